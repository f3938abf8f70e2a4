//! The lights of a scene, and how they and points on them are chosen, directly and in plane mirrors.

mod alias_table;
mod delta;
mod lights;
mod mirror_plane;
mod mirrors;
mod sampling;
mod tree;

pub use delta::{DeltaLight, DeltaLightSample};
pub use lights::Lights;
pub(crate) use mirrors::{Image, PlaneMirrors};
pub use sampling::{AreaLightSample, LightSample, LightSampler, LightSampling};
