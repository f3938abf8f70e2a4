//! Picture files.
#![cfg(feature = "images")]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]

use exr::meta::attribute::IntegerBounds;
use exr::prelude::{
    Encoding, Image, ImageAttributes, Layer, LayerAttributes, SpecificChannels, Vec2, WritableImage as _,
};
use glam::{DVec3, Vec3};
use globillum_geom::{KdTree, Triangle};
use globillum_integrator::{
    Estimates, Film, FirstHits, Model, PathReuse, Picture, PinholeCamera, Scene, Settings, Supersampling,
    render,
};
use globillum_io::{IoError, PictureData, PictureFile, PictureFormat};
use globillum_material::{Material, Rgb};
use std::fs;
use std::path::Path;

/// The upper half is black. The lower half is a light with red above 1.
fn film() -> Film {
    rendered(&Settings::new(3, 2, 1)).0.film
}

fn rendered(settings: &Settings) -> (Picture, PinholeCamera) {
    let corners = [Vec3::new(-9.0, 0.0, -1.0), Vec3::new(0.0, -99.0, -1.0), Vec3::new(9.0, 0.0, -1.0)];
    let mut model = Model::default();
    model.add(Material::light(Rgb::new(2.0, 0.5, 0.25)).unwrap(), [Triangle { vertices: corners }]);
    let scene = Scene::build(model, KdTree::build).unwrap();
    let camera = PinholeCamera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7).unwrap();
    (render(&scene, &camera, settings).unwrap(), camera)
}

#[test]
fn a_png_is_clamped_and_encoded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.PNG");
    PictureFile::create(&path).unwrap().write(&film()).unwrap();
    let picture = image::open(&path).unwrap();
    assert_eq!(picture.color(), image::ColorType::Rgb8);
    let [black, light] = [[0, 0, 0], [255, 188, 137]];
    assert_eq!(picture.into_rgb8().into_raw(), [black, black, black, light, light, light].concat());
}

#[test]
fn a_png_can_be_brightened_and_an_exr_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let [png, exr] = ["a.png", "a.exr"].map(|name| folder.path().join(name));
    for path in [&png, &exr] {
        PictureFile::create(path).unwrap().exposed(1.0).write(&film()).unwrap();
    }
    assert_eq!(image::open(&png).unwrap().into_rgb8().get_pixel(0, 1).0, [255, 255, 188]);
    assert_eq!(PictureData::read(&exr).unwrap().estimates.means[3], Rgb::new(2.0, 0.5, 0.25));
}

/// Writes `data` to an OpenEXR file and reads it.
fn written_and_read(data: &PictureData) -> (Vec<u8>, PictureData) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    PictureFile::create(&path).unwrap().write_data(data).unwrap();
    (fs::read(&path).unwrap(), PictureData::read(&path).unwrap())
}

/// `f32` is what a file holds.
fn rounded(pixels: &[Rgb]) -> Vec<Rgb> {
    pixels.iter().map(|pixel| pixel.map(|x| f64::from(x as f32))).collect()
}

/// The place of a crop in the whole picture is that of the data window in the display window.
#[test]
fn an_exr_of_a_crop_tells_its_place() {
    let whole = Estimates::unknown(37, 21);
    let (bytes, read) = written_and_read(&PictureData::new(whole.crop(8..30, 5..21)));
    assert_eq!((read.estimates.full_size, read.estimates.origin), ([37, 21], [8, 5]));
    assert_eq!((read.estimates.width, read.estimates.height), (22, 16));
    let meta = exr::meta::MetaData::read_from_buffered(bytes.as_slice(), false).expect("it is a file");
    let header = &meta.headers[0];
    let window = |x: i32, y: i32, size: (usize, usize)| IntegerBounds::new((x, y), size);
    assert_eq!(header.shared_attributes.display_window, window(0, 0, (37, 21)));
    assert_eq!(header.data_window(), window(8, 5, (22, 16)));
    let (_, read) = written_and_read(&PictureData::new(whole));
    assert_eq!((read.estimates.full_size, read.estimates.origin), ([37, 21], [0, 0]));
}

/// Display windows of other programs may begin anywhere, and data windows may exceed them.
#[test]
fn windows_of_other_programs_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let read = |display: IntegerBounds, corner: (i32, i32)| {
        let attributes = LayerAttributes { layer_position: Vec2(corner.0, corner.1), ..Default::default() };
        let channels = SpecificChannels::rgb(|_| (0.1_f32, 0.2_f32, 0.3_f32));
        let layer = Layer::new((4, 3), attributes, Encoding::UNCOMPRESSED, channels);
        Image::new(ImageAttributes::new(display), layer).write().to_file(&path).unwrap();
        let read = PictureData::read(&path).unwrap();
        assert_eq!((read.estimates.width, read.estimates.height), (4, 3));
        (read.estimates.full_size, read.estimates.origin)
    };
    assert_eq!(read(IntegerBounds::new((-20, -20), (40, 30)), (-5, 2)), ([40, 30], [15, 22]));
    assert_eq!(read(IntegerBounds::new((-20, -20), (4, 3)), (-20, -20)), ([4, 3], [0, 0]));
    for corner in [(-1, 0), (38, 0), (0, 28), (100, 100)] {
        assert_eq!(read(IntegerBounds::new((0, 0), (40, 30)), corner), ([4, 3], [0, 0]), "{corner:?}");
    }
}

