//! How a surface scatters light.
//!
//! Two ideal surfaces are enough for global illumination to show itself: the Lambertian
//! ([`Bsdf::Lambert`]), which scatters evenly, and the mirror ([`Bsdf::Mirror`]), which does not
//! scatter at all. A [`Material`] adds what the surface emits.
//!
//! Directions are unit vectors in the surface's local frame, `+z` along the geometric normal;
//! `wo` points to where the light goes, `wi` to where it comes from. Densities carry their
//! measure in their type.
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
pub use material::Material;
pub use reflectance::Reflectance;
pub use rgb::Rgb;
pub use srgb::srgb_encode;
