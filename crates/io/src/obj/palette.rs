use super::Warning;
use super::mtl::Description;
use super::source::{Source, Statement};
use crate::IoError;
use globillum_material::Material;
use std::collections::HashMap;
use std::io;
use std::path::{Component, Path, PathBuf};

/// The materials of all libraries that a file names.
#[derive(Default)]
pub(super) struct Palette {
    pub(super) materials: Vec<Material>,
    /// For each name, the position in `materials`.
    pub(super) ids: HashMap<String, usize>,
}

impl Palette {
    /// Reads the libraries that `statements` name; one that does not exist is only warned of.
    pub(super) fn load(statements: &[Statement<'_>], warnings: &mut Vec<Warning>) -> Result<Self, IoError> {
        let mut palette = Self::default();
        for statement in statements {
            match Source::read(&library_path(statement)?) {
                Err(IoError::Read { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                    let (path, line) = statement.place();
                    warnings.push(Warning::MissingLibrary { path, line, name: statement.arguments.into() });
                }
                library => palette.add(&library?, warnings)?,
            }
        }
        Ok(palette)
    }

    /// Adds the materials of one library; a name that is already there gets the new one.
    fn add(&mut self, library: &Source, warnings: &mut Vec<Warning>) -> Result<(), IoError> {
        for (begin, description) in Description::all(library)? {
            let ((path, line), name) = (begin.place(), begin.arguments.to_owned());
            let material = description.material().map_err(|source| IoError::Material {
                path: path.clone(),
                line,
                name: name.clone(),
                source,
            })?;
            if self.ids.insert(name.clone(), self.materials.len()).is_some() {
                let (path, name) = (path.clone(), name.clone());
                warnings.push(Warning::DuplicateMaterial { path, line, name });
            }
            if description.textured {
                warnings.push(Warning::TexturesIgnored { path, line, name });
            }
            self.materials.push(material);
        }
        Ok(())
    }
}

/// Where a library is: in the folder of the file that names it, or below.
fn library_path(statement: &Statement<'_>) -> Result<PathBuf, IoError> {
    let name = Path::new(statement.name()?);
    let inside = name.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if inside {
        Ok(statement.path.with_file_name(name))
    } else {
        let (path, line) = statement.place();
        Err(IoError::Escape { path, line, name: statement.arguments.into() })
    }
}
