use super::accessor::Accessors;
use super::document::Document;
use super::json;
use super::material::Materials;
use super::primitive::{self, Opened, Primitive, PrimitiveTriangles};
use super::tree::{Placed, Tree};
use crate::error::Result;
use crate::loading::Loading;
use crate::occurrences::Occurrences;
use crate::range::check_range;
use crate::{IoError, Place, WarningKind};
use glam::{DAffine3, DVec3};
use globillum_geom::Triangle;
use std::ops::Range;

/// Adds the triangles of every placed mesh.
pub(super) fn add_all<'a>(
    document: &'a Document<'a>,
    accessors: Accessors<'a>,
    tree: &Tree<'a>,
    materials: &Materials,
    loading: &mut Loading<'_>,
) -> Result<()> {
    let mut meshes = Meshes::new(document, accessors);
    let mut total = 0_u64;
    tree.walk(loading, |placed, loading| {
        let Some(mesh) = placed.node.mesh else { return Ok(()) };
        total = total.saturating_add(meshes.open(mesh, placed, loading)?);
        // The running total is checked, since many nodes may place one mesh.
        loading.check_triangles(total)
    })?;
    loading.try_grow(total as usize)?;
    meshes.warn(loading);
    let mut done = 0;
    tree.walk(loading, |placed, loading| {
        let Some(mesh) = placed.node.mesh else { return Ok(()) };
        for (primitive, triangles) in meshes.primitives(mesh) {
            let material = materials.get(primitive.material, triangles.place, loading)?;
            for index in 0..triangles.count() {
                let corners = triangles.get(index, loading)?;
                loading.add(material, place(corners, &placed.world, placed.index, loading)?);
                done += 1;
                loading.progress(done, total)?;
            }
        }
        Ok(())
    })
}

/// Transforms a triangle to world space.
fn place(corners: [DVec3; 3], world: &DAffine3, node: usize, loading: &Loading<'_>) -> Result<Triangle> {
    let placed = Triangle::transformed(corners, world);
    check_range("coordinate", placed.vertices.iter().flat_map(|v| v.to_array()))
        .map_err(|message| IoError::Domain { at: loading.at(Place::Node(node)), message })?;
    Ok(placed)
}

/// An opened mesh.
#[derive(Clone)]
struct Mesh {
    /// The range of its primitives with triangles in [`Meshes::primitives`].
    primitives: Range<u32>,
    /// The number of their triangles.
    triangles: u64,
}

/// The meshes that nodes place. Each is opened once.
struct Meshes<'a> {
    document: &'a Document<'a>,
    accessors: Accessors<'a>,
    opened: Vec<Option<Mesh>>,
    primitives: Vec<Primitive>,
    not_triangles: Occurrences,
    left_over: Occurrences,
    normals: Occurrences,
    posed: Option<Place>,
}

impl<'a> Meshes<'a> {
    fn new(document: &'a Document<'a>, accessors: Accessors<'a>) -> Self {
        let opened = vec![None; document.meshes.len()];
        let [not_triangles, left_over, normals] = [(); 3].map(|()| Occurrences::default());
        let (primitives, posed) = (Vec::new(), None);
        Self { document, accessors, opened, primitives, not_triangles, left_over, normals, posed }
    }

    /// Opens mesh `index` of the node `placed` and returns the number of its triangles.
    fn open(&mut self, index: u32, placed: &Placed<'_>, loading: &mut Loading<'_>) -> Result<u64> {
        if placed.node.skin.is_some() {
            self.posed.get_or_insert(Place::Node(placed.index));
        }
        let mesh = index as usize;
        if let Some(Some(opened)) = self.opened.get(mesh) {
            return Ok(opened.triangles);
        }
        let at = Place::Node(placed.index);
        loading.check_index(at, index.into(), self.opened.len(), "meshes")?;
        let Some(json) = self.document.meshes.get(mesh) else { return Ok(0) };
        let (first, mut triangles) = (self.primitives.len() as u32, 0_u64);
        for (number, json) in (0_u32..).zip(json.primitives.iter()) {
            let place = Place::Primitive { mesh, primitive: number as usize };
            match primitive::open(&json, number, place, &mut self.accessors, loading)? {
                Opened::NotTriangles => self.not_triangles.add(place, 1),
                Opened::NoPositions => loading.warn(place, WarningKind::NoPositions),
                Opened::Triangles(primitive) => {
                    triangles = triangles.saturating_add(self.keep(primitive, &json, place));
                }
            }
        }
        let primitives = first..self.primitives.len() as u32;
        self.opened[mesh] = Some(Mesh { primitives, triangles });
        Ok(triangles)
    }

    /// Keeps a primitive if it has triangles, and returns their number.
    fn keep(&mut self, primitive: Primitive, json: &json::Primitive, place: Place) -> u64 {
        let Some(triangles) = primitive.triangles(place, &self.accessors) else { return 0 };
        self.left_over.add(place, triangles.left_over() as usize);
        if json.attributes.normal.is_some() {
            self.normals.add(place, triangles.vertex_count() as usize);
        }
        if json.targets.count > 0 {
            self.posed.get_or_insert(place);
        }
        if triangles.count() > 0 {
            self.primitives.push(primitive);
        }
        triangles.count()
    }

    /// The primitives of an opened mesh, with their triangles.
    fn primitives(&self, mesh: u32) -> impl Iterator<Item = (&Primitive, PrimitiveTriangles<'_>)> {
        let mesh = mesh as usize;
        let opened = self.opened.get(mesh).into_iter().flatten();
        let range = opened.map(|mesh| mesh.primitives.start as usize..mesh.primitives.end as usize);
        let primitives = range.flat_map(|range| &self.primitives[range]);
        primitives.filter_map(move |primitive| {
            let place = Place::Primitive { mesh, primitive: primitive.index as usize };
            Some((primitive, primitive.triangles(place, &self.accessors)?))
        })
    }

    fn warn(&self, loading: &mut Loading<'_>) {
        self.not_triangles.warn(loading, |count| WarningKind::NotTriangles { count });
        self.left_over.warn(loading, |count| WarningKind::LeftOver { count });
        self.normals.warn(loading, |count| WarningKind::NormalsIgnored { count });
        if let Some(place) = self.posed {
            loading.warn(place, WarningKind::PoseIgnored);
        }
    }
}
