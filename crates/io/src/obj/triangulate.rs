use crate::IoError;
use glam::Vec3;
use globillum_geom::Triangle;
use std::collections::HashMap;
use std::io::Read;
use std::panic::catch_unwind;
use std::path::Path;
use tobj::{LoadOptions, Mesh};

/// The meshes of a scanned text, in its order: one for each run of faces of one material, whose
/// id is taken from `material_ids`.
pub(super) fn meshes(
    path: &Path,
    text: &str,
    material_ids: &HashMap<String, usize>,
) -> Result<Vec<Mesh>, IoError> {
    // tobj takes material ids from libraries alone, so all known ones are presented as a library.
    let mut reader = "mtllib all\n".as_bytes().chain(text.as_bytes());
    let options = LoadOptions { triangulate: true, ..LoadOptions::default() };
    // The scan leaves no known way to panic. This belt is for the unknown ones, and holds only
    // where panics unwind.
    let result = catch_unwind(move || {
        tobj::load_obj_buf(&mut reader, &options, |_| Ok((Vec::new(), material_ids.clone())))
    });
    match result {
        Ok(Ok((models, _))) => {
            Ok(models.into_iter().map(|model| model.mesh).filter(|mesh| !mesh.indices.is_empty()).collect())
        }
        Ok(Err(error)) => Err(failed(path, &error.to_string())),
        Err(_) => Err(failed(path, "the parser panicked")),
    }
}

/// The triangles of a mesh that has nothing but triangles.
pub(super) fn triangles(mesh: &Mesh) -> impl Iterator<Item = Triangle> {
    let (positions, _) = mesh.positions.as_chunks::<3>();
    let (corners, _) = mesh.indices.as_chunks::<3>();
    corners.iter().map(|face| Triangle { vertices: face.map(|i| Vec3::from(positions[i as usize])) })
}

/// The error for what the scan should have found.
pub(super) fn failed(path: &Path, message: &str) -> IoError {
    IoError::Parse { path: path.into(), line: None, message: message.into() }
}
