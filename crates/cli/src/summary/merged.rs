use super::error::PictureError;
use crate::checkpoint_coverage::describe_strip;
use globillum::integrator::{CheckpointHeader, CheckpointStrip, ErrorEstimate};

/// Samples, passes and error of a merged picture, as lines of the table; rows only if they differ.
pub(crate) fn of_merged(header: &CheckpointHeader, error: ErrorEstimate) -> String {
    let line = |strip: &CheckpointStrip| {
        format!("samples       {} per pixel, {}\n", strip.samples(), describe_strip(strip, header.height))
    };
    header.strips.iter().map(line).collect::<String>() + &PictureError::from(error).to_string()
}
