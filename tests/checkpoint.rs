//! Checkpoints: saving, resuming and merging parts of a picture.

use glam::{DVec3, Vec3};
use globillum::geom::{Accel, Triangle};
use globillum::integrator::{
    CheckpointError, CheckpointReader, CheckpointWriter, DeltaLight, Ending, ErrorEstimate, Estimator,
    Guiding, LightSampling, Merge, MergeError, MirrorSampling, Model, Monitor, PathReuse, Picture,
    PinholeCamera, PixelFilter, Render, RenderError, Sampler, Scene, Settings, Supersampling, render,
};
use globillum::material::{Bsdf, Emission, Material, Reflectance, Rgb, Sides};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::{cornell, scenes};
use std::ops::Range;
use std::slice::from_ref;
use std::sync::atomic::{AtomicU32, Ordering};

const SAMPLERS: [Sampler; 2] = [Sampler::Independent, Sampler::Sobol];

fn the_box() -> (Scene<Box<dyn Accel>>, PinholeCamera) {
    let model = cornell::with_blocks(false).expect("the box is good");
    (scenes::scene(&model, RENDERED[0].1), cornell::camera().expect("the camera is good"))
}

/// 64 passes; the last one is incomplete.
fn settings(sampler: Sampler) -> Settings {
    let mut settings = Settings::new(24, 20, 127);
    (settings.pass_samples, settings.sampler, settings.seed) = (2, sampler, 5);
    settings
}

fn changed(mut settings: Settings, change: impl FnOnce(&mut Settings)) -> Settings {
    change(&mut settings);
    settings
}

fn passes(range: Range<u32>, settings: &Settings) -> Picture {
    let (scene, camera) = the_box();
    Render::new(&scene, &camera, settings).passes(range).run().expect("the scene is good")
}

/// Cancels after some passes.
struct After(u32, AtomicU32);

impl Monitor for After {
    fn pass_done(&self, picture: &Picture) {
        assert_eq!(picture.ending, Ending::Open);
        self.1.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.1.load(Ordering::Relaxed) >= self.0
    }
}

fn through_bytes(picture: &Picture) -> Picture {
    Picture::from_bytes(&picture.to_bytes()).expect("it was just written")
}

#[test]
fn one_run_any_threads_two_halves_and_four_ranges_are_the_same_bytes() {
    let (scene, camera) = the_box();
    for sampler in SAMPLERS {
        let mut settings = settings(sampler);
        let whole = render(&scene, &camera, &settings).expect("the scene is good");
        assert_eq!((whole.samples, whole.ending), (127, Ending::Samples));
        let bytes = whole.to_bytes();
        for threads in [1, 2, 3, 7] {
            settings.threads = threads;
            assert_eq!(render(&scene, &camera, &settings).expect("likewise").to_bytes(), bytes, "{threads}");
        }

        let stopped =
            Render::new(&scene, &camera, &settings).monitor(&After(31, 0.into())).run().expect("likewise");
        assert_eq!((stopped.samples, stopped.ending), (62, Ending::Cancelled));
        let resumed = Render::new(&scene, &camera, &settings).resume(through_bytes(&stopped)).run();
        assert_eq!(resumed.expect("it is the same picture").to_bytes(), bytes);

        let parts = [0..8, 8..21, 21..63, 63..64].map(|range| passes(range, &settings));
        for order in [[0, 1, 2, 3], [3, 2, 1, 0], [2, 0, 3, 1]] {
            let mut parts = order.map(|i| through_bytes(&parts[i])).into_iter();
            let mut merged = parts.next().expect("there are four");
            parts.for_each(|part| merged.merge(part).expect("they are disjoint"));
            assert_eq!(merged.to_bytes(), bytes, "{order:?}");
        }
    }
}

#[test]
fn every_accelerator_makes_the_same_checkpoint() {
    let (model, camera) = (cornell::with_blocks(false).expect("the box is good"), the_box().1);
    let bytes = RENDERED.map(|(_, build)| {
        let scene = scenes::scene(&model, build);
        render(&scene, &camera, &settings(Sampler::Sobol)).expect("the scene is good").to_bytes()
    });
    assert!(bytes.iter().all(|b| *b == bytes[0]));
}

