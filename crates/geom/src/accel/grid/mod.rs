//! A uniform grid over triangles: equal cells, each with references to the triangles whose bounds overlap it.

mod build;
mod lattice;
mod mailbox;
mod traverse;
mod uniform;
mod walk;

pub use build::GridOptions;
pub(crate) use lattice::Lattice;
pub use uniform::UniformGrid;
