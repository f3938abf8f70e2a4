//! Decisions for eight rays with one main axis, side by side.

use super::candidates::Candidates;
use super::simd::LANES;
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

/// Decides for each ray that is searched for what may be hit before `t_end`.
///
/// All rays have the main axis `main_axis`.
#[inline(always)]
pub(super) fn decide_all<Q: Search>(
    main_axis: usize,
    rays: &[Ray; LANES],
    candidates: &[Candidates; LANES],
    t_end: &[f32; LANES],
    triangles: &Triangles,
    searches: &mut [Q; LANES],
) {
    let (mut origins, mut directions) = ([[0.0; LANES]; 3], [[1.0; LANES]; 3]);
    for (i, ray) in rays.iter().enumerate() {
        set(&mut origins, i, permute(ray.origin, main_axis));
        set(&mut directions, i, permute(ray.direction, main_axis));
    }
    let most = candidates.iter().map(Candidates::count).max().unwrap_or(0);
    let mut vertices = [[[0.0; LANES]; 3]; 3];
    for turn in 0..most {
        let mut indices = [None; LANES];
        for i in 0..LANES {
            indices[i] = candidates[i].get(turn, t_end[i]);
            let Some(index) = indices[i] else { continue };
            for (columns, vertex) in vertices.iter_mut().zip(triangles.get(index).vertices) {
                set(columns, i, permute(vertex.as_dvec3(), main_axis));
            }
        }
        let mut found = [[0.0; LANES]; 3];
        let mut is_met = [false; LANES];
        for (i, is_met) in is_met.iter_mut().enumerate() {
            let shear = Shear::of_permuted(main_axis, get(&origins, i), get(&directions, i));
            let [a, b, c] = &vertices;
            let (at, met) = shear.decide_permuted([get(a, i), get(b, i), get(c, i)]);
            set(&mut found, i, DVec3::new(at.t, at.u, at.v));
            *is_met = met;
        }
        for (i, search) in searches.iter_mut().enumerate() {
            if let (Some(index), true) = (indices[i], is_met[i]) {
                let DVec3 { x: t, y: u, z: v } = get(&found, i);
                search.offer(Intersection { t, u, v }, index);
            }
        }
    }
}
