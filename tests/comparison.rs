//! Two pictures beside each other: equal ones are found equal as often as stated, a difference is found.

use globillum::geom::WideBvh;
use globillum::integrator::{
    Comparison, Estimates, Model, PathReuse, Sampler, Scene, Settings, Stream, render,
};
use globillum::material::{Bsdf, Reflectance, Rgb};
use globillum::scenes::cornell;

type Built = Scene<WideBvh>;

/// The Cornell box, its albedos multiplied by `factor`.
fn scene(factor: f64) -> Built {
    let model = cornell::with_blocks(false).unwrap();
    let mut scaled = Model::default();
    for (index, triangle) in model.triangles().iter().enumerate() {
        let mut material = *model.material(index);
        if let Bsdf::Lambert(albedo) = material.bsdf {
            material.bsdf = Bsdf::Lambert(Reflectance::new(albedo.rgb() * factor).unwrap());
        }
        scaled.add(material, [*triangle]);
    }
    Scene::build(scaled, WideBvh::build).unwrap()
}

fn settings(side: u32, samples: u32, seed: u64) -> Settings {
    let mut settings = Settings::new(side, side, samples);
    (settings.pass_samples, settings.seed) = (samples / 4, seed);
    settings
}

fn picture(scene: &Built, settings: &Settings) -> Estimates {
    let camera = cornell::camera().unwrap();
    Estimates::of(&render(scene, &camera, settings).unwrap().film)
}

/// Of 40 pairs of seeds, no test of the comparison is biased, by 4.5 of its own standard errors, or off in its variance (a
/// false alarm in 12,000 runs), and fewer than 9 are called different at 5 % (in 7,700).
#[test]
fn seeds_are_equal_as_often_as_stated() {
    const PAIRS: u64 = 40;
    let scene = scene(1.0);
    let (mut different, mut tests) = (0, [[0.0; 2]; 3]);
    for pair in 0..PAIRS {
        let of = |seed| {
            let mut settings = settings(48, 8, seed);
            settings.sampler = [Sampler::Sobol, Sampler::Independent][pair as usize % 2];
            settings.path_reuse = [PathReuse::Tiles, PathReuse::Off][pair as usize / 2 % 2];
            picture(&scene, &settings)
        };
        let comparison = Comparison::between(&[of(2 * pair)], &[of(2 * pair + 1)]).unwrap();
        different += usize::from(comparison.p_value() < 0.05);
        let chi_square = comparison.chi_square.unwrap().z;
        for (sums, z) in tests.iter_mut().zip([comparison.mean, comparison.neighbours, chi_square]) {
            *sums = [sums[0] + z, sums[1] + z * z];
        }
    }
    let pairs = PAIRS as f64;
    for [sum, squares] in tests {
        assert!((sum / pairs.sqrt()).abs() < 4.5, "{tests:?}");
        // Quantiles of chi-square with 40 degrees of freedom, of 1e-5 on each side.
        assert!((12.57..90.08).contains(&squares), "{tests:?}");
    }
    assert!(different < 9, "{different} of {PAIRS} pairs are called different");
}

#[test]
fn albedos_one_percent_darker_are_found() {
    let [a, b] =
        [(scene(1.0), 0), (scene(0.99), 1)].map(|(scene, seed)| picture(&scene, &settings(128, 16, seed)));
    let comparison = Comparison::between(&[a], &[b]).unwrap();
    assert!(comparison.p_value() < 1e-6 && comparison.mean > 0.0, "{}", comparison.p_value());
    let [low, high] = comparison.ratio_95;
    // Light of `n` reflections is `n` percent darker.
    assert!(low > 1.0 && high > 1.005 && high < 1.05, "{low} {high}");
}

/// Pixels that vary independently by up to 5 % around a mean, with errors that are known and right.
fn noise(seed: u64, mean: impl Fn(u32, u32) -> f64) -> Estimates {
    let (width, height) = (62, 61);
    let mut picture = Estimates::unknown(width, height);
    for at in 0..width * height {
        let mean = mean(at % width, at / width);
        let stream = Stream::new(seed, u64::from(at), 0);
        let [r, g, b] = [0, 1, 2].map(|c| mean * (1.0 + 0.1 * (stream.uniform(c) - 0.5)));
        picture.means[at as usize] = Rgb::new(r, g, b);
        picture.standard_errors[at as usize] = Rgb::splat(0.1 * mean / 12.0_f64.sqrt());
        picture.observations[at as usize] = 1000;
    }
    picture
}

#[test]
fn deviates_of_pixels_and_blocks_are_standard_normal() {
    let [a, b] = [1, 2].map(|seed| noise(seed, |x, y| f64::from(1 + x + y)));
    let comparison = Comparison::between(&[a], &[b]).unwrap();
    assert_eq!(
        (comparison.pixels.len(), comparison.blocks.len(), comparison.blocks_width()),
        (62 * 61, 256, 16)
    );
    for deviates in [&comparison.pixels, &comparison.blocks] {
        let squares = deviates.iter().flat_map(|z| z.to_array()).map(|z| z * z);
        let (sum, count) = (squares.sum::<f64>(), 3.0 * deviates.len() as f64);
        assert!((sum / count - 1.0).abs() < 4.5 * (2.0 / count).sqrt(), "{}", sum / count);
    }
    let chi_square = comparison.chi_square.unwrap();
    assert!((chi_square.reduced - 1.0).abs() < 0.05 && comparison.p_value() > 1e-4, "{comparison:?}");
}

