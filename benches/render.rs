//! Whole pictures: `cargo bench --bench render`.
//!
//! Checks the picture's bits before timing. Also prints the relative mean squared error that the film
//! estimates, times the seconds of one run: the inverse of the efficiency.
#![allow(clippy::print_stdout, reason = "a bench prints its results")]

use Estimator::{Light, Mis};
use PathReuse::{Off, Tiles};
use Sampler::{Independent, Sobol};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use globillum::geom::Accel;
use globillum::integrator::{Estimator, Film, PathReuse, PinholeCamera, Sampler, Scene, Settings, render};
use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::scenes::scene;
use globillum_testkit::{cornell, hash};
use std::time::Instant;

const SIDE: u32 = 64;
const SAMPLES: u32 = 32;

/// The hash of each picture of the Cornell box with two blocks, the same for all accelerators. Changes that
/// intentionally change pictures update these hashes.
const PICTURES: [(&str, Estimator, Sampler, PathReuse, u64); 4] = [
    ("Mis, Sobol', path reuse", Mis, Sobol, Tiles, 0xf0f1_bc1b_0690_6414),
    ("Mis, Sobol'", Mis, Sobol, Off, 0x0800_1f12_d9e8_1ffe),
    ("Mis, independent", Mis, Independent, Off, 0xf194_7b70_8045_e729),
    ("Light, Sobol'", Light, Sobol, Off, 0x7886_2fa8_dd8a_9332),
];

fn film(scene: &Scene<Box<dyn Accel>>, camera: &PinholeCamera, settings: &Settings) -> Film {
    render(scene, camera, settings).expect("the box is good").film
}

fn pictures(criterion: &mut Criterion) {
    let model = cornell::with_blocks(false).expect("the box is good");
    let camera = cornell::camera().expect("the camera is good");
    for (name, estimator, sampler, path_reuse, expected) in PICTURES {
        let mut settings = Settings::new(SIDE, SIDE, SAMPLES);
        (settings.estimator, settings.sampler, settings.path_reuse) = (estimator, sampler, path_reuse);
        let mut group = criterion.benchmark_group(format!("render/{name}"));
        group.sample_size(10).throughput(Throughput::Elements(u64::from(SIDE * SIDE * SAMPLES)));
        // The first accelerator is brute force, which is slow.
        for (accel, build) in &ACCELERATORS[1..] {
            let scene = scene(&model, *build);
            let start = Instant::now();
            let first = film(&scene, &camera, &settings);
            let seconds = start.elapsed().as_secs_f64();
            let found = hash::of_film(&first);
            assert_eq!(found, expected, "{name}, {accel}: the picture's hash is {found:#018x}");
            let error = first.error().relative_rmse;
            println!("{name}, {accel}: MSE x seconds {:.2e}", error * error * seconds);
            group.bench_function(*accel, |b| b.iter(|| film(&scene, &camera, &settings)));
        }
    }
}

criterion_group!(benches, pictures);
criterion_main!(benches);
