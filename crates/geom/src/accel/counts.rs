//! Counts of the work of a query, with the same definitions for every accelerator.

use crate::{Accel, Hit, Ray};
use std::collections::HashSet;
use std::ops::AddAssign;

/// Receives the events of a query. The counter `()` ignores them and compiles to nothing.
pub trait QueryCounter {
    /// Called for each inner node of a tree, or each cell of a grid, that is visited.
    #[inline]
    fn visit(&mut self) {}
    /// Called for each leaf or grid cell that is visited and has at least one triangle.
    #[inline]
    fn open(&mut self) {}
    /// Called for each test of a triangle, given its index: an exact decision, or a rejection by a prefilter. Triangles
    /// that the ray excludes count as tested.
    #[inline]
    fn test(&mut self, _triangle: u32) {}
}

impl QueryCounter for () {}

/// An accelerator whose single-ray queries report to a [`QueryCounter`].
///
/// The same traversal answers the single-ray queries of [`Accel`].
pub trait Traverse: Accel {
    /// [`Accel::intersect`], reporting to `counter`.
    fn closest<C: QueryCounter>(&self, ray: &Ray, counter: &mut C) -> Option<Hit>;

    /// [`Accel::occluded`], reporting to `counter`.
    fn any<C: QueryCounter>(&self, ray: &Ray, counter: &mut C) -> bool;
}

/// The work of one query, or the sum over several.
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
    /// Number of queries.
    pub rays: u64,
    /// Queries with a hit.
    pub hits: u64,
    /// Inner nodes of trees and cells of grids visited.
    pub visits: u64,
    /// Leaves and cells visited that have at least one triangle.
    pub opened: u64,
    /// Triangle tests, including repeated ones.
    pub tests: u64,
    /// Tests of a triangle that the same query has already tested in another leaf or cell.
    pub repeats: u64,
}

impl Counts {
    /// The result of [`Accel::intersect`], and the work of this query.
    pub fn closest(accel: &impl Traverse, ray: &Ray) -> (Option<Hit>, Self) {
        let mut watch = Watch::default();
        let hit = accel.closest(ray, &mut watch);
        (hit, watch.counts(hit.is_some()))
    }

    /// The result of [`Accel::occluded`], and the work of this query.
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

/// Counts the work of one query.
#[derive(Default)]
struct Watch {
    counts: Counts,
    tested: HashSet<u32>,
}

impl Watch {
    fn counts(self, hit: bool) -> Counts {
        Counts { rays: 1, hits: u64::from(hit), ..self.counts }
    }
}

impl QueryCounter for Watch {
    fn visit(&mut self) {
        self.counts.visits += 1;
    }
    fn open(&mut self) {
        self.counts.opened += 1;
    }
    fn test(&mut self, triangle: u32) {
        self.counts.tests += 1;
        self.counts.repeats += u64::from(!self.tested.insert(triangle));
    }
}
