//! The decision against exact arithmetic.
//!
//! Let `eps = 2^-53` and `P` be the largest coordinate distance from the ray's origin to a vertex.
//! To first order in `eps`, `Shear::decide` makes two kinds of errors:
//!
//! - Projecting a vertex, `x - slope * z`, moves it by up to `6 eps P` along each of the two axes
//!   across the ray: `eps P` from `x`, `3 eps P` from the product (slope, `z` and multiplication),
//!   `2 eps P` from the difference.
//! - Everything after that is a mean of the vertices with weights of one sign, whose errors stay
//!   relative: `2 eps` for each edge function; in all `7 eps` for `u` and `v`, and for `t`, in units
//!   of the largest depth, `12 eps`.
//!
//! Moving the vertices, and with them any mean of them, is moving the ray the other way. The
//! outcome is therefore that of a parallel ray displaced by up to `6 eps P` along the two axes. What
//! that does to `t`, `u` and `v` depends on the triangle, and exact arithmetic knows it.

use glam::{DVec3, Vec3};
use globillum_exact::{Crossing, Rational, Vector, error, rounded};
use globillum_geom::decide::{Intersection, Shear};
use globillum_geom::{Ray, Triangle};
use globillum_testkit::aimed::{Aimed, edge_on, interpolate, ordinary, sliver};
use proptest::prelude::*;

/// Unit roundoff of `f64`.
const EPS: f64 = f64::EPSILON / 2.0;

/// Covers what is of second order in `eps`, and the rounding of the bounds themselves.
const SECOND_ORDER: f64 = 1.0 + 1e-9;

/// A decision and the truth about it.
struct Case {
    ray: Ray,
    triangle: Triangle,
    decided: Option<Intersection>,
    exact: Crossing,
}

impl Case {
    /// `None` if the line does not cross the plane in one point.
    fn new(ray: Ray, triangle: Triangle) -> Option<Self> {
        let exact = Crossing::with_plane(&ray, &triangle)?;
        let decided = Shear::new(&ray).expect("a traceable ray").decide(&triangle);
        Some(Self { ray, triangle, decided, exact })
    }

    fn main_axis(&self) -> usize {
        self.ray.direction.abs().max_position()
    }

    /// The largest of something about the vertices' offsets from the origin.
    fn largest(&self, of: impl Fn(DVec3) -> f64) -> f64 {
        let offsets = self.triangle.vertices.map(|v| (v.as_dvec3() - self.ray.origin).abs());
        offsets.map(of).into_iter().fold(0.0, f64::max)
    }

    /// How far a value with this gradient moves when the ray is displaced as the head of this
    /// file says.
    fn displacement(&self, gradient: &Vector) -> f64 {
        let mut across = DVec3::from(gradient.each_ref().map(rounded)).abs();
        across[self.main_axis()] = 0.0;
        SECOND_ORDER * 6.0 * EPS * self.largest(DVec3::max_element) * across.element_sum()
    }

    /// The errors of `t`, `u` and `v`, each as a fraction of its bound.
    fn bounds_used(&self, decided: &Intersection) -> [f64; 3] {
        let Crossing { t, u, v, gradients } = &self.exact;
        let z = self.main_axis();
        let depth = self.largest(|offset| offset[z]) / self.ray.direction[z].abs();
        let [dt, du, dv] = gradients.each_ref().map(|gradient| self.displacement(gradient));
        [
            error(decided.t, t) / (12.0 * EPS * depth * SECOND_ORDER + dt),
            error(decided.u, u) / (7.0 * EPS * SECOND_ORDER + du),
            error(decided.v, v) / (7.0 * EPS * SECOND_ORDER + dv),
        ]
    }

    /// The barycentric weight of each vertex, and how far it moves when the ray is displaced.
    fn weights(&self) -> [(f64, f64); 3] {
        let Crossing { u, v, gradients: [_, gu, gv], .. } = &self.exact;
        let w = Rational::ONE - u - v;
        let gw = [0, 1, 2].map(|k| &gu[k] + &gv[k]);
        [(&w, &gw), (u, gu), (v, gv)].map(|(weight, gradient)| (rounded(weight), self.displacement(gradient)))
    }

    /// Whether the verdict is that of some displaced ray.
    fn verdict_is_excusable(&self) -> bool {
        let mut weights = self.weights().into_iter();
        match self.decided {
            Some(_) => weights.all(|(weight, moved)| weight >= -moved),
            None => weights.any(|(weight, moved)| weight <= moved),
        }
    }
}

