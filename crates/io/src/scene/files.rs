use crate::error::Result;
use crate::limits::check_count;
use crate::path::folder_of;
use crate::{IoError, Limits, Location, Place};
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

/// How a file begins that stands for one in Git's large file storage.
const LFS_POINTER: &[u8] = b"version https://git-lfs";

/// Where the files of scenes are.
#[derive(Clone, Copy)]
pub(crate) enum Storage<'a> {
    Disk,
    /// Names and contents.
    Memory(&'a [(&'a str, &'a [u8])]),
}

/// Reads the files of one scene: the scene file, and files that it refers to in its own folder or below.
/// No name or link in a file reaches any other file.
pub(crate) struct SceneFiles<'a> {
    scene: &'a Path,
    storage: Storage<'a>,
    /// Total bytes that further files may have.
    bytes_left: u64,
    limit: u64,
    /// The files that have been read, in the order of reading.
    pub(crate) paths_read: Vec<PathBuf>,
}

impl<'a> SceneFiles<'a> {
    pub(crate) fn around(scene: &'a Path, storage: Storage<'a>, limits: &Limits) -> Self {
        Self { scene, storage, bytes_left: limits.bytes, limit: limits.bytes, paths_read: Vec::new() }
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
        match self.is_in_folder(&path, name)? {
            Err(error) if error.kind() == io::ErrorKind::NotFound && name.contains('\\') => {
                self.resolve(&name.replace('\\', "/"), at)
            }
            Err(source) => Err(IoError::Reference { at: at.clone(), name: name.into(), source }),
            Ok(false) => Err(escape()),
            Ok(true) => Ok(path),
        }
    }

    /// Whether the file `path`, called `name`, lies in the scene's folder or below; the inner error if it cannot be found.
    fn is_in_folder(&self, path: &Path, name: &str) -> Result<io::Result<bool>> {
        if let Storage::Memory(files) = self.storage {
            let names_folder = parts(Path::new(name)).next().is_none();
            return Ok(if names_folder { Err(not_regular()) } else { in_memory(files, path).map(|_| true) });
        }
        // Links may lead outside the folder; the canonical path shows where.
        let folder = folder_of(self.scene).canonicalize().map_err(|source| read_error(self.scene, source))?;
        Ok(path.canonicalize().map(|path| path.starts_with(folder)))
    }

    /// What a file has only one of, whatever its names.
    #[cfg(feature = "gltf")]
    pub(crate) fn identity(&self, path: &Path) -> PathBuf {
        match self.storage {
            Storage::Disk => path.canonicalize().unwrap_or_else(|_| path.into()),
            Storage::Memory(_) => parts(path).collect(),
        }
    }

    /// Reads the file `path`, which the location `at` refers to as `name`.
    pub(crate) fn read_named(&mut self, path: &Path, name: &str, at: &Location) -> Result<Vec<u8>> {
        let failed = |source| IoError::Reference { at: at.clone(), name: name.into(), source };
        self.read(path).map_err(|error| match error {
            IoError::Read { source, .. } => failed(source),
            IoError::NotRegularFile { .. } => failed(not_regular()),
            other => other,
        })
    }

    /// Reads a file.
    pub(crate) fn read(&mut self, path: &Path) -> Result<Vec<u8>> {
        let bytes = match self.storage {
            Storage::Disk => self.read_from_disk(path)?,
            Storage::Memory(files) => {
                let content = in_memory(files, path).map_err(|source| read_error(path, source))?;
                self.check_size(path, content.len() as u64)?;
                let mut bytes = reserved(path, content.len())?;
                bytes.extend_from_slice(content);
                bytes
            }
        };
        if bytes.starts_with(LFS_POINTER) {
            let message = "is a Git LFS pointer; `git lfs pull` fetches the file";
            return Err(read_error(path, io::Error::new(io::ErrorKind::InvalidData, message)));
        }
        self.bytes_left -= bytes.len() as u64;
        self.paths_read.push(path.into());
        Ok(bytes)
    }

    /// Reads a regular file. Other files are refused, since a FIFO or a device might never end.
    fn read_from_disk(&self, path: &Path) -> Result<Vec<u8>> {
        let failed = |source| read_error(path, source);
        let metadata = fs::metadata(path).map_err(failed)?;
        if !metadata.is_file() {
            return Err(IoError::NotRegularFile { path: path.into() });
        }
        self.check_size(path, metadata.len())?;
        let mut bytes = reserved(path, metadata.len() as usize)?;
        // The file may grow while it is being read.
        let mut file = File::open(path).map_err(failed)?.take(self.bytes_left.saturating_add(1));
        file.read_to_end(&mut bytes).map_err(failed)?;
        self.check_size(path, bytes.len() as u64)?;
        Ok(bytes)
    }

    /// An error about the file `path` if its `bytes` and those read before exceed the limit.
    fn check_size(&self, path: &Path, bytes: u64) -> Result<()> {
        let total = self.bytes_read().saturating_add(bytes);
        check_count(total, self.limit, "bytes in all files of the scene", || Place::File.of(path))
    }
}

/// Memory for the file `path` of this length.
fn reserved(path: &Path, length: usize) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let reserved = bytes.try_reserve_exact(length);
    reserved.map_err(|_| read_error(path, io::ErrorKind::OutOfMemory.into()))?;
    Ok(bytes)
}

/// The parts of a path without those that change nothing, `.`.
fn parts(path: &Path) -> impl Iterator<Item = Component<'_>> {
    path.components().filter(|part| *part != Component::CurDir)
}

/// The content of the file `path`.
fn in_memory<'a>(files: &[(&str, &'a [u8])], path: &Path) -> io::Result<&'a [u8]> {
    let found = files.iter().find(|(name, _)| parts(Path::new(name)).eq(parts(path)));
    found.map(|&(_, bytes)| bytes).ok_or_else(|| io::ErrorKind::NotFound.into())
}

fn not_regular() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, "is not a regular file")
}

fn read_error(path: &Path, source: io::Error) -> IoError {
    IoError::Read { path: path.into(), source }
}
