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
//! fn render(mesh: &str, picture: &str) -> Result<(), Box<dyn std::error::Error>> {
//!     use globillum_io::{PictureFile, load_obj};
//!
//!     let loaded = load_obj(mesh.as_ref())?;
//!     loaded.warnings.iter().for_each(|warning| eprintln!("{warning}"));
//!     let picture = PictureFile::create(picture.as_ref())?; // Fails now rather than in an hour.
//!     picture.write(&trace(&loaded.model))?;
//!     Ok(())
//! }
//! # fn trace(_: &globillum_integrator::Model) -> globillum_integrator::Film { unimplemented!() }
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
