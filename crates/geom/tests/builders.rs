//! Scenes that are hard to build for: empty, flat, degenerate, huge, tiny, overlapping, malformed.
//!
//! Every structure is built within the bounds that its documentation states, on references, nodes,
//! cells, depth and bytes, and answers aimed rays with the same bits as brute force. Bytes are
//! counted for each thread, so tests do not disturb each other.
//!
//! The scenes of coincident triangles have 100,000; with `GLOBILLUM_EFFORT=10` they have a million.

use allocation_counter::{AllocationInfo, measure};
use glam::{DVec3, Vec3};
use globillum_geom::conformance::shapes::{icosphere, quad, statue, torus};
use globillum_geom::conformance::{Regime, Seeded, Source};
use globillum_geom::decide::Shear;
use globillum_geom::{
    Accel, BruteForce, Counts, GeomError, GridOptions, Hit, KdOptions, KdStats, KdTree, Ray, SplitRule,
    Triangle, Triangles, UniformGrid, WideBvh,
};
use globillum_testkit::accelerators::rule_options;
use globillum_testkit::effort;
use proptest::prelude::*;

/// All structures over the same triangles.
struct Scene {
    triangles: Triangles,
    brute: BruteForce,
    kd: KdTree,
    by_rule: Vec<(String, KdTree)>,
    wide: WideBvh,
    quick: WideBvh,
    grid: UniformGrid,
}

impl Scene {
    fn new(triangles: Vec<Triangle>) -> Self {
        let triangles = Triangles::new(triangles).expect("coordinates in the domain");
        Self {
            brute: BruteForce::build(&triangles),
            kd: kd_within_bounds(&triangles, &KdOptions::default()),
            wide: wide_within_bounds(&triangles, WideBvh::build).0,
            quick: wide_within_bounds(&triangles, WideBvh::build_quickly).0,
            by_rule: every_rule().map(|options| kd_by_rule(&triangles, &options)).collect(),
            grid: grid_within_bounds(&triangles, &GridOptions::default()),
            triangles,
        }
    }

    /// Checks the answers to `count` aimed rays and returns how many hit; those of the wide BVHs also in batches with
    /// packets.
    fn check(&self, count: usize) -> usize {
        let rays = aimed_rays(&self.triangles, count);
        self.check_batches(&[&coherent_rays(&self.triangles), &rays[..count.min(64)]].concat());
        rays.iter().filter(|ray| self.hit(ray).is_some()).count()
    }

    /// Checks the answers of the wide BVHs to a batch of `rays`.
    fn check_batches(&self, rays: &[Ray]) {
        let expected: Vec<_> = rays.iter().map(|ray| bits(self.brute.intersect(ray))).collect();
        for (name, accel) in [("wide BVH", &self.wide), ("wide BVH, built quickly", &self.quick)] {
            let (mut hits, mut occluded) = (Vec::new(), Vec::new());
            accel.intersect_batch(rays, &mut hits);
            accel.occluded_batch(rays, &mut occluded);
            assert!(hits.into_iter().map(bits).eq(expected.iter().copied()), "{name}, {rays:?}");
            assert!(occluded.into_iter().eq(expected.iter().map(Option::is_some)), "{name}, {rays:?}");
        }
    }

    /// What all structures answer.
    fn hit(&self, ray: &Ray) -> Option<Hit> {
        let expected = self.brute.intersect(ray);
        for (name, accel) in [
            ("k-d tree", &self.kd as &dyn Accel),
            ("grid", &self.grid),
            ("wide BVH", &self.wide),
            ("wide BVH, built quickly", &self.quick),
        ] {
            assert_same(name, accel, ray, expected);
        }
        for (name, tree) in &self.by_rule {
            assert_same(name, tree, ray, expected);
        }
        expected
    }
}

fn every_rule() -> impl Iterator<Item = KdOptions> {
    SplitRule::ALL.into_iter().map(rule_options)
}

fn kd_by_rule(triangles: &Triangles, options: &KdOptions) -> (String, KdTree) {
    (format!("k-d tree, {:?}", options.rule), kd_within_bounds(triangles, options))
}

fn assert_same(name: &str, accel: &dyn Accel, ray: &Ray, expected: Option<Hit>) {
    assert_eq!(bits(accel.intersect(ray)), bits(expected), "{name}, {ray:?}");
    assert_eq!(accel.occluded(ray), expected.is_some(), "{name}, {ray:?}");
}

/// A hit as its bits, in which equal means equal.
fn bits(hit: Option<Hit>) -> Option<([u64; 3], u32)> {
    hit.map(|h| ([h.t, h.u, h.v].map(f64::to_bits), h.triangle))
}

/// What `make` returns, and what it allocated: on one thread, since bytes are counted for each, and
/// on a small stack, which is enough for the deepest tree.
fn measured<T: Send>(make: impl FnOnce() -> T + Send) -> (T, AllocationInfo) {
    let thread = rayon::ThreadPoolBuilder::new().num_threads(1).stack_size(256 * 1024).build();
    let thread = thread.expect("one thread can be had");
    let mut made = None;
    let allocated = thread.install(|| measure(|| made = Some(make())));
    (made.expect("`measure` calls once"), allocated)
}

