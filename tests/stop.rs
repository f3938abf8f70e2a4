//! The ends of a render: limits, goals, cancelling, and failures.

use glam::DVec3;
use globillum::geom::{Aabb, Accel, Hit, Ray, Triangle};
use globillum::integrator::{
    ElementSample, Ending, Estimator, Guiding, IrradiancePoints, Model, Monitor, PathReuse, PathStart,
    Picture, PinholeCamera, PixelGoal, Progress, Render, RenderError, Scene, Sensor, Settings, Stop,
    Supersampling, render, replay,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::scenes::LIGHT_OVER_FLOOR;
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::quad;
use globillum_testkit::stats::Z_LIMIT;
use std::f64::consts::PI;
use std::hash::Hasher;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// A square light of side 2 at height 1 above a floor.
fn light_over_floor() -> (Scene<Box<dyn Accel>>, PinholeCamera) {
    let camera = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    (scenes::scene(&scenes::light_over_floor(), RENDERED[0].1), camera)
}

const TRUTH: f64 = LIGHT_OVER_FLOOR;

fn stop(set: impl FnOnce(&mut Stop)) -> Stop {
    let mut stop = Stop::default();
    set(&mut stop);
    stop
}

fn with_samples(mut settings: Settings, samples: u32) -> Settings {
    settings.samples = samples;
    settings
}

fn run(settings: &Settings, stop: Stop, monitor: &impl Monitor) -> Picture {
    let (scene, camera) = light_over_floor();
    Render::new(&scene, &camera, settings).until(stop).monitor(monitor).run().expect("the scene is good")
}

#[test]
fn a_render_ends_when_its_goal_is_met() {
    let settings = Settings::new(32, 32, 1 << 14);
    for goal in [0.01, 0.005] {
        let picture = run(&settings, stop(|s| s.relative_rmse = Some(goal)), &());
        assert_eq!(picture.ending, Ending::Goals);
        let error = picture.film.error();
        assert!(error.interval_95[1] <= goal && error.relative_rmse > 0.8 * goal, "{goal}: {error:?}");
        let squares: f64 = picture.film.means().map(|mean| (mean.g / TRUTH - 1.0).powi(2)).sum();
        // The root mean square over 1024 pixels has a standard deviation of 2.2 %.
        assert!((squares / 1024.0).sqrt() < goal * 1.11, "{goal}");
    }
}

/// A black picture has not varied. From 64 passes on it is taken for exact.
#[test]
fn a_goal_is_not_met_by_a_few_passes_that_are_equal() {
    let black = scenes::scene(&scenes::cube(0.5), RENDERED[0].1);
    let camera = stare(DVec3::ZERO, DVec3::X);
    let settings = Settings::new(4, 4, 1 << 14);
    let goal = stop(|s| s.relative_rmse = Some(0.01));
    let render = |settings: &Settings| {
        Render::new(&black, &camera, settings).until(goal).run().expect("the scene is good")
    };
    let few = render(&with_samples(settings, 63 * 16));
    assert_eq!(few.ending, Ending::Samples);
    assert_eq!((few.film.error().relative_rmse, few.film.error().interval_95), (0.0, [0.0, f64::INFINITY]));
    let many = render(&settings);
    assert_eq!((many.ending, many.samples), (Ending::Goals, 64 * 16));
    assert_eq!(many.film.error().interval_95, [0.0; 2]);
    assert_eq!(goal.passes_after(&few.film), Some(f64::INFINITY));
    assert_eq!(goal.passes_after(&many.film), Some(64.0));
}

/// A point below a sky that a floor hides but for a gap. Two passes often have the same number of paths through it.
#[test]
fn a_goal_waits_for_light_through_a_gap() {
    let p = DVec3::new;
    let mut model = Model::default();
    let roof = quad(p(-999.0, 1.0, -999.0), p(3.0, 1.0, -999.0), p(3.0, 1.0, 999.0), p(-999.0, 1.0, 999.0));
    model.add(Material::lambert(Rgb::WHITE).expect("an albedo"), roof);
    let scene = scenes::scene_under(Rgb::WHITE, &model, RENDERED[0].1);
    let points = IrradiancePoints::new([(DVec3::ZERO, DVec3::Y)]).expect("a point");
    // Half of a strip's form factor: pi (1 - 3 / sqrt(10)) / 2.
    let truth = PI * (1.0 - 3.0 / 10.0_f64.sqrt()) / 2.0;
    for seed in 0..20 {
        let mut settings = points.settings(1 << 20);
        (settings.max_bounces, settings.seed) = (Some(1), seed);
        let goal = stop(|s| s.relative_rmse = Some(0.05));
        let picture = Render::new(&scene, &points, &settings).until(goal).run().expect("it is good");
        assert_eq!(picture.ending, Ending::Goals);
        let error = picture.film.mean(0, 0).g / truth - 1.0;
        assert!(error.abs() < 0.2, "{seed}: {error} after {} samples", picture.samples);
    }
}

#[test]
fn a_share_of_the_pixels_can_be_the_goal() {
    let settings = Settings::new(32, 32, 1 << 14);
    let goal = PixelGoal { error: 0.006, share: 0.9 };
    let picture = run(&settings, stop(|s| s.pixels = Some(goal)), &());
    assert_eq!(picture.ending, Ending::Goals);
    let limit = 0.006 * picture.film.image_mean().g;
    let within = picture.film.variances_of_mean().filter(|v| v.max_component().sqrt() <= limit).count();
    assert!((922..1000).contains(&within), "{within} of 1024");
}

#[test]
fn a_render_ends_at_the_first_limit_or_when_all_goals_are_met() {
    let settings = Settings::new(32, 32, 64);
    let both = stop(|s| {
        s.relative_rmse = Some(0.05);
        s.pixels = Some(PixelGoal { error: 1e-9, share: 1.0 });
    });
    let picture = run(&settings, both, &());
    assert_eq!((picture.ending, picture.samples), (Ending::Samples, 64));
    let quick = stop(|s| (s.relative_rmse, s.seconds) = (Some(1e-9), Some(1e-9)));
    let picture = run(&settings, quick, &());
    assert_eq!((picture.ending, picture.samples), (Ending::Seconds, 16), "the first pass is completed");
}

#[test]
fn a_time_limit_leaves_whole_passes() {
    let settings = Settings::new(64, 64, u32::MAX);
    let picture = run(&settings, stop(|s| s.seconds = Some(0.5)), &());
    assert_eq!((picture.ending, picture.samples % 16), (Ending::Seconds, 0));
    let whole = with_samples(settings, picture.samples);
    assert_eq!(run(&whole, Stop::default(), &()).film, picture.film);
}

/// Sleeps when it is asked for the first time, which is before the first pass if a guide is trained.
#[derive(Default)]
struct SlowStart(AtomicU32);

impl Monitor for SlowStart {
    fn cancelled(&self) -> bool {
        if self.0.fetch_add(1, Ordering::Relaxed) == 0 {
            std::thread::sleep(Duration::from_secs(2));
        }
        false
    }
}

/// A pass takes some milliseconds. If it were expected to take the seconds before it as well, there would be one.
#[test]
fn what_precedes_the_passes_is_not_the_time_of_one() {
    let mut settings = Settings::new(16, 16, 64);
    (settings.guiding, settings.threads) = (Guiding::Trained, 1);
    let picture = run(&settings, stop(|s| s.seconds = Some(4.0)), &SlowStart::default());
    assert!(picture.samples > 16, "{} samples", picture.samples);
}

/// A run completes its first pass even if its time is over, also if the resumed picture already has passes.
#[test]
fn a_resumed_run_completes_at_least_one_pass() {
    let (scene, camera) = light_over_floor();
    let settings = Settings::new(32, 32, 64);
    let passes = |range| Render::new(&scene, &camera, &settings).passes(range).run().expect("it is good");
    let at_once = stop(|s| s.seconds = Some(1e-9));
    let resume = |picture, stop| {
        Render::new(&scene, &camera, &settings).until(stop).resume(picture).run().expect("it is good")
    };
    for (held, then) in [(0..1, 0..2), (0..2, 0..3), (1..3, 0..3)] {
        let picture = resume(passes(held), at_once);
        assert_eq!((picture.ending, &picture.film), (Ending::Seconds, &passes(then).film));
    }
    let whole = resume(passes(0..3), at_once);
    assert_eq!((whole.ending, &whole.film), (Ending::Samples, &passes(0..4).film));
    assert_eq!(resume(whole.clone(), at_once), whole, "there is no pass to add");
    // The pilot uses up the time.
    let pilot = stop(|s| (s.seconds, s.relative_rmse, s.pilot) = (Some(1e-9), Some(1e-9), Some(2)));
    let picture = resume(passes(0..1), pilot);
    assert_eq!(picture.film.passes(), [0..1, 2..3]);
}

/// The pilot's passes are not part of the picture; only their error determines its number of passes.
#[test]
fn the_pilot_determines_the_number_of_passes() {
    let settings = Settings::new(32, 32, 1 << 14);
    let plan = stop(|s| (s.relative_rmse, s.pilot) = (Some(0.01), Some(4)));
    let picture = run(&settings, plan, &());
    assert_eq!(picture.ending, Ending::Goals);
    assert_eq!(picture.film.passes()[0].start, 4);
    let error = picture.film.error().relative_rmse;
    assert!((error / 0.01 - 1.0).abs() < 0.15, "{error}");
    let (scene, camera) = light_over_floor();
    let passes = picture.film.passes()[0].clone();
    let same = Render::new(&scene, &camera, &settings).passes(passes).run().expect("the scene is good");
    assert_eq!(same.film, picture.film);
    // An unreachable goal uses all samples.
    let plan = stop(|s| (s.relative_rmse, s.pilot) = (Some(1e-6), Some(2)));
    let picture = run(&with_samples(settings, 64), plan, &());
    assert_eq!((picture.ending, picture.samples), (Ending::Samples, 32));
}

/// Two passes of a small picture say nearly nothing about its error. More of them are the pilot then, and the plan is not
/// out of all proportion.
#[test]
fn a_short_pilot_is_continued() {
    let mut settings = Settings::new(17, 3, 1 << 20);
    for seed in 0..20 {
        settings.seed = seed;
        let plan = stop(|s| (s.relative_rmse, s.pilot) = (Some(0.02), Some(2)));
        let picture = run(&settings, plan, &());
        let passes = picture.film.passes()[0].clone();
        assert_eq!(picture.ending, Ending::Goals);
        assert!(passes.start.is_power_of_two() && passes.len() as u32 <= 16 * passes.start, "{passes:?}");
        assert!(picture.samples < 1 << 12, "{}", picture.samples);
    }
}

/// A pilot takes a small part of the time if that is limited, however much its error asks for.
#[test]
fn a_pilot_leaves_time_for_the_picture() {
    let settings = Settings::new(16, 16, u32::MAX);
    let plan = stop(|s| (s.relative_rmse, s.pilot, s.seconds) = (Some(1e-9), Some(2), Some(1.0)));
    let picture = run(&settings, plan, &());
    let passes = picture.film.passes()[0].clone();
    assert_eq!(picture.ending, Ending::Seconds);
    assert!(passes.len() as u32 > passes.start, "{passes:?}");
}

#[test]
fn a_pilot_must_leave_a_pass() {
    let (scene, camera) = light_over_floor();
    let settings = Settings::new(16, 16, 64);
    for (pilot, is_good) in [(3, true), (4, false), (5, false)] {
        let plan = stop(|s| (s.relative_rmse, s.pilot) = (Some(0.5), Some(pilot)));
        let result = Render::new(&scene, &camera, &settings).until(plan).run();
        let is_refused = matches!(result, Err(RenderError::Param { name: "pilot passes", .. }));
        assert_eq!((result.is_ok(), is_refused), (is_good, !is_good), "{pilot}");
    }
}

/// The mean radiance over many seeds of a picture of one pixel that stops at an error goal, and its standard
/// error.
fn mean_of_stopped(pilot: Option<u32>, seeds: u64) -> (f64, f64) {
    let (scene, camera) = light_over_floor();
    let mut settings = Settings::new(1, 1, 1 << 12);
    (settings.pass_samples, settings.estimator, settings.threads) = (1, Estimator::Bsdf, 1);
    let stop = stop(|s| (s.pixels, s.pilot) = (Some(PixelGoal { error: 0.2, share: 1.0 }), pilot));
    let means = (0..seeds).map(|seed| {
        settings.seed = seed;
        let render = Render::new(&scene, &camera, &settings).until(stop);
        render.run().expect("the scene is good").film.mean(0, 0).g
    });
    let means: Vec<f64> = means.collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    (mean, (means.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt())
}

/// A single pixel that checks its error after each pass is clearly biased; one with a pilot is not.
#[test]
fn a_pilot_avoids_stopping_bias() {
    let (mean, std_err) = mean_of_stopped(None, 5_000);
    assert!(
        (mean - TRUTH).abs() > 20.0 * std_err,
        "{mean} +- {std_err} is not biased: a pilot is not needed"
    );
    let (mean, std_err) = mean_of_stopped(Some(8), 20_000);
    assert!((mean - TRUTH).abs() < Z_LIMIT * std_err, "{mean} +- {std_err}");
    assert!(Z_LIMIT * std_err < 0.01 * TRUTH, "{mean} +- {std_err}");
}

#[test]
fn invalid_conditions_are_refused() {
    let (scene, camera) = light_over_floor();
    let settings = Settings::new(2, 2, 1);
    let goal = |error, share| Some(PixelGoal { error, share });
    for (bad, name) in [
        (stop(|s| s.seconds = Some(0.0)), "seconds"),
        (stop(|s| s.seconds = Some(f64::NAN)), "seconds"),
        (stop(|s| s.relative_rmse = Some(-0.1)), "relative_rmse"),
        (stop(|s| s.pixels = goal(f64::INFINITY, 0.5)), "pixel error"),
        (stop(|s| s.pixels = goal(0.1, 1.5)), "share of pixels"),
        (stop(|s| s.pilot = Some(1)), "pilot passes"),
    ] {
        match Render::new(&scene, &camera, &settings).until(bad).run() {
            Err(RenderError::Param { name: found, .. }) => assert_eq!(found, name),
            other => panic!("{name}: {other:?}"),
        }
    }
}

/// Records progress and passes, and cancels after a time.
#[derive(Default)]
struct Recorder {
    last: Mutex<Option<Progress>>,
    passes: AtomicU32,
    cancel_after: Option<Duration>,
    start: Option<Instant>,
    tiles_after_cancelling: AtomicU32,
}

impl Monitor for Recorder {
    fn progress(&self, progress: Progress) {
        if self.cancelled() {
            self.tiles_after_cancelling.fetch_add(1, Ordering::Relaxed);
        }
        *self.last.lock().expect("no thread panics while it holds the lock") = Some(progress);
    }

    fn cancelled(&self) -> bool {
        self.start.zip(self.cancel_after).is_some_and(|(start, after)| start.elapsed() > after)
    }

    fn pass_done(&self, _picture: &Picture) {
        self.passes.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn progress_reports_rays_error_and_time_left() {
    let recorder = Recorder::default();
    let mut settings = Settings::new(32, 32, 64);
    settings.threads = 1;
    let picture = run(&settings, Stop::default(), &recorder);
    let last = recorder.last.lock().unwrap().expect("there were tiles");
    assert_eq!((last.samples_done, last.samples_total), (64 * 1024, 64 * 1024));
    assert_eq!((last.rays, last.seconds_left), (picture.counters.rays(), 0.0));
    assert_eq!(last.relative_rmse, picture.film.error().relative_rmse);
    assert_eq!(recorder.passes.load(Ordering::Relaxed), 4);
}

/// After a render is cancelled, each thread ends at the next bounce of its wavefront, within milliseconds,
/// and completes no further tile.
#[test]
fn cancelling_finishes_no_further_tile() {
    // One pass of this picture would take minutes.
    let mut settings = Settings::new(4096, 4096, 1 << 20);
    settings.threads = 2;
    let recorder = Recorder {
        cancel_after: Some(Duration::from_millis(150)),
        start: Some(Instant::now()),
        ..Recorder::default()
    };
    let picture = run(&settings, Stop::default(), &recorder);
    assert_eq!((picture.ending, picture.samples), (Ending::Cancelled, 0));
    let late = recorder.tiles_after_cancelling.load(Ordering::Relaxed);
    assert!(late <= settings.threads as u32, "{late} tiles were finished");
}

/// Counts the rays that begin at it.
#[derive(Debug)]
struct Counting(PinholeCamera, AtomicU32);

impl Sensor for Counting {
    fn start(&self, sample: &ElementSample) -> PathStart {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.start(sample)
    }

    fn hash(&self, key: &mut dyn Hasher) {
        self.0.hash(key);
    }
}

/// Cancels as soon as this number of rays have begun.
struct CancelsAfter<'a>(&'a Counting, u32);

impl Monitor for CancelsAfter<'_> {
    fn cancelled(&self) -> bool {
        self.0.1.load(Ordering::Relaxed) >= self.1
    }
}

/// Probes for the edges of lights end too.
#[test]
fn cancelling_begins_no_further_tile() {
    let (scene, camera) = light_over_floor();
    let mut settings = Settings::new(1024, 1024, 16);
    settings.threads = 2;
    let sensor = Counting(camera, AtomicU32::new(0));
    let after = 50_000;
    let monitor = CancelsAfter(&sensor, after);
    let picture = Render::new(&scene, &sensor, &settings).monitor(&monitor).run().expect("the scene is good");
    assert_eq!((picture.ending, picture.samples), (Ending::Cancelled, 0));
    // A tile has 16 probes in each of 18 x 18 pixels, and then four samples in 16 x 16.
    let of_tile = 18 * 18 * 16 + 16 * 16 * 4;
    let begun = sensor.1.load(Ordering::Relaxed);
    assert!(begun <= after + 2 * of_tile, "{begun} rays");
}

/// Only passes that a run renders are passed to the monitor.
#[test]
fn passes_that_a_picture_holds_are_not_done_again() {
    let (scene, camera) = light_over_floor();
    let settings = Settings::new(32, 32, 96);
    let held = Render::new(&scene, &camera, &settings).passes(1..4).run().expect("the scene is good");
    let unreachable = stop(|s| s.relative_rmse = Some(1e-9));
    // The pilot takes passes 0 and 1.
    let pilot = stop(|s| (s.relative_rmse, s.pilot) = (Some(1e-9), Some(2)));
    for (stop, first, count) in [(Stop::default(), 0, 3), (unreachable, 0, 3), (pilot, 1, 2)] {
        let recorder = Recorder::default();
        let picture =
            Render::new(&scene, &camera, &settings).until(stop).resume(held.clone()).monitor(&recorder).run();
        assert_eq!(picture.expect("it is the same picture").film.passes(), vec![first..6]);
        assert_eq!(recorder.passes.load(Ordering::Relaxed), count);
    }
}

/// Records the error that is told first.
#[derive(Default)]
struct FirstError(Mutex<Option<f64>>);

impl Monitor for FirstError {
    fn progress(&self, progress: Progress) {
        self.0
            .lock()
            .expect("no thread panics while it holds the lock")
            .get_or_insert(progress.relative_rmse);
    }
}

#[test]
fn the_error_of_a_resumed_picture_is_told_from_the_start() {
    let (scene, camera) = light_over_floor();
    let settings = Settings::new(32, 32, 96);
    let held = Render::new(&scene, &camera, &settings).passes(0..4).run().expect("the scene is good");
    let (error, first) = (held.film.error().relative_rmse, FirstError::default());
    Render::new(&scene, &camera, &settings)
        .resume(held)
        .monitor(&first)
        .run()
        .expect("it is the same picture");
    assert_eq!(*first.0.lock().unwrap(), Some(error));
}

#[test]
fn a_film_without_passes_plans_no_number_of_them() {
    let (scene, camera) = light_over_floor();
    let monitor =
        Recorder { cancel_after: Some(Duration::ZERO), start: Some(Instant::now()), ..Recorder::default() };
    let empty = Render::new(&scene, &camera, &Settings::new(16, 16, 16))
        .monitor(&monitor)
        .run()
        .expect("the scene is good");
    assert_eq!(empty.samples, 0);
    let goal = PixelGoal { error: 0.1, share: 0.5 };
    for stop in [stop(|s| s.relative_rmse = Some(0.1)), stop(|s| s.pixels = Some(goal))] {
        assert_eq!(stop.passes_after(&empty.film), Some(f64::INFINITY));
    }
}

/// An accelerator that fails once, after a number of rays.
#[derive(Debug)]
struct Failing {
    inner: Box<dyn Accel>,
    left: AtomicU32,
    how: Failure,
}

#[derive(Clone, Copy, Debug)]
enum Failure {
    Panic,
    NotANumber,
}

impl Accel for Failing {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.inner.intersect(ray);
        // An atomic update, so that exactly one ray fails.
        let one_less = |left: u32| Some(left.saturating_sub(1));
        let left = self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, one_less).unwrap_or(0);
        match self.how {
            _ if left != 1 => hit,
            Failure::Panic => panic!("intersection failed"),
            Failure::NotANumber => hit.map(|hit| Hit { u: f64::NAN, ..hit }),
        }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.inner.occluded(ray)
    }

    fn bounds(&self) -> Aabb {
        self.inner.bounds()
    }

    fn bytes(&self) -> usize {
        self.inner.bytes()
    }
}

