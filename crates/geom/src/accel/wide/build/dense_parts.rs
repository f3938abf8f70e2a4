//! Dense parts of a scene that are tiny against the whole, each of which has a tree of its own.
//!
//! A traversal knows coordinates to about `2^-21` of the extent of its tree. If the triangles of a mesh are smaller than
//! that, a ray meets the boxes of all triangles that it passes near. In a tree over that mesh alone, coordinates are as
//! accurate as in any other tree.

use crate::ray::power_of_two;
use crate::{Aabb, Triangles};
use std::cmp::Reverse;

/// Triangles that are smaller than this fraction of the extent are fine (measured).
const MAX_FINE_SIZE: f64 = power_of_two(-17);
/// A part of the scene is tiny if its extent is at most this fraction of the whole's.
const MAX_PART_SIZE: f64 = power_of_two(-4);
/// Fewer fine triangles than this are not dense.
const MIN_TRIANGLES: usize = 64;
/// Fewer than one of this many fine triangles are not dense either.
const FINE_PER_DENSE: usize = 64;
/// The most dense parts of a scene: each ray meets a tree for each of them.
const MAX_PARTS: usize = 8;
/// Bins in which gaps between fine triangles are sought, along each axis.
const BINS: usize = 64;
/// The most gaps at which fine triangles are separated.
const MAX_GAPS: usize = 64;

/// The triangles in parts: each dense part that is tiny against what surrounds it, which may hold such parts itself, and last
/// what is left. Mostly there is one part, which is everything.
pub(super) fn dense_parts(triangles: &Triangles) -> Vec<Triangles> {
    let (mut parts, mut parts_left) = (Vec::new(), MAX_PARTS);
    add_parts(triangles.clone(), &mut parts_left, &mut parts);
    parts
}

/// Adds the dense parts of a part of the scene, and then the rest of it, after these.
fn add_parts(part: Triangles, parts_left: &mut usize, parts: &mut Vec<Triangles>) {
    let bounds = bounds_of_dense_parts(&part, *parts_left);
    if bounds.is_empty() {
        return parts.push(part);
    }
    *parts_left -= bounds.len();
    let (mut inside, mut outside) = (vec![Vec::new(); bounds.len()], Vec::new());
    for &index in part.live() {
        let triangle = part.get(index).bounds();
        let place = bounds.iter().position(|dense| dense.union(&triangle) == *dense);
        place.map_or(&mut outside, |place| &mut inside[place]).push(index);
    }
    inside.into_iter().for_each(|dense| add_parts(part.with_live(dense), parts_left, parts));
    if !outside.is_empty() {
        parts.push(part.with_live(outside));
    }
}

/// The bounds of the dense parts, up to `most` of those with the most fine triangles. They are disjoint.
fn bounds_of_dense_parts(part: &Triangles, most: usize) -> Vec<Aabb> {
    let extent = part.bounds().extent().max_element();
    let bounds = part.live().iter().map(|&index| part.get(index).bounds());
    let fine: Vec<Aabb> = bounds.filter(|b| b.extent().max_element() < MAX_FINE_SIZE * extent).collect();
    let fewest = MIN_TRIANGLES.max(fine.len() / FINE_PER_DENSE);
    let (mut groups, mut dense, mut gaps_left) = (vec![fine], Vec::new(), MAX_GAPS);
    while let Some(group) = groups.pop() {
        if group.len() < fewest {
            continue;
        }
        let bounds = group.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
        if bounds.extent().max_element() <= MAX_PART_SIZE * extent {
            dense.push((group.len(), bounds));
        } else if gaps_left > 0
            && let Some(gap) = widest_gap(&group, &bounds)
        {
            gaps_left -= 1;
            let (below, above) = group.into_iter().partition(|b| b.min[gap.axis] < gap.position);
            groups.extend([below, above]);
        }
    }
    dense.sort_by_key(|&(count, _)| Reverse(count));
    dense.into_iter().take(most).map(|(_, bounds)| bounds).collect()
}

/// A plane that no fine triangle of a group meets, with some on both sides.
struct Gap {
    axis: usize,
    position: f32,
    width: f64,
}

