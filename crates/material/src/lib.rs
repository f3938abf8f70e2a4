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
//! use globillum_material::glam::DVec3; // the crate glam, in the version that this crate takes
//! use globillum_material::{Emission, Material, Rgb, Sides};
//!
//! let grey = Material::lambert(Rgb::splat(0.5))?;
//! let silver = Material::mirror(Rgb::new(0.97, 0.96, 0.92))?;
//! let lamp = Material::light(Rgb::splat(10.0))?; // radiance, W/(m^2 sr)
//! let glowing = grey.emitting(Emission::new(Rgb::splat(0.1), Sides::Both)?);
//! assert!(silver.emission.is_black() && glowing.bsdf == grey.bsdf);
//!
//! // Toward the front and the back, by the cosine with the normal.
//! assert_eq!((lamp.emission.toward(0.5), lamp.emission.toward(-0.5)), (Rgb::splat(10.0), Rgb::BLACK));
//!
//! let sample = grey.bsdf.sample(DVec3::Z, [0.3, 0.7]).expect("seen from above");
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

/// A hash of this crate's sources, comments included, in hexadecimal digits. It is part of the key of a picture,
/// `Render::key` of the crate `globillum-integrator`.
pub const SOURCE_HASH: &str = env!("GLOBILLUM_SOURCE_HASH");
