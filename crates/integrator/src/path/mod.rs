//! Path tracing (Kajiya 1986): each sample follows one path of light back from the camera.

mod counters;
mod estimator;
mod next_event;
mod replay;
mod reuse;
mod wave;

pub use counters::Counters;
pub use estimator::Estimator;
pub use replay::{Replay, Vertex, replay};
pub(crate) use wave::{View, Wave, WaveSamples};
