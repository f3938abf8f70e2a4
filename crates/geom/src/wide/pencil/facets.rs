//! Rays from one point and triangles in `f32`: what certainly is no hit, and what certainly is one.
//!
//! The edge functions of [`Shear::decide`](crate::decide::Shear::decide) are linear in a ray's slopes, since
//! the rays share their origin. For a block's triangles they are found once, around a ray in the middle of
//! those that meet the block, so that little cancels; what a ray then adds is two products for each, and
//! their errors are bounded by what holds for all of these rays (docs/numerics.md).

use super::super::filter::{Filtered, Vertices};
use super::super::simd::{LANES, Simd};
use super::focus::Focus;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;
/// Error of a place ahead beyond that of the weights, in units of `U`.
const AHEAD_ERR: f32 = 26.0;

/// Eight triangles, or one in all lanes, as rays near the focus see them.
#[derive(Clone, Copy)]
pub(super) struct Facets<F> {
    /// Each edge function at the focus, and what it grows by for each unit of deviation along x and y.
    edges: [[F; 3]; 3],
    /// A bound for the error of each of them.
    edge_err: F,
    /// Where vertex 0 is, ahead, and how much further vertices 1 and 2.
    ahead: [F; 3],
    /// The error of a place ahead is at most this divided by the sum of the edge functions, and a constant.
    ahead_err: F,
}

/// [`Facets`] in memory.
pub(super) type Stored = Facets<[f32; LANES]>;

/// Rays, by what they deviate from the focus.
pub(super) struct Sights<S: Simd> {
    pub(super) aside: [S::F; 2],
    pub(super) begin: S::F,
    pub(super) range_end: S::F,
    /// What begins beyond this can not matter.
    pub(super) end: S::F,
}

impl<F: Copy> Facets<F> {
    #[inline(always)]
    pub(super) fn new<S: Simd<F = F>>(simd: S, focus: &Focus, v: &Vertices<S>) -> Self {
        let (sense, start) = (simd.splat(focus.sense), simd.splat(focus.start));
        let [a, b, c] = v.z;
        let places = [simd.mul(a, sense), simd.mul(b, sense), simd.mul(c, sense)];
        let [a, b, c] = places;
        let depths = [simd.sub(a, start), simd.sub(b, start), simd.sub(c, start)];
        let x = focus.project(simd, 0, &v.x, &places);
        let y = focus.project(simd, 1, &v.y, &places);
        let edges = [
            edge(simd, [&x, &y, &depths], 2, 1),
            edge(simd, [&x, &y, &depths], 0, 2),
            edge(simd, [&x, &y, &depths], 1, 0),
        ];
        let size = simd.max_abs(largest(simd, x), largest(simd, y));
        let depth = simd.add(largest(simd, depths), simd.splat(1.0));
        let [e0, e1, e2, e3, e4] = focus.err;
        let (e0, e1, e2) = (simd.splat(e0), simd.splat(e1), simd.splat(e2));
        let (e3, e4) = (simd.splat(e3), simd.splat(e4));
        let rate = simd.mul_add(size, e2, simd.mul_add(depth, e1, e0));
        let edge_err = simd.mul_add(size, rate, simd.mul_add(depth, e3, e4));
        let ahead = [places[0], simd.sub(places[1], places[0]), simd.sub(places[2], places[0])];
        let ahead_err = simd.mul(simd.mul(edge_err, simd.splat(8.0)), simd.max_abs(ahead[1], ahead[2]));
        Self { edges, edge_err, ahead, ahead_err }
    }

    /// Which of them any of the rays that meet the block may hit.
    #[inline(always)]
    pub(super) fn in_sight<S: Simd<F = F>>(&self, simd: S, focus: &Focus) -> u8 {
        let reach = [simd.splat(focus.reach[0]), simd.splat(focus.reach[1])];
        let [[a_low, a_high], [b_low, b_high], [c_low, c_high]] =
            [self.range(simd, reach, 0), self.range(simd, reach, 1), self.range(simd, reach, 2)];
        // One is negative for all rays, and one is positive for all.
        let negative = simd.min(simd.min(a_high, b_high), c_high);
        let positive = simd.max(simd.max(a_low, b_low), c_low);
        let minus_err = simd.sub(simd.splat(0.0), self.edge_err);
        !(simd.lt(negative, minus_err) & simd.lt(self.edge_err, positive))
    }

    /// The least and the greatest that an edge function is.
    #[inline(always)]
    fn range<S: Simd<F = F>>(&self, simd: S, reach: [F; 2], i: usize) -> [F; 2] {
        let [at, x, y] = self.edges[i];
        let growth = simd.mul_add(reach[0], simd.abs(x), simd.mul(reach[1], simd.abs(y)));
        [simd.sub(at, growth), simd.add(at, growth)]
    }

