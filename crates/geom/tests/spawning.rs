//! Rays and segments that leave surfaces: they meet other triangles, and never the surface that they leave. The rays of
//! all tests but the last exclude no triangle, so the offset of their ends alone keeps them off the surface.
//!
//! `GLOBILLUM_EFFORT` multiplies the number of rays; 10 makes it a million of each kind.

use glam::{DQuat, DVec3, Vec3};
use globillum_geom::conformance::shapes::{cuboid, icosphere, quad};
use globillum_geom::conformance::{Seeded, Source};
use globillum_geom::{Frame, Hit, Ray, Triangle, Triangles};

use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::effort;
use std::f64::consts::TAU;

/// Sizes of scenes.
const SIZES: [f64; 5] = [1e-6, 1e-3, 1.0, 1e3, 1e6];

/// A number in `(0, 1]`.
fn positive(source: &mut Seeded) -> f64 {
    1.0 - source.unit()
}

/// A power of ten with an exponent between `lo` and `hi`.
fn magnitude(source: &mut Seeded, lo: f64, hi: f64) -> f64 {
    10_f64.powf(lo + (hi - lo) * source.unit())
}

/// A whole number from `-reach` to `reach`.
fn whole(source: &mut Seeded, reach: i32) -> f64 {
    f64::from(source.below(2 * reach as usize + 1) as i32 - reach)
}

/// A point of the cube of half side 1.
fn in_cube(source: &mut Seeded) -> DVec3 {
    DVec3::new(source.signed(), source.signed(), source.signed())
}

/// A direction on the side of the unit vector `normal`: spread evenly, by the cosine, or nearly
/// along the surface. At `1e-12` above it, rounding cannot yet turn a direction to the other
/// side.
fn leaving(source: &mut Seeded, normal: DVec3) -> DVec3 {
    let height = match source.below(3) {
        0 => positive(source),
        1 => positive(source).sqrt(),
        _ => magnitude(source, -12.0, 0.0),
    };
    let (radius, angle) = ((1.0 - height * height).sqrt(), TAU * source.unit());
    Frame::around(normal).to_world(DVec3::new(radius * angle.cos(), radius * angle.sin(), height))
}

/// Barycentrics of a vertex or of a point on an edge, with an exact zero among them.
fn on_border(source: &mut Seeded) -> [f64; 2] {
    let s = source.unit();
    source.pick(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [s, 0.0], [0.0, s], [s, 1.0 - s]])
}

/// Barycentrics of any point, a vertex or a point on an edge now and then.
fn on_triangle(source: &mut Seeded) -> [f64; 2] {
    if source.one_in(3) {
        return on_border(source);
    }
    let (u, v) = Triangle::sample_uniform([source.unit(), source.unit()]);
    [u, v]
}

fn excluding_none(ray: Ray) -> Ray {
    ray.excluding([Ray::NO_TRIANGLE; 2])
}

/// A ray and the triangle that it leaves.
struct Departure {
    ray: Ray,
    from: usize,
}

/// Asserts that every one of `departures` is answered right in every accelerator.
fn assert_all(
    triangles: &[Triangle],
    departures: &[Departure],
    right: impl Fn(&Departure, Option<Hit>) -> bool,
    what: &str,
) {
    let triangles = Triangles::new(triangles.to_vec()).expect("the triangles are good");
    for (name, build) in ACCELERATORS {
        // Every triangle for every ray takes too long for more than a few.
        if name == "brute force" && triangles.len() > 100 {
            continue;
        }
        let accel = build(&triangles).expect("the accelerator can be built");
        let wrong = || departures.iter().filter(|&d| !right(d, accel.intersect(&d.ray)));
        let first = wrong().next().map(|d| (d.from, d.ray, accel.intersect(&d.ray)));
        assert_eq!(wrong().count(), 0, "{what}, {name}, of {}: {first:?}", departures.len());
    }
}

