//! Temporary files beside the file that they will replace.

use crate::path::folder_of;
use std::ffi::OsStr;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;
use tempfile::{Builder, NamedTempFile};

const SUFFIX: &str = ".tmp";
/// Number of random characters before the suffix.
const RANDOM: usize = 6;
/// Number of characters of the target's name that are used, which bounds the length of the temporary name.
const NAME_CHARS: usize = 48;
/// Another process may take a file for a leftover before it is locked, but not often in a row.
const ATTEMPTS: usize = 8;

/// Creates a locked temporary file beside `target` and removes leftovers of killed processes.
pub(crate) fn beside(target: &Path) -> io::Result<NamedTempFile> {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let prefix = format!(".{}.", name.chars().take(NAME_CHARS).collect::<String>());
    remove_leftovers(folder_of(target), &prefix);
    let mut builder = Builder::new();
    builder.prefix(&prefix).rand_bytes(RANDOM).suffix(SUFFIX);
    // The default is private; the umask decides who may read the result.
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

/// Removes temporary files that no process holds a lock on. Failure to remove one has no effect.
fn remove_leftovers(folder: &Path, prefix: &str) {
    let is_temporary = |name: &OsStr| {
        let random = name.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(SUFFIX));
        random
            .is_some_and(|random| random.len() == RANDOM && random.bytes().all(|b| b.is_ascii_alphanumeric()))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| is_temporary(&entry.file_name())) {
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        // Windows locks only files that are open for writing.
        if is_file && let Ok(file) = File::options().read(true).write(true).open(entry.path()) {
            // Holding the lock until the name is gone keeps the creator from taking the file for its own.
            if file.try_lock().is_ok() {
                let _ = fs::remove_file(entry.path());
            }
        }
    }
}
