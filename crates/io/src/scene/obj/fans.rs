use super::polygon::is_convex;
use super::source::{Source, Statement};
use crate::scene::loading::Loading;
use crate::{Place, WarningKind};
use glam::Vec3;
use globillum_geom::Triangle;
use globillum_integrator::MaterialId;
use std::iter;
use tobj::{Mesh, Model};

/// Adds each face of `models`, which tobj read from `source`, as a triangle fan around its first corner. `runs`
/// are the materials of the faces, each with a number of consecutive faces, `objects` the names of objects, each with
/// the number of faces before it.
pub(super) fn add(
    models: Vec<Model>,
    runs: &[(MaterialId, usize)],
    objects: &[(&str, usize)],
    source: &Source,
    loading: &mut Loading<'_>,
) {
    let mut non_convex = None;
    let mut objects = objects.iter().peekable();
    let mut materials = runs.iter().flat_map(|&(material, faces)| iter::repeat_n(material, faces)).zip(0..);
    for Model { mesh, .. } in models {
        let (positions, _) = mesh.positions.as_chunks::<3>();
        for (face, (material, position)) in faces(&mesh).zip(&mut materials) {
            // Of names without a face between them the last one counts.
            let begun = iter::from_fn(|| objects.next_if(|(_, before)| *before <= position)).last();
            if position == 0 || begun.is_some() {
                let name = begun.map_or("", |(name, _)| name);
                loading.begin_object(|| if name.is_empty() { "default".into() } else { name.into() });
            }
            #[allow(clippy::unnecessary_cast, reason = "another crate may enable tobj's feature `use_f64`")]
            let corner = |i: usize| Vec3::from(positions[face[i] as usize].map(|x| x as f32));
            if !is_convex(face.len(), corner) {
                non_convex.get_or_insert((position, 0)).1 += 1;
            }
            for i in 2..face.len() {
                loading.add(material, Triangle::new(corner(0), corner(i - 1), corner(i)));
            }
        }
    }
    if let Some((first, count)) = non_convex {
        let has_passed = |face: &Statement<'_>| face.keyword == "f" && face.words().nth(2).is_some();
        let place =
            source.statements().filter(has_passed).nth(first).map_or(Place::File, |face| face.place());
        loading.warn(place, WarningKind::NonConvex { count });
    }
}

/// The faces of a mesh, each as the indices of its corners.
fn faces(mesh: &Mesh) -> impl Iterator<Item = &[u32]> {
    let (mut indices, mut counts) = (&mesh.indices[..], mesh.face_arities.iter());
    iter::from_fn(move || {
        // A mesh of triangles has no counts.
        let corners = counts.next().map_or(3, |&count| count as usize);
        let (face, others) = indices.split_at_checked(corners)?;
        indices = others;
        Some(face)
    })
}