/// The tetrahedra in which corners are: `size` times their shape, faces outward.
fn tetrahedra(size: f32) -> [Vec<Triangle>; 2] {
    let v = |x, y, z| Vec3::new(x, y, z) * size;
    let corner = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)];
    let regular = [v(1.0, 1.0, 1.0), v(-1.0, 1.0, -1.0), v(1.0, -1.0, -1.0), v(-1.0, -1.0, 1.0)];
    [corner, regular].map(|v| {
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        faces.map(|f| Triangle::new(v[f[0]], v[f[1]], v[f[2]])).to_vec()
    })
}

/// The barycentrics of a point at `distance` from a random edge of `triangle`.
fn near_an_edge(source: &mut Seeded, triangle: &Triangle, distance: f64) -> [f64; 2] {
    let opposite = source.below(3);
    let [b, c] = [1, 2].map(|i| triangle.vertices[(opposite + i) % 3].as_dvec3());
    let height = 2.0 * triangle.area() / b.distance(c);
    let (weight, along) = (distance / height, source.unit());
    let mut weights = [weight; 3];
    weights[(opposite + 1) % 3] = (1.0 - weight) * along;
    weights[(opposite + 2) % 3] = (1.0 - weight) * (1.0 - along);
    [weights[1], weights[2]]
}

#[test]
fn no_ray_escapes_from_the_edges_inside_a_tetrahedron() {
    let mut source = Seeded::new(48);
    for size in SIZES {
        for faces in tetrahedra(size as f32) {
            let scene = Triangles::new(faces.to_vec()).expect("a tetrahedron is good");
            let mut depart = || {
                let from = source.below(4);
                let distance = size * magnitude(&mut source, -14.0, -1.0);
                let [u, v] = near_an_edge(&mut source, &faces[from], distance);
                let point = scene.surface_point(from as u32, u, v);
                Departure { ray: excluding_none(point.spawn_ray(leaving(&mut source, -point.normal))), from }
            };
            let departures: Vec<_> = (0..10_000 * effort() as usize).map(|_| depart()).collect();
            let lands = |d: &Departure, hit: Option<Hit>| hit.is_some_and(|h| h.triangle as usize != d.from);
            assert_all(&faces, &departures, lands, &format!("size {size}"));
        }
    }
}

/// Asserts that rays that leave `triangles` outward, from points that these share, meet nothing.
fn assert_none_returns(source: &mut Seeded, triangles: &[Triangle], count: usize, what: &str) {
    let scene = Triangles::new(triangles.to_vec()).expect("the triangles are good");
    let mut depart = || {
        let from = source.below(triangles.len());
        let [u, v] = on_border(source);
        let point = scene.surface_point(from as u32, u, v);
        Departure { ray: excluding_none(point.spawn_ray(leaving(source, point.normal))), from }
    };
    let departures: Vec<_> = (0..count).map(|_| depart()).collect();
    assert_all(triangles, &departures, |_, hit| hit.is_none(), what);
}

#[test]
fn rays_leave_the_edges_and_vertices_of_boxes() {
    let mut source = Seeded::new(490);
    // Parallel to the axes, a box of any `f32` corners has plane faces.
    for _ in 0..400 {
        let size = magnitude(&mut source, -6.0, 6.0);
        let center = in_cube(&mut source) * (100.0 * size * source.unit());
        let half = in_cube(&mut source).abs() * size;
        let what = format!("a box around {center}, {half}");
        assert_none_returns(&mut source, &cuboid(center, half, 0.0), 100 * effort() as usize, &what);
    }
}

#[test]
fn rays_leave_the_edges_and_vertices_of_a_ball() {
    let mut source = Seeded::new(491);
    for size in SIZES {
        let ball = icosphere(4).placed(size, DVec3::ZERO).triangles();
        assert_none_returns(&mut source, &ball, 6_000 * effort() as usize, &format!("size {size}"));
    }
}

