//! `globillum render`: what it writes, and what it says if it cannot. Rows are those of the table of bad
//! input in docs/testing.md.

use crate::RENDER;
use globillum::io::PictureData;
use globillum::material::Rgb;
use globillum_testkit::bad_input::{self, Outcome};
use std::path::Path;

/// A light over a floor, seen by nobody yet.
const ROOM: &str = "mtllib room.mtl
v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv -0.2 1 -0.2\nv 0.2 1 -0.2\nv 0.2 1 0.2\nv -0.2 1 0.2
usemtl floor\nf 1 2 3 4\nusemtl light\nf 5 6 7 8\n";
const MATERIALS: &str = "newmtl floor\nKd 0.7 0.6 0.5\nnewmtl light\nKd 0\nKe 10 10 10\n";

fn fill(folder: &Path) {
    std::fs::create_dir(folder.join("folder.png")).expect("an empty folder can be filled");
    for (name, content) in [("room.obj", ROOM), ("room.mtl", MATERIALS)] {
        std::fs::write(folder.join(name), content).expect("likewise");
    }
}

fn assert_refused(arguments: &[&str], words: &[&str]) {
    RENDER.assert_refused(fill, arguments, words);
}

/// What is said of a file in which nothing shines.
fn no_lights(file: &str) -> String {
    format!(
        "{file}: scene has no lights: a white environment of radiance 1 is added (--environment R,G,B sets it; \
         0 is none)"
    )
}

