//! `globillum view-factors`: its files, its checkpoint, and what it refuses.

use crate::PATH;
use globillum_testkit::program::{Program, names};
use std::path::Path;

const VIEW_FACTORS: Program = Program { path: PATH, first: &["view-factors"] };

/// Two squares that face each other, and a third object without area.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    o floor\nf 1 2 3 4\no lid, closed\nf 5 8 7 6\n";

fn fill(folder: &Path) {
    std::fs::write(folder.join("a.obj"), OBJ).expect("it can be written");
    std::fs::write(folder.join("flat.obj"), format!("{OBJ}o line\nf 1 2 2\n")).expect("it can be written");
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fill(folder.path());
    folder
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).expect("it was written")
}

#[test]
fn factors_between_objects_materials_and_triangles() {
    let folder = folder();
    let folder = folder.path();
    let run = |arguments: &[&str]| {
        VIEW_FACTORS.succeed(folder, &[&["a.obj", "--rays", "4096"], arguments].concat())
    };
    let said = run(&["--patches", "object", "--out", "a.csv"]);
    assert!(said.contains("patches       2\nrays          4096 of each patch in 16 passes"), "{said}");
    assert!(
        said.contains("\nrow sums      1 exactly\n") && said.contains("\nended by      rays\n"),
        "{said}"
    );
    let csv = read(folder, "a.csv");
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.rsplitn(4, ',').collect()).collect();
    let heads: Vec<&str> = lines.iter().map(|line| line[3]).collect();
    let lid = "\"lid, closed\"";
    let expected = [
        "from,to,area",
        &format!("floor,{lid},1"),
        "floor,surroundings,1",
        &format!("{lid},floor,1"),
        &format!("{lid},surroundings,1"),
    ];
    assert_eq!(heads, expected);
    let factor: f64 = lines[1][2].parse().expect("a number");
    assert!((factor - 0.2).abs() < 0.03, "{csv}");
    run(&["--patches", "material", "--out", "a.mtx"]);
    assert!(read(folder, "a.mtx").contains("\n% 1 2 material 0\n1 3 2\n1 1 "), "{}", read(folder, "a.mtx"));
    run(&["--patches", "triangle", "--out", "a.mtx", "--omit-below", "0.5"]);
    assert!(read(folder, "a.mtx").contains("\n4 6 4\n1 5 "), "{}", read(folder, "a.mtx"));
    let said = run(&["--patches", "object", "--out", "a.csv", "--reciprocity", "--two-sided"]);
    assert!(said.contains("\nrow sums      1 within "), "{said}");
    let accelerators: Vec<String> = ["wide", "kd", "grid", "brute"]
        .map(|accel| {
            run(&["--patches", "object", "--out", "b.csv", "--accel", accel, "--threads", "2"]);
            read(folder, "b.csv")
        })
        .into();
    assert!(accelerators.iter().all(|bytes| *bytes == csv));
}

/// Objects that are called as targets that are no patches get other names, which no object has.
#[test]
fn reserved_names_are_no_patches() {
    let folder = folder();
    let folder = folder.path();
    let square =
        |name: &str, z: f32| format!("o {name}\nv 0 0 {z}\nv 1 0 {z}\nv 1 1 {z}\nv 0 1 {z}\nf -4 -3 -2 -1\n");
    let scene = ["back", "surroundings", "object back"].map(|name| square(name, name.len() as f32));
    std::fs::write(folder.join("a.obj"), scene.concat()).expect("it can be written");
    let output =
        VIEW_FACTORS.run(folder, &["a.obj", "--patches", "object", "--rays", "4096", "--out", "a.CSV"]);
    let said = String::from_utf8_lossy(&output.stderr);
    let expected = "warning: object `surroundings` is written as `object surroundings`: `surroundings` is another target\n\
                    warning: object `back` is written as `object object back`: `back` is another target\n";
    assert_eq!((output.status.code(), &*said), (Some(0), expected));
    let csv = read(folder, "a.CSV");
    let from: Vec<&str> = csv.lines().filter_map(|line| line.split(',').next()).collect();
    let patches = ["object object back", "object surroundings", "object back"];
    assert!(from[1..].iter().all(|name| patches.contains(name)), "{csv}");
    assert!(csv.contains("\nobject object back,back,1,") && csv.contains("back,surroundings,1,"), "{csv}");
}

