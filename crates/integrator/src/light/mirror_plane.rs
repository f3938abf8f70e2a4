use glam::{DVec3, Vec3};
use globillum_geom::decide::Shear;
use globillum_geom::{Aabb, Ray, Triangle};

/// The coplanar triangles of an ideal mirror, which reflects on both sides.
#[derive(Clone, Debug)]
pub(crate) struct PlaneMirror {
    /// Unit normal of the plane, on its front.
    normal: DVec3,
    /// A point of the plane.
    point: DVec3,
    /// The largest distance of a vertex from the plane.
    tolerance: f64,
    triangles: Vec<Triangle>,
    /// The area of all triangles.
    pub(super) area: f64,
    /// Whether lights are visible from the back, and from the front.
    pub(super) lit: [bool; 2],
}

impl PlaneMirror {
    /// The largest distance of a vertex from the plane, in units of the longest side of the first triangle's
    /// bounds. Corners of a rectangle, rounded to `f32`, are within it if its sides are at least a tenth of
    /// their coordinates.
    const COPLANAR: f64 = 1.0 / (1 << 18) as f64;

    /// The largest angle between normals in radians, which is half the error of reflected directions.
    /// [`COPLANAR`](Self::COPLANAR) does not bound it: strips of a slightly curved mirror are nearly coplanar.
    const PARALLEL: f64 = 4.0 * Self::COPLANAR;

    pub(super) fn through(triangle: &Triangle) -> Self {
        Self {
            normal: triangle.normal(),
            point: triangle.vertices[0].as_dvec3(),
            tolerance: Self::COPLANAR * triangle.bounds().extent().max_element(),
            triangles: vec![*triangle],
            area: triangle.area(),
            lit: [false; 2],
        }
    }

    pub(super) fn contains(&self, triangle: &Triangle) -> bool {
        let is_parallel = triangle.normal().cross(self.normal).length() <= Self::PARALLEL;
        is_parallel && triangle.vertices.iter().all(|v| self.height(v.as_dvec3()).abs() <= self.tolerance)
    }

    pub(super) fn add(&mut self, triangle: &Triangle) {
        self.triangles.push(*triangle);
        self.area += triangle.area();
    }

    /// The signed distance of `position` from the plane.
    pub(super) fn height(&self, position: DVec3) -> f64 {
        self.normal.dot(position - self.point)
    }

    pub(super) fn image_of(&self, position: DVec3) -> DVec3 {
        position - 2.0 * self.height(position) * self.normal
    }

    /// The reflection of the unit vector `direction`.
    pub(crate) fn reflect(&self, direction: DVec3) -> DVec3 {
        direction - 2.0 * self.normal.dot(direction) * self.normal
    }

    /// Whether both points lie strictly on the same side of the plane.
    pub(crate) fn same_side(&self, a: DVec3, b: DVec3) -> bool {
        self.height(a) * self.height(b) > 0.0
    }

    /// Whether the ray, without regard to `t_max` and other triangles, hits the mirror. Decided as
    /// accelerators decide it, so a ray that misses here does not hit there.
    pub(crate) fn is_hit_by(&self, ray: &Ray) -> bool {
        let Some(shear) = Shear::new(ray) else { return false };
        self.triangles.iter().any(|triangle| shear.decide(triangle).is_some_and(|hit| hit.t > 0.0))
    }

    /// Whether the mirror may show part of `lights` to `from`. It does not if all of `lights` lies on the
    /// other side or outside the frustum of the mirror, if no light is visible from that side, or if
    /// `from` is within rounding of the plane.
    pub(super) fn may_show(&self, lights: &Sphere, from: DVec3) -> bool {
        let height = self.height(from);
        let lights_height = self.height(lights.center) * 1.0_f64.copysign(height);
        let lit = self.lit[usize::from(height > 0.0)];
        if !lit || height.abs() <= self.tolerance || lights_height < -lights.radius {
            return false;
        }
        let image = from - 2.0 * height * self.normal;
        self.triangles.iter().any(|triangle| lights.may_be_seen_through(triangle, image))
    }
}

/// A bounding sphere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Sphere {
    /// The sphere around the bounds of these points.
    pub(super) fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        let Aabb { min, max } = Aabb::around(points);
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        Self { center: 0.5 * (min + max), radius: 0.5 * min.distance(max) }
    }

    /// Whether part of the sphere may be visible from `eye` through `window`: not if all of it is outside one
    /// of the three planes through `eye` and a side.
    fn may_be_seen_through(&self, window: &Triangle, eye: DVec3) -> bool {
        let [a, b, c] = window.vertices.map(|v| v.as_dvec3() - eye);
        let center = self.center - eye;
        let winding = 1.0_f64.copysign(a.cross(b).dot(c));
        let is_beyond = |a: DVec3, b: DVec3| {
            let inward = winding * a.cross(b);
            let distance = inward.dot(center);
            distance < 0.0 && distance * distance > self.radius * self.radius * inward.length_squared()
        };
        !(is_beyond(a, b) || is_beyond(b, c) || is_beyond(c, a))
    }
}
