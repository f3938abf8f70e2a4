use glam::{DVec3, Vec3};

/// A point of a surface that receives light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Receiver {
    pub(crate) position: DVec3,
    /// The unit normal on the side of the surface where light counts.
    pub(crate) side: Vec3,
}
