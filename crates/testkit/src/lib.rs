//! What the project's tests, benches and examples share. Not published.

pub mod cornell;
pub mod reference;
pub mod scenes;
pub mod shapes;
pub mod stats;
