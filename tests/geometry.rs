//! Boxes, frames, triangles, densities and counts of work: what the crate geom promises of single values.

use glam::{DVec3, Vec3};
use globillum::geom::{
    Aabb, BruteForce, Counts, Frame, GridOptions, KdOptions, KdTree, PdfArea, PdfSolidAngle, Ray, SplitRule,
    Triangle, Triangles, UniformGrid,
};
use globillum::integrator::Stream;
use globillum_testkit::shapes::{Mesh, icosphere, statue, torus};
use std::collections::HashMap;
use std::f64::consts::TAU;

const CORNER: Triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);

#[test]
fn the_empty_box_is_neutral() {
    let cube = Aabb::around([Vec3::ZERO, Vec3::ONE]);
    assert!(Aabb::EMPTY.is_empty() && !cube.is_empty());
    assert_eq!(cube.union(&Aabb::EMPTY), cube);
    assert_eq!((Aabb::EMPTY.half_area(), cube.half_area()), (0.0, 3.0));
    assert!(cube.intersection(&Aabb::around([Vec3::splat(2.0)])).is_empty());
}

#[test]
fn the_domain_of_rays_ends_at_powers_of_two() {
    let [low, high] = [Ray::DIRECTION_DOMAIN.start(), Ray::DIRECTION_DOMAIN.end()];
    assert_eq!((Ray::MAX_ORIGIN, *low, *high), (2.0_f64.powi(300), 2.0_f64.powi(-600), 2.0_f64.powi(600)));
}

#[test]
#[should_panic(expected = "the len is 3 but the index is 3")]
fn a_face_without_a_vertex_panics() {
    let _ = Triangle::indexed(&CORNER.vertices, &[[0, 1, 2], [1, 2, 3]]).count();
}

#[test]
fn frames_are_orthonormal_and_right_handed() {
    let poles = [DVec3::Z, -DVec3::Z, DVec3::new(0.0, 0.0, -1.0)];
    let others = (0..10_000).map(|i| {
        let [a, b] = Stream::new(14, 0, i).uniform_pair(0);
        let z = 2.0 * a - 1.0;
        let (sin, cos) = (TAU * b).sin_cos();
        (1.0 - z * z).sqrt() * DVec3::new(cos, sin, 0.0) + z * DVec3::Z
    });
    for normal in poles.into_iter().chain(others) {
        let frame = Frame::around(normal);
        assert!((frame.tangent.cross(frame.bitangent) - normal).length() < 1e-14, "{normal}");
        assert!((frame.tangent.length() - 1.0).abs() < 1e-14, "{normal}");
        let w = DVec3::new(0.3, -0.5, 0.7);
        assert!((frame.to_world(frame.to_local(w)) - w).length() < 1e-14, "{normal}");
    }
}

#[test]
fn an_area_density_becomes_a_solid_angle_density() {
    let pdf = PdfArea(0.125);
    assert_eq!(pdf.to_solid_angle(4.0, -0.5), Some(PdfSolidAngle(1.0)));
    assert_eq!(pdf.to_solid_angle(4.0, 0.0), None);
}

#[test]
fn area_and_normal_follow_the_winding_at_every_scale() {
    assert_eq!(CORNER.area(), 0.5);
    for exponent in [-120, -40, 0, 40, 59] {
        let [a, b, c] = CORNER.vertices.map(|v| v * 2.0_f32.powi(exponent));
        let (front, back) = (Triangle::new(a, b, c), Triangle::new(a, c, b));
        assert_eq!((front.normal(), back.normal()), (DVec3::Z, -DVec3::Z), "scale 2^{exponent}");
        assert!(!front.is_degenerate(), "scale 2^{exponent}");
    }
}

#[test]
fn collinear_and_repeated_vertices_are_degenerate() {
    let (a, b) = (Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.7, -0.4, 0.9));
    let far = b * 2.0_f32.powi(30);
    for [a, b, c] in [[a, a, b], [a, a, a], [Vec3::ZERO, b, b * 2.0], [Vec3::ZERO, far, b]] {
        assert!(Triangle::new(a, b, c).is_degenerate(), "{a}, {b}, {c}");
    }
    let mut beside = b * 2.0;
    beside.x = beside.x.next_up();
    assert!(!Triangle::new(Vec3::ZERO, b, beside).is_degenerate(), "one ulp off the line");
}

#[test]
fn inverted_corners_of_a_triangle_are_numbers_below_one() {
    for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.7, 1.0 - 0.7), (-1e-17, 0.5), (0.5, -1e-17)] {
        let numbers = Triangle::invert_uniform(u, v);
        assert!(numbers.iter().all(|x| (0.0..1.0).contains(x)), "{u}, {v}: {numbers:?}");
    }
}

#[test]
fn uniform_samples_of_a_triangle_invert() {
    for i in 0..10_000 {
        let [a, b] = Stream::new(15, 0, i).uniform_pair(0);
        let (u, v) = Triangle::sample_uniform([a, b]);
        let [x, y] = Triangle::invert_uniform(u, v);
        assert!((x - a).abs() < 1e-15 && (y - b).abs() < 1e-7, "{a}, {b}: {x}, {y}");
    }
}

