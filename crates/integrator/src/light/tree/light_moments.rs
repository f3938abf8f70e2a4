use glam::DVec3;

/// The moments of a set of lights: how much they emit, and the means and variances of where they are and of the directions
/// in which they emit. Each light counts by its intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightMoments {
    /// The sum of the largest radiant intensities, as luminance.
    pub(super) intensity: f64,
    /// The mean position.
    pub(super) center: DVec3,
    /// The variances of the three coordinates.
    pub(super) variance: DVec3,
    /// The mean of the normals. Its length is at most 1.
    pub(super) normal: DVec3,
    /// The sum of the variances of their three coordinates: at most 1 for triangles, [`LightMoments::POINT_VARIANCE`] for a
    /// point light, and between 0 and that for a spot light.
    pub(super) normal_variance: f64,
    /// Whether some of them emit the same in the opposite directions too.
    pub(super) both_sides: bool,
    /// The cosine, times the length of the normal, of the angle from the normal within which a single light emits;
    /// [`LightMoments::UNLIMITED`] for several.
    pub(super) limit: f64,
}

impl LightMoments {
    /// Below all cosines.
    const UNLIMITED: f64 = -2.0;

    /// With this variance of normals, a third of it along each axis, and a mean of 0, [`twice_positive_part`] is twice the
    /// distance in all directions.
    const POINT_VARIANCE: f64 = 12.0;

    /// A triangle of these vertices whose front, of unit normal `normal`, has this intensity.
    pub(crate) fn of_triangle(vertices: [DVec3; 3], normal: DVec3, both_sides: bool, intensity: f64) -> Self {
        let center = vertices.into_iter().sum::<DVec3>() / 3.0;
        let square = |vector: DVec3| vector * vector;
        let variance = vertices.iter().map(|&vertex| square(vertex - center)).sum::<DVec3>() / 12.0;
        let limit = if both_sides { Self::UNLIMITED } else { 0.0 };
        Self { intensity, center, variance, normal, normal_variance: 0.0, both_sides, limit }
    }

    /// A point that emits in all directions.
    pub(crate) fn of_point(position: DVec3, intensity: f64) -> Self {
        Self::of_spot(position, DVec3::Y, -1.0, intensity)
    }

    /// A point that emits within the angle of cosine `cos_outer` of `axis`. By its moments, it emits `intensity` along the
    /// axis, and 0.7 of that or more at the angle.
    pub(crate) fn of_spot(position: DVec3, axis: DVec3, cos_outer: f64, intensity: f64) -> Self {
        let length = 0.5 * (1.0 + cos_outer);
        Self {
            intensity,
            center: position,
            variance: DVec3::ZERO,
            normal: length * axis,
            normal_variance: Self::POINT_VARIANCE * (1.0 - length),
            both_sides: false,
            limit: length * cos_outer,
        }
    }

    pub(super) fn union(&self, other: &Self) -> Self {
        let intensity = self.intensity + other.intensity;
        // Neither is 1 less the other: both are exact to rounding, however small.
        let shares = [self.intensity / intensity, other.intensity / intensity];
        let both = shares[0] * shares[1];
        let mean = |a: DVec3, b: DVec3| shares[0] * a + shares[1] * b;
        // Normals of triangles that emit on both sides have no sign.
        let is_turned = self.both_sides && other.both_sides && self.normal.dot(other.normal) < 0.0;
        let other_normal = if is_turned { -other.normal } else { other.normal };
        let (apart, turned) = (other.center - self.center, other_normal - self.normal);
        Self {
            intensity,
            center: mean(self.center, other.center),
            variance: mean(self.variance, other.variance) + both * apart * apart,
            normal: mean(self.normal, other_normal),
            normal_variance: shares[0] * self.normal_variance
                + shares[1] * other.normal_variance
                + both * turned.length_squared(),
            both_sides: self.both_sides || other.both_sides,
            limit: Self::UNLIMITED,
        }
    }

    /// The cost of a node with these lights: intensity by size by how much their directions differ, from 1 to 4. The
    /// surface area orientation heuristic (Conty Estevez and Kulla 2018, equation 1) with moments in place of bounds.
    pub(super) fn cost(&self) -> f64 {
        let directions = 1.0 + 3.0 * self.normal_variance.min(1.0);
        self.intensity * self.variance.element_sum() * directions
    }
}

