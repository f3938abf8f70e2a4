use crate::error::Result;
use crate::limits::check_count;
use crate::path::folder_of;
use crate::{IoError, Limits, Location, Place};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// How a file begins that stands for one in Git's large file storage.
const LFS_POINTER: &[u8] = b"version https://git-lfs";

/// Reads the files of one scene: the scene file, and files that it refers to in its own folder or below.
/// No name or link in a file reaches any other file.
pub(crate) struct Jail<'a> {
    scene: &'a Path,
    /// Total bytes that further files may have.
    bytes_left: u64,
    limit: u64,
    /// The files that have been read, in the order of reading.
    pub(crate) files: Vec<PathBuf>,
}

impl<'a> Jail<'a> {
    pub(crate) fn around(scene: &'a Path, limits: &Limits) -> Self {
        Self { scene, bytes_left: limits.bytes, limit: limits.bytes, files: Vec::new() }
    }

    /// Total bytes of the files that have been read.
    pub(crate) fn bytes_read(&self) -> u64 {
        self.limit - self.bytes_left
    }

    /// The path of the file `name`. The location `at` refers to it. If there is no such file, each `\` separates folders as
    /// `/` does: programs for Windows write it.
    pub(crate) fn resolve(&self, name: &str, at: &Location) -> Result<PathBuf> {
        let escape = || IoError::PathEscape { at: at.clone(), name: name.into() };
        let inside =
            Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
        if !inside {
            return Err(escape());
        }
        let path = self.scene.with_file_name(name);
        let failed = |source| IoError::Reference { at: at.clone(), name: name.into(), source };
        // Links may lead outside the folder; the canonical path shows where.
        let folder = folder_of(self.scene).canonicalize().map_err(|source| read_error(self.scene, source))?;
        let within = match path.canonicalize() {
            Err(error) if error.kind() == io::ErrorKind::NotFound && name.contains('\\') => {
                return self.resolve(&name.replace('\\', "/"), at);
            }
            path => path.map_err(failed)?.starts_with(folder),
        };
        if within { Ok(path) } else { Err(escape()) }
    }

    /// Reads the file `path`, which the location `at` refers to as `name`.
    pub(crate) fn read_named(&mut self, path: &Path, name: &str, at: &Location) -> Result<Vec<u8>> {
        let failed = |source| IoError::Reference { at: at.clone(), name: name.into(), source };
        self.read(path).map_err(|error| match error {
            IoError::Read { source, .. } => failed(source),
            IoError::NotRegularFile { .. } => {
                failed(io::Error::new(io::ErrorKind::InvalidInput, "is not a regular file"))
            }
            other => other,
        })
    }

    /// Reads a regular file. Other files are refused, since a FIFO or a device might never end.
    pub(crate) fn read(&mut self, path: &Path) -> Result<Vec<u8>> {
        let failed = |source| read_error(path, source);
        let metadata = fs::metadata(path).map_err(failed)?;
        if !metadata.is_file() {
            return Err(IoError::NotRegularFile { path: path.into() });
        }
        let (limit, read_before) = (self.limit, self.bytes_read());
        let check_size = |bytes: u64| {
            let total = read_before.saturating_add(bytes);
            check_count(total, limit, "bytes in all files of the scene", || Place::File.of(path))
        };
        check_size(metadata.len())?;
        let mut bytes = Vec::new();
        let reserved = bytes.try_reserve_exact(metadata.len() as usize);
        reserved.map_err(|_| failed(io::ErrorKind::OutOfMemory.into()))?;
        // The file may grow while it is being read.
        let mut file = File::open(path).map_err(failed)?.take(self.bytes_left.saturating_add(1));
        file.read_to_end(&mut bytes).map_err(failed)?;
        check_size(bytes.len() as u64)?;
        if bytes.starts_with(LFS_POINTER) {
            let message = "is a Git LFS pointer; `git lfs pull` fetches the file";
            return Err(failed(io::Error::new(io::ErrorKind::InvalidData, message)));
        }
        self.bytes_left -= bytes.len() as u64;
        self.files.push(path.into());
        Ok(bytes)
    }
}

fn read_error(path: &Path, source: io::Error) -> IoError {
    IoError::Read { path: path.into(), source }
}
