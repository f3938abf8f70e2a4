//! Samples have the stated densities: chi-square tests over cells of equal probability, and comparisons of
//! densities.

use glam::{DVec3, Vec3};
use globillum::geom::{Frame, Triangle};
use globillum::integrator::Stream;
use globillum::material::warp::CosineHemisphere;
use globillum::material::{Bsdf, Density, Reflectance, Rgb};
use globillum_testkit::chi_square::ChiSquare;
use globillum_testkit::stats::Z_LIMIT;

/// Enough draws to detect a ripple of 1 % with a probability of 99.9 %.
const DRAWS: u32 = 1_650_000;

fn draws() -> impl Iterator<Item = [f64; 2]> {
    (0..DRAWS).map(|i| Stream::new(11, 0, i).uniform_pair(0))
}

fn assert_even(cells: impl Iterator<Item = usize>, what: &str) {
    let mut counts = [0; 64];
    cells.for_each(|cell| counts[cell] += 1);
    ChiSquare::of_equal_cells(&counts).assert_fits(what);
}

/// The eighth in which a fraction lies.
fn eighth(x: f64) -> usize {
    ((x * 8.0) as usize).min(7)
}

#[test]
fn lambert_samples_are_cosine_distributed_on_both_sides() {
    let bsdf = Bsdf::Lambert(Reflectance::new(Rgb::splat(0.5)).expect("below one"));
    for wo in [DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, -0.8, -0.6)] {
        let cells = draws().map(|u| {
            let wi = bsdf.sample(wo, u).expect("it reflects").wi;
            assert!(wi.z * wo.z > 0.0, "{wo} {wi}");
            // Equal steps of the squared sine and of the azimuth have equal shares.
            let turn = wi.y.atan2(wi.x) / std::f64::consts::TAU;
            8 * eighth(wi.x * wi.x + wi.y * wi.y) + eighth(turn.rem_euclid(1.0))
        });
        assert_even(cells, &format!("wo = {wo}"));
    }
}

#[test]
fn triangles_are_sampled_uniformly() {
    let cells = draws().map(|u| {
        let (u, v) = Triangle::sample_uniform(u);
        sub_triangle(u, v, 3)
    });
    assert_even(cells, "barycentrics");
}

/// The index of the part of the triangle that contains a point. Each of `cuts` subdivisions divides every
/// part into four equal ones: three at the corners, one in the middle.
fn sub_triangle(u: f64, v: f64, cuts: u32) -> usize {
    let (mut u, mut v, mut index) = (u, v, 0);
    for _ in 0..cuts {
        (u, v) = (2.0 * u, 2.0 * v);
        let part = if u >= 1.0 {
            u -= 1.0;
            1
        } else if v >= 1.0 {
            v -= 1.0;
            2
        } else if u + v <= 1.0 {
            0
        } else {
            (u, v) = (1.0 - u, 1.0 - v);
            3
        };
        index = 4 * index + part;
    }
    index
}

/// Random numbers of 0, the least positive one and the greatest below 1 give usable points.
#[test]
fn random_numbers_at_the_ends_of_their_range_are_usable() {
    let ends = [0.0, 5e-324, 1.0_f64.next_down()];
    for u in ends.into_iter().flat_map(|a| ends.map(|b| [a, b])) {
        let w = CosineHemisphere::sample(u);
        assert!(w.z > 0.0 && CosineHemisphere::pdf(w).0 > 0.0 && w.is_finite(), "{u:?}: {w}");
        let (b1, b2) = Triangle::sample_uniform(u);
        let b0 = 1.0 - b1 - b2;
        assert!([b1, b2].iter().all(|b| (0.0..=1.0).contains(b)) && b0 >= -f64::EPSILON, "{u:?}");
    }
}

#[test]
fn densities_are_those_of_the_samples() {
    let bsdf = Bsdf::Lambert(Reflectance::new(Rgb::splat(0.5)).expect("below one"));
    let wo = DVec3::new(0.48, 0.6, 0.64);
    for (u, wo) in draws().take(10_000).flat_map(|u| [(u, wo), (u, -wo)]) {
        let sample = bsdf.sample(wo, u).expect("it reflects");
        let Density::SolidAngle(sampled) = sample.density else { panic!("{sample:?} is a delta") };
        let evaluated = bsdf.pdf(wo, sample.wi);
        assert!((evaluated.0 / sampled.0 - 1.0).abs() < 1e-12, "{sample:?}: {evaluated:?}");
    }
}

/// Quadrature at the midpoints of cells of equal area of the hemisphere.
#[test]
fn the_density_of_a_direction_integrates_to_one() {
    let bsdf = Bsdf::Lambert(Reflectance::new(Rgb::splat(0.5)).expect("below one"));
    let (rings, turns) = (1000, 16);
    let mut integral = 0.0;
    for (i, j) in (0..rings).flat_map(|i| (0..turns).map(move |j| (i, j))) {
        let z = (f64::from(i) + 0.5) / f64::from(rings);
        let (sin, cos) = (std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(turns)).sin_cos();
        let r = (1.0 - z * z).sqrt();
        integral += bsdf.pdf(DVec3::Z, DVec3::new(r * cos, r * sin, z)).0;
    }
    integral *= std::f64::consts::TAU / f64::from(rings * turns);
    assert!((integral - 1.0).abs() < 1e-6, "{integral}");
}

/// An area density, converted to solid angle, integrates to one over the directions to the triangle. The mean
/// of its inverse over samples is therefore the solid angle (Van Oosterom and Strackee 1983).
#[test]
fn a_light_sample_s_density_has_the_right_measure() {
    let triangle =
        Triangle::new(Vec3::new(-1.0, 2.0, 0.3), Vec3::new(1.5, 2.5, -0.2), Vec3::new(0.2, 1.5, 1.4));
    let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    let solid_angle = 2.0 * a.dot(b.cross(c)).abs().atan2(below);
    let (mut sum, mut sum_sq) = (0.0, 0.0);
    for u in draws().take(400_000) {
        let (u, v) = Triangle::sample_uniform(u);
        let p = a + u * (b - a) + v * (c - a);
        let cos = triangle.normal().dot(p.normalize());
        let pdf = triangle.pdf_uniform().to_solid_angle(p.length_squared(), cos).expect("it is seen");
        sum += 1.0 / pdf.0;
        sum_sq += 1.0 / (pdf.0 * pdf.0);
    }
    let n = 400_000.0;
    let (mean, std_err) = (sum / n, ((sum_sq / n - (sum / n).powi(2)) / n).sqrt());
    assert!((mean - solid_angle).abs() < Z_LIMIT * std_err, "{mean} +- {std_err}, not {solid_angle}");
    assert!(Z_LIMIT * std_err < 0.005 * solid_angle);
}

#[test]
fn frames_do_not_change_densities() {
    for u in draws().take(1000) {
        let normal = CosineHemisphere::sample(u);
        let w = CosineHemisphere::sample([u[1], u[0]]);
        let back = Frame::around(normal).to_local(Frame::around(normal).to_world(w));
        assert!((CosineHemisphere::pdf(back).0 - CosineHemisphere::pdf(w).0).abs() < 1e-14);
    }
}
