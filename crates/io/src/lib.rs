//! Scenes in, pictures out.
//!
//! `load` makes a [`Model`] of a scene file: `load_obj` of Wavefront OBJ with MTL (feature `obj`),
//! `load_gltf` of glTF 2.0 (feature `gltf`). `PictureFile` writes a [`Film`] as PNG or OpenEXR
//! (feature `images`). All features are on by default.
//!
//! What can not be used is never guessed at, nor does it make these functions panic: it is an
//! [`IoError`] that names the file and the place in it. What can be passed over is, and said in a
//! [`LoadReport`]. A file may be broken or hostile: it can make loaders neither hang nor take more
//! memory than [`Limits`] allow, nor read outside its own folder.
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
#[cfg(any(feature = "obj", feature = "gltf"))]
mod jail;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod lights;
mod limits;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod loader;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod loading;
mod location;
#[cfg(feature = "obj")]
mod obj;
mod path;
#[cfg(feature = "images")]
mod picture;
mod plain;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod report;
mod special;
#[cfg(feature = "images")]
mod srgb;
mod temporary;

pub use atomic::AtomicFile;
pub use error::IoError;
#[cfg(feature = "gltf")]
pub use gltf::load_gltf;
pub use limits::Limits;
#[cfg(any(feature = "obj", feature = "gltf"))]
pub use loader::{LoadMonitor, LoadProgress, Loaded, Loader};
pub use location::{Location, Place};
#[cfg(feature = "obj")]
pub use obj::load_obj;
#[cfg(feature = "images")]
pub use picture::{PictureFile, PictureFormat};
#[cfg(any(feature = "obj", feature = "gltf"))]
pub use report::{LoadReport, Warning, WarningKind};

#[cfg(any(feature = "obj", feature = "gltf"))]
/// Loads a scene in the format that its extension names, within the default [`Limits`].
///
/// # Errors
/// Those of [`Loader::load`].
pub fn load(path: &std::path::Path) -> Result<Loaded, IoError> {
    Loader::new().load(path)
}
