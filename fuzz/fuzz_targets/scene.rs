//! Loads bytes as a scene file: whatever they are, there is a scene or an error of one line.

use globillum_io::{Limits, Loader};
use std::path::PathBuf;
use std::sync::LazyLock;

/// A folder in memory, where there is one: it is written to with every run.
static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let shared = PathBuf::from("/dev/shm");
    let parent = if shared.is_dir() { shared } else { std::env::temp_dir() };
    let folder = parent.join(format!("globillum-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder can be made");
    folder
});

/// Writes `files` and loads the first.
pub fn load(files: &[(&str, &[u8])]) {
    for (name, bytes) in files {
        std::fs::write(FOLDER.join(name), bytes).expect("it can be written to");
    }
    // Time and memory shall be those of few triangles, whatever a file claims.
    let mut limits = Limits::default();
    limits.triangles = 1 << 18;
    match Loader::new().limits(limits).load(&FOLDER.join(files[0].0)) {
        Ok(loaded) => assert!(!loaded.model.triangles().is_empty()),
        Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
    }
}
