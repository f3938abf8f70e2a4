use super::face;
use super::mtl::default_material;
use super::number::fraction;
use super::polygon::is_convex;
use super::source::Statement;
use super::totals::Totals;
use crate::error::Result;
use crate::loading::Loading;
use crate::occurrences::Occurrences;
use crate::range::check_range;
use crate::{IoError, WarningKind};
use glam::Vec3;
use globillum_geom::Triangle;
use globillum_integrator::MaterialId;
use std::collections::{HashMap, HashSet};

/// Libraries in the message of an error. They share the limit of materials.
pub(super) const LIBRARIES: &str = "material libraries";

/// The state of reading an OBJ file line by line. Faces become triangles at once; materials are only named.
pub(super) struct Scan<'a, 'm, 'l> {
    loading: &'m mut Loading<'l>,
    positions: Vec<Vec3>,
    texture_coordinates: usize,
    normals: Occurrences,
    short_faces: Occurrences,
    non_convex: Occurrences,
    /// The corners of one face as indices of `positions`. Reused between faces to avoid reallocation.
    corners: Vec<usize>,
    /// The number of triangles of all faces, with degenerate ones.
    triangles: u64,
    /// The material of the faces that follow.
    current: MaterialId,
    library_names: HashSet<&'a str>,
    named: Named<'a>,
}

/// The libraries and materials that a file names.
#[derive(Default)]
pub(super) struct Named<'a> {
    /// The statements that name material libraries, without repetitions.
    pub(super) libraries: Vec<Statement<'a>>,
    /// Each material with the statement that first uses it.
    pub(super) materials: Vec<(Statement<'a>, MaterialId)>,
    /// The position in `materials` of each material's name.
    pub(super) positions: HashMap<&'a str, usize>,
}

impl<'a, 'm, 'l> Scan<'a, 'm, 'l> {
    /// A scan with memory for `totals`. Faces before the first `usemtl` have the material `default`.
    pub(super) fn new(loading: &'m mut Loading<'l>, default: MaterialId, totals: &Totals) -> Result<Self> {
        loading.try_grow(totals.triangles)?;
        let mut positions = Vec::new();
        positions.try_reserve_exact(totals.vertices).map_err(|_| loading.out_of_memory())?;
        Ok(Self {
            loading,
            positions,
            texture_coordinates: 0,
            normals: Occurrences::default(),
            short_faces: Occurrences::default(),
            non_convex: Occurrences::default(),
            corners: Vec::with_capacity(totals.corners),
            triangles: 0,
            current: default,
            library_names: HashSet::new(),
            named: Named::default(),
        })
    }

    /// Reads `statements`, which have `total` bytes.
    pub(super) fn run(
        mut self,
        statements: impl Iterator<Item = Statement<'a>>,
        total: usize,
    ) -> Result<Named<'a>> {
        let (mut done, total) = (0, total as u64);
        for statement in statements {
            done += statement.len();
            self.loading.progress(done.min(total), total)?;
            self.read(&statement)?;
        }
        self.loading.progress(total, total)?;
        self.short_faces.warn(self.loading, |count| WarningKind::ShortFaces { count });
        self.non_convex.warn(self.loading, |count| WarningKind::NonConvex { count });
        self.normals.warn(self.loading, |count| WarningKind::NormalsIgnored { count });
        Ok(self.named)
    }

    fn read(&mut self, statement: &Statement<'a>) -> Result<()> {
        match statement.keyword {
            "v" => self.positions.push(position(statement)?),
            "f" => self.face(statement)?,
            "vt" => self.texture_coordinates += 1,
            "vn" => self.normals.add(statement.place(), 1),
            "usemtl" => self.material(statement)?,
            "mtllib" => self.library(statement)?,
            // Names, points, lines and curves, which no ray can hit.
            _ => {}
        }
        Ok(())
    }

    /// `f` and the corners of a polygon. A face with one or two corners is skipped.
    fn face(&mut self, statement: &Statement<'a>) -> Result<()> {
        let limits = self.loading.limits;
        let counts = [self.positions.len(), self.texture_coordinates, self.normals.count()];
        self.corners.clear();
        for word in statement.words() {
            let corner = face::corner(statement, word, &counts)?;
            let count = self.corners.len() + 1;
            statement.check_count(count, "vertices in a polygon", limits.polygon_corners)?;
            self.corners.push(corner);
        }
        match self.corners.len() {
            0 => return Err(statement.malformed("expected at least three vertices")),
            1 | 2 => self.short_faces.add(statement.place(), 1),
            _ => {
                self.triangles += self.corners.len() as u64 - 2;
                statement.check_count(self.triangles as usize, "triangles", limits.triangles)?;
                self.add_fan(statement);
            }
        }
        Ok(())
    }

    /// Adds the polygon of `corners` as a triangle fan around its first corner.
    fn add_fan(&mut self, statement: &Statement<'a>) {
        let corner = |i: usize| self.positions[self.corners[i]];
        if !is_convex(self.corners.len(), corner) {
            self.non_convex.add(statement.place(), 1);
        }
        for i in 2..self.corners.len() {
            self.loading.add(self.current, Triangle::new(corner(0), corner(i - 1), corner(i)));
        }
    }

    /// `mtllib name`. Some exporters repeat it for every object.
    fn library(&mut self, statement: &Statement<'a>) -> Result<()> {
        if self.library_names.insert(statement.arguments) {
            let libraries = &mut self.named.libraries;
            statement.check_count(libraries.len() + 1, LIBRARIES, self.loading.limits.materials)?;
            libraries.push(*statement);
        }
        Ok(())
    }

    /// `usemtl name`.
    fn material(&mut self, statement: &Statement<'a>) -> Result<()> {
        let name = statement.name()?;
        let Named { materials, positions, .. } = &mut self.named;
        self.current = match positions.get(name) {
            Some(&position) => materials[position].1,
            None => {
                statement.check_count(materials.len() + 1, "materials", self.loading.limits.materials)?;
                let id = self.loading.add_material(default_material());
                positions.insert(name, materials.len());
                materials.push((*statement, id));
                id
            }
        };
        Ok(())
    }
}

/// `v x y z`, or `v x y z weight`, or `v x y z r g b`.
fn position(statement: &Statement<'_>) -> Result<Vec3> {
    let mut numbers = [0.0; 6];
    let mut count = 0;
    for word in statement.words() {
        let number = fraction(word).map_or_else(|| statement.number(word), Ok)?;
        *numbers.get_mut(count).ok_or_else(|| wrong_count(statement))? = number;
        count += 1;
    }
    let weight = match count {
        3 | 6 => 1.0,
        4 if numbers[3] == 0.0 => return Err(statement.malformed("weight is zero")),
        4 => numbers[3],
        _ => return Err(wrong_count(statement)),
    };
    let position = Vec3::from_slice(&numbers) / weight;
    if !position.is_finite() {
        return Err(IoError::NonFinite { at: statement.at() });
    }
    check_range("coordinate", position.to_array())
        .map_err(|message| IoError::Domain { at: statement.at(), message })?;
    Ok(position)
}

fn wrong_count(statement: &Statement<'_>) -> IoError {
    statement.malformed("expected 3, 4 or 6 numbers")
}
