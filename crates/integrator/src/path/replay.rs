use super::Counters;
use super::wave::{View, Wave, WaveSamples};
use crate::tile::Tile;
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
    /// What the vertex's own emission adds to the sample.
    pub emitted: Rgb,
    /// What the light sample taken at the vertex adds to the sample; black if it was occluded.
    pub direct: Rgb,
    /// What the light sample taken there in a plane mirror adds; black if either of its segments, to
    /// the mirror and from it to the light, was occluded.
    pub mirrored: Rgb,
}

/// Traces sample `sample` of pixel (`x`, `y`) of a picture again, and tells what it met.
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
    let samples = WaveSamples { first: sample, count: 1 };
    let radiance = view.shared_radiance((x, y), samples);
    let black = Rgb::BLACK;
    let mut replay = Replay { vertices: Vec::new(), environment: black, alone: black, radiance };
    let mut wave = Wave::default();
    wave.start(&view, Tile { x, y, width: 1, height: 1 }, samples);
    for bounce in 0.. {
        let Some(step) = wave.step_alone(&view, bounce) else { break };
        replay.add(step);
    }
    Ok(replay)
}

impl<A: Accel> View<'_, A> {
    /// The radiance of one sample, after all pixels with which it shares have been traced.
    fn shared_radiance(&self, (x, y): (u32, u32), sample: WaveSamples) -> Rgb {
        let block = Tile::block_around(x, y, self.settings.width, self.settings.height);
        let mut wave = Wave::default();
        // Nothing cancels it.
        wave.trace(self, block, sample, || false);
        wave.radiance[((y - block.y) * block.width + (x - block.x)) as usize]
    }
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
    /// Takes the only path through one bounce; `None` if it has ended.
    fn step_alone<A: Accel>(&mut self, view: &View<'_, A>, bounce: u32) -> Option<Step> {
        let (path, ray) = (*self.paths.first()?, *self.rays.first()?);
        // What the wave adds to nothing is what this bounce adds.
        self.radiance.fill(Rgb::BLACK);
        self.find_hits(view);
        self.shade(view, bounce, &mut Counters::default());
        let emitted = path.before * self.radiance[path.account as usize];
        let Some(hit) = self.hits[0] else { return Some(Step::Left(emitted)) };
        // What mirrors throw comes after the rest.
        let direct_count = self.arriving.len();
        self.reflect(view);
        self.find_light(view);
        let brought = |arriving: Range<usize>| {
            let unoccluded = arriving.filter(|&i| !self.occluded[i]).map(|i| &self.arriving[i]);
            unoccluded.fold(Rgb::BLACK, |sum, light| {
                let of_tail = light.account > 0;
                let before = if of_tail { self.stems.throughput(0) } else { Rgb::WHITE };
                sum + before * light.radiance
            })
        };
        let at = view.scene.interaction(&ray, &hit);
        Some(Step::Met(Vertex {
            point: at.point,
            triangle: hit.triangle,
            material: *at.material,
            throughput: path.before * path.throughput,
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