#[test]
fn a_checkpoint_is_continued_and_foreign_ones_are_refused() {
    let folder = folder();
    let folder = folder.path();
    let run = |rays: &str, more: &[&str]| {
        let always = ["a.obj", "--patches", "object", "--rays", rays];
        VIEW_FACTORS.succeed(folder, &[&always, more].concat())
    };
    run("131072", &["--out", "whole.csv"]);
    run("65536", &["--out", "part.csv", "--checkpoint", "part"]);
    run("131072", &["--out", "resumed.csv", "--checkpoint", "part", "--resume"]);
    assert_eq!(read(folder, "whole.csv"), read(folder, "resumed.csv"));
    let said = run("1000000", &["--out", "goal.csv", "--error", "0.02"]);
    assert!(said.contains("ended by      the error asked for\n"), "{said}");
    let said = run("4096", &["--out", "goal.csv", "--error", "1e-9"]);
    assert!(said.contains("ended by      rays; the error asked for was not reached\n"), "{said}");
    assert_eq!(
        names(folder),
        ["a.obj", "flat.obj", "goal.csv", "part", "part.csv", "resumed.csv", "whole.csv"]
    );
    let part = std::fs::read(folder.join("part")).expect("a checkpoint");
    let with_part = |folder: &Path| {
        fill(folder);
        std::fs::write(folder.join("part"), &part).expect("it can be written");
    };
    let refused =
        |arguments: &[&str], words: &[&str]| VIEW_FACTORS.assert_refused(with_part, arguments, words);
    let always = ["a.obj", "--patches", "object", "--out", "a.csv", "--checkpoint", "part"];
    refused(&always, &["part: exists already; --resume continues from it"]);
    let other = [&always[..], &["--resume", "--seed", "1"]].concat();
    refused(&other, &["part: belongs to other view factors"]);
}

#[cfg(unix)]
#[test]
fn a_signal_keeps_complete_passes() {
    let folder = folder();
    let folder = folder.path();
    let arguments =
        ["a.obj", "--patches", "object", "--error", "1e-12", "--out", "a.csv", "--checkpoint", "part"];
    let arguments = [&arguments[..], &["--save-every", "0"]].concat();
    let mut command = VIEW_FACTORS.command(folder, &arguments);
    let mut child = command
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("it starts");
    while !folder.join("part").exists() {
        assert_eq!(child.try_wait().expect("it is our own"), None, "it ended before the first pass");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let status = std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    assert!(status.expect("there is a `kill`").success());
    let output = child.wait_with_output().expect("it is our own");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(143), "{said}");
    assert!(said.starts_with("interrupted: complete passes are kept, "), "{said}");
    assert!(read(folder, "a.csv").starts_with("from,to,area,factor,std_err,hits\n"));
    assert_eq!(names(folder), ["a.csv", "a.obj", "flat.obj", "part"]);
}

#[test]
fn bad_input_is_one_line() {
    let refused = |arguments: &[&str], words: &[&str]| VIEW_FACTORS.assert_refused(fill, arguments, words);
    let out = ["--out", "a.csv"];
    refused(&["a.obj", "--patches", "object", "--out", "a.txt"], &["--out a.txt: must end in .csv or .mtx"]);
    refused(
        &[&["a.obj", "--patches", "wall"], &out[..]].concat(),
        &["--patches wall: must be one of material, object, triangle"],
    );
    refused(&[&["none.obj", "--patches", "triangle"], &out[..]].concat(), &["none.obj"]);
    refused(
        &[&["a.obj", "--patches", "triangle", "--at-least", "2"], &out[..]].concat(),
        &["--at-least 2: must be a number from 0 to 1"],
    );
    refused(
        &[&["a.obj", "--patches", "triangle", "--omit-below", "2"], &out[..]].concat(),
        &["--omit-below 2: must be a number from 0 to 1"],
    );
    refused(
        &[&["a.obj", "--patches", "object", "--error", "0.5", "--at-least", "0.9"], &out[..]].concat(),
        &["--at-least 0.9: no factor is as large; they are 0.8"],
    );
    // The loader has warned of its degenerate triangle.
    let folder = folder();
    let arguments = [&["flat.obj", "--patches", "object"], &out[..]].concat();
    let output = VIEW_FACTORS.run(folder.path(), &arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.ends_with("\nerror: flat.obj: patch `line` has no triangle with an area\n"), "{said}");
    assert_eq!(names(folder.path()), ["a.obj", "flat.obj"]);
}
