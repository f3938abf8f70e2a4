use super::counters::Counters;
use super::diffuse_vertex::irradiance_vertex;
use super::path_state::Path;
use super::preliminary::{prepare, train_guide};
use super::radiance_sums::{Contribution, Target};
use super::render_context::RenderContext;
use super::tile_probes::TileProbes;
use super::wavefront::{IRRADIANCE_PER_RADIANCE, Wavefront};
use crate::caught::caught;
use crate::pixel_rect::PixelRect;
use crate::worker_threads::run_in_threads;
use crate::{RenderError, Scene, Sensor, Settings};
use globillum_geom::{Accel, SurfacePoint};
use globillum_material::{Material, Rgb};
use std::fmt;
use std::ops::Range;

/// The path of one sample, traced again.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Replay {
    /// The path vertices, in order from the sensor.
    pub vertices: Vec<Vertex>,
    /// The radiance from the environment, if the path left the scene, times its throughput.
    pub environment: Rgb,
    /// The emission of lights that the sample's other camera rays find, if it has any
    /// ([`Supersampling`](crate::Supersampling)). What the path itself meets before its first diffuse vertex is then
    /// black, unless by way of more than eight mirrors.
    pub lights: Rgb,
    /// The radiance that the sample finds by itself: the sum over its vertices, the environment and the lights.
    pub alone: Rgb,
    /// The radiance of the sample, to the bit as in the picture. Differs from [`Replay::alone`] where the
    /// path shares its suffix or a caustic with those of other pixels, where the environment is a control variate, and where
    /// photons may guide to a caustic ([`PathReuse`](crate::PathReuse)).
    pub radiance: Rgb,
}

/// A path vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Vertex {
    /// The point on the triangle.
    pub point: SurfacePoint,
    /// The triangle's index; `None` for the point at which a path begins to measure irradiance
    /// ([`PathStart::Irradiance`](crate::PathStart)), a white surface that is not part of the scene.
    pub triangle: Option<u32>,
    /// The triangle's material.
    pub material: Material,
    /// The factor on what leaves the vertex back along the path: the product of `f cos / pdf` over the vertices before it,
    /// divided by the probabilities of surviving Russian roulette, and times pi if the path measures irradiance.
    pub throughput: Rgb,
    /// What the emission of the vertex adds to [`Replay::alone`].
    pub emitted: Rgb,
    /// What next event estimation at the vertex adds: the sum over its light samples that are not occluded.
    pub direct: Rgb,
    /// What next event estimation by way of mirrors adds: the sum over the samples of which neither the segment to the
    /// mirror nor the one from there to the light is occluded.
    pub mirrored: Rgb,
}

/// Traces sample `sample` of pixel (`x`, `y`) again, with the same sample of each pixel that reuses its path.
///
/// What a render does before its first sample is done again: it traces some thousand paths that decide how the picture is
/// sampled, and photons where caustics are shared, and it trains the guide with [`Guiding::Trained`](crate::Guiding).
///
/// # Errors
/// [`RenderError::Param`] for settings out of range, and for a pixel or a sample that the picture does not have.
/// [`RenderError::SensorSize`] for settings of another size than the sensor's. [`RenderError::Threads`] if no threads can
/// be started. [`RenderError::Worker`] for a panic in an accelerator or the sensor.
pub fn replay(
    scene: &Scene<dyn Accel + '_>,
    sensor: &dyn Sensor,
    settings: &Settings,
    (x, y): (u32, u32),
    sample: u32,
) -> Result<Replay, RenderError> {
    // Empty for `u32::MAX`, which no picture has as a sample.
    let samples = sample..sample.saturating_add(1);
    let replays = replay_samples(scene, sensor, settings, (x, y), samples)?;
    replays.into_iter().next().ok_or_else(|| not_a_sample(sample))
}

/// What [`replay`] returns for each of these samples of pixel (`x`, `y`), in order. What precedes them is done once.
///
/// # Errors
/// As those of [`replay`].
pub fn replay_samples(
    scene: &Scene<dyn Accel + '_>,
    sensor: &dyn Sensor,
    settings: &Settings,
    (x, y): (u32, u32),
    samples: Range<u32>,
) -> Result<Vec<Replay>, RenderError> {
    let settings = &settings.for_sensor(sensor)?;
    let within = [("x", x, settings.width, "[0, width)"), ("y", y, settings.height, "[0, height)")];
    if let Some((name, value, _, range)) = within.into_iter().find(|(_, value, end, _)| value >= end) {
        return Err(RenderError::Param { name, value: value.into(), range });
    }
    if !samples.is_empty() && samples.end > settings.samples {
        return Err(not_a_sample(samples.end - 1));
    }
    let work = || {
        let never = || false;
        let guide = train_guide(scene, sensor, settings, never)?.continue_value().flatten();
        let tile = PixelRect::square_around((x, y), [settings.width, settings.height]);
        let replays = || {
            let context = prepare(scene, sensor, settings, guide.as_ref(), never).continue_value()?;
            let probes = TileProbes::of(&context, tile);
            Some(samples.map(|sample| replay_within(&context, &probes, (x, y), sample)).collect())
        };
        let replays: Result<Option<Vec<Replay>>, String> = caught(replays);
        // Nothing cancels them, so there are some.
        replays.map(Option::unwrap_or_default).map_err(|message| RenderError::Worker {
            x: tile.x,
            y: tile.y,
            message,
        })
    };
    run_in_threads(settings.threads, work).map_err(RenderError::Threads)?
}

