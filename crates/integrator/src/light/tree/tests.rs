use super::*;
use crate::Stream;
use glam::DVec3;
use std::iter;

/// Uniform in `[-1, 1]^3`.
fn vector(numbers: Stream, dimension: u32) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|k| 2.0 * numbers.uniform(dimension + k) - 1.0))
}

/// `n` lights of all kinds, of intensities over twelve orders of magnitude, every seventh infinitely far
/// away; positions times `unit`.
fn lights(n: u32, unit: f64) -> Vec<TreeLight> {
    let light = |i: u32| {
        let numbers = Stream::new(7, n.into(), i);
        let intensity = 10.0_f64.powf(12.0 * numbers.uniform(0) - 6.0);
        let (at, axis) = (unit * vector(numbers, 1), vector(numbers, 4).normalize());
        let beside = |dimension| at + 0.05 * unit * vector(numbers, dimension);
        match i % 7 {
            0..=3 => {
                let vertices = [at, beside(7), beside(10)];
                TreeLight::Near(LightMoments::of_triangle(vertices, axis, i.is_multiple_of(2), intensity))
            }
            4 => TreeLight::Near(LightMoments::of_point(at, intensity)),
            5 => TreeLight::Near(LightMoments::of_spot(at, axis, 0.5, intensity)),
            _ => TreeLight::Far(FarLight { irradiance: intensity, direction: axis }),
        }
    };
    (0..n).map(light).collect()
}

/// At the lights, between them, and far away, on surfaces of all directions.
fn receivers() -> impl Iterator<Item = Receiver> {
    let normal = |i| vector(Stream::new(12, 0, i), 0).normalize().as_vec3();
    (0..).zip(positions()).map(move |(i, position)| Receiver { position, normal: normal(i) })
}

fn positions() -> impl Iterator<Item = DVec3> {
    (0..6).map(|i| vector(Stream::new(8, 0, i), 0) * [1.0, 0.1, 3.0][i as usize % 3]).chain([
        DVec3::ZERO,
        DVec3::splat(1e9),
        near(&lights(40, 1.0)[4]).center,
    ])
}

fn near(light: &TreeLight) -> LightMoments {
    match light {
        TreeLight::Near(moments) => *moments,
        TreeLight::Far(light) => panic!("{light:?}"),
    }
}

/// A tree over [`lights`], and the same by visibility, with two of three lights always visible, and one never.
fn trees(n: u32) -> impl Iterator<Item = LightTree> {
    let tree = LightTree::new(&lights(n, 1.0), &Aabb::EMPTY);
    let counts: Vec<_> = (0..n).map(|i| VisibilityCount::new(1000, 1000 * u32::from(i % 3 > 0))).collect();
    let by_visibility = tree.by_visibility(&counts);
    assert!(by_visibility.is_some() || n < 9);
    iter::once(tree).chain(by_visibility)
}

#[test]
fn each_light_has_a_chance_and_all_together_certainty() {
    for (n, tree) in
        [1, 2, 7, 9, 17, 18, 19, 20, 40, 1000].into_iter().flat_map(|n| trees(n).map(move |tree| (n, tree)))
    {
        for receiver in receivers() {
            let probs = (0..n as usize).map(|index| tree.prob(receiver, index));
            let (sum, least) = probs.fold((0.0, 1.0_f64), |(sum, least), prob| (sum + prob, prob.min(least)));
            assert!((sum - 1.0).abs() < 1e-12, "{n} lights from {receiver:?}: {sum}");
            assert!(least > 2.0_f64.powi(-330), "{n} lights from {receiver:?}: {least}");
        }
    }
}

