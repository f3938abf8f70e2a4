use super::*;
use crate::path::test_rooms::{
    FloorPoints, Setup, TILE, advanced, camera, room, room_with_wall, settings, shaft,
};
use crate::path::{TileProbes, Wavefront};
use crate::{Estimator, Guiding, MirrorSampling, PinholeCamera, Roulette, Scene, Sensor, Settings};
use glam::DVec3;
use globillum_geom::KdTree;
use std::ops::Range;

const SEEDS: u64 = 100;

/// Differences of radiance, by bands of four rows and of all pixels, each with the sum of its squares over all seeds.
type Deviations = [[(f64, f64); 3]; 5];

/// Adds the differences of a seed.
fn add(deviations: &mut Deviations, shared: &[Rgb], alone: &[Rgb]) {
    let difference = |pixels: Range<usize>| {
        let of_pixel = |i: usize| shared[i] - alone[i];
        pixels.map(of_pixel).sum::<Rgb>().to_array()
    };
    let bands = [0, 1, 2, 3].map(|band| difference(52 * band..52 * (band + 1)));
    let of_all = bands.iter().copied().chain([difference(0..TILE.pixel_count())]);
    for ((sum, square), d) in deviations.as_flattened_mut().iter_mut().zip(of_all.flatten()) {
        *sum += d;
        *square += d * d;
    }
}

/// Compares the pixels of each case with those that share nothing, by the same seeds, so that all other light cancels.
/// Single pixels of few caustics have a skewed distribution, so rows are compared together. Any of the deviations of
/// twelve cases exceeds the limit with a probability of 2.3e-5 (Student's distribution with 99 degrees of freedom).
fn check_means(cases: &[(&Scene<KdTree>, &dyn Sensor, Settings)]) {
    for (i, &(scene, sensor, settings)) in cases.iter().enumerate() {
        let setup = Setup::new(scene, sensor, settings.guiding);
        let mut deviations = [Deviations::default(); 2];
        let mut level = 0.0;
        for seed in 0..SEEDS {
            let [with_photons, shared, alone] = setup.pixels(&Settings { seed, ..settings });
            level += alone.iter().map(|radiance| radiance.mean()).sum::<f64>();
            add(&mut deviations[0], &with_photons, &alone);
            add(&mut deviations[1], &shared, &alone);
        }
        let z = |&(sum, square): &(f64, f64)| if square == 0.0 { 0.0 } else { sum.abs() / square.sqrt() };
        for (deviations, photons) in deviations.iter().zip([true, false]) {
            let largest = deviations.as_flattened().iter().map(z).fold(0.0, f64::max);
            let error = deviations[4].iter().map(|(_, square)| square).sum::<f64>().sqrt() / level;
            assert!(largest < 5.85, "{i}, {photons}: {largest}");
            assert!(error > 0.0 && error < 0.0092, "{i}, {photons}: {error}");
        }
    }
}

#[test]
fn pixels_keep_their_mean_by_every_estimator() {
    let (room, [wide, near]) = (room(0.6), [0.9, 0.2].map(camera));
    let by = |estimator| Settings { estimator, ..settings() };
    check_means(&[
        (&room, &wide, by(Estimator::Mis)),
        (&room, &wide, by(Estimator::Light)),
        (&room, &near, by(Estimator::Bsdf)),
        (&room, &near, Settings { guiding: Guiding::Trained, ..settings() }),
    ]);
}

#[test]
fn pixels_keep_their_mean_with_limits_and_roulette() {
    let (room, [wide, near]) = (room(0.6), [0.9, 0.2].map(camera));
    let within = |max_bounces| Settings { max_bounces: Some(max_bounces), ..settings() };
    check_means(&[
        (&room, &near, within(2)),
        (&room, &wide, within(3)),
        (&room, &near, Settings { mirror_sampling: MirrorSampling::Off, ..within(4) }),
        (&room, &near, Settings { roulette: Roulette { start: 1, threshold: 1.0 }, ..settings() }),
    ]);
}

#[test]
fn pixels_keep_their_mean_between_mirrors_and_beside_walls() {
    let (room, shaft, walled, [wide, near]) =
        (room(0.6), shaft(0.5), room_with_wall(), [0.9, 0.2].map(camera));
    check_means(&[
        (&room, &FloorPoints([0.9, 0.9]), settings()),
        (&shaft, &near, settings()),
        (&shaft, &wide, Settings { max_bounces: Some(4), ..settings() }),
        (&walled, &near, Settings { mirror_sampling: MirrorSampling::Off, ..settings() }),
    ]);
}

