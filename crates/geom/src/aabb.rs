use glam::{DVec3, Vec3};

/// An axis-aligned box, both faces included.
///
/// The empty box has `min` above `max` and is the neutral element of [`Aabb::union`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: Vec3,
    /// Largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `points`; [`Aabb::EMPTY`] if there are none.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// Whether the box contains nothing.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The smallest box that contains both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The part that both share, possibly empty.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Side lengths in `f64`; zero for the empty box.
    pub fn extent(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max.as_dvec3() - self.min.as_dvec3() }
    }

    /// Half the surface area, the quantity that the surface area heuristic compares.
    pub fn half_area(&self) -> f64 {
        let e = self.extent();
        e.x * e.y + e.y * e.z + e.z * e.x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_is_neutral() {
        let cube = Aabb::around([Vec3::ZERO, Vec3::ONE]);
        assert!(Aabb::EMPTY.is_empty() && !cube.is_empty());
        assert_eq!(cube.union(&Aabb::EMPTY), cube);
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert_eq!(cube.half_area(), 3.0);
        assert!(cube.intersection(&Aabb::around([Vec3::splat(2.0)])).is_empty());
    }
}
