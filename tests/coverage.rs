//! Coverage of 95 % confidence intervals where samples are skewed and pixels differ. Seeds are fixed. A share is accepted
//! from 93 to 97 %, and 5.85 of its standard deviations beyond.
#![allow(clippy::print_stdout, reason = "figures for docs/estimators.md, with --nocapture")]

use glam::DVec3;
use globillum::integrator::{
    Film, Model, PathReuse, Picture, PinholeCamera, Render, Sampler, Settings, Supersampling, render,
};
use globillum::material::{Material, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::cornell;
use globillum_testkit::scenes;
use globillum_testkit::shapes::{icosphere, quad};
use globillum_testkit::stats::Z_LIMIT;

/// Pixels along each side.
const SIDE: u32 = 32;

fn lambert(albedo: f64) -> Material {
    Material::lambert(Rgb::splat(albedo)).expect("an albedo")
}

fn light(radiance: f64) -> Material {
    Material::light(Rgb::splat(radiance)).expect("finite")
}

fn look(eye: DVec3, target: DVec3, fov: f64) -> PinholeCamera {
    PinholeCamera::look_at(eye, target, DVec3::Y, fov).expect("they are apart")
}

/// A floor of dark and bright squares, seen at an angle.
fn checkered_floor() -> (Model, PinholeCamera) {
    let (mut model, p) = (Model::default(), DVec3::new);
    for (i, k) in (-20..20).flat_map(|i| (-40..4).map(move |k| (i, k))) {
        let albedo = if (i + k) % 2 == 0 { 0.1 } else { 0.8 };
        let [x0, x1, z0, z1] = [i, i + 1, k, k + 1].map(|n| 0.3 * f64::from(n));
        model.add(lambert(albedo), quad(p(x0, 0.0, z1), p(x1, 0.0, z1), p(x1, 0.0, z0), p(x0, 0.0, z0)));
    }
    let above = quad(p(-1.0, 2.0, -4.0), p(1.0, 2.0, -4.0), p(1.0, 2.0, -2.0), p(-1.0, 2.0, -2.0));
    model.add(light(5.0), above);
    (model, look(p(0.1, 0.6, 1.5), p(0.0, 0.2, -2.0), 0.7))
}

/// A corner with five small mirror balls. Only BSDF sampling finds the light through them, which is rare.
fn small_mirrors() -> (Model, PinholeCamera) {
    let (mut model, p) = (Model::default(), DVec3::new);
    model.add(lambert(0.6), quad(p(-2.0, 0.0, 2.0), p(2.0, 0.0, 2.0), p(2.0, 0.0, -2.0), p(-2.0, 0.0, -2.0)));
    model.add(
        lambert(0.6),
        quad(p(-2.0, 0.0, -1.0), p(2.0, 0.0, -1.0), p(2.0, 3.0, -1.0), p(-2.0, 3.0, -1.0)),
    );
    let mirror = Material::mirror(Rgb::splat(0.9)).expect("a reflectance");
    for (center, radius) in [
        (p(-0.5, 0.3, 0.0), 0.12),
        (p(0.3, 0.5, -0.3), 0.1),
        (p(0.7, 0.2, 0.4), 0.15),
        (p(0.0, 0.8, -0.6), 0.08),
        (p(-0.8, 0.9, -0.5), 0.1),
    ] {
        model.add(mirror, icosphere(2).placed(radius, center).triangles());
    }
    let above = quad(p(-0.4, 2.0, -0.2), p(0.4, 2.0, -0.2), p(0.4, 2.0, 0.5), p(-0.4, 2.0, 0.5));
    model.add(light(20.0), above);
    (model, look(p(0.0, 0.9, 2.5), p(0.0, 0.5, -0.3), 0.8))
}

/// Bands of four pixels' width. Each pixel of every second band contains an emitting sliver that covers the
/// fraction `covered` of it; the other bands are dark.
fn slivers(covered: f64) -> (Model, PinholeCamera) {
    let (mut model, p) = (Model::default(), DVec3::new);
    let pixel = 2.0 / f64::from(SIDE);
    for column in (0..SIDE).filter(|column| column / 4 % 2 == 0) {
        let x0 = pixel * (f64::from(column) + 0.37) - 1.0;
        let x1 = x0 + pixel * covered;
        model.add(light(1.0), quad(p(x0, -1.0, 0.0), p(x1, -1.0, 0.0), p(x1, 1.0, 0.0), p(x0, 1.0, 0.0)));
    }
    (model, look(p(0.0, 0.0, 1.0), DVec3::ZERO, 2.0 * 1.0_f64.atan()))
}

/// `count` pictures of `passes` passes each, without common passes.
fn pictures(
    (model, camera): &(Model, PinholeCamera),
    settings: &Settings,
    passes: u32,
    count: u32,
) -> Vec<Picture> {
    let scene = scenes::scene(model, RENDERED[0].1);
    let of = |i| Render::new(&scene, camera, settings).passes(i * passes..(i + 1) * passes).run();
    (0..count).map(|i| of(i).expect("the scene is good")).collect()
}

/// Mean and skewness of each pixel's green component over the pictures.
fn pixels_of(films: &[Film]) -> Vec<(f64, f64)> {
    let count = films.len() as f64;
    let values: Vec<Vec<f64>> = films.iter().map(|film| film.means().map(|mean| mean.g).collect()).collect();
    let moments = |i: usize| {
        let mean = values.iter().map(|film| film[i]).sum::<f64>() / count;
        let central = |power| values.iter().map(|film| (film[i] - mean).powi(power)).sum::<f64>() / count;
        (mean, central(3) / central(2).powf(1.5))
    };
    (0..values[0].len()).map(moments).collect()
}

/// The share of intervals that contain the truth, for each fifth of the pixels in order of skewness. The mean
/// of all films serves as the truth; the margins are reduced by each film's own part in it.
fn coverage_by_fifths(films: &[Film], pixels: &[(f64, f64)]) -> [f64; 5] {
    let mut order: Vec<usize> = (0..pixels.len()).filter(|&i| pixels[i].1.is_finite()).collect();
    order.sort_by(|&i, &j| pixels[i].1.total_cmp(&pixels[j].1));
    let own_share = (1.0 - 1.0 / films.len() as f64).sqrt();
    let holds: Vec<Vec<bool>> = films
        .iter()
        .map(|film| {
            let estimates = film.means().zip(film.margins_95()).zip(pixels);
            estimates
                .map(|((mean, margin), &(truth, _))| (mean.g - truth).abs() <= own_share * margin.g)
                .collect()
        })
        .collect();
    std::array::from_fn(|fifth| {
        let part = &order[fifth * order.len() / 5..(fifth + 1) * order.len() / 5];
        let held: usize = holds.iter().map(|film| part.iter().filter(|&&i| film[i]).count()).sum();
        held as f64 / (part.len() * films.len()) as f64
    })
}

/// Asserts that `share` is from 93 to 97 %, within the statistical tolerance for `count` independent intervals.
fn assert_near_95(share: f64, count: usize, what: &str) {
    let tolerance = Z_LIMIT * (0.95 * 0.05 / count as f64).sqrt();
    println!("{what}: {:.1} %, tolerance {:.1} %", 100.0 * share, 100.0 * tolerance);
    assert!((0.93 - tolerance..=0.97 + tolerance).contains(&share), "{what}: {share} +- {tolerance}");
}

fn assert_coverage(what: &str, scene: &(Model, PinholeCamera), sampler: Sampler) {
    let mut settings = Settings::new(SIDE, SIDE, 48 * 4 * 16);
    (settings.sampler, settings.path_reuse) = (sampler, PathReuse::Off);
    let four = pictures(scene, &settings, 4, 48);
    let sixteen: Vec<Film> = four
        .chunks(4)
        .map(|parts| {
            let mut whole = parts[0].clone();
            parts[1..].iter().for_each(|part| whole.merge(part.clone()).expect("they are disjoint"));
            whole.film
        })
        .collect();
    let four: Vec<Film> = four.into_iter().map(|picture| picture.film).collect();
    let pixels = pixels_of(&four);
    for films in [four, sixteen] {
        let shares = coverage_by_fifths(&films, &pixels);
        let count = films.len() * (SIDE * SIDE / 5) as usize;
        for (fifth, share) in (1..).zip(shares) {
            let what = format!("{what}, {} samples, fifth {fifth}", films[0].samples());
            assert_near_95(share, count, &what);
        }
    }
}

#[test]
fn intervals_on_a_checkered_floor_contain_the_truth_in_every_fifth_by_skewness() {
    assert_coverage("checkered floor", &checkered_floor(), Sampler::Sobol);
}

#[test]
fn intervals_among_small_mirrors_contain_the_truth_in_every_fifth_by_skewness() {
    assert_coverage("small mirrors", &small_mirrors(), Sampler::Independent);
}

/// Most pixels have no sample on a sliver, if lights are not supersampled. Their margins are not zero.
#[test]
fn margins_include_lights_that_all_samples_missed() {
    for (covered, sampler) in
        [1e-3, 1.0 / 300.0].into_iter().flat_map(|c| [Sampler::Sobol, Sampler::Independent].map(|s| (c, s)))
    {
        let mut settings = Settings::new(SIDE, SIDE, 16 * 64);
        (settings.sampler, settings.path_reuse) = (sampler, PathReuse::Off);
        settings.supersampling = Supersampling::Off;
        let (mut count, mut held, mut unseen) = (0, 0, 0);
        for picture in pictures(&slivers(covered), &settings, 4, 16) {
            for (i, (mean, margin)) in
                (0..SIDE).cycle().zip(picture.film.means().zip(picture.film.margins_95()))
            {
                if i / 4 % 2 == 0 {
                    count += 1;
                    unseen += usize::from(mean.g == 0.0);
                    held += usize::from((mean.g - covered).abs() <= margin.g);
                }
                assert!(margin.g > 0.0, "a pixel without variance has a zero margin");
            }
        }
        let (share, unseen) = (held as f64 / count as f64, unseen as f64 / count as f64);
        println!("{covered}, {sampler:?}: {share:.4}, {unseen:.3} of them without a hit");
        assert!(unseen > 0.75 && share > 0.95, "{covered}, {sampler:?}: {share}, {unseen} without a hit");
    }
}

/// Pictures of a room with few samples, which do not show its light. An ideal interval, known from the spread
/// of the estimates, would be 3.92 standard deviations wide.
#[test]
fn the_interval_of_a_pictures_error_contains_it_and_is_narrow() {
    const PICTURES: u32 = 400;
    let model = cornell::with_blocks(false).expect("the box is good");
    let scene = scenes::scene(&model, RENDERED[0].1);
    let camera = look(DVec3::new(0.0, 0.2, 3.0), DVec3::new(0.0, -0.4, 0.0), 0.6);
    // Independent pixels, some independent tiles, and a single one.
    for (path_reuse, side) in [(PathReuse::Off, 16), (PathReuse::Tiles, 48), (PathReuse::Tiles, 16)] {
        let mut settings = Settings::new(side, side, 8);
        (settings.pass_samples, settings.path_reuse) = (1, path_reuse);
        let estimates = (0..PICTURES).map(|seed| {
            settings.seed = seed.into();
            let film = render(&scene, &camera, &settings).expect("the scene is good").film;
            let (error, mean) = (film.error(), film.image_mean().mean());
            // In radiance, independent of the error of the picture's mean.
            (error.relative_rmse * mean, error.interval_95.map(|end| end * mean))
        });
        let estimates: Vec<(f64, [f64; 2])> = estimates.collect();
        let count = f64::from(PICTURES);
        let truth = (estimates.iter().map(|(error, _)| error * error).sum::<f64>() / count).sqrt();
        let log_of = |(error, _): &(f64, _)| (error / truth).ln();
        let mean = estimates.iter().map(log_of).sum::<f64>() / count;
        let spread = (estimates.iter().map(|e| (log_of(e) - mean).powi(2)).sum::<f64>() / count).sqrt();
        let mut widths: Vec<f64> = estimates.iter().map(|(_, [low, high])| (high / low).ln()).collect();
        widths.sort_by(f64::total_cmp);
        let width = widths[widths.len() / 2] / (3.92 * spread);
        let share = estimates.iter().filter(|(_, [low, high])| (*low..=*high).contains(&truth)).count()
            as f64
            / count;
        println!("{path_reuse:?}, {side}: median width {width:.2}");
        assert_near_95(share, estimates.len(), &format!("{path_reuse:?}, {side}"));
        // One tile has one degree of freedom, for which Student's interval is 6.48 times as wide.
        let most = if (path_reuse, side) == (PathReuse::Tiles, 16) { 1.5 * 6.48 } else { 1.3 };
        assert!((0.8..most).contains(&width), "{path_reuse:?}, {side}: {width}");
    }
}
