use super::polygon::is_convex;
use super::scan::Scan;
use super::seen::Seen;
use super::source::{Source, Statement};
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::Vec3;
use globillum_geom::Triangle;
use globillum_integrator::MaterialId;
use std::panic::{AssertUnwindSafe, catch_unwind};
use tobj::{LoadOptions, Mesh};

/// The triangles of a whole file as one mesh, in the file's order, and what else it says.
pub(super) fn mesh<'a>(source: &'a Source, loading: &mut Loading<'_>) -> Result<(Mesh, Seen<'a>), IoError> {
    let failed = |message: &str| IoError::Parse { at: loading.at(Place::File), message: message.into() };
    let [refused, panicked] = ["the parser refused it", "the parser panicked"].map(failed);
    let mut scan = Scan::new(source.statements(), source.len(), loading);
    let options = LoadOptions { triangulate: true, ..LoadOptions::default() };
    // The scan leaves no known way to panic. This belt is for the unknown ones, and holds only
    // where panics unwind. What a panic leaves behind is thrown away.
    let result = catch_unwind(AssertUnwindSafe(|| {
        tobj::load_obj_buf(&mut scan, &options, |_| Ok(Default::default()))
    }));
    if let Some(failure) = scan.failure {
        return Err(failure);
    }
    match result {
        Ok(Ok((models, _))) => {
            Ok((models.into_iter().next().map(|model| model.mesh).unwrap_or_default(), scan.seen))
        }
        Ok(Err(_)) => Err(refused),
        Err(_) => Err(panicked),
    }
}

/// Gives each triangle its material: `materials` has the default one, then that of each name.
pub(super) fn fill(
    loading: &mut Loading<'_>,
    source: &Source,
    mesh: &Mesh,
    seen: &Seen<'_>,
    materials: &[MaterialId],
) -> Result<(), IoError> {
    loading.reserve(seen.triangles)?;
    let mut triangles = triangles(mesh);
    let mut fan = Vec::new();
    let (mut face, mut odd, mut odd_count) = (0, None, 0);
    for run in &seen.runs {
        let material = materials[run.material.map_or(0, |id| id as usize + 1)];
        for _ in 0..run.faces {
            fan.clear();
            fan.extend(triangles.by_ref().take(run.corners as usize - 2));
            fan.iter().for_each(|triangle| loading.add(material, *triangle));
            if !is_convex(&fan) {
                odd.get_or_insert(face);
                odd_count += 1;
            }
            face += 1;
        }
    }
    if let Some(line) = odd.and_then(|face| line_of(source, face)) {
        loading.warn(Place::Line(line), WarningKind::NonConvex { count: odd_count });
    }
    Ok(())
}

/// The triangles of a mesh that has nothing but triangles.
fn triangles(mesh: &Mesh) -> impl Iterator<Item = Triangle> {
    let (positions, _) = mesh.positions.as_chunks::<3>();
    let (corners, _) = mesh.indices.as_chunks::<3>();
    corners.iter().map(|face| Triangle { vertices: face.map(|i| Vec3::from(positions[i as usize])) })
}

/// The line of a face, counted among those of three corners or more.
fn line_of(source: &Source, face: usize) -> Option<usize> {
    let is_face = |statement: &Statement<'_>| statement.keyword == "f" && statement.words().nth(2).is_some();
    source.statements().filter(is_face).nth(face).map(|statement| statement.line)
}