/// Each directed edge occurs once, and so does its opposite.
fn is_closed(mesh: &Mesh) -> bool {
    let mut edges = HashMap::new();
    for [a, b, c] in &mesh.faces {
        [(a, b), (b, c), (c, a)].into_iter().for_each(|edge| *edges.entry(edge).or_insert(0) += 1);
    }
    edges.iter().all(|(&(a, b), &count)| count == 1 && edges.get(&(b, a)) == Some(&1))
}

fn volume(mesh: &Mesh) -> f64 {
    let parts = mesh.faces.iter().map(|face| {
        let [a, b, c] = face.map(|i| mesh.vertices[i]);
        a.dot(b.cross(c)) / 6.0
    });
    parts.sum()
}

#[test]
fn the_closed_shapes_are_closed_and_face_outward() {
    for mesh in [icosphere(3), torus(40, 20), statue(5000)] {
        assert!(is_closed(&mesh) && volume(&mesh) > 0.1, "{}", volume(&mesh));
    }
    assert_eq!(icosphere(3).faces.len(), 1280);
    assert!((volume(&icosphere(5)) - 4.18879).abs() < 0.01);
    assert!(statue(70_000).faces.len().abs_diff(70_000) < 1000);
}

/// Two small triangles far apart, and a long one that overlaps the cells of both. The ray misses all three, so
/// it visits every cell along its way.
#[test]
fn every_structure_counts_alike() {
    let small = |x: f32| Triangle::new(Vec3::X * x, Vec3::X * (x + 1.0), Vec3::new(x, 1.0, 0.0));
    let long = Triangle::new(Vec3::Z, Vec3::new(11.0, 0.0, 1.0), Vec3::new(0.0, 1.0, 1.0));
    let triangles = Triangles::new(vec![small(0.0), small(10.0), long]).unwrap();
    let ray = Ray::new(DVec3::new(-1.0, 0.9, 0.5), DVec3::X);
    let numbers = |(hit, counts): (_, Counts)| {
        assert_eq!(hit, None);
        [counts.rays, counts.hits, counts.visits, counts.opened, counts.tests, counts.repeats]
    };
    assert_eq!(numbers(Counts::closest(&BruteForce::build(&triangles), &ray)), [1, 0, 0, 0, 3, 0]);

    let mut halved = KdOptions::by_rule(SplitRule::Midpoint);
    (halved.traversal_cost, halved.max_depth, halved.leaf_size) = (0.0, 1, 0);
    let kd = KdTree::build_with(&triangles, &halved).unwrap();
    assert_eq!(numbers(Counts::closest(&kd, &ray)), [1, 0, 1, 2, 4, 1]);

    // Two cells; the mailbox avoids the second test of the long triangle.
    let mut two_cells = GridOptions::default();
    two_cells.resolution = Some([2, 1, 1]);
    let grid = UniformGrid::build_with(&triangles, &two_cells).unwrap();
    let counted = Counts::closest(&grid, &ray);
    assert_eq!(Counts::any(&grid, &ray), (false, counted.1));
    assert_eq!(numbers(counted), [1, 0, 2, 2, 3, 0]);
}

/// Two triangles in the planes x = 0 and x = 4 of a box 4 by 1 by 1.
#[test]
fn the_statistics_of_two_triangles_and_the_space_between() {
    let wall = |x: f32| Triangle::new(Vec3::X * x, Vec3::new(x, 1.0, 0.0), Vec3::new(x, 0.0, 1.0));
    let triangles = Triangles::new(vec![wall(0.0), wall(4.0)]).unwrap();
    let mut options = KdOptions::by_rule(SplitRule::Midpoint);
    (options.max_depth, options.leaf_size, options.traversal_cost) = (2, 0, 0.0);
    let stats = KdTree::build_with(&triangles, &options).unwrap().stats();
    // Split at 2, then at 1 and 3: the two inner quarters are empty.
    assert_eq!((stats.depth, stats.nodes, stats.leaves, stats.empty_leaves), (2, 7, 4, 2));
    assert_eq!((stats.references, stats.references_per_triangle), (2, 1.0));
    assert_eq!((stats.empty_volume, stats.aspect), (0.5, 1.0));
    // Half areas: 9 for the whole, 5 for a half, 3 for a quarter.
    assert_eq!(stats.expected_visits, 1.0 + 5.0 / 9.0 + 5.0 / 9.0);
    assert_eq!(stats.expected_tests, stats.expected_opened);
    assert!((stats.expected_tests - 6.0 / 9.0).abs() < 1e-15);
    assert!((stats.expected_cost(9.0) - 19.0 - 6.0 / 9.0).abs() < 1e-14);
}

#[test]
fn the_statistics_of_nothing() {
    let nothing = KdTree::build(&Triangles::new(Vec::new()).unwrap()).unwrap();
    let stats = nothing.stats();
    assert_eq!(
        (stats.depth, stats.nodes, stats.leaves, stats.empty_leaves, stats.references),
        (0, 1, 1, 1, 0)
    );
    assert_eq!((stats.references_per_triangle, stats.empty_volume, stats.aspect), (0.0, 0.0, 0.0));
    assert_eq!((stats.expected_opened, stats.expected_cost(1.0)), (0.0, 0.0));
}
