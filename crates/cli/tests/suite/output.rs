//! Standard output: as a file, and when its reader goes away.

use crate::{CORNELL, GLOBILLUM, MERGE};
use globillum_testkit::program::names;
use std::path::Path;
use std::process::{Output, Stdio};

const SMALL: [&str; 6] = ["--width", "16", "--height", "8", "--spp", "4"];

/// Runs a command whose standard output nobody reads.
fn run_unread(folder: &Path, arguments: &[&str]) -> Output {
    let (reader, writer) = std::io::pipe().expect("there are pipes");
    drop(reader);
    let mut command = GLOBILLUM.command(folder, arguments);
    let child = command.stdout(writer).stderr(Stdio::piped()).spawn().expect("the program starts");
    child.wait_with_output().expect("it ends")
}

#[test]
fn a_reader_of_tables_that_goes_away_is_no_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let render = [&["cornell", "--out", "a.png", "--checkpoint", "a"], &SMALL[..]].concat();
    let merge = ["merge", "a", "--out", "b.png"];
    for arguments in [&["--help"][..], &["render", "-h"], &["--version"], &render, &merge] {
        let output = run_unread(folder.path(), arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {said}");
        assert!(said.is_empty(), "{arguments:?}: {said}");
    }
    assert_eq!(names(folder.path()), ["a", "a.png", "b.png"]);
}

