use super::caustics::{Caustics, LEAST_WEIGHT};
use super::choices::Choices;
use super::counters::Counters;
use super::first_vertex::irradiance_vertex;
use super::large_mirror_rays::LargeMirrorRays;
use super::numbers::{draw_bounce_numbers, draw_numbers};
use super::path_state::{Contribution, Path, RadianceSums, Target};
use super::photon_rays::PhotonRays;
use super::pixel_groups::Groups;
use super::pixel_rect::PixelRect;
use super::render_context::RenderContext;
use super::reuse::Prefixes;
use super::shading_point::{MisContext, ShadingPoint};
use super::small_mirror_rays::SmallMirrorRays;
use super::stage::{Event, Met, Stage};
use super::supersampling_rays::SupersamplingRays;
use super::tile_probes::TileProbes;
use crate::guide::{GuideVertex, guide_vertex};
use crate::light::{ChosenLight, ChosenMirror};
use crate::sampler::{BounceNumbers, Member, MirrorSize, Numbers};
use crate::{Interaction, PathStart};
use globillum_geom::{Hit, Ray, SurfacePoint};
use globillum_material::{Density, Rgb};
use std::f64::consts::PI;
use std::ops::Range;

/// All paths of some samples of a tile, advanced together one bounce at a time, so that the accelerator
/// gets many rays at once (Laine, Karras and Aila 2013). Its buffers are reused from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct Wavefront {
    /// The paths that have not ended.
    pub(super) paths: Vec<Path>,
    /// The next ray of each path.
    pub(super) rays: Vec<Ray>,
    /// The paths that begin at a point of irradiance, and these points. They join the others after the first bounce.
    pub(super) from_points: Vec<Path>,
    pub(super) points: Vec<SurfacePoint>,
    pub(super) hits: Vec<Option<Hit>>,
    /// Uniform numbers for the positions of the samples in their pixels.
    film_numbers: Vec<[f64; 2]>,
    /// The cells of the hits in the guide, with some more at the end; none if there is no guide.
    guide_cells: Vec<u32>,
    /// The random numbers of each path's next bounce.
    bounce_numbers: Vec<BounceNumbers>,
    light_choices: Choices<ChosenLight>,
    /// The random numbers by which paths choose small mirrors; none unless most do so.
    mirror_numbers: Vec<f64>,
    mirror_choices: Choices<ChosenMirror>,
    /// The random numbers of each path for a light in a large mirror; empty unless most paths take such a sample.
    large_mirror_numbers: Vec<(f64, [f64; 2])>,
    /// Light samples.
    pub(super) contributions: Vec<Contribution>,
    /// The shadow ray of each contribution.
    pub(super) shadow_rays: Vec<Ray>,
    pub(super) occluded: Vec<bool>,
    large_mirror_rays: LargeMirrorRays,
    pub(super) small_mirror_rays: SmallMirrorRays,
    supersampling_rays: SupersamplingRays,
    pub(super) radiance: RadianceSums,
    pub(super) prefixes: Prefixes,
    pub(super) caustics: Caustics,
    photon_rays: PhotonRays,
}

/// Irradiance over the radiance of a white diffuse surface.
pub(super) const IRRADIANCE_PER_RADIANCE: f64 = PI;

/// How many vertices are looked up in a guide at once.
const CELLS_AT_ONCE: usize = 16;

impl Wavefront {
    /// Traces `samples` of each pixel of the tile; `None` if `cancelled` before the last bounce.
    pub(crate) fn trace(
        &mut self,
        context: &RenderContext<'_>,
        (tile, probes): (PixelRect, &TileProbes),
        samples: &Range<u32>,
        cancelled: impl Fn() -> bool,
    ) -> Option<Counters> {
        self.start(context, (tile, probes), samples);
        let mut counters = Counters { camera_rays: self.rays.len() as u64, ..Counters::default() };
        for bounce in 0.. {
            if cancelled() {
                return None;
            }
            self.advance(context, bounce, &mut counters);
            if self.paths.is_empty() {
                break;
            }
        }
        self.prefixes.share_suffixes(context, tile, &mut self.radiance, &mut counters);
        let (prefixes, radiance) = ((tile, &self.prefixes), &mut self.radiance.samples);
        self.photon_rays.trace(context, prefixes, samples, radiance, &mut counters);
        self.caustics.share(context, prefixes, radiance, &mut counters);
        for path in &self.from_points {
            *self.radiance.at(path.target) *= IRRADIANCE_PER_RADIANCE;
        }
        counters.camera_rays += self.supersample(context, (tile, probes), samples);
        Some(counters)
    }

