//! Where lights are supersampled: where neighbouring pixels see different emission.
//!
//! Which pixels these are depends on probes at fixed places, never on samples, so the mean is that of one camera ray
//! per sample.

use super::emission_rays::{EmissionRays, FoundEmission, max_reflections};
use super::render_context::RenderContext;
use super::tile_bounds::Tile;
use crate::{PathStart, Settings};
use glam::DVec3;
use globillum_material::Rgb;

/// Probes along each side of a pixel.
const PROBES: u32 = 4;

/// The same of a pixel that sees a curved mirror, in which lights look small.
const PROBES_OF_MIRRORS: u32 = 8;

/// How many times farther apart than camera rays the rays of a pixel are that a curved mirror has reflected.
const SPREAD: f64 = 2.0;

/// Pixels whose probes are traced at once.
const PIXELS_AT_ONCE: usize = 16;

/// The pixels of a tile that may see the edge of a light, as indices into [`Tile::pixels`], in ascending order.
#[derive(Debug, Default)]
pub(crate) struct LightEdges {
    pub(super) pixels: Vec<u32>,
}

/// Camera rays at fixed places of some pixels.
#[derive(Debug, Default)]
struct Probes {
    rays: EmissionRays,
    /// What each has found, pixel by pixel.
    emission: Vec<Rgb>,
    /// The direction of each, from the camera and from the last mirror.
    directions: Vec<[DVec3; 2]>,
    /// How many each pixel has.
    count: usize,
}

impl LightEdges {
    /// Finds them by probes in the tile and in the pixels around it.
    pub(crate) fn of(context: &RenderContext<'_>, tile: Tile) -> Self {
        if !context.supersamples_lights() {
            return Self::default();
        }
        let Settings { width, height, .. } = *context.settings;
        let around = tile.grown(width, height);
        let seen = emission_seen(context, around);
        let differs = |(x, y): (u32, u32)| {
            let own = seen[around.index(x, y)];
            let near = Tile { x, y, width: 1, height: 1 }.grown(width, height);
            own.is_none() || near.pixels().any(|(x, y)| seen[around.index(x, y)] != own)
        };
        let pixels = (0..).zip(tile.pixels()).filter(|&(_, pixel)| differs(pixel)).map(|(i, _)| i).collect();
        Self { pixels }
    }
}

/// The emission that each pixel of the tile sees; `None` if its probes do not all see the same.
fn emission_seen(context: &RenderContext<'_>, tile: Tile) -> Vec<Option<Rgb>> {
    let pixels: Vec<_> = tile.pixels().collect();
    let mut probes = Probes::default();
    let mut seen = Vec::with_capacity(pixels.len());
    let mut in_curved_mirrors = Vec::new();
    for chunk in pixels.chunks(PIXELS_AT_ONCE) {
        probes.trace(context, chunk.iter().copied(), PROBES);
        for i in 0..chunk.len() {
            let emission = probes.emission(i);
            if emission.is_some() && probes.are_spread(i) {
                in_curved_mirrors.push(seen.len());
            }
            seen.push(emission);
        }
    }
    for chunk in in_curved_mirrors.chunks(PIXELS_AT_ONCE) {
        probes.trace(context, chunk.iter().map(|&pixel| pixels[pixel]), PROBES_OF_MIRRORS);
        for (i, &pixel) in chunk.iter().enumerate() {
            seen[pixel] = seen[pixel].filter(|_| probes.emission(i) == seen[pixel]);
        }
    }
    seen
}

impl Probes {
    /// Traces `side` x `side` probes of each pixel.
    fn trace(&mut self, context: &RenderContext<'_>, pixels: impl Iterator<Item = (u32, u32)>, side: u32) {
        self.emission.clear();
        self.directions.clear();
        self.count = (side * side) as usize;
        for pixel in pixels {
            for probe in 0..side * side {
                let u = [probe % side, probe / side].map(|k| (f64::from(k) + 0.5) / f64::from(side));
                let start = context.path_start(pixel, u);
                let direction = if let PathStart::Ray(ray) = start { ray.direction } else { DVec3::ZERO };
                self.rays.push_start(start, self.emission.len() as u32);
                self.emission.push(Rgb::BLACK);
                self.directions.push([direction; 2]);
            }
        }
        let Self { rays, emission, directions, .. } = self;
        let add = |found: FoundEmission<'_>| emission[found.target as usize] += found.radiance;
        let reflect = |probe: u32, direction| directions[probe as usize][1] = direction;
        rays.trace(context, max_reflections(context), add, reflect);
    }

