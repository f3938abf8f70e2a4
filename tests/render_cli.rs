//! `examples/render.rs` as a person meets it: what it writes, and what it says when it can not.

mod program;

use program::Program;
use std::path::Path;

const RENDER: Program = Program("render");

/// A lamp over a floor, seen by nobody yet.
const ROOM: &str = "mtllib room.mtl
v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv -0.2 1 -0.2\nv 0.2 1 -0.2\nv 0.2 1 0.2\nv -0.2 1 0.2
usemtl floor\nf 1 2 3 4\nusemtl lamp\nf 5 6 7 8\n";
const MATERIALS: &str = "newmtl floor\nKd 0.7 0.6 0.5\nnewmtl lamp\nKd 0\nKe 10 10 10\n";

fn fill(folder: &Path) {
    std::fs::create_dir(folder.join("folder.png")).expect("an empty folder can be filled");
    for (name, content) in [
        ("room.obj", ROOM),
        ("room.mtl", MATERIALS),
        ("index.obj", "v 0 0 0\nf 1 2 3\n"),
        ("outside.obj", "mtllib ../secret.mtl\n"),
        ("colour.obj", "mtllib colour.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("colour.mtl", "newmtl m\nKd 5 5 5\n"),
        ("empty.obj", ""),
        ("half.gltf", "{\"asset\":"),
        ("old.gltf", "{\"asset\":{\"version\":\"1.0\"}}"),
        ("cycle.gltf", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[0]}]}"),
        ("short.glb", "glTF"),
    ] {
        std::fs::write(folder.join(name), content).expect("likewise");
    }
}

fn assert_refused(arguments: &[&str], words: &[&str]) {
    RENDER.assert_refused(fill, arguments, words);
}

#[test]
fn bad_scenes_are_one_line_that_names_file_and_place() {
    assert_refused(&["none.obj"], &["none.obj"]);
    assert_refused(&["folder.png"], &["folder.png: unknown scene format"]);
    assert_refused(&["index.obj"], &["index.obj:2: index 2 refers to none of the 1 vertices"]);
    assert_refused(&["outside.obj"], &["outside.obj:1: `../secret.mtl` is not within"]);
    assert_refused(&["colour.obj"], &["colour.mtl:1: material `m`: reflectance (5, 5, 5)"]);
    assert_refused(&["empty.obj"], &["empty.obj: has no triangles"]);
    assert_refused(&["half.gltf"], &["half.gltf:1: column 9"]);
    assert_refused(&["old.gltf"], &["old.gltf: glTF version 1.0"]);
    assert_refused(&["cycle.gltf"], &["cycle.gltf: nodes[0]: is its own ancestor"]);
    assert_refused(&["short.glb"], &["short.glb: the header is cut off"]);
}

#[test]
fn rows_83_to_92_bad_settings_are_one_line_that_names_them() {
    assert_refused(&[], &["SCENE"]);
    assert_refused(&["room.obj", "--spp", "0"], &["--spp"]);
    assert_refused(&["room.obj", "--width", "0"], &["--width"]);
    assert_refused(&["room.obj", "--width", "1000000", "--height", "1000000"], &["width", "height"]);
    for fov in ["0", "180"] {
        let camera = format!("0,0,4/0,0,0/0,1,0/{fov}");
        assert_refused(&["room.obj", "--camera", &camera], &["--camera", "fov_y"]);
    }
    assert_refused(&["room.obj", "--camera", "1,2,3/1,2,3"], &["eye and target must be finite and apart"]);
    assert_refused(&["room.obj", "--camera", "0,9,0/0,0,0"], &["up must be finite and not parallel"]);
    assert_refused(&["room.obj", "--camera", "0,9/0,0,0"], &["`0,9` is not 3 numbers"]);
    assert_refused(&["room.obj", "--environment", "-1"], &["radiance (-1, -1, -1)"]);
    assert_refused(&["room.obj", "--exposure", "inf"], &["--exposure inf"]);
}

#[test]
fn rows_93_to_96_bad_places_are_found_before_rendering() {
    assert_refused(&["room.obj", "--out", "folder.png"], &["folder.png: can not be written"]);
    assert_refused(&["room.obj", "--out", "nowhere/a.png"], &["nowhere/a.png: can not be written"]);
    assert_refused(&["room.obj", "--out", "a.bmp"], &["a.bmp: unknown picture format"]);
    assert_refused(&["room.obj", "--out", "a.png", "--out", "b.gif"], &["b.gif: unknown picture format"]);
    assert_refused(&["room.obj", "--stats", "nowhere/stats.json"], &["nowhere/stats.json"]);
}

#[test]
fn a_scene_becomes_several_pictures_and_figures() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let size = ["room.obj", "--width", "24", "--height", "16", "--spp", "4", "--exposure", "-1"];
    let out = ["--out", "a.png", "--out", "a.exr", "--stats", "stats.json", "--environment", "0.5,0.5,0.25"];
    let output = RENDER.run(folder.path(), &[&size[..], &out].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "", "there is nothing to warn of");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("a.png") && said.contains("a.exr"), "{said}");
    let read = |name| std::fs::read(folder.path().join(name)).expect("it was written");
    let stats: serde_json::Value = serde_json::from_slice(&read("stats.json")).expect("it is JSON");
    assert_eq!(stats["triangles"], 4);
    assert_eq!(stats["camera_rays"], 24 * 16 * 4);
    let exr = image::load_from_memory(&read("a.exr")).expect("a picture").into_rgb32f();
    let png = image::load_from_memory(&read("a.png")).expect("a picture").into_rgb8();
    // The corner sees the environment, which the PNG shows at half its brightness.
    assert_eq!(exr.get_pixel(0, 0).0, [0.5, 0.5, 0.25]);
    assert_eq!(png.get_pixel(0, 0).0, [137, 137, 99]);
}

#[test]
fn what_is_passed_over_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("a.obj"), "mtllib no.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .expect("an empty folder can be filled");
    let output = RENDER.run(folder.path(), &["a.obj", "--width", "4", "--height", "4", "--spp", "1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    assert!(said.contains("warning: a.obj:1: material library `no.mtl` does not exist"), "{said}");
    assert!(said.contains("warning: a.obj: nothing emits light"), "{said}");
    assert!(folder.path().join("render.png").exists());
}
