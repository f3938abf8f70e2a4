//! The figures that `--stats` writes.

use crate::CORNELL;
use std::collections::BTreeSet;
use std::path::Path;

fn stats(folder: &Path, flags: &[&str]) -> serde_json::Value {
    let size = ["--width", "12", "--height", "8", "--stats", "stats.json"];
    CORNELL.succeed(folder, &[&size, flags].concat());
    let bytes = std::fs::read(folder.join("stats.json")).expect("the figures were written");
    serde_json::from_slice(&bytes).expect("it is JSON")
}

#[test]
fn figures_say_how_the_picture_was_made() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let flags = ["--scene", "1", "--triangles", "500", "--seed", "7", "--passes", "1..3", "--pass-spp", "2"];
    let more = [
        "--threads",
        "1",
        "--sampler",
        "independent",
        "--max-bounces",
        "5",
        "--accel",
        "kd",
        "--guiding",
        "trained",
    ];
    let files = ["--out", "a.png", "--out", "a.exr", "--checkpoint", "parts"];
    let found = stats(folder.path(), &[&flags[..], &more, &files].concat());
    let expected = serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"), "scene": "cornell 1",
        "width": 12, "height": 8, "seed": 7, "threads": 1, "accel": "kd", "sampler": "independent",
        "estimator": "mis", "light_sampling": "solid-angle", "mirror_sampling": "images",
        "supersampling": "lights", "guiding": "trained",
        "path_reuse": "tiles", "filter": "box", "max_bounces": 5, "pass_spp": 2, "spp": 6, "exposure": 0.0,
        "passes": "1..3", "passes_held": [[1, 3]], "samples_per_pixel": 4, "samples": 12 * 8 * 4,
        "error": null, "seconds": null, "pilot": null, "resume": false,
        "out": ["a.png", "a.exr"], "stats": "stats.json", "checkpoint": "parts",
        "roulette_start": 2, "roulette_threshold": 0.2, "ended_by": "all samples taken",
    });
    for (key, value) in expected.as_object().expect("an object") {
        assert_eq!(&found[key], value, "{key}");
    }
    assert_eq!(found["arguments"][0], "cornell");
    assert!(["portable", "avx2", "avx512"].map(serde_json::Value::from).contains(&found["simd"]));
}

#[test]
fn what_no_flag_decides_is_recorded_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let found = stats(folder.path(), &[]);
    assert_eq!((&found["spp"], &found["out"][0]), (&64.into(), &"cornell.png".into()));
    assert!(found["threads"].as_u64().is_some_and(|threads| threads > 0));
    let found = stats(folder.path(), &["--error", "0.5"]);
    assert!(found["spp"].is_null() && found["error"] == 0.5 && found["ended_by"] == "the error reached");
}

/// The table in the README has each key, and no other.
#[test]
fn every_key_is_documented() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let found = stats(folder.path(), &["--spp", "1"]);
    let found: BTreeSet<&str> = found.as_object().expect("an object").keys().map(String::as_str).collect();
    let rows = include_str!("../../README.md").lines().filter(|line| line.starts_with("| `"));
    let keys = rows.flat_map(|row| row.split('|').nth(1).into_iter().flat_map(|cell| cell.split('`')));
    let documented: BTreeSet<&str> = keys.filter(|key| key.chars().any(char::is_alphabetic)).collect();
    assert_eq!(documented, found);
}