fn failing(rays: u32, how: Failure) -> (Scene<Box<dyn Accel>>, PinholeCamera) {
    (failing_in(&scenes::light_over_floor(), rays, how), light_over_floor().1)
}

fn failing_in(model: &Model, rays: u32, how: Failure) -> Scene<Box<dyn Accel>> {
    let build = |triangles: &_| -> Result<Box<dyn Accel>, _> {
        let inner: Box<dyn Accel> = RENDERED[0].1(triangles)?;
        Ok(Box::new(Failing { inner, left: AtomicU32::new(rays), how }))
    };
    Scene::build(model.clone(), build).expect("the model is good")
}

/// What a render does before its first sample is done again for a replay: with a mirror, it traces paths. A panic there is an
/// error, as is one in the replay itself.
#[test]
fn a_panic_in_a_replay_is_an_error() {
    let mut model = scenes::light_over_floor();
    let without_mirror = model.clone();
    let [a, b, c] = [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::new(1.0, 0.0, 1.0)].map(|v| v.as_vec3());
    model.add(Material::mirror(Rgb::splat(0.9)).expect("in range"), [Triangle::new(a, b, c)]);
    for model in [model, without_mirror] {
        let scene = failing_in(&model, 100, Failure::Panic);
        let replayed = replay(&scene, &light_over_floor().1, &Settings::new(16, 16, 1), (3, 4), 0);
        assert!(matches!(replayed, Err(RenderError::Worker { .. })), "{replayed:?}");
    }
}

