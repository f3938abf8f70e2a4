use crate::{Ray, Triangle};
use glam::DVec3;

/// Unit roundoff of `f64`.
const U: f64 = f64::EPSILON / 2.0;

/// A point on a triangle, from which rays leave without meeting the triangle again.
///
/// The computed position lies off the triangle's plane by a rounding error; `plane_err` bounds
/// it. A ray that leaves starts that far off the plane, on the side to which it goes, so that no
/// length has to be guessed: the offset scales with the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position in world space, rounded.
    pub position: DVec3,
    /// Unit geometric normal `n_g`, on the triangle's front.
    pub normal: DVec3,
    /// Bound on the distance between `position` and the triangle's plane, in units of length,
    /// with room for the rounding of the offset point itself.
    pub plane_err: f64,
}

impl SurfacePoint {
    /// The point of `triangle` with barycentrics `u` (second vertex) and `v` (third vertex).
    ///
    /// The bound is `|n| . (u |v0| + 3u extent + 2u |p|)` with `u = 2^-53` and `extent` the
    /// largest component of `|e1| + |e2| + |e1 - e2|` (NVIDIA, "Solving Self-Intersection
    /// Artifacts in DirectX Raytracing", 2023, without its transforms; derived in
    /// docs/numerics.md).
    pub(crate) fn on(triangle: &Triangle, u: f64, v: f64) -> Self {
        let [e1, e2] = triangle.edges();
        let v0 = triangle.vertices[0].as_dvec3();
        let position = v0 + (u * e1 + v * e2);
        let normal = triangle.normal();
        let extent = (e1.abs() + e2.abs() + (e1 - e2).abs()).max_element();
        let position_err = U * v0.abs() + DVec3::splat(3.0 * U * extent) + 2.0 * U * position.abs();
        Self { position, normal, plane_err: normal.abs().dot(position_err) }
    }

    /// Where a ray toward `direction` starts: off the plane on that side.
    pub fn leave_toward(&self, direction: DVec3) -> DVec3 {
        let side = 1.0_f64.copysign(self.normal.dot(direction));
        self.position + (side * self.plane_err) * self.normal
    }

    /// The ray that leaves this point toward `direction`.
    pub fn spawn(&self, direction: DVec3) -> Ray {
        Ray::new(self.leave_toward(direction), direction)
    }

    /// The open segment between two surface points, each end offset toward the other.
    pub fn segment_to(&self, other: &Self) -> Ray {
        let between = other.position - self.position;
        Ray::segment(self.leave_toward(between), other.leave_toward(-between))
    }
}
