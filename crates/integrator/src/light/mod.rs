//! The lights of a scene, and how points on them are chosen, directly and in plane mirrors.

mod alias_table;
mod lights;
mod mirror_plane;
mod mirrors;
mod sampling;

pub use lights::Lights;
pub(crate) use mirrors::{Image, PlaneMirrors};
pub use sampling::{LightSample, LightSampler, LightSampling};
