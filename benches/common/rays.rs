//! Rays as a renderer makes them.

use globillum::geom::{Aabb, Accel, Hit, Ray, Triangles};
use globillum::glam::DVec3;
use globillum::integrator::Stream;

/// Rays from a pinhole in front of the mesh, row by row: neighbours take nearly the same way.
pub(crate) fn camera_rays(bounds: &Aabb, side: u32) -> Vec<Ray> {
    let middle = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0;
    let size = bounds.extent().max_element();
    let eye = middle + DVec3::new(0.3, 0.2, 1.5) * size;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side) - 0.5;
    let target = |x: u32, y: u32| middle + DVec3::new(at(x), at(y), 0.0) * size;
    (0..side)
        .flat_map(|y| (0..side).map(move |x| (x, y)))
        .map(|(x, y)| Ray::new(eye, target(x, y) - eye))
        .collect()
}

/// Rays that leave what `rays` hit in directions uniform over the sphere's outer half: no two
/// take the same way.
pub(crate) fn bounce_rays(accel: &dyn Accel, triangles: &Triangles, rays: &[Ray]) -> Vec<Ray> {
    let hits = rays.iter().filter_map(|ray| Some((ray, accel.intersect(ray)?)));
    hits.zip(0..)
        .map(|((ray, Hit { triangle, u, v, .. }), i)| {
            let point = triangles.surface_point(triangle, u, v);
            let direction = on_sphere(Stream::new(0, i, 0).uniform_pair(0));
            let outward = point.normal.dot(direction) * point.normal.dot(ray.direction) <= 0.0;
            point.spawn(if outward { direction } else { -direction })
        })
        .collect()
}

fn on_sphere([a, b]: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * a;
    let (sin, cos) = (std::f64::consts::TAU * b).sin_cos();
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * cos, r * sin, z)
}