/// Builds a tree and checks all that is promised about its size.
fn kd_within_bounds(triangles: &Triangles, options: &KdOptions) -> KdTree {
    let (tree, allocated) = measured(|| KdTree::build_with(triangles, options).expect("options in range"));
    let n = triangles.live().len();
    let b = (8 * n).max(1);
    let KdStats { references, nodes, depth, .. } = tree.stats();
    assert!((n..=b).contains(&references), "{references} references to {n} triangles");
    assert!(nodes < 2 * b, "{nodes} nodes over {n} triangles");
    assert!(depth <= KdTree::MAX_DEPTH, "depth {depth}");
    assert!(
        allocated.bytes_max as usize <= 200 * n + 240 * b + 1024,
        "{} bytes for {n}",
        allocated.bytes_max
    );
    assert_eq!(allocated.bytes_current as usize, tree.bytes() - triangles.bytes());
    tree
}

/// Builds a wide BVH and checks all that is promised about its size; also returns the bytes that building
/// took.
fn wide_within_bounds(
    triangles: &Triangles,
    build: impl FnOnce(&Triangles) -> Result<WideBvh, GeomError> + Send,
) -> (WideBvh, usize) {
    let (tree, allocated) = measured(|| build(triangles).expect("not too many references"));
    let taken = allocated.bytes_max as usize;
    let n = triangles.live().len();
    let b = (8 * n).max(1);
    let kept = tree.bytes() - triangles.bytes();
    assert!(kept <= 296 * b + 68 * n + 2048, "{kept} bytes kept for {n}");
    assert!(taken <= 1100 * b + (1 << 17), "{taken} bytes for {n}");
    assert_eq!(allocated.bytes_current as usize, kept);
    (tree, taken)
}

/// Builds a grid and checks all that is promised about its size.
fn grid_within_bounds(triangles: &Triangles, options: &GridOptions) -> UniformGrid {
    let (grid, allocated) =
        measured(|| UniformGrid::build_with(triangles, options).expect("a grid that fits"));
    let n = triangles.live().len();
    let (references, cells) = (grid.reference_count(), cell_count(&grid));
    assert!((n..=16 * n + 1024).contains(&references), "{references} references to {n} triangles");
    assert!(options.resolution.is_some() || cells <= 8 * n + 64, "{cells} cells for {n} triangles");
    assert!(cells <= 1 << 27, "{cells} cells");
    assert_eq!(allocated.bytes_max as usize, 4 * (cells + 1 + references));
    assert_eq!(allocated.bytes_current as usize, grid.bytes() - triangles.bytes());
    grid
}

fn cell_count(grid: &UniformGrid) -> usize {
    grid.resolution().map(|r| r as usize).into_iter().product()
}

/// Rays at vertices, at edges and into triangles, from everywhere, from other triangles and along
/// axes; for scenes of any size, since distances are those of the scene or of the triangle.
fn aimed_rays(triangles: &Triangles, count: usize) -> Vec<Ray> {
    let mut source = Seeded::new(count as u64);
    if triangles.is_empty() {
        return vec![Ray::new(DVec3::ZERO, DVec3::X); count];
    }
    (0..count).map(|_| aimed_ray(triangles, &mut source)).collect()
}

/// Two packets of 64 rays: from one point close to an aimed ray, and segments back to it from near the ray's target.
fn coherent_rays(triangles: &Triangles) -> Vec<Ray> {
    if triangles.is_empty() {
        return Vec::new();
    }
    let mut source = Seeded::new(64);
    let ray = aimed_ray(triangles, &mut source);
    let spread = 0.01 * ray.direction.abs().max_element();
    let directions = [0; 64].map(|_| ray.direction + spread * in_cube(&mut source).as_dvec3());
    let from_origin = directions.map(|direction| Ray { direction, ..ray });
    [from_origin, directions.map(|direction| Ray::segment(ray.origin + direction, ray.origin))].concat()
}

fn aimed_ray(triangles: &Triangles, source: &mut Seeded) -> Ray {
    let triangle = source.pick(triangles.as_slice());
    let target = point_of(&triangle, source);
    let size = if source.one_in(2) { triangles.bounds().extent() } else { triangle.bounds().extent() };
    // Flat boxes too are to be seen from outside their plane.
    let size = size.max(DVec3::splat(size.max_element() / 8.0));
    let away = 2.0 * size * DVec3::new(source.signed(), source.signed(), source.signed());
    let origin = match source.below(4) {
        0 => point_of(&source.pick(triangles.as_slice()), source),
        1 => {
            let axis = source.below(3);
            target + DVec3::AXES[axis] * away[axis]
        }
        _ => target + away,
    };
    let signed_zero = |x: f64| if x == 0.0 && source.one_in(2) { -0.0 } else { x };
    Ray::new(origin, (target - origin).map(signed_zero))
}

