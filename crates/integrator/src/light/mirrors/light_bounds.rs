use glam::DVec3;
use globillum_geom::{Aabb, Triangles};

/// The box around some area lights, and the sphere around that.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightBounds {
    pub(super) center: DVec3,
    /// The distances of the box's faces from the center.
    pub(super) half_extents: DVec3,
    pub(super) radius: f64,
}

impl LightBounds {
    /// Around the triangles with these indices.
    pub(super) fn around(triangles: &Triangles, lights: impl IntoIterator<Item = u32>) -> Self {
        let bounds = Aabb::around(lights.into_iter().flat_map(|index| triangles.get(index).vertices));
        let extent = bounds.extent();
        Self { center: bounds.center(), half_extents: 0.5 * extent, radius: 0.5 * extent.length() }
    }

    /// Whether a ray of this origin and unit `direction` may meet the box. Rounding to less than `2^-20` of the distance
    /// loses none.
    pub(super) fn may_be_hit_by(&self, origin: DVec3, direction: DVec3) -> bool {
        let to_center = self.center - origin;
        let margin = (to_center.length() + self.radius) / f64::from(1 << 20);
        let reach = self.half_extents + margin;
        let (a, b) = ((to_center - reach) / direction, (to_center + reach) / direction);
        a.min(b).max_element().max(0.0) <= a.max(b).min_element()
    }

    /// Whether part of the sphere may be visible from `eye` through the triangle `window`: not if all of it is outside one
    /// of the three planes through `eye` and a side.
    #[inline(always)]
    pub(super) fn may_be_seen_through(&self, window: [DVec3; 3], eye: DVec3) -> bool {
        let [a, b, c] = window.map(|v| v - eye);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use glam::Vec3;
    use globillum_geom::Triangle;

    /// A ray to a point of the lights may meet their box, flat or not, from anywhere; most others do not.
    #[test]
    fn rays_to_lights_may_meet_their_box() {
        let mut others = 0;
        for i in 0..2000 {
            let numbers = Stream::new(4, 0, i);
            let vector =
                |k: u32| DVec3::from_array([0, 1, 2].map(|axis| 2.0 * numbers.uniform(k + axis) - 1.0));
            let size = 10.0_f64.powf(6.0 * numbers.uniform(40) - 3.0);
            let flat = if i % 2 == 0 { DVec3::ONE } else { DVec3::new(1.0, 0.0, 1.0) };
            let corner = |k: u32| (vector(0) + size * flat * vector(k)).as_vec3();
            let light = Triangle::new(corner(3), corner(6), corner(9));
            let triangles = Triangles::new(vec![light]).unwrap();
            let bounds = LightBounds::around(&triangles, [0]);
            let (u, v) = Triangle::sample_uniform(numbers.uniform_pair(20));
            let [a, b, c] = light.vertices.map(Vec3::as_dvec3);
            let origin = 4.0 * vector(30);
            let direction = (a + u * (b - a) + v * (c - a) - origin).normalize();
            assert!(bounds.may_be_hit_by(origin, direction), "{i}: {bounds:?}");
            others += i32::from(bounds.may_be_hit_by(origin, vector(50).normalize()));
            others += i32::from(bounds.may_be_hit_by(origin, -direction));
        }
        assert!(others < 1000, "{others}");
    }
}
