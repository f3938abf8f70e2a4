use super::lattice::Lattice;
use crate::{Aabb, Accel, Hit, Ray, Traverse, Triangles};

/// A uniform grid: quick to build, and good where triangles are of one size and evenly spread.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{Accel, GridOptions, Ray, Triangle, Triangles, UniformGrid};
///
/// let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y)])?;
/// let mut options = GridOptions::default();
/// options.resolution = Some([4, 4, 1]); // instead of one that follows from the number of triangles
/// let grid = UniformGrid::build(&triangles, &options)?;
/// assert!(grid.occluded(&Ray::new(DVec3::new(0.2, 0.2, 2.0), -DVec3::Z)));
/// # Ok::<(), globillum_geom::GeomError>(())
/// ```
#[derive(Clone, Debug)]
pub struct UniformGrid {
    pub(super) triangles: Triangles,
    pub(super) lattice: Lattice,
    /// Where each cell's list starts in `references`, and one entry more.
    pub(super) starts: Vec<u32>,
    /// Triangle indices of all cells, ascending within each.
    pub(super) references: Vec<u32>,
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

    /// The triangles that a cell lists, ascending.
    #[inline]
    pub(super) fn listed(&self, flat: usize) -> &[u32] {
        &self.references[self.starts[flat] as usize..self.starts[flat + 1] as usize]
    }

    /// How many triangle references the cells hold.
    pub fn reference_count(&self) -> usize {
        self.references.len()
    }
}

impl Accel for UniformGrid {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.closest(ray, &mut ())
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.any(ray, &mut ())
    }

    fn bounds(&self) -> Aabb {
        self.triangles.bounds()
    }

    fn bytes(&self) -> usize {
        self.triangles.bytes() + size_of_val(&*self.starts) + size_of_val(&*self.references)
    }
}
