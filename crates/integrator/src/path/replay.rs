use super::counters::Counters;
use super::job::{View, WaveSamples};
use super::tile::Tile;
use super::wavefront::Wave;
use crate::{Camera, RenderError, Scene, Settings};
use globillum_geom::{Accel, SurfacePoint};
use globillum_material::{Material, Rgb};
use std::fmt;
use std::ops::Range;

/// The path of one sample, traced once more.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Replay {
    /// Where the path met a surface, in order from the camera.
    pub vertices: Vec<Vertex>,
    /// What arrives from the environment, if that is where the path ended; already weighted.
    pub environment: Rgb,
    /// What the path brings by itself: the sum of all that.
    pub alone: Rgb,
    /// The sample's radiance, to the bit what the picture got: differs from [`Replay::alone`] where the
    /// path shares what it found with those of other pixels, and they with it
    /// ([`PathReuse`](crate::PathReuse)).
    pub radiance: Rgb,
}

/// A point at which a path met a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Vertex {
    /// The point on the triangle.
    pub point: SurfacePoint,
    /// The triangle's index.
    pub triangle: u32,
    /// What the triangle is made of.
    pub material: Material,
    /// The factor on what leaves the vertex toward the one before it: products of `f cos / pdf`,
    /// divided by the chances of surviving.
    pub throughput: Rgb,
    /// What the vertex's own emission adds to [`Replay::alone`].
    pub emitted: Rgb,
    /// What the light sample taken at the vertex adds to it; black if it was occluded.
    pub direct: Rgb,
    /// What the light sample taken there in a plane mirror adds; black if either of its segments, to
    /// the mirror and from it to the light, was occluded.
    pub mirrored: Rgb,
}

/// Traces sample `sample` of pixel (`x`, `y`) of a picture again, and tells what it met; of the pixels with
/// which it shares paths, the same sample is traced too.
///
/// # Errors
/// [`RenderError::Param`] for settings out of range, and for a pixel or a sample that the picture
/// does not have.
pub fn replay<A: Accel>(
    scene: &Scene<A>,
    camera: &Camera,
    settings: &Settings,
    (x, y): (u32, u32),
    sample: u32,
) -> Result<Replay, RenderError> {
    settings.validate()?;
    let within = [
        ("x", x, settings.width, "[0, width)"),
        ("y", y, settings.height, "[0, height)"),
        ("sample", sample, settings.samples, "[0, samples)"),
    ];
    if let Some((name, value, _, range)) = within.into_iter().find(|(_, value, end, _)| value >= end) {
        return Err(RenderError::Param { name, value: value.into(), range });
    }
    let view = View { scene, camera, settings };
    let one = WaveSamples { first: sample, count: 1 };
    // Together with all pixels with which it shares what is found.
    let block = Tile::block_around(x, y, settings.width, settings.height);
    let place = (y - block.y) * block.width + (x - block.x);
    let mut wave = Wave::default();
    // Nothing cancels it.
    wave.trace(&view, block, one, || false);
    let radiance = wave.radiance[place as usize];
    let mut replay = Replay { vertices: Vec::new(), environment: Rgb::BLACK, alone: Rgb::BLACK, radiance };
    wave.start(&view, block, one);
    for bounce in 0.. {
        let Some(step) = wave.step(&view, place, bounce) else { break };
        replay.add(step);
    }
    Ok(replay)
}

/// What one bounce came to.
enum Step {
    Met(Vertex),
    /// The environment, and what arrives from there.
    Left(Rgb),
}

impl Replay {
    /// Adds up as the wave does: first what is emitted, then what the light samples bring.
    fn add(&mut self, step: Step) {
        match step {
            Step::Met(vertex) => {
                self.alone += vertex.emitted;
                self.alone += vertex.direct;
                self.alone += vertex.mirrored;
                self.vertices.push(vertex);
            }
            Step::Left(environment) => {
                self.alone += environment;
                self.environment = environment;
            }
        }
    }
}

impl Wave {
    /// Takes all paths through one bounce, and tells what `sample` met; `None` if its path has ended.
    fn step<A: Accel>(&mut self, view: &View<'_, A>, sample: u32, bounce: u32) -> Option<Step> {
        let i = self.paths.iter().position(|path| self.stems.sample(path.account) == sample)?;
        let (path, ray) = (self.paths[i], self.rays[i]);
        // What the wave adds to nothing is what this bounce adds.
        self.radiance.fill(Rgb::BLACK);
        self.find_hits(view);
        let hit = self.hits[i];
        self.shade(view, bounce, &mut Counters::default());
        let emitted = self.stems.before(path.account) * self.radiance[path.account as usize];
        let Some(hit) = hit else { return Some(Step::Left(emitted)) };
        // What mirrors throw comes after the rest.
        let direct_count = self.arriving.len();
        self.reflect(view);
        self.find_light(view);
        let brought = |arriving: Range<usize>| {
            let unoccluded = arriving.filter(|&i| !self.occluded[i]).map(|i| &self.arriving[i]);
            let own = unoccluded.filter(|light| self.stems.sample(light.account) == sample);
            own.fold(Rgb::BLACK, |sum, light| sum + self.stems.before(light.account) * light.radiance)
        };
        let at = view.scene.interaction(&ray, &hit);
        Some(Step::Met(Vertex {
            point: at.point,
            triangle: hit.triangle,
            material: *at.material,
            throughput: self.stems.before(path.account) * path.throughput,
            emitted,
            direct: brought(0..direct_count),
            mirrored: brought(direct_count..self.arriving.len()),
        }))
    }
}

impl fmt::Display for Replay {
    /// One line a vertex, and one with the sum.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, vertex) in (1..).zip(&self.vertices) {
            let Vertex { point, triangle, material, throughput, emitted, direct, mirrored } = vertex;
            writeln!(f, "{i}: {} on triangle {triangle}, {:?}", point.position, material.bsdf)?;
            writeln!(
                f,
                "   throughput {throughput}, emitted {emitted}, direct {direct}, mirrored {mirrored}"
            )?;
        }
        if !self.environment.is_black() {
            writeln!(f, "environment {}", self.environment)?;
        }
        writeln!(f, "alone {}", self.alone)?;
        writeln!(f, "radiance {}", self.radiance)
    }
}
