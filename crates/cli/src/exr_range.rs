//! Radiance that an OpenEXR file cannot hold.

use crate::output::has_format;
use anyhow::{Result, ensure};
use globillum::io::PictureFormat;
use globillum::material::Rgb;
use std::path::PathBuf;

/// Refuses an environment that the first OpenEXR file among `out` cannot hold, so that it costs no render.
pub(crate) fn check(out: &[PathBuf], environment: Rgb) -> Result<()> {
    let is_exr = |path: &&PathBuf| has_format(path, PictureFormat::Exr);
    let Some(exr) = out.iter().find(is_exr) else { return Ok(()) };
    let (most, limit) = (environment.to_array().into_iter().fold(0.0, f64::max), f32::MAX);
    ensure!(
        most <= limit.into(),
        "--out {}: the environment has a radiance of {most:e}, which exceeds {limit:e}, the most of OpenEXR",
        exr.display()
    );
    Ok(())
}
