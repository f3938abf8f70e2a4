use crate::Interaction;
use crate::sampler::BounceNumbers;
use glam::DVec3;
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
}

/// The density of a path's current direction, and where a light sample of the same direction would have
/// been taken: what the multiple importance sampling weight of emission depends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct MisContext {
    /// A delta if no light sample could have found what the ray hits: after the camera and most mirrors. The rest is
    /// then of no account.
    pub(super) density: Density,
    /// The point from which lights would have been sampled: the last diffuse vertex, or its image in the
    /// mirror that the path hit since.
    pub(super) from: DVec3,
    /// The probability of that light sample.
    pub(super) from_prob: f64,
    /// Whether `from` is an image in a mirror.
    pub(super) in_mirror: bool,
}

impl MisContext {
    /// A direction of this density that starts at `from`.
    pub(super) fn new(density: Density, from: DVec3) -> Self {
        Self { density, from, from_prob: 1.0, in_mirror: false }
    }
}
