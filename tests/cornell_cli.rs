//! `examples/cornell.rs` as a person meets it: what it writes, and what it says when it can not.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The example's executable, which cargo builds beside the tests.
fn cornell() -> PathBuf {
    let test = std::env::current_exe().expect("a test knows its own path");
    let profile = test.ancestors().nth(2).expect("tests lie in a profile's folder");
    let path = profile.join("examples").join(format!("cornell{}", std::env::consts::EXE_SUFFIX));
    assert!(path.exists(), "{} is not built; run `cargo test` or `cargo build --examples`", path.display());
    path
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(cornell()).current_dir(folder).args(arguments).output().expect("the example starts")
}

/// Fails with exit code 1 and one line on standard error that holds each of `words`, leaving the
/// folder as it was.
fn assert_refused(arguments: &[&str], words: &[&str]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("folder.png")).expect("an empty folder can be filled");
    std::fs::write(folder.path().join("bad.obj"), "v 0 0 0\nv 1 0 zero\n").expect("likewise");
    std::fs::write(folder.path().join("empty.obj"), "").expect("likewise");
    std::fs::write(folder.path().join("point.obj"), "v 1 2 3\nf 1 1 1\n").expect("likewise");
    let before = names(folder.path());
    let output = run(folder.path(), arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert_eq!(message.lines().count(), 1, "{arguments:?}: {message}");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
    assert_eq!(names(folder.path()), before, "{arguments:?} left something behind");
}

fn names(folder: &Path) -> Vec<std::ffi::OsString> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<_> = entries.map(|e| e.expect("an entry").file_name()).collect();
    names.sort();
    names
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
}

#[test]
fn a_small_picture_and_its_figures_are_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = ["--width", "32", "--height", "24", "--spp", "4", "--max-bounces", "2"];
    for (accel, out) in
        [("wide", "w.png"), ("kd", "a.png"), ("grid", "b.png"), ("brute", "c.png"), ("kd", "a.exr")]
    {
        let arguments = [&size[..], &["--accel", accel, "--out", out, "--stats", "stats.json"]].concat();
        let output = run(folder.path(), &arguments);
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
