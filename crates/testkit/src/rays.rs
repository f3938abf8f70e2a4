//! Camera, bounce and shadow rays of a renderer.

use crate::meshes::Subject;
use glam::DVec3;
use globillum_geom::{Accel, Frame, GeomError, Hit, KdTree, Ray};
use globillum_integrator::Stream;
use globillum_material::warp::CosineHemisphere;

/// The rays of one picture.
#[derive(Clone, Debug)]
pub struct Rays {
    /// From one origin, row by row: coherent. For closest hits.
    pub camera: Vec<Ray>,
    /// From the hits of the camera rays, in cosine-distributed directions: incoherent. For closest hits.
    pub bounce: Vec<Ray>,
    /// From the hits of the camera rays to one light: coherent. For any hit.
    pub shadow: Vec<Ray>,
}

impl Rays {
    /// The rays of a square picture of `subject` with `side` pixels on each side.
    ///
    /// # Errors
    /// Those of [`KdTree`], whose hits are the origins of bounce and shadow rays.
    pub fn new(subject: &Subject, side: u32) -> Result<Self, GeomError> {
        let accel = KdTree::build(&subject.triangles)?;
        let camera = camera_rays(subject, side);
        let (mut bounce, mut shadow) = (Vec::new(), Vec::new());
        for (ray, index) in camera.iter().zip(0..) {
            let Some(Hit { triangle, u, v, .. }) = accel.intersect(ray) else { continue };
            let point = subject.triangles.surface_point(triangle, u, v);
            let normal = if point.normal.dot(ray.direction) < 0.0 { point.normal } else { -point.normal };
            let along = CosineHemisphere::sample(Stream::new(0, index, 0).uniform_pair(0));
            bounce.push(point.spawn_ray(Frame::around(normal).to_world(along)));
            let mut to_light = point.spawn_ray(subject.light - point.position);
            to_light.t_max = 1.0;
            shadow.push(to_light);
        }
        Ok(Self { camera, bounce, shadow })
    }
}

fn camera_rays(subject: &Subject, side: u32) -> Vec<Ray> {
    let forward = subject.target - subject.eye;
    let right = forward.cross(DVec3::Y).normalize() * forward.length() * subject.half_height;
    let up = right.cross(forward).normalize() * right.length();
    let at = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(side) - 1.0;
    let pixels = (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
    pixels.map(|(x, y)| Ray::new(subject.eye, forward + at(x) * right - at(y) * up)).collect()
}