#[test]
fn an_exr_keeps_means_and_errors_to_the_bit() {
    let mut settings = Settings::new(37, 21, 12);
    (settings.pass_samples, settings.seed, settings.threads) = (1, u64::MAX, 1);
    // Else the edge of the light, which halves a row of pixels, is exact.
    settings.supersampling = Supersampling::Off;
    let (picture, camera) = rendered(&settings);
    let mut data = PictureData::of_render(&picture, &settings, Some(&camera));
    let (bytes, read) = written_and_read(&data);
    let expected = &data.estimates;
    assert!(expected.standard_errors.iter().any(|error| error.r > 0.0), "the edge of the light is noisy");
    assert_eq!(read.estimates.means, rounded(&expected.means));
    assert_eq!(read.estimates.standard_errors, rounded(&expected.standard_errors));
    assert_eq!(
        (&read.estimates.samples, &read.estimates.observations),
        (&vec![12; 37 * 21], &vec![12; 37 * 21])
    );
    assert_eq!((read.estimates.path_reuse, read.camera), (PathReuse::Tiles, data.camera));
    assert_eq!(read.attributes, data.attributes);
    assert_eq!(read.attributes["seed"], "18446744073709551615");
    assert_eq!(read.attributes["passes"], "0..12");
    assert_eq!(read.attributes["key"], format!("{:016x}", picture.key));
    assert_eq!(
        read.attributes["settings"],
        "sampler=sobol filter=box estimator=mis light_sampling=solid-angle light_samples=4 mirror_sampling=images \
         supersampling=off path_reuse=tiles guiding=off \
         max_bounces=none pass_samples=1 roulette_start=2 roulette_threshold=0.2"
    );
    assert_eq!(read.first_hits, None);
    assert!(written_and_read(&read).0 == bytes, "what was read is written with the same bytes");
    for (margin, expected) in read.estimates.margins_95().iter().zip(picture.film.margins_95()) {
        assert!((margin.r - expected.r).abs() <= 1e-6 * expected.r, "{margin} {expected}");
    }
    // The floats of these hits are those of files.
    let mut hits = FirstHits::nothing(37, 21);
    let hit = &mut hits.pixels[50];
    (hit.depth, hit.normal.y, hit.albedo.b, hit.triangle, hit.material) = (2.5, -0.75, 0.5, Some(7), Some(3));
    data.first_hits = Some(hits);
    let (bytes, read) = written_and_read(&data);
    assert_eq!(read.first_hits, data.first_hits);
    assert!(written_and_read(&read).0 == bytes, "first hits too");
}

#[test]
fn an_error_that_is_unknown_is_infinite_and_means_alone_have_no_error() {
    let data = PictureData::of(&film());
    let read = written_and_read(&data).1;
    assert_eq!(read.estimates.standard_errors, [Rgb::splat(f64::INFINITY); 6]);
    assert_eq!((read.estimates.samples[0], read.attributes["samples"].as_str()), (1, "1"));
    let mut means = Estimates::unknown(3, 2);
    means.means.clone_from(&data.estimates.means);
    let data = PictureData::new(means);
    let (bytes, read) = written_and_read(&data);
    assert_eq!(read, data);
    assert!(!bytes.windows(6).any(|name| name == b"stderr"), "there are only R, G and B");
}

#[test]
fn files_that_are_no_such_picture_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let refused = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let message = PictureData::read(&path).unwrap_err().to_string();
        message.strip_prefix(&format!("{}: ", path.display())).unwrap().to_owned()
    };
    let good = written_and_read(&PictureData::of(&film())).0;
    refused(b"");
    refused(b"\x89PNG");
    (0..good.len()).step_by(29).for_each(|length| drop(refused(&good[..length])));
    let with = |change: fn(&mut PictureData)| {
        let mut data = PictureData::of(&film());
        change(&mut data);
        PictureFile::create(&path).unwrap().write_data(&data).unwrap();
        refused(&fs::read(&path).unwrap())
    };
    assert_eq!(with(|data| data.estimates.means[4].g = f64::NAN), "pixel (1, 1) is not finite");
    let message = with(|data| data.estimates.standard_errors[2].b = -1.0);
    assert_eq!(message, "standard error of pixel (2, 0) is negative or NaN");
    // A header of 2^27 pixels with the content of 6.
    let mut huge = good;
    let window = |x: i32, y: i32| [0, 0, x, y].into_iter().flat_map(i32::to_le_bytes).collect::<Vec<u8>>();
    let (small, large) = (window(2, 1), window((1 << 14) - 1, (1 << 13) - 1));
    while let Some(at) = huge.windows(16).position(|bytes| bytes == small) {
        huge[at..at + 16].copy_from_slice(&large);
    }
    let chunks = b"chunkCount\0int\0\x04\0\0\0";
    let at = huge.windows(chunks.len()).position(|bytes| bytes == chunks).unwrap() + chunks.len();
    huge[at..at + 4].copy_from_slice(&512_i32.to_le_bytes()); // of 16 lines each
    assert_eq!(refused(&huge), "has more pixels than it can hold");
    let error = PictureData::read(folder.path().join("none.exr")).unwrap_err();
    assert!(matches!(error, IoError::Read { .. }));
}

