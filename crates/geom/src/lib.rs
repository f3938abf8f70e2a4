//! Triangles, and accelerators that intersect rays with them.
//!
//! All accelerators give the same answers, to the bit. In the order of the data flow:
//!
//! - [`Triangles`] are validated [`Triangle`]s, from which every accelerator is built;
//! - [`BruteForce`], [`KdTree`], [`WideBvh`] and [`UniformGrid`] implement [`Accel`], whose documentation
//!   states their common contract;
//! - a query takes a [`Ray`] and returns a [`Hit`], decided by the routine in [`decide`];
//! - [`Triangles::surface_point`] turns the hit into a [`SurfacePoint`], from which rays leave without hitting
//!   the same triangle again.
//!
//! Vertices are `f32`; rays, decisions and points are `f64`. No tolerance or offset of this crate is a length, so a
//! scene may have any scale between limits far from any use: [`Triangle::MAX_COORDINATE`], [`Ray::MAX_ORIGIN`], and
//! `2^-200`, below which an origin coordinate counts as zero in a decision.
//!
//! ```
//! use globillum_geom::glam::{DVec3, Vec3}; // the crate glam, in the version that this crate takes
//! use globillum_geom::{Accel, KdTree, Ray, Triangle, Triangles};
//!
//! let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)])?;
//! let tree = KdTree::build(&triangles)?;
//! let ray = Ray::new(DVec3::new(0.25, 0.25, 1.0), -DVec3::Z);
//! let hit = tree.intersect(&ray).expect("the ray points at the triangle");
//! assert_eq!((hit.t, hit.u, hit.v, hit.triangle), (1.0, 0.25, 0.25, 0));
//! # Ok::<(), globillum_geom::GeomError>(())
//! ```

#![forbid(unsafe_code)]

mod aabb;
mod accel;
mod accurate;
#[cfg(feature = "conformance")]
pub mod conformance;
mod cpu;
pub mod decide;
mod error;
mod frame;
mod hit;
mod measure;
mod ray;
mod rounding;
#[cfg(feature = "shapes")]
pub mod shapes;
mod spherical;
mod surface;
mod triangle;
mod triangles;

pub use aabb::Aabb;
pub use accel::{
    Accel, BruteForce, Counts, GridOptions, KdOptions, KdStats, KdTree, QueryCounter, SplitRule, Traverse,
    UniformGrid, WideBvh,
};
pub use cpu::SimdLevel;
pub use error::GeomError;
pub use frame::Frame;
/// The crate of the vectors that this crate takes and returns, in its version.
pub use glam;
pub use hit::Hit;
pub use measure::{PdfArea, PdfSolidAngle};
pub use ray::Ray;
pub use spherical::SphericalTriangle;
pub use surface::SurfacePoint;
pub use triangle::Triangle;
pub use triangles::Triangles;

/// A hash of this crate's sources, comments included, in hexadecimal digits. It is part of the key of a picture,
/// `Render::key` of the crate `globillum-integrator`.
pub const SOURCE_HASH: &str = env!("GLOBILLUM_SOURCE_HASH");
