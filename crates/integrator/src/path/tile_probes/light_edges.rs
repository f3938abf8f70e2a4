//! Where lights are supersampled: where neighbouring pixels, or points of one pixel, see different emission.
//!
//! Which pixels these are depends on probes at fixed places, never on samples, so the mean is that of one camera ray
//! per sample.

use crate::PathStart;
use crate::path::emission_rays::{EmissionRays, FoundEmission};
use crate::path::mirrors_left::mirrors_left;
use crate::path::render_context::RenderContext;
use crate::pixel_rect::PixelRect;
use crate::scene::unit;
use glam::DVec3;
use globillum_material::Rgb;

/// Probes along each side of a pixel.
const PROBES_PER_SIDE: u32 = 4;

/// Probes along each side of a pixel that sees a curved mirror, in which lights look small.
const PROBES_OF_MIRRORS: u32 = 8;

/// The same if the unit direction of a probe is more than [`WIDE_DISTANCE`] from that of the first one after the last mirror.
const PROBES_OF_WIDE_MIRRORS: u32 = 16;
const WIDE_DISTANCE: f64 = 0.6;

/// A pixel sees a curved mirror if the directions of its probes are this many times farther apart after the last mirror
/// than before the first, and by an angle of more than [`MIN_ANGLE`] in radians.
const SPREAD: f64 = 2.0;
/// More than what rounding makes of the normals of triangles in one plane.
const MIN_ANGLE: f64 = 1e-6;

/// Pixels whose probes are traced at once.
const PIXELS_AT_ONCE: usize = 16;

/// Points of lights at which probes are traced at once.
const POINTS_AT_ONCE: usize = 256;

/// The pixels of a tile that may see the edge of a light, as indices into [`PixelRect::pixels`], in ascending order.
#[derive(Debug, Default)]
pub(crate) struct LightEdges {
    /// Those that see no curved mirror.
    pub(in crate::path) plain: Vec<u32>,
    pub(in crate::path) in_curved_mirrors: Vec<u32>,
}

/// What a pixel sees.
#[derive(Clone, Copy, Debug)]
struct Seen {
    /// The emission that all of its probes find; `None` if they do not find the same.
    emission: Option<Rgb>,
    /// How many probes along each side it needs; more than [`PROBES_PER_SIDE`] if it sees a curved mirror.
    side: u32,
}

/// Camera rays at fixed places of some pixels.
#[derive(Debug, Default)]
struct Probes {
    rays: EmissionRays,
    /// What each has found.
    emission: Vec<Rgb>,
    /// The unit direction of each, from the camera and from the last mirror; `None` if there is no ray.
    directions: Vec<Option<[DVec3; 2]>>,
    /// How many each pixel has, of those in a grid.
    count: usize,
}

impl LightEdges {
    /// Finds them by probes in the tile and in the pixels around it.
    pub(crate) fn of(context: &RenderContext<'_>, tile: PixelRect) -> Self {
        if !context.supersamples_lights() {
            return Self::default();
        }
        let size = [context.settings.width, context.settings.height];
        let around = tile.grown(size);
        let seen = seen_by(context, around);
        let mut edges = Self::default();
        for (i, (x, y)) in (0..).zip(tile.pixels()) {
            let own = seen[around.index(x, y)];
            let mut near = PixelRect::pixels_near((x, y), size);
            let differs = |(x, y)| seen[around.index(x, y)].emission != own.emission;
            if own.emission.is_none() || near.any(differs) {
                let pixels =
                    if own.side > PROBES_PER_SIDE { &mut edges.in_curved_mirrors } else { &mut edges.plain };
                pixels.push(i);
            }
        }
        edges
    }

    /// Whether a pixel is one of them.
    pub(in crate::path) fn contain(&self, pixel: u32) -> bool {
        [&self.plain, &self.in_curved_mirrors].into_iter().any(|pixels| pixels.binary_search(&pixel).is_ok())
    }
}

