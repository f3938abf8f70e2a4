use std::path::Path;

/// The folder that contains `file`.
pub(crate) fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// The extension of `file` in lower case, empty if it has none.
#[cfg(any(feature = "images", feature = "obj", feature = "gltf"))]
pub(crate) fn extension_of(file: &Path) -> std::ffi::OsString {
    file.extension().unwrap_or_default().to_ascii_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bare_name_lies_in_the_current_folder() {
        assert_eq!(folder_of(Path::new("a.png")), Path::new("."));
        assert_eq!(folder_of(Path::new("b/a.png")), Path::new("b"));
    }
}
