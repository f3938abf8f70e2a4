//! `globillum render` of files that Blender wrote (`crates/io/tests/blender`).

use crate::RENDER;
use globillum::integrator::Estimates;
use globillum::io::PictureData;
use globillum::material::Rgb;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::PathBuf;

/// A picture of a file: its pixels and its figures.
struct Shot {
    pixels: Estimates,
    stats: Value,
    warnings: String,
}

impl Shot {
    fn of(file: &str, flags: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path: PathBuf = [env!("CARGO_MANIFEST_DIR"), "../io/tests/blender", file].iter().collect();
        let path = path.to_str().expect("a plain name");
        let out = ["--out", "a.exr", "--stats", "a.json"];
        let output = RENDER.run(folder.path(), &[&[path], &out[..], flags].concat());
        let warnings = String::from_utf8(output.stderr).expect("plain text");
        assert!(output.status.success(), "{warnings}");
        let stats = std::fs::read(folder.path().join("a.json")).expect("it was written");
        let pixels = PictureData::read(folder.path().join("a.exr")).expect("a picture").estimates;
        Self { pixels, stats: serde_json::from_slice(&stats).expect("it is JSON"), warnings }
    }
}

#[test]
fn the_startup_scene_shows_its_lit_cube_through_its_camera() {
    let shot = Shot::of("startup.glb", &["--width", "96", "--height", "54", "--spp", "16"]);
    assert_eq!((&shot.stats["lights"], &shot.stats["delta_lights"]), (&json!(0), &json!(1)));
    assert_eq!(
        (&shot.stats["camera_by"], &shot.stats["environment"]),
        (&json!("scene"), &json!([0.0, 0.0, 0.0]))
    );
    assert_eq!(shot.stats["bounds"], json!([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]));
    // Blender's point light of 1000 W is at (4.076, 1.005, 5.904), z up; the albedo is 0.8. The corner of the top
    // that is nearest to it gets most.
    let (to, intensity) = ([4.0762453_f64 - 1.0, 1.0054539 - 1.0, 5.903862 - 1.0], 1000.0 / (4.0 * PI));
    let distance_sq: f64 = to.iter().map(|x| x * x).sum();
    let expected = 0.8 / PI * intensity * to[2] / distance_sq.powf(1.5);
    let brightest = shot.pixels.means.iter().map(|mean| mean.r).fold(0.0, f64::max);
    assert!((0.95..1.0).contains(&(brightest / expected)), "{brightest}, {expected}");
    assert_eq!(shot.pixels.means[0], Rgb::BLACK);
    let lit = shot.pixels.means.iter().filter(|mean| mean.r > 0.0).count();
    assert!((200..2000).contains(&lit), "{lit} pixels show the cube");
}

#[test]
fn another_shape_than_the_cameras_is_warned_of() {
    let warnings = |width, flags: &[&str]| {
        let size = ["--width", width, "--height", "18", "--spp", "1"];
        Shot::of("startup.glb", &[&size[..], flags].concat()).warnings
    };
    let said = "the file's camera is meant for a picture 1.778 times as wide as high, such as --width 32 --height 18; \
                18 x 18 pixels keep its vertical field of view";
    assert!(warnings("18", &[]).contains(said), "{}", warnings("18", &[]));
    for quiet in [warnings("32", &[]), warnings("18", &["--camera", "9,9,9/0,0,0"])] {
        assert!(!quiet.contains("is meant for"), "{quiet}");
    }
}

#[test]
fn lumens_per_watt_divide_delta_lights() {
    let mean = |flags: &[&str]| {
        let size = ["--width", "32", "--height", "18", "--spp", "4"];
        Shot::of("startup.glb", &[&size[..], flags].concat()).stats["image_mean"][0]
            .as_f64()
            .expect("a number")
    };
    assert_eq!(mean(&["--lumens-per-watt", "341.5"]), 2.0 * mean(&[]));
    RENDER.assert_refused(
        |_| (),
        &["a.glb", "--lumens-per-watt", "0"],
        &["--lumens-per-watt 0: must be a number above 0"],
    );
}

#[test]
fn a_room_is_rendered_as_its_twin_without_textures() {
    let flags = ["--width", "48", "--height", "36", "--spp", "4"];
    for (room, plain) in
        [("room.glb", "room_plain.glb"), ("room.obj", "room_plain.obj"), ("room_pbr.obj", "room_plain.obj")]
    {
        let shots = [room, plain].map(|file| Shot::of(file, &flags));
        assert!(shots[0].pixels == shots[1].pixels, "{room}");
        assert!(shots[0].stats["image_mean"][0].as_f64().is_some_and(|mean| mean > 0.05), "{room}");
    }
}

/// The room has a window, and its OBJ file no camera.
#[test]
fn a_room_without_a_camera_is_seen_from_inside() {
    let shot = Shot::of("room.obj", &["--width", "48", "--height", "36", "--spp", "1"]);
    assert_eq!(shot.stats["camera_by"], "inside");
    let shot = Shot::of("bust.obj", &["--width", "48", "--height", "36", "--spp", "1", "--up", "z"]);
    assert_eq!(
        (&shot.stats["camera_by"], &shot.stats["environment"]),
        (&json!("outside"), &json!([1.0, 1.0, 1.0]))
    );
}