    /// The radiance of the samples traced last, pixel by pixel.
    pub(crate) fn radiance(&self) -> &[Rgb] {
        &self.radiance.samples
    }

    /// Adds what camera rays of their own find of the lights at edges. Returns their number.
    fn supersample(
        &mut self,
        context: &RenderContext<'_>,
        (tile, probes): (PixelRect, &TileProbes),
        samples: &Range<u32>,
    ) -> u64 {
        let rays = self.supersampling_rays.find(context, (tile, &probes.edges), samples);
        for &(sample, emitted) in &self.supersampling_rays.found {
            self.radiance.samples[sample as usize] += emitted;
        }
        rays
    }

    /// What these camera rays have found for a sample.
    pub(super) fn lights_seen_by(&self, sample: u32) -> Rgb {
        let found = self.supersampling_rays.found.iter().find(|&&(of, _)| of == sample);
        found.map_or(Rgb::BLACK, |&(_, emitted)| emitted)
    }

    /// Advances all paths by one bounce.
    pub(super) fn advance(&mut self, context: &RenderContext<'_>, bounce: u32, counters: &mut Counters) {
        self.trace_rays(context);
        self.shade(context, bounce, counters);
        self.trace_mirror_rays(context);
        self.trace_shadow_rays(context);
        let mirror_rays = self.large_mirror_rays.len() + self.small_mirror_rays.len();
        counters.shadow_rays += (mirror_rays + self.shadow_rays.len()) as u64;
        counters.bounce_rays += self.rays.len() as u64;
    }

    pub(super) fn trace_rays(&mut self, context: &RenderContext<'_>) {
        context.scene.accel().intersect_batch(&self.rays, &mut self.hits);
    }

    /// Follows light samples by way of mirrors. Those of large mirrors become contributions with shadow rays.
    pub(super) fn trace_mirror_rays(&mut self, context: &RenderContext<'_>) {
        self.large_mirror_rays.trace(context, &mut self.shadow_rays, &mut self.contributions);
        self.small_mirror_rays.trace(context);
    }

    /// Adds the contributions that are not occluded, and what samples of small mirrors have found.
    pub(super) fn trace_shadow_rays(&mut self, context: &RenderContext<'_>) {
        context.scene.accel().occluded_batch(&self.shadow_rays, &mut self.occluded);
        let unoccluded = self.contributions.iter().zip(&self.occluded).filter(|(_, occluded)| !**occluded);
        let contributions = unoccluded.map(|(contribution, _)| contribution);
        for contribution in contributions.chain(&self.small_mirror_rays.found) {
            *self.radiance.at(contribution.target) += contribution.radiance;
        }
    }

    /// Starts the paths of these samples where the sensor says.
    pub(super) fn start(
        &mut self,
        context: &RenderContext<'_>,
        (tile, probes): (PixelRect, &TileProbes),
        samples: &Range<u32>,
    ) {
        let settings = context.settings;
        self.paths.clear();
        let pass = settings.pass_of(samples.start);
        let groups =
            context.stratifies_groups().then(|| Groups::of_pass(samples.start / settings.pass_samples));
        for (x, y) in tile.pixels_by_block() {
            let alone = || Member::alone(u64::from(y) * u64::from(settings.width) + u64::from(x));
            let member = groups.map_or_else(alone, |groups| groups.member(x, y, settings.width));
            let pixel = tile.index(x, y) as u32;
            let supersampled = probes.edges.contain(pixel);
            for (i, sample) in (0..).zip(samples.clone()) {
                let numbers = settings.sampler.numbers(settings.seed, member, sample, &pass);
                let mut path = Path::new(pixel * samples.len() as u32 + i, numbers);
                path.mis.supersampled = supersampled;
                self.paths.push(path);
            }
        }
        draw_numbers(context.simd, &self.paths, &mut self.film_numbers, Numbers::films);
        let suffixes = self.prefixes.start(context, (tile, probes), samples);
        self.radiance.reset(self.paths.len(), suffixes);
        self.caustics.clear();
        self.place(context, tile, samples.len());
    }

