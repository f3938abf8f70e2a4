use super::accessor::Reader;
use super::document::Document;
use super::material::Materials;
use super::primitive::{self, Opened, Primitive};
use super::tree::Placed;
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::{DAffine3, DVec3};
use globillum_geom::{Triangle, Triangles};
use std::borrow::Cow;
use std::collections::HashMap;

/// Adds the triangles of every placed mesh.
pub(super) fn add_all(
    document: &Document<'_>,
    buffers: &[Cow<'_, [u8]>],
    placed: &[Placed],
    materials: &Materials,
    loading: &mut Loading<'_>,
) -> Result<(), IoError> {
    let reader = Reader { document, buffers };
    let mut meshes = Meshes::default();
    let mut total = 0_u64;
    for Placed { node, .. } in placed {
        let Some(mesh) = document.nodes[*node].mesh else { continue };
        total = total.saturating_add(meshes.open(mesh, *node, &reader, loading)?.triangles);
        // Many nodes may place one mesh: the sum is watched, not only its parts.
        loading.check_triangles(total)?;
    }
    loading.try_grow(total as usize)?;
    meshes.warn(loading);
    let mut done = 0;
    for Placed { node, world } in placed {
        let mesh = document.nodes[*node].mesh.and_then(|mesh| meshes.opened.get(&mesh));
        for primitive in mesh.into_iter().flat_map(|mesh| &mesh.primitives) {
            let material = materials.get(primitive.material, primitive.place, loading)?;
            for index in 0..primitive.triangle_count() {
                let triangle = place(primitive.triangle(index, loading)?, world, *node, loading)?;
                loading.add(material, triangle);
                done += 1;
                loading.progress(done, total)?;
            }
        }
    }
    Ok(())
}

/// Moves a triangle into the world. A transform that mirrors would turn its front to the back.
fn place(
    corners: [DVec3; 3],
    world: &DAffine3,
    node: usize,
    loading: &Loading<'_>,
) -> Result<Triangle, IoError> {
    let [a, b, c] = corners.map(|corner| world.transform_point3(corner).as_vec3());
    let limit = Triangles::MAX_COORDINATE;
    if let Some(x) = [a, b, c].iter().flat_map(|v| v.to_array()).find(|x| !(-limit..=limit).contains(x)) {
        let message = format!("coordinate {x:e} is beyond {limit:e}");
        return Err(IoError::Domain { at: loading.at(Place::Node(node)), message });
    }
    let mirrored = world.matrix3.determinant() < 0.0;
    Ok(if mirrored { Triangle::new(a, c, b) } else { Triangle::new(a, b, c) })
}

/// The primitives that have triangles, and how many together.
#[derive(Default)]
struct Mesh<'a> {
    primitives: Vec<Primitive<'a>>,
    triangles: u64,
}

/// Meshes that nodes place, each opened once.
#[derive(Default)]
struct Meshes<'a> {
    opened: HashMap<u32, Mesh<'a>>,
    /// Where first, and how many: primitives of points or lines, vertices left over, normals.
    skipped: Option<(Place, usize)>,
    left_over: Option<(Place, usize)>,
    normals: Option<(Place, usize)>,
    posed: Option<Place>,
}

impl<'a> Meshes<'a> {
    fn open(
        &mut self,
        mesh: u32,
        node: usize,
        reader: &Reader<'a>,
        loading: &mut Loading<'_>,
    ) -> Result<&Mesh<'a>, IoError> {
        if reader.document.nodes[node].skin.is_some() {
            self.posed.get_or_insert(Place::Node(node));
        }
        if !self.opened.contains_key(&mesh) {
            let all = &reader.document.meshes;
            let json = all.get(mesh as usize).ok_or_else(|| IoError::Index {
                at: loading.at(Place::Node(node)),
                index: mesh.into(),
                count: all.len(),
                what: "meshes",
            })?;
            let mut opened = Mesh::default();
            for (index, json) in json.primitives.iter().enumerate() {
                let place = Place::Primitive { mesh: mesh as usize, primitive: index };
                match primitive::open(json, place, reader, loading)? {
                    Opened::NotTriangles => count(&mut self.skipped, place, 1),
                    Opened::NoPositions => loading.warn(place, WarningKind::NoPositions),
                    Opened::Triangles(primitive) => {
                        self.note(json, &primitive, place);
                        let triangles = primitive.triangle_count();
                        opened.triangles = opened.triangles.saturating_add(triangles);
                        if triangles > 0 {
                            opened.primitives.push(*primitive);
                        }
                    }
                }
            }
            self.opened.insert(mesh, opened);
        }
        Ok(&self.opened[&mesh])
    }

    fn note(&mut self, json: &super::json::Primitive, primitive: &Primitive<'_>, place: Place) {
        count(&mut self.left_over, place, primitive.left_over());
        if json.attributes.normal.is_some() {
            count(&mut self.normals, place, primitive.vertex_count());
        }
        if !json.targets.is_empty() {
            self.posed.get_or_insert(place);
        }
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
