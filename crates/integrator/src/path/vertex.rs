use crate::Interaction;
use crate::sampler::BounceNumbers;
use glam::DVec3;
use globillum_geom::Frame;
use globillum_material::Density;

/// A surface that is shaded, with its own frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaded<'a> {
    pub(super) at: Interaction<'a>,
    pub(super) frame: Frame,
    /// Unit direction back along the path, in that frame.
    pub(super) wo: DVec3,
    pub(super) bounce: u32,
    /// What decides this bounce.
    pub(super) numbers: BounceNumbers,
}

impl<'a> Shaded<'a> {
    #[inline(always)]
    pub(super) fn new(at: Interaction<'a>, bounce: u32, numbers: BounceNumbers) -> Self {
        let frame = Frame::around(at.point.normal);
        Self { at, frame, wo: frame.to_local(at.wo), bounce, numbers }
    }
}

/// How the direction of a path's ray was chosen, and how a light sample would have chosen it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice {
    /// A delta where no light sample could have found what the ray meets: the camera's directions,
    /// and those from most mirrors.
    pub(super) density: Density,
    /// Where the light sample would have been taken: the surface that scattered, or its image in the
    /// mirror that the path met since.
    pub(super) from: DVec3,
    /// The probability with which it would have been taken there.
    pub(super) from_prob: f64,
    /// Whether it would have been taken in a mirror.
    pub(super) in_mirror: bool,
}

impl Choice {
    pub(super) fn of_camera(position: DVec3) -> Self {
        Self { density: Density::Delta, from: position, from_prob: 1.0, in_mirror: false }
    }

    pub(super) fn at_surface(density: Density, position: DVec3) -> Self {
        Self { density, from: position, from_prob: 1.0, in_mirror: false }
    }
}
