use super::lattice::{Lattice, MAX_CELLS, resolution_for};
use super::uniform::UniformGrid;
use crate::{Aabb, GeomError, Triangles};

/// Options for building a [`UniformGrid`].
///
/// Made by `default` and then changed, since fields may be added:
///
/// ```
/// let mut options = globillum_geom::GridOptions::default();
/// options.density = 4.0;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GridOptions {
    /// The number of cells per live triangle if `resolution` is `None`; finite and `> 0`. The default, 2,
    /// is measured (docs/accelerators.md).
    pub density: f64,
    /// The number of cells along each axis, each at least 1; `None` derives it from `density`. An axis along
    /// which the scene is flat always has one cell.
    pub resolution: Option<[u32; 3]>,
}

impl Default for GridOptions {
    fn default() -> Self {
        Self { density: 2.0, resolution: None }
    }
}

impl UniformGrid {
    /// [`UniformGrid::build_with`] default options.
    ///
    /// # Errors
    /// None; the result has the type that all builders share.
    pub fn build(triangles: &Triangles) -> Result<Self, GeomError> {
        Self::build_with(triangles, &GridOptions::default())
    }

    /// Builds the grid.
    ///
    /// Over `n` live triangles there are at most `2^27` cells, without a given resolution at most `8 n + 64`,
    /// and at most `16 n + 1024` references. Each takes four bytes, and building needs no memory beyond its
    /// result. A resolution derived from the density is halved until the references are within the budget.
    ///
    /// # Errors
    /// [`GeomError::Param`] for an option out of its range; [`GeomError::Budget`] for a given resolution with
    /// more than `2^27` cells or too many references, before anything is allocated.
    pub fn build_with(triangles: &Triangles, options: &GridOptions) -> Result<Self, GeomError> {
        let lattice = choose_lattice(triangles, options)?;
        let live = triangles.live();
        let mut starts = vec![0_u32; lattice.cell_count() + 1];
        for &index in live {
            lattice.for_each_cell(triangles.get(index), |cell| starts[cell] += 1);
        }
        // `starts` holds the ends of the lists; filling each list from its end turns them into starts.
        let mut end = 0;
        for start in &mut starts {
            end += *start;
            *start = end;
        }
        let mut references = vec![0; end as usize];
        for &index in live.iter().rev() {
            lattice.for_each_cell(triangles.get(index), |cell| {
                starts[cell] -= 1;
                references[starts[cell] as usize] = index;
            });
        }
        Ok(Self { triangles: triangles.clone(), lattice, starts, references })
    }
}

fn choose_lattice(triangles: &Triangles, options: &GridOptions) -> Result<Lattice, GeomError> {
    let density = options.density;
    if !(density.is_finite() && density > 0.0) {
        return Err(GeomError::Param { name: "density", value: density, range: "(0, inf)" });
    }
    let bounds = triangles.bounds();
    let count = triangles.live().len();
    let reference_budget = (16 * count as u64 + 1024).min(u64::from(u32::MAX));
    let mut resolution = match options.resolution {
        Some(given) => check_resolution(given, &bounds)?,
        None => resolution_for(&bounds, count, options.density),
    };
    loop {
        let lattice = Lattice::new(&bounds, resolution);
        let live = triangles.live().iter();
        let requested: u64 = live.map(|&i| lattice.cells_of(triangles.get(i))).sum();
        if requested <= reference_budget {
            return Ok(lattice);
        }
        if options.resolution.is_some() {
            let what = "grid references";
            return Err(GeomError::Budget { what, requested, budget: reference_budget });
        }
        resolution = resolution.map(|r| r.div_ceil(2));
    }
}

/// The given resolution, validated, with one cell along flat axes.
fn check_resolution(given: [u32; 3], bounds: &Aabb) -> Result<[u32; 3], GeomError> {
    if given.contains(&0) {
        return Err(GeomError::Param { name: "resolution", value: 0.0, range: "[1, 2^27]" });
    }
    // In floating point: the product of three `u32` can overflow `u64`.
    let requested = given.map(f64::from).into_iter().product::<f64>();
    if requested > MAX_CELLS as f64 {
        return Err(GeomError::Budget { what: "grid cells", requested: requested as u64, budget: MAX_CELLS });
    }
    let extent = bounds.extent();
    Ok([0, 1, 2].map(|axis| if extent[axis] > 0.0 { given[axis] } else { 1 }))
}
