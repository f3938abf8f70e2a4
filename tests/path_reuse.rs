//! Path reuse keeps the mean of every pixel and lowers the variance.
#![allow(clippy::print_stdout, reason = "figures for docs/estimators.md, with --nocapture")]

use glam::DVec3;
use globillum::integrator::{
    Estimator, Film, Guiding, Model, PathReuse, PinholeCamera, Render, Sampler, Settings, render,
};
use globillum::material::{Emission, Material, Rgb, Sides};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::cornell;
use globillum_testkit::pixels::{PIXEL_LIMIT, assert_same_means, largest_difference, largest_z};
use globillum_testkit::scenes::{self, stare};
use globillum_testkit::shapes::{cuboid, icosphere, inside_out, quad};
use globillum_testkit::stats::Estimate;

use Estimator::{Bsdf, Light, Mis};

/// Pixels along each side of most pictures. They are few, so that the pixels of a group show different
/// surfaces.
const SIDE: u32 = 16;

const PASSES: u32 = 128;

fn film(model: &Model, camera: &PinholeCamera, settings: &Settings) -> Film {
    let scene = scenes::scene(model, RENDERED[0].1);
    render(&scene, camera, settings).expect("the scene is good").film
}

/// A picture of `3 * PASSES` passes of four samples per pixel.
fn picture(
    model: &Model,
    camera: &PinholeCamera,
    path_reuse: PathReuse,
    change: impl Fn(&mut Settings),
) -> Film {
    let mut settings = Settings::new(SIDE, SIDE, 12 * PASSES);
    (settings.path_reuse, settings.seed) = (path_reuse, path_reuse as u64);
    settings.pass_samples = 4;
    change(&mut settings);
    film(model, camera, &settings)
}

/// Asserts that each pixel has the same mean with and without path reuse, and that path reuse changes the errors.
fn assert_same_mean(what: &str, model: &Model, camera: &PinholeCamera, change: impl Fn(&mut Settings)) {
    let without = picture(model, camera, PathReuse::Off, &change);
    assert_same_mean_as(&without, what, model, camera, change);
}

/// [`assert_same_mean`] beside a picture without path reuse that has the same expectation.
fn assert_same_mean_as(
    without: &Film,
    what: &str,
    model: &Model,
    camera: &PinholeCamera,
    change: impl Fn(&mut Settings),
) {
    let with = picture(model, camera, PathReuse::Tiles, &change);
    assert_same_means(what, without, &with, 0.02);
    // With equal random numbers, only path reuse makes a difference.
    let [alone, reused] = [PathReuse::Off, PathReuse::Tiles].map(|path_reuse| {
        picture(model, camera, path_reuse, |s| {
            change(s);
            (s.seed, s.samples, s.sampler) = (9, s.pass_samples, Sampler::Independent);
        })
    });
    assert!(largest_difference(&alone, &reused) > 0.0, "{what}: no path was reused");
}

#[test]
fn pixels_of_a_box_have_the_mean_of_their_own_paths() {
    // The light is not visible: its edge would dominate the error.
    let (eye, target) = (DVec3::new(0.0, 0.2, 3.0), DVec3::new(0.0, -0.4, 0.0));
    let camera = PinholeCamera::look_at(eye, target, DVec3::Y, 0.6).expect("they are apart");
    for (what, specular, estimator) in [("diffuse", false, Mis), ("a mirror", true, Light)] {
        let model = cornell::with_blocks(specular).expect("the box is good");
        assert_same_mean(&format!("{what}, {estimator:?}"), &model, &camera, |s| s.estimator = estimator);
    }
}

/// Russian roulette may end paths behind the mirror, which path reuse must account for.
#[test]
fn pixels_under_early_roulette_have_the_mean_of_their_own_paths() {
    let model = cornell::with_blocks(true).expect("the box is good");
    let (eye, target) = (DVec3::new(0.5, -0.2, 1.4), DVec3::new(-0.3, -0.4, -0.3));
    let camera = PinholeCamera::look_at(eye, target, DVec3::Y, 0.5).expect("they are apart");
    assert_same_mean("early roulette", &model, &camera, |s| {
        (s.roulette.start, s.roulette.threshold) = (1, 1.0);
        (s.samples, s.pass_samples) = (32 * PASSES, 16);
    });
}