/// What rows 1 to 82 and 97 to 99 must print is in one table with what the loaders must return.
#[test]
fn rows_1_to_82_and_97_to_99_bad_scenes_are_one_line_that_names_file_and_place() {
    // An OpenEXR file needs no exposure.
    let size =
        ["--width", "1", "--height", "1", "--spp", "1", "--threads", "1", "--verbose", "--out", "render.exr"];
    for case in bad_input::cases() {
        let (row, folder) = (case.row, tempfile::tempdir().expect("a temporary folder"));
        if !case.write(folder.path()).expect("an empty folder can be filled") {
            eprintln!("SKIPPED: row {row} needs a pipe or a link, which cannot be made here");
            continue;
        }
        let output = RENDER.run(folder.path(), &[&[case.scene()], &size[..]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        let nothing_shines = no_lights(case.scene());
        let (code, lines) = match case.outcome {
            Outcome::Refused { message, .. } => (1, vec![format!("error: {message}")]),
            Outcome::Loaded { warnings } => {
                // Row 98 has a delta light.
                let all = warnings.into_iter().chain((row != 98).then_some(nothing_shines));
                (0, all.map(|warning| format!("warning: {warning}")).collect())
            }
        };
        assert_eq!(output.status.code(), Some(code), "row {row}: {said}");
        assert_eq!(said.lines().collect::<Vec<_>>(), lines, "row {row}");
        assert_eq!(folder.path().join("render.exr").exists(), code == 0, "row {row}");
    }
}

#[test]
fn scenes_that_are_not_there_and_of_other_formats_are_named() {
    assert_refused(&[], &["SCENE"]);
    assert_refused(&["none.obj"], &["none.obj: can", "not be read"]);
    assert_refused(&["folder.png"], &["folder.png: is a folder, not a scene file"]);
    assert_refused(&["none.png"], &["none.png: unknown scene format"]);
    assert_refused(&["room.obj", "--max-triangles", "3"], &["room.obj:13: too many triangles (limit: 3)"]);
}

#[test]
fn row_83_no_samples() {
    assert_refused(&["room.obj", "--spp", "0"], &["--spp"]);
}

#[test]
fn row_84_no_width_or_height() {
    assert_refused(&["room.obj", "--width", "0"], &["--width"]);
    assert_refused(&["room.obj", "--height", "0"], &["--height"]);
}

#[test]
fn row_85_too_many_pixels() {
    assert_refused(
        &["room.obj", "--width", "1000000", "--height", "1000000"],
        &["--width 1000000 --height 1000000: must be at most 134217728 pixels"],
    );
    assert_refused(&["room.obj", "--width", "4294967296"], &["--width"]);
}

#[test]
fn row_86_field_of_view() {
    for fov in ["0", "-1", "180", "nan"] {
        let camera = format!("0,0,4/0,0,0/0,1,0/{fov}");
        assert_refused(
            &["room.obj", "--camera", &camera],
            &["--camera", "the field of view must be above 0 and below 180 degrees"],
        );
    }
}

/// It is refused before the render, not when its file is written.
#[test]
fn an_environment_that_openexr_cannot_hold() {
    assert_refused(
        &["room.obj", "--out", "a.png", "--out", "b.exr", "--environment", "0.1,1e50,1e40"],
        &[
            "--out b.exr: the environment has a radiance of 1e50, which exceeds 3.4028235e38, the most of OpenEXR",
        ],
    );
}

#[test]
fn row_87_a_camera_that_looks_at_itself() {
    assert_refused(&["room.obj", "--camera", "1,2,3/1,2,3"], &["eye and target must be finite and apart"]);
    assert_refused(
        &["room.obj", "--camera", "0,0,inf/0,0,0"],
        &["each coordinate must be from -1e60 to 1e60"],
    );
    assert_refused(&["room.obj", "--camera", "0,9/0,0,0"], &["`0,9` is not 3 numbers"]);
}

#[test]
fn row_88_up_along_the_view() {
    assert_refused(&["room.obj", "--camera", "0,9,0/0,0,0"], &["up must be finite and not parallel"]);
}

#[test]
fn rows_89_and_90_any_number_of_threads_and_any_seed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let picture = |flags: &[&str]| {
        let size = ["room.obj", "--width", "8", "--height", "8", "--spp", "1", "--out", "a.exr"];
        let output = RENDER.run(folder.path(), &[&size[..], flags].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(folder.path().join("a.exr")).expect("it was written")
    };
    let seeds = ["0", "1", "18446744073709551615"].map(|seed| picture(&["--seed", seed]));
    assert!(seeds[0] != seeds[1] && seeds[1] != seeds[2], "each seed has numbers of its own");
    for threads in ["0", "1", "3"] {
        assert_eq!(picture(&["--threads", threads]), seeds[0], "{threads} threads");
    }
    assert_refused(
        &["room.obj", "--threads", "1025"],
        &["--threads 1025: must be an integer from 0 to 1024"],
    );
    assert_refused(&["room.obj", "--seed=-1"], &["--seed"]);
}

/// Tiles are not for users to choose; what they choose is a pass.
#[test]
fn row_91_passes_of_no_samples() {
    assert_refused(
        &["room.obj", "--pass-spp", "0"],
        &["--pass-spp 0: must be a power of two from 1 to 65536"],
    );
    assert_refused(&["room.obj", "--passes", "2..2"], &["--passes 2..2: must be A..B"]);
}

#[test]
fn row_92_no_bounces_leave_what_is_emitted() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let flags = ["--max-bounces", "0", "--environment", "0.25", "--spp", "4", "--stats", "stats.json"];
    let output =
        RENDER.run(folder.path(), &[&["room.obj", "--width", "16", "--height", "8"], &flags[..]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let stats = std::fs::read(folder.path().join("stats.json")).expect("it was written");
    let stats: serde_json::Value = serde_json::from_slice(&stats).expect("it is JSON");
    assert_eq!((&stats["bounce_rays"], &stats["shadow_rays"]), (&0.into(), &0.into()));
    assert!(stats["image_mean"][0].as_f64().is_some_and(|mean| mean > 0.0));
    assert_refused(&["room.obj", "--max-bounces=-1"], &["--max-bounces"]);
}

#[test]
fn colours_and_exposures_are_numbers() {
    assert_refused(
        &["room.obj", "--environment", "-1"],
        &["--environment -1: each radiance must be 0 or from 1e-50 to 1e50"],
    );
    assert_refused(
        &["room.obj", "--environment", "1e60"],
        &["--environment 1e60: each radiance must be 0 or from 1e-50 to 1e50"],
    );
    assert_refused(
        &["room.obj", "--environment", "nan"],
        &["--environment nan: each radiance must be 0 or from 1e-50 to 1e50"],
    );
    assert_refused(&["room.obj", "--exposure", "inf"], &["--exposure inf: must be a finite number"]);
}

#[test]
fn row_93_a_picture_that_is_a_folder() {
    assert_refused(
        &["room.obj", "--out", "folder.png"],
        &["folder.png: can", "not be written: is a directory"],
    );
}

#[test]
fn row_94_pictures_where_nothing_can_be_written() {
    assert_refused(&["room.obj", "--out", "nowhere/a.png"], &["nowhere/a.png: can", "not be written"]);
    assert_refused(&["room.obj", "--out", "room.obj/a.png"], &["room.obj/a.png: can", "not be written"]);
    assert_refused(
        &["room.obj", "--stats", "nowhere/stats.json"],
        &["nowhere/stats.json: can", "not be written"],
    );
    assert_refused(&["room.obj", "--checkpoint", "nowhere/cp"], &["nowhere/cp: can", "not be written"]);
}

/// No room is left while the picture, the figures or the checkpoint are being written: what was
/// there before stays, and nothing else.
#[cfg(unix)]
#[test]
fn row_95_a_disk_that_fills_up() {
    let size = ["room.obj", "--width", "64", "--height", "64", "--spp", "1"];
    for (flag, name) in [("--out", "old.exr"), ("--checkpoint", "old.cp")] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fill(folder.path());
        let old = folder.path().join("old.exr");
        std::fs::write(&old, "old").expect("likewise");
        let names = || std::fs::read_dir(folder.path()).expect("it is there").count();
        let before = names();
        // A limit on the size of files stands for the end of the disk.
        let output = std::process::Command::new("sh")
            .args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$@\"", "sh"])
            .arg(RENDER.path)
            .args(RENDER.first)
            .args(size)
            .args([flag, name])
            .current_dir(folder.path())
            .output()
            .expect("there is a shell");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.starts_with(&format!("error: {name}: can")), "{message}");
        assert!(message.contains("not be written: "), "{message}");
        assert_eq!((message.lines().count(), names()), (1, before), "{message}");
        assert_eq!(std::fs::read(&old).expect("it is there"), b"old");
    }
}

