use glam::{DVec3, Vec3};

/// A closed axis-aligned bounding box.
///
/// A box with `min > max` on any axis is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The empty box that is the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box that contains all `points`; [`Aabb::EMPTY`] if there are none.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Whether the box contains no point; `true` also for a NaN coordinate.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box that contains both boxes.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The common part of both boxes, possibly empty.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The side lengths, `>= 0`; zero for an empty box.
    pub fn extent(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max.as_dvec3() - self.min.as_dvec3() }
    }

    /// The point in the middle of the box; without meaning for an empty one.
    pub fn center(&self) -> DVec3 {
        0.5 * (self.min.as_dvec3() + self.max.as_dvec3())
    }

    /// Half the surface area, in squared units of length, as the surface area heuristic uses it.
    pub fn half_area(&self) -> f64 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}