    /// What the probes of pixel `i` have found, if all have found the same.
    fn emission(&self, i: usize) -> Option<Rgb> {
        let emission = &self.emission[i * self.count..][..self.count];
        emission.iter().all(|other| *other == emission[0]).then_some(emission[0])
    }

    /// Whether mirrors spread the probes of pixel `i`. Flat ones keep the angles between them.
    fn are_spread(&self, i: usize) -> bool {
        let directions = &self.directions[i * self.count..][..self.count];
        let [from_camera, last] = [0, 1].map(|k| {
            let squares = directions.iter().map(|of| (of[k] - directions[0][k]).length_squared());
            squares.fold(0.0, f64::max)
        });
        last > SPREAD * SPREAD * from_camera
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, Model, Scene};
    use globillum_geom::conformance::shapes::{icosphere, quad};
    use globillum_geom::{KdOptions, KdTree, Triangle};
    use globillum_material::Material;

    const TILE: Tile = Tile { x: 0, y: 0, width: 16, height: 16 };

    /// A light behind the camera, and a mirror in front of it.
    fn scene(mirror: Vec<Triangle>) -> Scene<KdTree> {
        let p = |x, y| DVec3::new(x, y, 6.0);
        let mut model = Model::default();
        model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), mirror);
        let light = quad(p(1.0, 1.0), p(1.0, 1.6), p(1.6, 1.6), p(1.6, 1.0));
        model.add(Material::light(Rgb::splat(3.0)).unwrap(), light);
        Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap()
    }

    /// Balls in rows, between which light is reflected several times.
    fn balls() -> Vec<Triangle> {
        let places = (0..4).flat_map(|y| (0..4).map(move |x| [x, y].map(|k| 0.5 * f64::from(k) - 0.75)));
        let ball = icosphere(4);
        places.flat_map(|[x, y]| ball.clone().placed(0.24, DVec3::new(x, y, 0.0)).triangles()).collect()
    }

    /// A square of 16 x 16 squares.
    fn wall() -> Vec<Triangle> {
        let corner = |x: i32, y: i32| DVec3::new(f64::from(x) / 8.0, f64::from(y) / 8.0, 0.0);
        let squares = (-8..8).flat_map(|y| (-8..8).map(move |x| (x, y)));
        squares
            .flat_map(|(x, y)| quad(corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)))
            .collect()
    }

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y, 0.4).unwrap()
    }

    /// The variance of one camera ray in each pixel, as 32 x 32 of them tell.
    fn variances(context: &RenderContext<'_>) -> Vec<f64> {
        const SIDE: u32 = 32;
        let mut probes = Probes::default();
        let variance = |pixel| {
            probes.trace(context, std::iter::once(pixel), SIDE);
            let mean = |f: fn(f64) -> f64| {
                probes.emission.iter().map(|emission| f(emission.g)).sum::<f64>() / f64::from(SIDE * SIDE)
            };
            mean(|x| x * x) - mean(|x| x) * mean(|x| x)
        };
        TILE.pixels().map(variance).collect()
    }

    /// Of what the balls show, four by four probes a pixel alone find 2 %.
    #[test]
    fn reflections_of_lights_in_curved_mirrors_are_found() {
        let (scene, camera, settings) = (scene(balls()), camera(), Settings::new(16, 16, 1));
        let context = RenderContext::new(&scene, &camera, &settings);
        let variances = variances(&context);
        let edges = LightEdges::of(&context, TILE).pixels;
        let found: f64 = edges.iter().map(|&pixel| variances[pixel as usize]).sum();
        let all: f64 = variances.iter().sum();
        assert!(all > 1.0 && found > 0.6 * all, "{found} of {all}");
        assert!(edges.len() < TILE.pixel_count() / 2, "{} pixels", edges.len());
    }

    #[test]
    fn flat_mirrors_spread_no_rays() {
        let (camera, settings) = (camera(), Settings::new(16, 16, 1));
        let spread = |mirror| {
            let scene = scene(mirror);
            let context = RenderContext::new(&scene, &camera, &settings);
            let mut probes = Probes::default();
            probes.trace(&context, TILE.pixels(), PROBES);
            (0..TILE.pixel_count()).filter(|&pixel| probes.are_spread(pixel)).count()
        };
        assert_eq!(spread(wall()), 0);
        assert!(spread(balls()) > 150);
    }
}
