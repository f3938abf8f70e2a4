use crate::{Ray, Triangle};
use glam::DVec3;

/// Unit roundoff of `f64`.
const U: f64 = f64::EPSILON / 2.0;

/// How far, on each axis, a hit's point on the ray may be from the triangle, in units of `U` times
/// the largest coordinate distance between the ray's origin and the triangle: 24 for the decision,
/// the rest for the rounding of a direction between two points.
const HIT_ERR: f64 = 26.0;

/// A point on a triangle of a scene, from which rays leave without meeting the triangle again, or
/// another one in the same plane.
///
/// The computed position lies off the triangle's plane by a rounding error, and so does the place
/// where a ray seems to meet it. `plane_err` covers both: a ray that leaves starts that far off the
/// plane, on the side to which it goes. No length has to be guessed, since it scales with the
/// scene.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Accel, BruteForce, Triangle, Triangles};
///
/// let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)])?;
/// let point = triangles.surface_point(0, 0.25, 0.25);
/// let accel = BruteForce::build(&triangles);
/// assert!(!accel.occluded(&point.spawn(DVec3::Z)) && !accel.occluded(&point.spawn(-DVec3::Z)));
/// # Ok::<(), globillum_geom::GeomError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SurfacePoint {
    /// Position in world space, rounded.
    pub position: DVec3,
    /// Unit geometric normal `n_g`, on the triangle's front.
    pub normal: DVec3,
    /// A distance from the triangle's plane, in units of length, at which a ray that leads away
    /// from the plane certainly hits nothing that lies within it.
    pub plane_err: f64,
}

impl SurfacePoint {
    /// The point of `triangle`, which has that unit `normal`, with barycentrics `u` (second vertex) and `v` (third vertex), in a
    /// scene whose longest side is `scene_extent`.
    ///
    /// With `u = 2^-53` and `extent` the largest component of `|e1| + |e2| + |e1 - e2|`, the
    /// distance is `|n| . (u |v0| + 3u extent + 2u |p| + 26u scene_extent)`: the first three terms
    /// for the position and its offset (NVIDIA, "Solving Self-Intersection Artifacts in DirectX
    /// Raytracing", 2023), the last for what a decision within the scene may be off
    /// (docs/numerics.md).
    #[inline(always)]
    pub(crate) fn on(triangle: &Triangle, normal: DVec3, u: f64, v: f64, scene_extent: f64) -> Self {
        let [e1, e2] = triangle.edges();
        let v0 = triangle.vertices[0].as_dvec3();
        let position = v0 + (u * e1 + v * e2);
        let extent = (e1.abs() + e2.abs() + (e1 - e2).abs()).max_element();
        let evenly = DVec3::splat(3.0 * extent + HIT_ERR * scene_extent);
        let err = U * (v0.abs() + evenly + 2.0 * position.abs());
        Self { position, normal, plane_err: normal.abs().dot(err) }
    }

    /// Where a ray toward `direction` starts: off the plane on that side.
    #[inline(always)]
    pub fn leave_toward(&self, direction: DVec3) -> DVec3 {
        let side = 1.0_f64.copysign(self.normal.dot(direction));
        self.position + (side * self.plane_err) * self.normal
    }

    /// The ray that leaves this point toward `direction`.
    #[inline(always)]
    pub fn spawn(&self, direction: DVec3) -> Ray {
        Ray::new(self.leave_toward(direction), direction)
    }

    /// The open segment between two surface points, each end offset toward the other.
    ///
    /// `None` if one of them cannot be told from lying in the other's plane: nothing is to be seen
    /// along a surface.
    #[inline(always)]
    pub fn segment_to(&self, other: &Self) -> Option<Ray> {
        let between = other.position - self.position;
        let stands_off = |at: &Self| at.normal.dot(between).abs() > at.plane_err;
        (stands_off(self) && stands_off(other))
            .then(|| Ray::segment(self.leave_toward(between), other.leave_toward(-between)))
    }
}
