//! Random triangles, and rays that hit or nearly hit them, for tests.

use crate::conformance::{Seeded, Source};
use crate::{Ray, Triangle};
use glam::DVec3;

/// A vector in `[-1, 1]^3`.
pub(super) fn vector(source: &mut Seeded) -> DVec3 {
    DVec3::new(source.signed(), source.signed(), source.signed())
}

/// A magnitude between `2^-octaves` and 1.
fn small(source: &mut Seeded, octaves: f64) -> f64 {
    (-octaves * source.unit()).exp2()
}

/// A triangle of some size and width within a scene that is 2 wide.
pub(super) fn triangle(source: &mut Seeded) -> Triangle {
    let (size, width) = (0.3 * small(source, 6.0), small(source, 5.0));
    let (place, along, across) = (0.4 * vector(source), size * vector(source), size * width * vector(source));
    let corner = |at: DVec3| (place + at).as_vec3();
    Triangle::new(corner(DVec3::ZERO), corner(along), corner(0.9 * source.signed() * along + across))
}

/// A ray toward a point in the middle, near an edge or a corner, sometimes nearly within the plane, or with a range that
/// begins or ends near the point.
pub(super) fn ray(source: &mut Seeded, triangle: &Triangle) -> Ray {
    let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
    let mut weights = [source.unit(), source.unit(), source.unit()];
    for weight in &mut weights {
        if source.unit() < 0.15 {
            *weight = source.signed() * small(source, 24.0);
        }
    }
    let sum = weights.iter().sum::<f64>().max(0.01);
    let at = (weights[0] * a + weights[1] * b + weights[2] * c) / sum;
    let edge = [b - a, c - b, a - c][source.below(3)].normalize_or(DVec3::X);
    let aside = vector(source);
    let direction = if source.unit() < 0.2 { edge + small(source, 20.0) * aside } else { aside };
    let distance = small(source, 8.0) / direction.length();
    let near = distance * (1.0 + source.signed() * small(source, 24.0));
    let ray = Ray::new(at - distance * direction, direction);
    match source.below(8) {
        0 => ray.with_range(0.0, near),
        1 => ray.with_range(near, f64::INFINITY),
        _ => ray,
    }
}
