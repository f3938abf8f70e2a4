use super::counters::Counters;
use super::job::{View, WaveSamples};
use super::next_event::Thrown;
use super::reuse::Stems;
use super::state::{Path, Stage};
use super::tile::Tile;
use super::vertex::{Choice, Shaded};
use crate::film::Moments;
use crate::sampler::{BounceNumbers, Numbers};
use crate::{RenderError, Roulette};
use globillum_geom::{Accel, Hit, Ray, SimdLevel};
use globillum_material::{Density, Rgb};

/// All paths of one tile's next samples, advanced together one bounce at a time, so that the
/// accelerator gets many rays at once. Its buffers are kept from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct Wave {
    level: Level,
    /// Paths still under way, and beside each the ray it follows next.
    pub(super) paths: Vec<Path>,
    pub(super) rays: Vec<Ray>,
    /// What decides where in its pixel each camera ray passes.
    places: Vec<[f64; 2]>,
    /// What decides each path's next bounce.
    drawn: Vec<BounceNumbers>,
    pub(super) hits: Vec<Option<Hit>>,
    /// Light that arrives unless its shadow ray is occluded.
    pub(super) arriving: Vec<Arriving>,
    shadow_rays: Vec<Ray>,
    /// Light that mirrors throw, each with the sample that it is for and beside the ray that must meet
    /// the mirror.
    thrown: Vec<(u32, Thrown)>,
    mirror_rays: Vec<Ray>,
    mirror_hits: Vec<Option<Hit>>,
    pub(super) occluded: Vec<bool>,
    /// What each sample has gathered, in the order in which the samples are taken; then, as many again,
    /// what their tails have, until it is dealt out.
    pub(super) radiance: Vec<Rgb>,
    pub(super) stems: Stems,
}

/// Which instructions a wave is shaded with; the bits are the same with any.
#[derive(Clone, Copy, Debug)]
struct Level(SimdLevel);

impl Default for Level {
    fn default() -> Self {
        Self(SimdLevel::best())
    }
}

/// How many paths' numbers are computed side by side.
const SIDE_BY_SIDE: usize = 8;

