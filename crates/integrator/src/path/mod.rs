//! Path tracing (Kajiya 1986) in wavefronts: next event estimation, scattering and path reuse.

mod counters;
mod job;
mod next_event;
mod replay;
mod reuse;
mod reuse_groups;
mod state;
mod tile;
mod vertex;
mod wavefront;

pub use counters::Counters;
pub(crate) use job::Job;
pub use replay::{Replay, Vertex, replay};
pub(crate) use reuse_groups::SIDE as REUSE_BLOCK_SIDE;
pub(crate) use tile::Tile;
pub(crate) use wavefront::Wavefront;
