//! Standard output: as a file, and when its reader goes away.

use crate::{CORNELL, GLOBILLUM, MERGE};
use globillum_testkit::program::names;
use std::process::{Output, Stdio};

const SMALL: [&str; 6] = ["--width", "16", "--height", "8", "--spp", "4"];

/// Runs a command whose standard output nobody reads.
fn run_unread(folder: &std::path::Path, arguments: &[&str]) -> Output {
    let (reader, writer) = std::io::pipe().expect("there are pipes");
    drop(reader);
    let mut command = GLOBILLUM.command(folder, arguments);
    let child = command.stdout(writer).stderr(Stdio::piped()).spawn().expect("the program starts");
    child.wait_with_output().expect("it ends")
}

#[test]
fn a_reader_that_goes_away_is_no_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let render = [&["cornell", "--out", "a.png", "--checkpoint", "a"], &SMALL[..]].concat();
    let merge = ["merge", "a", "--out", "b.png"];
    let unseen = [&["cornell", "--out", "-"], &SMALL[..]].concat();
    for arguments in [&["--help"][..], &["render", "-h"], &["--version"], &render, &merge, &unseen] {
        let output = run_unread(folder.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {said}");
        assert!(said.is_empty() || arguments == unseen, "{arguments:?}: {said}");
    }
    assert_eq!(names(folder.path()), ["a", "a.png", "b.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_is_full_is_an_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for arguments in [&["--help"][..], &[&["cornell"], &SMALL[..]].concat()] {
        let full = std::fs::File::options().write(true).open("/dev/full").expect("it is always there");
        let mut command = GLOBILLUM.command(folder.path(), arguments);
        let output = command.stdout(full).output().expect("the program starts");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(75), "{said}");
        assert!(said.starts_with("error: ") && said.lines().count() == 1, "{said}");
    }
}

/// Each file that can be written is, and each that cannot is named.
#[cfg(target_os = "linux")]
#[test]
fn a_file_that_cannot_be_written_does_not_keep_others_from_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    std::os::unix::fs::symlink("/dev/full", folder.join("full.png")).expect("an empty folder can be filled");
    let run = |arguments: &[&str]| {
        let output = GLOBILLUM.run(folder, arguments);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), said.lines().count()), (Some(75), 1), "{said}");
        (String::from_utf8_lossy(&output.stdout).into_owned(), said)
    };
    let render =
        [&["cornell", "--checkpoint", "a", "--out", "a.png", "--out", "full.png"], &SMALL[..]].concat();
    let (table, said) = run(&[&render[..], &["--out", "b.png", "--stats", "/dev/full"]].concat());
    assert!(said.starts_with("error: full.png: ") && said.contains("; /dev/full: "), "{said}");
    assert!(table.ends_with("picture       a.png\npicture       b.png\n"), "{table}");
    run(&["merge", "a", "--out", "full.png", "--out", "c.png"]);
    std::fs::write(folder.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("likewise");
    std::fs::write(folder.join("a.csv"), "0,0,1,0,0,1\n").expect("likewise");
    let measure = ["irradiance", "a.obj", "--environment", "1", "--points", "a.csv", "--samples", "16"];
    let (table, _) = run(&[&measure[..], &["--out", "/dev/full", "--stats", "a.json"]].concat());
    assert!(!table.contains("readings"), "{table}");
    let expected = ["a", "a.csv", "a.json", "a.obj", "a.png", "b.png", "c.png", "full.png"];
    assert_eq!(names(folder), expected);
}

#[test]
fn a_picture_or_figures_go_to_standard_output() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = |flags: &[&str]| {
        let output = CORNELL.run(folder.path(), &[&SMALL, flags].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success() && said.contains("ended by      all samples taken"), "{said}");
        output.stdout
    };
    let picture = run(&["--out", "a.png", "--out", "-", "--exposure", "1", "--checkpoint", "a"]);
    assert_eq!(std::fs::read(folder.path().join("a.png")).expect("it was written"), picture);
    assert!(picture.starts_with(b"\x89PNG"));
    let figures = run(&["--out", "a.png", "--stats", "-"]);
    let figures: serde_json::Value = serde_json::from_slice(&figures).expect("nothing but JSON");
    assert_eq!(figures["samples_per_pixel"], 4);
    let merged = MERGE.run(folder.path(), &["a", "--out", "-", "--exposure", "1"]);
    assert_eq!(merged.stdout, picture);
    assert!(String::from_utf8_lossy(&merged.stderr).contains("4 per pixel, passes 0..1"));
    assert_eq!(names(folder.path()), ["a", "a.png"]);
}

#[cfg(unix)]
#[test]
fn figures_are_written_through_to_a_fifo() {
    use std::io::Read;
    use std::os::unix::fs::FileTypeExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let fifo = folder.path().join("fifo");
    let made = std::process::Command::new("mkfifo").arg(&fifo).status().expect("there is a `mkfifo`");
    assert!(made.success());
    // Opened for both, a FIFO waits neither for a writer nor for a reader.
    let mut reader = std::fs::File::options().read(true).write(true).open(&fifo).expect("it is there");
    CORNELL.succeed(folder.path(), &[&SMALL[..], &["--out", "a.png", "--stats", "fifo"]].concat());
    assert!(std::fs::metadata(&fifo).expect("it is there").file_type().is_fifo(), "it was replaced");
    let mut figures = [0; 1 << 16];
    let length = reader.read(&mut figures).expect("it holds the figures");
    let figures: serde_json::Value = serde_json::from_slice(&figures[..length]).expect("it is JSON");
    assert_eq!(figures["samples_per_pixel"], 4);
}
