use crate::IoError;
use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// A file that appears under its name only once it is complete.
///
/// Until then it is a temporary file in the same folder, which vanishes when this is dropped. So
/// a reader never sees half a file, and a failure leaves the old one as it was.
///
/// The temporary file of `picture.png` is called `.picture.png.`, six random characters, `.tmp`. A
/// process that is killed leaves it behind; whoever next writes a file of that name removes it. It is
/// locked as long as its process lives, so nobody removes one that is still being written.
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
    /// Opens the temporary file, and removes those that killed processes left.
    ///
    /// # Errors
    /// [`IoError::Write`] where the folder can not be written to, or `target` is itself a folder.
    pub fn create(target: &Path) -> Result<Self, IoError> {
        if target.is_dir() {
            return Err(write_error(target, io::ErrorKind::IsADirectory.into()));
        }
        let prefix = prefix_of(target);
        remove_leftovers(folder_of(target), &prefix);
        let temporary = temporary_beside(target, &prefix)
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

const SUFFIX: &str = ".tmp";
/// How many random characters stand before the suffix.
const RANDOM: usize = 6;
/// How much of a target's name is used, so that the temporary one is not too long.
const NAME_CHARS: usize = 48;
/// Another process may take a file for a leftover before it is locked, but not often in a row.
const ATTEMPTS: usize = 8;

/// What the names of a target's temporary files begin with.
fn prefix_of(target: &Path) -> String {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    format!(".{}.", name.chars().take(NAME_CHARS).collect::<String>())
}

/// A new temporary file, locked.
fn temporary_beside(target: &Path, prefix: &str) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(prefix).rand_bytes(RANDOM).suffix(SUFFIX);
    // Private by default; others shall read the result as the umask allows.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    for _ in 0..ATTEMPTS {
        let temporary = builder.tempfile_in(folder_of(target))?;
        match temporary.as_file().try_lock() {
            Err(TryLockError::WouldBlock) => {}
            // Without locks, nobody removes leftovers either.
            Err(TryLockError::Error(_)) => return Ok(temporary),
            Ok(()) if temporary.path().exists() => return Ok(temporary),
            Ok(()) => {}
        }
    }
    Err(io::ErrorKind::ResourceBusy.into())
}

/// Removes the temporary files that nobody holds a lock on: those who wrote them are gone. What
/// can not be removed stays, since nothing depends on it.
fn remove_leftovers(folder: &Path, prefix: &str) {
    let is_temporary = |name: &OsStr| {
        let random = name.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(SUFFIX));
        random
            .is_some_and(|random| random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric()))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| is_temporary(&entry.file_name())) {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        // On Windows a file is opened for writing to be locked.
        if is_file && let Ok(file) = File::options().read(true).write(true).open(entry.path()) {
            // The lock is held until the name is gone, so that none who made it takes it for theirs.
            if file.try_lock().is_ok() {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
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

    #[test]
    fn leftovers_of_the_dead_are_removed_and_files_of_the_living_stay() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let living = AtomicFile::create(&at("a.png")).unwrap();
        let strangers = [".a.png.x.tmp", ".a.png.123456.TMP", ".b.png.123456.tmp", "a.png.123456.tmp"];
        for name in strangers.iter().chain(&[".a.png.123456.tmp", ".a.png.abcXYZ.tmp"]) {
            fs::write(at(name), "left").unwrap();
        }
        fs::create_dir(at(".a.png.folder.tmp")).unwrap();
        AtomicFile::create(&at("a.png")).unwrap().commit(|writer| writer.write_all(NEW)).unwrap();
        let left = names_in(folder.path());
        assert!(strangers.iter().all(|name| left.contains(&(*name).into())), "{left:?}");
        // Beside the strangers: the folder, the new file, and the one still being written.
        assert_eq!(left.len(), strangers.len() + 3, "{left:?}");
        living.commit(|writer| writer.write_all(OLD)).unwrap();
        assert_eq!(fs::read(at("a.png")).unwrap(), OLD);
    }

    #[test]
    fn many_writers_of_one_name_do_not_take_each_others_files() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.png");
        let write = |content: &[u8]| {
            for _ in 0..50 {
                AtomicFile::create(&target).unwrap().commit(|writer| writer.write_all(content)).unwrap();
            }
        };
        std::thread::scope(|scope| {
            [OLD, NEW, OLD, NEW].map(|content| scope.spawn(move || write(content))).map(drop)
        });
        assert_eq!(names_in(folder.path()), ["a.png"]);
        assert!([OLD, NEW].contains(&&fs::read(&target).unwrap()[..]));
    }

    #[test]
    fn the_longest_names_can_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("\u{e4}".repeat(127));
        AtomicFile::create(&target).unwrap().commit(|writer| writer.write_all(NEW)).unwrap();
        assert_eq!(fs::read(&target).unwrap(), NEW);
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
