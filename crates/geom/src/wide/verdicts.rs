//! Decisions for eight rays with one main axis, side by side.

use super::candidates::Candidates;
use super::course::AXES;
use super::simd::{LANES, Simd};
use crate::decide::{Intersection, Shear, permute};
use crate::search::Search;
use crate::{Ray, Triangles};
use glam::DVec3;

/// Vectors of eight rays, component by component.
type Columns = [[f64; LANES]; 3];

#[inline(always)]
fn set(columns: &mut Columns, lane: usize, v: DVec3) {
    for (column, x) in columns.iter_mut().zip([v.x, v.y, v.z]) {
        column[lane] = x;
    }
}

#[inline(always)]
fn get(columns: &Columns, lane: usize) -> DVec3 {
    DVec3::new(columns[0][lane], columns[1][lane], columns[2][lane])
}

/// The [`Shear`]s of eight rays, number by number. Components are in its order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shears {
    pub(super) main_axis: usize,
    pub(super) origin: Columns,
    /// What the directions go along x and y for each unit along z.
    pub(super) slopes: [[f64; LANES]; 2],
    pub(super) direction_z: [f64; LANES],
}

/// What was decided about one triangle for each of eight rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Verdicts {
    t: [f64; LANES],
    u: [f64; LANES],
    v: [f64; LANES],
    indices: [u32; LANES],
    is_met: [bool; LANES],
}

impl Shears {
    pub(super) const NONE: Self = {
        let zero = [0.0; LANES];
        Self { main_axis: 0, origin: [zero; 3], slopes: [zero; 2], direction_z: zero }
    };

    /// Those of rays that have the main axis `main_axis`, all of them.
    #[inline(always)]
    pub(super) fn of(main_axis: usize, rays: &[Ray; LANES]) -> Self {
        let (mut origin, mut direction) = ([[0.0; LANES]; 3], [[1.0; LANES]; 3]);
        for (i, ray) in rays.iter().enumerate() {
            set(&mut origin, i, permute(ray.origin, main_axis));
            set(&mut direction, i, permute(ray.direction, main_axis));
        }
        let [x, y, direction_z] = direction;
        let mut slopes = [x, y];
        for slopes in &mut slopes {
            for i in 0..LANES {
                slopes[i] /= direction_z[i];
            }
        }
        Self { main_axis, origin, slopes, direction_z }
    }

    /// Decides for each ray about its candidates that may be hit before `t_end`, and returns how many verdicts
    /// there are for each.
    #[inline(always)]
    pub(super) fn decide<S: Simd>(
        &self,
        simd: S,
        candidates: &[Candidates; LANES],
        t_end: &[f32; LANES],
        triangles: &Triangles,
        verdicts: &mut [Verdicts],
    ) -> usize {
        let most = candidates.iter().map(Candidates::count).max().unwrap_or(0);
        let turns = most.min(verdicts.len());
        for (turn, verdicts) in verdicts.iter_mut().take(turns).enumerate() {
            self.decide_one(simd, turn, candidates, t_end, triangles, verdicts);
        }
        turns
    }

    #[inline(always)]
    fn decide_one<S: Simd>(
        &self,
        simd: S,
        turn: usize,
        candidates: &[Candidates; LANES],
        t_end: &[f32; LANES],
        triangles: &Triangles,
        verdicts: &mut Verdicts,
    ) {
        let mut asked = [triangles.get(0); LANES];
        let mut is_asked = [false; LANES];
        for (i, is_asked) in is_asked.iter_mut().enumerate() {
            let index = candidates[i].get(turn, t_end[i]);
            *is_asked = index.is_some();
            // Where none is asked about, any will do.
            verdicts.indices[i] = index.unwrap_or(0);
            asked[i] = triangles.get(verdicts.indices[i]);
        }
        let corners = simd.corners(asked);
        let axes = AXES[self.main_axis % 3];
        let mut permuted = [[[0.0; LANES]; 3]; 3];
        for (permuted, vertices) in permuted.iter_mut().zip(corners.as_chunks::<3>().0) {
            for (to, axis) in permuted.iter_mut().zip(axes) {
                for (to, x) in to.iter_mut().zip(&vertices[usize::from(axis) % 3]) {
                    *to = f64::from(*x);
                }
            }
        }
        for i in 0..LANES {
            let slopes = [self.slopes[0][i], self.slopes[1][i]];
            let shear = Shear::of_slopes(self.main_axis, get(&self.origin, i), slopes, self.direction_z[i]);
            let [a, b, c] = &permuted;
            let (at, is_met) = shear.decide_permuted([get(a, i), get(b, i), get(c, i)]);
            (verdicts.t[i], verdicts.u[i], verdicts.v[i]) = (at.t, at.u, at.v);
            verdicts.is_met[i] = is_met;
        }
        for (is_met, is_asked) in verdicts.is_met.iter_mut().zip(is_asked) {
            *is_met &= is_asked;
        }
    }
}

impl Verdicts {
    pub(super) const NONE: Self = {
        let zero = [0.0; LANES];
        Self { t: zero, u: zero, v: zero, indices: [0; LANES], is_met: [false; LANES] }
    };

    /// Offers a ray's triangle, if it is met.
    #[inline(always)]
    pub(super) fn offer<Q: Search>(&self, i: usize, search: &mut Q) {
        if self.is_met[i] {
            search.offer(Intersection { t: self.t[i], u: self.u[i], v: self.v[i] }, self.indices[i]);
        }
    }
}
