//! 64 coherent rays, that is ones that take nearly the same way, searched for together.

use super::WideKdTree;
use super::candidates::{CAPACITY, Candidates};
use super::course::Courses;
use super::descent::Descent;
use super::frustum::Frustum;
use super::goal::Goal;
use super::scratch::WIDTH;
use super::simd::{LANES, Simd};
use super::slots::Slots;
use super::verdicts::{Shears, Verdicts};
use crate::Ray;

/// The rays of a packet come eight by eight.
pub(super) const GROUPS: usize = WIDTH / LANES;

/// What is known of the rays. Kept from packet to packet, so that its memory is.
#[derive(Debug)]
pub(super) struct Packet {
    pub(super) courses: [Courses<LANES>; GROUPS],
    /// What begins beyond this can not matter.
    pub(super) t_end: [[f32; LANES]; GROUPS],
    /// How far each ray goes along its main axis for each unit of its parameter.
    pub(super) rates: [[f32; LANES]; GROUPS],
    pub(super) candidates: [[Candidates; LANES]; GROUPS],
    verdicts: [Verdicts; CAPACITY],
    /// What is still to be visited, the nearest last.
    pub(super) cells: Vec<Cell>,
}

/// A cell of a node, in sight of the packet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub(super) child: u32,
    /// The node, and its lane, that has the cell's box.
    pub(super) node: u32,
    pub(super) lane: u32,
    /// Where the box begins along the main axis.
    pub(super) near: f32,
}

impl Packet {
    pub(super) fn idle() -> Self {
        Self {
            courses: [const { Courses::idle() }; GROUPS],
            t_end: [[0.0; LANES]; GROUPS],
            rates: [[0.0; LANES]; GROUPS],
            candidates: [[Candidates::default(); LANES]; GROUPS],
            verdicts: [Verdicts::NONE; CAPACITY],
            cells: Vec::new(),
        }
    }

    /// Searches for all rays and reports every search. If they are not coherent it does nothing, and
    /// returns false.
    #[inline(always)]
    pub(super) fn search<S: Simd, Q: Goal>(
        &mut self,
        simd: S,
        tree: &WideKdTree,
        rays: &[Ray; WIDTH],
        mut report: impl FnMut(usize, Q),
    ) -> bool {
        if !seem_coherent(rays) {
            return false;
        }
        let (groups, _) = rays.as_chunks::<LANES>();
        let live = self.set(simd, tree, groups);
        let Some(frustum) = Frustum::around(simd, self, live) else { return false };
        let main_axis = frustum.main_axis();
        let mut searches = [[Q::begin(&rays[0]); LANES]; GROUPS];
        for (searches, group) in searches.iter_mut().zip(groups) {
            for (search, ray) in searches.iter_mut().zip(group) {
                *search = Q::begin(ray);
            }
        }
        let packet = &mut *self;
        Descent { simd, tree, rays: groups, packet, frustum, live, searches: &mut searches }.run();
        for (g, group) in groups.iter().enumerate() {
            let (candidates, t_end) = (&self.candidates[g], &self.t_end[g]);
            let shears = Shears::of(main_axis, group);
            let turns = shears.decide(simd, candidates, t_end, &tree.triangles, &mut self.verdicts);
            for (i, mut search) in searches[g].into_iter().enumerate() {
                for verdicts in &self.verdicts[..turns] {
                    verdicts.offer(i, &mut search);
                }
                report(g * LANES + i, search);
            }
        }
        true
    }

    /// Makes the rays ready; returns those that may meet anything.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, tree: &WideKdTree, groups: &[[Ray; LANES]]) -> Slots {
        let mut live = 0;
        for (g, group) in groups.iter().enumerate() {
            let courses = &mut self.courses[g];
            courses.set(&simd.columns(group), &tree.triangles.bounds(), &tree.space);
            self.t_end[g] = courses.end;
            for i in 0..LANES {
                self.rates[g][i] = 1.0 / courses.depth_scale[i];
                self.candidates[g][i].clear();
                live |= Slots::from(courses.is_any[i]) << (g * LANES + i);
            }
        }
        live
    }
}

/// Smallest and largest of the numbers of the rays in `slots`.
#[inline(always)]
pub(super) fn range<S: Simd>(simd: S, numbers: &[S::F; GROUPS], slots: Slots) -> [f32; 2] {
    let (zero, nothing) = (simd.splat(0.0), simd.splat(f32::INFINITY));
    let (mut low, mut minus_high) = (nothing, nothing);
    for (g, &x) in numbers.iter().enumerate() {
        let group = (slots >> (g * LANES)) as u8;
        low = simd.min(low, simd.select(group, x, nothing));
        minus_high = simd.min(minus_high, simd.select(group, simd.sub(zero, x), nothing));
    }
    [simd.min_of(low, 0xff), -simd.min_of(minus_high, 0xff)]
}

/// Whether a few of the rays say nothing to the contrary.
#[inline(always)]
fn seem_coherent(rays: &[Ray; WIDTH]) -> bool {
    let first = rays[0].direction;
    for i in [WIDTH / 3, 2 * WIDTH / 3, WIDTH - 1] {
        let other = rays[i].direction;
        let dot = first.dot(other);
        if !(dot > 0.0 && dot * dot > 0.99 * (first.length_squared() * other.length_squared())) {
            return false;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::super::simd::Portable;
    use super::*;
    use crate::conformance::shapes::icosphere;
    use crate::search::Closest;
    use crate::{Accel, Triangles};
    use glam::DVec3;

    /// A square of eight by eight pixels that many radians wide, seen from outside.
    fn camera(width: f64) -> [Ray; WIDTH] {
        std::array::from_fn(|i| {
            let (x, y) = ((i % 8) as f64 / 7.0 - 0.4, (i / 8) as f64 / 7.0 - 0.6);
            Ray::new(DVec3::new(0.1, 0.2, 3.0), DVec3::new(width * x, width * y, -1.0))
        })
    }

    #[test]
    fn rays_through_neighbouring_pixels_are_coherent_and_others_are_not() {
        let tree = WideKdTree::build(&Triangles::new(icosphere(3).triangles()).unwrap()).unwrap();
        for (width, expected) in [(1e-9, true), (0.01, true), (0.03, true), (0.5, false), (3.0, false)] {
            let rays = camera(width);
            let (mut reported, mut hits) = ([0; WIDTH], [None; WIDTH]);
            let report = |i, search: Closest| {
                reported[i] += 1;
                hits[i] = search.hit();
            };
            let coherent = Packet::idle().search(Portable, &tree, &rays, report);
            assert_eq!(coherent, expected, "{width}");
            assert_eq!(reported, [usize::from(coherent); WIDTH]);
            if coherent {
                assert_eq!(hits, rays.map(|ray| tree.intersect(&ray)));
                assert!(hits.iter().all(Option::is_some));
            }
        }
    }
}
