//! A k-d tree over triangles: axis-aligned planes split cells, and leaves reference the triangles that
//! overlap them.

mod branch;
mod build;
mod clipping;
mod cost;
mod events;
mod options;
mod plane;
mod rules;
mod stats;
mod sweep;
mod traverse;
mod tree;

pub use options::{KdOptions, SplitRule};
pub use stats::KdStats;
pub use tree::KdTree;
pub(crate) use tree::Node;
