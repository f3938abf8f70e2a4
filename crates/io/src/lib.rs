//! Scene files and picture files.
//!
//! `load` reads a scene file into a [`Model`]: `load_obj` reads Wavefront OBJ with MTL (feature `obj`),
//! `load_gltf` reads glTF 2.0 (feature `gltf`). `PictureFile` writes a [`Film`] as PNG or OpenEXR,
//! `PictureData` reads OpenEXR with the errors of pixels (feature `images`). All features are on by default.
//!
//! Invalid input is an [`IoError`] that names the file and the place in it; it is never guessed at and
//! never causes a panic. Unsupported content is skipped and listed in a [`LoadReport`]. A broken or hostile
//! file cannot make a loader hang, exceed the memory that [`Limits`] allow, or read outside the scene's
//! folder.
//!
//! ```
//! # #[cfg(all(feature = "obj", feature = "images"))]
//! fn picture_of(
//!     scene: &std::path::Path,
//!     picture: &std::path::Path,
//!     trace: impl Fn(&globillum_integrator::Model) -> globillum_integrator::Film,
//! ) -> Result<(), globillum_io::IoError> {
//!     let picture = globillum_io::PictureFile::create(picture)?; // Fails now rather than in an hour.
//!     let loaded = globillum_io::load(scene)?;
//!     picture.write(&trace(&loaded.model))
//! }
//! ```
//!
//! [`Model`]: globillum_integrator::Model
//! [`Film`]: globillum_integrator::Film

mod atomic;
mod error;
#[cfg(feature = "gltf")]
mod gltf;
mod limits;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod lint;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod loader;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod loading;
mod location;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod losses;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod monitor;
#[cfg(feature = "obj")]
mod obj;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod occurrences;
#[cfg(feature = "images")]
mod openexr;
mod path;
#[cfg(feature = "images")]
mod picture;
#[cfg(feature = "images")]
mod picture_data;
mod plain;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod range;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod report;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod scene_files;
mod special;
mod temporary;

pub use atomic::AtomicFile;
pub use error::IoError;
pub use limits::Limits;
#[cfg(any(feature = "obj", feature = "gltf"))]
pub use loader::Loader;
#[cfg(feature = "gltf")]
pub use loader::load_gltf;
#[cfg(feature = "obj")]
pub use loader::load_obj;
#[cfg(any(feature = "obj", feature = "gltf"))]
pub use loading::{Loaded, NamedMaterial, Object};
pub use location::{Location, Place};
#[cfg(any(feature = "obj", feature = "gltf"))]
pub use monitor::{LoadMonitor, LoadProgress};
#[cfg(feature = "images")]
pub use picture::{PictureFile, PictureFormat};
#[cfg(feature = "images")]
pub use picture_data::PictureData;
#[cfg(any(feature = "obj", feature = "gltf"))]
pub use report::{LoadReport, Warning, WarningKind};

#[cfg(any(feature = "obj", feature = "gltf"))]
/// Loads a scene in the format given by the extension of `path`, within the default [`Limits`].
///
/// # Errors
/// Those of [`Loader::load`].
pub fn load(path: impl AsRef<std::path::Path>) -> Result<Loaded, IoError> {
    Loader::new().load(path)
}
