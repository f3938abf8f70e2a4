use crate::{Aabb, Triangle};
use glam::DVec3;
use std::ops::RangeInclusive;

/// The geometry of the cells, in coordinates relative to the lower corner of the scene's bounds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    pub(super) corner: DVec3,
    pub(super) resolution: [u32; 3],
    cell_size: DVec3,
    cells_per_length: DVec3,
}

impl Lattice {
    /// The lattice over `bounds` with `resolution` cells along each axis.
    pub(super) fn new(bounds: &Aabb, resolution: [u32; 3]) -> Self {
        let cells = DVec3::from(resolution.map(f64::from));
        let cell_size = bounds.extent() / cells;
        // A flat axis has one cell of size zero, to which every coordinate maps.
        let per_length = |size: f64| if size > 0.0 { 1.0 / size } else { 0.0 };
        Self {
            corner: bounds.min.as_dvec3(),
            resolution,
            cell_size,
            cells_per_length: cell_size.map(per_length),
        }
    }

    /// The relative coordinate of the lower face of cell `index`.
    #[inline]
    pub(super) fn plane(&self, axis: usize, index: u32) -> f64 {
        f64::from(index) * self.cell_size[axis]
    }

    /// A cell along `axis` that contains the relative coordinate, up to rounding; the nearest cell for a
    /// coordinate outside.
    #[inline]
    pub(super) fn index(&self, axis: usize, coordinate: f64) -> u32 {
        // The cast saturates.
        let index = (coordinate * self.cells_per_length[axis]) as u32;
        index.min(self.resolution[axis] - 1)
    }

    /// The linear index of a cell.
    #[inline]
    pub(super) fn flat(&self, [x, y, z]: [u32; 3]) -> usize {
        let [rx, ry, _] = self.resolution.map(|r| r as usize);
        (z as usize * ry + y as usize) * rx + x as usize
    }

    /// The cells along `axis` that the triangle's bounds overlap.
    ///
    /// [`Lattice::index`] is monotone, so the cell of every point of the triangle is among them.
    fn span_of(&self, triangle: &Triangle, axis: usize) -> RangeInclusive<u32> {
        let bounds = triangle.bounds();
        let cell = |x: f32| self.index(axis, f64::from(x) - self.corner[axis]);
        cell(bounds.min[axis])..=cell(bounds.max[axis])
    }

    /// The number of cells that the triangle's bounds overlap.
    pub(super) fn cells_of(&self, triangle: &Triangle) -> u64 {
        let cells = |axis| u64::from(self.span_of(triangle, axis).count() as u32);
        cells(0) * cells(1) * cells(2)
    }

    /// Calls `visit` with the linear index of each cell that the triangle's bounds overlap.
    pub(super) fn for_each_cell(&self, triangle: &Triangle, mut visit: impl FnMut(usize)) {
        let [xs, ys, zs] = [0, 1, 2].map(|axis| self.span_of(triangle, axis));
        for z in zs {
            for y in ys.clone() {
                for x in xs.clone() {
                    visit(self.flat([x, y, z]));
                }
            }
        }
    }
}
