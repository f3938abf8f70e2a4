//! Runs the program `convergence`, and checks its report and error messages.

use globillum_testkit::program::Program;
use std::path::Path;

const CONVERGENCE: Program = Program { path: env!("CARGO_BIN_EXE_convergence"), first: &[] };

/// Small parameters that still give a full report.
const SMALL: [&str; 6] = ["--spp", "16", "--time", "0.02", "--rays", "1000"];

fn fill(folder: &Path) {
    std::fs::write(folder.join("dark.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a file");
    std::fs::write(folder.join("bad.obj"), "v 0 0 0\nv 1 0 zero\n").expect("a file");
}

fn assert_refused(arguments: &[&str], words: &[&str]) {
    CONVERGENCE.assert_refused(fill, arguments, words);
}

/// A report of `scenes`, in its own folder.
fn report(scenes: &[&str], more: &[&str]) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    let arguments = [scenes, &SMALL, more].concat();
    let output = CONVERGENCE.run(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.path().join("convergence/report.md")).expect("a report");
    (folder, text)
}

#[test]
fn bad_input_is_one_line_that_names_it() {
    assert_refused(&["c4"], &["c4"]);
    assert_refused(&["none.obj"], &["none.obj"]);
    assert_refused(&["bad.obj"], &["bad.obj:2"]);
    assert_refused(&["dark.obj"], &["dark.obj", "no light", "--environment"]);
    assert_refused(&["corner", "corner"], &["two scenes", "corner"]);
    assert_refused(&["--spp", "12"], &["--spp 12", "power of two"]);
    assert_refused(&["--spp", "2"], &["--spp"]);
    assert_refused(&["--side", "7"], &["--side", "7"]);
    assert_refused(&["--time", "0"], &["seconds", "0"]);
    assert_refused(&["--threads", "2000"], &["threads", "2000"]);
    assert_refused(&["--accel", "wide,kd,wide"], &["--accel", "wide BVH", "twice"]);
    assert_refused(&["--out", "dark.obj"], &["dark.obj"]);
}

/// The seeds are fixed, and verdicts do not depend on times.
#[test]
fn only_the_combination_that_is_biased_on_purpose_is_found_biased() {
    let (folder, report) = report(&["corner", "cornell"], &["--accel", "wide", "--side", "64"]);
    let verdicts = |scene: &str| -> Vec<String> {
        let section = report.split("\n## ").find(|section| section.starts_with(scene)).expect("a section");
        let rows = section.lines().filter(|line| line.contains(" +- "));
        rows.map(str::to_owned).collect()
    };
    for (scene, biased) in [("corner", 0), ("cornell", 1)] {
        let verdicts = verdicts(scene);
        assert_eq!(verdicts.len(), 8, "{report}");
        let [unbiased @ .., truncated] = &verdicts[..] else { panic!("no rows") };
        assert!(unbiased.iter().all(|row| row.contains("no bias found")), "{scene}: {unbiased:#?}");
        assert_eq!(usize::from(truncated.contains("**biased**: the mean")), biased, "{scene}: {truncated}");
    }
    // The pictures in the report exist.
    let shown = report.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let shown: Vec<&str> = shown.collect();
    assert_eq!(shown.len(), 5, "{report}");
    for name in shown {
        let bytes = std::fs::read(folder.path().join("convergence").join(name)).expect(name);
        assert!(bytes.starts_with(b"<svg") || bytes.starts_with(b"\x89PNG"), "{name}");
    }
}

#[test]
fn a_file_is_measured_and_all_accelerators_have_one_hash() {
    let (folder, report) = report(&["dark.obj"], &["--environment", "1", "--side", "16"]);
    assert!(report.contains("## dark"), "{report}");
    // With path reuse, all pixels of a tile depend on each other.
    assert_eq!(report.matches("none: a single tile").count(), 1, "{report}");
    let csv = std::fs::read_to_string(folder.path().join("convergence/samples.csv")).expect("a table");
    let mut rows = csv::Reader::from_reader(csv.as_bytes());
    let rows: Vec<csv::StringRecord> = rows.records().map(|row| row.expect("a row")).collect();
    // Five numbers of samples: seven combinations with three accelerators, and one with one.
    assert_eq!(rows.len(), 5 * (7 * 3 + 1), "{csv}");
    let key = |row: &csv::StringRecord| [2, 3, 4].map(|column| row[column].to_owned());
    for row in &rows {
        let first = rows.iter().find(|other| key(other) == key(row)).expect("itself at least");
        assert_eq!(row.iter().next_back(), first.iter().next_back(), "{row:?}");
    }
}
