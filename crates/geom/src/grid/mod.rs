//! A uniform grid over triangles: equal cells, each listing the triangles whose boxes touch it.

mod build;
mod traverse;

pub use build::GridOptions;

use crate::{Aabb, Accel, Any, Closest, Hit, Ray, Triangles};
use glam::DVec3;

/// A uniform grid.
#[derive(Clone, Debug)]
pub struct UniformGrid {
    triangles: Triangles,
    lattice: Lattice,
    /// Where each cell's list starts in `references`, and one entry more.
    starts: Vec<u32>,
    /// Triangle indices of all cells, ascending within each.
    references: Vec<u32>,
}

/// The cells' geometry, in coordinates relative to the scene's lower corner.
#[derive(Clone, Copy, Debug)]
struct Lattice {
    corner: DVec3,
    resolution: [u32; 3],
    cell_size: DVec3,
    cells_per_length: DVec3,
}

impl Lattice {
    fn new(bounds: &Aabb, resolution: [u32; 3]) -> Self {
        let cells = DVec3::from(resolution.map(f64::from));
        let cell_size = bounds.extent() / cells;
        // A flat axis has one cell of no size, which every coordinate falls into.
        let per_length = |size: f64| if size > 0.0 { 1.0 / size } else { 0.0 };
        Self {
            corner: bounds.min.as_dvec3(),
            resolution,
            cell_size,
            cells_per_length: cell_size.map(per_length),
        }
    }

    /// The relative coordinate of the plane below cell `index`.
    #[inline]
    fn plane(&self, axis: usize, index: u32) -> f64 {
        f64::from(index) * self.cell_size[axis]
    }

    /// A cell whose closed slab holds the relative coordinate, up to rounding; the nearest one
    /// for a coordinate outside.
    #[inline]
    fn index(&self, axis: usize, coordinate: f64) -> u32 {
        // The cast saturates, so a coordinate far outside is the first or last cell.
        let index = (coordinate * self.cells_per_length[axis]) as u32;
        index.min(self.resolution[axis] - 1)
    }

    #[inline]
    fn flat(&self, [x, y, z]: [u32; 3]) -> usize {
        let [rx, ry, _] = self.resolution.map(|r| r as usize);
        (z as usize * ry + y as usize) * rx + x as usize
    }
}

impl UniformGrid {
    /// Number of cells along each axis.
    pub fn resolution(&self) -> [u32; 3] {
        self.lattice.resolution
    }

    /// Every plane between cells along `axis`, in world coordinates, rounded.
    pub fn planes(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        (0..=self.lattice.resolution[axis])
            .map(move |i| self.lattice.corner[axis] + self.lattice.plane(axis, i))
    }

    /// How many triangle references the cells hold.
    pub fn reference_count(&self) -> usize {
        self.references.len()
    }
}

impl Accel for UniformGrid {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.search(ray, Closest::new(ray), &mut ()).hit()
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.search(ray, Any::new(ray), &mut ()).found()
    }

    fn bounds(&self) -> Aabb {
        self.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.starts) + size_of_val(&*self.references)
    }
}