/// Twice a bound on the mean of the positive part of a number of this mean and variance: no number has a larger one
/// (Scarf 1958), and without variance it is exact.
#[inline(always)]
pub(super) fn twice_positive_part(mean: f32, variance: f32) -> f32 {
    let root = (mean * mean + variance).sqrt();
    // The same, without cancellation.
    let of_negative = variance / (root - mean);
    if mean >= 0.0 { root + mean } else { of_negative }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// Numbers that take one of two values.
    #[test]
    fn no_positive_part_is_above_its_bound() {
        let mut attained: f64 = 0.0;
        for i in 0..10_000 {
            let numbers = Stream::new(16, 0, i);
            let [a, b] = [0, 1].map(|k| 10.0_f64.powf(4.0 * numbers.uniform(k) - 2.0));
            let [a, b] = [a * (2.0 * numbers.uniform(2) - 1.0), b * (2.0 * numbers.uniform(3) - 1.0)];
            let share = numbers.uniform(4);
            let mean = a + share * (b - a);
            let variance = share * (1.0 - share) * (a - b).powi(2);
            let part = a.max(0.0) + share * (b.max(0.0) - a.max(0.0));
            let bound = 0.5 * f64::from(twice_positive_part(mean as f32, variance as f32));
            assert!(part <= bound * (1.0 + 1e-5), "{i}: {part}, {bound}");
            attained = attained.max(part / bound);
            let exact = 0.5 * f64::from(twice_positive_part(a as f32, 0.0));
            assert!((exact - a.max(0.0)).abs() <= 1e-6 * a.abs(), "{i}: {exact}, {a}");
        }
        assert!(attained > 0.999, "{attained}");
    }

    /// The moments of clusters united one by one and in halves are those of all lights, summed directly.
    #[test]
    fn a_union_has_the_moments_of_its_lights() {
        let light = |i: u32| {
            let numbers = Stream::new(17, 0, i);
            let vector = |k: u32| DVec3::from_array([0, 1, 2].map(|axis| numbers.uniform(k + axis) - 0.5));
            let intensity = 10.0_f64.powf(6.0 * numbers.uniform(20));
            let corners = [0, 3, 6].map(|k| 1000.0 + vector(k));
            LightMoments::of_triangle(corners, vector(9).normalize(), false, intensity)
        };
        let lights: Vec<_> = (0..32).map(light).collect();
        let total: f64 = lights.iter().map(|light| light.intensity).sum();
        let mean = |value: &dyn Fn(&LightMoments) -> DVec3| {
            lights.iter().map(|light| light.intensity / total * value(light)).sum::<DVec3>()
        };
        let center = mean(&|light| light.center);
        let square = |vector: DVec3| vector * vector;
        let variance = mean(&|light| light.variance + square(light.center - center));
        let normal = mean(&|light| light.normal);
        let normal_variance = 1.0 - normal.length_squared();
        let in_a_row = |lights: &[LightMoments]| lights.iter().copied().reduce(|a, b| a.union(&b)).unwrap();
        let halves = in_a_row(&lights[..16]).union(&in_a_row(&lights[16..]));
        for union in [in_a_row(&lights), halves] {
            assert!((union.intensity / total - 1.0).abs() < 1e-14);
            assert!((union.center - center).length() < 1e-12 && (union.variance - variance).length() < 1e-12);
            assert!((union.normal - normal).length() < 1e-14);
            assert!((union.normal_variance - normal_variance).abs() < 1e-14);
        }
    }

    /// A light of a share of 1e-20 of the intensity is not lost among lights of equal normals in a plane.
    #[test]
    fn a_dim_light_leaves_a_variance() {
        let bright = |x: f64| LightMoments::of_spot(DVec3::X * x, DVec3::Y, 1.0, 1e20);
        let dim = LightMoments::of_spot(DVec3::new(0.3, 1.0, 0.0), DVec3::NEG_Y, 1.0, 2.0);
        for union in
            [bright(0.0).union(&bright(1.0)).union(&dim), dim.union(&bright(0.0)).union(&bright(1.0))]
        {
            assert!((union.variance.y / 1e-20 - 1.0).abs() < 1e-10, "{union:?}");
            assert!((union.normal_variance / 4e-20 - 1.0).abs() < 1e-10, "{union:?}");
        }
    }

    #[test]
    fn opposite_normals_of_lights_with_two_sides_are_one() {
        let light = |normal| LightMoments::of_triangle([DVec3::X, DVec3::Z, DVec3::ZERO], normal, true, 1.0);
        let union = light(DVec3::Y).union(&light(DVec3::NEG_Y));
        assert_eq!((union.normal, union.normal_variance), (DVec3::Y, 0.0));
    }
}
