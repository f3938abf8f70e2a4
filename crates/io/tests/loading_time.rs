//! The time of loading relative to tobj: `cargo test --release -p globillum-io --test loading_time --
//! --ignored --nocapture`.
#![cfg(feature = "obj")]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]
#![allow(clippy::print_stderr, reason = "a skipped test prints a message")]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;
use tobj::LoadOptions;

/// The bound on the time of loading as a multiple of tobj's.
const LIMIT: f64 = 2.0;

#[test]
#[ignore = "a measurement for an idle machine and a release build"]
fn a_scanned_mesh_takes_at_most_twice_as_long_as_by_tobj_alone() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/meshes/bunny.obj");
    if !path.exists() {
        eprintln!("SKIPPED: bunny.obj is not there");
        return;
    }
    let options = LoadOptions { triangulate: true, ..LoadOptions::default() };
    let ours = fastest(|| globillum_io::load_obj(&path).unwrap());
    let tobjs = fastest(|| tobj::load_obj(&path, &options).unwrap());
    eprintln!("{:.1} ms, tobj {:.1} ms: {:.2} times as long", 1e3 * ours, 1e3 * tobjs, ours / tobjs);
    assert!(ours <= LIMIT * tobjs);
}

/// Seconds of the fastest of many runs.
fn fastest<T>(run: impl Fn() -> T) -> f64 {
    let seconds = |_| {
        let start = Instant::now();
        black_box(run());
        start.elapsed().as_secs_f64()
    };
    (0..15).map(seconds).fold(f64::INFINITY, f64::min)
}
