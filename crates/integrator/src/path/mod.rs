//! Path tracing (Kajiya 1986) in wavefronts: next event estimation, scattering and path reuse.

mod counters;
mod debug_sample;
mod job;
mod next_event;
mod path_state;
mod reuse;
mod reuse_groups;
mod shading_point;
mod tile_bounds;
mod wavefront;

pub use counters::Counters;
pub use debug_sample::{Replay, Vertex, replay};
pub(crate) use job::Job;
pub(crate) use reuse_groups::SIDE as REUSE_BLOCK_SIDE;
pub(crate) use tile_bounds::Tile;
pub(crate) use wavefront::Wavefront;
