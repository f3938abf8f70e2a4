//! Files that are replaced whole or not at all.

mod special;
mod temporary;

use crate::IoError;
use crate::path::folder_of;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::iter;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that appears under its name only when it is complete.
///
/// The content is written to a temporary file in the same folder, which then replaces the target.
/// Readers never see part of a file, and a failure leaves the old file unchanged. Dropping this value
/// removes the temporary file.
///
/// Symbolic links are followed: the file that a link names is replaced or created, and the link stays.
///
/// A target that exists and is not a regular file is never replaced. Devices, FIFOs and the process's own
/// standard output and standard error (`/dev/stdout`, or the file that the shell redirected it to) are
/// written through: there is no temporary file, a failure may leave part of the content written, and the
/// content is not forced to disk. Directories and sockets are refused.
///
/// The temporary file of `picture.png` is named `.picture.png.`, six random characters, `.tmp`. It is
/// locked while its process lives. If the process is killed, the next [`AtomicFile`] of the same name
/// removes the file.
///
/// ```no_run
/// # fn save(picture: &globillum_integrator::Picture) -> Result<(), globillum_io::IoError> {
/// let file = globillum_io::AtomicFile::create("picture.checkpoint")?;
/// file.commit(|writer| writer.write_all(&picture.to_bytes()))
/// # }
/// ```
#[derive(Debug)]
pub struct AtomicFile {
    /// The target as it was named.
    path: PathBuf,
    sink: Sink,
}

#[derive(Debug)]
enum Sink {
    /// Replaces the regular file `target`, or creates it.
    Replace { temporary: NamedTempFile, target: PathBuf },
    /// Is written through.
    Special(File),
}

impl AtomicFile {
    /// Opens the temporary file, or the target itself if it is written through, so that a target that
    /// cannot be written is reported before the content exists.
    ///
    /// Blocks until there is a reader if the target is a FIFO. A process that reads several FIFOs must
    /// open all of them before it waits for the content of one.
    ///
    /// # Errors
    /// [`IoError::Write`] if the folder or the target cannot be written to, or if the target is a
    /// directory or a socket.
    pub fn create(target: impl AsRef<Path>) -> Result<Self, IoError> {
        let target = target.as_ref();
        let sink = Sink::open(target).map_err(|source| write_error(target, source))?;
        Ok(Self { path: target.into(), sink })
    }

    /// The canonical path of the file that one of this name replaces, or creates in its folder. `None` of what is written
    /// through, of folders, and if its folder does not exist.
    pub fn target(path: impl AsRef<Path>) -> Option<PathBuf> {
        let path = path.as_ref();
        if fs::metadata(path).is_ok_and(|found| !special::is_replaced(&found)) {
            return None;
        }
        let target = resolved(path);
        let created = || Some(fs::canonicalize(folder_of(&target)).ok()?.join(target.file_name()?));
        fs::canonicalize(&target).ok().or_else(created)
    }

    /// Writes the content by `fill`, forces it to disk, and replaces the target by it. A target that is
    /// written through is neither forced to disk nor replaced.
    ///
    /// # Errors
    /// [`IoError::Write`] with the error of `fill` or of the operating system; also if the target is
    /// no longer the regular file of [`AtomicFile::create`].
    pub fn commit(self, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), IoError> {
        let written = match self.sink {
            Sink::Special(file) => write(&file, fill),
            Sink::Replace { temporary, target } => {
                write(temporary.as_file(), fill).and_then(|()| replace(temporary, &target))
            }
        };
        written.map_err(|source| write_error(&self.path, source))
    }
}

impl Sink {
    fn open(path: &Path) -> io::Result<Self> {
        if let Some(file) = special::open(path)? {
            return Ok(Self::Special(file));
        }
        let target = resolved(path);
        // The operating system's message would name the temporary file.
        let temporary = temporary::beside(&target).map_err(|error| match error.kind() {
            kind @ ErrorKind::NotFound if !folder_of(&target).is_dir() => {
                io::Error::new(kind, "its folder does not exist")
            }
            ErrorKind::NotFound => io::Error::new(ErrorKind::PermissionDenied, "its folder takes no files"),
            kind => kind.into(),
        })?;
        Ok(Self::Replace { temporary, target })
    }
}

/// The most symbolic links that are followed, as in Linux.
const MAX_LINKS: usize = 40;

/// The name that symbolic links lead to from `path`, whether a file of that name exists or not.
fn resolved(path: &Path) -> PathBuf {
    let next = |path: &PathBuf| Some(folder_of(path).join(fs::read_link(path).ok()?));
    iter::successors(Some(path.to_path_buf()), next).take(1 + MAX_LINKS).last().unwrap_or_default()
}

fn write(file: &File, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    writer.flush()
}

fn replace(temporary: NamedTempFile, target: &Path) -> io::Result<()> {
    if fs::symlink_metadata(target).is_ok_and(|metadata| !metadata.is_file()) {
        return Err(io::Error::other("is no longer a regular file"));
    }
    // The content must be on disk before the name points to it: otherwise a crash leaves an empty file.
    temporary.as_file().sync_all()?;
    temporary.persist(target)?;
    sync(folder_of(target))
}

/// Forces the names in a folder to disk where folders can be opened.
fn sync(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

fn write_error(path: &Path, source: io::Error) -> IoError {
    IoError::Write { path: path.into(), source }
}
