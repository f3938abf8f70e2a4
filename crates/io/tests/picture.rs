//! Picture files.
#![cfg(feature = "images")]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]

use glam::{DVec3, Vec3};
use globillum_geom::{KdOptions, KdTree, Triangle};
use globillum_integrator::{Camera, Film, Model, Scene, Settings, render};
use globillum_io::{IoError, PictureFile, PictureFormat};
use globillum_material::{Material, Rgb};
use std::fs;
use std::path::Path;

/// The upper half is black. The lower half is a light with red above 1.
fn film() -> Film {
    let corners = [Vec3::new(-9.0, 0.0, -1.0), Vec3::new(0.0, -99.0, -1.0), Vec3::new(9.0, 0.0, -1.0)];
    let mut model = Model::default();
    model.add(Material::light(Rgb::new(2.0, 0.5, 0.25)).unwrap(), [Triangle { vertices: corners }]);
    let scene = Scene::build(model, |triangles| KdTree::build(triangles, &KdOptions::default())).unwrap();
    let camera = Camera::look_at(DVec3::ZERO, -DVec3::Z, DVec3::Y, 0.7).unwrap();
    render(&scene, &camera, &Settings::new(3, 2, 1), &()).unwrap().film
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
    assert_eq!(image::open(&exr).unwrap().into_rgb32f().get_pixel(0, 1).0, [2.0, 0.5, 0.25]);
}

#[test]
fn an_exr_keeps_every_float() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    PictureFile::create(&path).unwrap().write(&film()).unwrap();
    let picture = image::open(&path).unwrap();
    assert_eq!(picture.color(), image::ColorType::Rgb32F);
    let [black, light] = [[0.0, 0.0, 0.0], [2.0, 0.5, 0.25]];
    assert_eq!(picture.into_rgb32f().into_raw(), [black, black, black, light, light, light].concat());
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
