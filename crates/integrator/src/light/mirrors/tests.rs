use super::mirror_tree::Choice;
use super::*;
use crate::Stream;
use crate::light::Receiver;
use glam::{DVec3, Vec3};
use globillum_geom::conformance::shapes::{cuboid, icosphere, quad, torus};
use globillum_geom::{Ray, Triangle};
use globillum_material::{Emission, Rgb, Sides};

/// The mirrors above a floor and below two lights of this size, with lengths times `unit`.
fn scene(mirrors: &[Triangle], size: f64, unit: f32) -> (Triangles, Mirrors) {
    scene_beside(&[], mirrors, size, unit)
}

/// The same beside `others`, which come last and do not reflect.
fn scene_beside(others: &[Triangle], mirrors: &[Triangle], size: f64, unit: f32) -> (Triangles, Mirrors) {
    let p = DVec3::new;
    let floor = quad(p(-2.0, -1.0, 2.0), p(2.0, -1.0, 2.0), p(2.0, -1.0, -2.0), p(-2.0, -1.0, -2.0));
    let [light, other] = [-1.0, 3.8 * size - 1.0].map(|x| {
        let (near, far) = (0.1 + size, x + size);
        quad(p(x, 3.0, 0.1), p(far, 3.0, 0.1), p(far, 3.0, near), p(x, 3.0, near))
    });
    let all = [&light, &other, &floor, mirrors, others].map(<[Triangle]>::to_vec).concat();
    let scaled = |triangle: &Triangle| Triangle { vertices: triangle.vertices.map(|v| unit * v) };
    let triangles = Triangles::new(all.iter().map(scaled).collect()).unwrap();
    let glow = Emission::new(Rgb::WHITE, Sides::Both).unwrap();
    let lights = Lights::of(&triangles, |index| if index < 4 { glow } else { Emission::NONE }, &[]);
    let are_mirrors = 6..6 + mirrors.len() as u32;
    let mirrors = Mirrors::of(&triangles, |index| are_mirrors.contains(&index), &lights);
    (triangles, mirrors)
}

/// A column of 64 facets, which are small beside lights of half a unit, and of which each is cut into parts.
fn column() -> Vec<Triangle> {
    let corner = |i: u32, y: f64| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / 64.0);
        DVec3::new(0.2 + 0.3 * cos, y, 0.1 + 0.3 * sin)
    };
    (0..64)
        .flat_map(|i| quad(corner(i, 1.2), corner(i + 1, 1.2), corner(i + 1, -0.6), corner(i, -0.6)))
        .collect()
}

