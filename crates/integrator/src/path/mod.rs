//! Path tracing (Kajiya 1986) in wavefronts: next event estimation, scattering, path reuse and the training of a guide.

mod caustics;
mod choices;
mod counters;
mod emission_rays;
mod first_vertex;
mod large_mirror_rays;
mod light_edges;
mod next_event;
mod numbers;
mod open_sky;
mod path_state;
mod photon_rays;
mod pixel_groups;
mod pixel_rect;
mod probes;
mod render_context;
mod replay;
mod reuse;
mod reuse_vertex;
mod shading_point;
mod small_mirror_rays;
mod stage;
mod supersampling_rays;
mod tile_probes;
mod training;
mod wavefront;

pub use counters::Counters;
pub(crate) use pixel_rect::{BLOCK_SIDE, PixelRect, SIDE as TILE_SIDE};
pub(crate) use probes::probed;
pub(crate) use render_context::RenderContext;
pub use replay::{Replay, Vertex, replay};
pub(crate) use tile_probes::TileProbes;
pub(crate) use training::guide;
pub(crate) use wavefront::Wavefront;
