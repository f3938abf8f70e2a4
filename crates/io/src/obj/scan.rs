use super::face::{self, Counts};
use super::mtl::default_material;
use super::number::fraction;
use super::polygon::is_convex;
use super::source::Statement;
use super::totals::Totals;
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use glam::Vec3;
use globillum_geom::{Triangle, Triangles};
use globillum_integrator::MaterialId;
use std::collections::{HashMap, HashSet};

/// What there may be as many of as there may be materials.
pub(super) const LIBRARIES: &str = "material libraries";

/// An OBJ file read line by line: faces become triangles at once, materials are only named.
pub(super) struct Scan<'a, 'm, 'l> {
    loading: &'m mut Loading<'l>,
    positions: Vec<Vec3>,
    texture_coordinates: usize,
    normals: Occurrences,
    short_faces: Occurrences,
    odd_polygons: Occurrences,
    /// The corners of one face, as indices of `positions`; kept only to be filled again.
    corners: Vec<usize>,
    /// Triangles of all faces, degenerate ones too.
    triangles: u64,
    /// The material of faces to come.
    current: MaterialId,
    library_names: HashSet<&'a str>,
    named: Named<'a>,
}

/// What a file refers to by name.
#[derive(Default)]
pub(super) struct Named<'a> {
    /// Statements that name material libraries, each another one.
    pub(super) libraries: Vec<Statement<'a>>,
    /// For each material, the statement that first uses it.
    pub(super) materials: Vec<(Statement<'a>, MaterialId)>,
    /// For each material's name, its position in `materials`.
    pub(super) positions: HashMap<&'a str, usize>,
}

impl<'a, 'm, 'l> Scan<'a, 'm, 'l> {
    /// A scan that gives faces the material `default` until a statement says otherwise, with room
    /// for what `totals` has counted.
    pub(super) fn new(
        loading: &'m mut Loading<'l>,
        default: MaterialId,
        totals: &Totals,
    ) -> Result<Self, IoError> {
        loading.try_grow(totals.triangles)?;
        let mut positions = Vec::new();
        positions.try_reserve_exact(totals.vertices).map_err(|_| loading.out_of_memory())?;
        Ok(Self {
            loading,
            positions,
            texture_coordinates: 0,
            normals: Occurrences::default(),
            short_faces: Occurrences::default(),
            odd_polygons: Occurrences::default(),
            corners: Vec::with_capacity(totals.corners),
            triangles: 0,
            current: default,
            library_names: HashSet::new(),
            named: Named::default(),
        })
    }

    /// Reads `statements`, of `total` bytes together.
    pub(super) fn run(
        mut self,
        statements: impl Iterator<Item = Statement<'a>>,
        total: usize,
    ) -> Result<Named<'a>, IoError> {
        let (mut done, total) = (0, total as u64);
        for statement in statements {
            done += statement.len();
            self.loading.progress(done.min(total), total)?;
            self.read(&statement)?;
        }
        self.loading.progress(total, total)?;
        self.short_faces.warn(self.loading, |count| WarningKind::ShortFaces { count });
        self.odd_polygons.warn(self.loading, |count| WarningKind::NonConvex { count });
        self.normals.warn(self.loading, |count| WarningKind::NormalsIgnored { count });
        Ok(self.named)
    }

    fn read(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        match statement.keyword {
            "v" => self.positions.push(position(statement)?),
            "f" => self.face(statement)?,
            "vt" => self.texture_coordinates += 1,
            "vn" => self.normals.count(statement),
            "usemtl" => self.material(statement)?,
            "mtllib" => self.library(statement)?,
            // Names, points, lines, curves: nothing that a ray could meet.
            _ => {}
        }
        Ok(())
    }

    /// `f` with three corners or more.
    fn face(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        let limits = self.loading.limits;
        let counts = Counts([self.positions.len(), self.texture_coordinates, self.normals.count]);
        self.corners.clear();
        for word in statement.words() {
            let corner = face::corner(statement, word, &counts)?;
            let count = self.corners.len() + 1;
            statement.check_count(count, "vertices in a polygon", limits.polygon_corners)?;
            self.corners.push(corner);
        }
        match self.corners.len() {
            0 => return Err(statement.malformed("expected at least three vertices")),
            1 | 2 => self.short_faces.count(statement),
            _ => {
                self.triangles += self.corners.len() as u64 - 2;
                statement.check_count(self.triangles as usize, "triangles", limits.triangles)?;
                self.add_fan(statement);
            }
        }
        Ok(())
    }

    /// Cuts the polygon of `corners` into triangles around its first corner.
    fn add_fan(&mut self, statement: &Statement<'a>) {
        let corner = |i: usize| self.positions[self.corners[i]];
        if !is_convex(self.corners.len(), corner) {
            self.odd_polygons.count(statement);
        }
        for i in 2..self.corners.len() {
            self.loading.add(self.current, Triangle::new(corner(0), corner(i - 1), corner(i)));
        }
    }

    /// `mtllib name`. Some exporters name the library again for every object.
    fn library(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        if self.library_names.insert(statement.arguments) {
            let libraries = &mut self.named.libraries;
            statement.check_count(libraries.len() + 1, LIBRARIES, self.loading.limits.materials)?;
            libraries.push(*statement);
        }
        Ok(())
    }

    /// `usemtl name`.
    fn material(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
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
fn position(statement: &Statement<'_>) -> Result<Vec3, IoError> {
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
    let limit = Triangles::MAX_COORDINATE;
    match position.to_array().into_iter().find(|x| x.abs() > limit) {
        Some(x) => {
            let message = format!("coordinate {x:e} exceeds {limit:e} in magnitude");
            Err(IoError::Domain { at: statement.at(), message })
        }
        None => Ok(position),
    }
}

fn wrong_count(statement: &Statement<'_>) -> IoError {
    statement.malformed("expected 3, 4 or 6 numbers")
}

/// Something that is passed over: how often, and where first.
#[derive(Default)]
struct Occurrences {
    first_line: usize,
    count: usize,
}

impl Occurrences {
    fn count(&mut self, statement: &Statement<'_>) {
        if self.count == 0 {
            self.first_line = statement.line;
        }
        self.count += 1;
    }

    fn warn(&self, loading: &mut Loading<'_>, kind: impl FnOnce(usize) -> WarningKind) {
        if self.count > 0 {
            loading.warn(Place::Line(self.first_line), kind(self.count));
        }
    }
}
