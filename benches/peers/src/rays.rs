//! Rays as a renderer generates them.
//!
//! Every number of a ray is rounded to `f32`, so that peers in `f32` trace the same rays as this library in
//! `f64`.

use crate::scenes::{Light, Scene, View};
use globillum::geom::{Accel, Frame, Hit, Ray};
use globillum::glam::DVec3;
use globillum::integrator::Stream;
use globillum::material::warp::CosineHemisphere;
use serde::Serialize;
use std::ops::Deref;

/// The kinds of rays that every scene is traced by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Kind {
    /// Coherent rays from the camera.
    Camera,
    /// Incoherent rays from the hit points of camera rays.
    Bounce,
    /// Rays from the same points toward one light, for any-hit queries.
    Shadow,
}

impl Kind {
    pub(crate) const ALL: [Self; 3] = [Self::Camera, Self::Bounce, Self::Shadow];
}

/// Rays of every kind, in the order of [`Kind::ALL`].
pub(crate) fn generate(scene: &Scene, accel: &dyn Accel, count: u32) -> [RaySet; 3] {
    let camera = camera_rays(&scene.view, count);
    let starts: Vec<_> = starts(scene, accel, &camera).into_iter().flatten().collect();
    let bounce = starts.iter().map(Start::bounce).collect();
    let shadow = starts.iter().filter_map(|start| start.shadow(&scene.lights[0])).collect();
    let set = |kind: Kind, rays| {
        let mut set = RaySet::new(&format!("{kind:?}").to_lowercase(), kind == Kind::Shadow);
        set.push_batch(rays);
        set
    };
    [set(Kind::Camera, camera), set(Kind::Bounce, bounce), set(Kind::Shadow, shadow)]
}

/// Rays that are traced in a row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RaySet {
    pub(crate) name: String,
    /// Whether they query any hit instead of the closest.
    pub(crate) is_any_hit: bool,
    rays: Vec<Ray>,
    /// Where batches end.
    ends: Vec<usize>,
}

impl RaySet {
    fn new(name: &str, is_any_hit: bool) -> Self {
        Self { name: name.to_owned(), is_any_hit, rays: Vec::new(), ends: Vec::new() }
    }

    fn push_batch(&mut self, rays: Vec<Ray>) {
        self.rays.extend(rays);
        self.ends.push(self.rays.len());
    }

    /// The lengths of the batches.
    pub(crate) fn batches(&self) -> Vec<usize> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, end)| end - start).collect()
    }
}

impl Deref for RaySet {
    type Target = [Ray];

    fn deref(&self) -> &[Ray] {
        &self.rays
    }
}

/// A tile's side in pixels, that of its blocks, and its samples per pixel, as the integrator has them.
const WAVEFRONT_TILE: u32 = 16;
const BLOCK: u32 = 4;
const SAMPLES: u32 = 4;
/// The bounces of a path.
const BOUNCES: u32 = 3;

/// The rays of the integrator's wavefronts: a batch holds all rays of one kind of a tile of 16 x 16 pixels with four
/// samples each, block by block and pixel by pixel. Shadow rays go to each light from the first hits, and to one at
/// random from the hits of bounce rays.
pub(crate) fn wavefronts(scene: &Scene, accel: &dyn Accel, count: u32) -> Vec<RaySet> {
    let side = (f64::from(count / SAMPLES).sqrt() / f64::from(WAVEFRONT_TILE)).ceil() as u32;
    let lights = &scene.lights;
    let mut camera = RaySet::new("camera", false);
    let mut direct: Vec<_> =
        (0..lights.len()).map(|light| RaySet::new(&format!("shadow of light {light}"), true)).collect();
    let mut bounces: Vec<_> = (1..=BOUNCES)
        .map(|i| {
            [RaySet::new(&format!("bounce {i}"), false), RaySet::new(&format!("shadow of bounce {i}"), true)]
        })
        .collect();
    for tile in 0..side * side {
        let mut rays = tile_rays(&scene.view, side, tile);
        camera.push_batch(rays.iter().map(|(ray, _)| *ray).collect());
        let mut hits = path_starts(scene, accel, &rays, 0);
        for (light, set) in lights.iter().zip(&mut direct) {
            set.push_batch(hits.iter().filter_map(|start| start.shadow(light)).collect());
        }
        for (bounce, [closest, shadow]) in (1..).zip(&mut bounces) {
            rays = hits.iter().map(|start| (start.bounce(), start.path)).collect();
            closest.push_batch(rays.iter().map(|(ray, _)| *ray).collect());
            hits = path_starts(scene, accel, &rays, bounce);
            let any = |start: &Start| {
                start.shadow(&lights[(start.stream.uniform(CHOICE) * lights.len() as f64) as usize])
            };
            shadow.push_batch(hits.iter().filter_map(any).collect());
        }
    }
    [camera].into_iter().chain(direct).chain(bounces.into_iter().flatten()).collect()
}