/// Rare caustics have most of the variance here. Pixels that share them have less, and with photons still less.
#[test]
fn shared_caustics_have_less_variance() {
    let (scene, near) = (room(0.2), camera(0.2));
    let setup = Setup::new(&scene, &near, Guiding::Off);
    let mut sums = [[0.0; 2]; 3];
    for seed in 0..SEEDS {
        let settings = Settings { seed, ..settings() };
        for (sums, radiance) in sums.iter_mut().zip(setup.pixels(&settings)) {
            for pixel in radiance {
                sums[0] += pixel.mean();
                sums[1] += pixel.mean() * pixel.mean();
            }
        }
    }
    let n = (SEEDS as usize * TILE.pixel_count()) as f64;
    let [with_photons, shared, alone] = sums.map(|[sum, square]| square / n - (sum / n) * (sum / n));
    assert!(shared < 0.6 * alone, "{shared}, {alone}");
    assert!(with_photons < 0.8 * shared, "{with_photons}, {shared}");
}

/// What a pixel finds by way of a mirror that another path has met is what its own path finds there: by way of no
/// fewer mirrors and of no more, and with the same weight beside photons.
#[test]
fn each_path_finds_its_own_caustic_again() {
    let (scene, settings) = (shaft(0.5), settings());
    let camera = PinholeCamera::look_at(DVec3::new(0.0, 2.0, 0.5), DVec3::ZERO, DVec3::Y, 0.4).unwrap();
    let photons = Setup::new(&scene, &camera, Guiding::Off).photons;
    let [lit, weighted] = [None, Some(photons)].map(|photons| {
        let context = RenderContext::new(&scene, &camera, &settings);
        numbers_found_again(&RenderContext { shares_caustics: true, photons, ..context })
    });
    assert!(lit[0] > 100 && lit[1] == 0, "{lit:?}");
    assert!(weighted[0] == lit[0] && weighted[1] > 100, "{weighted:?}");
}

/// The buffers of a wavefront keep nothing of what it traced before.
#[test]
fn a_wavefront_forgets_caustics() {
    let (scene, camera) = (room_with_wall(), camera(0.9));
    let settings = Settings { mirror_sampling: MirrorSampling::Off, ..settings() };
    let context = RenderContext::new(&scene, &camera, &settings);
    let context = RenderContext { shares_caustics: true, ..context };
    let mut wavefront = Wavefront::default();
    let mut trace = || {
        wavefront.trace(&context, &TileProbes::of(&context, TILE), 0..4, || false);
        assert!(!wavefront.radiance.suffix_caustics.is_empty());
        wavefront.radiance().to_vec()
    };
    assert_eq!(trace(), trace());
}

/// How many caustics are found again, and how many of these with a weight less than one.
fn numbers_found_again(context: &RenderContext<'_>) -> [u32; 2] {
    let Wavefront { prefixes, mut caustics, .. } = advanced(context);
    let mut counters = Counters::default();
    let mut numbers = [0; 2];
    for sample in 0..4 * TILE.pixel_count() as u32 {
        let met = prefixes.of(sample).and_then(|own| Some((own, own.mirror?)));
        let Some((own, mirror)) = met else { continue };
        caustics.connections = vec![(Connection::new(sample, 1.0, 1.0), Rgb::BLACK); 2];
        caustics.rays = vec![own.end.point.segment_to(&mirror.point).unwrap()];
        caustics.trace_connections(context, &prefixes, own.bounce, &mirror.point, &mut counters);
        let of_sample: Vec<PathCaustic> =
            caustics.found.iter().copied().filter(|found| found.sample == sample).collect();
        let shared = shared_radiance(context, own, &mirror, &of_sample).g;
        let again = caustics.connections[1].1.g;
        assert!((again - shared).abs() <= 1e-9 * shared, "{sample}: {again}, {shared}");
        numbers[0] += u32::from(shared > 0.0);
        numbers[1] += u32::from(shared < 0.999 * caustics.found_by(sample).g);
    }
    numbers
}
