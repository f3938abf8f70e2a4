use super::source::Source;
use crate::shapes::Mesh;
use crate::{Accel, Ray};
use glam::DVec3;

/// The features of a mesh that [`leaks`] aims rays at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Points on edges that two triangles share.
    Edges,
    /// Vertices that several triangles share.
    Vertices,
}

/// Casts `rays` rays from the core of a closed `mesh` at its edges or vertices, and returns the number of rays
/// that hit nothing: each is a leak. `accel` must be built from the mesh's triangles.
///
/// # Panics
/// If the mesh has no faces or no core and `rays` is not 0.
pub fn leaks(accel: &dyn Accel, mesh: &Mesh, target: Target, rays: u64, source: &mut impl Source) -> u64 {
    // The accelerator holds the vertices rounded to `f32`.
    let corner = |i: usize| mesh.vertices[i].as_vec3().as_dvec3();
    let leaks = (0..rays).filter(|_| {
        let [a, b, _] = source.pick(&mesh.faces).map(corner);
        let at = match target {
            Target::Vertices => a,
            Target::Edges if source.one_in(2) => (a + b) / 2.0,
            Target::Edges => a + source.unit() * (b - a),
        };
        // Origins spread around the core, so that directions vary.
        let aside = DVec3::new(source.signed(), source.signed(), source.signed());
        let near = mesh.core[source.below(mesh.core.len())];
        let origin = near + aside * (0.1 * mesh.thickness);
        !accel.occluded(&Ray::new(origin, at - origin))
    });
    leaks.count() as u64
}