/// The camera rays of a tile, with the numbers of their paths.
fn tile_rays(view: &View, side: u32, tile: u32) -> Vec<(Ray, u64)> {
    let pixels = WAVEFRONT_TILE * side;
    let (left, top) = (tile % side * WAVEFRONT_TILE, tile / side * WAVEFRONT_TILE);
    let place = |i: u32| {
        let (block, within) = (i / (BLOCK * BLOCK), i % (BLOCK * BLOCK));
        let [x, y] = [block % (WAVEFRONT_TILE / BLOCK), block / (WAVEFRONT_TILE / BLOCK)];
        (left + x * BLOCK + within % BLOCK, top + y * BLOCK + within / BLOCK)
    };
    let samples = (0..WAVEFRONT_TILE * WAVEFRONT_TILE).flat_map(|i| (0..SAMPLES).map(move |s| (place(i), s)));
    let ray = |((x, y), sample): ((u32, u32), u32)| {
        let path = u64::from(SAMPLES * (y * pixels + x) + sample);
        (camera_ray(view, pixels, [x, y], path), path)
    };
    samples.map(ray).collect()
}

/// Where the rays of paths hit; paths without a hit end.
fn path_starts(scene: &Scene, accel: &dyn Accel, rays: &[(Ray, u64)], bounce: u32) -> Vec<Start> {
    let start = |&(ray, path): &(Ray, u64)| start(scene, accel, &ray, path, bounce + 2);
    rays.iter().filter_map(start).collect()
}

const SEED: u64 = 5;

/// The dimensions of the random numbers.
const PIXEL: u32 = 0;
const DIRECTION: u32 = 2;
const LIGHT: u32 = 4;
const CHOICE: u32 = 6;

/// A tile's side, in pixels.
const TILE: u32 = 8;

/// One ray per pixel of a square picture of about `count` pixels, tile by tile.
fn camera_rays(view: &View, count: u32) -> Vec<Ray> {
    let tiles = (f64::from(count).sqrt() / f64::from(TILE)).ceil() as u32;
    let square = |side: u32| (0..side * side).map(move |i| (i % side, i / side));
    let pixels =
        square(tiles).flat_map(|(i, j)| square(TILE).map(move |(x, y)| (TILE * i + x, TILE * j + y)));
    let pixel = |x: u32, y: u32| u64::from(y * tiles * TILE + x);
    pixels.map(|(x, y)| camera_ray(view, tiles * TILE, [x, y], pixel(x, y))).collect()
}

/// A ray at random through a pixel of a picture of `side` by `side` pixels.
fn camera_ray(view: &View, side: u32, [x, y]: [u32; 2], path: u64) -> Ray {
    let forward = view.target - view.eye;
    let right = forward.cross(DVec3::Y).normalize() * view.width;
    let down = forward.cross(right).normalize() * view.width;
    let jitter = Stream::new(SEED, path, 0).uniform_pair(PIXEL);
    let at = |i: u32, u: f64| (f64::from(i) + u) / f64::from(side) - 0.5;
    rounded(Ray::new(view.eye, forward + at(x, jitter[0]) * right + at(y, jitter[1]) * down))
}

/// The hit point of a ray, the origin of bounce and shadow rays.
struct Start {
    path: u64,
    position: DVec3,
    /// On the viewer's side.
    normal: DVec3,
    stream: Stream,
}

/// Distance of ray origins from the surface, in multiples of the scene's reach. Rounding to `f32` moves an
/// origin by at most `2^-24`, so no peer may hit the triangle that a ray starts on.
const CLEARANCE: f64 = 1.0 / (1 << 17) as f64;

fn starts(scene: &Scene, accel: &dyn Accel, rays: &[Ray]) -> Vec<Option<Start>> {
    rays.iter().zip(0..).map(|(ray, pixel)| start(scene, accel, ray, pixel, 1)).collect()
}

