//! The binary tree with the help of a grid instead of a k-d tree: references are sorted by its cells in linear time, and
//! upper levels are split between cells instead of references.

use super::binary_tree::BinaryTree;
use super::sah::{Bounded, center, center_bounds, split_in_bins};
use crate::Aabb;
use crate::accel::grid::Lattice;
use crate::accel::prim_ref::PrimRef;
use crate::accel::wide::tree::MAX_LEVELS;

/// Cells for each reference. A surface meets few of them; each of those holds about ten of its triangles.
const DENSITY: f64 = 0.5;

/// Fewer references than this are not sorted into a grid.
const GRID_REFS: usize = 256;

/// Cells with no more references than this are split by references.
const CELL_REFS: usize = 64;

/// Halves with fewer references than this are not built in parallel.
const PARALLEL_REFS: usize = 4096;

/// A cell with the references whose centers are in it, or a reference larger than a cell.
#[derive(Clone, Copy, Debug)]
struct GridCell {
    /// The bounds of its references, which may reach beyond the cell.
    bounds: Aabb,
    /// Where its references begin, and how many there are.
    first: u32,
    count: u32,
}

impl Bounded for GridCell {
    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn count(&self) -> usize {
        self.count as usize
    }
}

impl BinaryTree {
    /// The binary tree of a scene within `bounds`, without k-d planes: upper levels are split between the cells of a
    /// grid. `refs` are reordered.
    ///
    /// It is built in parallel on the current rayon pool.
    pub(super) fn by_grid(bounds: &Aabb, refs: &mut [PrimRef]) -> Self {
        let mut this = Self::empty(bounds);
        this.add_by_grid(0, refs, MAX_LEVELS);
        this
    }

    /// Like [`BinaryTree::add_refs`], with upper levels split between the cells of a grid.
    fn add_by_grid(&mut self, first: u32, refs: &mut [PrimRef], levels_left: u32) {
        if refs.len() <= GRID_REFS || levels_left <= MAX_LEVELS / 2 {
            self.add_refs(first, refs, levels_left);
        } else {
            let (sorted, mut cells) = sort_by_cell(refs);
            self.add_cells(first, refs, &sorted, &mut cells, levels_left);
        }
    }

    /// Adds the references of these cells, which are ranges of `sorted`, after writing them to `refs`.
    fn add_cells(
        &mut self,
        first: u32,
        refs: &mut [PrimRef],
        sorted: &[PrimRef],
        cells: &mut [GridCell],
        levels_left: u32,
    ) {
        let must_balance = levels_left <= MAX_LEVELS / 2;
        let split = if refs.len() <= CELL_REFS || must_balance { None } else { split_in_bins(cells) };
        let Some((axis, lower)) = split else {
            let mut rest = &mut *refs;
            for cell in &*cells {
                let (place, others) = rest.split_at_mut(cell.count as usize);
                place.copy_from_slice(&sorted[cell.first as usize..][..cell.count as usize]);
                rest = others;
            }
            // A cell that holds many references is divided by a grid of its own, unless this one did not divide them.
            return match cells {
                [_] if refs.len() < sorted.len() => self.add_by_grid(first, refs, levels_left),
                _ => self.add_refs(first, refs, levels_left),
            };
        };
        let (low_cells, high_cells) = cells.split_at_mut(lower);
        let lower = low_cells.iter().map(|cell| cell.count).sum::<u32>();
        let (low, high) = refs.split_at_mut(lower as usize);
        let levels_left = levels_left - 1;
        if rayon::current_num_threads() == 1 || low.len().min(high.len()) < PARALLEL_REFS {
            let halves = [(first, low, low_cells), (first + lower, high, high_cells)];
            self.add_inner(axis, halves, |this, (first, refs, cells)| {
                this.add_cells(first, refs, sorted, cells, levels_left);
            });
        } else {
            let (mut below, mut above) = (self.without_nodes(), self.without_nodes());
            rayon::join(
                || below.add_cells(first, low, sorted, low_cells, levels_left),
                || above.add_cells(first + lower, high, sorted, high_cells, levels_left),
            );
            self.add_inner(axis, [below, above], |this, half| this.append(&half));
        }
    }
}

/// The references sorted by cells, and the cells that are not empty. A reference larger than a cell is one by itself:
/// together with small references it would widen the bounds of all of them.
fn sort_by_cell(refs: &[PrimRef]) -> (Vec<PrimRef>, Vec<GridCell>) {
    let centers = center_bounds(refs);
    let lattice = Lattice::with_density(&centers, refs.len(), DENSITY);
    let mut count = lattice.cell_count();
    let cell_of = |reference: &PrimRef| {
        if reference.bounds.extent().max_element() > lattice.longest_edge() {
            count += 1;
            return count as u32 - 1;
        }
        lattice.cell_of(center(reference).truncate()) as u32
    };
    let cells: Vec<u32> = refs.iter().map(cell_of).collect();
    let mut ends = vec![0_u32; count];
    cells.iter().for_each(|&cell| ends[cell as usize] += 1);
    let mut end = 0;
    for count in &mut ends {
        end += *count;
        *count = end;
    }
    // Cells are filled from their ends, which turns ends into starts.
    let mut sorted = refs.to_vec();
    for (reference, &cell) in refs.iter().zip(&cells).rev() {
        let start = &mut ends[cell as usize];
        *start -= 1;
        sorted[*start as usize] = *reference;
    }
    let starts = ends;
    let next = starts.iter().skip(1).copied().chain([refs.len() as u32]);
    let filled = starts.iter().zip(next).filter(|&(&first, next)| first < next);
    let cell = |(&first, next): (&u32, u32)| {
        let refs = &sorted[first as usize..next as usize];
        let bounds = refs.iter().fold(Aabb::EMPTY, |all, reference| all.union(&reference.bounds));
        GridCell { bounds, first, count: next - first }
    };
    let cells = filled.map(cell).collect();
    (sorted, cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_reference_larger_than_a_cell_is_alone() {
        let reference =
            |index: u32, min: Vec3, size: f32| PrimRef { index, bounds: Aabb { min, max: min + size } };
        let corner = |i: u32| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32);
        let small = (0..1000).map(|i| reference(i, corner(i), 0.1));
        let large = (1000..1003).map(|i| reference(i, Vec3::splat(0.1 * (i - 1000) as f32), 9.0));
        let refs: Vec<_> = small.chain(large).collect();
        let (sorted, cells) = sort_by_cell(&refs);
        let mut indices: Vec<_> = sorted.iter().map(|reference| reference.index).collect();
        indices.sort_unstable();
        assert!(indices.into_iter().eq(0..1003));
        assert_eq!(cells.iter().map(|cell| cell.count).sum::<u32>(), 1003);
        let (alone, others): (Vec<GridCell>, Vec<GridCell>) =
            cells.into_iter().partition(|cell| sorted[cell.first as usize].index >= 1000);
        assert_eq!(alone.iter().map(|cell| cell.count).collect::<Vec<_>>(), [1, 1, 1]);
        assert!(others.len() > 100 && others.iter().all(|cell| cell.bounds.extent().max_element() < 4.0));
    }
}
