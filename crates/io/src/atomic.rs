use crate::IoError;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// A file that appears under its name only once it is complete.
///
/// Until then it is a temporary file in the same folder, which vanishes when this is dropped. So
/// a reader never sees half a file, and a failure leaves the old one as it was.
///
/// ```no_run
/// # fn save(picture: &globillum_integrator::Picture) -> Result<(), globillum_io::IoError> {
/// let file = globillum_io::AtomicFile::create("picture.checkpoint".as_ref())?;
/// file.commit(|writer| writer.write_all(&picture.to_bytes()))
/// # }
/// ```
#[derive(Debug)]
pub struct AtomicFile {
    temporary: NamedTempFile,
    target: PathBuf,
}

impl AtomicFile {
    /// Opens the temporary file.
    ///
    /// # Errors
    /// [`IoError::Write`] where the folder can not be written to, or `target` is itself a folder.
    pub fn create(target: &Path) -> Result<Self, IoError> {
        if target.is_dir() {
            return Err(write_error(target, io::ErrorKind::IsADirectory.into()));
        }
        let temporary = temporary_beside(target)
            // The system's message would name the temporary file.
            .map_err(|e| write_error(target, e.kind().into()))?;
        Ok(Self { temporary, target: target.into() })
    }

    /// Has `fill` write the content, forces it to disk, and puts it in the place of what was
    /// there before.
    ///
    /// # Errors
    /// [`IoError::Write`] with what `fill` or the system says.
    pub fn commit(self, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), IoError> {
        let Self { temporary, target } = self;
        replace(temporary, &target, fill).map_err(|e| write_error(&target, e))
    }
}

fn replace(
    temporary: NamedTempFile,
    target: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let mut writer = BufWriter::new(temporary.as_file());
    fill(&mut writer)?;
    writer.flush()?;
    drop(writer);
    // The content must be on disk before the name points to it, or a crash leaves it empty.
    temporary.as_file().sync_all()?;
    temporary.persist(target)?;
    sync(folder_of(target))
}

fn temporary_beside(target: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".").suffix(".tmp");
    // Private by default; others shall read the result as the umask allows.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder_of(target))
}

/// The folder in which `file` lies.
pub(crate) fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Forces a folder's names to disk, where folders can be opened.
fn sync(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

fn write_error(path: &Path, source: io::Error) -> IoError {
    IoError::Write { path: path.into(), source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const OLD: &[u8] = b"what was there before";
    const NEW: &[u8] = b"what comes instead, rather longer than that";

    fn names_in(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_failed_writer_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("picture");
        fs::write(&target, OLD).unwrap();
        for k in 0..=NEW.len() {
            let result = AtomicFile::create(&target).unwrap().commit(|writer| {
                writer.write_all(&NEW[..k])?;
                writer.flush()?;
                Err(io::ErrorKind::StorageFull.into())
            });
            assert!(matches!(result, Err(IoError::Write { .. })));
            assert_eq!(fs::read(&target).unwrap(), OLD, "failed after {k} bytes");
            assert_eq!(names_in(folder.path()), ["picture"]);
        }
    }

    #[test]
    fn a_complete_file_takes_the_place_of_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("picture");
        for content in [OLD, NEW] {
            let file = AtomicFile::create(&target).unwrap();
            file.commit(|writer| writer.write_all(content)).unwrap();
            assert_eq!(fs::read(&target).unwrap(), content);
            assert_eq!(names_in(folder.path()), ["picture"]);
        }
    }

    #[test]
    fn nothing_is_left_of_an_abandoned_file() {
        let folder = tempfile::tempdir().unwrap();
        drop(AtomicFile::create(&folder.path().join("picture")).unwrap());
        assert!(names_in(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let [ours, plain] = ["ours", "plain"].map(|name| folder.path().join(name));
        AtomicFile::create(&ours).unwrap().commit(|_| Ok(())).unwrap();
        File::create(&plain).unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(ours), mode(plain));
    }

    #[test]
    fn a_bare_name_lies_in_the_current_folder() {
        assert_eq!(folder_of(Path::new("a.png")), Path::new("."));
        assert_eq!(folder_of(Path::new("b/a.png")), Path::new("b"));
    }
}
