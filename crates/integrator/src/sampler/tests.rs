use super::*;
use std::collections::BTreeSet;

/// Samples of a pass.
const PASS: u32 = 16;

/// The numbers of one sample, in passes of [`PASS`].
fn numbers(sampler: Sampler, pixel: u64, sample: u32) -> Numbers {
    let first = sample / PASS * PASS;
    sampler.numbers(1, Member::alone(pixel), sample, &(first..first + PASS))
}

/// The positions of `N` rays of one sample of the first pass.
fn rays<const N: usize>(sampler: Sampler, sample: u32) -> [[f64; 2]; N] {
    sampler.ray_positions(1, 7, sample, &(0..PASS))
}

/// The first number of a decision.
fn single(numbers: Numbers, decision: Decision) -> f64 {
    let [u] = numbers.uniform(decision);
    u
}

const BOTH: [Sampler; 2] = [Sampler::Independent, Sampler::Sobol];

/// Standard normal equivalent of chi-square with `dof` degrees of freedom (Wilson, Hilferty 1931).
fn normal_equivalent(chi_sq: f64, dof: f64) -> f64 {
    let spread = 2.0 / (9.0 * dof);
    ((chi_sq / dof).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// `z` of the hypothesis that `points` fill 16 x 16 equal cells evenly.
fn evenness(points: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (mut counts, mut draws) = ([0_u32; 256], 0.0);
    for [x, y] in points {
        counts[16 * (x * 16.0) as usize + (y * 16.0) as usize] += 1;
        draws += 1.0;
    }
    let expected = draws / 256.0;
    let chi_sq = counts.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
    normal_equivalent(chi_sq, 255.0)
}

#[test]
fn one_sample_of_every_pixel_or_pass_fills_the_square_evenly() {
    let draws = 1_u32 << 18;
    for sampler in BOTH {
        for (decision, index) in [(0, 0), (2, 5), (350, 15)] {
            let over_pixels = (0..draws).map(|i| numbers(sampler, u64::from(i), index));
            let over_passes = (0..draws).map(|i| numbers(sampler, 9, PASS * i + index));
            for z in [
                evenness(over_pixels.map(|n| n.uniform(Decision(decision)))),
                evenness(over_passes.map(|n| n.uniform(Decision(decision)))),
            ] {
                assert!(z.abs() < 5.85, "{sampler:?}, decision {decision}: z = {z}");
            }
        }
    }
}

/// Two decisions that took one number would depend on each other, and bias what follows from both.
#[test]
fn no_two_decisions_of_a_path_take_the_same_number() {
    for sampler in BOTH {
        let numbers = numbers(sampler, 7, 5);
        let of_bounce = |bounce| {
            let [drawn] = BounceNumbers::draw(&[numbers], bounce, true);
            let BounceNumbers { light, point: [x, y], scatter: [u, v], roulette } = drawn;
            let in_mirrors = |size| {
                let (mirrored, [z, w]) = numbers.light_in_mirror(size, bounce);
                [numbers.mirror(size, bounce), mirrored, z, w]
            };
            let roulette = roulette.expect("a number for roulette was asked for");
            let [large, small] = [MirrorSize::Large, MirrorSize::Small].map(in_mirrors);
            [&[light, x, y, u, v, roulette][..], &large, &small].concat()
        };
        let [film] = Numbers::pixel_positions(&[numbers]);
        let few = rays::<16>(sampler, 5).concat();
        let many = rays::<32>(sampler, 5).concat();
        let all = (0..1000).flat_map(of_bounce).chain(film).chain(few).chain(many);
        let mut all: Vec<f64> = all.collect();
        all.sort_by(f64::total_cmp);
        // Numbers of 53 random bits coincide by chance with a probability of 2e-9.
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]), "{sampler:?}");
    }
}