    /// What of them rays may hit: one triangle's and one ray's lane by lane.
    #[inline(always)]
    pub(super) fn filter<S: Simd<F = F>>(&self, simd: S, rays: &Sights<S>) -> Filtered<S> {
        let zero = simd.splat(0.0);
        let [e0, e1, e2] = [self.edge(simd, rays, 0), self.edge(simd, rays, 1), self.edge(simd, rays, 2)];
        let (err, minus_err) = (self.edge_err, simd.sub(zero, self.edge_err));
        let low = simd.min(simd.min(e0, e1), e2);
        let high = simd.max(simd.max(e0, e1), e2);
        let outside = simd.lt(low, minus_err) & simd.lt(err, high);
        let inside = simd.lt(err, low) | simd.lt(high, minus_err);
        // The place is that of vertex 0 and the weighted differences of the others'.
        let inverse = simd.div(simd.splat(1.0), simd.add(simd.add(e0, e1), e2));
        let weighted = simd.mul_add(e1, self.ahead[1], simd.mul(e2, self.ahead[2]));
        let place = simd.mul_add(weighted, inverse, self.ahead[0]);
        let place_err = simd.mul_add(self.ahead_err, simd.abs(inverse), simd.splat(AHEAD_ERR * U));
        let (start, end) = (simd.sub(place, place_err), simd.add(place, place_err));
        // Comparisons with NaN are false: where an error is unbounded, a hit is possible.
        let beyond = simd.lt(rays.end, start) | simd.lt(end, rays.begin);
        let possible = !(outside | beyond);
        let certain = possible & inside & simd.lt(rays.begin, start) & simd.lt(end, rays.range_end);
        Filtered { possible, certain, start, end }
    }

    #[inline(always)]
    fn edge<S: Simd<F = F>>(&self, simd: S, rays: &Sights<S>, i: usize) -> F {
        let [at, x, y] = self.edges[i];
        simd.mul_add(rays.aside[0], x, simd.mul_add(rays.aside[1], y, at))
    }

    #[inline(always)]
    fn each<T: Copy>(&self, mut f: impl FnMut(F) -> T) -> Facets<T> {
        let Self { edges: [a, b, c], edge_err, ahead: [p, q, r], ahead_err } = *self;
        Facets {
            edges: [[f(a[0]), f(a[1]), f(a[2])], [f(b[0]), f(b[1]), f(b[2])], [f(c[0]), f(c[1]), f(c[2])]],
            edge_err: f(edge_err),
            ahead: [f(p), f(q), f(r)],
            ahead_err: f(ahead_err),
        }
    }

    #[inline(always)]
    pub(super) fn store<S: Simd<F = F>>(&self, simd: S) -> Stored {
        self.each(
            #[inline(always)]
            |x| {
                let mut stored = [0.0; LANES];
                simd.store(&mut stored, x);
                stored
            },
        )
    }
}

/// The edge function of vertices `i` and `j` at the focus, and its growth.
#[inline(always)]
fn edge<S: Simd>(simd: S, [x, y, depths]: [&[S::F; 3]; 3], i: usize, j: usize) -> [S::F; 3] {
    [cross(simd, x, y, i, j), cross(simd, y, depths, i, j), cross(simd, depths, x, i, j)]
}

#[inline(always)]
fn cross<S: Simd>(simd: S, a: &[S::F; 3], b: &[S::F; 3], i: usize, j: usize) -> S::F {
    simd.mul_sub(a[i], b[j], simd.mul(b[i], a[j]))
}

/// The largest magnitude.
#[inline(always)]
fn largest<S: Simd>(simd: S, [a, b, c]: [S::F; 3]) -> S::F {
    simd.max_abs(simd.max_abs(a, b), c)
}

