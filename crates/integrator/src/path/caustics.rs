//! Caustics that pixels share.
//!
//! A path may leave its first diffuse vertex `x` toward a mirror, and find a light by way of mirrors alone. Where light
//! samples do not find such light, or hardly ever, these paths are rare and bring much. So all pixels of a square share
//! each of them: they look from their own `x` at its point `y` on the first mirror, and follow mirrors from there. Those
//! that find a light could have found it by way of `y`, and divide it by the balance heuristic, each with the radiance
//! that it sees in `y`.

use super::counters::Counters;
use super::emission_rays::{EmissionRays, FoundEmission, MAX_REFLECTIONS, reflection};
use super::path_state::Path;
use super::pixel_groups::square_of;
use super::render_context::RenderContext;
use super::reuse::{Prefix, Prefixes};
use super::reuse_vertex::ReuseVertex;
use super::shading_point::MisContext;
use super::tile_bounds::Tile;
use crate::Interaction;
use crate::light::Receiver;
use globillum_geom::{Hit, PdfSolidAngle, Ray, SurfacePoint};
use globillum_material::{Bsdf, Density, Rgb};
use std::f64::consts::PI;

/// The least weight of multiple importance sampling with which a light is shared. Below it, light samples find most.
pub(super) const LEAST_WEIGHT: f64 = 0.5;

/// The caustics that the paths of a wavefront have found.
#[derive(Debug, Default)]
pub(super) struct Caustics {
    /// The samples, and the radiance that leaves the first mirror toward the end of the prefix.
    found: Vec<(u32, Rgb)>,
    /// One for each prefix that may share a caustic; its own is first.
    views: Vec<View>,
    /// The segment to the mirror of each view but the first.
    rays: Vec<Ray>,
    occluded: Vec<bool>,
    emission_rays: EmissionRays,
}

/// The first mirror of a caustic as the end of a prefix sees it.
#[derive(Clone, Copy, Debug)]
struct View {
    sample: u32,
    /// The density, per area of the mirror and times pi, with which the prefix would have been continued there by its
    /// BSDF alone.
    density: f64,
    /// The same by the guide, if there is one.
    guided_density: f64,
    radiance: Rgb,
}

impl Caustics {
    /// Forgets what was found.
    pub(super) fn clear(&mut self) {
        self.found.clear();
    }

