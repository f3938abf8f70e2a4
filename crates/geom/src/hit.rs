/// Where a ray meets a triangle: small and unshaded.
///
/// The point is `(1 - u - v) * v0 + u * v1 + v * v2`; see
/// [`Triangles::surface_point`](crate::Triangles::surface_point).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter, strictly inside the ray's range: the hit is at `origin + t * direction`, so `t` is a
    /// length along the ray in multiples of the direction's.
    ///
    /// The distance from the origin is `t * direction.length()`. The planar depth, as a depth buffer holds it,
    /// is `t * direction.dot(forward)`, with the camera's unit view direction `forward`; `t` itself is that
    /// depth where directions are not normalised but reach the plane at distance 1.
    pub t: f64,
    /// Barycentric weight of the triangle's second vertex, in `[0, 1]`.
    pub u: f64,
    /// Barycentric weight of the triangle's third vertex, in `[0, 1]`.
    pub v: f64,
    /// Index of the triangle in the order in which the scene was given.
    pub triangle: u32,
}
