//! `examples/cornell.rs` as a person meets it: what it writes, and what it says when it can not.

use globillum_testkit::program::Program;
use std::path::Path;
use std::process::Command;

const CORNELL: Program = Program { path: env!("CARGO_BIN_EXE_globillum"), first: &["cornell"] };

fn fill(folder: &Path) {
    std::fs::create_dir(folder.join("folder.png")).expect("an empty folder can be filled");
    std::fs::write(folder.join("bad.obj"), "v 0 0 0\nv 1 0 zero\n").expect("likewise");
    std::fs::write(folder.join("empty.obj"), "").expect("likewise");
    std::fs::write(folder.join("point.obj"), "v 1 2 3\nf 1 1 1\n").expect("likewise");
}

fn assert_refused(arguments: &[&str], words: &[&str]) {
    CORNELL.assert_refused(fill, arguments, words);
}

#[test]
fn bad_input_is_one_line_that_names_it() {
    assert_refused(&["--mesh", "none.obj"], &["none.obj"]);
    assert_refused(&["--mesh", "bad.obj"], &["bad.obj:2"]);
    assert_refused(&["--mesh", "empty.obj"], &["empty.obj"]);
    assert_refused(&["--mesh", "point.obj"], &["point.obj"]);
    assert_refused(&["--width", "0"], &["width"]);
    assert_refused(&["--height", "0"], &["height"]);
    assert_refused(&["--width", "1000000", "--height", "1000000"], &["width", "height"]);
    assert_refused(&["--spp", "0"], &["spp"]);
    assert_refused(&["--spp", "many"], &["--spp", "many"]);
    assert_refused(&["--scene", "5"], &["--scene 5"]);
    assert_refused(&["--accel", "magic"], &["--accel", "magic"]);
    assert_refused(&["--out", "picture.bmp"], &["picture.bmp"]);
    assert_refused(&["--out", "picture"], &["picture"]);
    assert_refused(&["--out", "folder.png"], &["folder.png"]);
    assert_refused(&["--out", "nowhere/picture.png"], &["nowhere"]);
    assert_refused(&["--stats", "nowhere/stats.json"], &["nowhere/stats.json"]);
    assert_refused(&["--no-such-flag"], &["--no-such-flag"]);
    assert_refused(&["--pass-spp", "3"], &["pass_samples"]);
    assert_refused(&["--error", "-1"], &["error"]);
    assert_refused(&["--seconds", "nan"], &["seconds"]);
    assert_refused(&["--passes", "3"], &["--passes"]);
    assert_refused(&["--passes", "4..4"], &["passes"]);
    assert_refused(&["--resume"], &["--checkpoint"]);
    assert_refused(&["--checkpoint", "bad.obj"], &["bad.obj", "--resume"]);
    assert_refused(&["--checkpoint", "bad.obj", "--resume"], &["bad.obj", "is no checkpoint"]);
    assert_refused(&["--checkpoint", "nowhere/a"], &["nowhere/a"]);
}

#[test]
fn every_scene_is_rendered_with_as_many_triangles_as_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = ["--width", "16", "--height", "16", "--spp", "1", "--triangles", "20000"];
    for scene in ["1", "2", "3", "4"] {
        let arguments = [&size[..], &["--scene", scene, "--stats", "stats.json"]].concat();
        let output = CORNELL.run(folder.path(), &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let stats = std::fs::read(folder.path().join("stats.json")).expect("the figures were written");
        let stats: serde_json::Value = serde_json::from_slice(&stats).expect("it is JSON");
        let around = if scene == "4" { 7680 + 10 + 336 + 8 * 12 } else { 12 };
        let statues = stats["triangles"].as_u64().expect("a number") - around;
        assert!(statues.abs_diff(20_000) < 2000, "scene {scene}: {statues}");
    }
}

#[test]
fn a_small_picture_and_its_figures_are_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = ["--width", "32", "--height", "24", "--spp", "4", "--max-bounces", "2"];
    for (accel, out) in
        [("wide", "w.png"), ("kd", "a.png"), ("grid", "b.png"), ("brute", "c.png"), ("kd", "a.exr")]
    {
        let arguments = [&size[..], &["--accel", accel, "--out", out, "--stats", "stats.json"]].concat();
        let output = CORNELL.run(folder.path(), &arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(String::from_utf8_lossy(&output.stdout).contains(out));
    }
    let read = |name| std::fs::read(folder.path().join(name)).expect("the picture was written");
    assert_eq!(read("a.png"), read("b.png"));
    assert_eq!(read("a.png"), read("c.png"));
    assert_eq!(read("a.png"), read("w.png"));
    let stats: serde_json::Value = serde_json::from_slice(&read("stats.json")).expect("it is JSON");
    assert_eq!(stats["camera_rays"], 32 * 24 * 4);
    assert_eq!(stats["triangles"], 36);
    assert!(stats["limit_ends"].as_u64().is_some_and(|n| n > 0));
    assert!(stats["accelerator_bytes"].as_u64().is_some_and(|n| n > 36 * 36));
}