#[test]
fn a_render_can_be_resumed_with_more_samples() {
    let (scene, camera) = the_box();
    let with = |samples| changed(settings(Sampler::Sobol), |s| s.samples = samples);
    let whole = render(&scene, &camera, &with(40)).expect("the scene is good");
    let part = render(&scene, &camera, &with(24)).expect("likewise");
    let more = Render::new(&scene, &camera, &with(40)).resume(part.clone()).run().expect("likewise");
    assert_eq!(more.to_bytes(), whole.to_bytes());
    // An incomplete pass cannot be completed, and samples cannot be removed.
    let short = render(&scene, &camera, &with(23)).expect("likewise");
    let refusals = [(40, short, CheckpointError::CutShort), (20, part, CheckpointError::TooManySamples)];
    for (samples, picture, error) in refusals {
        let result = Render::new(&scene, &camera, &with(samples)).resume(picture).run();
        assert_eq!(result.expect_err("it does not fit"), RenderError::Checkpoint(error));
    }
}

/// The box with another vertex, another albedo, another radiance, and a light on both sides.
fn nearly_the_box() -> [Model; 4] {
    let model = cornell::with_blocks(false).expect("the box is good");
    let light = (0..).find(|&index| !model.material(index).emission.is_black()).expect("there is a light");
    let with = |change: &dyn Fn(usize, &mut Triangle, &mut Material)| {
        let mut changed = Model::default();
        for (index, triangle) in model.triangles().iter().enumerate() {
            let (mut triangle, mut material) = (*triangle, *model.material(index));
            change(index, &mut triangle, &mut material);
            changed.add(material, [triangle]);
        }
        changed
    };
    let radiance = model.material(light).emission.radiance();
    let emitting = |material: &mut Material, radiance, sides| {
        material.emission = Emission::new(radiance, sides).expect("in range");
    };
    [
        with(&|index, triangle, _| {
            if index == 7 {
                triangle.vertices[2].x = triangle.vertices[2].x.next_up();
            }
        }),
        with(&|index, _, material| {
            if index == 7 {
                let Bsdf::Lambert(albedo) = material.bsdf else { panic!("it is diffuse") };
                let Rgb { r, g, b } = albedo.rgb();
                material.bsdf =
                    Bsdf::Lambert(Reflectance::new(Rgb::new(r, g.next_up(), b)).expect("below one"));
            }
        }),
        with(&|index, _, material| {
            if index == light {
                emitting(material, Rgb::new(radiance.r, radiance.g.next_up(), radiance.b), Sides::Front);
            }
        }),
        with(&|index, _, material| {
            if index == light {
                emitting(material, radiance, Sides::Both);
            }
        }),
    ]
}

#[test]
fn another_picture_is_refused() {
    let (scene, camera) = the_box();
    let base = settings(Sampler::Sobol);
    let picture = passes(0..2, &base);
    type Change = fn(&mut Settings);
    let changes: [Change; 15] = [
        |s| s.seed += 1,
        |s| s.pass_samples = 4,
        |s| s.sampler = Sampler::Independent,
        |s| s.filter = PixelFilter::Tent,
        |s| s.estimator = Estimator::Light,
        |s| s.max_bounces = Some(1),
        |s| s.roulette.start += 1,
        |s| s.path_reuse = PathReuse::Off,
        |s| s.guiding = Guiding::Trained,
        |s| s.roulette.threshold = 0.5,
        |s| s.light_sampling = LightSampling::Area,
        |s| s.mirror_sampling = MirrorSampling::Off,
        |s| s.supersampling = Supersampling::Off,
        |s| s.light_samples = 2,
        |s| (s.width, s.height) = (s.height, s.width),
    ];
    let refused = |result: Result<Picture, RenderError>| {
        let mismatch = CheckpointError::Mismatch("scene, camera, settings or build");
        assert_eq!(result.expect_err("it is another picture"), RenderError::Checkpoint(mismatch));
    };
    for change in changes {
        let mut other = base;
        change(&mut other);
        refused(Render::new(&scene, &camera, &other).resume(picture.clone()).run());
    }
    let nearly = PinholeCamera::look_at(DVec3::new(0.0, 0.0, 3.9_f64.next_up()), DVec3::ZERO, DVec3::Y, 0.7);
    refused(Render::new(&scene, &nearly.expect("it is good"), &base).resume(picture.clone()).run());
    let mirror = cornell::with_blocks(true).expect("the box is good");
    let mirror = scenes::scene(&mirror, RENDERED[0].1);
    refused(Render::new(&mirror, &camera, &base).resume(picture.clone()).run());
    for other in nearly_the_box() {
        let other = scenes::scene(&other, RENDERED[0].1);
        refused(Render::new(&other, &camera, &base).resume(picture.clone()).run());
    }
    let with_light = |intensity: f64| {
        let mut model = cornell::with_blocks(false).expect("the box is good");
        model.add_delta_light(DeltaLight::point(Vec3::ZERO, Rgb::splat(intensity)).expect("in range"));
        scenes::scene(&model, RENDERED[0].1)
    };
    refused(Render::new(&with_light(1.0), &camera, &base).resume(picture.clone()).run());
    let lit = Render::new(&with_light(1.0), &camera, &base).passes(0..2).run().expect("the scene is good");
    refused(Render::new(&with_light(1.0_f64.next_up()), &camera, &base).resume(lit).run());
    let model = cornell::with_blocks(false).expect("the box is good");
    let under_a_sky = scenes::scene_under(Rgb::splat(1e-9), &model, RENDERED[0].1);
    refused(Render::new(&under_a_sky, &camera, &base).resume(picture).run());
}

