//! Solid angle sampling of triangles: density, closed forms, inversion, and the cases that are left to area
//! sampling.

use glam::{DVec3, Vec3};
use globillum::geom::{SphericalTriangle, Triangle};
use globillum::integrator::Stream;
use globillum_testkit::chi_square::ChiSquare;
use globillum_testkit::stats::Estimate;

/// Enough draws to detect a ripple of 2 % with a probability of 99.9 %.
const DRAWS: u32 = 600_000;

fn draws(count: u32) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(|i| Stream::new(12, 0, i).uniform_pair(0))
}

const PLAIN: Triangle =
    Triangle::new(Vec3::new(-1.0, 2.0, 0.3), Vec3::new(1.5, 2.5, -0.2), Vec3::new(0.2, 1.5, 1.4));

/// A needle whose longest side is 200 times its height.
const NEEDLE: Triangle =
    Triangle::new(Vec3::new(-1.0, 1.0, 0.0), Vec3::new(0.3, 1.0, 0.01), Vec3::new(1.0, 1.0, 0.0));

/// The point of `triangle` with barycentrics `(u, v)`, moved by `height` along its normal.
fn above(triangle: &Triangle, (u, v): (f64, f64), height: f64) -> DVec3 {
    let [e1, e2] = triangle.edges();
    triangle.vertices[0].as_dvec3() + u * e1 + v * e2 + height * triangle.normal()
}

/// Triangles and points: far away, beside an edge and a vertex, very close to the interior, at a grazing
/// angle, and behind; a needle of a small solid angle whose longest side looks long.
fn views() -> [(Triangle, DVec3); 10] {
    [
        (PLAIN, DVec3::ZERO),
        (PLAIN, DVec3::new(-1.0, 5.0, 1.0)),
        (PLAIN, above(&PLAIN, (0.5, 0.5), 1e-4)),
        (PLAIN, above(&PLAIN, (0.0, 0.7), 1e-6)),
        (PLAIN, above(&PLAIN, (1.0, 0.0), -1e-4)),
        (PLAIN, above(&PLAIN, (0.2, 0.3), 1e-3)),
        (PLAIN, above(&PLAIN, (1.1, -0.4), 0.3)),
        (NEEDLE, above(&NEEDLE, (0.2, 0.2), -0.03)),
        (NEEDLE, DVec3::ZERO),
        (NEEDLE, DVec3::new(-1.3, 0.2, 0.1)),
    ]
}

/// The solid angle of three directions, which need not be unit vectors (Van Oosterom and Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).abs().atan2(below)
}

/// The index of the part that contains the point `(u, v)`, of 64 parts of equal solid angle: eight sectors
/// bounded by arcs from vertex `apex`, with eight steps along these arcs.
fn cell(corners: [DVec3; 3], apex: usize, (u, v): (f64, f64)) -> usize {
    let weights = [1.0 - u - v, u, v];
    let [a, b, c] = [0, 1, 2].map(|i| corners[(apex + i) % 3]);
    let [wa, wb, wc] = [0, 1, 2].map(|i| weights[(apex + i) % 3]);
    let end = wb * b + wc * c;
    let part = solid_angle([a, b, end]) / solid_angle([a, b, c]);
    let height = |to: DVec3| a.normalize().distance_squared(to.normalize());
    let along = height(wa * a + end) / height(end);
    let eighth = |x: f64| ((x * 8.0) as usize).min(7);
    8 * eighth(part) + eighth(along)
}

#[test]
fn directions_are_uniform_in_cells_around_each_vertex() {
    for (i, (triangle, origin)) in views().into_iter().enumerate() {
        let corners = triangle.vertices.map(|v| v.as_dvec3() - origin);
        let spherical = SphericalTriangle::new(&triangle, origin).expect("it is large enough");
        let expected = solid_angle(corners);
        assert!((spherical.solid_angle() / expected - 1.0).abs() < 1e-9, "view {i}: {expected}");
        let mut counts = [[0; 64]; 3];
        for u in draws(DRAWS) {
            let point = spherical.sample(u);
            for apex in 0..3 {
                counts[apex][cell(corners, apex, point)] += 1;
            }
        }
        for (apex, counts) in counts.iter().enumerate() {
            ChiSquare::of_equal_cells(counts).assert_fits(&format!("view {i}, vertex {apex}"));
        }
    }
}

