use super::source::Statement;
use crate::loading::Loading;
use crate::{IoError, Limits, Place, WarningKind};
use std::collections::HashMap;

/// What the scan of an OBJ file keeps of it, beside what it passes on to tobj.
#[derive(Default)]
pub(super) struct Seen<'a> {
    /// Statements that name material libraries.
    pub(super) libraries: Vec<Statement<'a>>,
    /// For each material, the statement that first uses it.
    pub(super) materials: Vec<Statement<'a>>,
    /// Faces in the order of the file.
    pub(super) runs: Vec<Run>,
    /// Triangles that the faces make.
    pub(super) triangles: u64,
    /// The first face of fewer than three vertices, and how many there are.
    short_faces: Option<(usize, usize)>,
    /// The first line with a vertex normal, and how many there are.
    normals: Option<(usize, usize)>,
    /// For each name in `materials`, its position there.
    names: HashMap<&'a str, usize>,
    /// The material of faces to come.
    current: Option<usize>,
}

/// Faces that follow each other and are alike.
#[derive(Clone, Copy)]
pub(super) struct Run {
    /// Position in [`Seen::materials`].
    pub(super) material: Option<u32>,
    /// Corners of each face.
    pub(super) corners: u32,
    pub(super) faces: u32,
}

impl<'a> Seen<'a> {
    /// `usemtl name`.
    pub(super) fn material(&mut self, statement: &Statement<'a>, limits: &Limits) -> Result<(), IoError> {
        let name = statement.name()?;
        let next = self.materials.len();
        let id = *self.names.entry(name).or_insert(next);
        if id == next {
            statement.check_count(next + 1, "materials", limits.materials)?;
            self.materials.push(*statement);
        }
        self.current = Some(id);
        Ok(())
    }

    /// `f` with so many corners.
    pub(super) fn face(
        &mut self,
        statement: &Statement<'a>,
        corners: usize,
        limits: &Limits,
    ) -> Result<(), IoError> {
        match corners {
            0 => return Err(statement.malformed("takes three corners or more")),
            1 | 2 => count(&mut self.short_faces, statement),
            _ => {
                statement.check_count(corners, "corners of a polygon", limits.polygon_corners)?;
                self.triangles += corners as u64 - 2;
                statement.check_count(self.triangles as usize, "triangles", limits.triangles)?;
                self.long_face(corners as u32);
            }
        }
        Ok(())
    }

    fn long_face(&mut self, corners: u32) {
        let material = self.current.map(|id| id as u32);
        match self.runs.last_mut() {
            Some(run) if (run.material, run.corners) == (material, corners) => run.faces += 1,
            _ => self.runs.push(Run { material, corners, faces: 1 }),
        }
    }

    /// `vn x y z`.
    pub(super) fn normal(&mut self, statement: &Statement<'a>) {
        count(&mut self.normals, statement);
    }

    /// Reports what was passed over.
    pub(super) fn warn(&self, loading: &mut Loading<'_>) {
        if let Some((line, count)) = self.short_faces {
            loading.warn(Place::Line(line), WarningKind::ShortFaces { count });
        }
        if let Some((line, count)) = self.normals {
            loading.warn(Place::Line(line), WarningKind::NormalsIgnored { count });
        }
    }
}

/// Counts one more, and keeps the line of the first.
fn count(occurrences: &mut Option<(usize, usize)>, statement: &Statement<'_>) {
    occurrences.get_or_insert((statement.line, 0)).1 += 1;
}
