//! Scenes for tests, above all of caustics and path reuse between mirrors, and their paths.

use super::counters::Counters;
use super::preliminary::photon_guide;
use super::tile_probes::LightEdges;
use super::{RenderContext, TileProbes, Wavefront, train_guide};
use crate::guide::{Guide, PhotonGuide};
use crate::pixel_rect::PixelRect;
use crate::{ElementSample, Guiding, Model, PathStart, PinholeCamera, Scene, Sensor, Settings};
use glam::DVec3;
use globillum_geom::conformance::shapes::{icosphere, quad};
use globillum_geom::{KdTree, Triangle};
use globillum_material::{Emission, Material, Rgb, Sides};
use std::hash::Hasher;

pub(super) const TILE: PixelRect = PixelRect { x: 0, y: 0, width: 13, height: 16 };

/// A floor of colours without blue or red between mirrors, flat, curved and emitting, and a light of this size. The
/// camera sees parts of the floor in a mirror.
pub(super) fn room(size: f64) -> Scene<KdTree> {
    built(room_model(size))
}

pub(super) fn built(model: Model) -> Scene<KdTree> {
    Scene::build(model, KdTree::build).unwrap()
}

/// The room with a wall that the floor sees, and that sees the light in mirrors.
pub(super) fn room_with_wall() -> Scene<KdTree> {
    let (p, mut model) = (DVec3::new, room_model(0.6));
    let wall = quad(p(0.9, 0.0, 1.0), p(0.9, 1.2, 1.0), p(0.9, 1.2, -0.9), p(0.9, 0.0, -0.9));
    model.add(Material::lambert(Rgb::splat(0.8)).unwrap(), wall);
    built(model)
}

pub(super) fn room_model(size: f64) -> Model {
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
    let light = quad(p(-0.4, 1.5, -0.3), p(far[0], 1.5, -0.3), p(far[0], 1.5, far[1]), p(-0.4, 1.5, far[1]));
    add(Material::light(Rgb::new(5.0, 4.0, 3.0)).unwrap(), &light);
    model
}

pub(super) fn camera(fov: f64) -> PinholeCamera {
    PinholeCamera::look_at(DVec3::new(0.3, 0.9, 2.2), DVec3::new(0.1, 0.0, 0.0), DVec3::Y, fov).unwrap()
}

/// Points of the floor that measure irradiance, up to these distances from its middle.
#[derive(Debug)]
pub(super) struct FloorPoints(pub(super) [f64; 2]);

impl Sensor for FloorPoints {
    fn start(&self, sample: &ElementSample) -> PathStart {
        let position = DVec3::new(self.0[0] * sample.x, 0.0, self.0[1] * sample.y);
        PathStart::Irradiance { position, normal: DVec3::Y }
    }

    fn hash(&self, _: &mut dyn Hasher) {}
}

pub(super) fn settings() -> Settings {
    Settings::new(13, 16, 4)
}

/// What is rendered, and what directions at first diffuse vertices follow.
pub(super) struct Setup<'a> {
    pub(super) scene: &'a Scene<KdTree>,
    pub(super) sensor: &'a dyn Sensor,
    pub(super) photons: PhotonGuide,
    pub(super) trained: Option<Guide>,
}

impl<'a> Setup<'a> {
    pub(super) fn new(scene: &'a Scene<KdTree>, sensor: &'a dyn Sensor, guiding: Guiding) -> Self {
        let settings = Settings { guiding, ..settings() };
        let trained = train_guide(scene, sensor, &settings, || false).unwrap().continue_value().flatten();
        let context = RenderContext::new(scene, sensor, &settings);
        let context = RenderContext { shares_caustics: true, ..context };
        let photons = photon_guide(&context, || false).continue_value().flatten().unwrap();
        Self { scene, sensor, photons, trained }
    }

    /// The radiance of each pixel's four samples together: with shared caustics and photons, with shared caustics, and
    /// with neither.
    pub(super) fn pixels(&self, settings: &Settings) -> [Vec<Rgb>; 3] {
        let photons = Some(self.photons.clone());
        [(true, photons), (true, None), (false, None)].map(|(shares_caustics, photons)| {
            let context = RenderContext::new(self.scene, self.sensor, settings);
            let guide = self.trained.as_ref();
            let context = RenderContext { guide, shares_caustics, photons, ..context };
            let mut wavefront = Wavefront::default();
            wavefront.trace(&context, &TileProbes::of(&context, TILE), 0..4, || false);
            let of_pixels = wavefront.radiance().chunks(4);
            let sum = |of_pixel: &[Rgb]| of_pixel.iter().copied().sum::<Rgb>();
            of_pixels.map(sum).collect()
        })
    }
}

/// A floor between two high mirrors that face each other, below a light. If `half_light` is 0.5, the light takes up all that
/// the mirrors show, and many paths reach it after eight mirrors, and many after nine.
pub(super) fn shaft_model(half_light: f64) -> Model {
    let p = DVec3::new;
    let mut model = Model::default();
    let level = |y: f64, x: f64, z: f64| [p(-x, y, z), p(x, y, z), p(x, y, -z), p(-x, y, -z)];
    let [a, b, c, d] = level(0.0, 0.5, 9.0);
    model.add(Material::lambert(Rgb::splat(0.8)).unwrap(), quad(a, b, c, d));
    let [a, b, c, d] = level(4.0, half_light, 18.0 * half_light);
    model.add(Material::light(Rgb::splat(2.0)).unwrap(), quad(a, d, c, b));
    for x in [-0.5, 0.5] {
        let wall = quad(p(x, 0.0, 9.0), p(x, 0.0, -9.0), p(x, 4.0, -9.0), p(x, 4.0, 9.0));
        model.add(Material::mirror(Rgb::splat(0.95)).unwrap(), wall);
    }
    model
}

pub(super) fn shaft(half_light: f64) -> Scene<KdTree> {
    built(shaft_model(half_light))
}

/// The paths of the tile, advanced to their ends.
pub(super) fn advanced(context: &RenderContext<'_>) -> Wavefront {
    let (mut wavefront, mut counters) = (Wavefront::default(), Counters::default());
    let probes = TileProbes { edges: LightEdges::default(), ..TileProbes::of(context, TILE) };
    wavefront.start(context, &probes, 0..4);
    wavefront.advance_to_end(context, &mut counters, || false);
    wavefront
}

/// The sum of the radiances of four samples of each pixel of a tile.
pub(super) fn radiance_sum(context: &RenderContext<'_>, tile: PixelRect) -> f64 {
    let mut wavefront = Wavefront::default();
    wavefront.trace(context, &TileProbes::of(context, tile), 0..4, || false);
    wavefront.radiance().iter().map(|radiance| radiance.mean()).sum()
}

/// Asserts that the two numbers that `pair` returns for a seed have the same mean, whose standard error is below `limit` of
/// it. A deviation exceeds the limit with a probability of 1e-6 (Student's distribution with 799 degrees of freedom).
pub(super) fn assert_equal_means(limit: f64, pair: impl Fn(u64) -> [f64; 2]) {
    let (mut level, mut deviation, mut squares) = (0.0, 0.0_f64, 0.0_f64);
    for seed in 0..800 {
        let [a, b] = pair(seed);
        (level, deviation) = (level + a, deviation + (b - a));
        squares += (b - a) * (b - a);
    }
    let (z, error) = (deviation.abs() / squares.sqrt(), squares.sqrt() / level);
    assert!(z < 4.93, "{z}");
    assert!(error > 0.0 && error < limit, "{error}");
}