    /// Asks the sensor where the paths begin, `count` of each element. Keeps those that begin with a ray, in order, and
    /// those that begin at a point by themselves.
    fn place(&mut self, context: &RenderContext<'_>, tile: PixelRect, count: usize) {
        self.rays.clear();
        self.from_points.clear();
        self.points.clear();
        let elements = tile.pixels_by_block().zip(self.film_numbers.chunks_exact(count));
        let samples = elements.flat_map(|(element, numbers)| numbers.iter().map(move |&u| (element, u)));
        let mut kept = 0;
        for (i, (element, u)) in samples.enumerate() {
            match context.path_start(element, u) {
                PathStart::Ray(ray) if ray.is_traceable() => {
                    self.paths[kept] = self.paths[i];
                    self.rays.push(ray);
                    kept += 1;
                }
                PathStart::Irradiance { position, normal }
                    if position.is_finite() && normal.is_normalized() =>
                {
                    self.from_points.push(self.paths[i]);
                    self.points.push(context.scene.triangles().given_point(position, normal));
                }
                PathStart::Ray(_) | PathStart::Irradiance { .. } => {
                    *self.radiance.at(self.paths[i].target) = Rgb::splat(f64::NAN);
                }
                PathStart::Nowhere => {}
            }
        }
        self.paths.truncate(kept);
    }

    /// Shades all hits: adds emission, samples lights, and scatters. Keeps the paths that go on, in order.
    pub(super) fn shade(&mut self, context: &RenderContext<'_>, bounce: u32, counters: &mut Counters) {
        let with_roulette = bounce >= context.settings.roulette.start;
        draw_bounce_numbers(context.simd, &self.paths, bounce, with_roulette, &mut self.bounce_numbers);
        self.draw_large_mirror_numbers(context, bounce);
        self.draw_mirror_numbers(context, bounce);
        self.contributions.clear();
        self.shadow_rays.clear();
        self.large_mirror_rays.clear();
        self.small_mirror_rays.clear();
        context.simd.run(
            #[inline(always)]
            || self.shade_paths(context, bounce, counters),
        );
        if bounce == 0 && !self.points.is_empty() {
            self.shade_points(context, counters);
        }
        self.prefixes.update_group_throughputs(bounce);
    }

    /// Draws the numbers for lights in large mirrors, if most paths take them.
    fn draw_large_mirror_numbers(&mut self, context: &RenderContext<'_>, bounce: u32) {
        self.large_mirror_numbers.clear();
        if context.samples_large_mirrors() && (bounce == 0 || context.large_mirror_prob > 0.5) {
            draw_numbers(
                context.simd,
                &self.paths,
                &mut self.large_mirror_numbers,
                #[inline(always)]
                |samples| Numbers::lights_in_mirrors(samples, MirrorSize::Large, bounce),
            );
        }
    }

    /// Draws the numbers that choose small mirrors, if most paths take one sample of them.
    fn draw_mirror_numbers(&mut self, context: &RenderContext<'_>, bounce: u32) {
        self.mirror_numbers.clear();
        let take_one = context.small_mirror_samples(bounce == 0) == 1 && context.may_sample_mirrors(bounce);
        if take_one && context.small_mirrors().is_some() {
            draw_numbers(
                context.simd,
                &self.paths,
                &mut self.mirror_numbers,
                #[inline(always)]
                |samples| Numbers::mirrors(samples, MirrorSize::Small, bounce),
            );
        }
    }

    /// Functions called here for most paths are inlined, so that they are compiled for the same
    /// instruction set.
    #[inline(always)]
    fn shade_paths(&mut self, context: &RenderContext<'_>, bounce: u32, counters: &mut Counters) {
        self.find_guide_cells(context);
        let wave = (&*self.paths, &*self.rays, &*self.hits);
        self.light_choices.choose_lights(context, wave, &self.bounce_numbers);
        self.mirror_choices.choose_mirrors(context, wave, &self.mirror_numbers);
        let mut kept = 0;
        for i in 0..self.paths.len() {
            let (mut path, ray, numbers) = (self.paths[i], self.rays[i], self.bounce_numbers[i]);
            let Some(hit) = self.hits[i] else {
                if path.stage.meet(Met::Environment).1 == Event::SuffixIsEnvironment {
                    self.prefixes.leave_scene(&mut path, ray.direction);
                }
                *self.radiance.at(path.target) += path.throughput * context.scene.environment();
                continue;
            };
            let at = context.scene.interaction(&ray, &hit);
            if !at.point.position.is_finite() {
                // No ray can leave it: the sample would come out black instead of being an error.
                *self.radiance.at(path.target) = Rgb::splat(f64::NAN);
                continue;
            }
            if let Stage::Reflected(_) = path.stage {
                self.add_reflected_emission(context, &path, (&hit, &at));
            } else {
                self.add_emission(context, &path, bounce, (&hit, &at));
            }
            if context.settings.max_bounces == Some(bounce) {
                counters.limit_ends += 1;
                continue;
            }
            let guide_cell = self.guide_cells.get(i).and_then(|&cell| Some(context.guide?.cell(cell)));
            let mut vertex = ShadingPoint::new(at, guide_cell, bounce, numbers);
            vertex.light = self.light_choices.of_path(i);
            vertex.mirror = self.mirror_choices.of_path(i);
            vertex.large_mirror_numbers = self.large_mirror_numbers.get(i).copied();
            self.meet_vertex(&mut path, &vertex);
            let Some(next) = self.sample_and_scatter(context, &mut path, &vertex, Some(&hit), counters)
            else {
                continue;
            };
            (self.paths[kept], self.rays[kept]) = (path, next);
            kept += 1;
        }
        self.paths.truncate(kept);
        self.rays.truncate(kept);
    }

