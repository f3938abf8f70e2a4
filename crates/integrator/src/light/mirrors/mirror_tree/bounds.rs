use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// What the tree knows of a mirror, in its frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    /// The place of the mirror in the list that the tree is built of.
    pub(super) mirror: u32,
    /// The center in a frame in which all coordinates of the scene are within `[-1, 1]`.
    pub(super) center_in_frame: DVec3,
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// The bit of its body.
    pub(super) body: u32,
}

/// Bounds of some mirrors: a sphere, and a cone of rectangular cross section around their normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// The axis of the cone, and the directions of its sides: orthogonal unit vectors.
    pub(super) frame: [DVec3; 3],
    /// The largest angles, in radians, between the axis and a normal as projected onto the planes of the axis and
    /// each side.
    pub(super) angles: [f64; 2],
    /// The sum of all areas.
    pub(super) area: f64,
    /// The bits of all bodies.
    pub(super) bodies: u32,
}

impl Bounds {
    /// Of one or more mirrors.
    pub(super) fn around(items: &[Item]) -> Self {
        let min = items.iter().map(|item| item.center - item.radius).fold(DVec3::INFINITY, DVec3::min);
        let max = items.iter().map(|item| item.center + item.radius).fold(DVec3::NEG_INFINITY, DVec3::max);
        let center = 0.5 * (min + max);
        let radius = |item: &Item| item.center.distance(center) + item.radius;
        let frame = frame(items);
        let angles = [frame[1], frame[2]].map(|cross_axis| {
            let tan = |item: &Item| item.normal.dot(cross_axis).abs() / item.normal.dot(frame[0]);
            // Beyond a right angle, tangents are negative.
            let is_wide = items.iter().any(|item| item.normal.dot(frame[0]) <= 0.0);
            if is_wide { PI } else { libm::atan(items.iter().map(tan).fold(0.0, f64::max)) }
        });
        Self {
            center,
            radius: items.iter().map(radius).fold(0.0, f64::max),
            frame,
            angles,
            area: items.iter().map(|item| item.area).sum(),
            bodies: items.iter().fold(0, |bodies, item| bodies | item.body),
        }
    }
}

/// The axis of a cone around the normals, the direction in which they vary most, and the one orthogonal to both.
fn frame(items: &[Item]) -> [DVec3; 3] {
    let sum: DVec3 = items.iter().map(|item| item.normal).sum();
    let axis = sum.try_normalize().unwrap_or(items[0].normal);
    let (x, y) = axis.any_orthonormal_pair();
    let slope =
        |normal: DVec3, x: DVec3, y: DVec3| DVec2::new(normal.dot(x), normal.dot(y)) / normal.dot(axis);
    let slopes = |x: DVec3, y: DVec3| items.iter().map(move |item| slope(item.normal, x, y));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for DVec2 { x, y } in slopes(x, y) {
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
    }
    let (sin, cos) = libm::sincos(0.5 * libm::atan2(2.0 * xy, xx - yy));
    let (x, y) = (cos * x + sin * y, cos * y - sin * x);
    let min = slopes(x, y).fold(DVec2::INFINITY, DVec2::min);
    let max = slopes(x, y).fold(DVec2::NEG_INFINITY, DVec2::max);
    let middle = 0.5 * (min + max);
    // Slopes of normals more than a right angle off the axis mean nothing; such a cone is wide anyway.
    match (axis + middle.x * x + middle.y * y).try_normalize() {
        Some(axis) => {
            let x = x.reject_from_normalized(axis).normalize();
            [axis, x, axis.cross(x)]
        }
        None => [axis, x, y],
    }
}