/// Two triangles on either side of an edge, exactly in one plane: sums of whole multiples of two
/// vectors of whole numbers are exact in `f32`.
fn coplanar_neighbours(source: &mut Seeded) -> [Triangle; 2] {
    let far = source.below(21);
    let mut vector = |reach| DVec3::from([0; 3].map(|_| whole(source, reach)));
    let (origin, a, b) = (vector(1 << far), vector(50), vector(50));
    let scale = 2_f64.powf(whole(source, 38));
    let mut beside = |side| {
        let (i, j) = (whole(source, 100), side * (1.0 + source.below(1000) as f64));
        origin + i * a + j * b
    };
    let (left, right) = (beside(1.0), beside(-1.0));
    let at = |p: DVec3| (p * scale).as_vec3();
    [[origin, origin + a, left], [origin + a, origin, right]].map(|t| Triangle { vertices: t.map(at) })
}

#[test]
fn rays_leave_the_edges_and_vertices_of_a_plane() {
    let mut source = Seeded::new(492);
    for _ in 0..1_500 {
        let sheet = coplanar_neighbours(&mut source);
        if !sheet.iter().any(Triangle::is_degenerate) {
            assert_none_returns(&mut source, &sheet, 20 * effort() as usize, &format!("{sheet:?}"));
        }
    }
}

/// Whether all of `points` lie strictly on one side of the plane of `triangle`, decided exactly.
fn strictly_on_one_side(triangle: &Triangle, points: &Triangle) -> bool {
    let coord = |v: Vec3| robust::Coord3D { x: v.x, y: v.y, z: v.z };
    let [a, b, c] = triangle.vertices.map(coord);
    let sides = points.vertices.map(|p| robust::orient3d(a, b, c, coord(p)));
    sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0)
}

/// Two triangles, near one plane or not, of which neither can come between points of both.
fn apart(source: &mut Seeded, size: f64) -> [Triangle; 2] {
    loop {
        let flatness = source.pick(&[1.0, 1.0, 1e-2, 1e-4, 1e-6]);
        let turn = DQuat::from_rotation_arc(DVec3::Y, in_cube(source).normalize());
        let center = in_cube(source) * source.pick(&[0.0, 10.0]);
        let mut vertex = || {
            let v = in_cube(source) * DVec3::new(1.0, flatness, 1.0);
            (size * (center + turn * v)).as_vec3()
        };
        let pair = [0, 1].map(|_| Triangle::new(vertex(), vertex(), vertex()));
        if strictly_on_one_side(&pair[0], &pair[1]) && strictly_on_one_side(&pair[1], &pair[0]) {
            return pair;
        }
    }
}

#[test]
fn two_triangles_apart_never_shade_each_other() {
    let mut source = Seeded::new(50);
    let mut count = 0;
    for size in SIZES {
        for _ in 0..2_000 * effort() as usize {
            let pair = apart(&mut source, size);
            let triangles = Triangles::new(pair.to_vec()).expect("the triangles are good");
            let mut point = |index| {
                let [u, v] = on_triangle(&mut source);
                triangles.surface_point(index, u, v)
            };
            let segments: Vec<Ray> =
                (0..10).filter_map(|_| point(0).segment_to(&point(1))).map(excluding_none).collect();
            count += segments.len();
            for (name, build) in ACCELERATORS {
                let accel = build(&triangles).expect("the accelerator can be built");
                let shaded = segments.iter().find(|segment| accel.occluded(segment));
                assert_eq!(shaded, None, "{name}, {pair:?}");
            }
        }
    }
    assert!(count > 10_000 * SIZES.len() * effort() as usize, "{count}");
}