/// Each light has an interval of `u`, or one in each of two columns of the table for the lights infinitely
/// far away: of evenly spaced numbers it gets its share, to within one for each end.
#[test]
fn lights_are_chosen_with_their_probability() {
    for (n, tree) in [1, 5, 40, 300].into_iter().flat_map(|n| trees(n).map(move |tree| (n, tree))) {
        for receiver in receivers() {
            let (draws, mut counts) = (10_000, vec![0.0; n as usize]);
            for i in 0..draws {
                let [chosen] = tree.choose(receiver, [(f64::from(i) + 0.5) / f64::from(draws)]);
                let (index, prob) = (chosen.index as usize, chosen.prob);
                assert_eq!(
                    prob.to_bits(),
                    tree.prob(receiver, index).to_bits(),
                    "light {index} from {receiver:?}"
                );
                counts[index] += 1.0;
            }
            for (index, count) in counts.iter().enumerate() {
                let expected = f64::from(draws) * tree.prob(receiver, index);
                let ends = if matches!(tree.addresses[index], Address::Path(_)) { 1.001 } else { n as f64 };
                assert!(
                    f64::abs(count - expected) <= ends,
                    "light {index} of {n} from {receiver:?}: {count}, {expected}"
                );
            }
        }
    }
}

/// Those infinitely far away and every fifth light are never visible, the others from everywhere.
#[test]
fn hidden_lights_are_chosen_rarely() {
    let n = 300;
    let is_hidden = |index: u32| index % 7 == 6 || index.is_multiple_of(5);
    let tree = LightTree::new(&lights(n, 1.0), &Aabb::EMPTY);
    let mut counts = vec![VisibilityCount::default(); n as usize];
    for (k, receiver) in (0..).zip(receivers()) {
        for i in 0..4000 {
            let [chosen] = tree.choose(receiver, [Stream::new(16, k, i).uniform(0)]);
            counts[chosen.index as usize].add(!is_hidden(chosen.index));
        }
    }
    let by_visibility = tree.by_visibility(&counts).expect("some are hidden");
    let prob_of_hidden = |tree: &LightTree| -> f64 {
        let of_receiver =
            |receiver| (0..n).filter(|&i| is_hidden(i)).map(move |i| tree.prob(receiver, i as usize));
        receivers().flat_map(of_receiver).sum::<f64>() / receivers().count() as f64
    };
    let [before, after] = [&tree, &by_visibility].map(prob_of_hidden);
    assert!(before > 0.6 && after < 0.3, "{before}, {after}");
    let visible = vec![VisibilityCount::new(10_000, 5000); n as usize];
    assert!(tree.by_visibility(&visible).is_none());
}

/// What lights infinitely far away leave of the largest number below 1 must not round to 1. The last light has a
/// probability above `2^-50`.
#[test]
fn the_largest_number_chooses_the_last_light() {
    let tree = LightTree::new(&lights(40, 1.0), &Aabb::EMPTY);
    for i in 0..200 {
        let numbers = Stream::new(11, 0, i);
        let receiver =
            Receiver { position: vector(numbers, 0), normal: vector(numbers, 3).as_vec3().normalize() };
        let [last, before] = tree.choose(receiver, [1.0_f64.next_down(), 1.0 - 2.0_f64.powi(-50)]);
        assert_eq!(last, before, "{i}");
    }
}

#[test]
fn several_choices_at_once_are_those_one_by_one() {
    let tree = LightTree::new(&lights(300, 1.0), &Aabb::EMPTY);
    let receivers: Vec<_> = receivers().collect();
    for i in 0..1000 {
        let numbers = Stream::new(10, 0, i);
        let us = [0, 1, 2, 3].map(|k| numbers.uniform(k));
        let four = [4, 5, 6, 7].map(|k| receivers[(numbers.uniform(k) * receivers.len() as f64) as usize]);
        let alone = |receiver: Receiver, u: f64| tree.choose(receiver, [u])[0];
        assert_eq!(tree.choose_each(four, us), std::array::from_fn(|k| alone(four[k], us[k])), "{i}");
        assert_eq!(tree.choose(four[0], us), us.map(|u| alone(four[0], u)), "{i}");
    }
}

