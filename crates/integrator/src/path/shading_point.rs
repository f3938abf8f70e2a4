use crate::Interaction;
use crate::sampler::BounceNumbers;
use glam::{DVec3, Vec3};
use globillum_geom::Frame;
use globillum_material::Density;

/// A path vertex that is shaded, with its local frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadingPoint<'a> {
    pub(super) at: Interaction<'a>,
    pub(super) frame: Frame,
    /// Unit direction back along the path, in the local frame.
    pub(super) wo: DVec3,
    pub(super) bounce: u32,
    /// The random numbers of this bounce.
    pub(super) numbers: BounceNumbers,
}

impl<'a> ShadingPoint<'a> {
    #[inline(always)]
    pub(super) fn new(at: Interaction<'a>, bounce: u32, numbers: BounceNumbers) -> Self {
        let frame = Frame::around(at.point.normal);
        Self { at, frame, wo: frame.to_local(at.wo), bounce, numbers }
    }

    /// The normal on the side of the surface from which the path came.
    #[inline(always)]
    pub(super) fn side(&self) -> Vec3 {
        (self.at.point.normal * 1.0_f64.copysign(self.wo.z)).as_vec3()
    }
}

/// The density of a path's current direction, and where a light sample of the same direction would have
/// been taken: what the multiple importance sampling weight of emission depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct MisContext {
    /// A delta if no light sample could have found what the ray hits: after the camera and most mirrors. The rest is
    /// then of no account.
    pub(super) density: Density,
    /// The point from which lights would have been sampled: the last diffuse vertex.
    pub(super) from: DVec3,
    /// The normal on the side of its surface from which the path came.
    pub(super) side: Vec3,
    /// The mirror triangle that the path hit since.
    pub(super) mirror: Option<u32>,
    /// Whether other camera rays find what the path would find of lights before its first diffuse vertex.
    pub(super) supersampled: bool,
}

impl MisContext {
    /// A direction of this density that starts at `from`, on this side of its surface.
    pub(super) fn new(density: Density, from: DVec3, side: Vec3) -> Self {
        Self { density, from, side, mirror: None, supersampled: false }
    }
}
