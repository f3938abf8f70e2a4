use glam::{DVec3, Vec3};
use globillum_geom::Triangle;

/// A point of a surface that receives light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Receiver {
    pub(crate) position: DVec3,
    /// The unit normal on the side of the surface where light counts.
    pub(crate) side: Vec3,
}

impl Receiver {
    /// Whether all of `triangle` certainly lies behind the surface, so that its light does not count.
    #[inline(always)]
    pub(super) fn has_behind(&self, triangle: &Triangle) -> bool {
        let to_vertices = triangle.vertices.map(|vertex| vertex.as_dvec3() - self.position);
        let side = self.side.as_dvec3();
        let [a, b, c] = to_vertices.map(|to_vertex| side.dot(to_vertex));
        let [d, e, f] = to_vertices.map(DVec3::abs);
        a.max(b).max(c) < -MARGIN * d.max(e).max(f).max_element()
    }
}

/// Part of the largest distance of a vertex along an axis. It exceeds the errors of the side, which is in single precision,
/// and of a point sampled on the triangle: since its vertices differ, one is at least `2^-26` of their coordinates away.
const MARGIN: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;

    /// Random triangles around receivers, in scenes at and far from the origin: points of a triangle behind a surface are
    /// below it, and most triangles with all vertices below are found.
    #[test]
    fn no_point_of_a_triangle_behind_a_surface_is_above_it() {
        let (mut behind, mut below) = (0, 0);
        for i in 0..200_000 {
            let stream = Stream::new(0, 0, i);
            let vector = |at: u32| DVec3::from([0, 1, 2].map(|k| 2.0 * stream.uniform(3 * at + k) - 1.0));
            let normal = vector(0).normalize();
            let offset = f64::from(i % 4) * 1e4 * vector(1);
            let position = offset + vector(2);
            let receiver = Receiver { position, side: normal.as_vec3() };
            // Some are as good as in the plane of the surface.
            let flat = if i % 3 == 0 { 1e-7 } else { 1.0 };
            let vertex = |at: u32| {
                let to_vertex = vector(at);
                let height = normal.dot(to_vertex);
                (position + to_vertex + (flat - 1.0) * height * normal).as_vec3()
            };
            let triangle = Triangle::new(vertex(3), vertex(4), vertex(5));
            let heights = triangle.vertices.map(|vertex| normal.dot(vertex.as_dvec3() - position));
            let is_behind = receiver.has_behind(&triangle);
            behind += u32::from(is_behind);
            below += u32::from(heights.iter().all(|&height| height < -0.01));
            if is_behind {
                for k in 0..8 {
                    let (u, v) = Triangle::sample_uniform(stream.uniform_pair(20 + 2 * k));
                    let [a, b, c] = triangle.vertices.map(|vertex| vertex.as_dvec3());
                    let point = a + u * (b - a) + v * (c - a);
                    assert!(normal.dot(point - position) < 0.0, "{i}");
                }
            }
        }
        assert!(below > 10_000 && behind >= below, "{behind} of {below}");
    }
}