/// A panicking worker ends the render with an error and leaves nothing locked.
#[test]
fn a_panic_is_an_error_and_the_next_render_works() {
    let mut settings = Settings::new(64, 64, 64);
    for threads in [1, 2, 7] {
        settings.threads = threads;
        // Before and in the first pass are 1.3 * 2^16 probes for lights, 2^16 camera rays, and further rays.
        let (scene, camera) = failing(300_000, Failure::Panic);
        let recorder = Recorder::default();
        let error = Render::new(&scene, &camera, &settings).monitor(&recorder).run().expect_err("it panics");
        assert!(
            matches!(&error, RenderError::Worker { message, .. } if message == "intersection failed"),
            "{error:?}"
        );
        assert!(error.to_string().contains("panic in the tile at pixel ("), "{error}");
        assert!(recorder.passes.load(Ordering::Relaxed) >= 1, "whole passes were reported");
        let again = render(&scene, &camera, &settings).expect("it panics only once");
        assert_eq!(again.film, run(&settings, Stop::default(), &()).film);
    }
}

/// Panics in one of its methods.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Faulty {
    Progress,
    Cancelled,
    PassDone,
}

impl Monitor for Faulty {
    fn progress(&self, _progress: Progress) {
        assert_ne!(*self, Self::Progress, "faulty");
    }

