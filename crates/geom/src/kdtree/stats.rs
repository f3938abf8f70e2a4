use super::tree::{KdTree, Node};
use crate::Aabb;

/// What a [`KdTree`] looks like, and what a ray is expected to cost in it.
///
/// *Expected* numbers are for a ray that meets the tree's bounds and hits nothing, its line drawn
/// at random among all that do: such a ray meets a cell with a probability that is the cell's
/// surface over that of the bounds (Goldsmith and Salmon, 1987).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct KdStats {
    /// Number of planes above the deepest leaf.
    pub depth: u32,
    /// Nodes, leaves included.
    pub nodes: usize,
    /// Leaves, empty ones included.
    pub leaves: usize,
    /// Leaves that list nothing.
    pub empty_leaves: usize,
    /// How many triangles the leaves list, repetitions included.
    pub references: usize,
    /// The same for each triangle that can be hit; 0 if there is none.
    pub references_per_triangle: f64,
    /// The empty leaves' share of the bounds' volume; 0 for a flat scene.
    pub empty_volume: f64,
    /// Longest over shortest side of a leaf that lists something, the median of all: infinite if
    /// most are flat, 0 if there is none.
    pub aspect: f64,
    /// Inner nodes that a ray is expected to visit.
    pub expected_visits: f64,
    /// Leaves with triangles that it is expected to open.
    pub expected_opened: f64,
    /// Triangles that it is expected to have decided, repetitions included.
    pub expected_tests: f64,
}

impl KdStats {
    /// What the surface area heuristic makes small: the expected cost of a ray, in units of
    /// deciding one triangle, where visiting an inner node costs `traversal_cost` of them.
    pub fn expected_cost(&self, traversal_cost: f64) -> f64 {
        traversal_cost * self.expected_visits + self.expected_tests
    }
}

impl KdTree {
    /// Measures the tree: looks at every node.
    pub fn stats(&self) -> KdStats {
        let mut stats = KdStats::default();
        let mut aspects = Vec::new();
        let bounds = self.triangles.bounds();
        self.for_each_cell(|node, cell, depth| {
            stats.nodes += 1;
            stats.depth = stats.depth.max(depth);
            let probability = ratio(cell.half_area(), bounds.half_area());
            match *node {
                Node::Split { .. } => stats.expected_visits += probability,
                Node::Leaf { count, .. } => {
                    stats.leaves += 1;
                    stats.references += count as usize;
                    stats.expected_tests += probability * f64::from(count);
                    if count == 0 {
                        stats.empty_leaves += 1;
                        stats.empty_volume += ratio(volume(cell), volume(&bounds));
                    } else {
                        stats.expected_opened += probability;
                        aspects.push(cell.extent().max_element() / cell.extent().min_element());
                    }
                }
            }
        });
        stats.references_per_triangle = ratio(stats.references as f64, self.triangles.live().len() as f64);
        stats.aspect = median(&mut aspects);
        stats
    }

    /// Calls `visit` with every node, its cell and the number of planes above it.
    fn for_each_cell(&self, mut visit: impl FnMut(&Node, &Aabb, u32)) {
        // Walked with an explicit stack, so that depth costs no call stack.
        let mut open = vec![(0, self.triangles.bounds(), 0)];
        while let Some((index, cell, depth)) = open.pop() {
            let node = &self.nodes[index];
            visit(node, &cell, depth);
            if let Node::Split { axis, position, upper } = *node {
                let [mut low, mut high] = [cell; 2];
                low.max[usize::from(axis)] = position;
                high.min[usize::from(axis)] = position;
                open.extend([(index + 1, low, depth + 1), (upper as usize, high, depth + 1)]);
            }
        }
    }
}

/// `part / whole`, and 0 for a part of nothing.
fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

fn volume(cell: &Aabb) -> f64 {
    cell.extent().element_product()
}

fn median(values: &mut [f64]) -> f64 {
    let half = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(half, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{KdOptions, SplitRule, Triangle, Triangles};
    use glam::Vec3;

    #[test]
    fn two_triangles_and_the_space_between() {
        // Two triangles in the planes x = 0 and x = 4 of a box 4 by 1 by 1.
        let wall = |x: f32| Triangle::new(Vec3::X * x, Vec3::new(x, 1.0, 0.0), Vec3::new(x, 0.0, 1.0));
        let triangles = Triangles::new(vec![wall(0.0), wall(4.0)]).unwrap();
        let options = KdOptions {
            max_depth: 2,
            leaf_size: 0,
            traversal_cost: 0.0,
            ..KdOptions::by_rule(SplitRule::Midpoint)
        };
        let stats = KdTree::build(&triangles, &options).unwrap().stats();
        // Halved at 2, and both halves at 1 and 3: the inner two quarters are empty.
        assert_eq!((stats.depth, stats.nodes, stats.leaves, stats.empty_leaves), (2, 7, 4, 2));
        assert_eq!((stats.references, stats.references_per_triangle), (2, 1.0));
        assert_eq!((stats.empty_volume, stats.aspect), (0.5, 1.0));
        // Half areas: 9 for the whole, 5 for a half, 3 for a quarter.
        assert_eq!(stats.expected_visits, 1.0 + 5.0 / 9.0 + 5.0 / 9.0);
        assert_eq!(stats.expected_tests, stats.expected_opened);
        assert!((stats.expected_tests - 6.0 / 9.0).abs() < 1e-15);
        assert!((stats.expected_cost(9.0) - 19.0 - 6.0 / 9.0).abs() < 1e-14);
    }

    #[test]
    fn nothing_has_no_shape() {
        let nothing = KdTree::build(&Triangles::new(Vec::new()).unwrap(), &KdOptions::default()).unwrap();
        assert_eq!(nothing.stats(), KdStats { nodes: 1, leaves: 1, empty_leaves: 1, ..KdStats::default() });
    }
}
