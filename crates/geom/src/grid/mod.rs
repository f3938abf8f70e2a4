//! A uniform grid over triangles: equal cells, each listing the triangles whose boxes touch it.

mod build;
mod lattice;
mod mailbox;
mod traverse;
mod uniform;
mod walk;

pub use build::GridOptions;
pub use uniform::UniformGrid;
