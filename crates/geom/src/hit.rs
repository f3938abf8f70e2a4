/// The intersection of a ray with a triangle.
///
/// The point is `(1 - u - v) * v0 + u * v1 + v * v2`; see
/// [`Triangles::surface_point`](crate::Triangles::surface_point).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray parameter, strictly inside the ray's range: the point is `origin + t * direction`.
    ///
    /// The distance from the origin is `t * direction.length()`. The depth of a depth buffer is `t *
    /// direction.dot(forward)`, where `forward` is the camera's unit view direction; it equals `t` if each
    /// direction ends on the plane at depth 1.
    pub t: f64,
    /// The barycentric coordinate of the second vertex, in `[0, 1]`.
    pub u: f64,
    /// The barycentric coordinate of the third vertex, in `[0, 1]`.
    pub v: f64,
    /// The index of the triangle in [`Triangles`](crate::Triangles).
    pub triangle: u32,
}