#[test]
fn the_unit_of_length_does_not_matter() {
    for unit in [2.0_f64.powi(-40), 2.0_f64.powi(60)] {
        // Irradiances from infinity have a unit of their own.
        let lights = |unit| {
            let near = lights(100, unit).into_iter().filter(|light| matches!(light, TreeLight::Near(_)));
            LightTree::new(&near.collect::<Vec<_>>(), &Aabb::EMPTY)
        };
        let (tree, scaled) = (lights(1.0), lights(unit));
        for receiver in receivers() {
            for i in 0..100 {
                let u = f64::from(i) / 100.0;
                assert_eq!(
                    tree.choose(receiver, [u]),
                    scaled.choose(Receiver { position: unit * receiver.position, ..receiver }, [u]),
                    "{unit} {receiver:?} {u}"
                );
            }
        }
    }
}

/// Eight spot lights in one place: each is chosen within its beam, whatever the size of the scene. From a point of the
/// air far outside of the scene, too.
#[test]
fn spot_lights_in_one_place_are_told_apart_at_any_scale() {
    let axes = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| vector(Stream::new(22, 0, i), 0).normalize());
    let mut usual = None;
    for unit in [1.0, 2.0_f64.powi(-80), 2.0_f64.powi(54)] {
        let at = unit * DVec3::new(0.25, 0.5, 0.0);
        let spots = axes.map(|axis| {
            let cos_outer = libm::cos(10.0_f64.to_radians());
            TreeLight::Near(LightMoments::of_spot(at, axis, cos_outer, unit * unit))
        });
        let half = Vec3::splat(2.0 * unit as f32);
        let tree = LightTree::new(&spots, &Aabb { min: -half, max: half });
        let prob = |index: usize, distance: f64| {
            let position = at + distance * unit * axes[index];
            tree.prob(Receiver { position, normal: -axes[index].as_vec3() }, index)
        };
        let probs = [0, 1, 2, 3, 4, 5, 6, 7].map(|index| [1e-3, 1.5, 1e30].map(|to| prob(index, to)));
        assert!(probs.as_flattened().iter().all(|&prob| prob > 0.9), "{unit}: {probs:?}");
        assert_eq!(*usual.get_or_insert(probs), probs, "{unit}");
    }
}

/// The sun as a mesh, and a lamp that brings as much to a point at this distance.
#[test]
fn a_lamp_is_told_from_a_distant_sun() {
    for distance in [0.01, 1.0, 100.0] {
        let lamp = LightMoments::of_point(DVec3::new(3.0, 2.0, 1.0), distance * distance);
        let to_sun = 1.5e11 * DVec3::new(0.6, 0.8, 0.0);
        let corners = [DVec3::X, DVec3::Z, DVec3::NEG_ONE].map(|corner| to_sun + 7e8 * corner);
        let sun = LightMoments::of_triangle(corners, -to_sun.normalize(), false, 1.5e11_f64.powi(2));
        let tree = LightTree::new(&[TreeLight::Near(lamp), TreeLight::Near(sun)], &Aabb::EMPTY);
        let below = lamp.center - distance * to_sun.normalize();
        let receiver = Receiver { position: below, normal: to_sun.normalize().as_vec3() };
        let prob = tree.prob(receiver, 0);
        assert!((prob - 0.5).abs() < 0.01, "{distance}: {prob}");
    }
}

/// Two equal lights at distances 1 and 10, one that turns its back, one behind the surface, and a spot light that shines
/// past the receiver by less than a degree.
#[test]
fn near_lights_in_front_that_face_the_receiver_are_preferred() {
    let light = |x: f64, axis| {
        let vertices = [DVec3::Y, DVec3::Z, DVec3::NEG_ONE].map(|v| DVec3::new(x, 0.0, 0.0) + 1e-3 * v);
        TreeLight::Near(LightMoments::of_triangle(vertices, axis, false, 1.0))
    };
    let [toward, away] = [DVec3::NEG_X, DVec3::X];
    let past = TreeLight::Near(LightMoments::of_spot(DVec3::X, DVec3::new(-0.8, 0.6, 0.0), 0.81, 1.0));
    let lights = [light(1.0, toward), light(10.0, toward), light(0.5, away), light(-0.5, away), past];
    let tree = LightTree::new(&lights, &Aabb::EMPTY);
    let receiver = Receiver { position: DVec3::ZERO, normal: Vec3::X };
    let [near, distant, averted, behind, past] = [0, 1, 2, 3, 4].map(|index| tree.prob(receiver, index));
    assert!((0.985..0.995).contains(&near) && (0.009..0.011).contains(&distant), "{near} {distant}");
    let is_least = |prob: &f64| (3.0e-6..3.4e-6).contains(prob);
    assert!([averted, behind, past].iter().all(is_least), "{averted} {behind} {past}");
}

