use glam::DVec3;

/// The moments of a set of lights: how much they emit, and the means and variances of where they are and of the directions
/// in which they emit. Each light counts by its intensity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cluster {
    /// The sum of the largest radiant intensities, as luminance.
    pub(super) intensity: f64,
    /// The mean position.
    pub(super) centre: DVec3,
    /// The variances of the three coordinates.
    pub(super) variance: DVec3,
    /// The mean of the normals, or of the axes of spot lights. Its length is at most 1.
    pub(super) normal: DVec3,
    /// The mean of their squared lengths.
    pub(super) normal_sq: f64,
    /// Whether some of them emit the same in the opposite directions too.
    pub(super) both_sides: bool,
    /// The cosine of the angle from its normal within which a single light emits; [`Cluster::UNLIMITED`] for several.
    pub(super) cos_limit: f64,
}

impl Cluster {
    /// Below the cosine of any angle.
    const UNLIMITED: f64 = -2.0;

    /// The squared length of a normal that emits in all directions alike, though its mean is 0: by it,
    /// [`positive_part`] is 1 in all of them.
    const POINT_NORMAL_SQ: f64 = 12.0;

    /// A triangle of these vertices whose front, of unit normal `normal`, has this intensity.
    pub(crate) fn of_triangle(vertices: [DVec3; 3], normal: DVec3, both_sides: bool, intensity: f64) -> Self {
        let centre = vertices.into_iter().sum::<DVec3>() / 3.0;
        let variance = vertices.iter().map(|&vertex| (vertex - centre).powf(2.0)).sum::<DVec3>() / 12.0;
        let cos_limit = if both_sides { Self::UNLIMITED } else { 0.0 };
        Self { intensity, centre, variance, normal, normal_sq: 1.0, both_sides, cos_limit }
    }

    /// A point that emits in all directions.
    pub(crate) fn of_point(position: DVec3, intensity: f64) -> Self {
        let spot = Self::of_spot(position, DVec3::ZERO, Self::UNLIMITED, intensity);
        Self { normal_sq: Self::POINT_NORMAL_SQ, ..spot }
    }

    /// A point that emits within the angle of cosine `cos_limit` of `axis`.
    pub(crate) fn of_spot(position: DVec3, axis: DVec3, cos_limit: f64, intensity: f64) -> Self {
        Self {
            intensity,
            centre: position,
            variance: DVec3::ZERO,
            normal: axis,
            normal_sq: 1.0,
            both_sides: false,
            cos_limit,
        }
    }

    pub(super) fn union(&self, other: &Self) -> Self {
        let intensity = self.intensity + other.intensity;
        let share = other.intensity / intensity;
        let apart = other.centre - self.centre;
        let mean = |a: DVec3, b: DVec3| a + share * (b - a);
        Self {
            intensity,
            centre: mean(self.centre, other.centre),
            variance: mean(self.variance, other.variance) + share * (1.0 - share) * apart * apart,
            normal: mean(self.normal, other.normal),
            normal_sq: self.normal_sq + share * (other.normal_sq - self.normal_sq),
            both_sides: self.both_sides || other.both_sides,
            cos_limit: Self::UNLIMITED,
        }
    }

    /// The cost of a node with these lights: intensity by size by how much their directions differ, from 1 to 4. The
    /// surface area orientation heuristic (Conty Estevez and Kulla 2018, equation 1) with moments in place of bounds.
    pub(super) fn cost(&self) -> f64 {
        let directions = 1.0 + 3.0 * (1.0 - self.normal.length_squared());
        self.intensity * self.variance.element_sum() * directions
    }

    /// The variance of the normals along an axis, if it is the same along all.
    pub(super) fn normal_variance(&self) -> f64 {
        (self.normal_sq - self.normal.length_squared()).max(0.0) / 3.0
    }
}

/// Twice a bound on the mean of the positive part of a number of this mean and variance: no number has a larger one
/// (Scarf 1958), and without variance it is exact.
#[inline(always)]
pub(super) fn positive_part(mean: f32, variance: f32) -> f32 {
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
            let bound = 0.5 * f64::from(positive_part(mean as f32, variance as f32));
            assert!(part <= bound * (1.0 + 1e-5), "{i}: {part}, {bound}");
            attained = attained.max(part / bound);
            let exact = 0.5 * f64::from(positive_part(a as f32, 0.0));
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
            Cluster::of_spot(1000.0 + vector(0), vector(3).normalize(), 0.5, intensity)
        };
        let lights: Vec<_> = (0..32).map(light).collect();
        let total: f64 = lights.iter().map(|light| light.intensity).sum();
        let mean = |value: &dyn Fn(&Cluster) -> DVec3| {
            lights.iter().map(|light| light.intensity / total * value(light)).sum::<DVec3>()
        };
        let centre = mean(&|light| light.centre);
        let variance = mean(&|light| (light.centre - centre).powf(2.0));
        let normal = mean(&|light| light.normal);
        let in_a_row = |lights: &[Cluster]| lights.iter().copied().reduce(|a, b| a.union(&b)).unwrap();
        let halves = in_a_row(&lights[..16]).union(&in_a_row(&lights[16..]));
        for union in [in_a_row(&lights), halves] {
            assert!((union.intensity / total - 1.0).abs() < 1e-14);
            assert!((union.centre - centre).length() < 1e-12 && (union.variance - variance).length() < 1e-12);
            assert!((union.normal - normal).length() < 1e-14 && (union.normal_sq - 1.0).abs() < 1e-14);
        }
    }
}
