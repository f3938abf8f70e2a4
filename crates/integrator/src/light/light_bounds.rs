use glam::DVec3;
use globillum_geom::{Aabb, Triangle, Triangles};

/// The sphere around some area lights.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightBounds {
    pub(super) centre: DVec3,
    pub(super) radius: f64,
}

impl LightBounds {
    /// Around the triangles with these indices.
    pub(super) fn around(triangles: &Triangles, lights: impl IntoIterator<Item = u32>) -> Self {
        let Aabb { min, max } =
            Aabb::around(lights.into_iter().flat_map(|index| triangles.get(index).vertices));
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        Self { centre: 0.5 * (min + max), radius: 0.5 * min.distance(max) }
    }

    /// Whether part of the sphere may be visible from `eye` through `window`: not if all of it is outside one
    /// of the three planes through `eye` and a side.
    pub(super) fn may_be_seen_through(&self, window: &Triangle, eye: DVec3) -> bool {
        let [a, b, c] = window.vertices.map(|v| v.as_dvec3() - eye);
        let centre = self.centre - eye;
        let winding = 1.0_f64.copysign(a.cross(b).dot(c));
        let is_beyond = |a: DVec3, b: DVec3| {
            let inward = winding * a.cross(b);
            let distance = inward.dot(centre);
            distance < 0.0 && distance * distance > self.radius * self.radius * inward.length_squared()
        };
        !(is_beyond(a, b) || is_beyond(b, c) || is_beyond(c, a))
    }
}
