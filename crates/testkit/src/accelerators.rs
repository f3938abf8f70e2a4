//! The accelerators that tests run on: a new one is one line here.

use globillum_geom::{Accel, BruteForce, GeomError, GridOptions, KdOptions, KdTree, Triangles, UniformGrid};

/// Builds an accelerator.
pub type Builder = fn(&Triangles) -> Result<Box<dyn Accel>, GeomError>;

/// Every accelerator by name; brute force, which is slow, comes first.
pub const ACCELERATORS: [(&str, Builder); 3] = [
    ("brute force", |t| Ok(Box::new(BruteForce::build(t)))),
    ("k-d tree", |t| Ok(Box::new(KdTree::build(t, &KdOptions::default())?))),
    ("uniform grid", |t| Ok(Box::new(UniformGrid::build(t, &GridOptions::default())?))),
];

/// Those among them that pictures are made with.
pub const STRUCTURES: [(&str, Builder); 2] = [ACCELERATORS[1], ACCELERATORS[2]];