/// A plane in the middle of the widest gap between the triangles of a group within `bounds`; `None` if no bin is empty.
fn widest_gap(group: &[Aabb], bounds: &Aabb) -> Option<Gap> {
    let gap_along = |axis: usize| {
        let (start, width) = (f64::from(bounds.min[axis]), bounds.extent()[axis] / BINS as f64);
        let bin = |x: f32| (((f64::from(x) - start) / width) as usize).min(BINS - 1);
        let mut filled = [false; BINS];
        group.iter().for_each(|b| filled[bin(b.min[axis])..=bin(b.max[axis])].fill(true));
        // The first and the last bin are filled, unless the group is flat.
        let (mut at, mut widest) = (0, (0, 0));
        for bins in filled.split(|is_filled| *is_filled).map(<[bool]>::len) {
            widest = widest.max((bins, at));
            at += bins + 1;
        }
        let (bins, first) = widest;
        let position = (start + (first as f64 + 0.5 * bins as f64) * width) as f32;
        // In `f32` the plane may coincide with an end of a group that is hardly wider than that resolves.
        let separates = bins > 0 && bounds.min[axis] < position && position < bounds.max[axis];
        separates.then_some(Gap { axis, position, width: bins as f64 * width })
    };
    (0..3).filter_map(gap_along).max_by(|a, b| a.width.total_cmp(&b.width))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Triangle;
    use crate::conformance::shapes::icosphere;
    use glam::Vec3;

    /// A ball of 5,120 triangles.
    fn ball(center: Vec3, radius: f32) -> impl Iterator<Item = Triangle> {
        icosphere(4)
            .triangles()
            .into_iter()
            .map(move |triangle| Triangle { vertices: triangle.vertices.map(|v| center + radius * v) })
    }

    /// A triangle of this size.
    fn large(size: f32) -> Triangle {
        Triangle::new(Vec3::new(-size, -size, 0.0), Vec3::new(size, -size, 0.0), Vec3::new(0.0, size, size))
    }

    /// The numbers of triangles in the parts of a scene; each triangle is in one part.
    fn counts(triangles: impl IntoIterator<Item = Triangle>) -> Vec<usize> {
        let triangles = Triangles::new(triangles.into_iter().collect()).expect("valid triangles");
        let parts = dense_parts(&triangles);
        let mut all: Vec<u32> = parts.iter().flat_map(|part| part.live().to_vec()).collect();
        all.sort_unstable();
        assert_eq!(all, triangles.live());
        parts.iter().map(|part| part.live().len()).collect()
    }

    #[test]
    fn a_scene_of_one_scale_is_one_part() {
        assert_eq!(counts([]), [0]);
        assert_eq!(counts(ball(Vec3::ONE, 1.0)), [5120]);
        assert_eq!(counts(ball(Vec3::ONE, 1.0).chain([large(1e3)])), [5121]);
    }

    #[test]
    fn a_dense_part_may_be_anywhere_and_hold_others() {
        let ball = |x: f32, radius: f32| ball(Vec3::new(x, 0.0, 0.0), radius);
        for place in [-1e5, 0.0, 3.0, 2e5] {
            assert_eq!(counts(ball(place, 1.0).chain([large(1e6), large(20.0)])), [5120, 2]);
        }
        // A triangle that is not fine, within the bounds of those that are.
        assert_eq!(counts(ball(0.0, 1.0).chain([large(4e4), large(0.5)])), [5121, 1]);
        assert_eq!(counts(ball(-5e5, 1.0).chain([large(1e6)]).chain(ball(5e5, 1.0))), [5120, 5120, 1]);
        // Nothing is left outside of two balls.
        assert_eq!(counts(ball(0.0, 1.0).chain(ball(1e6, 1.0))), [5120, 5120]);
        let nested = ball(0.0, 1e-6).chain(ball(0.0, 1.0)).chain([large(1e6), large(0.2)]);
        assert_eq!(counts(nested), [5120, 5121, 1]);
    }

    #[test]
    fn what_gaps_do_not_separate_is_one_part() {
        // A row of fine triangles from one end of the scene to the other.
        let fine = (0..4000).map(|i| {
            let at = Vec3::new(i as f32 / 2000.0 - 1.0, 0.0, 0.0);
            Triangle::new(at, at + 1e-7 * Vec3::Y, at + 1e-7 * Vec3::Z)
        });
        assert_eq!(counts(fine.chain([large(1.0)])), [4001]);
        // Ten flat groups of four hundred have gaps between them.
        let flat = (0..4000).map(|i| {
            let at = Vec3::new((i / 400) as f32 / 5.0 - 1.0, 0.0, (i % 400) as f32 * 1e-6);
            Triangle::new(at, at + 1e-7 * Vec3::X, at + 1e-7 * Vec3::Z)
        });
        assert_eq!(counts(flat.chain([large(1.0)])).len(), 1 + MAX_PARTS);
        // Few fine triangles are not dense.
        assert_eq!(counts(ball(Vec3::ZERO, 1.0).take(60).chain([large(1e6)])), [61]);
    }
}