/// The hit point of a ray, which has random numbers of its own.
fn start(scene: &Scene, accel: &dyn Accel, ray: &Ray, path: u64, numbers: u32) -> Option<Start> {
    let clearance = CLEARANCE * scene.reach();
    let Hit { triangle, u, v, .. } = accel.intersect(ray)?;
    let point = scene.triangles.surface_point(triangle, u, v);
    let normal = if point.normal.dot(ray.direction) < 0.0 { point.normal } else { -point.normal };
    let position = point.leave_toward(normal) + clearance * normal;
    Some(Start { path, position, normal, stream: Stream::new(SEED, path, numbers) })
}

impl Start {
    /// A ray distributed as the cosine with the normal.
    fn bounce(&self) -> Ray {
        let local = CosineHemisphere::sample(self.stream.uniform_pair(DIRECTION));
        rounded(Ray::new(self.position, Frame::around(self.normal).to_world(local)))
    }

    /// A ray to a uniformly chosen point of the light; `None` if the surface faces away from it.
    fn shadow(&self, light: &Light) -> Option<Ray> {
        let [a, b] = self.stream.uniform_pair(LIGHT).map(|u| u - 0.5);
        let target = light.center + a * light.edges[0] + b * light.edges[1];
        let ray = Ray::segment(self.position, target);
        (ray.direction.dot(self.normal) > 0.0).then(|| rounded(ray))
    }
}

fn rounded(ray: Ray) -> Ray {
    let [origin, direction] = [ray.origin, ray.direction].map(|v| v.as_vec3().as_dvec3());
    Ray { origin, direction, ..ray }
}

#[cfg(test)]
mod tests {
    use super::*;
    use globillum::geom::KdTree;

    fn room() -> (Scene, KdTree) {
        let scene = Scene::load("room").expect("it is procedural");
        let tree = KdTree::build(&scene.triangles).expect("the mesh is good");
        (scene, tree)
    }

    #[test]
    fn rays_are_the_same_in_single_precision_and_in_every_run() {
        let (scene, tree) = room();
        let kinds = generate(&scene, &tree, 4096);
        assert_eq!(kinds, generate(&scene, &tree, 4096));
        for ray in kinds.iter().flat_map(|set| set.iter()) {
            assert!(ray.is_traceable());
            assert_eq!(rounded(*ray), *ray);
            assert_eq!(ray.t_min, 0.0);
            assert!(ray.t_max == 1.0 || ray.t_max.is_infinite());
        }
    }

    #[test]
    fn tiles_cover_the_picture() {
        let (scene, tree) = room();
        let [camera, bounce, shadow] = generate(&scene, &tree, 1000);
        assert_eq!(camera.len(), 1024, "32 x 32 is the next square of whole tiles");
        assert_eq!(bounce.len(), camera.len(), "the room is closed");
        assert!(shadow.len() < bounce.len() && shadow.len() > bounce.len() / 2);
        let spread = |rays: &[Ray]| {
            let directions = rays.iter().map(|ray| ray.direction.normalize());
            let mean = directions.clone().sum::<DVec3>() / rays.len() as f64;
            directions.map(|d| d.distance_squared(mean)).sum::<f64>() / rays.len() as f64
        };
        let tile = (TILE * TILE) as usize;
        assert!(spread(&camera[..tile]) < 0.1 * spread(&camera));
    }

    #[test]
    fn bounce_rays_leave_their_triangle_cosine_distributed() {
        let (scene, tree) = room();
        let camera = camera_rays(&scene.view, 4096);
        let starts: Vec<_> = starts(&scene, &tree, &camera).into_iter().flatten().collect();
        let mut cosines = 0.0;
        for (start, ray) in starts.iter().zip(&camera) {
            let origin = tree.intersect(ray).expect("the room is closed").triangle;
            let bounce = start.bounce();
            assert!(tree.intersect(&bounce).is_none_or(|hit| hit.triangle != origin));
            cosines += bounce.direction.normalize().dot(start.normal);
        }
        // Mean 2/3, variance 1/18; the bound is five standard deviations of the mean of 4096.
        let mean = cosines / starts.len() as f64;
        assert!((mean - 2.0 / 3.0).abs() < 5.0 * (1.0 / 18.0_f64 / starts.len() as f64).sqrt(), "{mean}");
    }
}