#[test]
fn passes_count_once() {
    let base = settings(Sampler::Sobol);
    let mut picture = passes(3..7, &base);
    let before = picture.to_bytes();
    assert_eq!(picture.merge(passes(6..9, &base)), Err(CheckpointError::Overlap { pass: 6 }));
    let other = changed(base, |s| s.seed = 9);
    assert!(matches!(picture.merge(passes(9..10, &other)), Err(CheckpointError::Mismatch(_))));
    assert_eq!(picture.to_bytes(), before);
    // An incomplete pass in the middle: no run produces it.
    let cut = passes(0..2, &changed(base, |s| s.samples = 3));
    for (mut a, b) in [(cut.clone(), passes(2..3, &base)), (passes(2..3, &base), cut)] {
        assert_eq!(a.merge(b), Err(CheckpointError::CutShort));
    }
    for invalid in [5..5, 0..65] {
        let (scene, camera) = the_box();
        let result = Render::new(&scene, &camera, &base).passes(invalid).run();
        assert!(matches!(result, Err(RenderError::Range { name: "passes", step: 1, .. })));
    }
}

#[test]
fn damaged_and_incomplete_checkpoints_are_refused() {
    let small = changed(settings(Sampler::Sobol), |s| (s.width, s.height) = (3, 2));
    let bytes = passes(0..3, &small).to_bytes();
    assert!(Picture::from_bytes(&bytes).is_ok());
    for length in 0..bytes.len() {
        assert!(Picture::from_bytes(&bytes[..length]).is_err(), "cut to {length} bytes");
    }
    for bit in 0..8 * bytes.len() {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        assert!(Picture::from_bytes(&damaged).is_err(), "bit {bit}");
    }
    assert!(Picture::from_bytes(&[&bytes[..], &[0]].concat()).is_err());
    assert_eq!(Picture::from_bytes(b"\x89PNG and so on"), Err(CheckpointError::NoCheckpoint));
    let mut newer = bytes;
    newer[8] += 1;
    assert_eq!(Picture::from_bytes(&newer), Err(CheckpointError::Version(6)));
}

/// Merges checkpoints as streams.
fn merged(checkpoints: &[&[u8]]) -> Result<(Vec<u8>, ErrorEstimate), MergeError> {
    let readers = checkpoints.iter().map(|&bytes| CheckpointReader::new(bytes).expect("it is a checkpoint"));
    let merge = Merge::new(readers.collect())?;
    let mut writer = CheckpointWriter::new(Vec::new(), merge.header()).expect("a vector takes all");
    let error = merge.run(|rows| writer.write(rows))?;
    Ok((writer.finish().expect("a vector takes all"), error))
}

