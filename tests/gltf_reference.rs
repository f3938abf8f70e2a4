//! Loads and renders the reference scenes from glTF files, and compares them with pictures by an independent
//! renderer (Mitsuba 3.9.1).

#![allow(clippy::print_stderr, reason = "reports skipped tests")]

use globillum::integrator::{Settings, render};
use globillum::io::{Loaded, load};
use globillum::material::{Bsdf, Reflectance, Rgb};
use globillum_testkit::accelerators::RENDERED;
use globillum_testkit::reference::{MEAN_LIMIT, Reference};
use globillum_testkit::stats::Z_LIMIT;
use globillum_testkit::{cornell, scenes};
use std::path::{Path, PathBuf};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference").join(name)
}

/// The scene and its reference, if the files exist.
fn reference(name: &str) -> Option<(Loaded, Reference)> {
    let (scene, blocks) = (file(&format!("{name}.glb")), file(&format!("{name}.json")));
    if !scene.exists() || !blocks.exists() {
        eprintln!("SKIPPED: {name}.glb does not exist, so nothing was compared");
        return None;
    }
    let blocks = std::fs::read_to_string(blocks).expect("the reference can be read");
    Some((load(&scene).expect("the scene is good"), Reference::parse(&blocks)))
}

/// Compares the picture with all bounces and that with direct illumination only, with `samples` per pixel.
fn check(name: &str, samples: [u32; 2]) {
    let Some((loaded, reference)) = reference(name) else { return };
    assert_eq!(loaded.report.warnings, []);
    let scene = scenes::scene(&loaded.model, RENDERED[0].1);
    for (max_bounces, samples) in [None, Some(1)].into_iter().zip(samples) {
        let mut settings = Settings::new(reference.resolution, reference.resolution, samples);
        settings.max_bounces = max_bounces;
        let film = render(&scene, &loaded.cameras[0], &settings).expect("the scene is good").film;
        let blocks = if max_bounces.is_some() { &reference.direct } else { &reference.path };
        let deviation = reference.deviation(&film, blocks);
        assert!(deviation.image_mean < MEAN_LIMIT, "{name}, bounces {max_bounces:?}: {deviation:?}");
        assert!(deviation.largest_z < Z_LIMIT, "{name}, bounces {max_bounces:?}: {deviation:?}");
    }
}

#[test]
fn the_box() {
    check("box", [512, 512]);
}

#[test]
fn the_box_with_a_mirror() {
    check("box_mirror", [512, 512]);
}

#[test]
fn the_box_with_a_scanned_mesh() {
    check("box_bunny", [512, 512]);
}

/// The same with numbers of a file, which are read as `f32`.
fn rounded(bsdf: Bsdf) -> Bsdf {
    let round = |reflectance: Reflectance| {
        let rgb = reflectance.rgb().to_array().map(|x| f64::from(x as f32));
        Reflectance::new(Rgb::from(rgb)).expect("it stays in range")
    };
    match bsdf {
        Bsdf::Lambert(albedo) => Bsdf::Lambert(round(albedo)),
        Bsdf::Mirror(reflectance) => Bsdf::Mirror(round(reflectance)),
        other => other,
    }
}

#[test]
fn the_files_contain_the_scenes_that_the_code_builds() {
    for (name, specular) in [("box", false), ("box_mirror", true)] {
        let Some((loaded, _)) = reference(name) else { continue };
        let model = cornell::with_blocks(specular).expect("the box is good");
        assert_eq!(loaded.model.triangles().len(), model.triangles().len());
        for (index, expected) in model.triangles().iter().enumerate() {
            let found = &loaded.model.triangles()[index];
            for (a, b) in found.vertices.iter().zip(expected.vertices) {
                assert!(a.distance(b) < 1e-6, "{name}, triangle {index}: {found:?} {expected:?}");
            }
            let expected = rounded(model.material(index).bsdf);
            assert_eq!(loaded.model.material(index).bsdf, expected, "{name}, {index}");
        }
        let (found, expected) = (loaded.cameras[0], cornell::camera().expect("it is good"));
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.3, 0.7)] {
            let [found, expected] = [found, expected].map(|camera| camera.ray(x, y, 1.0));
            // The translation of a node is read as `f32`.
            assert!(found.origin.distance(expected.origin) < 1e-6, "{name}: {found:?} {expected:?}");
            assert!(found.direction.distance(expected.direction) < 1e-7, "{name}: {found:?} {expected:?}");
        }
    }
}
