//! Path tracing (Kajiya 1986) in wavefronts.
//!
//! [`RenderContext`] is what is rendered. [`preliminary`] paths prepare it before the first sample, and [`tile_probes`] find
//! what a tile sees. A [`wavefront`] then traces samples of the tile:
//!
//! 1. The sensor starts their paths.
//! 2. Bounce by bounce, all paths find their next vertex. Emission is added there with its weight ([`mis`]), lights are
//!    sampled ([`next_event`]), and the path is scattered.
//! 3. After the last bounce, pixels share the suffixes of their paths ([`reuse`]) and the [`caustics`] of first diffuse
//!    vertices.
//! 4. At the edges of lights, more camera rays find the emission ([supersampling](crate::Supersampling)).

mod caustics;
mod counters;
mod diffuse_vertex;
mod emission_rays;
mod light_points;
mod mirrors_left;
mod mis;
mod next_event;
mod path_state;
mod path_vertex;
mod preliminary;
mod radiance_sums;
mod render_context;
mod replay;
mod reuse;
mod reuse_stage;
#[cfg(test)]
mod test_rooms;
mod tile_probes;
mod tile_samples;
mod wavefront;

pub use counters::Counters;
pub(crate) use preliminary::{prepare, train_guide};
pub(crate) use render_context::RenderContext;
pub use replay::{Replay, Vertex, replay, replay_samples};
pub(crate) use tile_probes::TileProbes;
pub(crate) use wavefront::Wavefront;
