use crate::light::Receiver;
use glam::DVec3;
use globillum_geom::SurfacePoint;
use globillum_material::{Material, Rgb};

/// The point and the material of a hit.
///
/// [`Hit::t`](globillum_geom::Hit::t) has its depth, in multiples of the ray's direction.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Interaction<'a> {
    /// The point on the triangle.
    pub point: SurfacePoint,
    /// The triangle's material.
    pub material: &'a Material,
    /// Unit direction back along the ray, world frame.
    pub wo: DVec3,
}

impl Interaction<'_> {
    /// The radiance that the surface emits back along the ray; black if it does not emit on that side.
    #[inline(always)]
    pub fn emitted(&self) -> Rgb {
        self.material.emission.toward(self.point.normal.dot(self.wo))
    }

    /// What receives light on that side of the surface from which the ray came.
    #[inline(always)]
    pub(crate) fn receiver(&self) -> Receiver {
        Receiver { position: self.point.position, normal: self.facing_normal().as_vec3() }
    }

    /// The unit normal on the side of the surface from which the ray came.
    #[inline(always)]
    pub fn facing_normal(&self) -> DVec3 {
        let normal = self.point.normal;
        normal * 1.0_f64.copysign(normal.dot(self.wo))
    }
}
