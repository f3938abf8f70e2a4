use super::accessor::{Accessor, Accessors, Use};
use super::json;
use crate::error::Result;
use crate::loading::Loading;
use crate::{IoError, Place};
use glam::DVec3;

/// How a list of corners forms triangles.
#[derive(Clone, Copy)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// A primitive of triangles with open accessors. It holds only their indices, since a file may have a
/// primitive for every 30 bytes of JSON.
#[derive(Clone, Copy)]
pub(super) struct Primitive {
    /// Its index in its mesh.
    pub(super) index: u32,
    pub(super) material: Option<u32>,
    positions: u32,
    indices: Option<u32>,
    mode: Mode,
}

/// The result of opening a primitive.
pub(super) enum Opened {
    Triangles(Primitive),
    /// Points or lines.
    NotTriangles,
    NoPositions,
}

/// Opens the primitive at `place`, with this index in its mesh.
pub(super) fn open(
    primitive: &json::Primitive,
    index: u32,
    place: Place,
    accessors: &mut Accessors<'_>,
    loading: &Loading<'_>,
) -> Result<Opened> {
    let mode = match primitive.mode {
        0..=3 => return Ok(Opened::NotTriangles),
        4 => Mode::Triangles,
        5 => Mode::Strip,
        6 => Mode::Fan,
        mode => {
            let message = format!("primitive mode {mode} is not supported");
            return Err(IoError::Parse { at: loading.at(place), message });
        }
    };
    let Some(positions) = primitive.attributes.position else { return Ok(Opened::NoPositions) };
    accessors.open(positions, Use::Positions, loading)?;
    if let Some(indices) = primitive.indices {
        accessors.open(indices, Use::Indices, loading)?;
    }
    let (material, indices) = (primitive.material, primitive.indices);
    Ok(Opened::Triangles(Primitive { index, material, positions, indices, mode }))
}

impl Primitive {
    /// The triangles of this primitive at `place`; `None` if its accessors are not open.
    pub(super) fn triangles<'a>(
        &self,
        place: Place,
        accessors: &'a Accessors<'_>,
    ) -> Option<PrimitiveTriangles<'a>> {
        let positions = accessors.get(self.positions)?;
        let (indices, indices_at) = match self.indices {
            Some(index) => (Some(accessors.get(index)?), Place::Accessor(index as usize)),
            None => (None, place),
        };
        Some(PrimitiveTriangles { positions, indices, mode: self.mode, indices_at, place })
    }
}

/// The triangles of a primitive.
pub(super) struct PrimitiveTriangles<'a> {
    positions: &'a Accessor<'a>,
    indices: Option<&'a Accessor<'a>>,
    mode: Mode,
    indices_at: Place,
    pub(super) place: Place,
}

impl PrimitiveTriangles<'_> {
    pub(super) fn vertex_count(&self) -> u64 {
        self.positions.count()
    }

    /// The number of corners in the list.
    fn corner_count(&self) -> u64 {
        self.indices.unwrap_or(self.positions).count()
    }

    pub(super) fn count(&self) -> u64 {
        match self.mode {
            Mode::Triangles => self.corner_count() / 3,
            Mode::Strip | Mode::Fan => self.corner_count().saturating_sub(2),
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
            Mode::Triangles => [3 * index, 3 * index + 1, 3 * index + 2],
            // Odd triangles of a strip have the opposite winding.
            Mode::Strip if index % 2 == 1 => [index, index + 2, index + 1],
            Mode::Strip => [index, index + 1, index + 2],
            Mode::Fan => [0, index + 1, index + 2],
        };
        let [a, b, c] = corners.map(|corner| self.position(corner, loading));
        Ok([a?, b?, c?])
    }

    fn position(&self, corner: u64, loading: &Loading<'_>) -> Result<DVec3> {
        let vertex = self.indices.map_or(corner, |indices| indices.index(corner));
        loading.check_index(self.indices_at, vertex, self.positions.count() as usize, "vertices")?;
        let position = self.positions.position(vertex);
        if position.is_finite() {
            Ok(position.as_dvec3())
        } else {
            Err(IoError::NonFinite { at: loading.at(self.place) })
        }
    }
}
