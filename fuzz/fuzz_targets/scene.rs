//! Loads bytes as a scene file: whatever they are, there is a scene or an error of one line.

use globillum_io::{Limits, Loader};

/// Loads the first of `files`.
pub fn load(files: &[(&str, &[u8])]) {
    // Time and memory shall be those of few triangles, whatever a file claims.
    let mut limits = Limits::default();
    limits.triangles = 1 << 18;
    match Loader::new().limits(limits).files(files).load(files[0].0) {
        Ok(loaded) => assert!(!loaded.model.triangles().is_empty()),
        Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{error}"),
    }
}