/// What each pixel of the tile sees.
fn seen_by(context: &RenderContext<'_>, tile: PixelRect) -> Vec<Seen> {
    let pixels: Vec<_> = tile.pixels().collect();
    let mut probes = Probes::default();
    let mut seen = Vec::with_capacity(pixels.len());
    for chunk in pixels.chunks(PIXELS_AT_ONCE) {
        probes.trace(context, chunk.iter().copied(), PROBES_PER_SIDE);
        let of_pixel = |i| Seen { emission: probes.common_emission(i), side: probes.side_needed(i) };
        seen.extend((0..chunk.len()).map(of_pixel));
    }
    for side in [PROBES_OF_MIRRORS, PROBES_OF_WIDE_MIRRORS] {
        let is_open = |&i: &usize| seen[i].side == side && seen[i].emission.is_some();
        let open: Vec<usize> = (0..seen.len()).filter(is_open).collect();
        for chunk in open.chunks(PIXELS_AT_ONCE) {
            probes.trace(context, chunk.iter().map(|&i| pixels[i]), side);
            for (i, &pixel) in chunk.iter().enumerate() {
                let Seen { emission, .. } = &mut seen[pixel];
                *emission = emission.filter(|_| probes.common_emission(i) == *emission);
            }
        }
    }
    let points: Vec<_> = context.light_points.within(tile).collect();
    for chunk in points.chunks(POINTS_AT_ONCE) {
        let is_open = |&&((x, y), _): &&((u32, u32), _)| seen[tile.index(x, y)].emission.is_some();
        let open: Vec<_> = chunk.iter().filter(is_open).collect();
        probes
            .trace_starts(context, open.iter().map(|&&(pixel, offset)| context.element_start(pixel, offset)));
        for (&&((x, y), _), found) in open.iter().zip(&probes.emission) {
            let Seen { emission, .. } = &mut seen[tile.index(x, y)];
            *emission = emission.filter(|emission| emission == found);
        }
    }
    seen
}

impl Probes {
    /// Traces a grid of `side` x `side` probes of each pixel, pixel by pixel.
    fn trace(&mut self, context: &RenderContext<'_>, pixels: impl Iterator<Item = (u32, u32)>, side: u32) {
        self.count = (side * side) as usize;
        let place = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
        let of_pixel = |pixel| {
            let probe = move |probe: u32| context.path_start(pixel, [probe % side, probe / side].map(place));
            (0..side * side).map(probe)
        };
        self.trace_starts(context, pixels.flat_map(of_pixel));
    }

    /// Traces the probes that begin there.
    fn trace_starts(&mut self, context: &RenderContext<'_>, starts: impl Iterator<Item = PathStart>) {
        self.emission.clear();
        self.directions.clear();
        for start in starts {
            self.rays.push_start(start, self.emission.len() as u32);
            self.emission.push(Rgb::BLACK);
            self.directions.push(match start {
                PathStart::Ray(ray) if start.is_valid() => Some([unit(ray.direction); 2]),
                _ => None,
            });
        }
        let Self { rays, emission, directions, .. } = self;
        let add = |found: FoundEmission<'_>| emission[found.tag as usize] += found.radiance;
        let reflect = |probe: u32, direction| {
            if let Some([_, last]) = &mut directions[probe as usize] {
                *last = direction;
            }
        };
        rays.trace(context, mirrors_left(context.settings, 0), add, reflect);
    }

    /// What the probes of pixel `i` have found, if all have found the same.
    fn common_emission(&self, i: usize) -> Option<Rgb> {
        let emission = &self.emission[i * self.count..][..self.count];
        emission.iter().all(|other| *other == emission[0]).then_some(emission[0])
    }

