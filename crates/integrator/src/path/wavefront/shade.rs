//! Shading: what a path does at a vertex.

use super::Wavefront;
use super::numbers::{draw_bounce_numbers, draw_numbers};
use crate::Interaction;
use crate::checked_accel;
use crate::guide::{GuideVertex, guide_vertex};
use crate::path::caustics::MIN_WEIGHT;
use crate::path::counters::Counters;
use crate::path::diffuse_vertex::irradiance_vertex;
use crate::path::mis::MisContext;
use crate::path::path_state::Path;
use crate::path::path_vertex::PathVertex;
use crate::path::radiance_sums::{Contribution, Target};
use crate::path::render_context::RenderContext;
use crate::path::reuse_stage::{Met, ReuseEvent, ReuseStage};
use crate::sampler::{MirrorSize, Numbers};
use globillum_geom::Ray;
use globillum_material::{Density, Rgb};

/// How many vertices are looked up in a guide at once.
const CELLS_AT_ONCE: usize = 16;

impl Wavefront {
    /// Traces the rays of all paths and shades their hits: adds emission, samples lights, and scatters. Keeps the paths that
    /// go on, in order.
    pub(in crate::path) fn shade(
        &mut self,
        context: &RenderContext<'_>,
        bounce: u32,
        counters: &mut Counters,
    ) {
        checked_accel::intersect(context.scene.accel(), &self.rays, &mut self.hits);
        let with_roulette = bounce >= context.settings.roulette.start;
        draw_bounce_numbers(context.simd, &self.paths, bounce, with_roulette, &mut self.bounce_numbers);
        self.draw_large_mirror_numbers(context, bounce);
        self.draw_small_mirror_numbers(context, bounce);
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
        self.prefixes.update_largest_throughputs(context, &self.samples, bounce);
    }

