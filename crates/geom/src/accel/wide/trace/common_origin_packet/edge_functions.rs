//! The conservative ray/triangle test for rays from a common origin, in `f32`.
//!
//! The edge functions of [`Shear::decide`](crate::decide::Shear::decide) are linear in a ray's slopes, since
//! the rays share their origin. For the triangles of a leaf block they are computed once, around a central ray of
//! those that may meet the block, so that little cancels. A ray then adds two products for each edge
//! function. The error bounds hold for all of these rays (docs/numerics.md).

use super::child_slope_bounds::SlopeBounds;
use super::setup::PacketSetup;
use crate::accel::wide::simd::{Simd, SimdBase, SimdFloat};
use crate::accel::wide::trace::prefilter::{
    Filtered, HitRange, Vertices, classify, cross, hit_depth, largest, shear,
};
use crate::rounding::W;

/// Error of a hit's depth beyond that of the weights, in units of `W`.
const DEPTH_ERR: f32 = 26.0;
/// Error of a vertex projected along the central ray, beyond that of the offset, in units of `W`.
const VERTEX_ERR: f32 = 8.0;
/// Error of an edge function of vertices up to `m` across from the central ray and up to a distance of `a` from the origin
/// along the main axis, with `b = a + 1`, for rays whose slopes deviate by up to `d` from those of the central ray, in
/// units of `W`: the factors of `m * m`, of `m * b` and of `m * b * d`.
const EDGE_ERR: [f32; 3] = [13.0, 0.5, 37.0];
/// A bound for the error of the distance `a`, `2 W b`.
const AHEAD_ERR: f32 = 1.0 / 65536.0;

/// The central ray of those that may meet a leaf block.
pub(super) struct CentralRay {
    /// Its deviation from the packet's middle ray.
    pub(super) deviation: [f32; 2],
    /// How far the other rays' slopes are from its own at most.
    max_deviation: [f32; 2],
    slope: [f32; 2],
    offset: [f32; 2],
    sense: f32,
    /// The depth of the origin.
    start: f32,
    /// The error of an edge function is at most `m * (err[0] + b * err[1] + m * err[2]) + a * err[3] + err[4]`.
    err: [f32; 5],
}