/// From next to the surface to a million times its size away.
#[test]
fn a_surface_does_not_shade_itself_from_a_point() {
    let mut source = Seeded::new(502);
    let mut count = 0;
    for size in SIZES {
        for _ in 0..500 * effort() as usize {
            let center = size * in_cube(&mut source);
            let triangle = triangle_around(&mut source, center, size);
            let triangles = Triangles::new(vec![triangle]).expect("the triangle is good");
            if triangles.live().is_empty() {
                continue;
            }
            let [u, v] = on_triangle(&mut source);
            let at = triangles.surface_point(0, u, v);
            assert_eq!(at.segment_to_position(at.position), None);
            let distance = size * magnitude(&mut source, -12.0, 6.0);
            let position = at.position + leaving(&mut source, at.normal) * distance * whole(&mut source, 1);
            let Some(segment) = at.segment_to_position(position).map(excluding_none) else { continue };
            count += 1;
            assert_eq!((segment.t_min, segment.t_max), (0.0, 1.0));
            let rounding = 4.0 * f64::EPSILON * (position.abs() + segment.origin.abs());
            assert!((segment.at(1.0) - position).abs().cmple(rounding).all(), "{position}, {segment:?}");
            let height = |point: DVec3| at.normal.dot(point - at.position);
            assert!(height(segment.origin) * height(position) > 0.0, "{position}, {segment:?}");
            for (name, build) in ACCELERATORS {
                let accel = build(&triangles).expect("the accelerator can be built");
                assert!(!accel.occluded(&segment), "{name}, {triangle:?}, {segment:?}");
            }
        }
    }
    assert!(count > 1000 * effort() as usize, "{count}");
}

/// A triangle of half `size` around `center`, facing anywhere.
fn triangle_around(source: &mut Seeded, center: DVec3, size: f64) -> Triangle {
    let mut vertex = || (center + size * in_cube(source)).as_vec3();
    Triangle::new(vertex(), vertex(), vertex())
}

/// What the decision may be off grows with the distance from which a triangle is seen.
#[test]
fn a_small_triangle_far_away_does_not_shade_itself() {
    let mut source = Seeded::new(501);
    let mut count = 0;
    for (ratio, distance) in
        [1.0, 1e-1, 1e-3, 1e-6].into_iter().flat_map(|r| [3.0, 10.0, 1e2, 1e4, 1e6].map(|d| (r, d)))
    {
        for _ in 0..300 * effort() as usize {
            let toward = in_cube(&mut source).normalize() * distance;
            // Where it is small, it is at the origin: elsewhere f32 could not hold it.
            let [small, large] = [(DVec3::ZERO, ratio), (toward, 1.0)]
                .map(|(center, size)| triangle_around(&mut source, center, size));
            if !strictly_on_one_side(&small, &large) || !strictly_on_one_side(&large, &small) {
                continue;
            }
            let triangles = Triangles::new(vec![small, large]).expect("the triangles are good");
            let mut point = |index| {
                let [u, v] = on_triangle(&mut source);
                triangles.surface_point(index, u, v)
            };
            let (a, b) = (point(0), point(1));
            count += usize::from(a.segment_to(&b).is_some());
            for (name, build) in ACCELERATORS {
                let accel = build(&triangles).expect("the accelerator can be built");
                for segment in [a.segment_to(&b), b.segment_to(&a)].into_iter().flatten().map(excluding_none)
                {
                    assert!(!accel.occluded(&segment), "{name}, {small:?}, {large:?}, {segment:?}");
                }
            }
        }
    }
    assert!(count > 1000 * effort() as usize, "{count}");
}

/// A lamp `2 a` by `2 b` in the middle of a ceiling three times as large, in one plane to the bit, and with
/// `in_front` a plate half as large again as the lamp at that part of the ceiling's extent along `a x b`.
fn lamp_in_ceiling([a, b]: [DVec3; 2], in_front: Option<f64>) -> Triangles {
    let around =
        |by: f64, at: DVec3| quad(at - by * (a + b), at + by * (a - b), at + by * (a + b), at - by * (a - b));
    let ceiling = around(3.0, DVec3::ZERO);
    let extent = ceiling[0].bounds().union(&ceiling[1].bounds()).extent().max_element();
    let off = |part: f64| around(1.5, part * extent * a.cross(b).normalize());
    let all = around(1.0, DVec3::ZERO).into_iter().chain(ceiling).chain(in_front.into_iter().flat_map(off));
    Triangles::new(all.collect()).expect("the triangles are good")
}

