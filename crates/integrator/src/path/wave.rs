use super::Counters;
use crate::film::Moments;
use crate::lamp::LampSampler;
use crate::sampler::{BounceNumbers, Numbers};
use crate::tile::Tile;
use crate::{Camera, Interaction, RenderError, Roulette, Scene, Settings};
use glam::DVec3;
use globillum_geom::{Accel, Frame, Hit, Ray, SimdLevel};
use globillum_material::{Density, Rgb};

/// The samples of each pixel that one wave takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WaveSamples {
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// All paths of one tile's next samples, advanced together one bounce at a time, so that the
/// accelerator gets many rays at once. Its buffers are kept from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct Wave {
    /// Paths still under way, and beside each the ray it follows next.
    pub(super) paths: Vec<Path>,
    pub(super) rays: Vec<Ray>,
    /// What decides each path's next bounce.
    drawn: Vec<BounceNumbers>,
    pub(super) hits: Vec<Option<Hit>>,
    /// Light that arrives unless its shadow ray is occluded.
    pub(super) arriving: Vec<Arriving>,
    shadow_rays: Vec<Ray>,
    pub(super) occluded: Vec<bool>,
    /// What each sample has gathered, in the order in which the samples are taken.
    pub(super) radiance: Vec<Rgb>,
}

/// How many paths' numbers are computed side by side.
const SIDE_BY_SIDE: usize = 8;

/// One path under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    /// Its place in [`Wave::radiance`].
    sample: u32,
    numbers: Numbers,
    pub(super) throughput: Rgb,
    /// How the direction of its ray was chosen; the camera's counts as a delta, since no light
    /// sample could have found it.
    density: Density,
    /// The surface position from which its ray was chosen: where a light sample would have been taken.
    from: DVec3,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    sample: u32,
    pub(super) radiance: Rgb,
}

/// What is rendered: all that the steps of a wave share.
#[derive(Debug)]
pub(crate) struct View<'a, A> {
    pub(crate) scene: &'a Scene<A>,
    pub(crate) camera: &'a Camera,
    pub(crate) settings: &'a Settings,
}

impl Wave {
    /// Traces these samples of the tile; `None` if `cancelled` before the last bounce.
    pub(crate) fn trace<A: Accel>(
        &mut self,
        view: &View<'_, A>,
        tile: Tile,
        samples: WaveSamples,
        cancelled: impl Fn() -> bool,
    ) -> Option<Counters> {
        let mut counters = Counters::default();
        self.start(view.camera, view.settings, tile, samples);
        counters.camera_rays = self.rays.len() as u64;
        for bounce in 0.. {
            if cancelled() {
                return None;
            }
            self.advance(view, bounce, &mut counters);
            if self.paths.is_empty() {
                break;
            }
        }
        Some(counters)
    }

    /// Takes all paths through one bounce.
    fn advance<A: Accel>(&mut self, view: &View<'_, A>, bounce: u32, counters: &mut Counters) {
        self.find_hits(view);
        self.shade(view, bounce, counters);
        self.find_light(view);
        counters.shadow_rays += self.shadow_rays.len() as u64;
        counters.bounce_rays += self.rays.len() as u64;
    }

    /// What each path's ray meets.
    pub(super) fn find_hits<A: Accel>(&mut self, view: &View<'_, A>) {
        view.scene.accel().intersect_batch(&self.rays, &mut self.hits);
    }

    /// Adds the light that arrives unoccluded.
    pub(super) fn find_light<A: Accel>(&mut self, view: &View<'_, A>) {
        view.scene.accel().occluded_batch(&self.shadow_rays, &mut self.occluded);
        for (arriving, &occluded) in self.arriving.iter().zip(&self.occluded) {
            if !occluded {
                self.radiance[arriving.sample as usize] += arriving.radiance;
            }
        }
    }

    /// Camera rays, `samples.count` for each pixel of the tile.
    pub(super) fn start(&mut self, camera: &Camera, settings: &Settings, tile: Tile, samples: WaveSamples) {
        self.paths.clear();
        self.rays.clear();
        let (width, height) = (f64::from(settings.width), f64::from(settings.height));
        let pass = settings.pass_of(samples.first);
        for (x, y) in tile.pixels() {
            let pixel = u64::from(y) * u64::from(settings.width) + u64::from(x);
            for sample in samples.first..samples.first + samples.count {
                let numbers = settings.sampler.numbers(settings.seed, pixel, sample, &pass);
                let [dx, dy] = settings.filter.place(numbers.film());
                let film_x = 2.0 * (f64::from(x) + dx) / width - 1.0;
                let film_y = 1.0 - 2.0 * (f64::from(y) + dy) / height;
                let ray = camera.ray(film_x, film_y, width / height);
                let (throughput, density) = (Rgb::WHITE, Density::Delta);
                let sample = self.paths.len() as u32;
                self.paths.push(Path { sample, numbers, throughput, density, from: ray.origin });
                self.rays.push(ray);
            }
        }
        self.radiance.clear();
        self.radiance.resize(self.paths.len(), Rgb::BLACK);
    }

    /// The random numbers of all paths, for one bounce.
    fn draw(&mut self, bounce: u32) {
        let Self { paths, drawn, .. } = self;
        drawn.clear();
        SimdLevel::best().run(
            #[inline(always)]
            || {
                for group in paths.chunks(SIDE_BY_SIDE) {
                    let mut samples = [group[0].numbers; SIDE_BY_SIDE];
                    for (sample, path) in samples.iter_mut().zip(group) {
                        *sample = path.numbers;
                    }
                    drawn.extend_from_slice(&BounceNumbers::draw(&samples, bounce)[..group.len()]);
                }
            },
        );
    }

