use super::mtl::Description;
use super::source::{Source, Statement};
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use globillum_material::Material;
use std::collections::{HashMap, HashSet};
use std::io;
use std::path::Path;

/// The materials of all libraries that a file names.
#[derive(Default)]
pub(super) struct Palette {
    materials: Vec<Material>,
    /// For each name, the position in `materials`.
    ids: HashMap<String, usize>,
}

impl Palette {
    /// Reads the libraries that `statements` name; one that does not exist is only warned of.
    pub(super) fn load(statements: &[Statement<'_>], loading: &mut Loading<'_>) -> Result<Self, IoError> {
        let mut palette = Self::default();
        let mut read = HashSet::new();
        // Some exporters name the library again for every object.
        for statement in statements.iter().filter(|statement| read.insert(statement.arguments)) {
            if palette.add_library(statement, statement.name()?, loading)? {
                continue;
            }
            // Names may have spaces, but several may also follow each other.
            let mut missing: Vec<_> = statement.words().collect();
            let names = missing.len();
            for name in std::mem::take(&mut missing) {
                if names == 1 || !palette.add_library(statement, name, loading)? {
                    missing.push(name);
                }
            }
            let missing = if missing.len() == names { vec![statement.arguments] } else { missing };
            for name in missing {
                loading.warn(Place::Line(statement.line), WarningKind::MissingLibrary { name: name.into() });
            }
        }
        Ok(palette)
    }

    /// The material of that name.
    pub(super) fn get(&self, name: &str) -> Option<Material> {
        self.ids.get(name).map(|&id| self.materials[id])
    }

    /// Reads a library; `false` if it does not exist.
    fn add_library(
        &mut self,
        statement: &Statement<'_>,
        name: &str,
        loading: &mut Loading<'_>,
    ) -> Result<bool, IoError> {
        let path = match loading.jail.resolve(name, &statement.at()) {
            Err(IoError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                return Ok(false);
            }
            path => path?,
        };
        let bytes = loading.jail.read(&path)?;
        let library = Source::of(&path, bytes, loading.limits)?;
        self.add(&path, &library, loading)?;
        Ok(true)
    }

    /// Adds the materials of one library; a name that is already there gets the new one.
    fn add(&mut self, path: &Path, library: &Source, loading: &mut Loading<'_>) -> Result<(), IoError> {
        for (begin, description) in Description::all(library, loading.limits)? {
            let name = begin.arguments;
            let material = description.material().map_err(|source| IoError::Material {
                at: begin.at(),
                name: name.into(),
                source,
            })?;
            begin.check_count(self.materials.len() + 1, "materials", loading.limits.materials)?;
            let place = Place::Line(begin.line);
            if self.ids.insert(name.into(), self.materials.len()).is_some() {
                loading.report.warn(place, path, WarningKind::DuplicateMaterial { name: name.into() });
            }
            for kind in description.passed_over(name) {
                loading.report.warn(place, path, kind);
            }
            self.materials.push(material);
        }
        Ok(())
    }
}