    /// Draws the numbers for lights in large mirrors, if most paths take them.
    fn draw_large_mirror_numbers(&mut self, context: &RenderContext<'_>, bounce: u32) {
        self.large_mirror_numbers.clear();
        if context.large_mirrors().is_some() && context.large_mirror_prob(bounce == 0) > 0.5 {
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
    fn draw_small_mirror_numbers(&mut self, context: &RenderContext<'_>, bounce: u32) {
        self.small_mirror_numbers.clear();
        let take_one = context.small_mirror_samples(bounce == 0) == 1 && context.may_sample_mirrors(bounce);
        if take_one && context.small_mirrors().is_some() {
            draw_numbers(
                context.simd,
                &self.paths,
                &mut self.small_mirror_numbers,
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
        self.small_mirror_choices.choose_small_mirrors(context, wave, &self.small_mirror_numbers);
        let (mut paths, mut kept) = (std::mem::take(&mut self.paths), 0);
        for i in 0..paths.len() {
            let (path, numbers) = (&mut paths[i], self.bounce_numbers[i]);
            let Some(at) = self.find_vertex(context, path, i, bounce) else { continue };
            if context.settings.max_bounces == Some(bounce) {
                counters.limit_ends += 1;
                continue;
            }
            let guide_cell = self.guide_cells.get(i).and_then(|&cell| Some(context.guide?.cell(cell)));
            let mut vertex = PathVertex::new(at, guide_cell, bounce, path.is_prefix(), numbers);
            vertex.light = self.light_choices.of_path(i);
            vertex.small_mirror = self.small_mirror_choices.of_path(i);
            vertex.large_mirror_numbers = self.large_mirror_numbers.get(i).copied();
            self.meet_vertex(path, &vertex);
            let Some(next) = self.sample_and_scatter(context, path, &vertex, counters) else { continue };
            (paths[kept], self.rays[kept]) = (*path, next);
            kept += 1;
        }
        paths.truncate(kept);
        self.paths = paths;
        self.rays.truncate(kept);
    }

    /// The vertex that `path`, the one of index `i`, has met; `None` if it has left the scene. Adds the emission there, or
    /// of the environment.
    #[inline(always)]
    fn find_vertex<'a>(
        &mut self,
        context: &RenderContext<'a>,
        path: &mut Path,
        i: usize,
        bounce: u32,
    ) -> Option<Interaction<'a>> {
        let Some(hit) = self.hits[i] else {
            if path.stage.meet(Met::Environment) == Some(ReuseEvent::SuffixIsEnvironment) {
                self.prefixes.leave_scene(path, self.rays[i].direction);
            }
            *self.radiance.at(path.target) += path.throughput * context.scene.environment();
            return None;
        };
        let at = context.scene.interaction(&self.rays[i], &hit);
        if !at.point.position.is_finite() {
            // No ray can leave it: the sample would come out black instead of being an error.
            *self.radiance.at(path.target) = Rgb::splat(f64::NAN);
            return None;
        }
        if let ReuseStage::Reflected(_) = path.stage {
            self.add_reflected_emission(context, path, &at);
        } else {
            self.add_emission(context, path, bounce, &at);
        }
        Some(at)
    }

    /// Adds the emission that a path has met. What a suffix finds by way of mirrors is kept by itself, where it is rare.
    #[inline(always)]
    fn add_emission(&mut self, context: &RenderContext<'_>, path: &Path, bounce: u32, at: &Interaction<'_>) {
        let emitted = at.emitted();
        if emitted.is_black() || path.mis.is_supersampled(bounce) {
            return;
        }
        let weight = path.mis.weight(context, at);
        let radiance = path.throughput * (emitted * weight);
        let is_shared = context.shares_caustics && path.mis.is_specular() && weight >= MIN_WEIGHT;
        match path.target {
            Target::AfterPrefix(sample) if is_shared => {
                self.radiance.suffix_caustics.push((sample, radiance))
            }
            target => *self.radiance.at(target) += radiance,
        }
    }

    /// Adds the emission that a path has met after its prefix by way of mirrors. What caustics do not take has a weight that
    /// depends on the prefix, so it goes to this sample alone.
    #[inline(always)]
    fn add_reflected_emission(&mut self, context: &RenderContext<'_>, path: &Path, at: &Interaction<'_>) {
        let left = self.caustics.take_emission(context, path, at);
        let throughput = self.prefixes.throughput_before(path.target);
        self.radiance.samples[path.target.sample() as usize] += throughput * left;
    }

    /// Updates the stage of a path that has met a vertex. Its suffix may begin there.
    #[inline(always)]
    fn meet_vertex(&mut self, path: &mut Path, vertex: &PathVertex<'_>) {
        let met = if vertex.at.material.bsdf.is_delta() { Met::Mirror } else { Met::Diffuse };
        match path.stage.meet(met) {
            Some(ReuseEvent::FirstMirror) => self.prefixes.meet_mirror(path, vertex),
            Some(ReuseEvent::SuffixBegins) => self.prefixes.begin_suffix(path, vertex),
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
            let vertex = PathVertex::new(at, guide_cell, 0, true, numbers);
            let Some(next) = self.sample_and_scatter(context, &mut path, &vertex, counters) else {
                continue;
            };
            self.paths.push(path);
            self.rays.push(next);
        }
    }

    /// Samples lights at a vertex, and scatters the path there. The next ray; `None` if the path ends.
    #[inline(always)]
    fn sample_and_scatter(
        &mut self,
        context: &RenderContext<'_>,
        path: &mut Path,
        vertex: &PathVertex<'_>,
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
        let next = path.scatter(context, vertex)?;
        if vertex.at.material.bsdf.is_diffuse()
            && path.stage.scatter(context.may_reuse_prefix(vertex.bounce)) == Some(ReuseEvent::PrefixEnds)
        {
            self.prefixes.end(path, vertex);
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
    fn scatter(&mut self, context: &RenderContext<'_>, vertex: &PathVertex<'_>) -> Option<Ray> {
        let PathVertex { at, frame, .. } = vertex;
        let (sample, ratio) = vertex.sample()?;
        self.throughput *= sample.weight;
        self.guide_ratio *= ratio;
        self.mis = match sample.density {
            Density::SolidAngle(_) => {
                MisContext::scattered(sample.density, vertex.at.receiver(), vertex.is_first)
            }
            Density::Delta => self.mis.after_mirror(context, at.point.triangle),
        };
        (!self.throughput.is_black()).then(|| at.point.spawn_ray(frame.to_world(sample.wi)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::test_rooms::built;
    use crate::path::tile_probes::TileProbes;
    use crate::pixel_rect::PixelRect;
    use crate::{Estimator, Model, PinholeCamera, Sampler, Scene, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::quad;
    use globillum_geom::{KdTree, SimdLevel};
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
        built(model)
    }

    #[test]
    fn shading_gives_the_same_bits_with_any_instructions() {
        let scene = corner();
        let camera =
            PinholeCamera::look_at(DVec3::new(0.3, 0.8, 2.5), DVec3::new(0.0, 0.6, 0.0), DVec3::Y, 0.8)
                .unwrap();
        let tile = PixelRect { x: 0, y: 0, width: 16, height: 16 };
        for (sampler, estimator) in [Sampler::Sobol, Sampler::Independent]
            .into_iter()
            .flat_map(|s| [Estimator::Bsdf, Estimator::Light, Estimator::Mis].map(|e| (s, e)))
        {
            let settings = Settings { sampler, estimator, ..Settings::new(16, 16, 16) };
            let traced = SimdLevel::ALL.map(|simd| {
                let context = RenderContext { simd, ..RenderContext::new(&scene, &camera, &settings) };
                let mut wavefront = Wavefront::default();
                let counters = wavefront.trace(&context, &TileProbes::of(&context, tile), 0..16, || false);
                (counters, wavefront.radiance.samples)
            });
            let lit = traced[0].1.iter().filter(|radiance| !radiance.is_black()).count();
            assert!(lit > 500, "{estimator:?}: {lit} samples are lit");
            assert!(traced.iter().all(|other| *other == traced[0]), "{sampler:?}, {estimator:?}");
        }
    }
}
