//! The lights of a scene, and how they and points on them are chosen, directly and by way of mirrors.

mod alias_table;
mod child_weights;
mod delta;
mod facet;
mod facets;
mod large_mirrors;
mod light_bounds;
mod light_clusters;
mod lights;
mod mirror_tree;
mod mirrors;
mod receiver;
mod sampling;
mod small_mirrors;
mod tree;
mod unit_of_length;
mod viewpoints;

pub(crate) use alias_table::AliasTable;
pub use delta::{DeltaLight, DeltaLightSample};
pub(crate) use facet::reflection;
pub(crate) use large_mirrors::LargeMirrors;
pub(crate) use lights::Light;
pub use lights::Lights;
pub(crate) use mirrors::Mirrors;
pub(crate) use receiver::Receiver;
pub use sampling::{AreaLightSample, LightSample, LightSampler, LightSampling};
pub(crate) use small_mirrors::{ChosenMirror, MirrorPoint, SmallMirrors};
pub(crate) use tree::ChosenLight;