/// A difference that the mean does not show: half of the picture is brighter, half darker.
#[test]
fn a_difference_in_structure_is_found_without_errors_too() {
    let slope = |x: u32, _| 1.0 + 0.02 * (f64::from(x) / 61.0 - 0.5);
    let [mut a, mut b] = [noise(1, |_, _| 1.0), noise(2, slope)];
    let with_errors = Comparison::between(&[a.clone()], &[b.clone()]).unwrap();
    assert!(with_errors.p_value() < 1e-6 && with_errors.mean.abs() < 4.0, "{}", with_errors.neighbours);
    for picture in [&mut a, &mut b] {
        picture.standard_errors.fill(Rgb::splat(f64::INFINITY));
    }
    let without = Comparison::between(&[a], &[b]).unwrap();
    assert!(without.p_value() < 1e-6 && without.chi_square.is_none(), "{}", without.neighbours);
    assert!(without.pixels[0].r.is_nan());
}

/// Pixels differ by twice their errors, up or down, which the means do not show; one block differs far more, so that it would
/// be most of an unlimited sum.
#[test]
fn a_block_that_differs_far_more_hides_no_difference_of_the_others() {
    let [a, mut b] = [1, 2].map(|seed| noise(seed, |_, _| 1.0));
    for (at, mean) in b.means.iter_mut().enumerate() {
        let apart = if at < 4 { 1e4 } else { 2.0 * (0.1 / 12.0_f64.sqrt()) };
        let sign = if at % 62 % 2 == 0 { 1.0 } else { -1.0 };
        *mean += Rgb::splat(sign * apart);
    }
    let chi_square = Comparison::between(&[a], &[b]).unwrap().chi_square.unwrap();
    assert!(chi_square.z > 10.0, "{chi_square:?}");
}

/// A picture of 96 x 96 pixels whose errors are those of its tiles, and nothing is known of them.
fn tiled_noise(seed: u64) -> Estimates {
    let mut picture = Estimates::unknown(96, 96);
    picture.path_reuse = PathReuse::Tiles;
    for (at, mean) in (0_u64..).zip(&mut picture.means) {
        let tile = at / 96 / 16 * 6 + at % 96 / 16;
        *mean = Rgb::splat(1.0 + 0.1 * (Stream::new(seed, tile, 0).uniform(0) - 0.5));
    }
    picture
}

/// Of 400 pairs of seeds, of the whole picture and of crops that begin within tiles, no test is biased or off in its
/// variance by 4.5 of its own standard errors (a false alarm in 10,000 runs).
#[test]
fn crops_of_equal_pictures_are_equal() {
    const PAIRS: u64 = 400;
    for (columns, rows) in [(0..96, 0..96), (8..88, 8..88), (5..90, 0..93), (16..96, 13..87)] {
        let mut tests = [[0.0; 2]; 2];
        for pair in 0..PAIRS {
            let [a, b] =
                [2 * pair, 2 * pair + 1].map(|seed| tiled_noise(seed).crop(columns.clone(), rows.clone()));
            assert_eq!(a.origin, [columns.start, rows.start]);
            let comparison = Comparison::between(&[a], &[b]).unwrap();
            for (sums, z) in tests.iter_mut().zip([comparison.mean, comparison.neighbours]) {
                *sums = [sums[0] + z, sums[1] + z * z];
            }
        }
        let pairs = PAIRS as f64;
        for [sum, squares] in tests {
            assert!((sum / pairs.sqrt()).abs() < 4.5, "{columns:?} {rows:?}: {tests:?}");
            let off = squares / pairs - 1.0;
            assert!(off.abs() < 4.5 * (2.0 / pairs).sqrt(), "{columns:?} {rows:?}: {tests:?}");
        }
    }
}

/// Several pictures of a side are seeds, whose spread is the error, whatever their files say.
#[test]
fn the_errors_of_seeds_are_their_spread() {
    let seeds = |first: u64| (first..first + 4).map(|seed| noise(seed, |_, _| 2.0)).collect::<Vec<_>>();
    let comparison = Comparison::between(&seeds(0), &seeds(9)).unwrap();
    for deviates in [&comparison.pixels, &comparison.blocks] {
        let large = deviates.iter().flat_map(|z| z.to_array()).filter(|z| z.abs() > 1.96).count() as f64;
        let count = 3.0 * deviates.len() as f64;
        assert!((large / count - 0.05).abs() < 4.5 * (0.05 / count).sqrt() + 0.005, "{}", large / count);
    }
    assert!(comparison.p_value() > 1e-4);
}