const SMALL: [&str; 8] = ["--width", "32", "--height", "24", "--pass-spp", "2", "--out", "a.exr"];

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Runs an example in `folder`, where it must succeed.
fn succeed(name: &'static str, folder: &Path, arguments: &[&[&str]]) -> String {
    let output = Program(name).run(folder, &arguments.concat());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn parts_of_a_picture_are_merged_to_the_whole() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let render = |arguments: &[&str]| succeed("cornell", folder, &[&SMALL, arguments]);
    render(&["--spp", "12", "--checkpoint", "whole"]);
    let whole = read(folder, "a.exr");
    for (part, passes) in [("1", "0..3"), ("2", "3..4"), ("3", "4..6")] {
        render(&["--passes", passes, "--checkpoint", part]);
    }
    let said = succeed("merge", folder, &[&["2", "3", "1", "--out", "b.exr", "--checkpoint", "all"]]);
    assert!(said.contains("12 a pixel, passes 0..6") && said.contains("error "), "{said}");
    assert_eq!(read(folder, "b.exr"), whole);
    assert_eq!(read(folder, "all"), read(folder, "whole"));
    for (parts, message) in [(["1", "1"], "held twice"), (["1", "a.exr"], "a.exr: is no checkpoint")] {
        let output = Program { path: env!("CARGO_BIN_EXE_globillum"), first: &["merge"] }
            .run(folder, &[&parts[..], &["--out", "c.png"]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && said.contains(message), "{said}");
    }
    render(&["--seed", "1", "--passes", "0..1", "--checkpoint", "4"]);
    let output = Program { path: env!("CARGO_BIN_EXE_globillum"), first: &["merge"] }
        .run(folder, &["1", "4", "--out", "c.png"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("4: belongs to another picture"));
}

#[test]
fn an_error_can_be_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for pilot in [&[][..], &["--pilot", "4"]] {
        let said = succeed("cornell", folder.path(), &[&SMALL, &["--error", "0.1"], pilot]);
        assert!(said.contains("ended by      the error reached"), "{said}");
    }
    let said = succeed("cornell", folder.path(), &[&SMALL, &["--seconds", "0.2", "--error", "1e-9"]]);
    assert!(said.contains("ended by      the time given"), "{said}");
}

/// A run that finds nothing left to do traces nothing, however much its picture holds.
#[test]
fn rates_are_those_of_the_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let render = |flags: &[&str]| {
        succeed("cornell", folder.path(), &[&SMALL, &["--spp", "8", "--checkpoint", "all"], flags])
    };
    let idle = "0.00 million samples and 0.00 million rays a second";
    assert!(!render(&[]).contains(idle));
    let said = render(&["--resume"]);
    assert!(said.contains(idle) && said.contains("samples       8 a pixel, 0.01 million in all"), "{said}");
}

/// A render killed a hundred times and resumed each time gives the bytes of an uninterrupted one.
#[test]
fn a_render_survives_being_killed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let flags = ["--spp", "1000", "--threads", "1", "--checkpoint"];
    succeed("cornell", folder, &[&SMALL, &flags, &["whole"]]);
    let resume = [&SMALL[..], &flags, &["parts", "--resume", "--save-every", "0"]].concat();
    for i in 0..100 {
        let mut child = Command::new(CORNELL.path)
            .current_dir(folder)
            .args(&resume)
            .stdout(std::process::Stdio::null())
            .spawn()
            .expect("the example starts");
        std::thread::sleep(std::time::Duration::from_millis(10 + 37 * i % 29));
        child.kill().expect("it is our own");
        child.wait().expect("it is our own");
    }
    assert!(folder.join("parts").exists(), "none came as far as a first checkpoint");
    succeed("cornell", folder, &[&resume]);
    assert_eq!(read(folder, "parts"), read(folder, "whole"));
    let names = std::fs::read_dir(folder).expect("it is there").map(|e| e.expect("an entry").file_name());
    let mut names: Vec<_> = names.collect();
    names.sort();
    assert_eq!(names, ["a.exr", "parts", "whole"], "what the killed ones left is gone");
}
