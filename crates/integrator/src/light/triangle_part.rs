use glam::{DVec2, DVec3, Vec3};
use globillum_geom::{Aabb, Triangle};

/// A part of a triangle, which is cut into slices parallel to its shortest side if it is much longer than wide.
///
/// The slices are equally long. The first has the tip, the vertex opposite to the shortest side, and is one part. Each of
/// the others is a trapezoid, and is two parts. A triangle that is not cut is one part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TrianglePart {
    /// The index of the tip.
    tip: u8,
    slices: u32,
    /// Among all parts, slice by slice from the tip.
    number: u32,
}

impl TrianglePart {
    pub(super) const WHOLE: Self = Self { tip: 0, slices: 1, number: 0 };

    /// A triangle is cut if its longest side is more than this many times as long as the shortest, into slices of about
    /// these proportions.
    const PROPORTIONS: f64 = 5.0;

    /// From this longest over the shortest side on, points that see a triangle from end to end sample it by area.
    const NEEDLE: f64 = 10_000.0;

    /// The most slices. More of them leave as much variance.
    const MAX_SLICES: f64 = 16.0;

    /// The parts of `triangle`, at least one and no more than `most`.
    pub(super) fn of(triangle: &Triangle, most: usize) -> impl Iterator<Item = Self> {
        let (tip, aspect) = Self::tip_and_aspect(triangle);
        let slices = (aspect / Self::PROPORTIONS).ceil().min(Self::MAX_SLICES) as u32;
        let slices = slices.min(most.div_ceil(2) as u32);
        let first = if slices > 1 { Self { tip, slices, number: 0 } } else { Self::WHOLE };
        (0..2 * first.slices - 1).map(move |number| Self { number, ..first })
    }

