/// How much a scene file may ask for. What exceeds a limit is refused with
/// [`IoError::TooLarge`](crate::IoError::TooLarge) before memory is spent on it.
///
/// ```
/// let mut limits = globillum_io::Limits::default();
/// limits.triangles = 1_000_000;
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Bytes of all files that a scene consists of, together: 2 GiB.
    pub bytes: u64,
    /// Triangles, a mesh counted as often as it is placed: 2^29. In memory, a triangle with its
    /// material takes 40 bytes.
    pub triangles: u64,
    /// Triangles beyond one for each byte of the files, so many of which only placing the same
    /// mesh again can make: 2^25. This bounds what a small file can ask for, at 1.3 GB.
    pub instanced: u64,
    /// Materials: 65,536. As many material libraries may be named.
    pub materials: u64,
    /// Perspective cameras, one counted as often as it is placed: 65,536.
    pub cameras: u64,
    /// Bytes in a line of OBJ or MTL: 16 MiB.
    pub line_bytes: u64,
    /// Corners of a polygon: 65,536.
    pub polygon_corners: u64,
    /// Values in a glTF's JSON, objects and arrays included: 2^23. JSON of few bytes can ask for
    /// much work: the smallest node is `{}`. As many elements may an accessor have without bytes
    /// behind them.
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
            line_bytes: 16 << 20,
            polygon_corners: 65_536,
            json_values: 1 << 23,
        }
    }
}