/// A vertex, a point on an edge, or one inside.
fn point_of(triangle: &Triangle, source: &mut Seeded) -> DVec3 {
    let [a, b, c] = triangle.vertices.map(|v| v.as_dvec3());
    let along = source.unit();
    match source.below(3) {
        0 => source.pick(&[a, b, c]),
        1 => a.lerp(b, along),
        _ => a.lerp(b, along).lerp(c, source.unit()),
    }
}

fn in_cube(source: &mut Seeded) -> Vec3 {
    DVec3::new(source.signed(), source.signed(), source.signed()).as_vec3()
}

const CORNER: Triangle = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);

fn moved(triangle: Triangle, by: Vec3) -> Triangle {
    Triangle { vertices: triangle.vertices.map(|v| v + by) }
}

#[test]
fn an_empty_scene() {
    let scene = Scene::new(Vec::new());
    assert_eq!(scene.check(10), 0);
    for accel in [&scene.brute as &dyn Accel, &scene.kd, &scene.grid] {
        assert!(accel.bounds().is_empty());
    }
    assert_eq!(
        (scene.kd.stats().depth, scene.kd.stats().references, scene.grid.reference_count()),
        (0, 0, 0)
    );
}

#[test]
fn one_triangle_and_two_identical_ones() {
    let down = Ray::new(DVec3::new(0.25, 0.25, 1.0), -DVec3::Z);
    for copies in [1, 2] {
        let scene = Scene::new(vec![CORNER; copies]);
        assert!(scene.check(200) > 50);
        assert_eq!(scene.hit(&down).map(|h| h.triangle), Some(0));
    }
}

#[test]
fn flat_scenes_in_each_plane() {
    for axis in 0..3 {
        // A lattice of squares whose coordinate along `axis` is always one.
        let corner = |x: usize, y: usize| {
            let mut p = DVec3::ONE;
            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (x as f64, y as f64);
            p
        };
        let square = |i: usize| {
            let (x, y) = (i % 8, i / 8);
            quad(corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1))
        };
        let scene = Scene::new((0..64).flat_map(square).collect());
        assert_eq!(scene.grid.resolution()[axis], 1);
        assert!(scene.kd.planes().all(|(a, _)| a != axis) && scene.kd.stats().depth > 0);
        assert!(scene.check(2000) > 500);
    }
}

#[test]
fn only_lines_and_points() {
    let n = 100_000;
    let on_the_axis = |i: usize| Triangle { vertices: [i, 2 * i, 5 * i + 1].map(|x| Vec3::X * x as f32) };
    let point = Triangle { vertices: [Vec3::new(0.1, 0.2, 0.3); 3] };
    for triangles in [(0..n).map(on_the_axis).collect(), vec![point; n]] {
        let scene = Scene::new(triangles);
        assert_eq!(scene.triangles.degenerate_count(), n);
        assert_eq!(scene.check(100), 0);
    }
}

#[test]
fn degenerate_triangles_keep_their_index_and_are_not_hit() {
    // Dyadic, so that points on their line can be named exactly.
    let (a, b) = (Vec3::new(0.125, 0.75, 0.25), Vec3::new(0.875, 0.25, 0.5));
    let repeated = Triangle::new(a, a, b);
    let collinear = Triangle::new(a, a + 2.0 * (b - a), a + 0.5 * (b - a));
    let through_zero = Triangle::new(Vec3::ZERO, b, 4.0 * b);
    let scene = Scene::new(vec![repeated, through_zero, CORNER, collinear, moved(CORNER, Vec3::Z)]);
    assert_eq!(scene.triangles.degenerate_count(), 3);
    assert!(scene.check(500) > 50);
    let down = Ray::new(DVec3::new(0.25, 0.25, 0.5), -DVec3::Z);
    assert_eq!(scene.hit(&down).map(|h| h.triangle), Some(2));
}

/// A spindle: a ring of tiny radius, and two tips far off. Its triangles are 1e8 times as long as
/// they are wide, and every long edge is shared.
#[test]
fn needles_that_share_long_edges_do_not_leak() {
    let (tip, ring, radius) = (DVec3::new(0.36, 0.48, 0.8), 60_u32, 1e-7);
    let (side, other) = (tip.any_orthonormal_vector(), tip.cross(tip.any_orthonormal_vector()));
    let at = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i % ring) / f64::from(ring)).sin_cos();
        (radius * (cos * side + sin * other)).as_vec3()
    };
    let (top, bottom) = (tip.as_vec3(), -tip.as_vec3());
    let needles = |i| [Triangle::new(at(i), at(i + 1), top), Triangle::new(at(i + 1), at(i), bottom)];
    let scene = Scene::new((0..ring).flat_map(needles).collect());
    assert_eq!(scene.triangles.degenerate_count(), 0);
    let mut source = Seeded::new(27);
    for _ in 0..20_000 {
        let origin = (0.5 * radius / 3.0_f64.sqrt()) * in_cube(&mut source).as_dvec3();
        let [a, b, c] = source.pick(scene.triangles.as_slice()).vertices.map(|v| v.as_dvec3());
        let target =
            source.pick(&[a, b, c, a.lerp(c, source.clone().unit()), a.lerp(b, source.clone().unit())]);
        assert!(scene.hit(&Ray::new(origin, target - origin)).is_some(), "from {origin} to {target}");
    }
    scene.check(20_000);
}

