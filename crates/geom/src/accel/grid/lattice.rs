use crate::{Aabb, Triangle};
use glam::{DVec3, Vec3};
use std::ops::RangeInclusive;

/// The largest number of cells.
pub(super) const MAX_CELLS: u64 = 1 << 27;

/// The geometry of the cells, in coordinates relative to the lower corner of the scene's bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
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

    /// The lattice with nearly cubic cells over `bounds`, about `density` for each of `count` triangles.
    pub(crate) fn with_density(bounds: &Aabb, count: usize, density: f64) -> Self {
        Self::new(bounds, resolution_for(bounds, count, density))
    }

    /// The longest edge of a cell.
    pub(crate) fn longest_edge(&self) -> f64 {
        self.cell_size.max_element()
    }

    /// The number of cells.
    pub(crate) fn cell_count(&self) -> usize {
        self.resolution.map(|r| r as usize).into_iter().product()
    }

    /// The linear index of the cell that contains a point, up to rounding; of the nearest one for a point outside.
    pub(crate) fn cell_of(&self, point: Vec3) -> usize {
        self.flat([0, 1, 2].map(|axis| self.index(axis, f64::from(point[axis]) - self.corner[axis])))
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

/// The resolution with nearly cubic cells, `density` for each of `count` triangles.
pub(super) fn resolution_for(bounds: &Aabb, count: usize, density: f64) -> [u32; 3] {
    let most = (8 * count as u64 + 64).min(MAX_CELLS) as f64;
    let mut left = (density * count as f64).clamp(1.0, most);
    // Shortest axes first: an axis too short for two cells leaves its share to the others.
    let extent = bounds.extent();
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| extent[a].total_cmp(&extent[b]));
    let mut resolution = [1; 3];
    for (done, &axis) in axes.iter().enumerate() {
        let remaining = &axes[done..];
        let longest = extent[axes[2]];
        if longest <= 0.0 {
            break;
        }
        // Extents relative to the longest axis prevent overflow at any scale.
        let volume: f64 = remaining.iter().map(|&a| extent[a] / longest).product();
        let cells_per_extent = libm::pow(left / volume, 1.0 / remaining.len() as f64);
        let cells = (extent[axis] / longest * cells_per_extent).clamp(1.0, left.max(1.0));
        resolution[axis] = if cells.is_finite() { cells as u32 } else { 1 };
        left /= f64::from(resolution[axis]);
    }
    resolution
}