#[test]
fn row_96_formats_that_are_not_written() {
    assert_refused(&["room.obj", "--out", "a.bmp"], &["a.bmp: unknown picture format"]);
    assert_refused(&["room.obj", "--out", "a"], &["a: unknown picture format"]);
    assert_refused(&["room.obj", "--out", "a.png", "--out", "b.gif"], &["b.gif: unknown picture format"]);
}

#[test]
fn a_scene_becomes_several_pictures_and_figures() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let size = ["room.obj", "--width", "24", "--height", "16", "--spp", "4", "--exposure", "-1"];
    let out = [
        "--out",
        "a.png",
        "--out",
        "a.exr",
        "--stats",
        "stats.json",
        "--environment",
        "0.5,0.5,0.25",
        "--buffers",
    ];
    let output = RENDER.run(folder.path(), &[&size[..], &out].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "", "there is nothing to warn of");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("a.png") && said.contains("a.exr"), "{said}");
    let read = |name| std::fs::read(folder.path().join(name)).expect("it was written");
    let stats: serde_json::Value = serde_json::from_slice(&read("stats.json")).expect("it is JSON");
    assert_eq!(stats["triangles"], 4);
    assert_eq!(stats["camera_rays"], 24 * 16 * 4);
    let exr = PictureData::read(folder.path().join("a.exr")).expect("a picture");
    let hits = exr.first_hits.expect("they were asked for").pixels;
    assert_eq!((hits[0].depth, hits[0].triangle), (f64::INFINITY, None));
    assert!(hits.iter().any(|hit| hit.depth.is_finite() && hit.triangle.is_some() && hit.material.is_some()));
    let png = image::load_from_memory(&read("a.png")).expect("a picture").into_rgb8();
    // The corner sees the environment, which the PNG shows at half its brightness.
    assert_eq!(exr.estimates.means[0], Rgb::new(0.5, 0.5, 0.25));
    assert_eq!(png.get_pixel(0, 0).0, [137, 137, 99]);
}

/// Runs `render` with these flags and returns what it says on standard error, and its figures.
fn figures(folder: &Path, arguments: &[&str]) -> (String, serde_json::Value) {
    let size = ["--width", "12", "--height", "8", "--spp", "4", "--stats", "stats.json"];
    let output = RENDER.run(folder, &[&size[..], arguments].concat());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{said}");
    let stats = std::fs::read(folder.join("stats.json")).expect("it was written");
    (said, serde_json::from_slice(&stats).expect("it is JSON"))
}