/// Meshes of three sizes, each in the middle of the next: every ray has the answers of brute force, and few more tests
/// than if there were only one mesh.
#[test]
fn dense_meshes_in_huge_scenes() {
    let ball = |size: f32| -> Vec<Triangle> {
        let scaled = |t: Triangle| Triangle { vertices: t.vertices.map(|v| size * v) };
        icosphere(4).triangles().into_iter().map(scaled).collect()
    };
    // A floor of fine squares within a large one in the same plane, in both orders: the smaller index is hit.
    let floor = |size: f64, squares: i32| {
        let corner = move |x: i32, y: i32| {
            let at = |i: i32| size * (2.0 * f64::from(i) / f64::from(squares) - 1.0);
            DVec3::new(at(x), at(y), 0.0)
        };
        let square = move |i: i32| {
            let (x, y) = (i % squares, i / squares);
            quad(corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1))
        };
        (0..squares * squares).flat_map(square)
    };
    let (fine, large) = (floor(1e-3, 20), floor(1e5, 1));
    for triangles in [fine.clone().chain(large.clone()).collect::<Vec<_>>(), large.chain(fine).collect()] {
        let scene = Scene::new(triangles);
        assert!(format!("{:?}", scene.wide).contains("trees: 2"), "{:?}", scene.wide);
        assert!(scene.check(3000) > 1000);
        for x in [0.0, 0.3e-4, 0.55e-3, 0.9e-3, 1e-3, 2e-3, 1.0] {
            let down = Ray::new(DVec3::new(x, 0.1e-4, 1.0), -DVec3::Z);
            assert_eq!(scene.hit(&down).map(|hit| hit.t), Some(1.0));
        }
    }
    let scene = Scene::new([ball(1.0), ball(1e12), ball(1e6)].concat());
    assert!(format!("{:?}", scene.wide).contains("trees: 3"), "{:?}", scene.wide);
    assert!(scene.check(20_000) > 10_000);
    let alone = Triangles::new(ball(1.0)).expect("a valid mesh");
    for (nested, alone) in
        [(&scene.wide, WideBvh::build(&alone)), (&scene.quick, WideBvh::build_quickly(&alone))]
    {
        let alone = alone.expect("the tree can be built");
        let mut source = Seeded::new(52);
        let (mut few, mut all) = (0, 0);
        for _ in 0..2000 {
            let origin = 3.0 * in_cube(&mut source).as_dvec3();
            let ray = Ray::new(origin, in_cube(&mut source).as_dvec3() - origin);
            let (hit, counts) = Counts::closest(&alone, &ray);
            let (in_nested, counts_in_nested) = Counts::closest(nested, &ray);
            assert!(hit.is_none() || bits(hit) == bits(in_nested));
            (few, all) = (few + counts.tests, all + counts_in_nested.tests);
        }
        assert!(few > 0 && all < 4 * few, "{all} tests, {few} without the other meshes");
    }
}

#[test]
fn bad_coordinates_are_named() {
    let with = |vertex: usize, axis: usize, value| {
        let mut triangles = vec![CORNER; 3];
        triangles[1].vertices[vertex][axis] = value;
        Triangles::new(triangles)
    };
    let limit = Triangle::MAX_COORDINATE;
    for (vertex, axis) in (0..9).map(|i| (i / 3, i % 3)) {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let error = with(vertex, axis, value).unwrap_err();
            assert_eq!(error, GeomError::NonFinite { triangle: 1, vertex });
        }
        for value in [limit.next_up(), -limit.next_up(), f32::MAX] {
            let error = with(vertex, axis, value).unwrap_err();
            assert_eq!(error, GeomError::Domain { triangle: 1, vertex, value });
        }
        for value in [limit, -limit] {
            let scene = Scene::new(with(vertex, axis, value).unwrap().as_slice().to_vec());
            scene.check(100);
        }
    }
}

#[test]
fn negative_zero_is_zero() {
    let mesh: Vec<Triangle> = Regime::Lattice.triangles(&mut Seeded::new(29));
    let negated = |x: f32| if x == 0.0 { -0.0 } else { x };
    let mirrored = mesh.iter().map(|t| Triangle { vertices: t.vertices.map(|v| v.map(negated)) }).collect();
    let (plain, negative) = (Scene::new(mesh), Scene::new(mirrored));
    for ray in aimed_rays(&plain.triangles, 2000) {
        assert_eq!(bits(plain.hit(&ray)), bits(negative.hit(&ray)), "{ray:?}");
    }
    let planes = |scene: &Scene| scene.kd.planes().map(|(a, x)| (a, x.to_bits())).collect::<Vec<_>>();
    assert_eq!(planes(&plain), planes(&negative));
}

