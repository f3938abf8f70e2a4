//! Renders: passes over the picture on all threads, until a stop condition holds.

mod key;
mod meter;
mod monitor;
mod pass;
mod pass_loop;
mod render;
mod stop;

pub(crate) use meter::Meter;
pub use monitor::{Monitor, Progress};
pub use render::{Render, render};
pub use stop::{PixelGoal, Stop};
