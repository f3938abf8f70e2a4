//! Scanned meshes, which may not be distributed. Tests report where they are absent.
#![allow(clippy::print_stderr, reason = "reports skipped tests")]

use globillum::geom::Triangle;
use std::path::Path;

/// The scans that exist, with their names.
pub(crate) fn scans() -> impl Iterator<Item = (&'static str, Vec<Triangle>)> {
    ["bunny.obj", "dragon.obj"].into_iter().filter_map(|name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/meshes").join(name);
        if !path.exists() {
            eprintln!("SKIPPED: {name} does not exist; the statue replaces it");
            return None;
        }
        let mesh = globillum::io::load_obj(&path).expect("the mesh is good").model;
        Some((name, mesh.triangles().to_vec()))
    })
}
