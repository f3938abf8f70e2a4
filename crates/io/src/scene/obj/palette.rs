use super::mtl::{self, default_material};
use super::source::{Source, Statement};
use super::unknown::UnknownStatements;
use crate::error::Result;
use crate::scene::loading::Loading;
use crate::{IoError, WarningKind};
use globillum_integrator::MaterialId;
use std::collections::HashSet;
use std::collections::hash_map::{Entry, HashMap};
use std::{io, mem};

/// The libraries and materials that an OBJ file names. The names do not pass to tobj, which finds a material
/// only if its library is named above it, one library to a statement, and begins a mesh with every change of
/// material.
pub(super) struct Palette<'a> {
    /// The material of the faces that follow.
    pub(super) current: MaterialId,
    /// The first of the statements that name the same libraries: some exporters repeat them for every object.
    libraries: HashMap<&'a str, Statement<'a>>,
    materials: HashMap<&'a str, Used<'a>>,
    /// The number of words in `libraries`, which may be one name or several.
    names: usize,
    /// The number of materials of all libraries, and their names.
    defined: (usize, HashSet<String>),
}

/// A material that the file names.
struct Used<'a> {
    /// The statement that first uses it.
    first: Statement<'a>,
    id: MaterialId,
    is_defined: bool,
}

impl<'a> Palette<'a> {
    /// No names. Faces before the first `usemtl` have the material `default`.
    pub(super) fn new(default: MaterialId) -> Self {
        let (libraries, materials) = (HashMap::new(), HashMap::new());
        Self { current: default, libraries, materials, names: 0, defined: (0, HashSet::new()) }
    }

    /// `mtllib name`.
    pub(super) fn add_library(&mut self, statement: &Statement<'a>, loading: &Loading<'_>) -> Result<()> {
        if let Entry::Vacant(entry) = self.libraries.entry(statement.arguments) {
            entry.insert(*statement);
            self.names += statement.words().count();
        }
        statement.check_count(self.names, "material libraries", loading.limits.materials)
    }

    /// `usemtl name`. The empty name is one like others, since exporters write `usemtl` and `newmtl` without a name.
    pub(super) fn use_material(
        &mut self,
        statement: &Statement<'a>,
        loading: &mut Loading<'_>,
    ) -> Result<()> {
        let count = self.materials.len();
        let used = match self.materials.entry(statement.arguments) {
            Entry::Occupied(used) => used.into_mut(),
            Entry::Vacant(entry) => {
                statement.check_count(count + 1, "materials", loading.limits.materials)?;
                let id = loading.add_named_material(statement.arguments.into(), default_material());
                entry.insert(Used { first: *statement, id, is_defined: false })
            }
        };
        self.current = used.id;
        Ok(())
    }

    /// Reads all libraries and sets the materials that the file names. A library or material that does not
    /// exist causes a warning.
    pub(super) fn load(mut self, loading: &mut Loading<'_>) -> Result<()> {
        for statement in in_order(mem::take(&mut self.libraries).into_values()) {
            self.read_named(&statement, loading)?;
        }
        let undefined = self.materials.into_values().filter(|used| !used.is_defined);
        for first in in_order(undefined.map(|used| used.first)) {
            loading.warn(first.place(), WarningKind::UnknownMaterial { name: first.arguments.into() });
        }
        Ok(())
    }

    /// Reads the libraries that a statement names: its arguments are one name with spaces, or several names.
    fn read_named(&mut self, statement: &Statement<'a>, loading: &mut Loading<'_>) -> Result<()> {
        if self.read_library(statement, statement.name()?, loading)? {
            return Ok(());
        }
        let mut missing = Vec::new();
        for name in statement.words() {
            if !self.read_library(statement, name, loading)? {
                missing.push(name);
            }
        }
        if missing.len() == statement.words().count() {
            missing = vec![statement.arguments];
        }
        for name in missing {
            loading.warn(statement.place(), WarningKind::MissingLibrary { name: name.into() });
        }
        Ok(())
    }

    /// Reads a library; `false` if it does not exist.
    fn read_library(
        &mut self,
        statement: &Statement<'_>,
        name: &str,
        loading: &mut Loading<'_>,
    ) -> Result<bool> {
        let path = match loading.files.resolve(name, &statement.at()) {
            Err(IoError::Reference { source, .. }) if is_missing(source.kind()) => return Ok(false),
            path => path?,
        };
        let bytes = loading.files.read_named(&path, name, &statement.at())?;
        self.define(&Source::of(&path, bytes, loading)?, loading)?;
        Ok(true)
    }

    /// Sets the materials of a library. A second material of the same name replaces the first.
    fn define(&mut self, library: &Source, loading: &mut Loading<'_>) -> Result<()> {
        let (count, names) = &mut self.defined;
        let mut unknown = UnknownStatements::default();
        let descriptions = mtl::read(library, &mut unknown, |begin| {
            *count += 1;
            begin.check_count(*count, "materials", loading.limits.materials)
        })?;
        for description in descriptions {
            let (begin, name) = (description.begin, description.begin.arguments);
            let refused = |(at, source)| IoError::Material { at, name: name.into(), source };
            let material = description.material().map_err(refused)?;
            if !names.insert(name.into()) {
                loading.warn_of(begin.at(), WarningKind::DuplicateMaterial { name: name.into() });
            }
            for kind in description.losses().warnings(name) {
                loading.warn_of(begin.at(), kind);
            }
            if let Some(used) = self.materials.get_mut(name) {
                used.is_defined = true;
                loading.set_material(used.id, material);
            }
        }
        unknown.warn(loading);
        Ok(())
    }
}

/// Statements in the order of the file.
fn in_order<'a>(statements: impl Iterator<Item = Statement<'a>>) -> Vec<Statement<'a>> {
    let mut all: Vec<_> = statements.collect();
    all.sort_unstable_by_key(|statement| statement.line);
    all
}

/// Whether there is no file of a name. Several names together may be too long for one.
fn is_missing(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::NotFound | io::ErrorKind::InvalidFilename)
}