    fn cancelled(&self) -> bool {
        assert_ne!(*self, Self::Cancelled, "faulty");
        false
    }

    fn pass_done(&self, _picture: &Picture) {
        assert_ne!(*self, Self::PassDone, "faulty");
    }
}

#[test]
fn a_panic_in_any_method_of_a_monitor_is_an_error() {
    let (scene, camera) = light_over_floor();
    let settings = Settings::new(32, 32, 64);
    let plan = stop(|s| (s.relative_rmse, s.pilot) = (Some(1e-6), Some(2)));
    for faulty in [Faulty::Progress, Faulty::Cancelled, Faulty::PassDone] {
        for stop in [Stop::default(), plan] {
            let error = Render::new(&scene, &camera, &settings).until(stop).monitor(&faulty).run();
            let error = error.expect_err("the monitor panics");
            let message = match (&error, faulty) {
                (RenderError::Monitor { message, samples }, Faulty::PassDone) => {
                    assert_eq!(*samples, 16);
                    message
                }
                (RenderError::Worker { message, .. }, Faulty::Progress | Faulty::Cancelled) => message,
                _ => panic!("{faulty:?}: {error:?}"),
            };
            assert!(message.contains("faulty"), "{faulty:?}: {message}");
            assert!(error.to_string().ends_with(message.as_str()), "{error}");
        }
    }
}