#[test]
fn a_sun_lights_what_is_seen() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill_unlit(folder.path());
    let mean = |figures: &serde_json::Value| figures["image_mean"][0].as_f64().expect("a number");
    let (said, sun) = figures(folder.path(), &["a.obj", "--sun"]);
    assert!(!said.contains("lights"), "{said}");
    assert_eq!((&sun["environment"], &sun["delta_lights"]), (&serde_json::json!([0.3, 0.3, 0.3]), &1.into()));
    let (_, sky) = figures(folder.path(), &["a.obj", "--environment", "0.3"]);
    assert!(mean(&sun) > 1.02 * mean(&sky) && mean(&sun) < 1.0, "{sun}");
    let (_, alone) = figures(folder.path(), &["a.obj", "--sun", "--environment", "0"]);
    assert!(mean(&alone) > 0.0 && mean(&alone) < mean(&sun), "{alone}");
}

/// A triangle without lights, whose material library does not exist.
fn fill_unlit(folder: &Path) {
    let text = "mtllib no.mtl\nusemtl a\nv 0 0 0\nv 2 0 0\nv 0 0 -1\nf 1 2 3\nusemtl b\nv 0 0.5 0\nf 1 2 4\n";
    std::fs::write(folder.join("a.obj"), text).expect("an empty folder can be filled");
}

#[test]
fn what_is_passed_over_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill_unlit(folder.path());
    let first = "warning: a.obj:2: material `a` is not defined; grey is used instead";
    let missing = "warning: a.obj:1: material library `no.mtl` does not exist";
    let (said, _) = figures(folder.path(), &["a.obj", "--environment", "1"]);
    let grouped = format!("{first} (first of 2 such warnings; --verbose lists all)");
    assert_eq!(said.lines().collect::<Vec<_>>(), [missing, &grouped]);
    let (said, _) = figures(folder.path(), &["a.obj", "--environment", "1", "--verbose"]);
    let second = "warning: a.obj:7: material `b` is not defined; grey is used instead";
    assert_eq!(said.lines().collect::<Vec<_>>(), [missing, first, second]);
}

#[test]
fn a_file_in_which_nothing_shines_gets_a_white_environment() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill_unlit(folder.path());
    let last = |said: &str| said.lines().last().expect("it warns").to_owned();
    let (said, lit) = figures(folder.path(), &["a.obj"]);
    assert_eq!(last(&said), format!("warning: {}", no_lights("a.obj")));
    assert_eq!(lit["environment"], serde_json::json!([1.0, 1.0, 1.0]));
    let mean = |figures: &serde_json::Value| figures["image_mean"][0].as_f64().expect("a number");
    assert!(mean(&lit) > 0.5 && mean(&lit) < 1.0, "{lit}");
    let (said, dark) = figures(folder.path(), &["a.obj", "--environment", "0"]);
    assert_eq!(last(&said), "warning: a.obj: scene has no lights and no environment: the picture is black");
    assert_eq!(dark["image_mean"], serde_json::json!([0.0, 0.0, 0.0]));
    let (said, own) = figures(folder.path(), &["a.obj", "--environment", "0.5,1,2"]);
    assert!(!said.contains("lights"), "{said}");
    assert_eq!(own["environment"], serde_json::json!([0.5, 1.0, 2.0]));
    // What has a light of its own gets nothing.
    fill(folder.path());
    let (said, room) = figures(folder.path(), &["room.obj"]);
    assert_eq!((said.as_str(), &room["environment"]), ("", &serde_json::json!([0.0, 0.0, 0.0])));
}

#[test]
fn figures_say_where_the_scene_and_the_camera_are() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill_unlit(folder.path());
    let (_, stats) = figures(folder.path(), &["a.obj"]);
    assert_eq!(stats["bounds"], serde_json::json!([[0.0, 0.0, -1.0], [2.0, 0.5, 0.0]]));
    assert_eq!(stats["camera_by"], "outside");
    let camera = stats["camera"].as_str().expect("a text");
    let (_, again) = figures(folder.path(), &["a.obj", "--camera", camera]);
    assert_eq!(again["camera_by"], "flag");
    // The digits that are not shown may change the last one that is.
    let numbers =
        |text: &str| text.split(['/', ',']).map(|x| x.parse().expect("a number")).collect::<Vec<f64>>();
    let (shown, parsed) = (numbers(camera), numbers(again["camera"].as_str().expect("a text")));
    assert_eq!((shown.len(), parsed.len()), (10, 10));
    assert!(shown.iter().zip(&parsed).all(|(a, b)| (a - b).abs() < 1e-4), "{shown:?}, {parsed:?}");
    let (_, up) = figures(folder.path(), &["a.obj", "--up", "z"]);
    assert_ne!(up["camera"], stats["camera"]);
    let (_, up) = figures(folder.path(), &["a.obj", "--up", "z", "--camera", "1,-4,2/1,0,0"]);
    let camera = up["camera"].as_str().expect("a text");
    assert!(camera.starts_with("1,-4,2/1,") && camera.ends_with("/0,0.447214,0.894427/40"), "{camera}");
    assert_refused(&["room.obj", "--up", "x"], &["--up x: must be one of y, z"]);
}

