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

/// The kinds of rays.
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
pub(crate) fn generate(scene: &Scene, accel: &dyn Accel, count: u32) -> [Vec<Ray>; 3] {
    let camera = camera_rays(&scene.view, count);
    let starts = starts(scene, accel, &camera);
    let bounce = starts.iter().map(Start::bounce).collect();
    let shadow = starts.iter().filter_map(|start| start.shadow(&scene.light)).collect();
    [camera, bounce, shadow]
}

const SEED: u64 = 5;

/// The dimensions of the random numbers.
const PIXEL: u32 = 0;
const DIRECTION: u32 = 2;
const LIGHT: u32 = 4;

/// A tile's side, in pixels.
const TILE: u32 = 8;

/// One ray per pixel of a square picture of about `count` pixels, tile by tile.
fn camera_rays(view: &View, count: u32) -> Vec<Ray> {
    let tiles = (f64::from(count).sqrt() / f64::from(TILE)).ceil() as u32;
    let forward = view.target - view.eye;
    let right = forward.cross(DVec3::Y).normalize() * view.width;
    let down = forward.cross(right).normalize() * view.width;
    let through = |x: u32, y: u32| {
        let jitter = Stream::new(SEED, u64::from(y * tiles * TILE + x), 0).uniform_pair(PIXEL);
        let at = |i: u32, u: f64| (f64::from(i) + u) / f64::from(tiles * TILE) - 0.5;
        rounded(Ray::new(view.eye, forward + at(x, jitter[0]) * right + at(y, jitter[1]) * down))
    };
    let square = |side: u32| (0..side * side).map(move |i| (i % side, i / side));
    let pixels =
        square(tiles).flat_map(|(i, j)| square(TILE).map(move |(x, y)| (TILE * i + x, TILE * j + y)));
    pixels.map(|(x, y)| through(x, y)).collect()
}

/// The hit point of a camera ray, the origin of bounce and shadow rays.
struct Start {
    position: DVec3,
    /// On the viewer's side.
    normal: DVec3,
    stream: Stream,
}

/// Distance of ray origins from the surface, in multiples of the scene's reach. Rounding to `f32` moves an
/// origin by at most `2^-24`, so no peer may hit the triangle that a ray starts on.
const CLEARANCE: f64 = 1.0 / (1 << 17) as f64;

fn starts(scene: &Scene, accel: &dyn Accel, rays: &[Ray]) -> Vec<Start> {
    let clearance = CLEARANCE * scene.reach();
    let start = |(ray, pixel): (&Ray, u64)| {
        let Hit { triangle, u, v, .. } = accel.intersect(ray)?;
        let point = scene.triangles.surface_point(triangle, u, v);
        let normal = if point.normal.dot(ray.direction) < 0.0 { point.normal } else { -point.normal };
        let position = point.leave_toward(normal) + clearance * normal;
        Some(Start { position, normal, stream: Stream::new(SEED, pixel, 1) })
    };
    rays.iter().zip(0..).filter_map(start).collect()
}

impl Start {
    /// A ray distributed as the cosine with the normal.
    fn bounce(&self) -> Ray {
        let local = CosineHemisphere::sample(self.stream.uniform_pair(DIRECTION));
        rounded(Ray::new(self.position, Frame::around(self.normal).to_world(local)))
    }

    /// A ray to a uniformly chosen point of the light; `None` if the surface faces away from it.
    fn shadow(&self, light: &Light) -> Option<Ray> {
        let [a, b] = self.stream.uniform_pair(LIGHT).map(|u| (u - 0.5) * light.side);
        let target = light.center + DVec3::new(a, 0.0, b);
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
    use globillum::geom::{KdOptions, KdTree};

    fn room() -> (Scene, KdTree) {
        let scene = Scene::load("room").expect("it is procedural");
        let tree = KdTree::build(&scene.triangles, &KdOptions::default()).expect("the mesh is good");
        (scene, tree)
    }

    #[test]
    fn rays_are_the_same_in_single_precision_and_in_every_run() {
        let (scene, tree) = room();
        let kinds = generate(&scene, &tree, 4096);
        assert_eq!(kinds, generate(&scene, &tree, 4096));
        for ray in kinds.iter().flatten() {
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
        let starts = starts(&scene, &tree, &camera);
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
