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
mod escaped;
mod limits;
mod location;
mod path;
#[cfg(feature = "images")]
mod picture;
#[cfg(any(feature = "obj", feature = "gltf"))]
mod scene;

pub use atomic::AtomicFile;
pub use error::IoError;
pub use limits::Limits;
pub use location::{Location, Place};
#[cfg(feature = "images")]
pub use picture::{PictureData, PictureFile, PictureFormat};
#[cfg(feature = "gltf")]
pub use scene::load_gltf;
#[cfg(feature = "obj")]
pub use scene::load_obj;
#[cfg(any(feature = "obj", feature = "gltf"))]
pub use scene::{
    LoadMonitor, LoadProgress, LoadReport, Loaded, Loader, NamedMaterial, Object, Warning, WarningKind, load,
};