/// The pixels of a PNG in `folder`.
fn pixels(folder: &Path, name: &str) -> image::RgbImage {
    image::open(folder.join(name)).expect("it was written").to_rgb8()
}

#[test]
fn a_crop_has_the_pixels_of_the_picture() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let size = ["room.obj", "--width", "30", "--height", "24", "--spp", "4", "--threads", "1"];
    let picture = |flags: &[&str]| RENDER.succeed(folder.path(), &[&size[..], flags].concat());
    picture(&["--out", "whole.png"]);
    let whole = pixels(folder.path(), "whole.png");
    for (crop, reuse) in
        [("5,6,14,7", "tiles"), ("0,0,30,24", "tiles"), ("13,23,17,1", "tiles"), ("3,1,5,9", "off")]
    {
        picture(&["--out", "crop.png", "--crop", crop, "--path-reuse", reuse]);
        let numbers: Vec<u32> = crop.split(',').flat_map(str::parse).collect();
        let [x, y, width, height] = numbers[..] else { panic!("four numbers") };
        if reuse == "off" {
            picture(&["--out", "whole.png", "--path-reuse", "off"]);
        }
        let whole = if reuse == "off" { pixels(folder.path(), "whole.png") } else { whole.clone() };
        let expected = image::imageops::crop_imm(&whole, x, y, width, height).to_image();
        assert_eq!(pixels(folder.path(), "crop.png"), expected, "{crop}");
    }
    assert_refused(
        &["room.obj", "--crop", "0,0,513,1"],
        &["--crop 0,0,513,1: must lie within the picture of 512 x 512 pixels"],
    );
    assert_refused(&["room.obj", "--crop", "0,0,5,0"], &["--crop 0,0,5,0: must be X,Y,WIDTH,HEIGHT"]);
}

#[test]
fn cameras_of_all_types_are_taken_and_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    for (kind, camera) in [
        ("orthographic", Some("0,0.5,3/0,0.5,0/0,1,0/1.5")),
        ("360", Some("0,0.5,0/0,0.5,-3/0,1,0")),
        ("orthographic", None),
        ("360", None),
    ] {
        let size = [
            "room.obj",
            "--width",
            "8",
            "--height",
            "4",
            "--spp",
            "1",
            "--stats",
            "-",
            "--camera-type",
            kind,
        ];
        let given: Vec<&str> = camera.into_iter().flat_map(|camera| ["--camera", camera]).collect();
        let stats = RENDER.succeed(folder.path(), &[&size[..], &given].concat());
        let stats: serde_json::Value = serde_json::from_str(&stats).expect("it is JSON");
        assert_eq!(stats["camera_type"], kind);
        // What is told gives the same camera again.
        let told = stats["camera"].as_str().expect("a text").to_owned();
        let again = RENDER.succeed(folder.path(), &[&size[..], &["--camera", &told]].concat());
        let again: serde_json::Value = serde_json::from_str(&again).expect("it is JSON");
        assert_eq!(again["camera_by"], "flag");
        if camera.is_some() {
            assert_eq!(again["image_mean"], stats["image_mean"], "{kind}");
        }
    }
    assert_refused(
        &["room.obj", "--camera-type", "360", "--camera", "0,0,1/0,0,0/0,1,0/40"],
        &["must have two or three parts: from/to/up"],
    );
    assert_refused(
        &["room.obj", "--camera-type", "orthographic", "--camera", "0,0,1/0,0,0/0,1,0/-1"],
        &["the height must be a number above 0"],
    );
    assert_refused(&["room.obj", "--camera-type", "fisheye"], &["must be one of pinhole, orthographic, 360"]);
}
