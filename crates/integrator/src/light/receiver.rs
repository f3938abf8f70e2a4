use glam::{DVec3, Vec3};
use globillum_geom::Triangle;

/// A point of a surface that receives light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Receiver {
    pub(crate) position: DVec3,
    /// The unit normal on the side of the surface where light counts.
    pub(crate) normal: Vec3,
}

impl Receiver {
    /// Whether all of `triangle` certainly lies behind the surface, so that its light does not count.
    #[inline(always)]
    pub(super) fn has_behind(&self, triangle: &Triangle) -> bool {
        let to_vertices = triangle.vertices.map(|vertex| vertex.as_dvec3() - self.position);
        let normal = self.normal.as_dvec3();
        let [a, b, c] = to_vertices.map(|to_vertex| normal.dot(to_vertex));
        let [d, e, f] = to_vertices.map(DVec3::abs);
        a.max(b).max(c) < -MARGIN * d.max(e).max(f).max_element()
    }
}

/// Part of the largest distance of a vertex along an axis. It exceeds two errors. The normal is rounded to single precision,
/// twice in the image of a receiver in a mirror. A point sampled on the triangle is off by some `2^-52` of its coordinates:
/// along an axis the vertices have all the same coordinate, and the point has it too, or one is at least `2^-26` of the
/// largest coordinate away.
const MARGIN: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// Random triangles around receivers: some at the origin and some far from it, some as good as in the plane of the
    /// surface, and some a few units of rounding in size. No point of a triangle behind a surface is above it, and each
    /// triangle that is clearly below is found.
    #[test]
    fn triangles_behind_a_surface_are_those_below_it() {
        let (mut behind, mut tiny) = (0, 0);
        for i in 0..200_000 {
            let stream = Stream::new(0, 0, i);
            let vector = |at: u32| DVec3::from([0, 1, 2].map(|k| 2.0 * stream.uniform(3 * at + k) - 1.0));
            let normal = if i % 7 == 0 { DVec3::AXES[i as usize % 3] } else { vector(0).normalize() };
            // Single precision has steps of a sixteenth at 1e6.
            let offset = [0.0, 1e4, 3e4, 1e6][i as usize % 4] * vector(1);
            let position = offset + vector(2);
            let receiver = Receiver { position, normal: normal.as_vec3() };
            let flatness = if i % 3 == 0 { 1e-7 } else { 1.0 };
            let size = if i % 5 == 0 { 0.1 } else { 1.0 };
            let vertex = |at: u32| {
                let to_vertex = size * vector(at);
                (position + to_vertex + (flatness - 1.0) * normal.dot(to_vertex) * normal).as_vec3()
            };
            let triangle = Triangle::new(vertex(3), vertex(4), vertex(5));
            let heights = triangle.vertices.map(|vertex| normal.dot(vertex.as_dvec3() - position));
            let highest = heights.into_iter().fold(f64::NEG_INFINITY, f64::max);
            if !receiver.has_behind(&triangle) {
                assert!(highest >= -3e-6, "{i}: {highest}");
                continue;
            }
            behind += 1;
            tiny += u32::from(size < 1.0 && offset.length() > 1e5);
            for k in 0..8 {
                let (u, v) = Triangle::sample_uniform(stream.uniform_pair(20 + 2 * k));
                let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
                let point = a + (u * (b - a) + v * (c - a));
                assert!(normal.dot(point - position) < 0.0, "{i}");
            }
        }
        assert!(behind > 15_000 && tiny > 500, "{behind}, {tiny} of them tiny");
    }
}