    /// How many probes along each side pixel `i` needs, by how far mirrors spread those that it has. Flat mirrors keep the
    /// angles between them; only at their edges some probes are reflected and some are not.
    fn side_needed(&self, i: usize) -> u32 {
        let mut directions = self.directions[i * self.count..][..self.count].iter().flatten();
        let Some(first) = directions.next() else { return PROBES_PER_SIDE };
        let [from_camera, last] = [0, 1].map(|k| {
            let squares = directions.clone().map(|other| (other[k] - first[k]).length_squared());
            squares.fold(0.0, f64::max)
        });
        let is_spread = last > (SPREAD * SPREAD * from_camera).max(MIN_ANGLE * MIN_ANGLE);
        match is_spread {
            false => PROBES_PER_SIDE,
            true if last <= WIDE_DISTANCE * WIDE_DISTANCE => PROBES_OF_MIRRORS,
            true => PROBES_OF_WIDE_MIRRORS,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::test_rooms::built;
    use crate::{ElementSample, Model, OrthographicCamera, PinholeCamera, Scene, Sensor, Settings};
    use globillum_geom::conformance::shapes::{icosphere, quad};
    use globillum_geom::{KdTree, Ray, Triangle};
    use globillum_material::Material;
    use std::hash::Hasher;

    const TILE: PixelRect = PixelRect { x: 0, y: 0, width: 16, height: 16 };

    /// A light behind the camera, and a mirror in front of it.
    fn scene(mirror: Vec<Triangle>) -> Scene<KdTree> {
        let p = |x, y| DVec3::new(x, y, 6.0);
        let mut model = Model::default();
        model.add(Material::mirror(Rgb::splat(0.9)).unwrap(), mirror);
        let light = quad(p(1.0, 1.0), p(1.0, 1.6), p(1.6, 1.6), p(1.6, 1.0));
        model.add(Material::light(Rgb::splat(3.0)).unwrap(), light);
        built(model)
    }

    /// Balls in rows, between which light is reflected several times.
    fn balls() -> Vec<Triangle> {
        let places = (0..4).flat_map(|y| (0..4).map(move |x| [x, y].map(|k| 0.5 * f64::from(k) - 0.75)));
        let ball = icosphere(4);
        places.flat_map(|[x, y]| ball.clone().placed(0.24, DVec3::new(x, y, 0.0)).triangles()).collect()
    }

    /// A wall of 16 x 16 squares, aslant.
    fn wall() -> Vec<Triangle> {
        let corner =
            |x: i32, y: i32| DVec3::new(f64::from(x) / 8.0, f64::from(y) / 8.0, f64::from(x + 2 * y) / 56.0);
        let squares = (-8..8).flat_map(|y| (-8..8).map(move |x| (x, y)));
        squares
            .flat_map(|(x, y)| quad(corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)))
            .collect()
    }

    fn camera() -> PinholeCamera {
        PinholeCamera::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, DVec3::Y, 0.4).unwrap()
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

    /// Four by four probes a pixel alone find 2 % of the variance of what the balls show, eight by eight 65 %.
    #[test]
    fn reflections_of_lights_in_curved_mirrors_are_found() {
        let (scene, camera, settings) = (scene(balls()), camera(), Settings::new(16, 16, 1));
        let context = RenderContext::new(&scene, &camera, &settings);
        let variances = variances(&context);
        let LightEdges { plain, in_curved_mirrors } = LightEdges::of(&context, TILE);
        let found: f64 = in_curved_mirrors.iter().map(|&pixel| variances[pixel as usize]).sum();
        let all: f64 = variances.iter().sum();
        assert!(all > 1.0 && found > 0.9 * all, "{found} of {all}");
        let count = plain.len() + in_curved_mirrors.len();
        assert!(count < TILE.pixel_count() * 4 / 5, "{count} pixels");
    }

    /// A camera with directions of this length.
    #[derive(Debug)]
    struct WithLength(PinholeCamera, f64);

    impl Sensor for WithLength {
        fn start(&self, sample: &ElementSample) -> PathStart {
            match self.0.start(sample) {
                PathStart::Ray(ray) => PathStart::Ray(Ray::new(ray.origin, ray.direction * self.1)),
                other => other,
            }
        }

        fn hash(&self, key: &mut dyn Hasher) {
            self.0.hash(key);
        }
    }

    #[test]
    fn the_length_of_directions_does_not_matter() {
        let (scene, settings) = (scene(balls()), Settings::new(16, 16, 1));
        let edges = |length| {
            let sensor = WithLength(camera(), length);
            LightEdges::of(&RenderContext::new(&scene, &sensor, &settings), TILE).in_curved_mirrors
        };
        assert!(edges(1.0).len() > 50);
        assert_eq!(edges(1.0), edges(1024.0));
        assert_eq!(edges(1.0), edges(2.0_f64.powi(-500)));
    }

    #[test]
    fn flat_mirrors_spread_no_rays() {
        let settings = Settings::new(16, 16, 1);
        let parallel =
            OrthographicCamera::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::new(0.1, 0.2, 0.0), DVec3::Y, 1.0);
        let parallel = parallel.unwrap();
        let spread = |mirror, sensor: &dyn Sensor| {
            let scene = scene(mirror);
            let context = RenderContext::new(&scene, sensor, &settings);
            let mut probes = Probes::default();
            probes.trace(&context, TILE.pixels(), PROBES_PER_SIDE);
            (0..TILE.pixel_count()).filter(|&pixel| probes.side_needed(pixel) > PROBES_PER_SIDE).count()
        };
        for sensor in [&camera() as &dyn Sensor, &parallel] {
            assert_eq!(spread(wall(), sensor), 0);
            assert!(spread(balls(), sensor) > 150);
        }
    }
}
