use super::lattice::Lattice;
use crate::accel::prune::{Pruner, Span};
use crate::decide::main_axis;
use crate::{Aabb, Ray};
use glam::DVec3;

/// The traversal of a lattice along a ray.
///
/// Visits every cell that the ray, widened by the pruning slack, intersects: layer by layer along the ray's
/// main axis, and row by row within a layer. Each crossing is computed from the cell's index, so that errors
/// do not accumulate.
pub(super) struct Walk<'a> {
    lattice: &'a Lattice,
    pruner: Pruner,
    /// The part of the ray within the lattice.
    span: Span,
    /// The ray's origin relative to the corner of the lattice.
    origin: DVec3,
    /// The axes of layers, of rows within a layer, and of cells within a row.
    axes: [usize; 3],
}

impl<'a> Walk<'a> {
    /// The traversal for a [traceable](Ray::is_traceable) ray; `None` if it misses `bounds` or these are
    /// empty.
    pub(super) fn new(lattice: &'a Lattice, bounds: &Aabb, ray: &Ray) -> Option<Self> {
        if bounds.is_empty() {
            return None;
        }
        let pruner = Pruner::new(ray, bounds);
        let span = pruner.clip(ray, bounds);
        let main = main_axis(pruner.direction);
        let axes = [main, (main + 1) % 3, (main + 2) % 3];
        let origin = pruner.origin - lattice.corner;
        (span.start <= span.end).then_some(Self { lattice, pruner, span, origin, axes })
    }

    /// Calls `open` with each cell; cells that start beyond the `t` that it returned last are skipped.
    pub(super) fn for_each_cell(&self, mut open: impl FnMut([u32; 3]) -> f64) {
        let [layers, rows, columns] = self.axes;
        let (mut cell, mut t_end) = ([0; 3], f64::INFINITY);
        for layer in self.indices(layers, self.span) {
            cell[layers] = layer;
            let span = self.within(layers, layer, self.span);
            // Layers and rows are in the order of the ray, so all later ones start farther away.
            if span.start > t_end {
                break;
            }
            for row in self.indices(rows, span) {
                cell[rows] = row;
                let span = self.within(rows, row, span);
                if span.start > t_end {
                    break;
                }
                for column in self.indices(columns, span) {
                    // A hit in this row may end the traversal of its remaining columns.
                    if span.start > t_end {
                        break;
                    }
                    cell[columns] = column;
                    t_end = open(cell);
                }
            }
        }
    }

    /// The cells along `axis` that the widened ray intersects within `span`, in the order of the ray; none
    /// for an empty span.
    fn indices(&self, axis: usize, span: Span) -> impl Iterator<Item = u32> + use<> {
        let at = |t: f64| self.origin[axis] + t * self.pruner.direction[axis];
        let (a, b) = (at(span.start), at(span.end));
        let first = self.lattice.index(axis, a.min(b) - self.pruner.slack);
        let last = self.lattice.index(axis, a.max(b) + self.pruner.slack);
        let count = if span.start <= span.end { last - first + 1 } else { 0 };
        let backward = self.pruner.direction[axis] < 0.0;
        (0..count).map(move |i| if backward { last - i } else { first + i })
    }

    /// The part of `span` within the widened slab of cell `index` along `axis`.
    fn within(&self, axis: usize, index: u32, span: Span) -> Span {
        let distance = |plane| self.lattice.plane(axis, plane) - self.origin[axis];
        let (low, high) = (distance(index), distance(index + 1));
        let (enter, leave) = if self.pruner.direction[axis] > 0.0 { (low, high) } else { (high, low) };
        Span {
            start: span.start.max(self.pruner.crossing(axis, enter, false)),
            end: span.end.min(self.pruner.crossing(axis, leave, true)),
        }
    }
}