/// Different decisions of one sample, and one decision of neighbouring samples of different
/// pixels, must not depend on each other: their pairs fill the square too.
#[test]
fn different_addresses_are_independent() {
    let draws = 1_u32 << 18;
    for sampler in BOTH {
        // One sample in each pass: those of one pass are dependent on purpose.
        let numbers = |pixel: u64, i: u32| numbers(sampler, pixel, PASS * i + i % PASS);
        let roulette = |pixel, i| single(numbers(pixel, i), Decision::roulette(0));
        let second = |numbers: Numbers, decision| numbers.uniform::<2>(Decision(decision))[1];
        let decisions =
            (0..draws).map(|i| [single(numbers(3, i), Decision(0)), single(numbers(3, i), Decision(1))]);
        let coordinates = (0..draws).map(|i| [second(numbers(3, i), 0), second(numbers(3, i), 2)]);
        let pixels = (0..draws).map(|i| [roulette(3, i), roulette(4, i)]);
        let passes = (0..draws).map(|i| [roulette(3, i), roulette(3, i + 1)]);
        for z in [evenness(decisions), evenness(coordinates), evenness(pixels), evenness(passes)] {
            assert!(z.abs() < 5.85, "{sampler:?}: z = {z}");
        }
    }
}

/// Within a pass, dimensions are matched by random permutations, as in Latin hypercubes: the
/// integral of a product of two of them has the variance of as many independent samples, times
/// n / (n - 1) (Stein, "Large Sample Properties of Simulations Using Latin Hypercube Sampling",
/// 1987). Were they matched in less random a way, the variance would be twice that, or all.
#[test]
fn padded_dimensions_do_not_line_up() {
    let (passes, n) = (1_u32 << 14, f64::from(PASS));
    let (mut sum, mut sum_sq) = ([0.0; 4], [0.0; 4]);
    for first in (0..passes).map(|i| i * PASS) {
        let mut products = [0.0; 4];
        for sample in first..first + PASS {
            let numbers = numbers(Sampler::Sobol, 9, sample);
            let ([a, b], [c, d]) =
                (Numbers::pixel_positions(&[numbers])[0], numbers.uniform(Decision::scatter(0)));
            for (product, [x, y]) in products.iter_mut().zip([[a, c], [a, d], [b, c], [b, d]]) {
                *product += (x - 0.5) * (y - 0.5) / n;
            }
        }
        for i in 0..4 {
            sum[i] += products[i];
            sum_sq[i] += products[i] * products[i];
        }
    }
    for i in 0..4 {
        let variance = sum_sq[i] / f64::from(passes);
        assert!(sum[i].abs() < 5.85 * (variance * f64::from(passes)).sqrt(), "{i}: mean of {}", sum[i]);
        // One product has a variance of 1/144. The estimate from these passes has a standard deviation of 1.2 %.
        let ratio = variance * 144.0 * (n - 1.0);
        assert!((ratio - 1.0).abs() < 5.85 * 0.012, "{i}: {ratio} times the variance expected");
    }
}

/// Of the 64 points of four parts of each sample of a pass, one lies in each cell of every grid of 64 cells;
/// parts one by one and side by side are the same.
#[test]
fn the_parts_of_all_samples_are_one_net() {
    let samples = (0..PASS).map(|sample| numbers(Sampler::Sobol, 9, sample));
    let points: Vec<_> = samples.flat_map(|numbers| numbers.lights::<4>(2, 0, 4)).collect();
    for (i, point) in (0..).zip(&points) {
        let part = numbers(Sampler::Sobol, 9, i / 4).part(i % 4, 4);
        assert_eq!(part.lights::<1>(2, 0, 1), [*point]);
    }
    assert_one_net(points.iter().map(|&(_, point)| point));
}

/// Asserts that of these `2^m` points, one lies in each cell of every grid of `2^m` cells.
fn assert_one_net(points: impl ExactSizeIterator<Item = [f64; 2]> + Clone) {
    let count = points.len();
    for columns in (0..=count.trailing_zeros()).map(|digits| f64::from(1 << digits)) {
        let rows = count as f64 / columns;
        let cell = |[x, y]: [f64; 2]| ((x * columns).floor() * rows + (y * rows).floor()) as u32;
        let cells: BTreeSet<_> = points.clone().map(cell).collect();
        assert_eq!(cells.len(), count, "{columns} columns");
    }
}