/// The irradiance at `receiver` from the lights, each without extent, as if all were visible and spot lights
/// were as bright at their edges as in the middle.
fn irradiance(lights: &[LightMoments], receiver: &Receiver) -> f64 {
    let from_one = |light: &LightMoments| {
        let line = receiver.position - light.center;
        let distance = line.length();
        let cos_in = -receiver.normal.as_dvec3().dot(line) / distance;
        let cos = light.normal.dot(line) / distance;
        let cos = match light.normal_variance {
            0.0 if light.both_sides => cos.abs(),
            0.0 => cos.max(0.0),
            _ if cos >= light.limit => 1.0,
            _ => 0.0,
        };
        light.intensity * cos * cos_in.max(0.0) / distance.powi(2)
    };
    lights.iter().map(from_one).sum()
}

/// The importance of clusters of `size` lights over the irradiance from these, in ascending order, at points beyond twice
/// the extent of the cluster.
fn ratios(size: usize) -> Vec<f64> {
    let all = lights(400, 1.0);
    let all: Vec<_> = all.iter().filter(|light| matches!(light, TreeLight::Near(_))).map(near).collect();
    let alike = |light: &LightMoments| LightMoments {
        intensity: light.intensity.powf(0.1),
        center: 0.3 * light.center,
        variance: 1e-8 * light.variance,
        ..*light
    };
    let mut ratios = Vec::new();
    for (k, group) in (0..).zip(all.chunks_exact(size)) {
        let group: Vec<_> = group.iter().map(alike).collect();
        let union = group.iter().copied().reduce(|a, b| a.union(&b)).unwrap();
        let node = Node::new(&[(Child::Light(0), union)], &TreeFrame::around(iter::empty(), &Aabb::EMPTY));
        for i in 0..50 {
            let numbers = Stream::new(9, k, i);
            let (position, normal) = (2.0 * vector(numbers, 0), vector(numbers, 3).normalize());
            let receiver = Receiver { position, normal: normal.as_vec3() };
            let brought = irradiance(&group, &receiver);
            let extent_sq = union.variance.element_sum();
            if position.distance_squared(union.center) > 4.0 * extent_sq && brought > 1e-3 {
                ratios.push(node.importance(&receiver)[0] / brought);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    ratios
}

/// For a single triangle or point light it is the same, for spot lights and clusters within a factor.
#[test]
fn the_importance_is_about_the_irradiance() {
    let alone = ratios(1);
    let exact = alone.iter().filter(|ratio| (*ratio - 1.0).abs() < 0.001).count();
    let (least, most) = (alone[0], alone[alone.len() - 1]);
    assert!(alone.len() > 4000 && exact > 4000, "{exact} of {}", alone.len());
    assert!(least > 0.7 && most < 1.001, "{least} {most}");
    for size in [2, 4, 16] {
        let of_several = ratios(size);
        let (least, median) = (of_several[0], of_several[of_several.len() / 2]);
        assert!(of_several.len() > 500 && least > 0.05, "{size}: {least}");
        assert!((1.0..2.5).contains(&median), "{size}: {median}");
    }
}

/// Rounding does not put points within a narrow beam outside it.
#[test]
fn narrow_spot_lights_shine_within_their_beams() {
    for i in 0..1000 {
        let numbers = Stream::new(19, 0, i);
        let (position, axis) = (vector(numbers, 0), vector(numbers, 3).normalize());
        let spot = LightMoments::of_spot(position, axis, libm::cos(2e-4), 1.0);
        let node = Node::new(&[(Child::Light(0), spot)], &TreeFrame::around(iter::empty(), &Aabb::EMPTY));
        let along = axis + 1.4e-4 * axis.any_orthonormal_vector();
        let receiver = Receiver { position: position + 3.0 * along, normal: -axis.as_vec3() };
        let importance = node.importance(&receiver)[0];
        assert!((importance * 9.0 - 1.0).abs() < 1e-3, "{i}: {importance}");
    }
}

/// The facets of a sphere, on a spiral around it, of size `radius`.
fn sphere(middle: DVec3, radius: f64, intensity: f64) -> impl Iterator<Item = LightMoments> {
    let facet = move |i: u32| {
        let height = 1.0 - (2.0 * f64::from(i) + 1.0) / 80.0;
        let (sin, cos) = libm::sincos(2.4 * f64::from(i));
        let width = (1.0 - height * height).sqrt();
        let normal = DVec3::new(width * cos, height, width * sin);
        let (u, v) = normal.any_orthonormal_pair();
        let corners = [u + v, u - v, -u].map(|corner| middle + radius * (normal + 0.1 * corner));
        LightMoments::of_triangle(corners, normal, false, intensity)
    };
    (0..80).map(facet)
}

/// The relative variance of an estimate of irradiance by one light that `tree` over `lights` chooses, exactly; the mean
/// over points of the walls of a box.
fn relative_variance(lights: &[LightMoments]) -> f64 {
    let tree_lights: Vec<_> = lights.iter().map(|&light| TreeLight::Near(light)).collect();
    let tree = LightTree::new(&tree_lights, &Aabb::EMPTY);
    let at_point = |i: u32| {
        let (mut position, axis) = (vector(Stream::new(15, 0, i), 0), i as usize % 3);
        position[axis] = 1.0;
        let receiver = Receiver { position, normal: -Vec3::AXES[axis] };
        let (mut sum, mut mean_square) = (0.0, 0.0);
        for (index, light) in lights.iter().enumerate() {
            let brought = irradiance(std::slice::from_ref(light), &receiver);
            sum += brought;
            mean_square += brought * brought / tree.prob(receiver, index);
        }
        if sum > 0.0 { mean_square / (sum * sum) - 1.0 } else { 0.0 }
    };
    (0..500).map(at_point).sum::<f64>() / 500.0
}

/// Were a cluster's normals bounded by a cone instead, both halves of a sphere would seem alike.
#[test]
fn one_chosen_light_tells_most_of_the_irradiance_from_spheres() {
    let of_sphere = |k: u32| {
        let numbers = Stream::new(14, 0, k);
        sphere(vector(numbers, 0), 0.02 + 0.06 * numbers.uniform(3), 1.0 + f64::from(k))
    };
    let lights: Vec<_> = (0..12).flat_map(of_sphere).collect();
    let variance = relative_variance(&lights);
    assert!(variance < 0.1, "{variance}");
}

/// Lamps in two planes, some of which are close to the walls.
#[test]
fn one_chosen_light_tells_much_of_the_irradiance_from_planes() {
    let lamp = |i: u32| {
        let numbers = Stream::new(18, 0, i);
        let center = DVec3::new(1.0, 0.0, 1.0) * vector(numbers, 0) + f64::from(i % 2) * DVec3::Y;
        let corners = [DVec3::X, DVec3::Z, DVec3::NEG_ONE]
            .map(|corner| center + 0.01 * corner * DVec3::new(1.0, 0.0, 1.0));
        LightMoments::of_triangle(corners, DVec3::NEG_Y, false, 10.0_f64.powf(3.0 * numbers.uniform(3)))
    };
    let variance = relative_variance(&(0..300).map(lamp).collect::<Vec<_>>());
    assert!(variance < 0.3, "{variance}");
}
