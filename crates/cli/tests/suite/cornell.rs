//! `globillum cornell`: what it writes, and what it says if it cannot.

use crate::CORNELL;
use std::path::Path;

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
    assert_refused(&["--width", "0"], &["--width 0: must be an integer from 1 to 4294967295"]);
    assert_refused(&["--height", "0"], &["--height 0"]);
    assert_refused(
        &["--width", "1000000", "--height", "1000000"],
        &["--width 1000000", "--height 1000000", "134217728 pixels"],
    );
    assert_refused(&["--spp", "0"], &["--spp 0"]);
    assert_refused(&["--spp", "many"], &["--spp", "many"]);
    assert_refused(&["--scene", "5"], &["--scene 5: must be an integer from 0 to 4"]);
    assert_refused(&["--scene", "2", "--specular"], &["--specular: scene 2 has mirrors of its own"]);
    assert_refused(&["--scene", "4", "--specular"], &["--specular: scene 4 has mirrors of its own"]);
    assert_refused(&["--triangles", "1000"], &["--triangles: scene 0 has no statues"]);
    assert_refused(
        &["--scene", "1", "--triangles", "1000", "--mesh", "bad.obj"],
        &["--triangles: a mesh of --mesh has its own number"],
    );
    assert_refused(&["--mesh", "bad.obj", "--mesh", "bad.obj"], &["--mesh: scene 0 takes at most 1"]);
    assert_refused(&["--accel", "magic"], &["--accel magic: must be one of wide, kd, grid, brute"]);
    assert_refused(&["--out", "picture.bmp"], &["picture.bmp"]);
    assert_refused(&["--out", "picture"], &["picture"]);
    assert_refused(&["--out", "folder.png"], &["folder.png"]);
    assert_refused(&["--out", "nowhere/picture.png"], &["nowhere"]);
    assert_refused(&["--stats", "nowhere/stats.json"], &["nowhere/stats.json"]);
    assert_refused(&["--no-such-flag"], &["--no-such-flag"]);
    assert_refused(&["--pass-spp", "3"], &["--pass-spp 3: must be a power of two"]);
    assert_refused(&["--error", "-1"], &["--error -1: must be a number above 0"]);
    assert_refused(&["--seconds", "nan"], &["--seconds nan: must be a number above 0"]);
    assert_refused(&["--passes", "3"], &["--passes 3: must be A..B"]);
    assert_refused(&["--passes", "-1..3"], &["--passes -1..3: must be A..B"]);
    assert_refused(&["--crop", "-1,0,2,2"], &["--crop -1,0,2,2: must be X,Y,WIDTH,HEIGHT"]);
    assert_refused(&["--passes", "4..4"], &["--passes 4..4: must be A..B"]);
    assert_refused(&["--spp", "64", "--passes", "0..5"], &["--passes 0..5: --spp 64 has only passes 0..4"]);
    assert_refused(&["--error", "1", "--pilot", "1"], &["--pilot 1: must be an integer from 2"]);
    let pilot = ["--spp", "64", "--error", "1", "--pilot", "4"];
    assert_refused(&pilot, &["--pilot 4: leaves no pass of 4 after those of the pilot"]);
    assert_refused(&["--seed", "1", "--seed", "2"], &["--seed: can be given only once"]);
    assert_refused(&["--spp"], &["--spp: a value is missing"]);
    assert_refused(&["--widht", "3"], &["unexpected argument --widht (a similar argument exists: --width)"]);
    assert_refused(&["--out", "-", "--stats", "-"], &["-: standard output can be given only once"]);
    assert_refused(&["--resume"], &["--checkpoint <FILE> is missing"]);
    assert_refused(&["--checkpoint", "a", "--save-every", "-1"], &["--save-every -1: must be 0 or a number"]);
    assert_refused(&["--checkpoint", "bad.obj"], &["bad.obj", "--resume"]);
    assert_refused(&["--checkpoint", "bad.obj", "--resume"], &["bad.obj", "is not a checkpoint"]);
    assert_refused(&["--checkpoint", "nowhere/a"], &["nowhere/a"]);
}

#[test]
fn every_scene_is_rendered_with_as_many_triangles_as_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = ["--width", "16", "--height", "16", "--spp", "1", "--triangles", "20000"];
    for scene in ["1", "2", "3", "4"] {
        let arguments = [&size[..], &["--scene", scene, "--stats", "stats.json"]].concat();
        CORNELL.succeed(folder.path(), &arguments);
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
        assert!(CORNELL.succeed(folder.path(), &arguments).contains(out));
    }
    let read = |name| std::fs::read(folder.path().join(name)).expect("the picture was written");
    assert_eq!(read("a.png"), read("b.png"));
    assert_eq!(read("a.png"), read("c.png"));
    assert_eq!(read("a.png"), read("w.png"));
    let stats: serde_json::Value = serde_json::from_slice(&read("stats.json")).expect("it is JSON");
    assert_eq!(stats["samples"], 32 * 24 * 4);
    // Lights are supersampled.
    assert!(stats["camera_rays"].as_u64().is_some_and(|n| n > 32 * 24 * 4));
    assert_eq!(stats["triangles"], 36);
    assert!(stats["limit_ends"].as_u64().is_some_and(|n| n > 0));
    assert!(stats["accelerator_bytes"].as_u64().is_some_and(|n| n > 36 * 36));
}

/// The largest picture takes 13 GB at least, of which the limit leaves 8.
#[cfg(target_os = "linux")]
#[test]
fn a_picture_beyond_the_memory_allowed_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let limited = "ulimit -v 8000000 && exec \"$0\" cornell --width 16384 --height 8192 --spp 1 --threads 1";
    let output = std::process::Command::new("sh")
        .args(["-c", limited, CORNELL.path])
        .current_dir(folder.path())
        .output()
        .expect("there is a shell");
    let said = String::from_utf8_lossy(&output.stderr);
    let refused = "16384 x 8192 pixels take at least 12884901888 bytes of memory, which the system refuses";
    assert_eq!(said, format!("error: {refused}\n"));
    assert_eq!(output.status.code(), Some(75));
}
