use super::mtl::Description;
use super::scan::{LIBRARIES, Named};
use super::source::{Source, Statement};
use crate::error::Result;
use crate::loading::Loading;
use crate::{IoError, WarningKind};
use std::collections::HashSet;
use std::io;

/// Reads the material libraries of an OBJ file and sets the materials that the file names.
pub(super) struct Palette<'a, 'n, 'm, 'l> {
    named: &'n Named<'a>,
    loading: &'m mut Loading<'l>,
    /// Whether a library defines each material of `named`.
    is_known: Vec<bool>,
    /// The names of all materials of all libraries.
    defined: HashSet<String>,
    /// The number of materials of all libraries.
    materials: usize,
    /// The number of library names in statements that name several libraries.
    libraries: usize,
}

impl<'a, 'n, 'm, 'l> Palette<'a, 'n, 'm, 'l> {
    pub(super) fn new(named: &'n Named<'a>, loading: &'m mut Loading<'l>) -> Self {
        let is_known = vec![false; named.materials.len()];
        Self { named, loading, is_known, defined: HashSet::new(), materials: 0, libraries: 0 }
    }

    /// Reads all libraries. A library or material that does not exist causes a warning.
    pub(super) fn load(mut self) -> Result<()> {
        let named = self.named;
        for statement in &named.libraries {
            self.add_named(statement)?;
        }
        for ((first_use, _), is_known) in named.materials.iter().zip(self.is_known) {
            if !is_known {
                let unknown = WarningKind::UnknownMaterial { name: first_use.arguments.into() };
                self.loading.warn(first_use.place(), unknown);
            }
        }
        Ok(())
    }

    /// Reads the library or the libraries that a statement names.
    fn add_named(&mut self, statement: &Statement<'a>) -> Result<()> {
        if self.add_library(statement, statement.name()?)? {
            return Ok(());
        }
        // The arguments are one name with spaces, or several names.
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
            self.loading.warn(statement.place(), kind);
        }
        Ok(())
    }

    /// Reads a library; `false` if it does not exist.
    fn add_library(&mut self, statement: &Statement<'_>, name: &str) -> Result<bool> {
        let path = match self.loading.jail.resolve(name, &statement.at()) {
            Err(IoError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                return Ok(false);
            }
            path => path?,
        };
        let bytes = self.loading.jail.read(&path)?;
        let library = Source::of(&path, bytes, self.loading.limits)?;
        self.add(&library)?;
        Ok(true)
    }

    /// Adds the materials of one library. A second material of the same name replaces the first.
    fn add(&mut self, library: &Source) -> Result<()> {
        let limit = self.loading.limits.materials;
        // A malformed statement anywhere in the library is reported before an invalid material.
        Description::each(library, |begin, _| {
            self.materials += 1;
            begin.check_count(self.materials, "materials", limit)
        })?;
        Description::each(library, |begin, description| {
            let name = begin.arguments;
            let refused = |source| IoError::Material { at: begin.at(), name: name.into(), source };
            let material = description.material().map_err(refused)?;
            if !self.defined.insert(name.into()) {
                self.loading.warn_of(begin.at(), WarningKind::DuplicateMaterial { name: name.into() });
            }
            for kind in description.losses().warnings(name) {
                self.loading.warn_of(begin.at(), kind);
            }
            if let Some(&position) = self.named.positions.get(name) {
                self.is_known[position] = true;
                self.loading.set_material(self.named.materials[position].1, material);
            }
            Ok(())
        })
    }
}
