use super::light_bounds::LightBounds;
use crate::light::receiver::Receiver;
use glam::DVec3;
use globillum_geom::decide::Shear;
use globillum_geom::{Ray, Triangle, Triangles};

/// Adjacent coplanar triangles of an ideal mirror, which reflects on both sides.
#[derive(Clone, Debug)]
pub(crate) struct Facet {
    /// Unit normal of the plane; points out of a closed body.
    pub(super) normal: DVec3,
    /// A point of the plane.
    point: DVec3,
    /// The largest distance of a vertex from the plane.
    tolerance: f64,
    /// The place of the closed body in the list of them; `None` if the mirror is not part of one.
    pub(super) body: Option<u32>,
    pub(super) triangles: Vec<u32>,
}

impl Facet {
    /// The largest distance of a vertex from the plane, in units of the longest side of the first triangle's
    /// bounds. Corners of a rectangle, rounded to `f32`, are within it if its sides are at least a tenth of
    /// their coordinates.
    const COPLANAR: f64 = 1.0 / (1 << 18) as f64;

    /// The largest angle between normals of a facet in radians, which is half the error of reflected directions.
    /// [`COPLANAR`](Self::COPLANAR) does not bound it: strips of a slightly curved mirror are nearly coplanar.
    pub(super) const PARALLEL: f64 = 4.0 * Self::COPLANAR;

    /// Beyond this number of triangles, a facet may show any light: to test each would cost more than it brings.
    const MAX_TESTED: usize = 16;

    /// Of triangle `index` alone.
    pub(super) fn of(index: u32, triangle: &Triangle) -> Self {
        Self {
            normal: triangle.normal(),
            point: triangle.vertices[0].as_dvec3(),
            tolerance: Self::COPLANAR * triangle.bounds().extent().max_element(),
            body: None,
            triangles: vec![index],
        }
    }

    /// Whether planes of these unit normals are parallel, with their fronts on the same side.
    pub(super) fn is_parallel(a: DVec3, b: DVec3) -> bool {
        a.dot(b) > 0.0 && a.cross(b).length_squared() <= Self::PARALLEL * Self::PARALLEL
    }

    /// Whether `triangle` lies in the plane.
    pub(super) fn is_close(&self, triangle: &Triangle) -> bool {
        triangle.vertices.iter().all(|v| self.height(v.as_dvec3()).abs() <= self.tolerance)
    }

    pub(super) fn area(&self, triangles: &Triangles) -> f64 {
        self.triangles.iter().map(|&index| triangles.get(index).area()).sum()
    }

    /// The signed distance of `position` from the plane.
    pub(super) fn height(&self, position: DVec3) -> f64 {
        self.normal.dot(position - self.point)
    }

    /// The mirror image of `receiver`.
    pub(crate) fn image_of(&self, Receiver { position, normal }: Receiver) -> Receiver {
        let position = mirror_image(position, self.normal, self.height(position));
        Receiver { position, normal: self.reflect(normal.as_dvec3()).as_vec3() }
    }

    /// The reflection of the unit vector `direction`.
    pub(crate) fn reflect(&self, direction: DVec3) -> DVec3 {
        reflection(direction, self.normal)
    }

    /// Whether the ray, without regard to `t_max` and other triangles, hits the facet, decided as accelerators decide it.
    /// Always if the facet has many triangles.
    pub(crate) fn may_be_hit_by(&self, triangles: &Triangles, ray: &Ray) -> bool {
        let Some(shear) = Shear::new(ray) else { return false };
        let is_hit = |&index: &u32| shear.decide(triangles.get(index)).is_some_and(|hit| hit.t > 0.0);
        self.triangles.len() > Self::MAX_TESTED || self.triangles.iter().any(is_hit)
    }

    /// Whether both points lie strictly on the same side of the plane.
    pub(crate) fn same_side(&self, a: DVec3, b: DVec3) -> bool {
        self.height(a) * self.height(b) > 0.0
    }

    /// Whether the facet may show part of `lights` to `from`, on its front alone if `from` is outside of its body. It does
    /// not if all of `lights` lies on the other side or outside the frustum of the facet, or if `from` is within rounding
    /// of the plane.
    pub(super) fn may_show(
        &self,
        triangles: &Triangles,
        lights: &LightBounds,
        from: DVec3,
        is_outside: bool,
    ) -> bool {
        let height = self.height(from);
        let lights_height = self.height(lights.center) * 1.0_f64.copysign(height);
        let is_behind = is_outside && height < 0.0;
        if is_behind || height.abs() <= self.tolerance || lights_height < -lights.radius {
            return false;
        }
        let image = mirror_image(from, self.normal, height);
        let window = |index: u32| triangles.get(index).vertices.map(|v| v.as_dvec3());
        let may_show = |&index: &u32| lights.may_be_seen_through(window(index), image);
        self.triangles.len() > Self::MAX_TESTED || self.triangles.iter().any(may_show)
    }
}

/// The mirror image of a point in a plane of this normal. Its signed distance from the plane is `height` times the length of the
/// normal.
#[inline(always)]
pub(super) fn mirror_image(point: DVec3, normal: DVec3, height: f64) -> DVec3 {
    point - 2.0 * height * normal
}

/// The reflection of `direction`, of any length, by a mirror of this unit normal.
pub(crate) fn reflection(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - 2.0 * normal.dot(direction) * normal
}
