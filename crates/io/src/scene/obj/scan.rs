use super::corner;
use super::lines::write;
use super::palette::Palette;
use super::source::Statement;
use super::unknown::UnknownStatements;
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::scene::occurrences::Occurrences;
use crate::scene::range::check_range;
use crate::{IoError, WarningKind};
use glam::Vec3;
use globillum_integrator::MaterialId;

/// The number of corners after which tobj begins a new mesh. tobj takes 104 bytes for a face, and 24 for a
/// corner of a polygon, until it completes the mesh; then it takes 4 bytes for a corner.
const MESH_CORNERS: usize = 1 << 16;

/// Checks the statements of an OBJ file on their way to tobj, and keeps what does not pass.
pub(super) struct Scan<'a> {
    vertices: usize,
    normals: Occurrences,
    colours: Occurrences,
    short_faces: Occurrences,
    points_and_lines: Occurrences,
    free_form: Occurrences,
    unknown: UnknownStatements<'a>,
    /// The number of corners in tobj's current mesh.
    mesh_corners: usize,
    /// The number of triangles of all faces, with degenerate ones.
    pub(super) triangles: usize,
    /// The materials of all faces, each with the number of consecutive faces that have it.
    pub(super) runs: Vec<(MaterialId, usize)>,
    /// The names of objects, each with the number of faces before it; none if nobody asks for them.
    pub(super) objects: Vec<(&'a str, usize)>,
    faces: usize,
    pub(super) palette: Palette<'a>,
}

impl<'a> Scan<'a> {
    /// A scan in which faces before the first `usemtl` have the material `default`.
    pub(super) fn new(default: MaterialId) -> Self {
        Self {
            vertices: 0,
            normals: Occurrences::default(),
            colours: Occurrences::default(),
            short_faces: Occurrences::default(),
            points_and_lines: Occurrences::default(),
            free_form: Occurrences::default(),
            unknown: UnknownStatements::default(),
            mesh_corners: 0,
            triangles: 0,
            runs: Vec::new(),
            objects: Vec::new(),
            faces: 0,
            palette: Palette::new(default),
        }
    }

    /// Checks a statement and writes the line that tobj reads for it: `v x y z`, `v x y z weight`, or `f` and
    /// three vertices or more.
    pub(super) fn pass(
        &mut self,
        statement: &Statement<'a>,
        line: &mut String,
        loading: &mut Loading<'_>,
    ) -> Result<()> {
        match statement.keyword {
            "v" => self.vertex(statement, line)?,
            "f" => self.face(statement, line, loading)?,
            "vn" => self.normals.add(statement.place(), 1),
            "usemtl" => self.palette.use_material(statement, loading)?,
            "mtllib" => self.palette.add_library(statement, loading)?,
            "o" | "g" if loading.objects.is_some() => self.objects.push((statement.arguments, self.faces)),
            "p" | "l" => self.points_and_lines.add(statement.place(), 1),
            "curv" | "curv2" | "surf" | "bsp" | "bzp" | "cdc" | "cdp" => {
                self.free_form.add(statement.place(), 1)
            }
            // Texture coordinates and names.
            "vt" | "o" | "g" | "s" => {}
            // What describes curves and surfaces without being one.
            "vp" | "cstype" | "deg" | "bmat" | "step" | "parm" | "trim" | "hole" | "scrv" | "sp" | "end"
            | "con" | "mg" | "res" | "ctech" | "stech" => {}
            // How other renderers show it.
            "bevel" | "c_interp" | "d_interp" | "lod" | "usemap" | "maplib" | "shadow_obj" | "trace_obj" => {}
            _ => self.unknown.add(statement),
        }
        Ok(())
    }

    /// Adds the warnings about what did not pass.
    pub(super) fn warn(&self, loading: &mut Loading<'_>) {
        self.short_faces.warn(loading, |count| WarningKind::ShortFaces { count });
        self.points_and_lines.warn(loading, |count| WarningKind::NotTriangles { count });
        self.free_form.warn(loading, |count| WarningKind::FreeFormIgnored { count });
        self.unknown.warn(loading);
        self.normals.warn(loading, |count| WarningKind::NormalsIgnored { count });
        self.colours.warn(loading, |count| WarningKind::ColorsIgnored { count });
    }

    fn vertex(&mut self, statement: &Statement<'_>, line: &mut String) -> Result<()> {
        let count = check_position(statement)?;
        let has_colour = count == 6;
        self.colours.add(statement.place(), usize::from(has_colour));
        // tobj refuses a file in which only some vertices have colours.
        write(line, "v", statement.words().take(if has_colour { 3 } else { count }));
        self.vertices += 1;
        Ok(())
    }

    /// `f` and the corners of a polygon. A face with one or two corners does not pass.
    fn face(&mut self, statement: &Statement<'_>, line: &mut String, loading: &Loading<'_>) -> Result<()> {
        let limits = loading.limits;
        let mut corners = 0;
        line.push('f');
        for word in statement.words() {
            line.extend([" ", corner::vertex(statement, word, self.vertices)?]);
            corners += 1;
            statement.check_count(corners, "vertices in a polygon", limits.polygon_corners)?;
        }
        if corners == 0 {
            return Err(statement.malformed("expected at least three vertices"));
        }
        if corners < 3 {
            self.short_faces.add(statement.place(), 1);
            line.clear();
            return Ok(());
        }
        self.triangles += corners - 2;
        statement.check_count(self.triangles, "triangles", limits.triangles)?;
        line.push('\n');
        self.mesh_corners += corners;
        if self.mesh_corners > MESH_CORNERS {
            self.mesh_corners = corners;
            line.insert_str(0, "g\n");
        }
        self.add_face();
        Ok(())
    }

    /// Counts a face of the current material.
    fn add_face(&mut self) {
        self.faces += 1;
        let current = self.palette.current;
        match self.runs.last_mut() {
            Some((material, faces)) if *material == current => *faces += 1,
            _ => self.runs.push((current, 1)),
        }
    }
}

/// Checks the numbers of `v x y z`, `v x y z weight` or `v x y z r g b`, and returns how many they are.
fn check_position(statement: &Statement<'_>) -> Result<usize> {
    let numbers: Result<Vec<f32>> = statement.words().map(|word| statement.number(word)).collect();
    let numbers = numbers?;
    let position = match numbers[..] {
        [x, y, z] | [x, y, z, _, _, _] => Vec3::new(x, y, z),
        [_, _, _, 0.0] => return Err(statement.malformed("weight is zero")),
        [x, y, z, weight] => Vec3::new(x, y, z) / weight,
        _ => return Err(statement.malformed("expected 3, 4 or 6 numbers")),
    };
    if !position.is_finite() {
        return Err(IoError::NonFinite { at: statement.at() });
    }
    check_range("coordinate", position.to_array())
        .map_err(|message| IoError::Domain { at: statement.at(), message })?;
    Ok(numbers.len())
}
