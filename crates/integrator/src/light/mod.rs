//! The lights of a scene, and how they and points on them are chosen, directly and by way of [`mirrors`].

mod alias_table;
mod area_light;
mod child_weights;
mod delta;
mod descent;
mod lights;
mod mirrors;
mod receiver;
mod sampling;
mod systematic;
mod tree;
mod triangle_part;
mod unit_of_length;

pub(crate) use alias_table::AliasTable;
pub use delta::{DeltaLight, DeltaLightSample};
pub(crate) use lights::Light;
pub use lights::Lights;
pub(crate) use mirrors::{ChosenMirror, LargeMirrors, MirrorPoint, Mirrors, SmallMirrors, reflection};
pub(crate) use receiver::Receiver;
pub use sampling::{AreaLightSample, LightSample, LightSampler, LightSampling};
pub(crate) use tree::{ChosenLight, LightTree, VisibilityCount};
