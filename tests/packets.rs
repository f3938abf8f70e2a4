//! Batches of coherent rays, which some accelerators trace in packets, against brute force.

use glam::DVec3;
use globillum::geom::conformance::{Seeded, Source};
use globillum::geom::{Accel, BruteForce, Ray, SimdLevel, Triangles, WideBvh};
use globillum_testkit::shapes::{cuboid, icosphere};

fn vector(source: &mut Seeded) -> DVec3 {
    DVec3::new(source.signed(), source.signed(), source.signed())
}

/// A box full of small things: boxes along the axes, and a sphere.
fn furnished(source: &mut Seeded) -> Triangles {
    let mut triangles = cuboid(DVec3::ZERO, DVec3::splat(1.2), 0.0);
    for _ in 0..60 {
        let half = DVec3::splat(0.02) + 0.1 * vector(source).abs();
        triangles.extend(cuboid(vector(source), half, 0.0));
    }
    triangles.extend(icosphere(2).placed(0.3, DVec3::ZERO).triangles());
    Triangles::new(triangles).unwrap()
}

/// Segments between two places, up to a fifth wide; some along axes, some with a range of their own.
fn beam(source: &mut Seeded, count: usize) -> Vec<Ray> {
    let (from, mut to) = (vector(source), vector(source));
    if source.one_in(3) {
        // Into two octants.
        to.x = from.x;
    }
    let width = 10.0_f64.powf(-1.0 - 4.0 * source.unit());
    let is_flat = source.one_in(4);
    let ray = |_| {
        let start = from + width * vector(source);
        let mut ray = Ray::segment(start, to + width * vector(source));
        if is_flat {
            ray.direction[source.below(3)] = source.pick(&[0.0, -0.0]);
        }
        if source.one_in(8) {
            ray.t_min = source.signed();
            ray.t_max = ray.t_min + source.pick(&[0.1, 1.0, f64::INFINITY]);
        }
        ray
    };
    (0..count).map(ray).collect()
}

/// Makes something of a ray that no packet can contain, or that meets nothing.
fn spoil(ray: &mut Ray, source: &mut Seeded) {
    match source.below(6) {
        0 => ray.direction = DVec3::ZERO,
        1 => ray.direction.y = f64::NAN,
        2 => ray.t_max = ray.t_min,
        3 => ray.origin += 1e9 * DVec3::X,
        4 => ray.origin -= 1e15 * ray.direction,
        _ => ray.direction = -ray.direction,
    }
}

/// Batches of one ray, of whole packets and of parts of them, at each level.
#[test]
fn batches_are_answered_as_each_ray_alone() {
    let mut source = Seeded::new(21);
    let triangles = furnished(&mut source);
    let (tree, brute) = (WideBvh::build(&triangles).unwrap(), BruteForce::build(&triangles));
    let levels = SimdLevel::ALL.map(|level| tree.clone().with_level(level));
    let (mut found, mut occluded, mut all) = (Vec::new(), 0, 0);
    for round in 0..120 {
        let mut rays = beam(&mut source, [1, 3, 63, 64, 65, 200][round % 6]);
        if round % 4 == 3 {
            for ray in &mut rays {
                if source.one_in(5) {
                    spoil(ray, &mut source);
                }
            }
        }
        let expected: Vec<bool> = rays.iter().map(|ray| brute.occluded(ray)).collect();
        assert_eq!(rays.iter().map(|ray| tree.occluded(ray)).collect::<Vec<_>>(), expected);
        for tree in &levels {
            tree.occluded_batch(&rays, &mut found);
            assert_eq!(found, expected, "{:?}, {rays:?}", tree.level());
        }
        occluded += expected.iter().filter(|occluded| **occluded).count();
        all += rays.len();
    }
    assert!(occluded > all / 4 && occluded < 3 * all / 4, "{occluded} of {all}");
}

/// Rays from one point around a direction, which some accelerators trace in packets; of every fourth set, two axes are
/// the longest of this direction.
fn pencil(source: &mut Seeded) -> Vec<Ray> {
    let origin = vector(source) * 30.0_f64.powf(source.unit());
    let mut direction = vector(source) - origin;
    if source.one_in(4) {
        direction.y = -direction.x;
    }
    let spread = direction.length() * 10.0_f64.powf(-1.6 - 4.0 * source.unit());
    let mut ray = |_| {
        let t_min = (0.4 * source.signed()).max(0.0);
        let t_max = if source.one_in(2) { f64::INFINITY } else { t_min + source.unit() };
        Ray { t_min, t_max, ..Ray::new(origin, direction + spread * vector(source)) }
    };
    (0..64).map(&mut ray).collect()
}

#[test]
fn rays_from_one_point_find_what_each_finds_alone() {
    let mut source = Seeded::new(5);
    let triangles = furnished(&mut source);
    let (tree, brute) = (WideBvh::build(&triangles).unwrap(), BruteForce::build(&triangles));
    let levels = SimdLevel::ALL.map(|level| tree.clone().with_level(level));
    let (mut hits, mut occluded, mut found) = (Vec::new(), Vec::new(), 0);
    for _ in 0..200 {
        let rays = pencil(&mut source);
        let expected: Vec<_> = rays.iter().map(|ray| brute.intersect(ray)).collect();
        for tree in &levels {
            tree.intersect_batch(&rays, &mut hits);
            assert_eq!(hits, expected, "{:?}, {rays:?}", tree.level());
            tree.occluded_batch(&rays, &mut occluded);
            assert!(occluded.iter().zip(&expected).all(|(occluded, hit)| *occluded == hit.is_some()));
        }
        found += expected.iter().flatten().count();
    }
    assert!(found > 1000, "{found}");
}