/// A room with a different albedo on each wall, one of which emits. Thin sheets intersect each other before
/// the camera, with a mirror behind them. Path prefixes end on both sides of a sheet, before and behind it,
/// and at different bounces.
fn sheets() -> (Model, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let emission = Emission::new(Rgb::new(1.0, 0.7, 0.4), Sides::Front).expect("finite");
    let walls = inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    for (i, wall) in walls.chunks(2).enumerate() {
        let wall = wall.iter().copied();
        let albedo = 0.3 + 0.1 * i as f64;
        let material = Material::lambert(Rgb::new(albedo, 0.5, 1.0 - albedo)).expect("an albedo");
        model.add(if i == 0 { material.emitting(emission) } else { material }, wall);
    }
    let sheet = Material::lambert(Rgb::new(0.9, 0.2, 0.6)).expect("an albedo");
    model.add(sheet, quad(p(-0.6, -0.6, 0.1), p(0.5, -0.5, -0.2), p(0.6, 0.6, 0.0), p(-0.5, 0.4, -0.1)));
    model.add(sheet, quad(p(0.05, -0.7, 0.4), p(-0.1, -0.7, -0.4), p(0.0, 0.7, -0.5), p(0.1, 0.6, 0.5)));
    let mirror = Material::mirror(Rgb::splat(0.9)).expect("a reflectance");
    model.add(mirror, quad(p(-0.9, -0.9, -0.8), p(0.9, -0.9, -0.8), p(0.9, 0.2, -0.9), p(-0.9, 0.3, -0.9)));
    let camera =
        PinholeCamera::look_at(p(0.2, 0.3, 0.95), p(0.0, 0.0, 0.0), DVec3::Y, 1.5).expect("they are apart");
    (model, camera)
}

#[test]
fn pixels_of_crossing_sheets_have_the_mean_of_their_own_paths() {
    let (model, camera) = sheets();
    let without = picture(&model, &camera, PathReuse::Off, |s| s.estimator = Mis);
    for estimator in [Bsdf, Mis] {
        let what = format!("{estimator:?}");
        assert_same_mean_as(&without, &what, &model, &camera, |s| s.estimator = estimator);
    }
    let independent = |s: &mut Settings| s.sampler = Sampler::Independent;
    assert_same_mean_as(&without, "independent samples", &model, &camera, independent);
    assert_same_mean("at most 2 bounces", &model, &camera, |s| s.max_bounces = Some(2));
}

/// A diffuse room with coloured mirrors: one that emits and reflects no blue, one between camera and wall that reflects on
/// both sides, and a ball of small triangles. Prefixes end before mirrors, behind them, and in what they show.
fn mirrors() -> (Model, PinholeCamera) {
    let p = DVec3::new;
    let mut model = Model::default();
    let walls = inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    let glow = Emission::new(Rgb::new(1.0, 0.8, 0.5), Sides::Front).expect("finite");
    for (i, wall) in walls.chunks(2).enumerate() {
        let wall = wall.iter().copied();
        let material = Material::lambert(Rgb::new(0.3 + 0.1 * i as f64, 0.6, 0.4)).expect("an albedo");
        model.add(if i == 3 { material.emitting(glow) } else { material }, wall);
    }
    let mirror = |r, g, b| Material::mirror(Rgb::new(r, g, b)).expect("a reflectance");
    let glow = Emission::new(Rgb::new(0.1, 0.2, 0.3), Sides::Both).expect("finite");
    let side = quad(p(-0.9, -0.9, 0.9), p(-0.8, -0.9, -0.9), p(-0.8, 0.9, -0.9), p(-0.9, 0.8, 0.9));
    model.add(mirror(0.9, 0.7, 0.0).emitting(glow), side);
    model.add(
        mirror(0.5, 0.9, 0.8),
        quad(p(0.2, -0.8, 0.3), p(0.8, -0.8, -0.2), p(0.7, 0.5, -0.4), p(0.1, 0.4, 0.2)),
    );
    model.add(mirror(0.9, 0.9, 0.9), icosphere(1).placed(0.25, p(-0.3, -0.7, -0.4)).triangles());
    let camera =
        PinholeCamera::look_at(p(0.1, 0.2, 0.95), p(0.0, -0.3, -0.2), DVec3::Y, 1.2).expect("they are apart");
    (model, camera)
}

#[test]
fn pixels_among_mirrors_have_the_mean_of_their_own_paths() {
    let (model, camera) = mirrors();
    let without = picture(&model, &camera, PathReuse::Off, |s| s.estimator = Mis);
    for (estimator, times) in [(Bsdf, 2), (Light, 1), (Mis, 1)] {
        let what = format!("mirrors, {estimator:?}");
        assert_same_mean_as(&without, &what, &model, &camera, |s| {
            (s.estimator, s.samples) = (estimator, times * s.samples);
        });
    }
    let guided = |s: &mut Settings| s.guiding = Guiding::Trained;
    assert_same_mean_as(&without, "mirrors, guided", &model, &camera, guided);
    assert_same_mean("mirrors, at most 3 bounces", &model, &camera, |s| s.max_bounces = Some(3));
}

