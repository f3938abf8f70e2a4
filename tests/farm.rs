//! Statistics of pictures that a farm renders to an error: a pilot, then as many passes as its error asks for, both
//! in parts that are merged.

use glam::DVec3;
use globillum::geom::Accel;
use globillum::integrator::{
    CheckpointReader, CheckpointWriter, Estimator, Merge, PathReuse, Picture, PinholeCamera, Render, Scene,
    Settings, Stop,
};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes::LIGHT_OVER_FLOOR;
use globillum_testkit::scenes::{self, stare};
use std::ops::Range;

/// Radiance of the point of the floor that all pixels see (`tests/stop.rs`).
const TRUTH: f64 = LIGHT_OVER_FLOOR;
const FARMS: u64 = 40;
const GOAL: f64 = 0.06;
/// Passes of the pilot, too few to know the error well: that is when stopping at the error itself is biased.
const PILOT: u32 = 4;

struct Farm {
    scene: Scene<Box<dyn Accel>>,
    camera: PinholeCamera,
    settings: Settings,
}

impl Farm {
    fn new(seed: u64) -> Self {
        let mut settings = Settings::new(4, 32, 1 << 16);
        (settings.pass_samples, settings.estimator, settings.seed) = (1, Estimator::Bsdf, seed);
        (settings.path_reuse, settings.threads) = (PathReuse::Off, 1);
        let scene = scenes::scene(&scenes::light_over_floor(), RENDERED[0].1);
        Self { scene, camera: stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO), settings }
    }

    /// The picture of these passes, of tasks that are ranges of passes of two strips.
    fn picture(&self, passes: Range<u32>) -> Picture {
        let mut parts = Vec::new();
        let middle = passes.start.midpoint(passes.end);
        for rows in [0..16, 16..32] {
            for passes in [passes.start..middle, middle..passes.end] {
                let task = Render::new(&self.scene, &self.camera, &self.settings).rows(rows.clone());
                parts.push(task.passes(passes).run().expect("the scene is good").to_bytes());
            }
        }
        let readers = parts.iter().map(|part| CheckpointReader::new(&part[..]).expect("it was just written"));
        let merge = Merge::new(readers.collect()).expect("they are parts of one picture");
        let mut writer = CheckpointWriter::new(Vec::new(), merge.header()).expect("a vector takes all");
        merge.run(|rows| writer.write(rows)).expect("they are good");
        let bytes = writer.finish().expect("a vector takes all");
        Picture::from_bytes(&bytes).expect("all rows hold the same passes")
    }
}

#[test]
fn farms_that_stop_at_an_error_are_not_biased() {
    let mut stop = Stop::default();
    stop.relative_rmse = Some(GOAL);
    // A path meets the light or does not: the larger of two values and the mean say the variance of one pass.
    let hit = Farm::new(0).picture(0..2).film.means().map(|mean| mean.g).fold(0.0, f64::max);
    let mut means = Vec::new();
    let mut held = 0;
    for seed in 0..FARMS {
        let farm = Farm::new(seed);
        let pilot = farm.picture(0..PILOT);
        let passes = stop.passes_after(&pilot.film).expect("there is a goal") as u32;
        let film = farm.picture(PILOT..PILOT + passes).film;
        assert_eq!((film.passes().len(), film.passes()[0].clone()), (1, PILOT..PILOT + passes));
        means.push(film.image_mean().g);
        // The error is relative to the picture's own mean.
        let std_err = (TRUTH * (hit - TRUTH) / f64::from(passes)).sqrt();
        let (truth, error) = (std_err / film.image_mean().g, film.error());
        held += u32::from((error.interval_95[0]..=error.interval_95[1]).contains(&truth));
        assert!(truth < 1.1 * GOAL && truth > 0.5 * GOAL, "{seed}: {truth}, {error:?}");
    }
    let n = FARMS as f64;
    let mean = means.iter().sum::<f64>() / n;
    let std_err = (means.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    // Student's quantile of 39 degrees of freedom for a false alarm in a thousand.
    assert!((mean - TRUTH).abs() < 3.56 * std_err, "{mean} +- {std_err}");
    // Of 40 intervals of 95 %, less than 33 hold the truth in 7 of 10,000 tests.
    assert!(held >= 33, "{held} of {FARMS}");
}