impl CentralRay {
    #[inline(always)]
    pub(super) fn new(setup: &PacketSetup, bounds: &SlopeBounds) -> Self {
        let SlopeBounds { low, high } = *bounds;
        let (mut deviation, mut slope, mut offset) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        let (mut max_deviation, mut furthest) = ([0.0; 2], 0.0_f32);
        for axis in 0..2 {
            deviation[axis] = 0.5 * (low[axis] + high[axis]);
            let exact = f64::from(setup.middle[axis]) + f64::from(deviation[axis]);
            slope[axis] = exact as f32;
            offset[axis] = (setup.origin[axis] - exact * setup.origin.z) as f32;
            max_deviation[axis] = larger(high[axis] - deviation[axis], deviation[axis] - low[axis]);
            furthest = larger(furthest, offset[axis].abs());
        }
        let furthest_slope = larger(max_deviation[0], max_deviation[1]);
        let vertex_err = (VERTEX_ERR + furthest) * W;
        let err = [
            4.0 * vertex_err,
            (EDGE_ERR[1] + EDGE_ERR[2] * furthest_slope) * W,
            EDGE_ERR[0] * W,
            4.1 * furthest_slope * vertex_err,
            (2.2 * vertex_err + AHEAD_ERR * 4.1 * furthest_slope) * vertex_err,
        ];
        Self {
            deviation,
            max_deviation,
            slope,
            offset,
            sense: setup.sense as f32,
            start: setup.origin.z as f32,
            err,
        }
    }
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The edge functions of eight triangles, or of one in all lanes, around a central ray.
pub(super) struct EdgeFunctions<S: Simd> {
    /// Each edge function at the central ray, and its growth for each unit of deviation from it along x and y.
    edges: [[S::F; 3]; 3],
    /// A bound for the error of each of them.
    edge_err: S::F,
    /// The depth of vertex 0, and the differences of those of vertices 1 and 2.
    depth: [S::F; 3],
    /// The error of a hit's depth is at most this divided by the sum of the edge functions, plus a constant.
    depth_err: S::F,
}

/// Rays by their deviation from the central ray.
pub(super) struct RayLanes<S: Simd> {
    pub(super) deviation: [S::F; 2],
    pub(super) range: HitRange<S>,
}

impl<S: Simd> EdgeFunctions<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, center: &CentralRay, v: &Vertices<S>) -> Self {
        let [z0, z1, z2] = [v.z[0] * center.sense, v.z[1] * center.sense, v.z[2] * center.sense];
        let from_origin = [z0 - center.start, z1 - center.start, z2 - center.start];
        let x = shear::<S>(center.slope[0], center.offset[0], &v.x, &[z0, z1, z2]);
        let y = shear::<S>(center.slope[1], center.offset[1], &v.y, &[z0, z1, z2]);
        let edges = [
            edge::<S>([&x, &y, &from_origin], 2, 1),
            edge::<S>([&x, &y, &from_origin], 0, 2),
            edge::<S>([&x, &y, &from_origin], 1, 0),
        ];
        let m = simd.max_abs(largest(simd, x), largest(simd, y));
        let a = largest(simd, from_origin);
        let b = a + 1.0;
        let [e0, e1, e2, e3, e4] = center.err;
        let rate = m.mul_add(e2, b.mul_add(e1, e0));
        let edge_err = m.mul_add(rate, a.mul_add(e3, e4));
        let depth = [z0, z1 - z0, z2 - z0];
        let depth_err = edge_err * 8.0 * simd.max_abs(depth[1], depth[2]);
        Self { edges, edge_err, depth, depth_err }
    }

    /// The triangles that any of the rays may hit.
    #[inline(always)]
    pub(super) fn may_hit(&self, simd: S, center: &CentralRay) -> u8 {
        let [[a_low, a_high], [b_low, b_high], [c_low, c_high]] = [
            self.range(center.max_deviation, 0),
            self.range(center.max_deviation, 1),
            self.range(center.max_deviation, 2),
        ];
        // A triangle is missed if one function is negative for all rays and another positive.
        let (negative, positive) = (a_high.min(b_high).min(c_high), a_low.max(b_low).max(c_low));
        !(simd.lt(negative, -self.edge_err) & simd.lt(self.edge_err, positive))
    }

    /// The least and the greatest value of an edge function.
    #[inline(always)]
    fn range(&self, max_deviation: [f32; 2], i: usize) -> [S::F; 2] {
        let [at, x, y] = self.edges[i];
        let growth = x.abs().mul_add(max_deviation[0], y.abs() * max_deviation[1]);
        [at - growth, at + growth]
    }

    /// The conservative test: in each lane, a triangle and a ray.
    #[inline(always)]
    pub(super) fn prefilter(&self, simd: S, rays: &RayLanes<S>) -> Filtered {
        let edges = [self.edge(rays, 0), self.edge(rays, 1), self.edge(rays, 2)];
        let (depth, inverse) = hit_depth(simd, edges, self.depth);
        let depth_err = self.depth_err.mul_add(inverse.abs(), DEPTH_ERR * W);
        classify(simd, edges, self.edge_err, [depth - depth_err, depth + depth_err], &rays.range)
    }

    #[inline(always)]
    fn edge(&self, rays: &RayLanes<S>, i: usize) -> S::F {
        let [at, x, y] = self.edges[i];
        rays.deviation[0].mul_add(x, rays.deviation[1].mul_add(y, at))
    }

    /// Those of one of the triangles, in all lanes.
    #[inline(always)]
    pub(super) fn lane(&self, simd: S, lane: usize) -> Self {
        let lanes = S::I::splat(simd, lane as u32);
        let splat = |x: S::F| simd.permute(x, lanes);
        let Self { edges: [a, b, c], edge_err, depth: [p, q, r], depth_err } = *self;
        Self {
            edges: [
                [splat(a[0]), splat(a[1]), splat(a[2])],
                [splat(b[0]), splat(b[1]), splat(b[2])],
                [splat(c[0]), splat(c[1]), splat(c[2])],
            ],
            edge_err: splat(edge_err),
            depth: [splat(p), splat(q), splat(r)],
            depth_err: splat(depth_err),
        }
    }
}

/// The edge function of vertices `i` and `j` at the central ray, and its growth.
#[inline(always)]
fn edge<S: Simd>([x, y, depth]: [&[S::F; 3]; 3], i: usize, j: usize) -> [S::F; 3] {
    [cross::<S>(x, y, i, j), cross::<S>(y, depth, i, j), cross::<S>(depth, x, i, j)]
}

#[cfg(test)]
mod tests {
    use super::super::setup::PacketRays;
    use super::super::tests::packet;
    use super::*;
    use crate::Ray;
    use crate::accel::wide::simd::{LANES, PACKET};
    use crate::accel::wide::tree::normalize::NormalizedSpace;
    use crate::conformance::{Seeded, Source};
    use crate::cpu::portable;
    use crate::decide::permute;
    use glam::DVec3;

    const UNIT: NormalizedSpace = NormalizedSpace { center: DVec3::ZERO, scale: 1.0 };