impl Stored {
    /// One of the triangles, in all lanes.
    #[inline(always)]
    pub(super) fn lane<S: Simd>(&self, simd: S, lane: usize) -> Facets<S::F> {
        self.each(
            #[inline(always)]
            |x| simd.splat(x[lane % LANES]),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::scratch::WIDTH;
    use super::super::super::simd::Portable;
    use super::super::super::space::Space;
    use super::super::lines::Lines;
    use super::super::tests::pencil;
    use super::super::view::View;
    use super::super::window::Window;
    use super::*;
    use crate::Ray;
    use crate::conformance::{Seeded, Source};
    use crate::decide::permute;
    use glam::DVec3;

    const UNIT: Space = Space { center: DVec3::ZERO, scale: 1.0 };

    /// A triangle with a vertex on a ray or near it, in the order of the view; as small as `10^-5`.
    fn triangle(source: &mut Seeded, view: &View, ray: &Ray) -> [DVec3; 3] {
        let size = 10.0_f64.powf(-5.0 * source.unit());
        let along = permute(ray.direction, view.main_axis);
        let from = view.origin * DVec3::new(1.0, 1.0, view.sense);
        let at = from + (source.signed() - from.z) / along.z * along;
        let mut vertex = || {
            let aside = DVec3::new(source.signed(), source.signed(), source.signed());
            (at + size * aside).clamp(DVec3::NEG_ONE, DVec3::ONE)
        };
        [vertex(), vertex(), vertex()]
    }

    /// The edge functions, as near to exact as `f64` is, and where the triangle is met if they say that it is.
    fn exactly(view: &View, ray: &Ray, vertices: [DVec3; 3]) -> ([f64; 3], Option<f64>) {
        let (origin, direction) =
            (permute(ray.origin, view.main_axis), permute(ray.direction, view.main_axis));
        let project = |v: DVec3| {
            let v = v - origin;
            v - v.z / direction.z * direction
        };
        let [a, b, c] = vertices.map(project);
        let edges = [c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x];
        let sum: f64 = edges.iter().sum();
        let weighted: f64 = (0..3).map(|i| edges[i] * vertices[i].z).sum();
        let is_met = edges.iter().all(|e| e / sum >= 0.0);
        (edges, is_met.then_some(view.sense * weighted / sum))
    }

    /// What is computed differs from what is true by less than the bound says, for every edge function and
    /// place, and for some by a good part of it: a tenth of the bound would be too little.
    #[test]
    fn errors_are_within_their_bounds() {
        let (simd, mut source) = (Portable, Seeded::new(11));
        let (mut worst, mut met, mut certain) = (0.0_f64, 0, 0);
        for _ in 0..4000 {
            let rays = pencil(&mut source);
            let (mut view, mut lines) = (View::new(&rays, &UNIT).unwrap(), Lines::idle());
            let (groups, _) = rays.as_chunks();
            assert!(lines.set(simd, &mut view, groups));
            let focus = Focus::new(&view, &Window { low: view.low, high: view.high });
            let triangles: [_; LANES] = std::array::from_fn(|_| {
                let ray = &rays[source.below(WIDTH)];
                triangle(&mut source, &view, ray)
            });
            let column = |i: usize, axis: usize| triangles.map(|t| t[i][axis] as f32);
            let row = |axis: usize| [0, 1, 2].map(|i| column(i, axis));
            let facets = Facets::new(simd, &focus, &Vertices { x: row(0), y: row(1), z: row(2) });
            let in_sight = facets.in_sight(simd, &focus);
            for slot in (0..WIDTH).step_by(9) {
                let (g, i) = (slot / LANES, slot % LANES);
                let aside = [0, 1].map(|axis| simd.splat(lines.aside[axis][g][i] - focus.aside[axis]));
                let [begin, end] = [lines.begin[g][i], lines.end[g][i]].map(|x| simd.splat(x));
                let sights = Sights { aside, begin, range_end: end, end };
                let edges = [0, 1, 2].map(|i| facets.edge(simd, &sights, i));
                let filtered = facets.filter(simd, &sights);
                for lane in 0..LANES {
                    let (exact, place) = exactly(&view, &rays[slot], triangles[lane]);
                    for (edge, exact) in edges.iter().zip(exact) {
                        let err = (f64::from(edge[lane]) - exact).abs() / f64::from(facets.edge_err[lane]);
                        assert!(err <= 1.0, "{err} of {:?} for {:?}", triangles[lane], rays[slot]);
                        worst = worst.max(err);
                    }
                    let is_certain = filtered.certain >> lane & 1 != 0;
                    let Some(place) = place.filter(|place| *place >= view.origin.z) else {
                        assert!(!is_certain, "{:?} by {:?}", triangles[lane], rays[slot]);
                        continue;
                    };
                    let (start, end) = (f64::from(filtered.start[lane]), f64::from(filtered.end[lane]));
                    assert!(!(place < start || end < place), "{start}..{end}, not {place}");
                    assert!((in_sight & filtered.possible) >> lane & 1 != 0);
                    met += 1;
                    certain += i32::from(is_certain);
                }
            }
        }
        assert!(worst > 0.1, "{worst}");
        assert!(met > 10_000 && certain > met / 2, "{certain} of {met}");
    }
}
