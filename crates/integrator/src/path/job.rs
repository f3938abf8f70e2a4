use crate::{Camera, Scene, Settings};

/// What is rendered: all that the steps of a wave share.
#[derive(Debug)]
pub(crate) struct View<'a, A> {
    pub(crate) scene: &'a Scene<A>,
    pub(crate) camera: &'a Camera,
    pub(crate) settings: &'a Settings,
}

/// The samples of each pixel that one wave takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WaveSamples {
    pub(crate) first: u32,
    pub(crate) count: u32,
}