/// Other files are written all the same.
#[test]
fn data_whose_reader_goes_away_is_an_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    std::fs::write(folder.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("an empty folder");
    std::fs::write(folder.join("a.csv"), "0,0,1,0,0,1\n").expect("likewise");
    let picture = [&["cornell", "--out", "-", "--out", "a.png", "--checkpoint", "a"], &SMALL[..]].concat();
    let figures = [&["cornell", "--stats", "-", "--out", "b.png"], &SMALL[..]].concat();
    let readings =
        ["irradiance", "a.obj", "--environment", "1", "--points", "a.csv", "--spp", "16", "--out", "-"];
    let merged = ["merge", "a", "--out", "-"];
    for arguments in [&picture[..], &figures, &readings, &merged] {
        let output = run_unread(folder, arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(141), "{arguments:?}: {said}");
        let errors = said.lines().filter(|line| line.starts_with("error: ")).collect::<Vec<_>>();
        assert!(
            errors.len() == 1 && errors[0].contains("standard output was closed before all data"),
            "{said}"
        );
    }
    assert_eq!(names(folder), ["a", "a.csv", "a.obj", "a.png", "b.png"]);
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

/// A folder whose files must not change.
fn fill(folder: &Path) {
    let names = ["a.obj", "a.csv", "a.part", "a.exr", "job.json"];
    names.iter().for_each(|name| std::fs::write(folder.join(name), name).expect("an empty folder"));
    std::fs::create_dir(folder.join("sub")).expect("likewise");
    std::fs::create_dir(folder.join("job.parts")).expect("likewise");
}

#[test]
fn a_file_has_one_use() {
    let refused = |arguments: &[&str], uses: &str| {
        let said = format!("error: {uses} are the same file");
        GLOBILLUM.assert_refused(fill, arguments, &[&said]);
    };
    let out = ["--out", "z.exr"];
    let cornell = |flags: &[&str], uses: &str| refused(&[&["cornell"], &out[..], flags].concat(), uses);
    cornell(&["--checkpoint", "z.exr"], "--out z.exr and --checkpoint z.exr");
    cornell(&["--stats", "./z.exr"], "--out z.exr and --stats ./z.exr");
    cornell(&["--out", "sub/../z.exr"], "--out z.exr and --out sub/../z.exr");
    cornell(&["--mesh", "a.obj", "--stats", "a.obj"], "--mesh a.obj and --stats a.obj");
    refused(&["cornell", "--checkpoint", "cornell.png"], "--out cornell.png and --checkpoint cornell.png");
    refused(&["render", "a.obj", "--stats", "sub/../a.obj"], "the scene a.obj and --stats sub/../a.obj");
    let measure = ["irradiance", "a.obj", "--points", "a.csv"];
    let measure = |flags: &[&str], uses: &str| refused(&[&measure, flags].concat(), uses);
    measure(&["--out", "a.csv"], "--points a.csv and --out a.csv");
    measure(&["--checkpoint", "irradiance.csv"], "--out irradiance.csv and --checkpoint irradiance.csv");
    measure(&["--stats", "a.obj"], "the scene a.obj and --stats a.obj");
    let factors = ["view-factors", "a.obj", "--patches", "material", "--out", "z.csv", "--checkpoint"];
    refused(&[&factors[..], &["z.csv"]].concat(), "--out z.csv and --checkpoint z.csv");
    refused(&[&factors[..], &["a.obj"]].concat(), "the scene a.obj and --checkpoint a.obj");
    let merge = |flags: &[&str], uses: &str| refused(&[&["merge", "a.part"], flags].concat(), uses);
    merge(&["--out", "z.exr", "--checkpoint", "z.exr"], "--out z.exr and --checkpoint z.exr");
    merge(&["a.exr", "--out", "a.exr"], "--out a.exr and the part a.exr");
    merge(
        &["--expect", "job.json", "--checkpoint", "job.json"],
        "--expect job.json and --checkpoint job.json",
    );
    let maps = ["diff", "a.exr", "a.exr", "--map", "z.png", "--block-map", "z.png"];
    refused(&maps, "--map z.png and --block-map z.png");
    refused(&["plan", "z.parts", "--", "cornell"], "the job z.parts and the folder of its parts z.parts");
}

/// The files that a scene refers to are known when it is loaded.
#[test]
fn no_file_of_a_scene_is_written() {
    let fill = |folder: &Path| {
        let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
        let library = "newmtl a\nKd 0.5 0.5 0.5\nKe 1 1 1\n";
        let scene = |library: &str| format!("mtllib {library}\n{mesh}");
        let files =
            [("a.obj", scene("a.mtl")), ("b.obj", scene("b.csv")), ("points", "0,0,1,0,0,-1\n".into())];
        let libraries = ["a.mtl", "b.csv"].map(|name| (name, library.into()));
        let write =
            |(name, text): (&str, String)| std::fs::write(folder.join(name), text).expect("an empty folder");
        files.into_iter().chain(libraries).for_each(write);
    };
    let refused = |arguments: &[&str], uses: &str| {
        let said = format!("error: the scene's file {uses} are the same file");
        GLOBILLUM.assert_refused(fill, arguments, &[&said]);
    };
    refused(&["render", "a.obj", "--stats", "a.mtl"], "a.mtl and --stats a.mtl");
    refused(&["cornell", "--scene", "1", "--mesh", "a.obj", "--stats", "a.mtl"], "a.mtl and --stats a.mtl");
    let measure = ["irradiance", "a.obj", "--points", "points", "--out", "a.mtl"];
    refused(&measure, "a.mtl and --out a.mtl");
    let factors = ["view-factors", "b.obj", "--patches", "material", "--out", "b.csv"];
    refused(&factors, "b.csv and --out b.csv");
}

#[test]
fn files_that_cannot_hold_what_they_are_for_are_refused() {
    let refused = |arguments: &[&str], said: &str| GLOBILLUM.assert_refused(fill, arguments, &[said]);
    let no_file = "error: --checkpoint -: a checkpoint needs a file";
    refused(&["cornell", "--checkpoint", "-"], no_file);
    refused(&["merge", "a.part", "--checkpoint", "-"], no_file);
    let no_buffers = "error: --buffers: only OpenEXR pictures hold them; --out names none";
    refused(&["cornell", "--buffers", "--out", "z.png"], no_buffers);
    refused(
        &["cornell", "--out", "none/z.png"],
        "error: none/z.png: cannot be written: its folder does not exist",
    );
    refused(&["status", "job.json"], "error: job.json: is no job file: expected value at line 1 column 1");
    refused(&["diff", "a.exr", "a.exr"], "error: a.exr: is no OpenEXR picture");
}

/// Figures have a replacement character for each byte that is no text.
#[cfg(target_os = "linux")]
#[test]
fn names_of_files_may_be_no_text() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let names = [OsStr::from_bytes(b"a\xff.png"), OsStr::from_bytes(b"a\xff.part")];
    let mut command =
        GLOBILLUM.command(folder.path(), &[&["cornell", "--stats", "a.json"], &SMALL[..]].concat());
    let output = command.args([OsStr::new("--out"), names[0], OsStr::new("--checkpoint"), names[1]]).output();
    assert!(output.expect("the program starts").status.success());
    let figures = std::fs::read(folder.path().join("a.json")).expect("it was written");
    let figures: serde_json::Value = serde_json::from_slice(&figures).expect("it is JSON");
    assert_eq!(
        (&figures["out"][0], &figures["checkpoint"]),
        (&"a\u{fffd}.png".into(), &"a\u{fffd}.part".into())
    );
}