/// The checkpoints of `passes` of `rows`, for each of both.
fn parts(settings: &Settings, strips: &[Range<u32>], ranges: &[Range<u32>]) -> Vec<Vec<u8>> {
    let (scene, camera) = the_box();
    let all = strips.iter().flat_map(|rows| ranges.iter().map(move |passes| (rows.clone(), passes.clone())));
    let render = |(rows, passes)| Render::new(&scene, &camera, settings).rows(rows).passes(passes).run();
    all.map(|part| render(part).expect("the scene is good").to_bytes()).collect()
}

fn as_slices(checkpoints: &[Vec<u8>]) -> Vec<&[u8]> {
    checkpoints.iter().map(Vec::as_slice).collect()
}

/// Not the settings' height, so that the last row of tiles is cut and strips can differ.
fn three_tiles(sampler: Sampler) -> Settings {
    changed(settings(sampler), |s| (s.width, s.height, s.samples) = (19, 41, 31))
}

/// In any order, and in a tree of any fan-in, passes and strips give the bytes of one run.
#[test]
fn streams_merge_to_the_bytes_of_one_run() {
    for (sampler, path_reuse) in [(Sampler::Sobol, PathReuse::Tiles), (Sampler::Independent, PathReuse::Off)]
    {
        let settings = changed(three_tiles(sampler), |s| s.path_reuse = path_reuse);
        let (scene, camera) = the_box();
        let whole = render(&scene, &camera, &settings).expect("the scene is good");
        let ranges = [0..1, 1..4, 4..8, 8..13, 13..16];
        for strips in [from_ref(&(0..41)), &[0..16, 16..41], &[0..16, 16..32, 32..41]] {
            let parts = parts(&settings, strips, &ranges);
            // None has a factor in common with 5, 10 or 15: each visits every part once.
            for step in [1, 7, 11, 13] {
                let order = |i: usize| &parts[(3 + step * i) % parts.len()][..];
                let shuffled: Vec<&[u8]> = (0..parts.len()).map(order).collect();
                let flat = merged(&shuffled).expect("they are parts of one picture");
                assert!(flat == (whole.to_bytes(), whole.film.error()), "{strips:?}, {step}");
                for fan_in in [2, 3, 5] {
                    let groups: Vec<Vec<u8>> =
                        shuffled.chunks(fan_in).map(|group| merged(group).expect("likewise").0).collect();
                    let tree = merged(&as_slices(&groups)).expect("likewise");
                    assert!(tree == flat, "{strips:?}, {step}, {fan_in}");
                }
            }
        }
    }
}

/// The oracle: the whole pictures in memory, with passes missing too.
#[test]
fn streams_merge_as_pictures_do() {
    let settings = three_tiles(Sampler::Sobol);
    let parts = parts(&settings, from_ref(&(0..41)), &[1..2, 3..4, 5..7, 9..10, 10..12, 12..16]);
    for chosen in 1..1 << parts.len() {
        let parts: Vec<&[u8]> =
            (0..parts.len()).filter(|i| chosen >> i & 1 == 1).map(|i| &parts[i][..]).collect();
        let mut pictures = parts.iter().map(|bytes| Picture::from_bytes(bytes).expect("it was just written"));
        let mut expected = pictures.next().expect("one at least");
        pictures.for_each(|picture| expected.merge(picture).expect("they are disjoint"));
        assert!(merged(&parts) == Ok((expected.to_bytes(), expected.film.error())), "{chosen:b}");
    }
}

/// Rows with different passes are a preview: they merge further, and the error is that of all pixels.
#[test]
fn an_incomplete_merge_can_be_completed() {
    let settings = three_tiles(Sampler::Sobol);
    let parts = parts(&settings, &[0..16, 16..41], &[0..8, 8..16]);
    let (incomplete, error) =
        merged(&[&parts[3], &parts[0], &parts[1]]).expect("they are parts of one picture");
    assert!(error.relative_rmse.is_finite() && error.interval_95 == [0.0, f64::INFINITY], "{error:?}");
    assert_eq!(Picture::from_bytes(&incomplete), Err(CheckpointError::Uneven));
    let reader = CheckpointReader::new(&incomplete[..]).expect("it was just written");
    let strips: Vec<_> =
        reader.header().strips.iter().map(|strip| (strip.rows(), strip.passes(), strip.samples())).collect();
    let [all, late] = [0..16, 8..16].map(|passes: Range<u32>| from_ref(&passes).to_vec());
    assert_eq!(strips, [(0..16, all, 31), (16..41, late, 15)]);
    assert_eq!(reader.header().file_length(), incomplete.len() as u64);
    let sums = CheckpointReader::new(std::io::Cursor::new(&incomplete)).expect("likewise").into_sums();
    assert_eq!(sums.expect("likewise").relative_rmse(), error.relative_rmse);
    let whole = merged(&as_slices(&parts)).expect("likewise");
    assert_eq!(merged(&[&incomplete, &parts[2]]), Ok(whole));
}

