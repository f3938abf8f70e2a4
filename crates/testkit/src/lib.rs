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
pub mod pixels;
pub mod polygon;
pub mod precision;
pub mod program;
pub mod query;
pub mod rays;
pub mod reference;
pub mod scenes;
pub mod stats;

/// How many times as long the slow tests take: the environment variable `GLOBILLUM_EFFORT`, or 1.
pub fn effort() -> u32 {
    std::env::var("GLOBILLUM_EFFORT")
        .map_or(1, |effort| effort.parse().expect("GLOBILLUM_EFFORT is a whole number"))
}

pub use globillum_geom::conformance::shapes;
pub use globillum_scenes::cornell;
