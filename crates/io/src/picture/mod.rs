//! Picture files: PNG and OpenEXR.

mod data;
mod file;
mod openexr;

pub use data::PictureData;
pub use file::{PictureFile, PictureFormat};
