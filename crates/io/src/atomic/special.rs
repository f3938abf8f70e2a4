//! Targets that are written through and never replaced: devices, FIFOs and the streams of the process.

use std::fs::{self, File, FileType, Metadata};
use std::io;
use std::path::Path;

/// Opens `path` for writing if it must not be replaced. `None` if it does not exist or is a regular file.
///
/// Opening a FIFO blocks until it has a reader.
pub(crate) fn open(path: &Path) -> io::Result<Option<File>> {
    let metadata = match fs::metadata(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        metadata => metadata?,
    };
    if let Some(stream) = own_stream(&metadata) {
        return Ok(Some(stream));
    }
    match metadata.file_type() {
        kind if kind.is_file() => Ok(None),
        kind if kind.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        kind if is_socket(kind) => Err(io::Error::other("is a socket")),
        _ => File::options().write(true).open(path).map(Some),
    }
}

/// Whether a file that `metadata` describes is replaced: it is regular, and no stream of the process.
pub(crate) fn is_replaced(metadata: &Metadata) -> bool {
    metadata.is_file() && own_stream(metadata).is_none()
}

/// Standard output or standard error, if `metadata` describes it. Opened anew, a file behind it would be
/// written from its start.
#[cfg(unix)]
fn own_stream(metadata: &Metadata) -> Option<File> {
    use std::os::{fd::AsFd, unix::fs::MetadataExt};
    let (stdout, stderr) = (io::stdout(), io::stderr());
    let streams = [stdout.as_fd(), stderr.as_fd()].into_iter();
    let mut files = streams.filter_map(|stream| Some(File::from(stream.try_clone_to_owned().ok()?)));
    files.find(|file| {
        file.metadata().is_ok_and(|own| (own.dev(), own.ino()) == (metadata.dev(), metadata.ino()))
    })
}

#[cfg(unix)]
fn is_socket(kind: FileType) -> bool {
    std::os::unix::fs::FileTypeExt::is_socket(&kind)
}

#[cfg(not(unix))]
fn own_stream(_metadata: &Metadata) -> Option<File> {
    None
}

#[cfg(not(unix))]
fn is_socket(_kind: FileType) -> bool {
    false
}
