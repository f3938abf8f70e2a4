//! 64 coherent rays from one point, as a pinhole camera sends out, searched for together.
//!
//! What follows from the point alone is computed once. A ray is then two numbers, how far its slopes are
//! from a middle ray's: a box is a [window](window) of these numbers, an edge function of a triangle is
//! linear in them ([`facets`]), and how far along is measured along the main axis, for all alike.

mod descent;
mod facets;
mod focus;
mod lines;
mod view;
mod window;

use super::WideKdTree;
use super::candidates::{CAPACITY, Candidates};
use super::goal::Goal;
use super::packet::GROUPS;
use super::scratch::WIDTH;
use super::simd::{LANES, Simd};
use super::slots::Slots;
use super::verdicts::Verdicts;
use crate::Ray;
use descent::{Descent, Found};
use lines::Lines;
use std::marker::PhantomData;
use view::View;
use window::Cell;

/// What is known of the rays. Kept from one set of rays to the next, so that its memory is.
#[derive(Debug)]
pub(super) struct Pencil {
    lines: Lines,
    candidates: [[Candidates; LANES]; GROUPS],
    found: [Found; WIDTH],
    verdicts: [Verdicts; CAPACITY],
    /// What is still to be visited, the nearest last.
    cells: Vec<Cell>,
}

impl Pencil {
    pub(super) fn idle() -> Self {
        Self {
            lines: Lines::idle(),
            candidates: [[Candidates::default(); LANES]; GROUPS],
            found: [Found::NOTHING; WIDTH],
            verdicts: [Verdicts::NONE; CAPACITY],
            cells: Vec::new(),
        }
    }

    /// Searches for all rays and reports every search. If they are not coherent, or not from one point, it
    /// does nothing and returns false.
    #[inline(always)]
    pub(super) fn search<S: Simd, Q: Goal>(
        &mut self,
        simd: S,
        tree: &WideKdTree,
        rays: &[Ray; WIDTH],
        mut report: impl FnMut(usize, Q),
    ) -> bool {
        let (groups, _) = rays.as_chunks::<LANES>();
        let Some(mut view) = View::new(rays, &tree.space) else { return false };
        if tree.triangles.bounds().is_empty() || !self.lines.set(simd, &mut view, groups) {
            return false;
        }
        for candidates in self.candidates.as_flattened_mut() {
            candidates.clear();
        }
        let (pencil, end, sure, goal) = (&mut *self, f32::INFINITY, 0, PhantomData::<Q>);
        let mut descent = Descent { simd, tree, rays: groups, view, pencil, end, sure, goal };
        descent.run();
        let sure = descent.sure;
        let Self { lines, candidates, verdicts, .. } = self;
        for (g, group) in groups.iter().enumerate() {
            let turns =
                lines.shears[g].decide(simd, &candidates[g], &lines.end[g], &tree.triangles, verdicts);
            for (i, ray) in group.iter().enumerate() {
                let mut search = Q::begin(ray);
                for verdicts in &verdicts[..turns] {
                    verdicts.offer(i, &mut search);
                }
                let slot = g * LANES + i;
                report(slot, if is_in(sure, slot) { search.sure() } else { search });
            }
        }
        true
    }
}

/// Whether a set of rays has this one.
#[inline(always)]
fn is_in(slots: Slots, slot: usize) -> bool {
    slots >> slot & 1 != 0
}

#[cfg(test)]
mod tests {
    use super::super::simd::Portable;
    use super::*;
    use crate::conformance::shapes::icosphere;
    use crate::conformance::{Seeded, Source};
    use crate::search::Closest;
    use crate::{Accel, Triangles};
    use glam::DVec3;

    /// Rays from one point, up to 30 from a scene that is 2 wide, around a ray through it, up to a tenth apart.
    pub(super) fn pencil(source: &mut Seeded) -> [Ray; WIDTH] {
        let mut vector = || DVec3::new(source.signed(), source.signed(), source.signed());
        let (place, at) = (vector(), vector());
        let origin = place * 30.0_f64.powf(1.4 * source.unit() - 0.4);
        let direction = at - origin;
        let main_axis = crate::decide::main_axis(direction);
        // Not too near to where another axis is the main one.
        let direction = DVec3::from_array(
            [0, 1, 2].map(|axis| if axis == main_axis { direction[axis] } else { 0.85 * direction[axis] }),
        );
        let spread = direction[main_axis].abs() * 10.0_f64.powf(-1.25 - 5.0 * source.unit());
        std::array::from_fn(|_| {
            let mut aside = DVec3::new(source.signed(), source.signed(), source.signed());
            aside[main_axis] = 0.0;
            Ray::new(origin, direction + spread * aside)
        })
    }

    #[test]
    fn rays_from_one_point_find_what_each_finds_alone() {
        let tree = WideKdTree::build(&Triangles::new(icosphere(3).triangles()).unwrap()).unwrap();
        let (mut source, mut pencil_memory, mut hits) = (Seeded::new(5), Pencil::idle(), 0);
        for _ in 0..500 {
            let mut rays = pencil(&mut source);
            for ray in &mut rays {
                ray.t_min = (source.signed() * 0.4).max(0.0);
                ray.t_max = if source.below(2) == 0 { f64::INFINITY } else { ray.t_min + source.unit() };
            }
            let (mut reported, mut found) = ([0; WIDTH], [None; WIDTH]);
            let is_pencil = pencil_memory.search(Portable, &tree, &rays, |i, search: Closest| {
                reported[i] += 1;
                found[i] = search.hit();
            });
            assert!(is_pencil);
            assert_eq!(reported, [1; WIDTH]);
            assert_eq!(found, rays.map(|ray| tree.intersect(&ray)));
            hits += found.iter().flatten().count();
        }
        assert!(hits > 1000, "{hits}");
    }

    #[test]
    fn what_is_no_pencil_is_left_alone() {
        let tree = WideKdTree::build(&Triangles::new(icosphere(2).triangles()).unwrap()).unwrap();
        let mut source = Seeded::new(6);
        let is_pencil =
            |rays: &[Ray; WIDTH]| Pencil::idle().search(Portable, &tree, rays, |_, _: Closest| {});
        let rays = pencil(&mut source);
        assert!(is_pencil(&rays));
        let spoil: [fn(&mut Ray); 10] = [
            |ray| ray.origin.x = ray.origin.x.next_up(),
            |ray| ray.origin.y = ray.origin.y.next_up(),
            |ray| ray.origin.z = ray.origin.z.next_up(),
            |ray| ray.direction = -ray.direction,
            |ray| ray.direction = DVec3::new(ray.direction.y, ray.direction.z, ray.direction.x),
            |ray| ray.direction.y = f64::NAN,
            |ray| ray.t_min = -1.0,
            |ray| ray.t_min = f64::NAN,
            |ray| ray.t_max = 0.0,
            |ray| ray.direction *= 2.0_f64.powi(700),
        ];
        for spoil in spoil {
            for i in [0, 17, WIDTH - 1] {
                let mut rays = rays;
                spoil(&mut rays[i]);
                assert!(!is_pencil(&rays), "{:?}", rays[i]);
            }
            let from_afar = rays.map(|ray| Ray { origin: ray.origin - 1000.0 * ray.direction, ..ray });
            assert!(!is_pencil(&from_afar));
        }
    }
}