fn shapes() -> [(&'static str, Vec<Triangle>); 4] {
    [
        ("a column", column()),
        ("a block", cuboid(DVec3::new(0.3, 0.4, -0.2), DVec3::new(0.3, 0.6, 0.4), 0.32).to_vec()),
        ("a ball", icosphere(3).placed(0.7, DVec3::new(0.2, 0.3, 0.0)).triangles()),
        ("a ring", torus(40, 20).triangles()),
    ]
}

/// Small mirrors, chosen from cells and by descents in the mirror tree.
fn chosen_both_ways(mirrors: &Mirrors) -> [SmallMirrors; 2] {
    let small = mirrors.small.clone().expect("there are small mirrors");
    [small.clone(), small.without_cells()]
}

/// `n` numbers in `[0, 1)`.
fn evenly_spaced(n: u32) -> impl Iterator<Item = f64> {
    (0..n).map(move |k| (f64::from(k) + 0.5) / f64::from(n))
}

/// On a surface that faces up.
fn upward(position: DVec3) -> Receiver {
    Receiver { position, normal: Vec3::Y }
}

/// A point of the floor, and one of a light.
fn ends(triangles: &Triangles, numbers: Stream) -> (DVec3, u32, DVec3) {
    let point = |index: u32, k: u32| {
        let (u, v) = Triangle::sample_uniform(numbers.uniform_pair(k));
        triangles.surface_point(index, u, v).position
    };
    let [floor, light] = [4, 0].map(|first| first + (4.0 * numbers.uniform(first)) as u32);
    (point(4 + floor % 2, 8), light, point(light, 10))
}

/// Whether the triangle reflects a ray from `from` to `to`, both outside of its body, on its front.
fn reflects(triangles: &Triangles, index: u32, from: DVec3, to: DVec3) -> bool {
    let triangle = triangles.get(index);
    let (normal, corner) = (triangle.normal(), triangle.vertices[0].as_dvec3());
    let heights = [from, to].map(|end| normal.dot(end - corner));
    let image = from - 2.0 * heights[0] * normal;
    let toward = to - image;
    let reflected = toward - 2.0 * normal.dot(toward) * normal;
    let ray = Ray::new(from, reflected);
    let is_hit = Facet::of(index, triangle).may_be_hit_by(triangles, &ray);
    heights[0] > 1e-3 * triangle.area().sqrt() && heights[1] > 0.0 && is_hit
}

/// A sun that looks as large as before and is farther away leaves a mirror large.
#[test]
fn a_mirror_is_as_large_as_it_looks_beside_the_light() {
    let p = DVec3::new;
    let mirror = quad(p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0));
    for (distance, half, is_large) in
        [(2.0, 0.5, true), (2.0, 4.0, false), (1e2, 5.0, true), (1e6, 5e4, true), (1e6, 2e6, false)]
    {
        let sun = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(x, z)| p(half * x, distance, half * z));
        let sun = quad(sun[0], sun[1], sun[2], sun[3]);
        let triangles = Triangles::new([sun, mirror].as_flattened().to_vec()).unwrap();
        let glow = Emission::new(Rgb::WHITE, Sides::Both).unwrap();
        let lights = Lights::of(&triangles, |index| if index < 2 { glow } else { Emission::NONE }, &[]);
        let mirrors = Mirrors::of(&triangles, |index| index >= 2, &lights);
        assert_eq!((mirrors.large.is_some(), mirrors.small.is_none()), (is_large, is_large), "{distance}");
    }
}

/// No bound is too small: a mirror that reflects a point of a light to the receiver has a probability above
/// zero there, also where the scene is far larger than the mirrors.
#[test]
fn every_mirror_that_shows_a_light_is_sampled() {
    for (what, shape) in shapes() {
        // Bounds are tightest around small lights.
        let stages = [
            (0.5, 1.0, 0),
            (0.5, 2.0_f32.powi(40), 0),
            (0.5, 2.0_f32.powi(-40), 0),
            (1e-3, 1.0, 0),
            (1e-3, 1.0, 1),
        ];
        let mountain = [Triangle { vertices: [Vec3::X, Vec3::Y, Vec3::Z].map(|v| 1e7 * v) }];
        for (size, unit, mountains) in stages {
            let (triangles, mirrors) = scene_beside(&mountain[..mountains], &shape, size, unit);
            let small = mirrors.small.is_some().then(|| chosen_both_ways(&mirrors));
            let mut shown = 0;
            for i in 0..400 {
                let (from, light, to) = ends(&triangles, Stream::new(1, 0, i));
                let are_mirrors = 6..6 + shape.len() as u32;
                for index in are_mirrors.filter(|&i| reflects(&triangles, i, from, to)) {
                    shown += 1;
                    let by_large = mirrors
                        .large
                        .as_ref()
                        .and_then(|large| large.chosen(&triangles, upward(from), large.facet_of(index)?));
                    let is_chosen = |small: &SmallMirrors| {
                        small.prob_to_reflect(&triangles, upward(from), index, (light, to)).is_some()
                    };
                    assert!(
                        by_large.is_some() || small.as_ref().is_some_and(|both| both.iter().all(is_chosen)),
                        "{what}, {size}, {unit}, {mountains}, {i}: {index}"
                    );
                }
            }
            assert!(shown > 8, "{what}: {shown}");
        }
    }
}

