use crate::console::warn;
use crate::interrupt::{Interrupt, NOTHING};
use anyhow::Result;
use globillum::geom::Triangle;
use globillum::io::{IoError, Limits, LoadMonitor, Loaded, Loader, WarningKind};
use std::path::Path;

/// Loads a scene within `limits` unless a signal comes, and warns of what was left out.
pub(crate) fn load(path: &Path, limits: Limits, interrupt: &Interrupt) -> Result<Loaded> {
    let loaded = load_watched(path, limits, interrupt)?;
    loaded.report.warnings.iter().for_each(warn);
    Ok(loaded)
}

/// Loads the triangles of a file whose materials do not matter unless a signal comes, and warns of what was
/// left out.
pub(crate) fn load_triangles(path: &Path, interrupt: &Interrupt) -> Result<Vec<Triangle>> {
    Ok(triangles(&load_watched(path, Limits::default(), interrupt)?))
}

/// Loads the triangles of a file whose materials do not matter, and warns of what was left out.
///
/// # Errors
/// Those of [`globillum::io::load`].
pub fn load_mesh(path: &Path) -> Result<Vec<Triangle>> {
    Ok(triangles(&globillum::io::load(path)?))
}

fn load_watched(path: &Path, limits: Limits, interrupt: &Interrupt) -> Result<Loaded> {
    match Loader::new().limits(limits).monitor(interrupt as &dyn LoadMonitor).load(path) {
        Err(IoError::Cancelled { .. }) => Err(interrupt.error(NOTHING).into()),
        loaded => Ok(loaded?),
    }
}

fn triangles(loaded: &Loaded) -> Vec<Triangle> {
    let matters = |kind: &WarningKind| !matches!(kind, WarningKind::NoLight);
    loaded.report.warnings.iter().filter(|warning| matters(&warning.kind)).for_each(warn);
    loaded.model.triangles().to_vec()
}