/// The segments from points `times` the scene's extent away to the lamp's triangles, the first two, for `count` points
/// at least `height` times their distance in front of its plane.
fn segments_from_afar(triangles: &Triangles, times: f64, height: f64, count: usize) -> Vec<Ray> {
    let mut source = Seeded::new(504);
    let normal = triangles.get(0).normal();
    let distance = times * triangles.bounds().extent().max_element();
    let segments = (0..count).filter_map(|i| {
        let [u, v] = on_triangle(&mut source);
        let lamp = triangles.surface_point(i as u32 % 2, u, v);
        let away = loop {
            let away = leaving(&mut source, normal);
            if away.dot(normal) >= height {
                break away;
            }
        };
        triangles.given_point(distance * away, -away).segment_to(&lamp).map(excluding_none)
    });
    segments.collect()
}

/// A given point may lie far outside the scene, where a decision is off by more than in the scene.
#[test]
fn what_shares_a_lamps_plane_does_not_shade_it_from_far_away() {
    let (axes, oblique) = ([DVec3::Z, DVec3::X], [DVec3::new(1.0, 2.0, 2.0), DVec3::new(2.0, 1.0, -2.0)]);
    for sides in [axes, oblique] {
        let [open, covered] = [None, Some(1e-4)].map(|in_front| lamp_in_ceiling(sides, in_front));
        for times in [1.0, 30.0, 100.0, 1000.0, 1e6, 1e9] {
            let count = 3000 * effort() as usize;
            let free = segments_from_afar(&open, times, 0.0, count);
            let blocked = segments_from_afar(&covered, times, 0.01, count);
            assert!(free.len() > count / 2 && blocked.len() == count, "{} and {}", free.len(), blocked.len());
            for (name, build) in ACCELERATORS {
                let [open, covered] =
                    [&open, &covered].map(|t| build(t).expect("the accelerator can be built"));
                let shaded = free.iter().filter(|segment| open.occluded(segment)).count();
                assert_eq!(shaded, 0, "{name}, {sides:?}, {times} times the extent, of {count}");
                let lit = blocked.iter().filter(|segment| !covered.occluded(segment)).count();
                assert_eq!(lit, 0, "{name}, {sides:?}, {times} times the extent, of {count}");
            }
        }
    }
}

#[test]
fn rays_exclude_the_triangles_at_their_ends() {
    let mut source = Seeded::new(503);
    let [triangles, _] = tetrahedra(1.0).map(|faces| Triangles::new(faces).expect("a tetrahedron is good"));
    let mut count = 0;
    for _ in 0..1000 {
        let (from, to) = (source.below(4) as u32, source.below(4) as u32);
        let mut point = |index| {
            let [u, v] = on_triangle(&mut source);
            triangles.surface_point(index, u, v)
        };
        let (a, b) = (point(from), point(to));
        let ray = a.spawn_ray(leaving(&mut source, a.normal));
        assert_eq!(ray.excluded, [from, Ray::NO_TRIANGLE]);
        let segment =
            a.segment_to_position(b.position + 0.1 * in_cube(&mut source)).expect("it is off the plane");
        assert_eq!(segment.excluded, [from, Ray::NO_TRIANGLE]);
        let Some(segment) = a.segment_to(&b) else { continue };
        count += 1;
        assert_eq!(segment.excluded, [from, to]);
        assert!(segment.excludes(from) && segment.excludes(to) && !segment.excludes(Ray::NO_TRIANGLE - 1));
    }
    assert!(count > 400, "{count}");
    let given = triangles.given_point(DVec3::ONE, DVec3::Z).spawn_ray(DVec3::Z);
    assert_eq!(given, excluding_none(given));
}