/// The integral of the cosine over a polygon above the horizon: half the sum over its sides of the subtended
/// angle times the cosine of the angle between the normals of the side's plane and of the receiver (Lambert
/// 1760).
fn projected(corners: [DVec3; 3], normal: DVec3) -> f64 {
    let side = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        a.angle_between(b) * a.cross(b).normalize().dot(normal)
    };
    (0.5 * (0..3).map(side).sum::<f64>()).abs()
}

#[test]
fn their_cosines_have_the_mean_of_lamberts_formula() {
    for (i, (triangle, origin)) in views().into_iter().enumerate() {
        let corners = triangle.vertices.map(|v| v.as_dvec3() - origin);
        // The triangle's normal on the side away from the point, so that the whole triangle is above the
        // horizon.
        let normal = triangle.normal() * triangle.normal().dot(corners[0]).signum();
        let spherical = SphericalTriangle::new(&triangle, origin).expect("it is large enough");
        let samples = draws(DRAWS).map(|u| {
            let (u, v) = spherical.sample(u);
            let to = above(&triangle, (u, v), 0.0) - origin;
            to.normalize().dot(normal) / spherical.pdf().0
        });
        let (count, sum, sum_sq) =
            samples.fold((0.0, 0.0, 0.0), |(n, sum, square), x| (n + 1.0, sum + x, square + x * x));
        let mean = sum / count;
        let std_err = ((sum_sq / count - mean * mean).max(0.0) / count).sqrt();
        let truth = projected(corners, normal);
        Estimate { mean, std_err, count }.assert_is(truth, &format!("view {i}"));
    }
}

#[test]
fn samples_and_random_numbers_are_one_to_one() {
    let ends = [0.0, 5e-324, 0.5, 1.0_f64.next_down()];
    for (i, (triangle, origin)) in views().into_iter().enumerate() {
        let spherical = SphericalTriangle::new(&triangle, origin).expect("it is large enough");
        for u in draws(10_000).chain(ends.into_iter().flat_map(|a| ends.map(|b| [a, b]))) {
            let (b1, b2) = spherical.sample(u);
            assert!(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0 + 2.0 * f64::EPSILON, "view {i}: {u:?}");
            let [x, y] = spherical.invert(b1, b2);
            // At the vertex where all arcs begin, the first number is undetermined.
            let at_vertex = u[1] < 1e-12;
            assert!((y - u[1]).abs() < 1e-8 && (at_vertex || (x - u[0]).abs() < 1e-8), "view {i}: {u:?}");
        }
    }
}

/// The result is `None` beyond the reach of a triangle, and not always within: needles and round triangles of
/// any size.
#[test]
fn triangles_beyond_their_reach_are_refused() {
    let (mut beyond, mut within, mut large) = (0, 0, 0);
    for i in 0..200_000 {
        let numbers = Stream::new(13, 0, i);
        let signed = |dimension: u32| 2.0 * numbers.uniform(dimension) - 1.0;
        let vector = |first: u32| DVec3::new(signed(first), signed(first + 1), signed(first + 2));
        let scale = 10.0_f64.powf(8.0 * signed(20));
        let thin = 10.0_f64.powf(-5.0 * numbers.uniform(21));
        let [a, b] = [vector(0), vector(3)];
        // The third vertex is near the first side, or near its end.
        let along = [numbers.uniform(22), 1.0][i as usize / 2 % 2];
        let vertices = [a, b, a + along * (b - a) + thin * vector(6)];
        let triangle = Triangle { vertices: vertices.map(|v| (scale * v).as_vec3()) };
        let middle = triangle.vertices.iter().map(|v| v.as_dvec3()).sum::<DVec3>() / 3.0;
        let reach = SphericalTriangle::reach(&triangle);
        // Half of the points are very close to the triangle near its first vertex, which may be a needle's tip.
        let at_tip = 10.0_f64.powf(-3.0 * numbers.uniform(24));
        let height = at_tip * thin * scale * 10.0_f64.powf(-3.0 * numbers.uniform(25));
        let near = above(&triangle, (0.5 * at_tip, 0.5 * at_tip), height);
        let around = middle + reach * (0.3 + 1.4 * numbers.uniform(23)) * vector(9).normalize();
        let from = if i % 2 == 0 { near } else { around };
        let distance = from.distance(middle);
        let seen = SphericalTriangle::new(&triangle, from).is_some();
        if distance > reach {
            assert!(!seen, "{triangle:?} from {distance} of {reach}");
            beyond += 1;
        } else {
            within += 1;
            large += u32::from(seen);
        }
    }
    assert!(beyond > 30_000 && within > 50_000 && large > within / 20, "{beyond} {within} {large}");
}

