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
    /// The sample's radiance, to the bit what the picture got.
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

/// Traces sample `sample` of pixel (`x`, `y`) of a picture alone, and tells what it met.
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
    let tile = Tile { x, y, width: 1, height: 1 };
    let mut wave = Wave::default();
    wave.start(camera, settings, tile, WaveSamples { first: sample, count: 1 });
    let mut replay = Replay { vertices: Vec::new(), environment: Rgb::BLACK, radiance: Rgb::BLACK };
    let view = View { scene, camera, settings };
    for bounce in 0.. {
        let Some(step) = wave.step_alone(&view, bounce) else { break };
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
                self.radiance += vertex.emitted;
                self.radiance += vertex.direct;
                self.radiance += vertex.mirrored;
                self.vertices.push(vertex);
            }
            Step::Left(environment) => {
                self.radiance += environment;
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
        self.radiance[0] = Rgb::BLACK;
        self.find_hits(view);
        self.shade(view, bounce, &mut Counters::default());
        let emitted = self.radiance[0];
        let Some(hit) = self.hits[0] else { return Some(Step::Left(emitted)) };
        // What mirrors throw comes after the rest.
        let direct_count = self.arriving.len();
        self.reflect(view);
        self.find_light(view);
        let brought = |arriving: Range<usize>| {
            let unoccluded = arriving.filter(|&i| !self.occluded[i]);
            unoccluded.fold(Rgb::BLACK, |sum, i| sum + self.arriving[i].radiance)
        };
        let at = view.scene.interaction(&ray, &hit);
        Some(Step::Met(Vertex {
            point: at.point,
            triangle: hit.triangle,
            material: *at.material,
            throughput: path.throughput,
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
        writeln!(f, "radiance {}", self.radiance)
    }
}
