use super::accessor::Accessors;
use super::document::Document;
use super::material::Materials;
use super::primitive::{Opened, Primitive};
use super::tree::{Placed, Tree};
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::scene::occurrences::Occurrences;
use crate::scene::range::check_range;
use crate::{IoError, Place, WarningKind};
use glam::{DAffine3, DVec3};
use globillum_geom::Triangle;
use gltf::json::mesh::Semantic;
use gltf::json::validation::Checked::Valid;
use gltf::json::{self, Index};

/// Adds the triangles of every placed mesh.
pub(super) fn add_all<'a>(
    document: &'a Document,
    accessors: Accessors<'a>,
    tree: &Tree<'_>,
    materials: &Materials,
    loading: &mut Loading<'_>,
) -> Result<()> {
    let mut meshes = Meshes::new(document, accessors);
    let mut total = 0_u64;
    for placed in tree.placed() {
        let Some(mesh) = placed.node.mesh else { continue };
        total = total.saturating_add(meshes.open(mesh, &placed, loading)?);
        // The running total is checked, since many nodes may place one mesh.
        loading.check_triangles(total)?;
    }
    loading.try_grow(total as usize)?;
    meshes.warn(loading);
    let mut done = 0;
    for placed in tree.placed() {
        let primitives = meshes.placed_by(placed.node);
        if !primitives.is_empty() {
            let name = &placed.node.name;
            loading.begin_object(|| name.clone().unwrap_or_else(|| format!("node {}", placed.index)));
        }
        for primitive in primitives {
            let material = materials.get(primitive.material, primitive.place, loading)?;
            for index in 0..primitive.count() {
                let corners = primitive.get(index, loading)?;
                loading.add(material, place(corners, placed.world, placed.index, loading)?);
                done += 1;
                loading.progress(done, total)?;
            }
        }
    }
    Ok(())
}

/// Transforms a triangle to world space.
fn place(corners: [DVec3; 3], world: &DAffine3, node: usize, loading: &Loading<'_>) -> Result<Triangle> {
    let placed = Triangle::transformed(corners, world);
    check_range("coordinate", placed.vertices.iter().flat_map(|v| v.to_array()))
        .map_err(|message| IoError::Domain { at: loading.at(Place::Node(node)), message })?;
    Ok(placed)
}

/// An opened mesh.
struct Mesh<'a> {
    /// The primitives that have triangles.
    primitives: Vec<Primitive<'a>>,
    /// The number of their triangles.
    triangles: u64,
}

/// The meshes that nodes place. Each is opened once.
struct Meshes<'a> {
    document: &'a Document,
    accessors: Accessors<'a>,
    opened: Vec<Option<Mesh<'a>>>,
    not_triangles: Occurrences,
    left_over: Occurrences,
    normals: Occurrences,
    colors: Occurrences,
    posed: Option<Place>,
}

impl<'a> Meshes<'a> {
    fn new(document: &'a Document, accessors: Accessors<'a>) -> Self {
        let opened = document.meshes.iter().map(|_| None).collect();
        let [not_triangles, left_over, normals, colors] = [(); 4].map(|()| Occurrences::default());
        Self { document, accessors, opened, not_triangles, left_over, normals, colors, posed: None }
    }

    /// Opens mesh `index` of the node `placed` and returns the number of its triangles.
    fn open(
        &mut self,
        index: Index<json::Mesh>,
        placed: &Placed<'_>,
        loading: &mut Loading<'_>,
    ) -> Result<u64> {
        let (at, document) = (Place::Node(placed.index), self.document);
        if placed.node.skin.is_some() {
            self.posed.get_or_insert(at);
        }
        let mesh = loading.check_index(at, index.value() as u64, self.opened.len(), "meshes")?;
        if let Some(opened) = &self.opened[mesh] {
            return Ok(opened.triangles);
        }
        let (mut primitives, mut triangles) = (Vec::new(), 0_u64);
        for (number, json) in document.meshes[mesh].primitives.iter().enumerate() {
            let place = Place::Primitive { mesh, primitive: number };
            match Opened::of(json, place, &mut self.accessors, loading)? {
                Opened::NotTriangles => self.not_triangles.add(place, 1),
                Opened::NoPositions => loading.warn(place, WarningKind::NoPositions),
                Opened::Triangles(primitive) => {
                    self.note(&primitive, json);
                    triangles = triangles.saturating_add(primitive.count());
                    if primitive.count() > 0 {
                        primitives.push(primitive);
                    }
                }
            }
        }
        self.opened[mesh] = Some(Mesh { primitives, triangles });
        Ok(triangles)
    }

    /// Notes what is ignored of a primitive.
    fn note(&mut self, primitive: &Primitive<'_>, json: &json::mesh::Primitive) {
        let place = primitive.place;
        self.left_over.add(place, primitive.left_over() as usize);
        if json.attributes.contains_key(&Valid(Semantic::Normals)) {
            self.normals.add(place, primitive.vertex_count() as usize);
        }
        if json.attributes.contains_key(&Valid(Semantic::Colors(0))) {
            self.colors.add(place, primitive.vertex_count() as usize);
        }
        if json.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
            self.posed.get_or_insert(place);
        }
    }

    /// The primitives with triangles of the mesh of an opened node.
    fn placed_by(&self, node: &json::Node) -> &[Primitive<'a>] {
        let opened = node.mesh.and_then(|mesh| self.opened.get(mesh.value())?.as_ref());
        opened.map_or(&[], |mesh| &mesh.primitives)
    }

    fn warn(&self, loading: &mut Loading<'_>) {
        self.not_triangles.warn(loading, |count| WarningKind::NotTriangles { count });
        self.left_over.warn(loading, |count| WarningKind::LeftOver { count });
        self.normals.warn(loading, |count| WarningKind::NormalsIgnored { count });
        self.colors.warn(loading, |count| WarningKind::ColorsIgnored { count });
        if let Some(place) = self.posed {
            loading.warn(place, WarningKind::PoseIgnored);
        }
    }
}