    /// Adds the emission that a path has met. What a suffix finds by way of mirrors is kept by itself, where it is rare.
    #[inline(always)]
    fn add_emission(
        &mut self,
        context: &RenderContext<'_>,
        path: &Path,
        bounce: u32,
        (hit, at): (&Hit, &Interaction<'_>),
    ) {
        let Some((emitted, weight)) = context.emitted(path, bounce, hit, at) else { return };
        let radiance = path.throughput * (emitted * weight);
        let is_shared = context.shares_caustics && path.mis.is_specular() && weight >= LEAST_WEIGHT;
        match path.target {
            Target::Suffix(sample) if is_shared => self.radiance.suffix_caustics.push((sample, radiance)),
            target => *self.radiance.at(target) += radiance,
        }
    }

    /// Adds the emission that a path has met after its prefix by way of mirrors. What caustics leave depends on the
    /// prefix, so it is not shared.
    #[inline(always)]
    fn add_reflected_emission(
        &mut self,
        context: &RenderContext<'_>,
        path: &Path,
        (hit, at): (&Hit, &Interaction<'_>),
    ) {
        let left = self.caustics.keep_emission(context, path, (hit, at));
        let throughput = self.prefixes.throughput_before(path.target);
        self.radiance.samples[path.target.sample() as usize] += throughput * left;
    }

    /// Updates the stage of a path that has met a vertex. Its suffix may begin there.
    #[inline(always)]
    fn meet_vertex(&mut self, path: &mut Path, vertex: &ShadingPoint<'_>) {
        let met = if vertex.at.material.bsdf.is_delta() { Met::Mirror } else { Met::Diffuse };
        let event;
        (path.stage, event) = path.stage.meet(met);
        match event {
            Event::FirstMirror => self.prefixes.meet_mirror(path, vertex),
            Event::SuffixBegins => self.prefixes.begin_suffix(path, vertex),
            _ => {}
        }
    }

    /// Finds the cells of all hits, if there is a guide.
    #[inline(always)]
    fn find_guide_cells(&mut self, context: &RenderContext<'_>) {
        self.guide_cells.clear();
        let Some(guide) = context.guide else { return };
        for (rays, hits) in self.rays.chunks(CELLS_AT_ONCE).zip(self.hits.chunks(CELLS_AT_ONCE)) {
            let mut vertices = [GuideVertex::default(); CELLS_AT_ONCE];
            for (vertex, (ray, hit)) in vertices.iter_mut().zip(rays.iter().zip(hits)) {
                if let Some(hit) = hit {
                    *vertex = guide_vertex(context.scene.interaction(ray, hit).receiver());
                }
            }
            self.guide_cells.extend_from_slice(&guide.cells(&vertices));
        }
    }

    /// Shades the points at which paths begin, and appends the paths that go on to the others. For one instruction
    /// set: it is a small part of the work.
    #[inline(never)]
    fn shade_points(&mut self, context: &RenderContext<'_>, counters: &mut Counters) {
        if context.settings.max_bounces == Some(0) {
            counters.limit_ends += self.points.len() as u64;
            return;
        }
        let with_roulette = context.settings.roulette.start == 0;
        draw_bounce_numbers(context.simd, &self.from_points, 0, with_roulette, &mut self.bounce_numbers);
        for i in 0..self.points.len() {
            let (mut path, point, numbers) = (self.from_points[i], self.points[i], self.bounce_numbers[i]);
            let at = irradiance_vertex(point);
            let guide_cell =
                context.guide.map(|guide| guide.cell(guide.cells(&[guide_vertex(at.receiver())])[0]));
            let vertex = ShadingPoint::new(at, guide_cell, 0, numbers);
            let Some(next) = self.sample_and_scatter(context, &mut path, &vertex, None, counters) else {
                continue;
            };
            self.paths.push(path);
            self.rays.push(next);
        }
    }

    /// Samples lights at a vertex, and scatters the path there. The next ray; `None` if the path ends. `hit` is where
    /// it came in, unless it begins here.
    #[inline(always)]
    fn sample_and_scatter(
        &mut self,
        context: &RenderContext<'_>,
        path: &mut Path,
        vertex: &ShadingPoint<'_>,
        hit: Option<&Hit>,
        counters: &mut Counters,
    ) -> Option<Ray> {
        context.next_event(
            path,
            vertex,
            #[inline(always)]
            |shadow_ray, radiance| {
                self.shadow_rays.push(shadow_ray);
                self.contributions.push(Contribution { target: path.target, radiance });
            },
        );
        if context.samples_in_mirrors(vertex) {
            // Each with random numbers of its own.
            self.large_mirror_rays.sample(context, path, vertex);
            self.small_mirror_rays.sample(context, path, vertex);
        }
        let next = path.scatter(context, hit, vertex)?;
        if vertex.at.material.bsdf.is_diffuse() {
            let event;
            (path.stage, event) = path.stage.scatter(context.may_reuse_prefix(vertex.bounce));
            if event == Event::PrefixEnds {
                self.prefixes.end(path, vertex);
            }
        }
        let roulette = vertex.numbers.roulette.filter(|_| path.plays_roulette());
        if roulette.is_some_and(|u| !path.survives(context.settings.roulette, u)) {
            counters.roulette_ends += 1;
            return None;
        }
        Some(next)
    }
}

impl Path {
    /// Samples the next ray; `None` if nothing is reflected.
    #[inline(always)]
    pub(super) fn scatter(
        &mut self,
        context: &RenderContext<'_>,
        hit: Option<&Hit>,
        vertex: &ShadingPoint<'_>,
    ) -> Option<Ray> {
        let ShadingPoint { at, frame, .. } = vertex;
        let (sample, ratio) = vertex.sample()?;
        self.throughput *= sample.weight;
        self.guide_ratio *= ratio;
        self.mis = match sample.density {
            Density::SolidAngle(_) => MisContext {
                is_first: self.is_prefix(),
                ..MisContext::new(sample.density, vertex.receiver())
            },
            Density::Delta => context.mis_after_mirror(self.mis, hit?.triangle),
        };
        (!self.throughput.is_black()).then(|| at.point.spawn(frame.to_world(sample.wi)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, Estimator, Model, Sampler, Scene, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::quad;
    use globillum_geom::{KdOptions, KdTree, SimdLevel};
    use globillum_material::Material;

    /// A floor and a wall, a mirror beside them, and a light above.
    fn corner() -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let floor = quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
        model.add(Material::lambert(Rgb::new(0.8, 0.6, 0.3)).unwrap(), floor);
        let wall = quad(p(-1.0, 0.0, -1.0), p(1.0, 0.0, -1.0), p(1.0, 2.0, -0.8), p(-1.0, 2.0, -0.8));
        model.add(Material::lambert(Rgb::splat(0.7)).unwrap(), wall);
        let mirror = quad(p(-1.0, 0.0, -1.0), p(-1.1, 2.0, -1.0), p(-1.1, 2.0, 1.0), p(-1.0, 0.0, 1.0));
        model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), mirror);
        let light = quad(p(-0.5, 1.5, -0.5), p(0.5, 1.5, -0.5), p(0.5, 1.5, 0.5), p(-0.5, 1.5, 0.5));
        model.add(Material::light(Rgb::splat(5.0)).unwrap(), light);
        Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    #[test]
    fn shading_gives_the_same_bits_with_any_instructions() {
        let scene = corner();
        let camera =
            Camera::look_at(DVec3::new(0.3, 0.8, 2.5), DVec3::new(0.0, 0.6, 0.0), DVec3::Y, 0.8).unwrap();
        let tile = PixelRect { x: 0, y: 0, width: 16, height: 16 };
        for (sampler, estimator) in [Sampler::Sobol, Sampler::Independent]
            .into_iter()
            .flat_map(|s| [Estimator::Bsdf, Estimator::Light, Estimator::Mis].map(|e| (s, e)))
        {
            let settings = Settings { sampler, estimator, ..Settings::new(16, 16, 16) };
            let traced = SimdLevel::ALL.map(|simd| {
                let context = RenderContext { simd, ..RenderContext::new(&scene, &camera, &settings) };
                let mut wavefront = Wavefront::default();
                let counters =
                    wavefront.trace(&context, (tile, &TileProbes::of(&context, tile)), &(0..16), || false);
                (counters, wavefront.radiance.samples)
            });
            let lit = traced[0].1.iter().filter(|radiance| !radiance.is_black()).count();
            assert!(lit > 500, "{estimator:?}: {lit} samples are lit");
            assert!(traced.iter().all(|other| *other == traced[0]), "{sampler:?}, {estimator:?}");
        }
    }
}
