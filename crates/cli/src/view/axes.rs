use globillum::glam::{DMat3, DVec3};

/// The axis of a scene that points upward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Up {
    /// As in every glTF file
    Y,
    /// As in Blender and in most CAD programs
    Z,
}

impl Up {
    /// The unit vectors to the right, upward and to the front of the scene, as columns. The front is where
    /// Blender's front view and the usual viewers of glTF look from.
    pub(crate) fn axes(self) -> DMat3 {
        match self {
            Self::Y => DMat3::IDENTITY,
            Self::Z => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        }
    }
}