#[test]
fn denormal_geometry() {
    let mesh = statue(500).placed(1e-40, DVec3::ZERO).triangles();
    let scene = Scene::new(mesh);
    assert!(scene.triangles.live().len() > 100);
    assert!(scene.check(2000) > 500);
    // The smallest triangle there is.
    let scene = Scene::new(vec![Triangle { vertices: CORNER.vertices.map(|v| v * f32::from_bits(1)) }]);
    assert!(scene.check(200) > 50);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// Which triangle wins may change only between those that are hit at the same `t`.
    #[test]
    fn the_order_of_triangles_changes_no_distance(
        choices in prop::collection::vec(any::<u64>(), 8..512), which in 0usize..5, seed in any::<u64>(),
    ) {
        let mut source = choices.into_iter();
        let ordered = Regime::ALL[which].triangles(&mut source);
        let order = shuffled(ordered.len(), seed);
        let place = |index: u32| order.iter().position(|&i| i == index as usize).map_or(Ray::NO_TRIANGLE, |at| at as u32);
        let (plain, mixed) = (Scene::new(ordered.clone()), Scene::new(order.iter().map(|&i| ordered[i]).collect()));
        for _ in 0..32 {
            let ray = Regime::ALL[which].ray(&ordered, &mut source);
            let ray_there = ray.excluding(ray.excluded.map(place));
            let there = mixed.hit(&ray_there).map(|h| Hit { triangle: order[h.triangle as usize] as u32, ..h });
            match (plain.hit(&ray), there) {
                (Some(a), Some(b)) if a.triangle != b.triangle => {
                    let other = Shear::new(&ray).and_then(|s| s.decide(&ordered[b.triangle as usize])).unwrap();
                    prop_assert_eq!(a.t.to_bits(), b.t.to_bits());
                    prop_assert_eq!(a.t.to_bits(), other.t.to_bits());
                }
                (a, b) => prop_assert_eq!(bits(a), bits(b)),
            }
        }
    }
}

fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut source = Seeded::new(seed);
    let mut order: Vec<usize> = (0..count).collect();
    (1..count).for_each(|i| order.swap(i, source.below(i + 1)));
    order
}

#[test]
fn a_teapot_in_a_stadium() {
    let mut triangles = statue(10_000).placed(0.1, DVec3::Y * 0.1).triangles();
    let far = 5e3;
    let corner = |x: f64, z: f64| DVec3::new(x * far, 0.0, z * far);
    triangles.extend(quad(corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)));
    let scene = Scene::new(triangles);
    assert!(scene.check(1000) > 500);
    // The tree's planes go where the triangles are; the grid cannot know.
    assert!(scene.kd.planes().filter(|(_, at)| at.abs() < 1.0).count() > 5000);
}

#[test]
fn long_diagonal_needles() {
    let mut source = Seeded::new(39);
    let mut needle = || {
        let (a, b) = (in_cube(&mut source), in_cube(&mut source));
        Triangle::new(a, b, b + 1e-3 * in_cube(&mut source))
    };
    let scene = Scene::new((0..8_000).map(|_| needle()).collect());
    assert!(scene.check(1000) > 250);
}

fn coincident_count() -> usize {
    100_000 * effort() as usize
}

#[test]
fn identical_triangles() {
    let scene = Scene::new(vec![CORNER; coincident_count()]);
    // No plane can part them.
    assert_eq!((scene.kd.stats().nodes, scene.kd.stats().references), (1, coincident_count()));
    assert!(scene.check(20) > 5);
    assert_eq!(scene.hit(&Ray::new(DVec3::new(0.25, 0.25, 1.0), -DVec3::Z)).map(|h| h.triangle), Some(0));
}

#[test]
fn triangles_at_two_alternating_places() {
    let place = |i| moved(CORNER, Vec3::new(2.5, 0.0, 0.0) * (i % 2) as f32);
    let scene = Scene::new((0..coincident_count()).map(place).collect());
    assert_eq!(scene.kd.stats().references, coincident_count());
    assert!(scene.check(20) > 5);
    for (x, first) in [(0.25, 0), (2.75, 1)] {
        let down = Ray::new(DVec3::new(x, 0.25, 1.0), -DVec3::Z);
        assert_eq!(scene.hit(&down).map(|h| h.triangle), Some(first));
    }
}

/// Squares around the y axis, from `1` to `2` in size; square `i` at height `rise` times its size.
fn nested_squares(rise: f64) -> Vec<Triangle> {
    let count = coincident_count() / 2;
    let square = |i: usize| {
        let size = 1.0 + i as f64 / count as f64;
        let corner = |x: f64, z: f64| size * DVec3::new(x, rise, z);
        quad(corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0))
    };
    (0..count).flat_map(square).collect()
}

#[test]
fn nested_squares_in_one_plane() {
    let scene = Scene::new(nested_squares(0.0));
    assert!(scene.check(20) > 5);
    let down = |x: f64| Ray::new(DVec3::new(x, 1.0, 0.1), -DVec3::Y);
    assert!(scene.hit(&down(0.5)).is_some_and(|h| h.triangle < 2));
    assert_eq!(scene.hit(&down(2.5)), None);
}