    /// Handles the emission that a path has met by way of mirrors after its prefix. If pixels share it, stores its radiance
    /// and returns black. Otherwise returns the radiance, which belongs to the sample of the path alone.
    #[inline(never)]
    pub(super) fn take_emission(
        &mut self,
        context: &RenderContext<'_>,
        path: &Path,
        (hit, at): (&Hit, &Interaction<'_>),
    ) -> Rgb {
        let emitted = at.emitted();
        if emitted.is_black() {
            return emitted;
        }
        let weight = context.weight_of_emission(&path.mis, (hit, at));
        let radiance = path.throughput * emitted * weight;
        // A radiance that is not finite stays with its own sample, so that an error names that one.
        if !context.shares_caustics || weight < LEAST_WEIGHT || radiance.is_black() || !radiance.is_finite() {
            return radiance;
        }
        self.found.push((path.target.sample(), radiance));
        Rgb::BLACK
    }

    /// What the path of a sample has found.
    pub(super) fn found_by(&self, sample: u32) -> Rgb {
        let own = self.found.iter().filter(|(of, _)| *of == sample);
        own.fold(Rgb::BLACK, |sum, &(_, radiance)| sum + radiance)
    }

    /// Adds each caustic to the samples of equal index of its square, of the wavefront of a tile.
    pub(super) fn share(
        &mut self,
        context: &RenderContext<'_>,
        (tile, prefixes): (Tile, &Prefixes),
        samples: &mut [Rgb],
        counters: &mut Counters,
    ) {
        let count = (samples.len() / tile.pixel_count()) as u32;
        let mut found = std::mem::take(&mut self.found);
        // A mirror that emits brings several to one sample.
        found.sort_by_key(|&(sample, _)| sample);
        for of_sample in found.chunk_by(|a, b| a.0 == b.0) {
            let (sample, _) = of_sample[0];
            let radiance = of_sample.iter().fold(Rgb::BLACK, |sum, &(_, radiance)| sum + radiance);
            let Some((own, mirror)) = prefixes.of(sample).and_then(|own| Some((own, own.mirror?))) else {
                continue;
            };
            let of_square = square_of(tile, sample / count).map(|pixel| pixel * count + sample % count);
            let own_view = View { sample, density: 1.0, guided_density: own.guide_ratio, radiance };
            self.collect_views(context, prefixes, (own_view, own, &mirror), of_square);
            self.look(context, (prefixes, own.bounce), &mirror.point, counters);
            self.divide(prefixes, samples);
        }
        self.found = found;
    }

    /// Collects the views of a caustic, that of the prefix that has found it and those of `others`, and the rays to its
    /// mirror.
    fn collect_views(
        &mut self,
        context: &RenderContext<'_>,
        prefixes: &Prefixes,
        (own_view, own, mirror): (View, &Prefix, &ReuseVertex),
        others: impl Iterator<Item = u32>,
    ) {
        self.views.clear();
        self.rays.clear();
        self.views.push(own_view);
        let Some((density, _)) = own.end.connection_to(mirror) else { return };
        self.views[0] = View { density, guided_density: density * own.guide_ratio, ..own_view };
        for sample in others.filter(|&other| other != own_view.sample) {
            let Some(prefix) = prefixes.of(sample).filter(|other| other.bounce == own.bounce) else {
                continue;
            };
            let Some((density, ray)) = prefix.end.connection_to(mirror) else { continue };
            let guided_density = density * prefix.end.guide_ratio(context.guide, ray.direction);
            self.rays.push(ray);
            self.views.push(View { sample, density, guided_density, radiance: Rgb::BLACK });
        }
    }

    /// Finds what each view shows, but for the first: by way of `mirror`, the first one after the end of prefixes at this
    /// bounce.
    fn look(
        &mut self,
        context: &RenderContext<'_>,
        (prefixes, bounce): (&Prefixes, u32),
        mirror: &SurfacePoint,
        counters: &mut Counters,
    ) {
        let Self { views, rays, occluded, emission_rays, .. } = self;
        context.scene.accel().occluded_batch(rays, occluded);
        let Bsdf::Mirror(reflectance) = context.scene.material(mirror.triangle).bsdf else { return };
        for (i, (ray, _)) in
            (1..).zip(rays.iter().zip(occluded.iter())).filter(|(_, (_, occluded))| !**occluded)
        {
            emission_rays.push(reflection(mirror, ray.direction), i, reflectance.rgb());
        }
        // Two bounces: at the prefix's end, and at this mirror.
        let left = context.settings.max_bounces.map_or(u32::MAX, |max| max - bounce - 2);
        let show = |found: FoundEmission<'_>| {
            let view = &mut views[found.target as usize];
            let Some(Prefix { end, .. }) = prefixes.of(view.sample) else { return };
            let direction = (mirror.position - end.point.position).normalize();
            let pdf =
                PdfSolidAngle(end.normal.dot(direction) / PI * end.guide_ratio(context.guide, direction));
            let mis = at_first_vertex(Density::SolidAngle(pdf), end.receiver());
            let weight = weight(context, mis, mirror.triangle, &found);
            if weight >= LEAST_WEIGHT {
                view.radiance += found.radiance * weight;
            }
        };
        let traced = emission_rays.trace(context, left.min(MAX_REFLECTIONS - 1), show, |_, _| {});
        counters.shadow_rays += rays.len() as u64 + traced;
    }