#[test]
fn formats_follow_extensions() {
    let of = |name: &str| PictureFormat::of(Path::new(name));
    assert_eq!(of("a.png").unwrap(), PictureFormat::Png);
    assert_eq!(of("b.c/a.EXR").unwrap(), PictureFormat::Exr);
    for name in ["a.jpg", "png", ".png", "a.", ""] {
        assert!(matches!(of(name), Err(IoError::UnknownFormat { .. })), "{name}");
    }
    let message = PictureFile::create(Path::new("a.jpg")).unwrap_err().to_string();
    assert_eq!(message, "a.jpg: unknown picture format; supported formats are .png and .exr");
}

#[test]
fn places_that_cannot_be_written_are_found_before_rendering() {
    let folder = tempfile::tempdir().unwrap();
    let directory = folder.path().join("d.png");
    fs::create_dir(&directory).unwrap();
    for path in [directory, folder.path().join("missing/a.png")] {
        let error = PictureFile::create(&path).unwrap_err();
        assert!(matches!(error, IoError::Write { .. }), "{error}");
        assert!(error.to_string().starts_with(&format!("{}: cannot be written: ", path.display())));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn an_old_picture_stays_until_the_new_one_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::write(&path, "old").unwrap();
    let file = PictureFile::create(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    drop(file);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_write_that_fails_says_so_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let file = PictureFile::create(&path).unwrap();
    // A folder appears at the path while the picture is rendered.
    fs::create_dir(&path).unwrap();
    assert!(matches!(file.write(&film()), Err(IoError::Write { .. })));
    assert!(path.is_dir());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// What is finite and beyond `f32` does not become infinite; what is infinite is unknown.
#[test]
fn an_exr_holds_no_radiance_beyond_its_range() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let write = |change: &dyn Fn(&mut Estimates)| {
        let mut data = PictureData::of(&film());
        let [width, height] = data.estimates.full_size;
        (data.estimates.full_size, data.estimates.origin) = ([width + 10, height + 20], [10, 20]);
        change(&mut data.estimates);
        PictureFile::create(&path).unwrap().write_data(&data).map_err(|error| error.to_string())
    };
    let most = f64::from(f32::MAX);
    let expected = |what: &str| {
        format!("{}: cannot be encoded: {what} exceeds 3.4028235e38, the most of OpenEXR", path.display())
    };
    let refused = write(&|estimates| estimates.full_size = [1, 1]).expect_err("it exceeds its picture");
    assert!(refused.contains("from (10, 20) on exceed 1 x 1"), "{refused}");
    let refused = write(&|estimates| estimates.means[5].g = 1e40);
    assert_eq!(refused, Err(expected("radiance 1e40 of pixel (12, 21)")));
    let refused = write(&|estimates| estimates.standard_errors[1].b = 2.0 * most);
    assert_eq!(refused, Err(expected("standard error 6.805646932770577e38 of pixel (11, 20)")));
    assert!(!path.exists());
    write(&|estimates| {
        estimates.means[0].r = most;
        estimates.standard_errors[0] = Rgb::splat(f64::INFINITY);
    })
    .unwrap();
    assert_eq!(PictureData::read(&path).unwrap().estimates.means[0].r, most);
}

#[cfg(unix)]
#[test]
fn a_picture_is_written_through_to_a_fifo() {
    use std::io::Read;
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.png", "a.exr"] {
        let [fifo, file] = ["fifo", "file"].map(|kind| folder.path().join(kind).join(name));
        for path in [&fifo, &file] {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
        }
        assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
        // A FIFO that is open for reading and writing does not block.
        let mut reader = fs::File::options().read(true).write(true).open(&fifo).unwrap();
        for path in [&fifo, &file] {
            PictureFile::create(path).unwrap().write(&film()).unwrap();
        }
        let expected = fs::read(&file).unwrap();
        assert!(!fs::metadata(&fifo).unwrap().is_file(), "the FIFO has been replaced");
        let mut found = vec![0; expected.len()];
        reader.read_exact(&mut found).unwrap();
        assert_eq!(found, expected, "{name}");
    }
}