#[test]
fn nested_squares_one_above_the_other() {
    let scene = Scene::new(nested_squares(1.0));
    assert!(scene.check(20) > 5);
    let nearest = |ray| scene.hit(&ray).map(|h| h.triangle as usize / 2);
    let axis = DVec3::new(0.1, 0.0, 0.2);
    assert_eq!(nearest(Ray::new(axis, DVec3::Y)), Some(0));
    assert_eq!(nearest(Ray::new(axis + 3.0 * DVec3::Y, -DVec3::Y)), Some(coincident_count() / 2 - 1));
}

/// Triangle `i` at `x = 2^-i`, of size `2^-i`, down to the smallest number there is and beyond.
#[test]
fn a_geometric_chain_of_ever_smaller_triangles() {
    let link = |i: i32| {
        let s = 2.0_f64.powi(-i) as f32;
        moved(Triangle::new(Vec3::ZERO, Vec3::new(s, s, 0.0), Vec3::new(0.0, s, s)), Vec3::X * s)
    };
    let chain: Vec<Triangle> = (0..1000).map(link).collect();
    let mut options = KdOptions::default();
    options.max_depth = u32::MAX;
    let job = move || {
        let scene = Scene::new(chain);
        // The rest is zero in f32.
        assert_eq!(scene.triangles.live().len(), 150);
        let deep = kd_within_bounds(&scene.triangles, &options);
        for ray in aimed_rays(&scene.triangles, 5000) {
            assert_same("deep k-d tree", &deep, &ray, scene.hit(&ray));
        }
        deep.stats().depth
    };
    let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(job).unwrap();
    assert_eq!(thread.join().unwrap(), KdTree::MAX_DEPTH);
}

#[test]
fn any_depth_and_leaf_size() {
    let triangles = Triangles::new(statue(500).triangles()).unwrap();
    let brute = BruteForce::build(&triangles);
    let rays = aimed_rays(&triangles, 200);
    for max_depth in [0, 1, 60, 64, 65, 1_000_000_000] {
        for leaf_size in [0, 1, 1_000_000_000] {
            let mut options = KdOptions::default();
            (options.max_depth, options.leaf_size) = (max_depth, leaf_size);
            let tree = kd_within_bounds(&triangles, &options);
            assert!(tree.stats().depth <= max_depth.min(60));
            assert!(leaf_size < 1000 || tree.stats().depth == 0);
            for ray in &rays {
                assert_same("k-d tree", &tree, ray, brute.intersect(ray));
            }
        }
    }
}

/// Six planes box a triangle in; where that costs nothing, every reference could get its six.
#[test]
fn empty_space_at_no_cost() {
    let triangles = Triangles::new(statue(2000).triangles()).unwrap();
    let mut options = KdOptions::default();
    (options.max_depth, options.leaf_size) = (60, 0);
    (options.traversal_cost, options.empty_factor) = (0.0, 1e-3);
    let tree = kd_within_bounds(&triangles, &options);
    let brute = BruteForce::build(&triangles);
    for ray in aimed_rays(&triangles, 2000) {
        assert_same("k-d tree", &tree, &ray, brute.intersect(&ray));
    }
}

/// Where no plane pays, each is on trial, and twice as many follow. They are fewer than half of what the
/// documentation allows for their halves; each takes no more than 16 allocations.
#[test]
fn lookahead_tries_a_bounded_number_of_planes() {
    let triangles = Triangles::new(icosphere(2).triangles()).unwrap();
    let brute = BruteForce::build(&triangles);
    let rays = aimed_rays(&triangles, 200);
    let b = 8 * triangles.live().len() as u64;
    let most = 16 * (60 * b / 2);
    for lookahead in [1, 12, 20, u32::MAX] {
        for rule in SplitRule::ALL {
            let mut options = KdOptions::by_rule(rule);
            (options.lookahead, options.leaf_size, options.traversal_cost) = (lookahead, 0, 1e6);
            let (tree, allocated) = measured(|| KdTree::build_with(&triangles, &options).unwrap());
            let count = allocated.count_total;
            assert!(count <= most, "{rule:?}, lookahead {lookahead}: {count} allocations, not {most}");
            for ray in &rays {
                assert_same("k-d tree", &tree, ray, brute.intersect(ray));
            }
        }
    }
}

#[test]
fn costs_out_of_range() {
    let triangles = Triangles::new(vec![CORNER]).unwrap();
    let refused = |set: &dyn Fn(&mut KdOptions)| {
        let mut options = KdOptions::default();
        set(&mut options);
        matches!(KdTree::build_with(&triangles, &options), Err(GeomError::Param { .. }))
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e-300] {
        assert!(refused(&|o| o.traversal_cost = bad), "traversal_cost {bad}");
        assert!(refused(&|o| o.empty_factor = bad), "empty_factor {bad}");
    }
    for bad in [0.0, -0.0, 1.0_f64.next_up()] {
        assert!(refused(&|o| o.empty_factor = bad), "empty_factor {bad}");
    }
    for bad in [f64::NAN, f64::INFINITY, -3.0, 2.0_f64.next_down()] {
        assert!(refused(&|o| o.max_aspect = bad), "max_aspect {bad}");
    }
    for good in [0.0, -0.0, 1e300] {
        assert!(!refused(&|o| o.traversal_cost = good), "traversal_cost {good}");
    }
}