/// Ordinary, slim and nearly edge-on triangles, each with a ray.
fn shapes() -> impl Iterator<Item = Aimed> {
    (0..200).flat_map(|index| {
        let slivers = [1e-4, 1e-8, 1e-12].map(|width| sliver(width, 1, index));
        let grazing = [1e-2, 1e-5, 1e-8, 1e-12, 1e-16].map(|elevation| edge_on(elevation, 1, index));
        [ordinary(1, index)].into_iter().chain(slivers).chain(grazing)
    })
}

/// Each of the [`shapes`], small, large and far from the world's origin, with rays from one place
/// toward its inside, its edges and a vertex.
fn cases() -> impl Iterator<Item = Case> {
    let places = [(1.0, 0.0), (3e-12, 0.0), (7e9, 0.0), (2.0, 1e5)];
    let barycentrics = [(1.0 / 3.0, 1.0 / 3.0), (0.0, 0.3), (0.6, 0.0), (0.2, 0.8), (1.0, 0.0)];
    shapes().flat_map(move |shape| {
        places.into_iter().flat_map(move |(scale, offset)| {
            let place = move |p: DVec3| scale * p + offset;
            let triangle =
                Triangle { vertices: shape.triangle.vertices.map(|v: Vec3| place(v.as_dvec3()).as_vec3()) };
            let origin = place(shape.ray.origin);
            let ray = move |(u, v)| Ray::segment(origin, interpolate(&triangle, u, v));
            barycentrics.into_iter().filter_map(move |uv| Case::new(ray(uv), triangle))
        })
    })
}

#[test]
fn t_u_and_v_stay_within_the_derived_bounds() {
    let (mut count, mut largest) = (0, [0.0_f64; 3]);
    for case in cases() {
        let Some(decided) = case.decided else { continue };
        let used = case.bounds_used(&decided);
        assert!(used.iter().all(|&fraction| fraction <= 1.0), "{used:?}: {:?} {:?}", case.ray, case.triangle);
        count += 1;
        largest = [0, 1, 2].map(|i| largest[i].max(used[i]));
    }
    assert!(count > 5000, "{count}");
    // Bounds that nothing comes near would prove little.
    assert!(largest.iter().all(|&fraction| fraction > 0.1), "{largest:?}");
}

#[test]
fn a_verdict_is_that_of_a_ray_within_rounding() {
    let mut wrong = 0;
    for case in cases() {
        assert!(case.verdict_is_excusable(), "{:?}: {:?} {:?}", case.decided, case.ray, case.triangle);
        wrong += u32::from(case.decided.is_some() != case.exact.is_inside());
    }
    assert!(wrong > 100, "only {wrong} cases were hard");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// An equilateral triangle of height 1.5, seen from two units away at up to 60 degrees from
    /// its normal: no vertex is farther than 3.73, and displacing the ray by one along both axes
    /// changes a weight by `sqrt(2) / (1.5 cos 60)` at most.
    #[test]
    fn a_well_shaped_triangle_has_good_barycentrics(
        slant in 0.0..=1.047_f64, turn in 0.0..6.3_f64, u in 0.0..0.5_f64, v in 0.0..0.5_f64,
    ) {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
        let triangle = Triangle::new(corner(1.0, 0.0), corner(-0.5, 0.866), corner(-0.5, -0.866));
        let out = DVec3::new(slant.sin() * turn.cos(), slant.sin() * turn.sin(), slant.cos());
        let case = Case::new(Ray::new(interpolate(&triangle, u, v) + 2.0 * out, -out), triangle).unwrap();
        let inside = u.min(v).min(1.0 - u - v);
        prop_assert!(case.decided.is_some() || inside <= 1e-9, "missed at {u}, {v}");
        if let Some(decided) = case.decided {
            let limit = (7.0 + 6.0 * 3.74 * 1.9) * EPS;
            prop_assert!(error(decided.u, &case.exact.u) <= limit);
            prop_assert!(error(decided.v, &case.exact.v) <= limit);
        }
    }
}

#[test]
fn slivers_are_hit_where_they_are_aimed_at() {
    for (width, most_missed) in [(1e-4, 0), (1e-8, 0), (1e-12, 10)] {
        let hits: Vec<_> = (0..20_000)
            .map(|index| sliver(width, 0, index))
            .filter_map(|case| Shear::new(&case.ray)?.decide(&case.triangle))
            .collect();
        assert!(20_000 - hits.len() <= most_missed, "width {width}: {} hits", hits.len());
        let worst = hits.iter().map(|hit| (hit.t - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst <= 1e-11, "width {width}: t off by {worst:e}");
    }
}