/// The floor is lit by way of a mirror alone, from a wall that a light shines on. A black sheet hides the wall from it, and
/// two others throw shadows: one before the mirror, one between mirror and wall. Without reuse of what mirrors show, the
/// ratio of variances is about 1.
#[test]
fn pixels_share_what_mirrors_show() {
    let (mut model, p) = (Model::default(), DVec3::new);
    let mut add = |material, [a, b, c, d]: [DVec3; 4]| model.add(material, quad(a, b, c, d));
    let grey = |albedo| Material::lambert(Rgb::splat(albedo)).expect("an albedo");
    add(grey(0.8), [p(-1.0, 0.0, 1.0), p(1.0, 0.0, 1.0), p(1.0, 0.0, -1.0), p(-1.0, 0.0, -1.0)]);
    add(grey(0.8), [p(1.0, 1.0, 1.1), p(-1.0, 1.0, 1.1), p(-1.0, 2.5, 1.1), p(1.0, 2.5, 1.1)]);
    add(grey(0.0), [p(-1.0, 0.9, 1.1), p(1.0, 0.9, 1.1), p(1.0, 0.9, 0.2), p(-1.0, 0.9, 0.2)]);
    add(grey(0.0), [p(-0.1, 0.0, -0.3), p(0.0, 0.0, -0.3), p(0.0, 1.0, -0.3), p(-0.1, 1.0, -0.3)]);
    add(grey(0.0), [p(0.1, 0.6, -0.7), p(0.3, 0.6, -0.7), p(0.3, 1.5, -0.7), p(0.1, 1.5, -0.7)]);
    let mirror = Material::mirror(Rgb::splat(0.9)).expect("a reflectance");
    add(mirror, [p(-1.0, 0.0, -1.1), p(1.0, 0.0, -1.1), p(1.0, 2.0, -1.1), p(-1.0, 2.0, -1.1)]);
    let light = Material::light(Rgb::splat(50.0)).expect("a radiance");
    add(light, [p(-0.1, 1.6, 0.6), p(0.1, 1.6, 0.6), p(0.1, 1.8, 0.6), p(-0.1, 1.8, 0.6)]);
    let camera =
        PinholeCamera::look_at(p(0.0, 0.6, 0.0), p(0.0, 0.0, -0.1), DVec3::Z, 0.6).expect("they are apart");
    let films = [PathReuse::Off, PathReuse::Tiles]
        .map(|path_reuse| picture(&model, &camera, path_reuse, |s| s.samples = 8 * PASSES));
    let z = largest_z(&films[0], &films[1]);
    let [without, with] = films.map(|film| film.variances_of_mean().map(|variance| variance.g).sum::<f64>());
    println!("what a mirror shows: z {z:.2}, variance {:.3} of that without path reuse", with / without);
    assert!(z < PIXEL_LIMIT, "{z}");
    assert!(with < 0.5 * without, "{with} {without}");
}

/// A bright pixel uses the path suffixes of dark pixels of its group like its own. Russian roulette must not
/// make them rare and bright because of the low throughput of the dark pixels.
#[test]
fn dark_neighbours_do_not_raise_the_variance() {
    let (mut model, p) = (Model::default(), DVec3::new);
    let emission = Emission::new(Rgb::WHITE, Sides::Front).expect("finite");
    let walls = inside_out(cuboid(DVec3::ZERO, DVec3::ONE, 0.0));
    let wall = Material::lambert(Rgb::splat(0.8)).expect("an albedo");
    model.add(wall.emitting(emission), walls[..2].iter().copied());
    model.add(wall, walls[2..].iter().copied());
    let [dark, bright] = [0.01, 0.9].map(|albedo| Material::lambert(Rgb::splat(albedo)).expect("an albedo"));
    let cells = SIDE as i32 / 2;
    for (i, k) in (-cells..cells).flat_map(|i| (-cells..cells).map(move |k| (i, k))) {
        let [x0, x1, z0, z1] = [i, i + 1, k, k + 1].map(|n| f64::from(n) * 0.05);
        let material = if i % 2 == 0 && k % 2 == 0 { bright } else { dark };
        model.add(material, quad(p(x0, -0.9, z1), p(x1, -0.9, z1), p(x1, -0.9, z0), p(x0, -0.9, z0)));
    }
    // One pixel per square of the floor.
    let fov = 2.0 * (0.4_f64 / 1.5).atan();
    let camera =
        PinholeCamera::look_at(p(0.0, 0.6, 0.0), p(0.0, -0.9, 0.0), DVec3::Z, fov).expect("they are apart");
    let [without, with] = [PathReuse::Off, PathReuse::Tiles].map(|path_reuse| {
        let mut settings = Settings::new(SIDE, SIDE, 1024);
        (settings.path_reuse, settings.seed) = (path_reuse, path_reuse as u64);
        let film = film(&model, &camera, &settings);
        let bright = film.means().zip(film.variances_of_mean()).filter(|(mean, _)| mean.g > 0.3);
        let (count, sum) = bright.fold((0, 0.0), |(n, sum), (_, variance)| (n + 1, sum + variance.g));
        assert_eq!(count, SIDE * SIDE / 4, "{path_reuse:?}");
        sum
    });
    println!("variance of bright pixels: {:.3} of that without path reuse", with / without);
    assert!(with < 0.5 * without, "{with} {without}");
}

