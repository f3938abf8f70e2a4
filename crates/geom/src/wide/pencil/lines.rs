//! The rays of a pencil, number by number.

use super::super::packet::{GROUPS, range};
use super::super::simd::{LANES, Simd};
use super::super::slots::Slots;
use super::super::verdicts::Shears;
use super::view::{View, WIDEST};
use crate::Ray;

/// Beyond all that is in the scene.
const BEYOND: f64 = 2.0;

#[derive(Debug)]
pub(super) struct Lines {
    /// How far the slopes are from the middle ray's.
    pub(super) aside: [[[f32; LANES]; GROUPS]; 2],
    /// Where the rays' ranges begin and end, ahead.
    pub(super) begin: [[f32; LANES]; GROUPS],
    pub(super) range_end: [[f32; LANES]; GROUPS],
    /// What begins beyond this can not matter.
    pub(super) end: [[f32; LANES]; GROUPS],
    pub(super) shears: [Shears; GROUPS],
}

impl Lines {
    pub(super) fn idle() -> Self {
        let zero = [[0.0; LANES]; GROUPS];
        Self { aside: [zero; 2], begin: zero, range_end: zero, end: zero, shears: [Shears::NONE; GROUPS] }
    }

    /// Makes the rays ready, and finds out by how much they deviate from the view's middle. Returns false if
    /// they are not coherent, or not from its point.
    #[inline(always)]
    pub(super) fn set<S: Simd>(&mut self, simd: S, view: &mut View, groups: &[[Ray; LANES]]) -> bool {
        let mut fit: Slots = 0;
        for (g, group) in groups.iter().enumerate() {
            fit |= Slots::from(self.set_group(simd, g, view, group)) << (g * LANES);
        }
        if fit != Slots::MAX {
            return false;
        }
        let [x, y] = [bounds(simd, &self.aside[0]), bounds(simd, &self.aside[1])];
        [view.low, view.high] = [[x[0], y[0]], [x[1], y[1]]];
        view.begin = bounds(simd, &self.begin)[0];
        [x, y].iter().all(|[least, greatest]| f64::from(greatest - least) <= WIDEST)
    }

    /// Makes a group ready; returns those that are of the pencil, a bit each.
    #[inline(always)]
    fn set_group<S: Simd>(&mut self, simd: S, g: usize, view: &View, group: &[Ray; LANES]) -> u8 {
        let columns = simd.columns(group);
        let [ox, oy, oz, .., t_min, t_max] = &columns;
        let [dx, dy, dz] = view.axes.map(|axis| &columns[3 + axis % 3]);
        let shears = &mut self.shears[g];
        let origin = view.ray_origin;
        shears.main_axis = view.main_axis;
        shears.origin = [[origin.x; LANES], [origin.y; LANES], [origin.z; LANES]];
        shears.direction_z = *dz;
        // No branch in the loops: the compiler makes vectors of them.
        for (axis, across) in [dx, dy].into_iter().enumerate() {
            let (mut slopes, mut aside) = ([0.0; LANES], [0.0; LANES]);
            let middle = f64::from(view.middle[axis]);
            for i in 0..LANES {
                slopes[i] = across[i] / dz[i];
                aside[i] = (slopes[i] * view.sense - middle) as f32;
            }
            shears.slopes[axis] = slopes;
            self.aside[axis][g] = aside;
        }
        let (mut begins, mut ends) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let rate = dz[i].abs() * view.scale;
            let (begin, end) = (view.origin.z + t_min[i] * rate, view.origin.z + t_max[i] * rate);
            begins[i] = begin as f32;
            ends[i] = (if end < BEYOND { end } else { BEYOND }) as f32;
        }
        (self.begin[g], self.range_end[g], self.end[g]) = (begins, ends, ends);
        let domain = Ray::DIRECTION_DOMAIN;
        let mut fits = [0.0; LANES];
        for i in 0..LANES {
            let along = dz[i] * view.sense;
            // Comparisons with NaN are false. Where two components are largest the main axis is not looked for.
            let fit = (along > dx[i].abs())
                & (along > dy[i].abs())
                & (along >= *domain.start())
                & (along <= *domain.end())
                & (t_min[i] >= 0.0)
                & (t_min[i] < t_max[i])
                & (ox[i].to_bits() == view.given.x.to_bits())
                & (oy[i].to_bits() == view.given.y.to_bits())
                & (oz[i].to_bits() == view.given.z.to_bits());
            fits[i] = if fit { 1.0 } else { 0.0 };
        }
        simd.lt(simd.splat(0.0), simd.load(&fits))
    }
}

/// Smallest and largest of the rays' numbers.
#[inline(always)]
pub(super) fn bounds<S: Simd>(simd: S, numbers: &[[f32; LANES]; GROUPS]) -> [f32; 2] {
    let mut vectors = [simd.splat(0.0); GROUPS];
    for (vector, numbers) in vectors.iter_mut().zip(numbers) {
        *vector = simd.load(numbers);
    }
    range(simd, &vectors, Slots::MAX)
}
