use super::accessor::{Indices, Positions, Reader};
use super::json;
use crate::loading::Loading;
use crate::{IoError, Place};
use glam::DVec3;

/// How vertices follow each other.
#[derive(Clone, Copy)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// A primitive made of triangles, its accessors opened.
pub(super) struct Primitive<'a> {
    positions: Positions<'a>,
    indices: Option<Indices<'a>>,
    mode: Mode,
    pub(super) material: Option<u32>,
    indices_at: Place,
    pub(super) place: Place,
}

/// What there is to say of a primitive.
pub(super) enum Opened<'a> {
    Triangles(Box<Primitive<'a>>),
    /// Points or lines.
    NotTriangles,
    NoPositions,
}

/// Opens a primitive that stands at `place`.
pub(super) fn open<'a>(
    primitive: &json::Primitive,
    place: Place,
    reader: &Reader<'a>,
    loading: &Loading<'_>,
) -> Result<Opened<'a>, IoError> {
    let mode = match primitive.mode {
        0..=3 => return Ok(Opened::NotTriangles),
        4 => Mode::Triangles,
        5 => Mode::Strip,
        6 => Mode::Fan,
        mode => {
            return Err(IoError::Parse {
                at: loading.at(place),
                message: format!("mode {mode} is not known"),
            });
        }
    };
    let Some(positions) = primitive.attributes.position else { return Ok(Opened::NoPositions) };
    let positions = reader.positions(positions, loading)?;
    let indices = primitive.indices.map(|index| reader.indices(index, loading)).transpose()?;
    let indices_at = primitive.indices.map_or(place, |index| Place::Accessor(index as usize));
    Ok(Opened::Triangles(Box::new(Primitive {
        positions,
        indices,
        mode,
        material: primitive.material,
        indices_at,
        place,
    })))
}

impl Primitive<'_> {
    pub(super) fn vertex_count(&self) -> u64 {
        self.positions.count()
    }

    /// How many corners follow each other.
    fn corner_count(&self) -> u64 {
        self.indices.as_ref().map_or(self.positions.count(), Indices::count)
    }

    pub(super) fn triangle_count(&self) -> u64 {
        match self.mode {
            Mode::Triangles => self.corner_count() / 3,
            Mode::Strip | Mode::Fan => self.corner_count().saturating_sub(2),
        }
    }

    /// Corners that are too few for one more triangle.
    pub(super) fn left_over(&self) -> u64 {
        match (self.mode, self.corner_count()) {
            (Mode::Triangles, count) => count % 3,
            (_, count @ (1 | 2)) => count,
            _ => 0,
        }
    }

    /// The corners of triangle `index`, counter-clockwise as seen from its front.
    pub(super) fn triangle(&self, index: u64, loading: &Loading<'_>) -> Result<[DVec3; 3], IoError> {
        let corners = match self.mode {
            Mode::Triangles => [3 * index, 3 * index + 1, 3 * index + 2],
            // Every other triangle of a strip is wound the other way round.
            Mode::Strip if index % 2 == 1 => [index, index + 2, index + 1],
            Mode::Strip => [index, index + 1, index + 2],
            Mode::Fan => [0, index + 1, index + 2],
        };
        let [a, b, c] = corners.map(|corner| self.position(corner, loading));
        Ok([a?, b?, c?])
    }

    fn position(&self, corner: u64, loading: &Loading<'_>) -> Result<DVec3, IoError> {
        let vertex = self.indices.as_ref().map_or(corner, |indices| indices.get(corner));
        if vertex >= self.positions.count() {
            return Err(IoError::Index {
                at: loading.at(self.indices_at),
                index: vertex as i64,
                count: self.positions.count() as usize,
                what: "vertices",
            });
        }
        let position = self.positions.get(vertex);
        if position.is_finite() {
            Ok(position.as_dvec3())
        } else {
            Err(IoError::NonFinite { at: loading.at(self.place) })
        }
    }
}