fn grid_options(resolution: [u32; 3]) -> GridOptions {
    let mut options = GridOptions::default();
    options.resolution = Some(resolution);
    options
}

#[test]
fn impossible_grids_are_refused_before_anything_is_allocated() {
    let triangles = Triangles::new(statue(500).triangles()).unwrap();
    let refused = |options: &GridOptions| {
        let (error, allocated) = measured(|| UniformGrid::build_with(&triangles, options).unwrap_err());
        assert_eq!(allocated.count_total, 0, "{options:?}");
        error
    };
    for axis in 0..3 {
        let mut resolution = [4; 3];
        resolution[axis] = 0;
        assert!(matches!(refused(&grid_options(resolution)), GeomError::Param { name: "resolution", .. }));
        resolution[axis] = 1_000_000_000;
        assert!(matches!(refused(&grid_options(resolution)), GeomError::Budget { what: "grid cells", .. }));
    }
    for all in [4096, 1_000_000_000, u32::MAX] {
        assert!(matches!(refused(&grid_options([all; 3])), GeomError::Budget { what: "grid cells", .. }));
    }
    // As many cells as there may be, but far too many for the references.
    assert!(matches!(refused(&grid_options([512; 3])), GeomError::Budget { what: "grid references", .. }));
    for density in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut options = GridOptions::default();
        options.density = density;
        assert!(matches!(refused(&options), GeomError::Param { name: "density", .. }), "density {density}");
    }
}

#[test]
fn possible_grids() {
    let triangles = Triangles::new(statue(500).triangles()).unwrap();
    let brute = BruteForce::build(&triangles);
    let mut options = vec![GridOptions::default(); 2];
    (options[0].density, options[1].density) = (f64::MIN_POSITIVE, f64::MAX);
    options.extend([[1, 1, 1], [1, 40, 1], [3, 5, 7]].map(grid_options));
    for options in &options {
        let grid = grid_within_bounds(&triangles, options);
        assert!(options.resolution.is_none_or(|r| r == grid.resolution()));
        for ray in aimed_rays(&triangles, 500) {
            assert_same("grid", &grid, &ray, brute.intersect(&ray));
        }
    }
}

#[test]
fn a_flat_axis_has_one_cell() {
    for axis in 0..3 {
        let mut flat = Triangle::new(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0), Vec3::new(3.0, 1.0, 2.0));
        flat.vertices.iter_mut().for_each(|v| v[axis] = 0.0);
        let triangles = Triangles::new(vec![flat]).unwrap();
        let mut expected = [30; 3];
        expected[axis] = 1;
        let grid = grid_within_bounds(&triangles, &grid_options([30; 3]));
        assert_eq!(grid.resolution(), expected);
    }
}

/// Ten thousand triangles in one plane, all around one point, and copies of one behind another.
#[test]
fn stacks_of_equal_distance() {
    let mut source = Seeded::new(44);
    let mut around_the_origin = || {
        // Two corners left and one right of the origin, so that most triangles contain it.
        let (up, down, right) = (source.unit(), source.unit(), source.unit());
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0).as_vec3();
        Triangle::new(
            corner(-right, 1.0 + up),
            corner(-right, -1.0 - down),
            corner(1.0 + right, source.signed()),
        )
    };
    let mut triangles: Vec<Triangle> = (0..10_000).map(|_| around_the_origin()).collect();
    let cover = moved(Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y), Vec3::new(-0.25, -0.25, 1.0));
    triangles.extend([moved(cover, -0.5 * Vec3::Z), cover, cover, moved(cover, -0.5 * Vec3::Z)]);
    let scene = Scene::new(triangles);
    let first = |ray| scene.hit(&ray).map(|h| h.triangle);
    assert_eq!(first(Ray::new(DVec3::Z * 2.0, -DVec3::Z)), Some(10_001));
    assert_eq!(first(Ray::new(DVec3::Z * 0.75, -DVec3::Z)), Some(10_000));
    assert_eq!(first(Ray::new(DVec3::Z * -2.0, DVec3::Z)), Some(0));
    assert!(scene.check(500) > 100);
}

#[test]
fn a_thousand_seeds_of_garbage() {
    let taken = (0..1000).filter(|&seed| check_garbage(seed)).count();
    // The test checks nothing if all scenes are refused.
    assert!((100..900).contains(&taken), "{taken} scenes taken");
}

