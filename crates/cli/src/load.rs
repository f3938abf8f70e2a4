use crate::warn;
use anyhow::Result;
use globillum::geom::Triangle;
use globillum::io::{Limits, Loaded, Loader, WarningKind};
use std::path::Path;

/// Loads a scene within `limits`, and says what was passed over.
pub fn load(path: &Path, limits: Limits) -> Result<Loaded> {
    let loaded = Loader::new().limits(limits).load(path)?;
    loaded.report.warnings.iter().for_each(warn);
    Ok(loaded)
}

/// Loads the triangles of a file whose materials do not matter, and says what was passed over.
pub fn load_mesh(path: &Path) -> Result<Vec<Triangle>> {
    let loaded = globillum::io::load(path)?;
    let matters = |kind: &WarningKind| !matches!(kind, WarningKind::NoLight);
    loaded.report.warnings.iter().filter(|warning| matters(&warning.kind)).for_each(warn);
    Ok(loaded.model.triangles().to_vec())
}