/// The list of a cell has all mirrors of which its points see any show a light: on floor and walls, between the mirrors, inside
/// of bodies and beside them.
#[test]
fn cells_list_all_mirrors_that_show_lights() {
    for (what, shape) in shapes().into_iter().filter(|(what, _)| *what != "a block") {
        // Open ones reflect on both sides.
        for mirrors in [&shape[..], &shape[..shape.len() - 1]] {
            for size in [0.5, 1.0] {
                let small = scene(mirrors, size, 1.0).1.small.unwrap();
                let mut listed = 0;
                for i in 0..2000 {
                    let numbers = Stream::new(6, 0, i);
                    let vector =
                        |k: u32| DVec3::from([0, 1, 2].map(|axis| 2.0 * numbers.uniform(k + axis) - 1.0));
                    let around = [DVec3::new(2.0, 1.0, 2.0), DVec3::ONE][i as usize % 2];
                    let receiver =
                        Receiver { position: around * vector(0), normal: vector(3).normalize().as_vec3() };
                    let leaves = small.listed_leaves(receiver, i % 4);
                    assert!(leaves.iter().all(|&is_listed| is_listed), "{what}, {size}, {i}: {receiver:?}");
                    listed += leaves.len();
                }
                assert!(listed > 100, "{what}, {size}: {listed}");
            }
        }
    }
}

/// A receiver outside of the scene's bounds, which has no cell.
#[test]
fn mirrors_show_lights_outside_of_the_scene() {
    let (triangles, mirrors) = scene(&shapes()[2].1, 0.5, 1.0);
    let [by_cells, by_descents] = chosen_both_ways(&mirrors);
    let from = DVec3::new(0.5, 0.2, 30.0);
    assert!(triangles.bounds().max.as_dvec3().cmplt(from).any());
    let receiver = Receiver { position: from, normal: Vec3::NEG_Z };
    let choices = evenly_spaced(1000).map(|u| (by_cells.choice(receiver, 0, f64::INFINITY, u), u));
    let mut chosen = 0;
    for (choice, u) in choices {
        assert_eq!(choice, by_descents.choice(receiver, 0, f64::INFINITY, u), "{u}");
        chosen += i32::from(choice.is_some());
    }
    assert!(chosen > 10, "{chosen}");
}

/// Of `n` evenly spaced numbers, the share that chooses a large facet is its probability, to within one number.
#[test]
fn large_facets_are_chosen_as_often_as_told() {
    let (triangles, mirrors) = scene(&shapes()[1].1, 0.5, 1.0);
    let large = mirrors.large.unwrap();
    let mut seen = 0;
    for i in 0..12 {
        let (from, ..) = ends(&triangles, Stream::new(2, 0, i));
        let n = 4096;
        let mut times = std::collections::HashMap::new();
        for u in evenly_spaced(n) {
            let Some(chosen) = large.choose(&triangles, upward(from), || u) else { continue };
            let again = large.chosen(&triangles, upward(from), chosen.index).unwrap();
            assert_eq!(again.prob, chosen.prob);
            times.entry(chosen.index).or_insert((0, chosen.prob)).0 += 1;
        }
        for (times, prob) in times.into_values() {
            seen += 1;
            assert!((f64::from(times) - prob * f64::from(n)).abs() <= 1.0, "{times}, {prob}");
        }
    }
    assert!(seen > 8, "{seen}");
}

/// Of evenly spaced numbers, the mean of `weight / prob` where a small facet is chosen is 1: it counts once. Every set of
/// candidates has an interval of numbers, at whose ends one counts or does not: at most 2.3 numbers in all are found here by
/// descents, and 4 are the limit.
#[test]
fn small_facets_count_once() {
    const MAX_NUMBERS: f64 = 4.0;
    let n = 1 << 18;
    for (what, shape) in shapes().into_iter().filter(|(what, _)| *what != "a block") {
        let (triangles, mirrors) = scene(&shape, 0.5, 1.0);
        let number = mirrors.small.as_ref().map_or(0, SmallMirrors::len);
        assert_eq!(number > shape.len(), what == "a column", "{what}: {number}");
        for small in chosen_both_ways(&mirrors) {
            let (mut seen, mut reweighted) = (0, 0);
            for i in 0..6 {
                let (from, light, _) = ends(&triangles, Stream::new(2, 0, i));
                let attempts = [30.0, f64::INFINITY][i as usize % 2];
                let mut facets = std::collections::HashMap::new();
                for u in evenly_spaced(n) {
                    let Some(Choice { place, prob, weight }) = small.choice(upward(from), light, attempts, u)
                    else {
                        continue;
                    };
                    let (mean, largest, of_facet) = facets.entry(place).or_insert((0.0, 0.0_f64, prob));
                    assert_eq!(*of_facet, prob, "{what}");
                    (*mean, *largest) = (*mean + weight / prob / f64::from(n), largest.max(weight / prob));
                    reweighted += i32::from((weight - 1.0).abs() > 0.1);
                }
                for (place, (mean, largest, prob)) in facets {
                    let again = small.choice_prob(upward(from), place, light, attempts);
                    assert_eq!(again, Some(prob), "{what}");
                    let margin = MAX_NUMBERS * largest / f64::from(n);
                    seen += i32::from(margin < 0.05);
                    assert!((mean - 1.0).abs() <= margin, "{what}, {i}, {place}: {mean}, {margin}");
                }
            }
            assert!(seen > 8 && reweighted > 1000, "{what}: {seen}, {reweighted}");
        }
    }
}

