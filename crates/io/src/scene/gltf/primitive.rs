use super::accessor::{Accessor, Accessors, Use};
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::{IoError, Place};
use glam::DVec3;
use gltf::json::mesh::{Mode, Semantic};
use gltf::json::validation::Checked::{Invalid, Valid};
use gltf::json::{self, Index};
use std::rc::Rc;

/// A primitive of triangles with open accessors.
pub(super) struct Primitive<'a> {
    pub(super) place: Place,
    pub(super) material: Option<Index<json::Material>>,
    positions: Rc<Accessor<'a>>,
    /// With the place of their accessor.
    indices: Option<(Rc<Accessor<'a>>, Place)>,
    mode: Mode,
}

/// The result of opening a primitive.
pub(super) enum Opened<'a> {
    Triangles(Primitive<'a>),
    /// Points or lines.
    NotTriangles,
    NoPositions,
}

impl<'a> Opened<'a> {
    /// Opens the primitive at `place`.
    pub(super) fn of(
        primitive: &json::mesh::Primitive,
        place: Place,
        accessors: &mut Accessors<'a>,
        loading: &Loading<'_>,
    ) -> Result<Self> {
        let mode = match primitive.mode {
            Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            Valid(_) => return Ok(Self::NotTriangles),
            Invalid => {
                let message = "primitive mode is not supported".into();
                return Err(IoError::Parse { at: loading.at(place), message });
            }
        };
        let Some(positions) = primitive.attributes.get(&Valid(Semantic::Positions)) else {
            return Ok(Self::NoPositions);
        };
        let positions = accessors.open(*positions, Use::Positions, loading)?;
        let mut open = |index: Index<_>| {
            Ok((accessors.open(index, Use::Indices, loading)?, Place::Accessor(index.value())))
        };
        let indices = primitive.indices.map(&mut open).transpose()?;
        Ok(Self::Triangles(Primitive { place, material: primitive.material, positions, indices, mode }))
    }
}

impl Primitive<'_> {
    pub(super) fn vertex_count(&self) -> u64 {
        self.positions.count()
    }

    /// The number of corners in the list.
    fn corner_count(&self) -> u64 {
        self.indices.as_ref().map_or(&self.positions, |(indices, _)| indices).count()
    }

    /// The number of triangles.
    pub(super) fn count(&self) -> u64 {
        match self.mode {
            Mode::Triangles => self.corner_count() / 3,
            _ => self.corner_count().saturating_sub(2),
        }
    }

    /// The number of corners after the last complete triangle.
    pub(super) fn left_over(&self) -> u64 {
        match (self.mode, self.corner_count()) {
            (Mode::Triangles, count) => count % 3,
            (_, count @ (1 | 2)) => count,
            _ => 0,
        }
    }

    /// The corners of triangle `index`, counter-clockwise as seen from its front.
    pub(super) fn get(&self, index: u64, loading: &Loading<'_>) -> Result<[DVec3; 3]> {
        let corners = match self.mode {
            // Odd triangles of a strip have the opposite winding.
            Mode::TriangleStrip if index % 2 == 1 => [index, index + 2, index + 1],
            Mode::TriangleStrip => [index, index + 1, index + 2],
            Mode::TriangleFan => [0, index + 1, index + 2],
            _ => [3 * index, 3 * index + 1, 3 * index + 2],
        };
        let [a, b, c] = corners.map(|corner| self.position(corner, loading));
        Ok([a?, b?, c?])
    }

    /// Where the vertex is.
    fn place_of(&self, vertex: u64) -> Place {
        match self.place {
            Place::Primitive { mesh, primitive } => {
                Place::Vertex { mesh, primitive, vertex: vertex as usize }
            }
            place => place,
        }
    }

    fn position(&self, corner: u64, loading: &Loading<'_>) -> Result<DVec3> {
        let vertex = self.indices.as_ref().map_or(corner, |(indices, _)| indices.index(corner));
        if vertex >= self.positions.count() {
            let at = self.indices.as_ref().map_or(self.place, |(_, place)| *place);
            loading.check_index(at, vertex, self.positions.count() as usize, "vertices")?;
        }
        let position = self.positions.position(vertex);
        if position.is_finite() {
            Ok(position.as_dvec3())
        } else {
            Err(IoError::NonFinite { at: loading.at(self.place_of(vertex)) })
        }
    }
}