    /// The most parts of each of these triangles, so that all that are cut have about `parts` in all.
    pub(super) fn most_of_each<'a>(triangles: impl Iterator<Item = &'a Triangle>, parts: usize) -> usize {
        let is_cut = |triangle: &&Triangle| Self::tip_and_aspect(triangle).1 > Self::PROPORTIONS;
        parts / triangles.filter(is_cut).count().max(1)
    }

    /// Whether `triangle` is so long that it cannot be sampled by solid angle as a whole, even if it is the only light.
    pub(super) fn is_needle(triangle: &Triangle) -> bool {
        Self::tip_and_aspect(triangle).1 > Self::NEEDLE
    }

    /// The index of the tip, and the longest side over the shortest.
    fn tip_and_aspect(triangle: &Triangle) -> (u8, f64) {
        let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
        let opposite = [b.distance(c), c.distance(a), a.distance(b)];
        let (tip, shortest) = (0..)
            .zip(opposite)
            .fold((0, f64::INFINITY), |least, side| if side.1 < least.1 { side } else { least });
        let longest = opposite.into_iter().fold(0.0, f64::max);
        (tip, longest / shortest)
    }

    /// Its number among all parts, from 0 on.
    pub(super) fn number(&self) -> u32 {
        self.number
    }

    /// The number of the part of the same triangle that contains `position`.
    pub(super) fn number_at(&self, triangle: &Triangle, position: DVec3) -> u32 {
        if self.is_whole() {
            return 0;
        }
        let [tip, left, right] = self.tip_first(triangle);
        // The long sides alone would leave little of the narrow direction.
        let (left_side, shortest_side, to) = (left - tip, right - left, position - tip);
        let normal = left_side.cross(shortest_side);
        let share = |vector: DVec3| vector.dot(normal) / normal.length_squared();
        let (along, across) = (share(to.cross(shortest_side)), share(left_side.cross(to)));
        let slice = (along * f64::from(self.slices)).clamp(0.0, f64::from(self.slices - 1)) as u32;
        let [near, far] = self.ends(slice);
        // The line from the left end of the slice's near side to the right end of its far side divides it.
        let is_second = along * far - across * (far - near) < near * far;
        (2 * slice + u32::from(is_second)).saturating_sub(1)
    }

    /// The area, as a share of that of the triangle.
    pub(super) fn area_share(&self) -> f64 {
        let [near, far] = self.ends(self.slice());
        (far - near) * if self.is_second() { near } else { far }
    }

    /// The vertices. Seen from the same side, they have the order of those of the triangle.
    #[inline(always)]
    pub(super) fn vertices(&self, triangle: &Triangle) -> [DVec3; 3] {
        if self.is_whole() {
            return triangle.vertices.map(|v| v.as_dvec3());
        }
        let [tip, left, right] = self.tip_first(triangle);
        self.corners().map(|place| (1.0 - place.x - place.y) * tip + place.x * left + place.y * right)
    }

    /// Bounds of the part, at most two units of rounding larger than it.
    pub(super) fn bounds(&self, triangle: &Triangle) -> Aabb {
        if self.is_whole() {
            return triangle.bounds();
        }
        let [a, b, c] = self.vertices(triangle);
        let rounded = |v: DVec3, to: fn(f32) -> f32| Vec3::from_array(v.as_vec3().to_array().map(to));
        Aabb { min: rounded(a.min(b).min(c), f32::next_down), max: rounded(a.max(b).max(c), f32::next_up) }
    }

    /// The barycentrics in the triangle of the point of these barycentrics in the part.
    #[inline(always)]
    pub(super) fn barycentrics_in_triangle(&self, (u, v): (f64, f64)) -> (f64, f64) {
        if self.is_whole() {
            return (u, v);
        }
        let [a, b, c] = self.corners();
        let place = (1.0 - u - v) * a + u * b + v * c;
        match self.tip {
            0 => (place.x, place.y),
            1 => (1.0 - place.x - place.y, place.x),
            _ => (place.y, 1.0 - place.x - place.y),
        }
    }

    /// The vertices of the triangle, the tip first.
    #[inline(always)]
    fn tip_first(&self, triangle: &Triangle) -> [DVec3; 3] {
        [0, 1, 2].map(|i| triangle.vertices[(usize::from(self.tip) + i) % 3].as_dvec3())
    }

    /// The vertices of the part as barycentrics, of which the two are of the vertices after the tip.
    #[inline(always)]
    fn corners(&self) -> [DVec2; 3] {
        let [near, far] = self.ends(self.slice());
        let [left, right] = [DVec2::X, DVec2::Y];
        if self.is_second() {
            [near * left, far * right, near * right]
        } else {
            [near * left, far * left, far * right]
        }
    }

    #[inline(always)]
    fn is_whole(&self) -> bool {
        self.slices == 1
    }

    #[inline(always)]
    fn slice(&self) -> u32 {
        self.number.div_ceil(2)
    }

    #[inline(always)]
    fn is_second(&self) -> bool {
        self.number > 0 && self.number.is_multiple_of(2)
    }

    /// How far the ends of a slice are from the tip, as shares of the whole.
    #[inline(always)]
    fn ends(&self, slice: u32) -> [f64; 2] {
        [slice, slice + 1].map(|end| f64::from(end) / f64::from(self.slices))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use glam::Vec3;

    /// Triangles of sides of 1 and about `length`, of which each vertex is the tip of one, and one that is as long but has no
    /// short side.
    fn triangles(length: f32) -> [Triangle; 4] {
        let [a, b, c] =
            [Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 3.0, 3.0), Vec3::new(1.0 + length, 2.1, 3.0)];
        let flat = Vec3::new(1.0 + 0.5 * length, 3.0, 3.0);
        [[a, b, c], [c, a, b], [b, c, a], [a, flat, c]].map(|vertices| Triangle { vertices })
    }

    fn parts(triangle: &Triangle, most: usize) -> Vec<TrianglePart> {
        TrianglePart::of(triangle, most).collect()
    }

    #[test]
    fn long_triangles_are_cut() {
        for (length, most, expected) in [
            (1.0, 99, 1),
            (4.9, 99, 1),
            (6.0, 99, 3),
            (49.0, 99, 19),
            (1e6, 99, 31),
            (1e6, 30, 29),
            (1e6, 1, 1),
        ] {
            let counts = triangles(length).map(|triangle| parts(&triangle, most).len());
            assert_eq!(counts, [expected, expected, expected, 1], "{length}, {most}");
        }
    }

    /// Areas of parts add up to that of the triangle, a point sampled in a part is in that part alone, and parts have the
    /// front of the triangle.
    #[test]
    fn parts_tile_the_triangle() {
        for triangle in [7.0, 23.0, 99.0, 1e4].into_iter().flat_map(triangles) {
            let (parts, mut area) = (parts(&triangle, 99), 0.0);
            for (number, part) in (0..).zip(&parts) {
                let [a, b, c] = part.vertices(&triangle);
                let area_vector = 0.5 * (b - a).cross(c - a);
                let error = area_vector - triangle.area() * part.area_share() * triangle.normal();
                assert!(error.length() < 1e-12 * triangle.area(), "{part:?} of {triangle:?}: {area_vector}");
                area += part.area_share();
                for i in 0..100 {
                    let in_part = Triangle::sample_uniform(Stream::new(0, 0, i).uniform_pair(0));
                    let (u, v) = part.barycentrics_in_triangle(in_part);
                    let [e1, e2] = triangle.edges();
                    let position = triangle.vertices[0].as_dvec3() + u * e1 + v * e2;
                    let expected = a + in_part.0 * (b - a) + in_part.1 * (c - a);
                    assert!(position.distance(expected) < 1e-15 * e1.length().max(e2.length()).max(4.0));
                    assert_eq!(parts[0].number_at(&triangle, position), number, "{part:?} of {triangle:?}");
                }
            }
            assert!((area - 1.0).abs() < 1e-14, "{area}");
        }
    }

    /// However narrow the triangle, rounding leaves points in their slices.
    #[test]
    fn narrow_triangles_are_cut_across() {
        let [tip, left, right] = [Vec3::ONE, Vec3::ZERO, Vec3::X * 1e-30];
        for vertices in [[tip, left, right], [right, tip, left], [left, right, tip]] {
            let triangle = Triangle { vertices };
            let parts = parts(&triangle, 99);
            assert_eq!(parts.len(), 31);
            for (number, part) in (0..).zip(&parts) {
                let middle = part.vertices(&triangle).iter().sum::<DVec3>() / 3.0;
                let found = parts[0].number_at(&triangle, middle);
                assert_eq!(parts[found as usize].slice(), part.slice(), "{number} of {triangle:?}");
            }
        }
    }

    /// Rounding may put a point of a triangle outside.
    #[test]
    fn points_outside_belong_to_a_part() {
        for triangle in triangles(99.0).into_iter().take(3) {
            let parts = parts(&triangle, 99);
            for beside in DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]) {
                for vertex in triangle.vertices {
                    let number = parts[0].number_at(&triangle, vertex.as_dvec3() + beside);
                    assert!((number as usize) < parts.len(), "{number}");
                }
            }
        }
    }
}
