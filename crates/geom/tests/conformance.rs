//! Every accelerator against the contract: named hard cases, six families of random scenes, and
//! leaks at the edges and vertices of closed meshes.
//!
//! `GLOBILLUM_EFFORT` multiplies the number of rays (1 by default).

use glam::DVec3;
use globillum_geom::conformance::shapes::{Mesh, icosphere, statue, torus};
use globillum_geom::conformance::{Regime, Seeded, Source, Suite, Tally, Target, cases, check_bytes, leaks};
use globillum_geom::{Accel, BruteForce, KdTree, Triangles, UniformGrid};
use globillum_testkit::accelerators::{self, Unanimous};
use globillum_testkit::effort;
use proptest::prelude::*;
use rayon::prelude::*;

macro_rules! hard_cases {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            let tally = cases::$name().check(Unanimous::build);
            assert!(tally.is_ok(), "{}", tally.unwrap_err());
        })*

        #[test]
        fn every_case_has_its_test() {
            assert_eq!([$(stringify!($name)),*].len(), cases::all().len());
        }
    };
}

hard_cases! {
    along_a_face_diagonal
    signed_zeros_and_origins_on_the_boundary
    within_the_plane_of_a_face
    along_an_edge
    through_opposite_vertices
    directions_close_to_an_axis
    a_lattice_of_shared_vertices
    origins_on_every_plane_through_a_vertex
    rays_within_planes_that_hold_triangles
    origins_on_a_triangle
    origins_outside_inside_and_behind
    directions_of_any_length
    zero_nan_and_infinite_rays
    empty_ranges
    ranges_are_open
    grazing_a_long_plane
    origins_far_away
    no_triangles
    duplicate_triangles
    excluded_triangles
    a_scene_flat_in_x
    a_scene_flat_in_y
    a_scene_flat_in_z
    degenerate_triangles
    aimed_rays_at_aligned_offset_thin_and_round_scenes
}

/// A family whose rays hit nothing, or always, compares little.
#[test]
fn every_family_hits_and_misses() {
    let mut source = Seeded::new(2);
    for regime in Regime::ALL {
        let mut tally = Tally::default();
        for _ in 0..400 {
            tally += regime.check(&mut source, 64, |t| Ok(BruteForce::build(t))).unwrap();
        }
        let share = tally.hits as f64 / tally.rays as f64;
        assert!((0.15..0.85).contains(&share), "{regime:?}: {tally:?}");
        assert!(tally.rays > 15_000, "{regime:?}: {tally:?}");
    }
}

/// Every comparison includes that `occluded` is `intersect().is_some()`.
#[test]
fn random_scenes_of_six_families() {
    [1, 2].into_par_iter().for_each(|seed| {
        let suite = Suite { rays: 400_000 * u64::from(effort()), seed };
        match suite.check(Unanimous::build) {
            Ok(tally) => {
                // A suite that hits nothing, or everything, compares little.
                let share = tally.hits as f64 / tally.rays as f64;
                assert!((0.2..0.8).contains(&share), "{tally:?}");
            }
            Err(violation) => panic!("{violation}"),
        }
    });
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// The same families through a shrinking generator, which makes small counterexamples.
    #[test]
    fn random_scenes_that_shrink(bits in prop::collection::vec(any::<u64>(), 8..512), which in 0usize..6) {
        let tally = Regime::ALL[which].check(&mut bits.into_iter(), 16, Unanimous::build);
        prop_assert!(tally.is_ok(), "{}", tally.unwrap_err());
    }
}

/// What the fuzzer keeps, and whatever it ever found (`fuzz/README.md`).
#[test]
fn the_fuzzers_corpus() {
    let corpus = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/corpus/accelerators");
    let mut files = 0;
    for file in std::fs::read_dir(corpus).unwrap() {
        let path = file.unwrap().path();
        let bytes = std::fs::read(&path).unwrap();
        let tally = check_bytes(&bytes, Unanimous::build);
        assert!(tally.is_ok(), "{}: {}", path.display(), tally.unwrap_err());
        files += 1;
    }
    assert!(files > 0, "{corpus} is empty");
}

/// At the edges and vertices of closed meshes, of any size and far from the origin.
#[test]
fn no_ray_leaks_at_edges_or_vertices() {
    let far = DVec3::new(1e5, -1e5, 1e5);
    let placements = [(1e-6, DVec3::ZERO), (1.0, DVec3::ZERO), (1e6, DVec3::ZERO), (1.0, far)];
    let meshes: [fn() -> Mesh; 3] = [|| icosphere(3), || torus(24, 12), || statue(2000)];
    let rays = 8_000 * u64::from(effort());
    let placed = meshes.iter().flat_map(|mesh| placements.map(|placement| (mesh(), placement)));
    placed.collect::<Vec<_>>().into_par_iter().enumerate().for_each(|(seed, (mesh, (scale, offset)))| {
        let mut source = Seeded::new(seed as u64);
        let mesh = mesh.placed(scale, offset);
        let triangles = Triangles::new(mesh.triangles()).unwrap();
        assert_eq!(triangles.degenerate_count(), 0, "scale {scale}, offset {offset}");
        for (accelerator, build) in accelerators::all() {
            let accel = build(&triangles).unwrap();
            for target in [Target::Edges, Target::Vertices] {
                let leaks = leaks(&*accel, &mesh, target, rays, &mut source);
                assert_eq!(leaks, 0, "{accelerator}, {target:?}, scale {scale}, offset {offset}");
            }
        }
    });
}

/// Origins on the split planes that the accelerators really have.
#[test]
fn origins_on_the_structures_own_planes() {
    let triangles = Triangles::new(statue(1500).triangles()).unwrap();
    let kd = KdTree::build(&triangles).unwrap();
    let grid = UniformGrid::build(&triangles).unwrap();
    let mut planes: Vec<(usize, f64)> = kd.planes().map(|(axis, at)| (axis, f64::from(at))).collect();
    for axis in 0..3 {
        planes.extend(grid.planes(axis).map(|at| (axis, at)));
    }
    let mut source = Seeded::new(8);
    let mut ray = || {
        let mut origin = DVec3::new(source.signed(), source.signed(), source.signed());
        let mut direction = DVec3::new(source.signed(), source.signed(), source.signed());
        for _ in 0..source.below(4) {
            let (axis, at) = source.pick(&planes);
            origin[axis] = at;
            direction[axis] = source.pick(&[1.0, -1.0, 0.0, -0.0]);
        }
        globillum_geom::Ray::new(origin, direction)
    };
    let rays: Vec<_> = (0..4000).map(|_| ray()).collect();
    for accel in [&kd as &dyn Accel, &grid] {
        globillum_geom::conformance::compare("origins on split planes", accel, triangles.as_slice(), &rays)
            .unwrap();
    }
}
