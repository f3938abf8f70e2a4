//! Runs the program `compare`, and checks its output files and error messages.

use std::path::Path;
use std::process::{Command, Output};

fn run(folder: &Path, arguments: &[&str]) -> Output {
    std::fs::write(folder.join("quad.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
        .expect("a file");
    std::fs::write(folder.join("bad.obj"), "v 0 0 0\nv 1 0 zero\n").expect("a file");
    std::fs::write(folder.join("point.obj"), "v 1 2 3\nf 1 1 1\n").expect("a file");
    std::fs::write(folder.join("picture.png"), [0x89, b'P', b'N', b'G', 0, 0xff]).expect("a file");
    Command::new(env!("CARGO_BIN_EXE_compare"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Fails with exit code 1 and one line on standard error that holds each of `words`.
fn assert_refused(arguments: &[&str], words: &[&str]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = run(folder.path(), arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
    assert_eq!(message.lines().count(), 1, "{arguments:?}: {message}");
    for word in words {
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
    assert!(!folder.path().join("compare/compare.csv").exists(), "{arguments:?}");
}

#[test]
fn bad_input_is_one_line_that_names_it() {
    let on_quad = |flag, value, words: &[&str]| assert_refused(&["--mesh", "quad.obj", flag, value], words);
    on_quad("--max-aspect", "1.5", &["max_aspect", "1.5", "[2, inf)"]);
    on_quad("--traversal-cost=-1", "--side=8", &["traversal_cost", "-1", "[0, inf)"]);
    on_quad("--density", "0", &["density", "(0, inf)"]);
    on_quad("--resolution", "4,0,4", &["resolution", "[1, 2^27]"]);
    on_quad("--resolution", "4096,4096,4096", &["grid cells", "68719476736", "134217728"]);
    on_quad("--resolution", "4096,4096,1", &["grid references", "1056"]);
    on_quad("--resolution", "4,4", &["resolution", "three numbers"]);
    on_quad("--side", "0", &["--side", "0"]);
    on_quad("--farther", "0.5", &["--farther", "0.5", "[1, 1e15]"]);
    on_quad("--mesh", "quad.obj", &["--mesh", "quad"]);
    assert_refused(&["--mesh", "none.obj"], &["none.obj"]);
    assert_refused(&["--mesh", "bad.obj"], &["bad.obj:2"]);
    assert_refused(&["--mesh", "point.obj"], &["point.obj", "no triangle"]);
    assert_refused(&["--mesh", "picture.png"], &["picture.png"]);
    assert_refused(&["--mesh", "quad.obj", "--out", "quad.obj"], &["quad.obj"]);
}

#[test]
fn everything_is_written_and_all_rows_have_one_hash() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let output = run(folder.path(), &["--mesh", "quad.obj", "--side", "8", "--repeats", "1", "--brute"]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    let table = String::from_utf8_lossy(&output.stdout);
    assert!(table.contains("| k-d tree, sliding fair"), "{table}");
    let csv = std::fs::read_to_string(folder.path().join("compare/compare.csv")).expect("a table");
    let hashes: Vec<&str> = csv.lines().skip(1).filter_map(|line| line.rsplit(',').next()).collect();
    // Brute force, the grid, the default k-d tree, the wide BVH and seven rules.
    assert_eq!(hashes.len(), 11, "{csv}");
    assert!(hashes.iter().all(|hash| hash == &hashes[0] && hash.len() == 16), "{csv}");
    for name in
        ["compare.svg", "compare.png", "heat-quad-kd.png", "heat-quad-sliding.png", "heat-quad-grid.png"]
    {
        let bytes = std::fs::read(folder.path().join("compare").join(name)).expect(name);
        assert!(bytes.starts_with(b"<svg") || bytes.starts_with(b"\x89PNG"), "{name}");
    }
}

/// The mesh lies between the two middle columns of pixels: no ray hits it, and every picture has one colour.
#[test]
fn a_mesh_that_no_ray_hits_is_no_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("blade.obj"), "v 0 0 0\nv 0 1 0\nv 0.0001 0.5 0\nf 1 2 3\n")
        .expect("a file");
    let output = run(folder.path(), &["--mesh", "blade.obj", "--side", "8", "--repeats", "1"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
