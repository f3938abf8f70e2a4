use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Bounds of a set of lights: where they are, in which directions they emit, and how much (Conty Estevez and
/// Kulla 2018, section 4).
///
/// A light emits within the angle `spread` of an axis, and each axis lies within the angle `tilt` of `axis`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cluster {
    min: DVec3,
    max: DVec3,
    /// Unit vector.
    pub(super) axis: DVec3,
    /// In radians, at most pi.
    pub(super) tilt: f64,
    /// In radians, at most pi.
    pub(super) spread: f64,
    /// Whether some of them emit the same in the opposite directions too.
    pub(super) both_sides: bool,
    /// The sum of the largest radiant intensities, as luminance.
    pub(super) intensity: f64,
}

impl Cluster {
    /// A triangle of these vertices whose front, of unit normal `axis`, emits `radiance`, as luminance.
    pub(crate) fn of_triangle(vertices: [DVec3; 3], axis: DVec3, both_sides: bool, intensity: f64) -> Self {
        let [a, b, c] = vertices;
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        Self { min, max, axis, tilt: 0.0, spread: FRAC_PI_2, both_sides, intensity }
    }

    /// A point that emits in all directions.
    pub(crate) fn of_point(position: DVec3, intensity: f64) -> Self {
        Self { tilt: PI, ..Self::of_spot(position, DVec3::Y, FRAC_PI_2, intensity) }
    }

    /// A point that emits within the angle `spread` of `axis`.
    pub(crate) fn of_spot(position: DVec3, axis: DVec3, spread: f64, intensity: f64) -> Self {
        Self { min: position, max: position, axis, tilt: 0.0, spread, both_sides: false, intensity }
    }

    pub(super) fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// The radius of the sphere around the centre that contains the box.
    pub(super) fn radius(&self) -> f64 {
        0.5 * self.min.distance(self.max)
    }

    pub(super) fn union(&self, other: &Self) -> Self {
        let (axis, tilt) = cone_around((self.axis, self.tilt), (other.axis, other.tilt));
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            axis,
            tilt,
            spread: self.spread.max(other.spread),
            both_sides: self.both_sides || other.both_sides,
            intensity: self.intensity + other.intensity,
        }
    }

    /// The cost of a node with these lights: intensity by size by the solid angle that they emit into (surface
    /// area orientation heuristic; equation 1, with the squared radius in place of the area, which is 0 for
    /// lights in a row).
    pub(super) fn cost(&self) -> f64 {
        self.intensity * self.radius().powi(2) * orientation(self.tilt, self.spread)
    }
}

/// The integral over all directions of the largest cosine with a direction of the cone.
fn orientation(tilt: f64, spread: f64) -> f64 {
    let end = (tilt + spread).min(PI);
    let (sin, cos) = libm::sincos(tilt);
    let falling = 2.0 * (end - tilt) * sin - libm::cos(tilt - 2.0 * end) + cos;
    2.0 * PI * (1.0 - cos) + FRAC_PI_2 * falling
}

/// The smallest cone around two cones, each an axis and an angle.
pub(super) fn cone_around(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    if wide.0 == narrow.0 {
        return wide;
    }
    let between = angle_between(wide.0, narrow.0);
    if between + narrow.1 <= wide.1 {
        return wide;
    }
    let tilt = 0.5 * (wide.1 + between + narrow.1);
    let turn = wide.0.cross(narrow.0).normalize_or_zero();
    if tilt >= PI || turn == DVec3::ZERO {
        return (wide.0, PI);
    }
    let (sin, cos) = libm::sincos(0.5 * (tilt - wide.1));
    let axis = DQuat::from_vec4((turn * sin).extend(cos)) * wide.0;
    (axis.normalize(), tilt)
}

/// In radians; exact to rounding for small angles too (Kahan).
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    2.0 * libm::atan2((a - b).length(), (a + b).length())
}