/// Checks a scene of random bits, and returns whether it was taken.
fn check_garbage(seed: u64) -> bool {
    let mut source = Seeded::new(seed);
    let count = source.below(257);
    // Bits of a number in the domain, one time in so many; else any bits.
    let tame = source.one_in(2);
    let mut number = || {
        let x = f32::from_bits(source.bits() as u32);
        if tame && (x.is_nan() || x.abs() > Triangle::MAX_COORDINATE) { 1.0 } else { x }
    };
    let mut triangle = || Triangle { vertices: [0; 3].map(|_| Vec3::new(number(), number(), number())) };
    let triangles: Vec<Triangle> = (0..count).map(|_| triangle()).collect();
    match Triangles::new(triangles.clone()) {
        Err(GeomError::NonFinite { triangle, vertex }) => {
            assert!(!triangles[triangle].vertices[vertex].is_finite());
            false
        }
        Err(GeomError::Domain { triangle, vertex, value }) => {
            assert!(triangles[triangle].vertices[vertex].to_array().contains(&value));
            false
        }
        Err(error) => panic!("{error}"),
        Ok(_) => {
            Scene::new(triangles).check(50);
            true
        }
    }
}

/// Triangles at random places in a cube of side 2, their sides up to some `size`.
fn soup(count: usize, size: f32) -> Triangles {
    let mut source = Seeded::new(count as u64);
    let mut triangle = || {
        let [corner, a, b] = [0; 3].map(|_| in_cube(&mut source));
        Triangle::new(corner, corner + size * a, corner + size * b)
    };
    Triangles::new((0..count).map(|_| triangle()).collect()).expect("coordinates in the domain")
}

/// What its documentation says that a closed mesh takes, far below the bounds.
#[test]
fn what_building_takes_over_closed_meshes() {
    let shapes = [statue(6_000), statue(20_000), icosphere(4), icosphere(5), torus(100, 30), torus(200, 60)];
    for triangles in shapes.map(|mesh| Triangles::new(mesh.triangles()).unwrap()) {
        let n = triangles.live().len();
        let kd =
            |options| measured(|| KdTree::build_with(&triangles, &options).unwrap()).1.bytes_max as usize / n;
        let by_area = kd(KdOptions::default());
        assert!((160..=310).contains(&by_area), "{by_area} n");
        for options in every_rule() {
            let by_rule = kd(options);
            assert!((170..=420).contains(&by_rule), "{by_rule} n, {:?}", options.rule);
        }
        for build in [WideBvh::build, WideBvh::build_quickly] {
            let wide = wide_within_bounds(&triangles, build).1 / n;
            assert!((150..=220).contains(&wide), "{wide} n");
        }
    }
}

#[test]
fn what_building_a_wide_bvh_takes_over_long_triangles_and_in_small_cells() {
    let mut tiny = KdOptions::default();
    (tiny.leaf_size, tiny.traversal_cost, tiny.empty_factor) = (0, 0.0, 1e-3);
    let mesh = Triangles::new(statue(6_000).triangles()).unwrap();
    for triangles in [mesh, soup(20_000, 0.02), soup(20_000, 0.2), soup(20_000, 1.0), soup(2_000, 3.0)] {
        let n = triangles.live().len();
        for build in [WideBvh::build, WideBvh::build_quickly] {
            let peak = wide_within_bounds(&triangles, build).1 / n;
            assert!((120..=1000).contains(&peak), "{peak} n");
        }
        for options in [KdOptions::default(), tiny] {
            let build = |triangles: &Triangles| WideBvh::build_with(triangles, &options);
            let peak = wide_within_bounds(&triangles, build).1 / n;
            assert!((200..=1700).contains(&peak), "{peak} n, {options:?}");
        }
    }
}

/// A grid divides none of the first, and only the furthest of the second.
#[test]
fn grids_that_divide_little_build_trees_too() {
    let at =
        |corner: Vec3, size: f32| Triangle::new(corner, corner + size * Vec3::X, corner + size * Vec3::Y);
    let in_one_place = (0..2000).map(|_| at(Vec3::ONE, 1.0));
    let far_apart = (0..2000).map(|i| at(Vec3::splat(2.0_f32.powi(i % 60)), 2.0_f32.powi(i % 60 - 8)));
    for triangles in [in_one_place.collect::<Vec<_>>(), far_apart.collect()] {
        assert!(Scene::new(triangles).check(300) > 0);
    }
}

/// Nor by other factors than powers of two, by which coordinates are rounded elsewhere, so that boxes are not
/// quite the same.
#[test]
fn the_unit_of_length_does_not_change_a_wide_bvh() {
    for build in [WideBvh::build, WideBvh::build_quickly] {
        let bytes = |levels, scale| {
            let mesh = icosphere(levels).placed(scale, DVec3::ZERO);
            build(&Triangles::new(mesh.triangles()).unwrap()).unwrap().bytes()
        };
        assert_eq!([-80, 0, 50].map(|exponent| bytes(4, 2.0_f64.powi(exponent))), [bytes(4, 1.0); 3]);
        let bytes = [1.0, 1.1, 1.2, 1.4, 1.7].map(|scale| bytes(5, scale));
        assert!(bytes.iter().all(|other| other.abs_diff(bytes[0]) < bytes[0] / 100), "{bytes:?}");
    }
}