/// Distant lights, points in a light's plane or on it, and other cases too ill-conditioned for solid angles.
#[test]
fn ill_conditioned_cases_are_left_to_area_sampling() {
    let at = |u: f64, v: f64, height: f64| above(&PLAIN, (u, v), height);
    let [a, b, c] = PLAIN.vertices.map(|v| v.as_dvec3());
    let cases = [
        ("far away", at(0.3, 0.3, 1e3)),
        ("farther than any scene", at(0.3, 0.3, 1e18)),
        ("in its plane", a + 2.0 * (b - a) + 2.0 * (c - a)),
        ("nearly in its plane", at(2.0, 2.0, 1e-12)),
        ("a vertex", b),
        ("on an edge", a + 0.5 * (b - a)),
        ("on it", a + 0.25 * (b - a) + 0.25 * (c - a)),
        ("very close to it", at(0.25, 0.25, 1e-12)),
        ("very close to an edge", at(0.5, 0.0, 1e-12)),
        ("not a number", DVec3::NAN),
        ("infinitely far", DVec3::INFINITY),
    ];
    for (what, origin) in cases {
        assert_eq!(SphericalTriangle::new(&PLAIN, origin), None, "{what}");
    }
    let flat = Triangle::new(Vec3::ZERO, Vec3::X, 2.0 * Vec3::X);
    assert_eq!(SphericalTriangle::new(&flat, DVec3::Y), None);
}

/// Every accepted case gives valid samples that can be inverted: random triangles of any shape, seen from
/// points concentrated near their vertices, edges and planes.
#[test]
fn accepted_cases_give_valid_samples() {
    let mut accepted = 0;
    for i in 0..100_000_u32 {
        let random = Stream::new(13, 0, i);
        let small = |dimension: u32| 10.0_f64.powf(-14.0 * random.uniform(dimension));
        let signed = |dimension: u32| 2.0 * random.uniform(dimension) - 1.0;
        let corner = |first: u32, scale: f64| {
            let scaled = |d: u32| scale * signed(first + d);
            DVec3::new(scaled(0), scaled(1), scaled(2)).as_vec3()
        };
        let first = corner(0, 1.0);
        let triangle = Triangle::new(first, first + corner(3, small(9)), first + corner(6, small(10)));
        let barycentrics = (signed(11) * small(12), signed(13).powi(3));
        let origin = above(&triangle, barycentrics, signed(14) * small(15));
        let Some(spherical) = SphericalTriangle::new(&triangle, origin) else { continue };
        accepted += 1;
        for u in (0..8).map(|j| random.uniform_pair(20 + 2 * j)) {
            let (b1, b2) = spherical.sample(u);
            assert!(b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0 + 2.0 * f64::EPSILON, "{triangle:?} {origin}");
            let back = spherical.invert(b1, b2);
            let error = (back[0] - u[0]).abs().max((back[1] - u[1]).abs());
            assert!(error < 1e-6, "{triangle:?} {origin}: {u:?}, {back:?}");
        }
    }
    assert!(accepted > 5000, "{accepted}");
}
