use super::tree::{KdTree, Node};
use crate::Aabb;

/// Statistics of a [`KdTree`], and the expected cost of a ray.
///
/// *Expected* numbers are for a uniformly random line through the tree's bounds that hits nothing. It
/// intersects a cell with a probability that is the ratio of the surface areas of the cell and of the bounds
/// (Goldsmith and Salmon, 1987).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct KdStats {
    /// The number of planes above the deepest leaf.
    pub depth: u32,
    /// The number of nodes, leaves included.
    pub nodes: usize,
    /// The number of leaves, empty ones included.
    pub leaves: usize,
    /// The number of leaves without triangles.
    pub empty_leaves: usize,
    /// The number of triangle references in all leaves.
    pub references: usize,
    /// References per live triangle; 0 if there is none.
    pub references_per_triangle: f64,
    /// The fraction of the bounds' volume in empty leaves, in `[0, 1]`; 0 for a flat scene.
    pub empty_volume: f64,
    /// The median ratio of the longest to the shortest side over all leaves with triangles: infinite if most
    /// are flat, 0 if there is no such leaf.
    pub aspect: f64,
    /// The expected number of inner nodes visited.
    pub expected_visits: f64,
    /// The expected number of leaves with triangles visited.
    pub expected_opened: f64,
    /// The expected number of triangle tests, repeated ones included.
    pub expected_tests: f64,
}

impl KdStats {
    /// The expected cost of a ray, which the surface area heuristic minimizes. It and `traversal_cost`, the
    /// cost of visiting an inner node, are in units of one triangle test.
    pub fn expected_cost(&self, traversal_cost: f64) -> f64 {
        traversal_cost * self.expected_visits + self.expected_tests
    }
}

impl KdTree {
    /// The statistics of the tree, in time linear in the number of nodes.
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

    /// Calls `visit` with each node, its cell and the number of planes above it.
    fn for_each_cell(&self, mut visit: impl FnMut(&Node, &Aabb, u32)) {
        // An explicit stack instead of recursion.
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

/// `part / whole`; 0 if `whole` is not positive.
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
