use glam::Vec3;

/// An axis-aligned cube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cube {
    /// The corner of least coordinates.
    corner: Vec3,
    size: f32,
}

impl Cube {
    /// Half of the diagonal of a cube of size 1, rounded up.
    const UNIT_RADIUS: f32 = 0.8661;

    /// A cube of this size around `center`, made slightly larger so that rounding leaves no point of it outside.
    pub(super) fn around(center: Vec3, size: f32) -> Self {
        let size = 1.001 * size;
        Self { corner: center - 0.5 * size, size }
    }

    pub(super) fn size(&self) -> f32 {
        self.size
    }

    pub(super) fn center(&self) -> Vec3 {
        self.corner + 0.5 * self.size
    }

    /// The radius of the sphere around it.
    pub(super) fn radius(&self) -> f32 {
        Self::UNIT_RADIUS * self.size
    }

    #[inline(always)]
    pub(super) fn contains(&self, position: Vec3) -> bool {
        (position.cmpge(self.corner) & position.cmple(self.corner + self.size)).all()
    }

    /// The octant with this position of the cube: its number, and itself.
    #[inline(always)]
    pub(super) fn octant(&self, position: Vec3) -> (usize, Self) {
        let size = 0.5 * self.size;
        let middle = self.corner + size;
        let is_above = position.cmpge(middle);
        (is_above.bitmask() as usize, Self { corner: Vec3::select(is_above, middle, self.corner), size })
    }
}
