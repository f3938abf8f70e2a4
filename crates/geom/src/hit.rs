/// Where a ray meets a triangle: small and unshaded.
///
/// The point is `(1 - u - v) * v0 + u * v1 + v * v2`; see
/// [`Triangles::surface_point`](crate::Triangles::surface_point).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter, in multiples of the ray's direction; strictly inside the ray's range.
    pub t: f64,
    /// Barycentric weight of the triangle's second vertex, in `[0, 1]`.
    pub u: f64,
    /// Barycentric weight of the triangle's third vertex, in `[0, 1]`.
    pub v: f64,
    /// Index of the triangle in the order in which the scene was given.
    pub triangle: u32,
}
