//! The meshes that the benches run on.

use globillum::geom::Triangles;
use globillum::io::load_obj;
use globillum_testkit::shapes;

/// A mesh with its name.
pub(crate) struct Case {
    pub(crate) name: String,
    pub(crate) triangles: Triangles,
}

/// A procedural statue, and the mesh that `GLOBILLUM_MESH` names if there is one.
pub(crate) fn cases() -> Vec<Case> {
    let mut meshes = vec![("statue".to_owned(), shapes::statue(70_000).triangles())];
    if let Ok(path) = std::env::var("GLOBILLUM_MESH") {
        let mesh = load_obj(path.as_ref()).expect("GLOBILLUM_MESH names an OBJ file").model;
        meshes.push((path, mesh.triangles().to_vec()));
    }
    let check = |(name, mesh)| Case { name, triangles: Triangles::new(mesh).expect("the mesh is good") };
    meshes.into_iter().map(check).collect()
}
