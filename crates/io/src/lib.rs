//! Scenes in, pictures out.
//!
//! `load_obj` makes a [`Model`] of a Wavefront OBJ file (feature `obj`); `PictureFile` writes a
//! [`Film`] as PNG or OpenEXR (feature `images`). Both features are on by default.
//!
//! What can not be used is never guessed at, nor does it make these functions panic: it is an
//! [`IoError`] that names the file and, where there is one, the line.
//!
//! ```
//! # #[cfg(all(feature = "obj", feature = "images"))]
//! fn picture_of(
//!     mesh: &std::path::Path,
//!     picture: &std::path::Path,
//!     trace: impl Fn(&globillum_integrator::Model) -> globillum_integrator::Film,
//! ) -> Result<(), globillum_io::IoError> {
//!     let picture = globillum_io::PictureFile::create(picture)?; // Fails now rather than in an hour.
//!     let loaded = globillum_io::load_obj(mesh)?;
//!     picture.write(&trace(&loaded.model))
//! }
//! ```
//!
//! [`Model`]: globillum_integrator::Model
//! [`Film`]: globillum_integrator::Film

mod atomic;
mod error;
#[cfg(feature = "obj")]
mod obj;
#[cfg(feature = "images")]
mod picture;
#[cfg(feature = "images")]
mod srgb;

pub use atomic::AtomicFile;
pub use error::IoError;
#[cfg(feature = "obj")]
pub use obj::{Loaded, Warning, load_obj};
#[cfg(feature = "images")]
pub use picture::{PictureFile, PictureFormat};
