use super::accessor::Accessors;
use super::document::Document;
use super::json;
use super::material::Materials;
use super::primitive::{self, Opened, Primitive, PrimitiveTriangles};
use super::tree::{Placed, Tree};
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::{DAffine3, DVec3};
use globillum_geom::{Triangle, Triangles};
use std::ops::Range;

/// Adds the triangles of every placed mesh.
pub(super) fn add_all<'a>(
    document: &'a Document<'a>,
    accessors: Accessors<'a>,
    tree: &Tree<'a>,
    materials: &Materials,
    loading: &mut Loading<'_>,
) -> Result<(), IoError> {
    let mut meshes = Meshes::new(document, accessors);
    let mut total = 0_u64;
    tree.walk(loading, |placed, loading| {
        let Some(mesh) = placed.node.mesh else { return Ok(()) };
        total = total.saturating_add(meshes.open(mesh, placed, loading)?);
        // Many nodes may place one mesh: the sum is watched, not only its parts.
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

/// Moves a triangle into the world.
fn place(
    corners: [DVec3; 3],
    world: &DAffine3,
    node: usize,
    loading: &Loading<'_>,
) -> Result<Triangle, IoError> {
    let placed = Triangle::transformed(corners, world);
    let limit = Triangles::MAX_COORDINATE;
    if let Some(x) = placed.vertices.iter().flat_map(|v| v.to_array()).find(|x| !(-limit..=limit).contains(x))
    {
        let message = format!("coordinate {x:e} exceeds {limit:e} in magnitude");
        return Err(IoError::Domain { at: loading.at(Place::Node(node)), message });
    }
    Ok(placed)
}

/// What has been opened of a mesh.
#[derive(Clone)]
struct Mesh {
    /// Where in [`Meshes::primitives`] those are that have triangles.
    primitives: Range<u32>,
    /// How many triangles they have together.
    triangles: u64,
}

/// Meshes that nodes place, each opened once.
struct Meshes<'a> {
    document: &'a Document<'a>,
    accessors: Accessors<'a>,
    opened: Vec<Option<Mesh>>,
    primitives: Vec<Primitive>,
    /// Where first, and how many: primitives of points or lines, vertices left over, normals.
    skipped: Option<(Place, usize)>,
    left_over: Option<(Place, usize)>,
    normals: Option<(Place, usize)>,
    posed: Option<Place>,
}

impl<'a> Meshes<'a> {
    fn new(document: &'a Document<'a>, accessors: Accessors<'a>) -> Self {
        let opened = vec![None; document.meshes.len()];
        let primitives = Vec::new();
        Self {
            document,
            accessors,
            opened,
            primitives,
            skipped: None,
            left_over: None,
            normals: None,
            posed: None,
        }
    }

    /// Opens mesh `index`, which `placed` holds, and returns how many triangles it has.
    fn open(&mut self, index: u32, placed: &Placed<'_>, loading: &mut Loading<'_>) -> Result<u64, IoError> {
        if placed.node.skin.is_some() {
            self.posed.get_or_insert(Place::Node(placed.index));
        }
        let mesh = index as usize;
        if let Some(Some(opened)) = self.opened.get(mesh) {
            return Ok(opened.triangles);
        }
        let json = self.document.meshes.get(mesh).ok_or_else(|| IoError::Index {
            at: loading.at(Place::Node(placed.index)),
            index: index.into(),
            count: self.document.meshes.len(),
            what: "meshes",
        })?;
        let (first, mut triangles) = (self.primitives.len() as u32, 0_u64);
        for (number, json) in (0_u32..).zip(json.primitives.iter()) {
            let place = Place::Primitive { mesh, primitive: number as usize };
            match primitive::open(&json, number, place, &mut self.accessors, loading)? {
                Opened::NotTriangles => count(&mut self.skipped, place, 1),
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

    /// Keeps a primitive if it has triangles, and returns how many.
    fn keep(&mut self, primitive: Primitive, json: &json::Primitive, place: Place) -> u64 {
        let Some(triangles) = primitive.triangles(place, &self.accessors) else { return 0 };
        count(&mut self.left_over, place, triangles.left_over());
        if json.attributes.normal.is_some() {
            count(&mut self.normals, place, triangles.vertex_count());
        }
        if json.targets.count > 0 {
            self.posed.get_or_insert(place);
        }
        if triangles.count() > 0 {
            self.primitives.push(primitive);
        }
        triangles.count()
    }

    /// The primitives of a mesh that has been opened, with their triangles.
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
        if let Some((place, count)) = self.skipped {
            loading.warn(place, WarningKind::NotTriangles { count });
        }
        if let Some((place, count)) = self.left_over {
            loading.warn(place, WarningKind::LeftOver { count });
        }
        if let Some((place, count)) = self.normals {
            loading.warn(place, WarningKind::NormalsIgnored { count });
        }
        if let Some(place) = self.posed {
            loading.warn(place, WarningKind::PoseIgnored);
        }
    }
}

/// Counts more of something, and keeps where it first occurred.
fn count(occurrences: &mut Option<(Place, usize)>, place: Place, more: u64) {
    if more > 0 {
        occurrences.get_or_insert((place, 0)).1 += more as usize;
    }
}
