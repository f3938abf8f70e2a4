//! Common-origin packets: 64 coherent rays from one point, such as a pinhole camera's, are traversed together.
//!
//! What follows from the origin alone is computed once. A ray is then two numbers, its slopes' deviation from
//! those of a [middle ray](setup). A box becomes [bounds of these slopes](child_slope_bounds), the [edge
//! functions](edge_functions) of a triangle are linear in them, and depth is measured along the main axis.

mod child_slope_bounds;
mod edge_functions;
mod setup;
mod traverse;

use super::deferred_decision::Candidates;
use crate::Ray;
use crate::accel::query::Query;
use crate::accel::wide::simd::{LANES, PACKET, Simd};
use crate::accel::wide::tree::Tree;
use setup::PacketSetup;
use std::marker::PhantomData;
pub(super) use traverse::CommonOriginScratch;
use traverse::PacketTraversal;

impl CommonOriginScratch {
    /// Answers the query of every ray and reports it. If the rays are not coherent, or not from a common
    /// origin, it does nothing and returns false.
    #[inline(always)]
    pub(super) fn query<S: Simd, Q: Query>(
        &mut self,
        simd: S,
        tree: &Tree,
        rays: &[Ray; PACKET],
        mut report: impl FnMut(usize, Q),
    ) -> bool {
        let (groups, _) = rays.as_chunks::<LANES>();
        let Some(mut setup) = PacketSetup::new(rays, &tree.space) else { return false };
        if tree.bounds.is_empty() || !self.rays.set(simd, &mut setup, groups) {
            return false;
        }
        self.candidates.as_flattened_mut().iter_mut().for_each(Candidates::clear);
        let (limit, finished, query) = (f32::INFINITY, 0, PhantomData::<Q>);
        let finished =
            PacketTraversal { simd, tree, rays: groups, setup, scratch: self, limit, finished, query }.run();
        let Self { rays, candidates, decisions, .. } = self;
        for (g, group) in groups.iter().enumerate() {
            let rounds =
                rays.shears[g].decide(simd, &candidates[g], &rays.limit[g], &tree.triangles, decisions);
            for (i, ray) in group.iter().enumerate() {
                let mut query = Q::new(ray);
                for decisions in &decisions[..rounds] {
                    decisions.offer(i, &mut query);
                }
                let slot = g * LANES + i;
                let is_finished = finished >> slot & 1 != 0;
                report(slot, if is_finished { query.with_some_hit() } else { query });
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::query::ClosestHit;
    use crate::accel::wide::build::build_by_kd_tree;
    use crate::conformance::shapes::icosphere;
    use crate::conformance::{Seeded, Source};
    use crate::cpu::portable;
    use crate::{KdOptions, Triangles};
    use glam::DVec3;

    /// Rays from one point, up to 30 from a scene that is 2 wide, around a ray through it, up to a tenth apart.
    pub(super) fn packet(source: &mut Seeded) -> [Ray; PACKET] {
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
    fn other_rays_are_refused() {
        let triangles = Triangles::new(icosphere(2).triangles()).unwrap();
        let tree = build_by_kd_tree(&triangles, &KdOptions::default()).unwrap();
        let mut source = Seeded::new(6);
        let is_packet = |rays: &[Ray; PACKET]| {
            CommonOriginScratch::idle().query(portable(), &tree, rays, |_, _: ClosestHit| {})
        };
        let rays = packet(&mut source);
        assert!(is_packet(&rays));
        let spoil: [fn(&mut Ray); 12] = [
            |ray| ray.origin.x = ray.origin.x.next_up(),
            |ray| ray.origin.y = ray.origin.y.next_up(),
            |ray| ray.origin.z = ray.origin.z.next_up(),
            |ray| ray.direction = -ray.direction,
            |ray| ray.direction = DVec3::new(ray.direction.y, ray.direction.z, ray.direction.x),
            |ray| ray.direction.y = f64::NAN,
            |ray| ray.t_min = -1.0,
            |ray| ray.t_min = f64::NAN,
            |ray| ray.t_max = 0.0,
            |ray| ray.excluded[0] = 0,
            |ray| ray.excluded[1] = 1,
            |ray| ray.direction *= 2.0_f64.powi(700),
        ];
        for spoil in spoil {
            for i in [0, 17, PACKET - 1] {
                let mut rays = rays;
                spoil(&mut rays[i]);
                assert!(!is_packet(&rays), "{:?}", rays[i]);
            }
            let from_afar = rays.map(|ray| Ray { origin: ray.origin - 1000.0 * ray.direction, ..ray });
            assert!(!is_packet(&from_afar));
        }
    }
}