fn not_a_sample(sample: u32) -> RenderError {
    RenderError::Param { name: "sample", value: sample.into(), range: "[0, samples)" }
}

/// [`replay`], given what is done before the first sample and before those of the tile.
fn replay_within(
    context: &RenderContext<'_>,
    probes: &TileProbes,
    (x, y): (u32, u32),
    sample: u32,
) -> Replay {
    let one = sample..sample + 1;
    let pixel = probes.tile.index(x, y) as u32;
    let mut wavefront = Wavefront::default();
    wavefront.trace(context, probes, one.clone(), || false);
    let radiance = wavefront.radiance()[pixel as usize];
    let lights = wavefront.lights_seen_by(pixel);
    let mut replay =
        Replay { vertices: Vec::new(), environment: Rgb::BLACK, lights, alone: Rgb::BLACK, radiance };
    wavefront.start(context, probes, one);
    for bounce in 0.. {
        if !wavefront.step(context, pixel, bounce, &mut replay) {
            break;
        }
    }
    replay.alone += lights;
    replay
}

impl Wavefront {
    /// Advances all paths by one bounce and adds that of `sample` to `replay`, in the order in which
    /// [`Wavefront::trace`] adds; `false` if its path has ended.
    fn step(&mut self, context: &RenderContext<'_>, sample: u32, bounce: u32, replay: &mut Replay) -> bool {
        let find = |paths: &[Path]| paths.iter().position(|path| path.target.sample() == sample);
        let (on_ray, from_point) = (find(&self.paths), find(&self.from_points));
        let Some(path) =
            on_ray.map(|i| self.paths[i]).or(from_point.filter(|_| bounce == 0).map(|i| self.from_points[i]))
        else {
            return false;
        };
        let unit = from_point.map_or(1.0, |_| IRRADIANCE_PER_RADIANCE);
        let ray = on_ray.map(|i| self.rays[i]);
        // Sums that begin at zero hold the radiance of this bounce alone.
        self.radiance.reset(self.radiance.samples.len(), self.radiance.after_prefixes.len());
        self.caustics.clear();
        self.shade(context, bounce, &mut Counters::default());
        let hit = on_ray.and_then(|i| self.hits[i]);
        let throughput_before = self.prefixes.throughput_before(path.target) * unit;
        let emitted = self.emission_found(&path, unit);
        replay.alone += emitted;
        let at = match (ray.zip(hit), from_point) {
            (Some((ray, hit)), _) => context.scene.interaction(&ray, &hit),
            (None, Some(i)) if bounce == 0 => irradiance_vertex(self.points[i]),
            _ => {
                replay.environment = emitted;
                return true;
            }
        };
        let direct_count = self.trace_light_samples(context);
        let [direct, mirrored] = self.found_by_light_samples(sample, direct_count, unit);
        replay.alone += direct;
        replay.alone += mirrored;
        replay.vertices.push(Vertex {
            point: at.point,
            triangle: hit.map(|hit| hit.triangle),
            material: *at.material,
            throughput: throughput_before * path.throughput,
            emitted,
            direct,
            mirrored,
        });
        true
    }

    /// The emission that a path has found at this bounce, times `unit`.
    fn emission_found(&mut self, path: &Path, unit: f64) -> Rgb {
        let sample = path.target.sample();
        // In the sum of the suffix, too, if it is the environment.
        let of_suffix = self.radiance.after_prefix(sample);
        // What a path finds of lights by way of mirrors after its prefix is in the sum of its sample.
        let of_sample = self.radiance.samples[sample as usize] * unit;
        let throughput = self.prefixes.throughput_before(Target::AfterPrefix(sample)) * unit;
        throughput * (of_suffix + self.caustics.found_by(sample)) + of_sample
    }

    /// What the light samples of a path have found at this bounce, times `unit`: directly, which are the first
    /// `direct_count` contributions, and by way of mirrors.
    fn found_by_light_samples(&self, sample: u32, direct_count: usize, unit: f64) -> [Rgb; 2] {
        let unoccluded = |i: Range<usize>| i.filter(|&i| !self.occluded[i]).map(|i| &self.contributions[i]);
        let add = |sum: Rgb, contribution: &Contribution| match contribution.target.sample() == sample {
            true => sum + self.prefixes.throughput_before(contribution.target) * unit * contribution.radiance,
            false => sum,
        };
        let in_large_mirrors = unoccluded(direct_count..self.contributions.len());
        let direct = unoccluded(0..direct_count).fold(Rgb::BLACK, add);
        [direct, in_large_mirrors.chain(&self.small_mirror_rays.found).fold(Rgb::BLACK, add)]
    }
}

impl fmt::Display for Replay {
    /// One line per vertex, and the sums.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, vertex) in (1..).zip(&self.vertices) {
            let Vertex { point, triangle, material, throughput, emitted, direct, mirrored } = vertex;
            let on = triangle.map_or("no triangle".into(), |index| format!("triangle {index}"));
            writeln!(f, "{i}: {} on {on}, {:?}", point.position, material.bsdf)?;
            writeln!(
                f,
                "   throughput {throughput}, emitted {emitted}, direct {direct}, mirrored {mirrored}"
            )?;
        }
        if !self.environment.is_black() {
            writeln!(f, "environment {}", self.environment)?;
        }
        if !self.lights.is_black() {
            writeln!(f, "lights {}", self.lights)?;
        }
        writeln!(f, "alone {}", self.alone)?;
        writeln!(f, "radiance {}", self.radiance)
    }
}
