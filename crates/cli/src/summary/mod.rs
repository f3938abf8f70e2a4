//! What came of a render, as a table for people and as JSON for programs.

mod error;
mod merged;
mod picture;
mod points;
mod run;

pub(crate) use merged::of_merged;
pub(crate) use picture::PictureSummary;
pub(crate) use points::PointsSummary;
pub(crate) use run::{Timing, reason};
