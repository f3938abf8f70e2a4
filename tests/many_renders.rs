//! Renders within somebody else's rayon pool.

use globillum::geom::Accel;
use globillum::integrator::view_factors::{FactorRun, FactorSettings, Patches};
use globillum::integrator::{FirstHits, PinholeCamera, Scene, Settings, render, replay};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::{cornell, scenes};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The most jobs of a pool of two workers that run at a time, of 100.
fn most_at_a_time(job: impl Fn() + Sync) -> usize {
    let (running, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let counted = |_| {
        most.fetch_max(running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
        job();
        running.fetch_sub(1, Ordering::SeqCst);
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("two threads");
    pool.install(|| (0..100).into_par_iter().for_each(counted));
    most.into_inner()
}

/// A worker of the pool that waits for a render takes up no other: some hundred of them on one stack overflow it.
#[test]
fn a_worker_of_another_pool_renders_one_picture_at_a_time() {
    let model = cornell::with_blocks(false).expect("the box is good");
    let scene: Scene<Box<dyn Accel>> = scenes::scene(&model, RENDERED[0].1);
    let camera: PinholeCamera = cornell::camera().expect("it is good");
    let mut settings = Settings::new(4, 4, 1);
    settings.threads = 1;
    let picture = || drop(render(&scene, &camera, &settings).expect("it is good"));
    let hits = || drop(FirstHits::of(&scene, &camera, &settings).expect("it is good"));
    let path = || drop(replay(&scene, &camera, &settings, (1, 2), 0).expect("it is good"));
    let patches = Patches::of_triangles(model.triangles().len() as u32);
    let mut of_factors = FactorSettings::new(16);
    of_factors.threads = 1;
    let factors = || {
        let run = FactorRun::new(scene.triangles(), scene.accel(), &patches, &of_factors);
        drop(run.run().expect("it is good"));
    };
    let jobs: [(&str, &(dyn Fn() + Sync)); 4] =
        [("render", &picture), ("first hits", &hits), ("replay", &path), ("view factors", &factors)];
    for (name, job) in jobs {
        let most = most_at_a_time(job);
        assert!(most <= 2, "{name}: {most} at a time");
    }
}