#[derive(Clone, Copy, Debug)]
pub(super) struct Arriving {
    /// Where it goes, as [`Path::account`].
    pub(super) account: u32,
    pub(super) radiance: Rgb,
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
        self.start(view, tile, samples);
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
        let Level(level) = self.level;
        self.stems.deal(view, level, &mut self.radiance, &mut counters);
        Some(counters)
    }

    /// Takes all paths through one bounce.
    fn advance<A: Accel>(&mut self, view: &View<'_, A>, bounce: u32, counters: &mut Counters) {
        self.find_hits(view);
        self.shade(view, bounce, counters);
        self.reflect(view);
        self.find_light(view);
        counters.shadow_rays += (self.mirror_rays.len() + self.shadow_rays.len()) as u64;
        counters.bounce_rays += self.rays.len() as u64;
    }

    /// What each path's ray meets.
    pub(super) fn find_hits<A: Accel>(&mut self, view: &View<'_, A>) {
        view.scene.accel().intersect_batch(&self.rays, &mut self.hits);
    }

    /// Takes the light that mirrors throw on to the lights, where it meets those mirrors.
    pub(super) fn reflect<A: Accel>(&mut self, view: &View<'_, A>) {
        if self.thrown.is_empty() {
            return;
        }
        view.scene.accel().intersect_batch(&self.mirror_rays, &mut self.mirror_hits);
        for ((account, thrown), &hit) in self.thrown.iter().zip(&self.mirror_hits) {
            let Some((shadow_ray, radiance)) = view.reflected(thrown, hit) else { continue };
            self.shadow_rays.push(shadow_ray);
            self.arriving.push(Arriving { account: *account, radiance });
        }
    }

    /// Adds the light that arrives unoccluded.
    pub(super) fn find_light<A: Accel>(&mut self, view: &View<'_, A>) {
        view.scene.accel().occluded_batch(&self.shadow_rays, &mut self.occluded);
        for (arriving, &occluded) in self.arriving.iter().zip(&self.occluded) {
            if !occluded {
                self.radiance[arriving.account as usize] += arriving.radiance;
            }
        }
    }

    /// Camera rays, `samples.count` for each pixel of the tile.
    pub(super) fn start<A>(&mut self, view: &View<'_, A>, tile: Tile, samples: WaveSamples) {
        let View { camera, settings, .. } = *view;
        self.paths.clear();
        self.rays.clear();
        let (width, height) = (f64::from(settings.width), f64::from(settings.height));
        let pass = settings.pass_of(samples.first);
        for (x, y) in tile.pixels() {
            let pixel = u64::from(y) * u64::from(settings.width) + u64::from(x);
            for sample in samples.first..samples.first + samples.count {
                let numbers = settings.sampler.numbers(settings.seed, pixel, sample, &pass);
                self.paths.push(Path::from_camera(self.paths.len() as u32, numbers, camera.eye()));
            }
        }
        side_by_side(self.level, &self.paths, &mut self.places, Numbers::films);
        let places = self.places.chunks_exact(samples.count as usize);
        for ((x, y), places) in tile.pixels().zip(places) {
            for &u in places {
                let [dx, dy] = settings.filter.place(u);
                let film_x = 2.0 * (f64::from(x) + dx) / width - 1.0;
                let film_y = 1.0 - 2.0 * (f64::from(y) + dy) / height;
                self.rays.push(camera.ray(film_x, film_y, width / height));
            }
        }
        self.radiance.clear();
        let tails = self.stems.start(view, tile, samples);
        self.radiance.resize(self.paths.len() + tails, Rgb::BLACK);
    }

    /// Adds what the hits emit, chooses points on lights, and scatters; keeps the paths that go
    /// on, in their order.
    pub(super) fn shade<A: Accel>(&mut self, view: &View<'_, A>, bounce: u32, counters: &mut Counters) {
        let roulette = view.settings.roulette;
        side_by_side(
            self.level,
            &self.paths,
            &mut self.drawn,
            #[inline(always)]
            |samples| BounceNumbers::draw(samples, bounce, bounce >= roulette.start),
        );
        self.arriving.clear();
        self.shadow_rays.clear();
        self.thrown.clear();
        self.mirror_rays.clear();
        let Level(level) = self.level;
        level.run(
            #[inline(always)]
            || self.shade_all(view, bounce, counters),
        );
        self.stems.compare(bounce);
    }

    /// What is called here for most paths is inlined, so that it is compiled for the machine's
    /// instructions too.
    #[inline(always)]
    fn shade_all<A: Accel>(&mut self, view: &View<'_, A>, bounce: u32, counters: &mut Counters) {
        let mut kept = 0;
        for i in 0..self.paths.len() {
            let (mut path, ray, numbers) = (self.paths[i], self.rays[i], self.drawn[i]);
            let Some(hit) = self.hits[i] else {
                self.radiance[path.account as usize] += path.throughput * view.scene.environment();
                continue;
            };
            let at = view.scene.interaction(&ray, &hit);
            if !at.point.position.is_finite() {
                // No ray could leave it: the sample would seem black instead of wrong.
                self.radiance[path.account as usize] = Rgb::splat(f64::NAN);
                continue;
            }
            self.radiance[path.account as usize] += path.throughput * view.emitted(&path, &hit, &at);
            if view.settings.max_bounces == Some(bounce) {
                counters.limit_ends += 1;
                continue;
            }
            let shaded = Shaded::new(at, bounce, numbers);
            if path.stage == Stage::Scattered {
                path.stage = Stage::Beyond;
                if at.material.bsdf.is_diffuse() {
                    self.stems.begin_tail(&mut path, &shaded);
                }
            }
            if let Some((shadow_ray, light)) = view.next_event(&path, &shaded) {
                self.shadow_rays.push(shadow_ray);
                self.arriving.push(Arriving { account: path.account, radiance: light });
            }
            if let Some((mirror_ray, thrown)) = view.next_event_in_mirror(&path, &shaded) {
                self.mirror_rays.push(mirror_ray);
                self.thrown.push((path.account, thrown));
            }
            let Some(next) = path.scatter(view, &hit, &shaded) else { continue };
            if path.stage == Stage::Stem && view.ends_stem(bounce) && at.material.bsdf.is_diffuse() {
                self.stems.end(&mut path, &shaded);
            }
            if numbers.roulette.is_some_and(|u| !path.survives(view.settings.roulette, u)) {
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

/// What `draw` makes of the random numbers of all `paths`, several at a time.
fn side_by_side<T: Copy>(
    Level(level): Level,
    paths: &[Path],
    drawn: &mut Vec<T>,
    draw: impl Fn(&[Numbers; SIDE_BY_SIDE]) -> [T; SIDE_BY_SIDE],
) {
    drawn.clear();
    level.run(
        #[inline(always)]
        || {
            for group in paths.chunks(SIDE_BY_SIDE) {
                let mut samples = [group[0].numbers; SIDE_BY_SIDE];
                for (sample, path) in samples.iter_mut().zip(group) {
                    *sample = path.numbers;
                }
                drawn.extend_from_slice(&draw(&samples)[..group.len()]);
            }
        },
    );
}

impl Path {
    /// Chooses where the path goes on; `None` if nothing is reflected.
    #[inline(always)]
    pub(super) fn scatter<A>(&mut self, view: &View<'_, A>, hit: &Hit, shaded: &Shaded<'_>) -> Option<Ray> {
        let Shaded { at, frame, wo, numbers, .. } = shaded;
        let sample = at.material.bsdf.sample(*wo, numbers.scatter)?;
        self.throughput *= sample.weight;
        self.choice = match sample.density {
            Density::SolidAngle(_) => Choice::at_surface(sample.density, at.point.position),
            Density::Delta => view.passed_mirror(self.choice, hit.triangle),
        };
        (!self.throughput.is_black()).then(|| at.point.spawn(frame.to_world(sample.wi)))
    }

    /// Whether roulette, by `u` in `[0, 1)`, lets the path go on.
    #[inline(always)]
    fn survives(&mut self, roulette: Roulette, u: f64) -> bool {
        let uncapped = (self.before * self.throughput).max_component() / roulette.threshold;
        let survive_prob = uncapped.min(Roulette::MAX_SURVIVE_PROB);
        self.throughput = self.throughput / survive_prob;
        u < survive_prob
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, Estimator, Model, Sampler, Scene, Settings};
    use glam::DVec3;
    use globillum_geom::conformance::shapes::quad;
    use globillum_geom::{KdOptions, KdTree};
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
        Scene::build(&model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    #[test]
    fn shading_gives_the_same_bits_with_any_instructions() {
        let scene = corner();
        let camera =
            Camera::look_at(DVec3::new(0.3, 0.8, 2.5), DVec3::new(0.0, 0.6, 0.0), DVec3::Y, 0.8).unwrap();
        let samples = WaveSamples { first: 0, count: 16 };
        let tile = Tile::all(16, 16).next().unwrap();
        for (sampler, estimator) in [Sampler::Sobol, Sampler::Independent]
            .into_iter()
            .flat_map(|s| [Estimator::Bsdf, Estimator::Light, Estimator::Mis].map(|e| (s, e)))
        {
            let settings = Settings { sampler, estimator, ..Settings::new(16, 16, 16) };
            let view = View { scene: &scene, camera: &camera, settings: &settings };
            let traced = SimdLevel::ALL.map(|level| {
                let mut wave = Wave { level: Level(level), ..Wave::default() };
                let counters = wave.trace(&view, tile, samples, || false);
                (counters, wave.radiance)
            });
            let lit = traced[0].1.iter().filter(|radiance| !radiance.is_black()).count();
            assert!(lit > 500, "{estimator:?}: {lit} samples are lit");
            assert!(traced.iter().all(|other| *other == traced[0]), "{sampler:?}, {estimator:?}");
        }
    }
}
