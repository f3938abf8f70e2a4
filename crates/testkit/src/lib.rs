//! Shared code of the project's tests, benches and studies. Not published.
#![allow(clippy::missing_panics_doc, reason = "it is for tests, where a panic is the message")]

pub mod accelerators;
pub mod aimed;
pub mod bad_input;
pub mod chi_square;
pub mod form_factor;
pub mod furnace;
pub mod hash;
pub mod meshes;
pub mod polygon;
pub mod precision;
pub mod program;
pub mod query;
pub mod rays;
pub mod reference;
pub mod scenes;
pub mod stats;

pub use globillum_geom::conformance::shapes;
pub use globillum_scenes::cornell;