/// A furnace: the mean over all pixels, and the share of their 95 % intervals that contain it. For 128 x 128 pixels whose
/// errors may be equal in groups of sixteen, its standard deviation is at most 0.68 %. The tolerance is 5.85 of them.
#[test]
fn a_furnace_with_path_reuse() {
    let camera = stare(DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.35, -0.2, 1.0));
    let model = scenes::furnace(0.5, 1.0, DVec3::ZERO);
    for (limit, truth) in [(Some(2), 1.75), (Some(5), 2.0 - f64::powi(0.5, 5)), (None, 2.0)] {
        for estimator in [Bsdf, Mis] {
            let mut settings = Settings::new(128, 128, 64);
            (settings.max_bounces, settings.estimator) = (limit, estimator);
            let film = film(&model, &camera, &settings);
            let what = format!("limit {limit:?}, {estimator:?}");
            Estimate::of_film(&film, |c| c.g).assert_is(truth, &what);
            let pixels = (0..128).flat_map(|y| (0..128).map(move |x| (x, y)));
            let holds = |&(x, y): &(u32, u32)| (film.mean(x, y).g - truth).abs() <= film.margin_95(x, y).g;
            let share = pixels.filter(holds).count() as f64 / f64::from(128 * 128);
            println!("{what}: {share:.4} of the intervals contain the truth");
            assert!((share - 0.95).abs() < 0.04, "{what}: {share}");
        }
    }
}

/// There is nothing to reuse: all illumination is direct. Sobol' points are shared nevertheless.
#[test]
fn path_reuse_does_not_change_direct_illumination() {
    let (sheets, inside) = sheets();
    let above = stare(DVec3::new(0.1, 0.5, 0.2), DVec3::ZERO);
    for (model, camera, limit) in [(&scenes::light_over_floor(), above, None), (&sheets, inside, Some(1))] {
        let [without, with] = [PathReuse::Off, PathReuse::Tiles].map(|path_reuse| {
            let mut settings = Settings::new(SIDE, SIDE, 32);
            (settings.path_reuse, settings.max_bounces) = (path_reuse, limit);
            settings.sampler = Sampler::Independent;
            film(model, &camera, &settings)
        });
        assert!(without.means().eq(with.means()) && !with.image_mean().is_black());
    }
}

/// The variance of the picture's mean, by 256 passes, divided by its value for independent pixels.
fn variance_ratio(path_reuse: PathReuse) -> f64 {
    // The ceiling has indirect illumination only, by path suffixes that all pixels of a group can reuse.
    let model = cornell::with_blocks(false).expect("the box is good");
    let camera = stare(DVec3::new(0.2, 0.1, 0.9), DVec3::new(0.5, 1.0, 0.5));
    let scene = scenes::scene(&model, RENDERED[0].1);
    let mut settings = Settings::new(SIDE, SIDE, PASSES);
    (settings.path_reuse, settings.pass_samples) = (path_reuse, 1);
    let means = (0..PASSES).map(|pass| {
        let picture = Render::new(&scene, &camera, &settings).passes(pass..pass + 1).run();
        picture.expect("the scene is good").film.image_mean().g
    });
    let means: Vec<f64> = means.collect();
    let whole = film(&model, &camera, &settings);
    let n = f64::from(PASSES);
    let variance =
        means.iter().map(|mean| (mean - whole.image_mean().g).powi(2)).sum::<f64>() / (n - 1.0) / n;
    let pixels = f64::from(SIDE * SIDE);
    variance / (whole.variances_of_mean().map(|v| v.g).sum::<f64>() / (pixels * pixels))
}

/// A variance by 256 observations has a relative standard deviation of 8.9 %. The tolerance is 5.85 of them. The pixels of
/// a group are apart, so that not all could have found a suffix as easily.
#[test]
fn the_errors_of_sixteen_pixels_are_alike() {
    let [without, with] = [PathReuse::Off, PathReuse::Tiles].map(variance_ratio);
    println!("without path reuse {without:.2}, with {with:.2}");
    assert!((without - 1.0).abs() < 0.52, "{without}");
    assert!((4.0..1.52 * 16.0).contains(&with), "{with}");
}