/// Links lead to the file that is replaced, also if it does not exist yet.
#[cfg(unix)]
#[test]
fn links_are_the_file_that_they_lead_to() {
    use std::os::unix::fs::symlink;
    let refused = |arguments: &[&str], uses: &str| {
        let fill = |folder: &Path| {
            fill(folder);
            let links = [("z.exr", "new.exr"), ("a.exr", "old.png")];
            links.iter().for_each(|(to, link)| symlink(to, folder.join(link)).expect("nothing is there"));
            symlink("sub", folder.join("link")).expect("likewise");
        };
        GLOBILLUM.assert_refused(fill, arguments, &[&format!("error: {uses} are the same file")]);
    };
    refused(&["cornell", "--out", "new.exr", "--out", "z.exr"], "--out new.exr and --out z.exr");
    refused(
        &["cornell", "--out", "sub/z.exr", "--out", "link/z.exr"],
        "--out sub/z.exr and --out link/z.exr",
    );
    refused(&["diff", "a.exr", "a.exr", "--map", "old.png"], "the picture a.exr and --map old.png");
    let job = serde_json::json!({"version": "", "key": "0", "picture": [], "samples": 1, "camera": null, "tasks": 1,
        "division": {"height": 16, "first_pass": 0, "end_pass": 1, "task_passes": 1, "task_rows": 16}});
    let fill = |folder: &Path| {
        std::fs::create_dir(folder.join("b.parts")).expect("an empty folder");
        std::fs::write(folder.join("b.json"), job.to_string()).expect("likewise");
        symlink("../b.json", folder.join("b.parts/task-000000.part")).expect("likewise");
    };
    let uses = "the job b.json and the part b.parts/task-000000.part are the same file";
    GLOBILLUM.assert_refused(fill, &["task", "b.json", "--index", "0"], &[uses]);
}

#[test]
fn a_checkpoint_is_continued_in_its_own_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let render = [&["--out", "a.png", "--checkpoint", "a", "--resume"], &SMALL[..]].concat();
    (0..2).for_each(|_| drop(CORNELL.succeed(folder, &render)));
    MERGE.succeed(folder, &["a", "./a", "--checkpoint", "a", "--out", "b.png"]);
    assert_eq!(names(folder), ["a", "a.png", "b.png"]);
}

/// What is written through keeps what was written before.
#[cfg(target_os = "linux")]
#[test]
fn special_files_may_have_several_uses() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    std::os::unix::fs::symlink("/dev/null", folder.join("null.png")).expect("an empty folder can be filled");
    std::os::unix::fs::symlink("/dev/stdout", folder.join("out.png")).expect("likewise");
    let arguments =
        [&["--out", "null.png", "--out", "null.png", "--stats", "/dev/null"], &SMALL[..]].concat();
    CORNELL.succeed(folder, &arguments);
    let arguments =
        [&["--out", "out.png", "--out", "out.png", "--stats", "/dev/stdout"], &SMALL[..]].concat();
    assert!(CORNELL.run(folder, &arguments).status.success());
    let file = std::fs::File::create(folder.join("log")).expect("likewise");
    let status = CORNELL.command(folder, &arguments).stdout(file).status().expect("the program starts");
    assert!(status.success(), "standard output is a file");
}