    /// Divides the caustic among the views that show a light.
    fn divide(&self, prefixes: &Prefixes, samples: &mut [Rgb]) {
        let lit = || self.views.iter().filter(|view| !view.radiance.is_black());
        let sum: f64 = lit().map(|view| view.guided_density).sum();
        for view in lit() {
            let throughput = prefixes.of(view.sample).map_or(Rgb::WHITE, |prefix| prefix.throughput);
            samples[view.sample as usize] += throughput * view.radiance * (view.density / sum);
        }
    }
}

/// What weights depend on after a first diffuse vertex has scattered a path with this density.
pub(super) fn at_first_vertex(density: Density, receiver: Receiver) -> MisContext {
    MisContext { is_first: true, ..MisContext::new(density, receiver) }
}

/// The weight of what a ray has found that triangle `mirror` reflected first. A second mirror is not sampled.
pub(super) fn weight(
    context: &RenderContext<'_>,
    mis: MisContext,
    mirror: u32,
    found: &FoundEmission<'_>,
) -> f64 {
    if found.reflections > 0 {
        return 1.0;
    }
    context.weight_of_emission(&context.mis_after_mirror(mis, mirror), found.at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::{LightEdges, Wavefront, probed};
    use crate::{Camera, Estimator, MirrorSampling, Model, Roulette, Scene, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::{icosphere, quad};
    use globillum_geom::{KdOptions, KdTree, Triangle};
    use globillum_material::{Emission, Material, Sides};
    use std::ops::Range;

    const TILE: Tile = Tile { x: 0, y: 0, width: 13, height: 16 };
    const SEEDS: u64 = 200;

    /// A floor of colours without blue or red between mirrors, flat, curved and emitting, and a light of this size. The
    /// camera sees parts of the floor in a mirror.
    fn room(size: f64) -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let mut add = |material, triangles: &[Triangle]| model.add(material, triangles.iter().copied());
        let lambert = |r, g, b| Material::lambert(Rgb::new(r, g, b)).unwrap();
        let mirror = |r, g, b| Material::mirror(Rgb::new(r, g, b)).unwrap();
        let left = quad(p(-1.0, 0.0, 1.0), p(0.1, 0.0, 1.0), p(0.1, 0.0, -1.0), p(-1.0, 0.0, -1.0));
        add(lambert(0.9, 0.6, 0.0), &left);
        let right = quad(p(0.1, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(0.1, 0.0, -1.0));
        add(lambert(0.0, 0.8, 0.7), &right);
        let back = quad(p(-1.0, 0.0, -1.0), p(1.0, 0.0, -1.0), p(1.0, 2.0, -0.8), p(-1.0, 2.0, -0.8));
        add(mirror(0.9, 0.5, 0.8), &back);
        let side = quad(p(-1.0, 0.0, -1.0), p(-1.1, 2.0, -1.0), p(-1.1, 2.0, 1.0), p(-1.0, 0.0, 1.0));
        add(mirror(0.0, 0.9, 0.8), &side);
        let glow = Emission::new(Rgb::new(0.2, 0.1, 0.3) * f64::from(size > 0.5), Sides::Front).unwrap();
        let other = quad(p(1.0, 0.0, 1.0), p(1.1, 2.0, 1.0), p(1.1, 2.0, -1.0), p(1.0, 0.0, -1.0));
        add(mirror(0.7, 0.9, 0.6).emitting(glow), &other);
        add(mirror(0.9, 0.8, 0.9), &icosphere(1).placed(0.3, p(0.3, 0.5, 0.1)).triangles());
        let far = [-0.4, -0.3].map(|near| near + size);
        let light =
            quad(p(-0.4, 1.5, -0.3), p(far[0], 1.5, -0.3), p(far[0], 1.5, far[1]), p(-0.4, 1.5, far[1]));
        add(Material::light(Rgb::new(5.0, 4.0, 3.0)).unwrap(), &light);
        Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    fn camera(fov: f64) -> Camera {
        Camera::look_at(DVec3::new(0.3, 0.9, 2.2), DVec3::new(0.1, 0.0, 0.0), DVec3::Y, fov).unwrap()
    }

    /// The radiance of each pixel's four samples together, with and without shared caustics.
    fn pixels(scene: &Scene<KdTree>, fov: f64, settings: &Settings) -> [Vec<Rgb>; 2] {
        [true, false].map(|shares_caustics| {
            let camera = camera(fov);
            let context = RenderContext { shares_caustics, ..RenderContext::new(scene, &camera, settings) };
            let mut wavefront = Wavefront::default();
            wavefront.trace(&context, (TILE, &LightEdges::of(&context, TILE)), &(0..4), || false);
            let of_pixels = wavefront.radiance().chunks(4);
            of_pixels.map(|of_pixel| of_pixel.iter().fold(Rgb::BLACK, |sum, &sample| sum + sample)).collect()
        })
    }

    /// Radiance with shared caustics minus radiance without, by bands of four rows and of all pixels, each with the sum of
    /// its squares over all seeds.
    type Deviations = [[(f64, f64); 3]; 5];

    /// The same seeds with and without shared caustics, so that all other light cancels. Single pixels of few caustics have
    /// a skewed distribution, so rows are compared together. Any of the deviations exceeds the limit with a probability of
    /// 3e-6 (Student's distribution with 199 degrees of freedom).
    #[test]
    fn pixels_keep_their_mean() {
        let scene = room(0.6);
        let settings = Settings::new(13, 16, 4);
        let with = |estimator, max_bounces| Settings { estimator, max_bounces, ..settings };
        let all = [
            (0.9, settings),
            (0.2, Settings { mirror_sampling: MirrorSampling::Off, max_bounces: Some(4), ..settings }),
            (0.9, with(Estimator::Light, None)),
            (0.2, with(Estimator::Bsdf, None)),
            (0.2, with(Estimator::Mis, Some(2))),
            (0.9, with(Estimator::Mis, Some(3))),
            (0.2, Settings { roulette: Roulette { start: 1, threshold: 1.0 }, ..settings }),
        ];
        for (i, (fov, settings)) in all.into_iter().enumerate() {
            let mut deviations = Deviations::default();
            let mut level = 0.0;
            for seed in 0..SEEDS {
                let [shared, alone] = pixels(&scene, fov, &Settings { seed, ..settings });
                level += alone.iter().map(|radiance| radiance.mean()).sum::<f64>();
                let difference = |pixels: Range<usize>| {
                    let of_pixel = |i: usize| shared[i] + alone[i] * -1.0;
                    pixels.map(of_pixel).fold(Rgb::BLACK, |sum, difference| sum + difference).to_array()
                };
                let bands = [0, 1, 2, 3].map(|band| difference(52 * band..52 * (band + 1)));
                let of_all = bands.iter().copied().chain([difference(0..TILE.pixel_count())]);
                for ((sum, square), d) in deviations.as_flattened_mut().iter_mut().zip(of_all.flatten()) {
                    *sum += d;
                    *square += d * d;
                }
            }
            let z = |&(sum, square): &(f64, f64)| if square == 0.0 { 0.0 } else { sum.abs() / square.sqrt() };
            let largest = deviations.as_flattened().iter().map(z).fold(0.0, f64::max);
            let error = deviations[4].iter().map(|(_, square)| square).sum::<f64>().sqrt() / level;
            assert!(largest < 5.85, "{i}: {largest}");
            assert!(error > 0.0 && error < 0.0065, "{i}: {error}");
        }
    }

    /// Rare caustics have most of the variance here, and pixels that share them have less.
    #[test]
    fn shared_caustics_have_less_variance() {
        let scene = room(0.2);
        let mut sums = [[0.0; 2]; 2];
        for seed in 0..SEEDS {
            let settings = Settings { seed, ..Settings::new(13, 16, 4) };
            for (sums, radiance) in sums.iter_mut().zip(pixels(&scene, 0.2, &settings)) {
                for pixel in radiance {
                    sums[0] += pixel.mean();
                    sums[1] += pixel.mean() * pixel.mean();
                }
            }
        }
        let n = (SEEDS as usize * TILE.pixel_count()) as f64;
        let [shared, alone] = sums.map(|[sum, square]| square / n - (sum / n) * (sum / n));
        assert!(shared < 0.6 * alone, "{shared}, {alone}");
    }

    /// A floor between two high mirrors that face each other, below a light: many paths reach it after eight mirrors, and
    /// many after nine.
    fn shaft() -> Scene<KdTree> {
        let p = DVec3::new;
        let mut model = Model::default();
        let level = |y| [p(-0.5, y, 9.0), p(0.5, y, 9.0), p(0.5, y, -9.0), p(-0.5, y, -9.0)];
        let [a, b, c, d] = level(0.0);
        model.add(Material::lambert(Rgb::splat(0.8)).unwrap(), quad(a, b, c, d));
        let [a, b, c, d] = level(4.0);
        model.add(Material::light(Rgb::splat(2.0)).unwrap(), quad(a, d, c, b));
        for x in [-0.5, 0.5] {
            let wall = quad(p(x, 0.0, 9.0), p(x, 0.0, -9.0), p(x, 4.0, -9.0), p(x, 4.0, 9.0));
            model.add(Material::mirror(Rgb::splat(0.95)).unwrap(), wall);
        }
        Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    /// What a pixel finds by way of a mirror that another path has met is what its own path finds there: by way of no
    /// fewer mirrors and of no more.
    #[test]
    fn each_path_finds_its_own_caustic_again() {
        let (scene, settings) = (shaft(), Settings::new(13, 16, 4));
        let camera = Camera::look_at(DVec3::new(0.0, 2.0, 0.5), DVec3::ZERO, DVec3::Y, 0.4).unwrap();
        let context =
            RenderContext { shares_caustics: true, ..RenderContext::new(&scene, &camera, &settings) };
        let (mut wavefront, mut counters) = (Wavefront::default(), Counters::default());
        wavefront.start(&context, (TILE, &LightEdges::default()), &(0..4));
        for bounce in 0.. {
            wavefront.advance(&context, bounce, &mut counters);
            if wavefront.paths.is_empty() {
                break;
            }
        }
        let Wavefront { prefixes, mut caustics, .. } = wavefront;
        let mut lit = 0;
        for sample in 0..4 * TILE.pixel_count() as u32 {
            let met = prefixes.of(sample).and_then(|own| Some((own, own.mirror?)));
            let Some((own, mirror)) = met else { continue };
            let (density, ray) = own.end.connection_to(&mirror).unwrap();
            caustics.views = vec![View { sample, density, guided_density: density, radiance: Rgb::BLACK }; 2];
            caustics.rays = vec![ray];
            caustics.look(&context, (&prefixes, own.bounce), &mirror.point, &mut counters);
            let [again, found] = [caustics.views[1].radiance.g, caustics.found_by(sample).g];
            assert!((again - found).abs() <= 1e-9 * found, "{sample}: {again}, {found}");
            lit += u32::from(found > 0.0);
        }
        assert!(lit > 100, "{lit}");
    }

    #[test]
    fn caustics_are_shared_where_they_are_rare() {
        let (camera, settings) = (camera(0.9), Settings::new(13, 16, 4));
        let off = Settings { path_reuse: crate::PathReuse::Off, ..settings };
        for (size, settings, expected) in
            [(0.6, &settings, false), (0.2, &settings, true), (0.2, &off, false)]
        {
            let scene = room(size);
            let context = probed(RenderContext::new(&scene, &camera, settings));
            assert_eq!(context.shares_caustics, expected, "{size}, {:?}", settings.path_reuse);
        }
    }
}
