//! The union of both structures: a coarse grid whose cells hold k-d trees.

use crate::decide::Shear;
use crate::grid::{Lattice, Walk};
use crate::kdtree::Builder;
use crate::{
    Aabb, Accel, Any, Closest, GeomError, GridOptions, Hit, KdOptions, KdTree, Probe, Ray, Search, Traverse,
    Triangles, UniformGrid,
};
use glam::DVec3;

/// A uniform grid of k-d trees.
///
/// The grid, coarse enough to cost little, takes the place of the trees' upper levels: those are
/// the most expensive to build, since every triangle is looked at on each of them.
#[derive(Clone, Debug)]
pub struct GridOfTrees {
    lattice: Lattice,
    /// The root of each cell's tree, [`NO_TREE`] for an empty cell.
    roots: Vec<u32>,
    /// All trees in one list of nodes.
    trees: KdTree,
}

/// The root of an empty cell.
const NO_TREE: u32 = u32::MAX;

/// How a [`GridOfTrees`] is built.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GridOfTreesOptions {
    /// How many triangles there are for each cell of the grid; finite and `> 0`.
    pub triangles_per_cell: f64,
    /// How the trees are built.
    pub tree: KdOptions,
}

impl Default for GridOfTreesOptions {
    fn default() -> Self {
        Self { triangles_per_cell: 64.0, tree: KdOptions::default() }
    }
}

impl GridOfTrees {
    /// Builds the grid and all trees.
    ///
    /// Memory is bounded beforehand, with `n` live triangles: the grid within the bounds of
    /// [`UniformGrid::build`], the trees together within those of a [`KdTree`] over the grid's
    /// references.
    ///
    /// # Errors
    /// [`GeomError::Param`] for an option out of its range.
    pub fn build(triangles: &Triangles, options: &GridOfTreesOptions) -> Result<Self, GeomError> {
        let GridOfTreesOptions { triangles_per_cell, ref tree } = *options;
        if !(triangles_per_cell.is_finite() && triangles_per_cell > 0.0) {
            let (name, range) = ("triangles_per_cell", "(0, inf)");
            return Err(GeomError::Param { name, value: triangles_per_cell, range });
        }
        let mut builder = Builder::new(triangles, tree)?;
        let mut grid_options = GridOptions::default();
        grid_options.density = 1.0 / triangles_per_cell;
        let grid = UniformGrid::build(triangles, &grid_options)?;
        let roots = grid.cells().map(|(cell, listed)| match listed {
            [] => NO_TREE,
            _ => builder.grow(
                &cell_bounds(&grid, cell, builder.slack()),
                listed.iter().copied(),
                8 * listed.len(),
            ),
        });
        let roots = roots.collect();
        Ok(Self { lattice: *grid.lattice(), roots, trees: builder.finish() })
    }

    /// Number of cells along each axis.
    pub fn resolution(&self) -> [u32; 3] {
        self.lattice.resolution
    }

    /// How many triangle references the leaves of all trees hold.
    pub fn reference_count(&self) -> usize {
        self.trees.reference_count()
    }
}

/// A box that holds all points that the grid may count to the cell.
fn cell_bounds(grid: &UniformGrid, cell: [u32; 3], slack: f64) -> Aabb {
    let lattice = grid.lattice();
    let corner = |index: [u32; 3]| {
        lattice.corner + DVec3::from([0, 1, 2].map(|axis| lattice.plane(axis, index[axis])))
    };
    let (low, high) = (corner(cell) - slack, corner(cell.map(|i| i + 1)) + slack);
    let (min, max) = (low.as_vec3().map(f32::next_down), high.as_vec3().map(f32::next_up));
    Aabb { min, max }.intersection(&grid.bounds())
}

impl Traverse for GridOfTrees {
    fn search<S: Search, P: Probe>(&self, ray: &Ray, mut search: S, probe: &mut P) -> S {
        let Some(shear) = Shear::new(ray) else { return search };
        let Some(walk) = Walk::new(&self.lattice, &self.bounds(), ray) else { return search };
        walk.for_each_cell(|cell, row| {
            probe.visit();
            let root = self.roots[self.lattice.flat(cell)];
            if root != NO_TREE {
                let span = walk.within_column(cell, row);
                self.trees.traverse(root, &shear, &walk.pruner, span, &mut search, probe);
            }
            search.t_end()
        });
        search
    }
}

impl Accel for GridOfTrees {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.search(ray, Closest::new(ray), &mut ()).hit()
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.search(ray, Any::new(ray), &mut ()).found()
    }

    fn bounds(&self) -> Aabb {
        self.trees.bounds()
    }

    fn bytes(&self) -> usize {
        self.trees.bytes() + size_of_val(&*self.roots)
    }
}