#[test]
fn the_rays_of_all_samples_are_one_net() {
    let few: Vec<_> = (0..PASS).flat_map(|sample| rays::<16>(Sampler::Sobol, sample)).collect();
    assert_one_net(few.into_iter());
    let many: Vec<_> = (0..PASS).flat_map(|sample| rays::<32>(Sampler::Sobol, sample)).collect();
    assert_one_net(many.into_iter());
}

#[test]
fn parts_of_independent_samples_differ() {
    let numbers = numbers(Sampler::Independent, 9, 3);
    let mut drawn: Vec<f64> =
        (0..16).map(|part| single(numbers.part(part, 16), Decision::light(0))).collect();
    drawn.push(single(numbers, Decision::light(0)));
    drawn.sort_by(f64::total_cmp);
    assert!(drawn.windows(2).all(|pair| pair[0] != pair[1]));
    assert_eq!(numbers.part(0, 1), numbers);
}

/// Of the 256 points of a pass, one lies in each cell of a grid of 4 x 4 x 4 x 4.
#[test]
fn the_directions_of_two_bounces_are_one_net() {
    let mut seen = [false; 256];
    for sample in 0..256 {
        let numbers = Sampler::Sobol.numbers(1, Member::alone(9), sample, &(0..256));
        let four = [2, 3].map(|bounce| numbers.scatter(bounce)).concat();
        let cell = four.iter().fold(0, |cell, u| 4 * cell + (4.0 * u) as usize);
        assert!(!std::mem::replace(&mut seen[cell], true), "{four:?}");
    }
}

/// Side by side and one by one give the same bits, for passes of any length.
#[test]
fn numbers_do_not_depend_on_their_neighbours() {
    for (sampler, length) in BOTH.into_iter().flat_map(|s| [1, 3, 16, 100, 5000].map(|n| (s, n))) {
        let pass = 7 * length..8 * length;
        let samples: [Numbers; 8] = std::array::from_fn(|i| {
            sampler.numbers(3, Member::alone(11 * i as u64), pass.start + i as u32 * 997 % length, &pass)
        });
        let films = samples.map(|numbers| Numbers::pixel_positions(&[numbers])[0]);
        assert_eq!(Numbers::pixel_positions(&samples), films, "{sampler:?}, {length}");
        for (size, bounce) in [(MirrorSize::Large, 0), (MirrorSize::Small, 1), (MirrorSize::Large, 20)] {
            let mirrors = samples.map(|numbers| numbers.mirror(size, bounce));
            assert_eq!(Numbers::mirrors(&samples, size, bounce), mirrors, "{sampler:?}, {length}");
            let lights = samples.map(|numbers| numbers.light_in_mirror(size, bounce));
            let together = Numbers::lights_in_mirrors(&samples, size, bounce);
            assert_eq!(together, lights, "{sampler:?}, {length}");
        }
        for bounce in [0, 1, 40] {
            let roulette = bounce > 0;
            let together = BounceNumbers::draw(&samples, bounce, roulette);
            let alone = samples.map(|numbers| BounceNumbers::draw(&[numbers], bounce, roulette)[0]);
            assert_eq!(together, alone, "{sampler:?}, {length}");
            // Not side by side.
            let of_both = [samples[5], numbers(Sampler::Independent, 1, 2), numbers(Sampler::Sobol, 1, 2)];
            let mixed = BounceNumbers::draw(&of_both, bounce, roulette);
            assert_eq!(mixed[0], together[5], "{sampler:?}, {length}");
        }
    }
}

#[test]
fn numbers_lie_below_one() {
    for (sampler, length) in BOTH.into_iter().flat_map(|s| [1, 3, 16, Sampler::MAX_PASS].map(|n| (s, n))) {
        for first in [0, u32::MAX - length] {
            for sample in [first, first + length - 1] {
                let numbers =
                    sampler.numbers(u64::MAX, Member::alone(u64::MAX), sample, &(first..first + length));
                let scatter: [f64; 2] = numbers.uniform(Decision::scatter(1 << 28));
                let rays: [_; 32] =
                    sampler.ray_positions(u64::MAX, u64::MAX, sample, &(first..first + length));
                assert!(scatter.iter().chain(rays.as_flattened()).all(|u| (0.0..1.0).contains(u)));
            }
        }
    }
}