#[test]
fn equal_checkpoints_count_once_and_others_not() {
    let settings = three_tiles(Sampler::Sobol);
    let parts = parts(&settings, &[0..16, 16..41], &[0..2, 2..4]);
    let twice = [as_slices(&parts), as_slices(&parts[1..3])].concat();
    assert_eq!(merged(&twice), merged(&as_slices(&parts)));
    // Equal headers, other pixels.
    let mut other = Picture::from_bytes(&parts[2]).expect("it was just written");
    let seeded = changed(settings, |s| s.seed = 9);
    let (scene, camera) = the_box();
    let render = |settings: &Settings| {
        let render = Render::new(&scene, &camera, settings).rows(16..41).passes(0..2);
        render.run().expect("the scene is good")
    };
    let foreign = render(&seeded);
    let mismatch = CheckpointError::Mismatch("scene, camera, settings or build");
    let result = merged(&[&parts[0], &foreign.to_bytes()]);
    assert_eq!(result, Err(MergeError::Input { index: 1, error: mismatch }));
    (other.film, other.counters) = (foreign.film, render(&settings).counters);
    let result = merged(&[&parts[0], &parts[2], &other.to_bytes()]);
    assert_eq!(result, Err(MergeError::Overlap { indices: [1, 2], pass: 0, row: 16 }));
    let overlapping = passes(1..3, &settings).to_bytes();
    let result = merged(&[&parts[3], &overlapping]);
    assert_eq!(result, Err(MergeError::Overlap { indices: [0, 1], pass: 2, row: 16 }));
    assert_eq!(merged(&[]), Err(MergeError::Empty));
    // A pass cut short, with one after it in another strip.
    let cut = changed(settings, |s| s.samples = 3);
    let cut = Render::new(&scene, &camera, &cut).rows(0..16).passes(0..2).run().expect("it is good");
    let result = merged(&[&parts[3], &cut.to_bytes()]);
    assert_eq!(result, Err(MergeError::Input { index: 1, error: CheckpointError::CutShort }));
}

#[test]
fn rows_are_whole_rows_of_tiles() {
    let settings = three_tiles(Sampler::Sobol);
    let (scene, camera) = the_box();
    let run = |rows| Render::new(&scene, &camera, &settings).passes(0..1).rows(rows).run();
    let strip = run(16..41).expect("the scene is good");
    assert_eq!((strip.film.rows(), strip.film.height(), strip.height), (16..41, 25, 41));
    let whole = run(0..41).expect("likewise");
    for (x, y) in [(0, 0), (18, 24), (5, 9)] {
        assert_eq!(strip.film.mean(x, y), whole.film.mean(x, y + 16));
    }
    for rows in [0..0, 16..16, Range { start: 32, end: 16 }, 0..8, 8..16, 0..48, 41..48] {
        assert!(matches!(run(rows), Err(RenderError::Range { name: "rows", .. })));
    }
    let mismatch = RenderError::Checkpoint(CheckpointError::Mismatch("range of rows"));
    let resumed = Render::new(&scene, &camera, &settings).rows(0..16).resume(strip).run();
    assert_eq!(resumed, Err(mismatch));
}

#[test]
fn a_checkpoint_without_passes_continues_the_rows_asked_for() {
    let settings = three_tiles(Sampler::Sobol);
    let (scene, camera) = the_box();
    let strip = || Render::new(&scene, &camera, &settings).passes(0..1).rows(16..32);
    let cancelled = strip().monitor(&After(0, AtomicU32::new(0))).run().expect("the scene is good");
    assert_eq!((cancelled.ending, cancelled.samples), (Ending::Cancelled, 0));
    let resumed = strip().resume(through_bytes(&cancelled)).run().expect("it is the same picture");
    assert_eq!(resumed, strip().run().expect("the scene is good"));
}
