//! Rounding to `f32` and `f64`: the units in which errors are counted.

use glam::DVec3;
use globillum_geom::Ray;

/// The arithmetic in which an intersector computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// `f32`.
    Single,
    /// `f64`.
    Double,
}

impl Precision {
    /// The unit in the last place of `x`, once that is rounded to this precision: the distance to
    /// the next number of larger magnitude.
    pub fn ulp(self, x: f64) -> f64 {
        match self {
            Self::Single => {
                let x = (x as f32).abs();
                f64::from(x.next_up()) - f64::from(x)
            }
            Self::Double => x.abs().next_up() - x.abs(),
        }
    }

    /// The ray, rounded to this precision.
    pub fn round(self, ray: &Ray) -> Ray {
        let round = |v: DVec3| match self {
            Self::Single => v.as_vec3().as_dvec3(),
            Self::Double => v,
        };
        Ray { origin: round(ray.origin), direction: round(ray.direction), ..*ray }
    }

    /// The point `origin + t * direction`, computed in this precision.
    pub fn point(self, ray: &Ray, t: f64) -> DVec3 {
        match self {
            Self::Single => (ray.origin.as_vec3() + t as f32 * ray.direction.as_vec3()).as_dvec3(),
            Self::Double => ray.at(t),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ulp_is_the_distance_to_the_next_number() {
        for (x, single, double) in [
            (1.0, f64::from(f32::EPSILON), f64::EPSILON),
            (-1.5, f64::from(f32::EPSILON), f64::EPSILON),
            (0.75, f64::from(f32::EPSILON) / 2.0, f64::EPSILON / 2.0),
            // Rounds to one in `f32`, not in `f64`.
            (1.0 - 1e-10, f64::from(f32::EPSILON), f64::EPSILON / 2.0),
        ] {
            assert_eq!(Precision::Single.ulp(x), single, "{x}");
            assert_eq!(Precision::Double.ulp(x), double, "{x}");
        }
        assert_eq!(Precision::Double.ulp(0.0), f64::from_bits(1));
    }
}