/// Leaves around a receiver do not take all probability from the others.
#[test]
fn close_leaves_do_not_crowd_out_mirrors_that_show_a_light() {
    let (triangles, mirrors) = scene(&torus(40, 20).triangles(), 0.5, 1.0);
    for small in chosen_both_ways(&mirrors) {
        let (mut shown, mut least) = (0, 1.0_f64);
        for i in 0..200 {
            let numbers = Stream::new(3, 0, i);
            let [x, z] = numbers.uniform_pair(0).map(|u| 2.0 * u - 1.0);
            // Between the middle of the ring and the floor.
            let (from, (_, light, to)) = (DVec3::new(x, -0.3, z), ends(&triangles, numbers));
            for index in (6..triangles.len() as u32).filter(|&i| reflects(&triangles, i, from, to)) {
                let prob = small.prob_to_reflect(&triangles, upward(from), index, (light, to));
                (shown, least) = (shown + 1, least.min(prob.unwrap_or(0.0)));
            }
        }
        assert!(shown > 8 && least > 1e-4, "{shown}, {least}");
    }
}

/// The variance grows with the mean of `1 / p`, for the probabilities `p` of mirrors that show a point of a light: 38 here, 51
/// in proportion to the share that may show lights instead of its square root, and 920 if facets count whether or not
/// they show any.
#[test]
fn mirrors_that_show_a_light_are_chosen_often() {
    let (triangles, mirrors) = scene(&shapes()[2].1, 0.2, 1.0);
    for (small, limit) in chosen_both_ways(&mirrors).into_iter().zip([30.0, 40.0]) {
        let mut costs = Vec::new();
        for i in 0..8000 {
            let (from, light, to) = ends(&triangles, Stream::new(5, 0, i));
            for index in (6..triangles.len() as u32).filter(|&i| reflects(&triangles, i, from, to)) {
                let prob = small.prob_to_reflect(&triangles, upward(from), index, (light, to));
                costs.push(prob.map_or(f64::INFINITY, f64::recip));
            }
        }
        let mean = costs.iter().sum::<f64>() / costs.len() as f64;
        assert!(costs.len() > 100 && mean > 1.0 && mean < limit, "{mean}, {}", costs.len());
    }
}

#[test]
fn a_point_in_a_mirrors_plane_has_no_image_in_it() {
    let (triangles, mirrors) = scene(&[Triangle::new(Vec3::ZERO, Vec3::Z, Vec3::X)], 0.5, 1.0);
    let large = mirrors.large.unwrap();
    let at = |y: f64| {
        let from = DVec3::new(0.2, y, 0.2);
        let receiver = Receiver { position: from, normal: -Vec3::Y * y.signum() as f32 };
        let chosen = large.choose(&triangles, receiver, || 0.5)?;
        Some(chosen.facet.image_of(receiver).position.y)
    };
    assert_eq!((at(0.0), at(1e-7), at(-1.0), at(1.0)), (None, None, None, Some(-1.0)));
}

#[test]
fn a_scene_without_area_lights_has_no_mirrors_to_sample() {
    let triangles = Triangles::new(shapes()[0].1.clone()).unwrap();
    let dark = Lights::of(&triangles, |_| Emission::NONE, &[]);
    assert!(Mirrors::of(&triangles, |_| true, &dark).is_empty());
}
