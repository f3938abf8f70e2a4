//! Tests of the crates together. `cargo test -p globillum-tests --test suite NAME::` runs those of one file.
#![allow(clippy::unwrap_used, reason = "a panic is the message of a test")]

mod api;
mod architecture;
mod cancel;
mod checkpoint;
mod closed_form;
mod coverage;
mod delta_lights;
mod determinism;
mod equilibrium;
mod error_bars;
mod extremes;
mod farm;
mod finite_form_factors;
mod form_factors;
mod geometry;
mod gltf_reference;
mod in_every_structure;
mod light_leaks;
mod light_samples;
mod materials;
mod mirrors;
mod models;
mod own_estimator;
mod pairwise;
mod path_reuse;
mod public_api;
mod reference;
mod replay;
mod rules;
mod same_scene;
mod scans;
mod solid_angle;
mod stop;
mod streams;
mod warps;
