//! Materials: scattering and emission.
//!
//! A surface is ideally diffuse ([`Bsdf::Lambert`]) or an ideal mirror ([`Bsdf::Mirror`]). A [`Material`]
//! adds its emission.
//!
//! Directions are unit vectors in the surface's local frame, whose `+z` is the geometric normal. `wo` is the
//! outgoing direction and `wi` the incident direction; both point away from the surface. Densities are
//! typed by their measure.
//!
//! ```
//! use globillum_material::{Bsdf, Reflectance, Rgb};
//! use glam::DVec3;
//!
//! let grey = Bsdf::Lambert(Reflectance::new(Rgb::splat(0.5))?);
//! let sample = grey.sample(DVec3::Z, [0.3, 0.7]).expect("seen from above");
//! assert_eq!(sample.weight, Rgb::splat(0.5)); // f |cos| / pdf is exactly the albedo
//! # Ok::<(), globillum_material::MaterialError>(())
//! ```

mod bsdf;
mod emission;
mod error;
mod material;
mod reflectance;
mod rgb;
mod srgb;
pub mod warp;

pub use bsdf::{Bsdf, BsdfSample, Density};
pub use emission::{Emission, Sides};
pub use error::MaterialError;
/// The crate of the vectors that this crate takes and returns, in its version.
pub use glam;
pub use material::Material;
pub use reflectance::Reflectance;
pub use rgb::Rgb;
pub use srgb::srgb_encode;

/// A hash of this crate's sources, comments included, in hexadecimal digits. It is part of the [key](https://docs.rs/globillum-integrator) of a picture.
pub const SOURCE_HASH: &str = env!("GLOBILLUM_SOURCE_HASH");
