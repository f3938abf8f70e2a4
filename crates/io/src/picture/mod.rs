//! Picture files: PNG and OpenEXR.

mod data;
mod file;
mod openexr;
mod setting_names;

pub use data::PictureData;
pub use file::{PictureFile, PictureFormat};
