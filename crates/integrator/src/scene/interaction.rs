use glam::DVec3;
use globillum_geom::SurfacePoint;
use globillum_material::{Material, Rgb};

/// A hit, looked up: where it is and what is there.
///
/// How far it is from the ray's origin, [`Hit::t`](globillum_geom::Hit::t) tells, in multiples of the ray's direction.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Interaction<'a> {
    /// The point on the triangle.
    pub point: SurfacePoint,
    /// What the triangle is made of.
    pub material: &'a Material,
    /// Unit direction, in the world, back along the ray.
    pub wo: DVec3,
}

impl Interaction<'_> {
    /// The radiance that the surface emits back along the ray; black if it does not emit on that side.
    #[inline(always)]
    pub fn emitted(&self) -> Rgb {
        self.material.emission.toward(self.point.normal.dot(self.wo))
    }
}
