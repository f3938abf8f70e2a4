//! Scanned meshes, which may not be distributed: where they are absent, tests say so.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use globillum::geom::Triangle;
use std::path::Path;

/// The scans that are there, with their names.
pub(crate) fn scans() -> impl Iterator<Item = (&'static str, Vec<Triangle>)> {
    ["bunny.obj", "dragon.obj"].into_iter().filter_map(|name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/meshes").join(name);
        if !path.exists() {
            eprintln!("SKIPPED: {name} is not there; the statue stands in for it");
            return None;
        }
        let mesh = globillum::io::load_obj(&path).expect("the mesh is good").model;
        Some((name, mesh.triangles().to_vec()))
    })
}
