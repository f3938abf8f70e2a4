use super::lattice::Lattice;
use crate::accel::by_query::accel_by_query;
use crate::{Accel, Traverse, Triangles};
use std::fmt;

/// A uniform grid: fast to build; suits triangles of similar size that are evenly distributed.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Accel, GridOptions, Ray, Triangle, Triangles, UniformGrid};
///
/// let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)])?;
/// let mut options = GridOptions::default();
/// options.resolution = Some([4, 4, 1]); // overrides `density`
/// let grid = UniformGrid::build_with(&triangles, &options)?;
/// assert!(grid.occluded(&Ray::new(DVec3::new(0.2, 0.2, 2.0), -DVec3::Z)));
/// # Ok::<(), globillum_geom::GeomError>(())
/// ```
#[derive(Clone)]
pub struct UniformGrid {
    pub(super) triangles: Triangles,
    pub(super) lattice: Lattice,
    /// The start of each cell's list in `references`, then the end of the last list.
    pub(super) starts: Vec<u32>,
    /// The triangle indices of all cells, ascending within each cell.
    pub(super) references: Vec<u32>,
}

impl UniformGrid {
    /// The number of cells along each axis, each at least 1.
    pub fn resolution(&self) -> [u32; 3] {
        self.lattice.resolution
    }

    /// The faces of all cells along `axis` (0 to 2), ascending, in rounded world-space coordinates: one more
    /// than there are cells along the axis.
    ///
    /// # Panics
    /// If `axis > 2`.
    pub fn planes(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        (0..=self.lattice.resolution[axis])
            .map(move |i| self.lattice.corner[axis] + self.lattice.plane(axis, i))
    }

    /// The triangle indices of the cell with the linear index `flat`, ascending.
    #[inline]
    pub(super) fn listed(&self, flat: usize) -> &[u32] {
        &self.references[self.starts[flat] as usize..self.starts[flat + 1] as usize]
    }

    /// The number of triangle references in all cells.
    pub fn reference_count(&self) -> usize {
        self.references.len()
    }
}

impl Accel for UniformGrid {
    accel_by_query!();

    fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.starts) + size_of_val(&*self.references)
    }
}

/// Counts, not the cells.
impl fmt::Debug for UniformGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("UniformGrid")
            .field("triangles", &self.triangles.len())
            .field("resolution", &self.resolution())
            .field("references", &self.reference_count())
            .field("bytes", &self.bytes())
            .finish_non_exhaustive()
    }
}
