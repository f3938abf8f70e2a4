use crate::rounding::EPS;
use crate::{Ray, Triangle};
use glam::DVec3;

/// The error bound of a hit along each axis, in units of [`EPS`] times the largest coordinate distance between
/// the ray's origin and the scene's bounds: 24 for the decision, 2 for the rounding of a direction between two
/// points.
const HIT_ERR: f64 = 26.0;

/// How far below a surface a given point may lie and still see what is above it, in units of the largest coordinates:
/// a vertex rounded to `f32` is off by `2^-24` of its coordinates, the given point as well, and as much again is left
/// for the arithmetic that produced them.
const GIVEN_ERR: f64 = 1.0 / (1 << 22) as f64;

/// A point on a triangle, from which rays leave without hitting the triangle or another one in the same
/// plane.
///
/// Rounding displaces the computed position from the triangle's plane, and also the computed intersection of
/// a ray with the triangle. `plane_err` bounds the sum of both errors. The origin of a spawned ray is offset
/// by it along the normal, to the side of the direction. The bound scales with the scene; there is no epsilon
/// to choose. Rays also [exclude](Ray::excluded) the triangle itself, so no accelerator has to decide it.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Accel, BruteForce, Triangle, Triangles};
///
/// let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)])?;
/// let point = triangles.surface_point(0, 0.25, 0.25);
/// let accel = BruteForce::build(&triangles);
/// assert!(!accel.occluded(&point.spawn_ray(DVec3::Z)) && !accel.occluded(&point.spawn_ray(-DVec3::Z)));
/// # Ok::<(), globillum_geom::GeomError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct SurfacePoint {
    /// The position in world space, rounded.
    pub position: DVec3,
    /// The unit geometric normal `n_g`, which points to the triangle's front.
    pub normal: DVec3,
    /// A distance from the triangle's plane, in units of length: a ray that starts this far off the plane and
    /// leads away from it hits no triangle in the plane. The same holds for a segment that ends this far off the plane,
    /// on the side where it begins, if it begins within the scene's bounds. 0 for a
    /// [given point](crate::Triangles::given_point).
    pub plane_err: f64,
    /// The index of the triangle; [`Ray::NO_TRIANGLE`] for a [given point](crate::Triangles::given_point).
    pub triangle: u32,
}

impl SurfacePoint {
    /// The point of triangle `index`, with its unit `normal`, at the barycentrics `u` (second vertex) and `v`
    /// (third vertex), in a scene whose bounds have the longest side `scene_extent`.
    ///
    /// With `eps = 2^-53` and `extent` the largest component of `|e1| + |e2| + |e1 - e2|`, the error is the
    /// sum over axes `a` of `|n_a| (eps |v0_a| + 3 eps extent + 2 eps |p_a| + 26 eps scene_extent)`. The
    /// first three terms bound the error of the position and its offset (NVIDIA, "Solving Self-Intersection
    /// Artifacts in DirectX Raytracing", 2023), the last that of a decision within the scene
    /// (docs/numerics.md).
    #[inline(always)]
    pub(crate) fn on(
        triangle: &Triangle,
        index: u32,
        normal: DVec3,
        [u, v]: [f64; 2],
        scene_extent: f64,
    ) -> Self {
        let [e1, e2] = triangle.edges();
        let v0 = triangle.vertices[0].as_dvec3();
        let position = v0 + (u * e1 + v * e2);
        let extent = (e1.abs() + e2.abs() + (e1 - e2).abs()).max_element();
        let evenly = DVec3::splat(3.0 * extent + HIT_ERR * scene_extent);
        let err = EPS * (v0.abs() + evenly + 2.0 * position.abs());
        Self { position, normal, plane_err: normal.abs().dot(err), triangle: index }
    }

    /// The point that stands for `position`, in a scene whose bounds have the longest side `scene_extent`; `reach` has
    /// the largest magnitudes of coordinates along each axis, of the scene and of `position`.
    pub(crate) fn given(position: DVec3, normal: DVec3, reach: DVec3, scene_extent: f64) -> Self {
        let lift = normal.abs().dot(GIVEN_ERR * reach + DVec3::splat(EPS * HIT_ERR * scene_extent));
        Self { position: position + lift * normal, normal, plane_err: 0.0, triangle: Ray::NO_TRIANGLE }
    }

    /// The origin of a ray toward `direction`: the position, offset by `plane_err` to that side of the plane.
    #[doc(alias = "OffsetRayOrigin")]
    #[inline(always)]
    pub fn leave_toward(&self, direction: DVec3) -> DVec3 {
        let side = 1.0_f64.copysign(self.normal.dot(direction));
        self.position + (side * self.plane_err) * self.normal
    }

    /// The ray from this point toward `direction`, of any length, with the range `0 < t < infinity`. It excludes the
    /// triangle.
    #[inline(always)]
    pub fn spawn_ray(&self, direction: DVec3) -> Ray {
        Ray::new(self.leave_toward(direction), direction).excluding([self.triangle, Ray::NO_TRIANGLE])
    }

    /// The open segment to `other`, each end offset toward the other one. It excludes both triangles.
    ///
    /// The ends are offset by `plane_err`, which suffices if both points are in the scene. A
    /// [given point](crate::Triangles::given_point) may be far outside it: from there the far end is offset by
    /// `26 eps (|n_x| + |n_y| + |n_z|)` times the largest coordinate distance of the points more, with `eps = 2^-53`
    /// and `n` the normal at that end. So what lies in the plane of `other` does not occlude `other`, from anywhere.
    ///
    /// `None` if one of the points lies in the plane of the other within its offset, where the cosine is
    /// zero up to rounding.
    #[inline(always)]
    pub fn segment_to(&self, other: &Self) -> Option<Ray> {
        let between = other.position - self.position;
        let end = if self.triangle == Ray::NO_TRIANGLE { other.seen_from_outside(between) } else { *other };
        (self.stands_off(between) && end.stands_off(between)).then(
            #[inline(always)]
            || {
                Ray::segment(self.leave_toward(between), end.leave_toward(-between))
                    .excluding([self.triangle, other.triangle])
            },
        )
    }

    /// The same point with a `plane_err` for rays from anywhere that are `offset` long where they end here.
    ///
    /// `plane_err` holds for rays from within the scene. For others the error of a decision grows with the distance of
    /// the ray's origin from whatever shares the plane: at most the scene's extent more than that from this point.
    #[inline(always)]
    fn seen_from_outside(&self, offset: DVec3) -> Self {
        let farther = EPS * HIT_ERR * offset.abs().max_element();
        Self { plane_err: self.plane_err + farther * self.normal.abs().element_sum(), ..*self }
    }

    /// The open segment to `position`, a point on no surface, offset toward it at this end. It excludes this point's
    /// triangle.
    ///
    /// `None` if `position` lies in this point's plane within `plane_err`. If it lies on another triangle,
    /// rounding decides whether the segment meets that triangle.
    #[inline(always)]
    pub fn segment_to_position(&self, position: DVec3) -> Option<Ray> {
        let between = position - self.position;
        self.stands_off(between).then(
            #[inline(always)]
            || {
                Ray::segment(self.leave_toward(between), position)
                    .excluding([self.triangle, Ray::NO_TRIANGLE])
            },
        )
    }

    /// Whether `offset` leads out of the plane by more than `plane_err`.
    #[inline(always)]
    fn stands_off(&self, offset: DVec3) -> bool {
        self.normal.dot(offset).abs() > self.plane_err
    }
}
