//! The lights of a scene, and how points on them are chosen, directly and in plane mirrors.

mod alias_table;
#[cfg_attr(not(test), expect(dead_code, reason = "scenes do not use delta lights yet"))]
mod delta;
mod lights;
mod mirror_plane;
mod mirrors;
mod sampling;

pub use delta::DeltaLight;
pub use lights::Lights;
pub(crate) use mirrors::{Image, PlaneMirrors};
pub use sampling::{LightSample, LightSampler, LightSampling};
