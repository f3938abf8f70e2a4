//! Path tracing (Kajiya 1986) in wavefronts.
//!
//! [`RenderContext`] is what is rendered. Before the first sample, [`preliminary`] paths train a guide and find what the scene
//! is like, and [`tile_probes`] find what a tile sees. A [`wavefront`] then traces the paths of a tile. At each vertex,
//! [`next_event`] estimation samples lights. After the last bounce, pixels share parts of their paths ([`reuse`]).

mod counters;
mod emission_rays;
mod first_vertex;
mod next_event;
mod path_state;
mod preliminary;
mod render_context;
mod replay;
mod reuse;
mod shading_point;
mod stage;
mod supersampling_rays;
mod tile_probes;
mod wavefront;

pub use counters::Counters;
pub(crate) use preliminary::{guide, probed};
pub(crate) use render_context::RenderContext;
pub use replay::{Replay, Vertex, replay};
pub(crate) use tile_probes::TileProbes;
pub(crate) use wavefront::Wavefront;
