use crate::light::Receiver;

/// Coordinates by which vertices are divided.
const AXES: usize = 6;

/// The coordinates of a path vertex.
pub(crate) type GuideVertex = [f32; AXES];

/// The coordinates of a vertex at which the side of the path is that of the receiver.
#[inline(always)]
pub(crate) fn guide_vertex(Receiver { position, normal }: Receiver) -> GuideVertex {
    let [x, y, z] = position.as_vec3().to_array();
    // Where a normal's z changes sign, its local frame jumps. Vertices are divided there first.
    [x, y, z, normal.x, normal.y, normal.z + FRAMES_APART.copysign(normal.z)]
}

/// Half the distance between vertices whose local frames differ by a jump.
const FRAMES_APART: f32 = 2.0;

/// A complete binary tree over vertices. The children of node `i` are `2 i + 1` and `2 i + 2`; the leaves are cells.
#[derive(Clone, Debug)]
pub(super) struct VertexTree {
    splits: Vec<Split>,
    depth: u32,
}

/// A vertex whose coordinate `axis` is `at` or more belongs to the second child.
#[derive(Clone, Copy, Debug, Default)]
struct Split {
    axis: u32,
    at: f32,
}

impl VertexTree {
    /// A tree of `2^depth` cells, divided at medians of `vertices`. Changes their order.
    pub(super) fn build(vertices: &mut [GuideVertex], depth: u32) -> Self {
        let mut tree = Self { splits: vec![Split::default(); (1 << depth) - 1], depth };
        let extents = extents(vertices);
        let size = extents[0].max(extents[1]).max(extents[2]).max(f32::MIN_POSITIVE);
        // The size of the scene divides vertices as far as a turn of the normal by 60 degrees.
        let weights = [size, size, size, 1.0, 1.0, 1.0].map(f32::recip);
        tree.split(0, vertices, &weights);
        tree
    }

    fn split(&mut self, node: usize, vertices: &mut [GuideVertex], weights: &[f32; AXES]) {
        if node >= self.splits.len() {
            return;
        }
        let extents = extents(vertices);
        let weighted = |axis: &usize| extents[*axis] * weights[*axis];
        let axis = (0..AXES).max_by(|a, b| weighted(a).total_cmp(&weighted(b))).unwrap_or(0);
        let at = median(vertices, axis);
        self.splits[node] = Split { axis: axis as u32, at };
        vertices.sort_unstable_by_key(|vertex| vertex[axis] >= at);
        let (first, second) = vertices.split_at_mut(vertices.partition_point(|vertex| vertex[axis] < at));
        self.split(2 * node + 1, first, weights);
        self.split(2 * node + 2, second, weights);
    }

    /// The cells of vertices.
    #[inline(always)]
    pub(super) fn cells<const N: usize>(&self, vertices: &[GuideVertex; N]) -> [usize; N] {
        let mut nodes = [0; N];
        for _ in 0..self.depth {
            for (node, vertex) in nodes.iter_mut().zip(vertices) {
                let Split { axis, at } = self.splits[*node];
                *node = 2 * *node + 1 + usize::from(vertex[axis as usize] >= at);
            }
        }
        nodes.map(|node| node - self.splits.len())
    }
}

/// The median coordinate, or the middle if half of the vertices have the least one; 0 if there are no vertices.
fn median(vertices: &mut [GuideVertex], axis: usize) -> f32 {
    let by_axis = |a: &GuideVertex, b: &GuideVertex| a[axis].total_cmp(&b[axis]);
    let least = vertices.iter().copied().min_by(by_axis).map_or(0.0, |vertex| vertex[axis]);
    let greatest = vertices.iter().copied().max_by(by_axis).map_or(0.0, |vertex| vertex[axis]);
    if vertices.is_empty() {
        return 0.0;
    }
    let (_, median, _) = vertices.select_nth_unstable_by(vertices.len() / 2, by_axis);
    if median[axis] > least { median[axis] } else { f32::midpoint(least, greatest) }
}

/// The length of the interval of each coordinate; 0 if there are no vertices.
fn extents(vertices: &[GuideVertex]) -> [f32; AXES] {
    let (mut low, mut high) = ([f32::INFINITY; AXES], [f32::NEG_INFINITY; AXES]);
    for vertex in vertices {
        low = std::array::from_fn(|axis| low[axis].min(vertex[axis]));
        high = std::array::from_fn(|axis| high[axis].max(vertex[axis]));
    }
    std::array::from_fn(|axis| (high[axis] - low[axis]).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Stream;
    use glam::{DVec3, Vec3};

    /// A floor, a ceiling and a wall.
    fn vertices() -> Vec<GuideVertex> {
        let stream = Stream::new(1, 2, 3);
        let on = |i: u32| match (stream.uniform_pair(2 * i), i % 3) {
            ([x, y], 0) => guide_vertex(Receiver { position: DVec3::new(x, y, 0.0), normal: Vec3::Z }),
            ([x, y], 1) => guide_vertex(Receiver { position: DVec3::new(x, y, 1.0), normal: -Vec3::Z }),
            ([x, y], _) => guide_vertex(Receiver { position: DVec3::new(0.0, x, y), normal: Vec3::X }),
        };
        (0..12_000).map(on).collect()
    }

    #[test]
    fn cells_have_about_as_many_vertices() {
        let vertices = vertices();
        let tree = VertexTree::build(&mut vertices.clone(), 6);
        let mut counts = [0; 64];
        vertices.iter().for_each(|vertex| counts[tree.cells(&[*vertex])[0]] += 1);
        assert!(counts.iter().all(|count| (80..400).contains(count)), "{counts:?}");
    }

    #[test]
    fn vertices_of_a_cell_have_one_normal() {
        let vertices = vertices();
        let tree = VertexTree::build(&mut vertices.clone(), 4);
        let mut normals = [None; 16];
        for vertex in &vertices {
            let normal = Vec3::from_slice(&vertex[3..]);
            assert_eq!(*normals[tree.cells(&[*vertex])[0]].get_or_insert(normal), normal);
        }
    }

    #[test]
    fn no_vertices_or_equal_ones_are_a_tree_too() {
        for mut vertices in [vec![], vec![[1.0; AXES]; 5]] {
            let tree = VertexTree::build(&mut vertices, 3);
            assert!(tree.cells(&[[1.0; AXES], [f32::NAN; AXES]]).iter().all(|&cell| cell < 8));
        }
    }
}