    /// A triangle with a vertex on a ray or near it, in the order of the shear; as small as `10^-5`, and half of the time
    /// as near to the origin as `10^-4`.
    fn triangle(source: &mut Seeded, setup: &PacketSetup, ray: &Ray) -> [DVec3; 3] {
        let size = 10.0_f64.powf(-5.0 * source.unit());
        let along = permute(ray.direction, setup.main_axis);
        let from = setup.origin * DVec3::new(1.0, 1.0, setup.sense);
        let far = (source.signed() - from.z) / along.z;
        let near = 10.0_f64.powf(-4.0 * source.unit()) / along.z.abs();
        let at = from + if source.one_in(2) { near } else { far } * along;
        let mut vertex = || {
            let aside = DVec3::new(source.signed(), source.signed(), source.signed());
            (at + size * aside).clamp(DVec3::NEG_ONE, DVec3::ONE)
        };
        [vertex(), vertex(), vertex()]
    }

    /// The edge functions in `f64`, and the depth of the hit if they say that there is one.
    fn exactly(setup: &PacketSetup, ray: &Ray, vertices: [DVec3; 3]) -> ([f64; 3], Option<f64>) {
        let (origin, direction) =
            (permute(ray.origin, setup.main_axis), permute(ray.direction, setup.main_axis));
        let project = |v: DVec3| {
            let v = v - origin;
            v - v.z / direction.z * direction
        };
        let [a, b, c] = vertices.map(project);
        let edges = [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x];
        let sum: f64 = edges.iter().sum();
        let weighted: f64 = (0..3).map(|i| edges[i] * vertices[i].z).sum();
        let is_hit = edges.iter().all(|e| e / sum >= 0.0);
        (edges, is_hit.then_some(setup.sense * weighted / sum))
    }

    /// The error of every edge function and depth is within its bound, and the largest is more than a tenth of it,
    /// so that a bound a tenth as large would fail.
    #[test]
    fn errors_are_within_their_bounds() {
        let (simd, mut source) = (portable(), Seeded::new(11));
        let (mut worst, mut met, mut certain) = (0.0_f64, 0, 0);
        for _ in 0..40_000 {
            let rays = packet(&mut source);
            let (mut setup, mut packet_rays) =
                (PacketSetup::new(&rays, &UNIT).unwrap(), PacketRays::default());
            let (groups, _) = rays.as_chunks();
            assert!(packet_rays.set(simd, &mut setup, groups));
            let center = CentralRay::new(&setup, &SlopeBounds { low: setup.low, high: setup.high });
            let triangles: [_; LANES] = std::array::from_fn(|_| {
                let ray = &rays[source.below(PACKET)];
                triangle(&mut source, &setup, ray)
            });
            let column = |i: usize, axis: usize| simd.load(&triangles.map(|t| t[i][axis] as f32));
            let row = |axis: usize| [0, 1, 2].map(|i| column(i, axis));
            let functions = EdgeFunctions::new(simd, &center, &Vertices { x: row(0), y: row(1), z: row(2) });
            let may_hit = functions.may_hit(simd, &center);
            for slot in (0..PACKET).step_by(9) {
                let (g, i) = (slot / LANES, slot % LANES);
                let deviation =
                    [0, 1].map(|axis| simd.splat(packet_rays.deviation[axis][g][i] - center.deviation[axis]));
                let [begin, limit] =
                    [packet_rays.begin[g][i], packet_rays.limit[g][i]].map(|x| simd.splat(x));
                let lanes = RayLanes { deviation, range: HitRange { begin, end: limit, limit } };
                let edges = [0, 1, 2].map(|i| functions.edge(&lanes, i));
                let filtered = functions.prefilter(simd, &lanes);
                for lane in 0..LANES {
                    let (exact, place) = exactly(&setup, &rays[slot], triangles[lane]);
                    for (edge, exact) in edges.iter().zip(exact) {
                        let err = (f64::from(edge[lane]) - exact).abs() / f64::from(functions.edge_err[lane]);
                        assert!(err <= 1.0, "{err} of {:?} for {:?}", triangles[lane], rays[slot]);
                        worst = worst.max(err);
                    }
                    let is_certain = filtered.certain >> lane & 1 != 0;
                    let Some(place) = place.filter(|place| *place >= setup.origin.z) else {
                        assert!(!is_certain, "{:?} by {:?}", triangles[lane], rays[slot]);
                        continue;
                    };
                    let (start, end) = (f64::from(filtered.start[lane]), f64::from(filtered.end[lane]));
                    assert!(!(place < start || end < place), "{start}..{end}, not {place}");
                    assert!((may_hit & filtered.possible) >> lane & 1 != 0);
                    met += 1;
                    certain += i32::from(is_certain);
                }
            }
        }
        assert!(worst > 0.1, "{worst}");
        assert!(met > 10_000 && certain > met / 2, "{certain} of {met}");
    }
}
