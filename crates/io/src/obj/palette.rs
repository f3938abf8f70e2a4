use super::mtl::Description;
use super::scan::{LIBRARIES, Named};
use super::source::{Source, Statement};
use crate::loading::Loading;
use crate::{IoError, Place, WarningKind};
use std::collections::HashSet;
use std::io;
use std::path::Path;

/// Gives materials that are only named what libraries say of them.
pub(super) struct Palette<'a, 'n, 'm, 'l> {
    named: &'n Named<'a>,
    loading: &'m mut Loading<'l>,
    /// For each name in `named`, whether a library has it.
    is_known: Vec<bool>,
    /// All names that libraries have.
    defined: HashSet<String>,
    /// Materials of all libraries.
    materials: usize,
    /// Names that did not stand for a library as a whole statement.
    libraries: usize,
}

impl<'a, 'n, 'm, 'l> Palette<'a, 'n, 'm, 'l> {
    pub(super) fn new(named: &'n Named<'a>, loading: &'m mut Loading<'l>) -> Self {
        let is_known = vec![false; named.materials.len()];
        Self { named, loading, is_known, defined: HashSet::new(), materials: 0, libraries: 0 }
    }

    /// Reads all libraries. What does not exist, library or material, is only warned of.
    pub(super) fn load(mut self) -> Result<(), IoError> {
        let named = self.named;
        for statement in &named.libraries {
            self.add_named(statement)?;
        }
        for ((first_use, _), is_known) in named.materials.iter().zip(self.is_known) {
            if !is_known {
                let unknown = WarningKind::UnknownMaterial { name: first_use.arguments.into() };
                self.loading.warn(Place::Line(first_use.line), unknown);
            }
        }
        Ok(())
    }

    /// Reads the library that a statement names.
    fn add_named(&mut self, statement: &Statement<'a>) -> Result<(), IoError> {
        if self.add_library(statement, statement.name()?)? {
            return Ok(());
        }
        // Names may have spaces, but several may also follow each other.
        let names = statement.words().count();
        let mut missing = Vec::new();
        for name in statement.words() {
            self.libraries += 1;
            statement.check_count(self.libraries, LIBRARIES, self.loading.limits.materials)?;
            if names == 1 || !self.add_library(statement, name)? {
                missing.push(name);
            }
        }
        let missing = if missing.len() == names { vec![statement.arguments] } else { missing };
        for name in missing {
            let kind = WarningKind::MissingLibrary { name: name.into() };
            self.loading.warn(Place::Line(statement.line), kind);
        }
        Ok(())
    }

    /// Reads a library; `false` if it does not exist.
    fn add_library(&mut self, statement: &Statement<'_>, name: &str) -> Result<bool, IoError> {
        let path = match self.loading.jail.resolve(name, &statement.at()) {
            Err(IoError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                return Ok(false);
            }
            path => path?,
        };
        let bytes = self.loading.jail.read(&path)?;
        let library = Source::of(&path, bytes, self.loading.limits)?;
        self.add(&path, &library)?;
        Ok(true)
    }

    /// Adds the materials of one library; a name that is already there gets the new one.
    fn add(&mut self, path: &Path, library: &Source) -> Result<(), IoError> {
        let limit = self.loading.limits.materials;
        // A library is read to its end before any of its materials is judged.
        let mut count = 0;
        Description::each(library, |begin, _| {
            count += 1;
            begin.check_count(count, "materials", limit)
        })?;
        Description::each(library, |begin, description| {
            let name = begin.arguments;
            let material = description.material().map_err(|source| IoError::Material {
                at: begin.at(),
                name: name.into(),
                source,
            })?;
            self.materials += 1;
            begin.check_count(self.materials, "materials", limit)?;
            let at = || Place::Line(begin.line).of(path);
            if !self.defined.insert(name.into()) {
                self.loading.warn_of(at(), WarningKind::DuplicateMaterial { name: name.into() });
            }
            for kind in description.passed_over(name) {
                self.loading.warn_of(at(), kind);
            }
            if let Some(&position) = self.named.positions.get(name) {
                self.is_known[position] = true;
                self.loading.set_material(self.named.materials[position].1, material);
            }
            Ok(())
        })
    }
}
