//! A hash of a crate's sources, made when it is built.
//!
//! A build script of one line makes it; `env!("GLOBILLUM_SOURCE_HASH")` in the crate is its value, 16 hexadecimal
//! digits:
//!
//! ```no_run
//! fn main() -> std::io::Result<()> {
//!     globillum_source_hash::emit()
//! }
//! ```
//!
//! The hash covers the names and contents of all files below `src`, sorted by name, without carriage returns. It does not
//! cover paths outside the crate, times, features, the compiler or dependencies, so equal checkouts have equal hashes on
//! every machine.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// The environment variable that the compiler gets.
const VARIABLE: &str = "GLOBILLUM_SOURCE_HASH";

/// In a build script: hands the hash of the crate's `src` to the compiler, and has the script run again when a
/// file in it changes.
///
/// # Errors
/// If the sources cannot be read.
#[allow(clippy::print_stdout, reason = "that is how a build script talks to cargo")]
pub fn emit() -> io::Result<()> {
    let root = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    println!("cargo::rerun-if-changed=src");
    println!("cargo::rustc-env={VARIABLE}={:016x}", of_folder(&root.join("src"))?);
    Ok(())
}

/// The hash of all files in a folder and the folders in it.
fn of_folder(folder: &Path) -> io::Result<u64> {
    let mut files = Vec::new();
    add_files(folder, String::new(), &mut files)?;
    files.sort();
    let mut hash = Fnv::default();
    for name in files {
        let content: Vec<u8> =
            fs::read(folder.join(&name))?.into_iter().filter(|&byte| byte != b'\r').collect();
        for part in [name.as_bytes(), &content] {
            hash.add(&(part.len() as u64).to_le_bytes());
            hash.add(part);
        }
    }
    Ok(hash.0)
}

/// Adds the names of files, from the folder at the top and with slashes.
fn add_files(folder: &Path, prefix: String, files: &mut Vec<String>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        match entry.file_type()?.is_dir() {
            true => add_files(&entry.path(), name + "/", files)?,
            false => files.push(name),
        }
    }
    Ok(())
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo 1991).
struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with files of these names and contents, made in this order.
    fn hash(files: &[(&str, &str)]) -> u64 {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for (name, content) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("it is in the folder")).expect("an empty folder");
            fs::write(path, content).expect("an empty folder");
        }
        of_folder(folder.path()).expect("it was just written")
    }

    #[test]
    fn every_change_of_a_file_changes_the_hash() {
        let base = hash(&[("a.rs", "1\n"), ("b/c.rs", "2\n")]);
        for other in [
            &[("a.rs", "1\n"), ("b/c.rs", "3\n")][..],
            &[("a.rs", "1\n"), ("b/d.rs", "2\n")],
            &[("a.rs", "1\n"), ("bc.rs", "2\n")],
            &[("a.rs", "1\n2\n"), ("b/c.rs", "")],
            &[("a.rs", "2\n"), ("b/c.rs", "1\n")],
            &[("a.rs", "1\n")],
        ] {
            assert_ne!(hash(other), base, "{other:?}");
        }
    }

    #[test]
    fn folder_order_and_line_ends_do_not_change_it() {
        let base = hash(&[("a.rs", "1\n"), ("b/c.rs", "2\n")]);
        assert_eq!(hash(&[("b/c.rs", "2\r\n"), ("a.rs", "1\r\n")]), base);
    }
}
