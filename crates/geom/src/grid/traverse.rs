use super::UniformGrid;
use crate::decide::{Shear, main_axis};
use crate::prune::{Pruner, Span};
use crate::search::offer_all;
use crate::{Probe, Ray, Search};
use glam::DVec3;

impl UniformGrid {
    /// Runs `search` along `ray`, counting into `probe`: the one traversal behind every query.
    ///
    /// Layer by layer along the ray's main axis, and within a layer row by row: every cell that
    /// the ray, thickened by the pruning slack, passes through. Each crossing is computed from
    /// the cell's index and none from the crossing before, so that no error accumulates.
    pub fn search<S: Search, P: Probe>(&self, ray: &Ray, mut search: S, probe: &mut P) -> S {
        if let Some(shear) = Shear::new(ray) {
            let bounds = self.triangles.bounds();
            if !bounds.is_empty() {
                let pruner = Pruner::new(ray, &bounds);
                let span = pruner.clip(ray, &bounds);
                if span.start <= span.end {
                    let origin = pruner.origin - self.lattice.corner;
                    let walk = Walk { grid: self, shear, pruner, origin, axes: axes_by_speed(&pruner) };
                    walk.layers(span, &mut search, probe);
                }
            }
        }
        search
    }
}

/// One ray's way through the grid.
struct Walk<'a> {
    grid: &'a UniformGrid,
    shear: Shear,
    pruner: Pruner,
    /// The ray's origin relative to the lattice's corner.
    origin: DVec3,
    /// Layers along the first axis, rows along the second, cells along the third.
    axes: [usize; 3],
}

fn axes_by_speed(pruner: &Pruner) -> [usize; 3] {
    let main = main_axis(pruner.direction);
    [main, (main + 1) % 3, (main + 2) % 3]
}

impl Walk<'_> {
    fn layers<S: Search, P: Probe>(&self, span: Span, search: &mut S, probe: &mut P) {
        let mut cell = [0; 3];
        for layer in self.indices(self.axes[0], span) {
            cell[self.axes[0]] = layer;
            let span = self.within(self.axes[0], layer, span);
            // Layers come in the ray's order, so nothing nearer can follow.
            if span.start > search.t_end() {
                break;
            }
            self.rows(&mut cell, span, search, probe);
        }
    }

    fn rows<S: Search, P: Probe>(&self, cell: &mut [u32; 3], span: Span, search: &mut S, probe: &mut P) {
        for row in self.indices(self.axes[1], span) {
            cell[self.axes[1]] = row;
            let span = self.within(self.axes[1], row, span);
            for column in self.indices(self.axes[2], span) {
                cell[self.axes[2]] = column;
                self.open(*cell, search, probe);
            }
        }
    }

    fn open<S: Search, P: Probe>(&self, cell: [u32; 3], search: &mut S, probe: &mut P) {
        probe.visit();
        let flat = self.grid.lattice.flat(cell);
        let listed = self.grid.starts[flat] as usize..self.grid.starts[flat + 1] as usize;
        if !listed.is_empty() {
            probe.open();
            let listed = &self.grid.references[listed];
            offer_all(&self.shear, &self.grid.triangles, listed, search, probe);
        }
    }

    /// The cells along `axis` that the thickened ray touches within `span`, in the ray's order;
    /// none for an empty span.
    fn indices(&self, axis: usize, span: Span) -> impl Iterator<Item = u32> + use<> {
        let lattice = &self.grid.lattice;
        let at = |t: f64| self.origin[axis] + t * self.pruner.direction[axis];
        let (a, b) = (at(span.start), at(span.end));
        let first = lattice.index(axis, a.min(b) - self.pruner.slack);
        let last = lattice.index(axis, a.max(b) + self.pruner.slack);
        let count = if span.start <= span.end { last - first + 1 } else { 0 };
        let backward = self.pruner.direction[axis] < 0.0;
        (0..count).map(move |i| if backward { last - i } else { first + i })
    }

    /// The part of `span` within the widened slab of cell `index` along `axis`.
    fn within(&self, axis: usize, index: u32, span: Span) -> Span {
        let lattice = &self.grid.lattice;
        let distance = |plane| lattice.plane(axis, plane) - self.origin[axis];
        let (low, high) = (distance(index), distance(index + 1));
        let (enter, leave) = if self.pruner.direction[axis] > 0.0 { (low, high) } else { (high, low) };
        Span {
            start: span.start.max(self.pruner.crossing(axis, enter, false)),
            end: span.end.min(self.pruner.crossing(axis, leave, true)),
        }
    }
}