/// A picture of 64 x 64 pixels of mean 1 that vary normally by `deviation`, an error that is known and right.
fn normal_noise(seed: u64, deviation: f64) -> Estimates {
    let mut picture = Estimates::unknown(64, 64);
    for (at, mean) in (0_u64..).zip(&mut picture.means) {
        let stream = Stream::new(seed, at, 0);
        let normal = |c: u32| {
            let [u, v] = stream.uniform_pair(2 * c);
            (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
        };
        let [r, g, b] = [0, 1, 2].map(|c| 1.0 + deviation * normal(c));
        *mean = Rgb::new(r, g, b);
    }
    picture.standard_errors.fill(Rgb::splat(deviation));
    picture.observations.fill(1000);
    picture
}

/// Of 60 comparisons of few seeds with a picture that is more accurate, more than two are called different, at a
/// false-alarm rate of 0.001, in fewer than one of 7,000 runs of these four cases.
#[test]
fn few_seeds_are_equal_to_an_accurate_picture() {
    for (count, accuracy) in [(2, 0.05), (2, 0.3), (4, 0.1), (4, 0.3)] {
        let different = (0..60).filter(|pair| {
            let seeds: Vec<Estimates> = (0..count).map(|seed| normal_noise(8 * pair + seed, 0.05)).collect();
            let accurate = normal_noise(8 * pair + 7, 0.05 * accuracy);
            Comparison::between(&seeds, &[accurate]).unwrap().p_value() < 0.001
        });
        let different = different.count();
        assert!(different <= 2, "{different} of 60 with {count} seeds, noise {accuracy}");
    }
}

/// What the other side knows hides no difference: one block is brighter.
#[test]
fn four_seeds_find_a_block_that_differs() {
    let seeds: Vec<Estimates> = (0..4).map(|seed| normal_noise(seed, 0.05)).collect();
    let mut accurate = normal_noise(7, 0.005);
    (0..4)
        .flat_map(|y| (0..4).map(move |x| y * 64 + x))
        .for_each(|at| accurate.means[at] = Rgb::splat(100.0));
    let comparison = Comparison::between(&seeds, &[accurate]).unwrap();
    assert!(comparison.p_value() < 1e-3, "{:?}", comparison.largest_block);
}

/// Of 2000 pairs of pictures of few tiles, the interval of the ratio holds it in 95 %, within 4.5 standard errors (a
/// false alarm in 150,000).
#[test]
fn intervals_of_the_ratio_hold_it_where_tiles_are_few() {
    const PAIRS: u64 = 2000;
    for (tiles, columns, rows) in [(2, 8, 4), (4, 8, 8), (16, 16, 16)] {
        let held = (0..PAIRS).filter(|pair| {
            let [a, b] =
                [2 * pair, 2 * pair + 1].map(|seed| normal_noise(seed, 0.05).crop(0..columns, 0..rows));
            let [low, high] = Comparison::between(&[a], &[b]).unwrap().ratio_95;
            (low..=high).contains(&1.0)
        });
        let share = held.count() as f64 / PAIRS as f64;
        let tolerance = 4.5 * (0.95 * 0.05 / PAIRS as f64).sqrt();
        assert!((share - 0.95).abs() < tolerance, "{tiles} tiles: {share}");
    }
    let one = normal_noise(0, 0.05).crop(0..4, 0..4);
    let comparison = Comparison::between(&[one], &[normal_noise(1, 0.05).crop(0..4, 0..4)]).unwrap();
    assert_eq!(comparison.ratio_95, [f64::NEG_INFINITY, f64::INFINITY]);
}

#[test]
#[should_panic(expected = "a crop lies within the picture")]
#[expect(clippy::reversed_empty_ranges, reason = "the range is wrong on purpose")]
fn a_crop_does_not_end_before_it_begins() {
    let _ = Estimates::unknown(8, 8).crop(5..3, 0..1);
}

#[test]
#[should_panic(expected = "every list has one entry for each pixel or block")]
fn a_picture_without_some_pixels_is_not_compared() {
    let whole = Estimates::unknown(8, 8);
    let mut short = whole.clone();
    short.observations.pop();
    let _ = Comparison::between(&[whole], &[short]);
}

#[test]
fn what_is_equal_or_has_no_pictures_is_told() {
    let one = &[noise(1, |_, _| 1.0)];
    let comparison = Comparison::between(one, one).unwrap();
    assert_eq!((comparison.ratio, comparison.mean, comparison.p_value()), (1.0, 0.0, 1.0));
    assert!(comparison.chi_square.unwrap().z < -4.0, "equal pictures are not independent");
    assert_eq!(Comparison::between(&[], one), None);
    assert_eq!(Comparison::between(one, &[]), None);
    assert_eq!(Comparison::between(one, &[Estimates::unknown(62, 60)]), None);
    for empty in [Estimates::unknown(0, 5), Estimates::unknown(5, 0), Estimates::unknown(0, 0)] {
        let empty = &[empty];
        assert_eq!(Comparison::between(empty, empty), None);
    }
}
