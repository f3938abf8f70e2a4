//! Rays that are sensitive to rounding: at edges and vertices, along axes, and within planes.

use super::oracle;
use super::source::Source;
use crate::{Ray, Triangle};
use glam::DVec3;

/// A point exactly on a vertex, on an edge up to rounding, or inside.
pub(super) fn point_of(triangle: &Triangle, source: &mut impl Source) -> DVec3 {
    let v = triangle.vertices.map(|v| v.as_dvec3());
    let first = source.below(3);
    let (a, b, c) = (v[first], v[(first + 1) % 3], v[(first + 2) % 3]);
    match source.below(4) {
        0 => a,
        1 => (a + b) / 2.0,
        2 => a + source.unit() * (b - a),
        _ => a + source.unit() * ((b - a) + source.unit() * (c - b)),
    }
}

/// A ray at a point of one of `triangles`. It starts at a point of a triangle, at `elsewhere`, or where it is
/// parallel to an axis or a coordinate plane. Its range is unlimited or ends near the point.
pub(super) fn ray_at(triangles: &[Triangle], elsewhere: DVec3, source: &mut impl Source) -> Ray {
    if triangles.is_empty() {
        return Ray::new(elsewhere, DVec3::new(source.signed(), source.signed(), source.signed()));
    }
    let target = point_of(&source.pick(triangles), source);
    let origin = match source.below(4) {
        0 => point_of(&source.pick(triangles), source),
        1 => snapped(target, elsewhere, source),
        _ => elsewhere,
    };
    let direction = with_signed_zeros(target - origin, source);
    with_some_range(Ray::new(origin, direction), source)
}

/// `target` moved toward `elsewhere` along one or two axes only.
fn snapped(target: DVec3, elsewhere: DVec3, source: &mut impl Source) -> DVec3 {
    let mut origin = target;
    let axis = source.below(3);
    origin[axis] = elsewhere[axis];
    if source.one_in(2) {
        let other = source.below(3);
        origin[other] = elsewhere[other];
    }
    origin
}

fn with_signed_zeros(direction: DVec3, source: &mut impl Source) -> DVec3 {
    direction.map(|x| if x == 0.0 && source.one_in(2) { -0.0 } else { x })
}

/// Mostly the same ray; otherwise one that excludes one or two triangles, mostly such that it would hit, now and then
/// an index that no triangle has.
pub(super) fn with_some_excluded(ray: Ray, triangles: &[Triangle], source: &mut impl Source) -> Ray {
    if triangles.is_empty() || !source.one_in(4) {
        return ray;
    }
    let ray = excluding_one_more(ray, triangles, source);
    if source.one_in(2) { excluding_one_more(ray, triangles, source) } else { ray }
}

fn excluding_one_more(ray: Ray, triangles: &[Triangle], source: &mut impl Source) -> Ray {
    let at_random = source.below(triangles.len()) as u32;
    let closest = if source.one_in(4) { None } else { oracle::closest(triangles, &ray) };
    let index = closest.map_or(at_random, |hit| hit.triangle);
    // A bit away from an index, or any.
    let index = match source.below(8) {
        6 => index ^ 1 << source.below(32),
        7 => source.bits() as u32,
        _ => index,
    };
    ray.excluding(if source.one_in(2) { [ray.excluded[1], index] } else { [index, ray.excluded[0]] })
}

/// Mostly the whole ray; otherwise a range with an end at or near the target, which is at `t = 1`.
pub(super) fn with_some_range(ray: Ray, source: &mut impl Source) -> Ray {
    let near_one = [1.0, 1.0_f64.next_up(), 1.0_f64.next_down(), 0.5, 2.0];
    match source.below(8) {
        0 => ray.with_range(0.0, source.pick(&near_one)),
        1 => ray.with_range(source.pick(&near_one), f64::INFINITY),
        2 => ray.with_range(-1.0, f64::INFINITY),
        _ => ray,
    }
}
