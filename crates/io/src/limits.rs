/// Limits on the content of a scene file. Exceeding one is
/// [`IoError::TooLarge`](crate::IoError::TooLarge), reported before memory is allocated for the content.
///
/// ```
/// let mut limits = globillum_io::Limits::default();
/// limits.triangles = 1_000_000;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Total bytes of the scene's files; default 2 GiB.
    pub bytes: u64,
    /// Triangles, with one count for each instance of a mesh; default 2^29. A triangle with its material
    /// takes 40 bytes of memory.
    pub triangles: u64,
    /// Triangles beyond one for each byte of the files, which only repeated mesh instances can produce;
    /// default 2^25. It bounds the memory that a small file can request to 1.3 GB.
    pub instanced: u64,
    /// Materials, and also named material libraries; default 65,536.
    pub materials: u64,
    /// Perspective cameras, with one count for each instance; default 65,536.
    pub cameras: u64,
    /// Delta lights, with one count for each instance; default 65,536.
    pub delta_lights: u64,
    /// Bytes in a line of OBJ or MTL; default 16 MiB.
    pub line_bytes: u64,
    /// Vertices of a polygon; default 65,536.
    pub polygon_corners: u64,
    /// Objects in the JSON of a glTF file; default 2^20. Each may take 1 KiB of memory. Like `json_values`, it
    /// does not count the content of `extras` and of extensions that are not read.
    pub json_objects: u64,
    /// Values in the JSON of a glTF file, including objects and arrays; default 2^23. Each may take 128 bytes
    /// of memory. Also the elements of an accessor without a buffer view.
    pub json_values: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            bytes: 2 << 30,
            triangles: 1 << 29,
            instanced: 1 << 25,
            materials: 65_536,
            cameras: 65_536,
            delta_lights: 65_536,
            line_bytes: 16 << 20,
            polygon_corners: 65_536,
            json_objects: 1 << 20,
            json_values: 1 << 23,
        }
    }
}

/// Returns [`crate::IoError::TooLarge`] if `count` exceeds `limit`.
#[cfg(any(feature = "obj", feature = "gltf"))]
pub(crate) fn check_count(
    count: u64,
    limit: u64,
    what: &'static str,
    at: impl FnOnce() -> crate::Location,
) -> crate::error::Result<()> {
    if count > limit { Err(crate::IoError::TooLarge { at: at(), what, limit }) } else { Ok(()) }
}
