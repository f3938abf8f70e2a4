//! View factors: the fraction of the diffuse radiation that leaves one patch and arrives directly at another.
//!
//! The view factor `F_ij` is the mean, over the points of patch `i` and over directions distributed by the cosine,
//! of the indicator that a ray first meets patch `j` (Howell, A Catalog of Radiation Heat Transfer Configuration
//! Factors, 1982; Modest, Radiative Heat Transfer, 2013, equation 4.16). Here it is the share of the rays from `i`
//! that hit `j`. A ray is counted exactly once, so the factors of a row add up to 1 exactly.
//!
//! [`Patches`] divide the triangles of a scene. A [`FactorRun`] traces the same number of rays from each patch in
//! passes, each a scrambled Sobol' net in four dimensions: point and direction. The counts are [`ViewFactors`],
//! whose errors come from the spread of the passes. [`Reciprocity`] uses `A_i F_ij = A_j F_ji`.
//!
//! # Sides
//! A triangle radiates from its front, from where its vertices run counter-clockwise, and blocks rays on both
//! sides. A ray that hits a back is counted as [`Target::Back`], and belongs neither to that patch, from whose back
//! nothing leaves, nor to the surroundings. A closed body has no such rays. With `Sides::Both`
//! ([`FactorSettings::sides`]) every triangle radiates from both sides and a patch has twice the area of its triangles.
//! A ray that hits nothing goes to the surroundings.
//!
//! ```
//! use glam::Vec3;
//! use globillum_geom::{Triangle, Triangles, WideBvh};
//! use globillum_integrator::view_factors::{FactorRun, FactorSettings, Patches, Target};
//!
//! let [a, b, c] = [Vec3::ZERO, Vec3::X, Vec3::Y];
//! let facing = [a, c, b].map(|v| v + Vec3::Z);
//! let triangles = Triangles::new(vec![Triangle::new(a, b, c), Triangle { vertices: facing }])?;
//! let accel = WideBvh::build(&triangles)?;
//! let patches = Patches::of_triangles(2);
//! let factors = FactorRun::new(&triangles, &accel, &patches, &FactorSettings::new(1 << 14)).run()?;
//! let [across, away] = [Target::Patch(1), Target::Surroundings].map(|target| factors.factor(0, target));
//! assert_eq!(across.hits + away.hits, factors.rays());
//! assert!((across.value - 0.1).abs() < 0.02, "{} +- {}", across.value, across.std_err);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod checkpoint;
mod error;
mod export;
mod factors;
mod patches;
mod reciprocity;
mod row;
mod run;
mod settings;
mod tracer;

pub use error::FactorError;
pub use export::{FactorFormat, FactorTable};
pub use factors::{Factor, FactorAccuracy, Target, ViewFactors};
pub use patches::Patches;
pub use reciprocity::Reciprocity;
pub use run::FactorRun;
pub use settings::FactorSettings;
