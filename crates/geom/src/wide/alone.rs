//! One ray on its own.

use super::WideKdTree;
use super::course::Courses;
use super::goal::Goal;
use super::leaf::{note, open};
use super::node::Child;
use super::scratch::Scratch;
use super::simd::Simd;
use super::step::step;
use crate::{Probe, Ray};

/// Searches for `ray`, telling `probe` what is done for it.
#[inline(always)]
pub(super) fn search_alone<S: Simd, Q: Goal, P: Probe>(
    simd: S,
    tree: &WideKdTree,
    ray: &Ray,
    probe: &mut P,
) -> Q {
    let mut search = Q::begin(ray);
    let mut courses = Courses::idle();
    let Ray { origin: o, direction: d, t_min, t_max } = *ray;
    let columns = [o.x, o.y, o.z, d.x, d.y, d.z, t_min, t_max].map(|x| [x]);
    courses.set(&columns, &tree.triangles.bounds(), &tree.space);
    let Some(course) = courses.get(0) else { return search };
    Scratch::lend(
        #[inline(always)]
        |scratch| {
            let [trace, ..] = &mut *scratch.traces;
            trace.begin(course, 0);
            loop {
                let child = trace.child;
                if Child::is_end(child) == 1 {
                    break;
                }
                if Child::is_block(child) == 0 {
                    probe.visit();
                    step(simd, &tree.nodes, trace);
                    trace.advance();
                    continue;
                }
                probe.open();
                tree.listed(child).iter().for_each(|&index| probe.test(index));
                let found = open(simd, tree, trace);
                if found.is_any() {
                    note(simd, tree, ray, &found, trace, &mut search);
                }
                trace.advance();
            }
            trace.candidates.decide(trace.t_end, ray, &tree.triangles, &mut search);
        },
    );
    search
}
