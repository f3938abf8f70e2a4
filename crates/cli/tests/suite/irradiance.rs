//! `globillum irradiance`: what it writes, and what it says if it cannot.

use crate::GLOBILLUM;
use globillum_testkit::stats::Z_LIMIT;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

/// A floor of albedo 0 at height 0 under a square light of 2 x 2 and radiance 1 at height 1.
const SCENE: &str = "mtllib a.mtl
v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nv -1 1 -1\nv 1 1 -1\nv 1 1 1\nv -1 1 1
usemtl floor\nf 1 2 3 4\nusemtl light\nf 5 6 7 8\n";
const MATERIALS: &str = "newmtl floor\nKd 0\nnewmtl light\nKd 0\nKe 1 2 4\n";
const POINTS: &str = "x,y,z,nx,ny,nz\n0,0,0,0,1,0\n# below\n0,0,0,0,-1,0\n1,0,1,0,1,0\n";

fn fill(folder: &Path) {
    for (name, content) in [("a.obj", SCENE), ("a.mtl", MATERIALS), ("a.csv", POINTS)] {
        std::fs::write(folder.join(name), content).expect("an empty folder can be filled");
    }
}

/// The numbers of each line below the heading.
fn rows(readings: &str) -> Vec<Vec<f64>> {
    let (heading, rows) = readings.split_once('\n').expect("a heading");
    assert_eq!(heading, "x,y,z,nx,ny,nz,r,g,b,r_error,g_error,b_error");
    rows.lines().map(|row| row.split(',').map(|word| word.parse().expect("a number")).collect()).collect()
}

#[test]
fn readings_are_written_with_their_errors_and_figures() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let flags =
        ["--points", "a.csv", "--samples", "4096", "--out", "b.csv", "--stats", "b.json", "--threads", "1"];
    let said = GLOBILLUM.succeed(folder.path(), &[&["irradiance", "a.obj"], &flags[..]].concat());
    for words in
        ["points        3, 4096 samples each", "ended by      all samples taken", "readings      b.csv"]
    {
        assert!(said.contains(words), "{said}");
    }
    let rows = rows(&std::fs::read_to_string(folder.path().join("b.csv")).expect("it was written"));
    assert_eq!(rows[0][..6], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    for (channel, radiance) in [1.0, 2.0, 4.0].into_iter().enumerate() {
        let (found, error) = (rows[0][6 + channel], rows[0][9 + channel]);
        let truth = std::f64::consts::PI * radiance * 0.554_126_424;
        assert!((found - truth).abs() < Z_LIMIT * error && error < 0.005 * truth, "{rows:?}");
        assert_eq!((rows[1][6 + channel], rows[1][9 + channel]), (0.0, 0.0), "the floor hides the light");
    }
    let stats = std::fs::read(folder.path().join("b.json")).expect("it was written");
    let stats: serde_json::Value = serde_json::from_slice(&stats).expect("it is JSON");
    assert_eq!((&stats["points"], &stats["samples_per_point"]), (&3.into(), &4096.into()));
    assert_eq!((&stats["scene"], &stats["arguments"][0]), (&"a.obj".into(), &"irradiance".into()));
}

#[test]
fn points_and_readings_go_through_pipes_and_checkpoints() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let common = ["irradiance", "a.obj", "--samples", "64", "--threads", "1"];
    let mut child =
        GLOBILLUM.command(folder.path(), &[&common[..], &["--points", "-", "--out", "-"]].concat());
    let child = child.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.expect("the program starts");
    child.stdin.take().expect("a pipe").write_all(POINTS.as_bytes()).expect("the program reads");
    let output = child.wait_with_output().expect("the program ends");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stderr).contains("points        3, 64 samples each"));
    let piped = String::from_utf8(output.stdout).expect("it is text");
    assert_eq!(rows(&piped).len(), 3);
    let part = |flags: &[&str]| {
        let files = ["--points", "a.csv", "--out", "b.csv", "--checkpoint", "b.part", "--resume"];
        GLOBILLUM.succeed(folder.path(), &[&common[..], &files, flags].concat())
    };
    part(&["--passes", "0..2"]);
    part(&[]);
    assert_eq!(std::fs::read_to_string(folder.path().join("b.csv")).expect("it was written"), piped);
}

#[test]
fn what_is_wrong_is_one_line_that_names_file_and_line() {
    let refused = |points: &'static str, flags: &[&str], words: &[&str]| {
        let fill = |folder: &Path| {
            fill(folder);
            std::fs::write(folder.join("bad.csv"), points).expect("a folder can be filled");
        };
        GLOBILLUM.assert_refused(fill, &[&["irradiance", "a.obj"], flags].concat(), words);
    };
    let bad = ["--points", "bad.csv"];
    refused("", &[], &["--points <FILE.csv> is missing"]);
    refused("", &["--points", "none.csv"], &["none.csv: cannot be read"]);
    refused("", &bad, &["bad.csv: there are no points"]);
    refused("x,y,z,nx,ny,nz\n0,0,0,0,1\n", &bad, &["bad.csv:2: has 5 columns, not the 6 of x,y,z,nx,ny,nz"]);
    refused("0,0,0,0,1,0\n\n0,0,a,0,1,0\n", &bad, &["bad.csv:3: `a` is not a number"]);
    refused("0,0,0,0,0,0\n", &bad, &["bad.csv:1: normal [0.0, 0.0, 0.0] has length 0.0, must be 1"]);
    refused("0,inf,0,0,1,0\n", &bad, &["bad.csv:1: position [0.0, inf, 0.0] is not finite"]);
    let words = ["bad.csv:1: position [1e300, 0.0, 0.0] is not finite or beyond +-2^60"];
    refused("1e300,0,0,0,1,0\n", &bad, &words);
    refused(
        "",
        &["--points", "a.csv", "--out", "-", "--stats", "-"],
        &["standard output can be given only once"],
    );
    refused("", &["--points", "a.csv", "--samples", "16", "--passes", "0..2"], &["has only passes 0..1"]);
    for name in ["a.exr", "a.PNG"] {
        let words = [&*format!("--out {name}: is written as CSV, which is no picture; use .csv")];
        refused("", &["--points", "a.csv", "--out", name], &words);
    }
}