/// The error names pixel and sample.
#[test]
fn a_nan_is_an_error_that_names_its_sample() {
    let mut settings = Settings::new(64, 64, 64);
    // No probes come first, neither for lights nor for path reuse.
    (settings.threads, settings.supersampling, settings.path_reuse) = (1, Supersampling::Off, PathReuse::Off);
    // A camera ray of the first tile: four samples of a pixel, block after block of 4 x 4 pixels.
    let (scene, camera) = failing(4 * 18 + 3, Failure::NotANumber);
    let error = render(&scene, &camera, &settings).expect_err("a point is not a number");
    assert_eq!(error, RenderError::NonFinite { x: 6, y: 0, sample: 2 });
}

/// With path reuse the error still names the sample of the failing ray.
#[test]
fn path_reuse_does_not_spread_a_nan() {
    let mut settings = Settings::new(64, 64, 64);
    (settings.threads, settings.roulette.start, settings.supersampling) = (1, 20, Supersampling::Off);
    // No path ends early in a furnace: 64 x 64 paths of three rays come first, which find out which lights are visible, then
    // as many of 17 rays, which find out whether reuse pays, and 2048 rays precede the third rays of the first tile's 4 x 256
    // samples.
    let ray = (3 + 17) * 64 * 64 + 2048 + 4 * 18 + 3;
    let scene = failing_in(&scenes::furnace(0.5, 1.0, DVec3::ZERO), ray, Failure::NotANumber);
    let camera = stare(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.35, -0.2, 1.0));
    let error = render(&scene, &camera, &settings).expect_err("a point is not a number");
    assert_eq!(error, RenderError::NonFinite { x: 6, y: 0, sample: 2 });
}