    /// Adds what the hits emit, chooses points on lights, and scatters; keeps the paths that go
    /// on, in their order.
    pub(super) fn shade<A: Accel>(&mut self, view: &View<'_, A>, bounce: u32, counters: &mut Counters) {
        self.draw(bounce);
        self.arriving.clear();
        self.shadow_rays.clear();
        let mut kept = 0;
        for i in 0..self.paths.len() {
            let (mut path, ray, numbers) = (self.paths[i], self.rays[i], self.drawn[i]);
            let Some(hit) = self.hits[i] else {
                self.radiance[path.sample as usize] += path.throughput * view.scene.environment();
                continue;
            };
            let at = view.scene.interaction(&ray, &hit);
            if !at.point.position.is_finite() {
                // No ray could leave it: the sample would seem black instead of wrong.
                self.radiance[path.sample as usize] = Rgb::splat(f64::NAN);
                continue;
            }
            self.radiance[path.sample as usize] += path.throughput * view.emitted(&path, &hit, &at);
            if view.settings.max_bounces == Some(bounce) {
                counters.limit_ends += 1;
                continue;
            }
            let frame = Frame::around(at.point.normal);
            let wo = frame.to_local(at.wo);
            if let Some((shadow_ray, light)) = view.next_event(&path, &at, &frame, wo, &numbers) {
                self.shadow_rays.push(shadow_ray);
                self.arriving.push(Arriving { sample: path.sample, radiance: light });
            }
            let Some(next) = path.scatter(&at, &frame, wo, &numbers) else { continue };
            if bounce >= view.settings.roulette.start && !path.survives(&numbers) {
                counters.roulette_ends += 1;
                continue;
            }
            (self.paths[kept], self.rays[kept]) = (path, next);
            kept += 1;
        }
        self.paths.truncate(kept);
        self.rays.truncate(kept);
    }

    /// Adds the traced samples to the tile's pixels, of which each holds `before` earlier ones of
    /// this pass, in the order in which they are taken.
    pub(crate) fn add_to(
        &self,
        pixels: &mut [Moments],
        tile: Tile,
        samples: WaveSamples,
        before: u32,
    ) -> Result<(), RenderError> {
        let radiance = self.radiance.chunks_exact(samples.count as usize);
        for (((x, y), pixel), radiance) in tile.pixels().zip(pixels).zip(radiance) {
            for (i, &radiance) in (0..).zip(radiance) {
                if !radiance.is_finite() {
                    return Err(RenderError::NonFinite { x, y, sample: samples.first + i });
                }
                pixel.add(radiance, u64::from(before + i));
            }
        }
        Ok(())
    }
}

impl<A: Accel> View<'_, A> {
    /// What the surface emits along the path, by the share that scattering has in finding it.
    fn emitted(&self, path: &Path, hit: &Hit, at: &Interaction<'_>) -> Rgb {
        let emission = &at.material.emission;
        let emitted = emission.toward(at.point.normal.dot(at.wo));
        if emitted.is_black() {
            return emitted;
        }
        let by_light_sample = || self.lamps_from(path.from).pdf(hit.triangle, &at.point, emission);
        emitted * self.settings.estimator.weight_of_emission(path.density, by_light_sample)
    }

    /// How points on lights are chosen where `from` is shaded.
    fn lamps_from(&self, from: DVec3) -> LampSampler<'_> {
        self.scene.lamp_sampler(self.settings.light_sampling, from)
    }

    /// A point on a light, as the ray that must be free and the light that then arrives at the
    /// path's start.
    fn next_event(
        &self,
        path: &Path,
        at: &Interaction<'_>,
        frame: &Frame,
        wo: DVec3,
        numbers: &BounceNumbers,
    ) -> Option<(Ray, Rgb)> {
        if !self.settings.estimator.samples_lights() || at.material.bsdf.is_delta() {
            return None;
        }
        let light = self.lamps_from(at.point.position).sample(numbers.light, numbers.point)?;
        let wi = frame.to_local(light.direction);
        let scattered = at.material.bsdf.pdf(wo, wi);
        let share = self.settings.estimator.weight_of_light(light.pdf, scattered);
        let value = at.material.bsdf.eval(wo, wi) * light.radiance;
        let radiance = path.throughput * value * (wi.z.abs() * share / light.pdf.0);
        if radiance.is_black() {
            return None;
        }
        Some((at.point.segment_to(&light.point)?, radiance))
    }
}

impl Path {
    /// Chooses where the path goes on; `None` if nothing is reflected.
    fn scatter(
        &mut self,
        at: &Interaction<'_>,
        frame: &Frame,
        wo: DVec3,
        numbers: &BounceNumbers,
    ) -> Option<Ray> {
        let sample = at.material.bsdf.sample(wo, numbers.scatter)?;
        self.throughput *= sample.weight;
        self.density = sample.density;
        self.from = at.point.position;
        (!self.throughput.is_black()).then(|| at.point.spawn(frame.to_world(sample.wi)))
    }

    fn survives(&mut self, numbers: &BounceNumbers) -> bool {
        let survive_prob = self.throughput.max_component().min(Roulette::MAX_SURVIVE_PROB);
        self.throughput = self.throughput / survive_prob;
        numbers.roulette < survive_prob
    }
}
