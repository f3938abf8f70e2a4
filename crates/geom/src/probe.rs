//! What a query costs, counted with one meaning in every structure.

use crate::{Accel, Hit, Ray};
use std::collections::HashSet;
use std::ops::AddAssign;

/// Watches a query. The no-op `()` compiles to nothing.
pub trait Probe {
    /// An inner node of a tree, or a cell of a grid, was visited.
    #[inline]
    fn visit(&mut self) {}
    /// A list of triangles was opened: a leaf or a cell that holds at least one.
    #[inline]
    fn open(&mut self) {}
    /// The triangle of that index was tested: decided, or found out of question.
    #[inline]
    fn test(&mut self, _triangle: u32) {}
}

impl Probe for () {}

/// An accelerator whose queries can be watched. The same traversal answers [`Accel`]'s queries for
/// single rays.
pub trait Traverse: Accel {
    /// [`Accel::intersect`], telling `probe` what is done for it.
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit>;

    /// [`Accel::occluded`], telling `probe` what is done for it.
    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool;
}

/// What queries cost, in all.
///
/// ```
/// use glam::{DVec3, Vec3};
/// use globillum_geom::{BruteForce, Counts, Ray, Triangle, Triangles};
///
/// let triangles = Triangles::new(vec![Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y); 3])?;
/// let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z);
/// let (hit, counts) = Counts::closest(&BruteForce::build(&triangles), &ray);
/// assert_eq!((hit.map(|hit| hit.triangle), counts.tests), (Some(0), 3));
/// # Ok::<(), globillum_geom::GeomError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Queries.
    pub rays: u64,
    /// Queries that found a hit.
    pub hits: u64,
    /// Inner nodes and cells visited.
    pub visits: u64,
    /// Lists opened: leaves and cells that hold triangles.
    pub opened: u64,
    /// Triangles tested, repetitions included.
    pub tests: u64,
    /// Tests of a triangle that the same query had tested before, in another leaf or cell.
    pub repeats: u64,
}

impl Counts {
    /// Finds the closest hit as [`Accel::intersect`] does, and counts what it takes.
    pub fn closest(accel: &impl Traverse, ray: &Ray) -> (Option<Hit>, Self) {
        let mut watch = Watch::default();
        let hit = accel.closest(ray, &mut watch);
        (hit, watch.counts(hit.is_some()))
    }

    /// Finds out whether anything is hit as [`Accel::occluded`] does, and counts what it takes.
    pub fn any(accel: &impl Traverse, ray: &Ray) -> (bool, Self) {
        let mut watch = Watch::default();
        let found = accel.any(ray, &mut watch);
        (found, watch.counts(found))
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.visits += other.visits;
        self.opened += other.opened;
        self.tests += other.tests;
        self.repeats += other.repeats;
    }
}

/// Watches one query.
#[derive(Default)]
struct Watch {
    visits: u64,
    opened: u64,
    tests: u64,
    tested: HashSet<u32>,
}

impl Watch {
    fn counts(self, hit: bool) -> Counts {
        let Self { visits, opened, tests, tested } = self;
        let repeats = tests - tested.len() as u64;
        Counts { rays: 1, hits: u64::from(hit), visits, opened, tests, repeats }
    }
}

impl Probe for Watch {
    fn visit(&mut self) {
        self.visits += 1;
    }
    fn open(&mut self) {
        self.opened += 1;
    }
    fn test(&mut self, triangle: u32) {
        self.tests += 1;
        self.tested.insert(triangle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BruteForce, GridOptions, KdOptions, KdTree, SplitRule, Triangle, Triangles, UniformGrid};
    use glam::{DVec3, Vec3};

    /// Two triangles apart, and one that reaches across both cells between them.
    fn scene() -> Triangles {
        let small = |x: f32| Triangle::new(Vec3::X * x, Vec3::X * (x + 1.0), Vec3::new(x, 1.0, 0.0));
        let long = Triangle::new(Vec3::Z, Vec3::new(11.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 1.0));
        Triangles::new(vec![small(0.0), small(10.0), long]).unwrap()
    }

    #[test]
    fn every_structure_counts_alike() {
        let triangles = scene();
        // Past all three, so that every list along the way is opened.
        let ray = Ray::new(DVec3::new(-1.0, 0.9, 0.5), DVec3::X);
        let brute = Counts::closest(&BruteForce::build(&triangles), &ray);
        assert_eq!(brute, (None, Counts { rays: 1, tests: 3, ..Counts::default() }));

        let halved = KdOptions {
            rule: SplitRule::Midpoint,
            traversal_cost: 0.0,
            max_depth: 1,
            leaf_size: 0,
            ..KdOptions::default()
        };
        let (hit, kd) = Counts::closest(&KdTree::build(&triangles, &halved).unwrap(), &ray);
        let expected = Counts { rays: 1, hits: 0, visits: 1, opened: 2, tests: 4, repeats: 1 };
        assert_eq!((hit, kd), (None, expected));

        // Two cells, and a mailbox for what both list.
        let two_cells = GridOptions { resolution: Some([2, 1, 1]), ..GridOptions::default() };
        let (hit, grid) = Counts::closest(&UniformGrid::build(&triangles, &two_cells).unwrap(), &ray);
        assert_eq!((hit, grid), (None, Counts { visits: 2, tests: 3, repeats: 0, ..expected }));
        assert_eq!(Counts::any(&UniformGrid::build(&triangles, &two_cells).unwrap(), &ray).1, grid);
    }
}
