use super::vertex::Choice;
use crate::sampler::Numbers;
use glam::DVec3;
use globillum_material::Rgb;

/// One path under way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    /// Where in [`Wave::radiance`] its light goes: at first, the number of its sample.
    pub(super) account: u32,
    pub(super) stage: Stage,
    pub(super) numbers: Numbers,
    /// The factor on what arrives, up to where its tail begins.
    pub(super) throughput: Rgb,
    /// The largest factor that this has in any sample that may share the tail.
    pub(super) before: Rgb,
    /// How the direction of its ray was chosen.
    pub(super) choice: Choice,
}

/// How much of a path has been traced, where paths are shared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stage {
    /// Nothing that ends a stem.
    Stem,
    /// Its stem, and no more.
    Scattered,
    /// More than that.
    Beyond,
}

impl Path {
    pub(super) fn from_camera(sample: u32, numbers: Numbers, eye: DVec3) -> Self {
        Self {
            account: sample,
            stage: Stage::Stem,
            numbers,
            throughput: Rgb::WHITE,
            before: Rgb::WHITE,
            choice: Choice::of_camera(eye),
        }
    }
}
