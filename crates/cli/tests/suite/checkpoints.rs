//! Checkpoints: parts of a picture, merged, resumed, and renders that are killed.

use crate::{CORNELL, GLOBILLUM, MERGE};
use globillum::io::PictureData;
use globillum_testkit::program::names;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

const SMALL: [&str; 8] = ["--width", "32", "--height", "24", "--pass-spp", "2", "--out", "a.exr"];

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn parts_of_a_picture_are_merged_to_the_whole() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let render = |arguments: &[&str]| CORNELL.succeed(folder, &[&SMALL[..], arguments].concat());
    render(&["--spp", "12", "--checkpoint", "whole"]);
    let data = |name: &str| PictureData::read(folder.join(name)).expect("a picture");
    let whole = data("a.exr");
    for (part, passes) in [("1", "0..3"), ("2", "3..4"), ("3", "4..6")] {
        render(&["--passes", passes, "--checkpoint", part]);
    }
    let said = MERGE.succeed(folder, &["2", "3", "1", "--out", "b.exr", "--checkpoint", "all"]);
    assert!(said.contains("12 per pixel, passes 0..6") && said.contains("error "), "{said}");
    let merged = data("b.exr");
    assert!(merged.estimates == whole.estimates, "means, errors and samples have the same bits");
    for (name, value) in &merged.attributes {
        assert_eq!(whole.attributes.get(name), Some(value), "{name}");
    }
    assert_eq!(merged.attributes.keys().collect::<Vec<_>>(), ["key", "passes", "path_reuse", "samples"]);
    assert_eq!(read(folder, "all"), read(folder, "whole"));
    MERGE.succeed(folder, &["2", "3", "1", "2", "--checkpoint", "twice"]);
    assert_eq!(read(folder, "twice"), read(folder, "whole"), "equal parts count once");
    render(&["--crop", "20,17,5,4", "--spp", "12", "--checkpoint", "crop"]);
    MERGE.succeed(folder, &["crop", "--out", "b.exr"]);
    assert!(data("b.exr").estimates == whole.estimates.crop(16..32, 16..24), "tiles around the crop");
    assert!(data("a.exr").estimates == whole.estimates.crop(20..25, 17..21), "the crop");
    MERGE.succeed(folder, &["1", "2", "--checkpoint", "12"]);
    MERGE.succeed(folder, &["2", "3", "--checkpoint", "23"]);
    let [second, first, neither] = [
        "error: whole holds passes 0..6, and 3 passes 4..6; the first holds all of the second: leave 3 out\n",
        "error: 1 holds passes 0..3, and 12 passes 0..4; the second holds all of the first: leave 1 out\n",
        "error: 12 holds passes 0..4, and 23 passes 3..6; these overlap: leave one of the two out\n",
    ];
    for (parts, message) in [
        (["whole", "3"], second),
        (["1", "12"], first),
        (["12", "23"], neither),
        (["1", "a.exr"], "a.exr: is not a checkpoint"),
    ] {
        let output = MERGE.run(folder, &[&parts[..], &["--out", "c.png"]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.code() == Some(1) && said.contains(message), "{said}");
    }
    render(&["--seed", "1", "--passes", "0..1", "--checkpoint", "4"]);
    let output = MERGE.run(folder, &["1", "4", "--out", "c.png"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("4: belongs to another picture"));
}

/// A merge replaces a file of which it holds everything, and no other.
#[test]
fn a_merge_replaces_only_what_it_holds() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let render = |arguments: &[&str]| CORNELL.succeed(folder, &[&SMALL[..], arguments].concat());
    for (part, passes) in [("1", "0..2"), ("2", "2..4"), ("3", "4..6")] {
        render(&["--passes", passes, "--checkpoint", part]);
    }
    render(&["--passes", "0..2", "--seed", "1", "--checkpoint", "other"]);
    std::fs::write(folder.join("text"), "kept").expect("it can be written");
    let merge = |arguments: &[&str]| MERGE.succeed(folder, arguments);
    let refused = |arguments: &[&str], reason: &str| {
        let (file, before) = (arguments[arguments.len() - 1], names(folder));
        let bytes = read(folder, file);
        let output = MERGE.run(folder, &[arguments, &["--out", "b.png"]].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        let expected =
            format!("error: {file}: exists already and {reason}, or give --checkpoint another name\n");
        assert_eq!((output.status.code(), &*said), (Some(1), expected.as_str()));
        assert!(read(folder, file) == bytes && names(folder) == before, "{file} is replaced");
    };
    merge(&["1", "2", "--checkpoint", "all"]);
    refused(
        &["3", "--checkpoint", "all"],
        "holds passes 0..4, some of which the parts lack; join it with them, move it away",
    );
    refused(
        &["2", "3", "--checkpoint", "all"],
        "holds passes 0..4, some of which the parts lack; join it with them, move it away",
    );
    refused(&["1", "--checkpoint", "text"], "is not a checkpoint; move it away");
    refused(
        &["1", "--checkpoint", "other"],
        "belongs to another picture: the scene, camera, settings or build differs; move it away",
    );
    // A last pass that is cut short has the number of a whole one.
    render(&["--passes", "0..6", "--spp", "11", "--checkpoint", "cut"]);
    render(&["--spp", "12", "--checkpoint", "whole"]);
    refused(
        &["cut", "--checkpoint", "whole"],
        "holds passes 0..6, some of which the parts lack; join it with them, move it away",
    );
    merge(&["3", "all", "--checkpoint", "all"]);
    merge(&["1", "2", "3", "--checkpoint", "again"]);
    assert_eq!(read(folder, "all"), read(folder, "again"));
    merge(&["1", "--checkpoint", "few"]);
    merge(&["3", "2", "1", "--checkpoint", "few"]);
    assert_eq!(read(folder, "all"), read(folder, "few"), "what it held is in it");
}

/// The message names the checkpoint, and says what is wrong with it.
#[test]
fn what_cannot_be_continued_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let render = |spp: &'static str, resume: &[&'static str]| {
        let save = ["--pass-spp", "16", "--spp", spp, "--checkpoint", "cut.film"];
        CORNELL.run(folder.path(), &[&["--width", "16", "--height", "16"], &save[..], resume].concat())
    };
    assert!(render("40", &[]).status.success());
    for (spp, reason) in [
        ("64", "cut.film: cannot be continued: its last pass is incomplete"),
        ("32", "cut.film: holds more samples"),
    ] {
        let output = render(spp, &["--resume"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && said.contains(reason), "{said}");
    }
}

#[test]
fn an_error_can_be_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (pilot, reason) in
        [(&[][..], "the error reached"), (&["--pilot", "4"], "the samples that the pilot asked for")]
    {
        let said = CORNELL.succeed(folder.path(), &[&SMALL[..], &["--error", "0.3"], pilot].concat());
        assert!(said.contains(&format!("ended by      {reason}\n")), "{said}");
    }
    let said =
        CORNELL.succeed(folder.path(), &[&SMALL[..], &["--seconds", "0.2", "--error", "1e-9"]].concat());
    assert!(said.contains("ended by      the time given\n"), "{said}");
    let missed = ["--spp", "4", "--error", "1e-9", "--stats", "a.json"];
    let said = CORNELL.succeed(folder.path(), &[&SMALL[..], &missed].concat());
    let expected = "ended by      all samples taken; the error asked for was not reached\n";
    assert!(said.contains(expected), "{said}");
    let figures: serde_json::Value =
        serde_json::from_slice(&read(folder.path(), "a.json")).expect("it is JSON");
    assert_eq!(figures["ended_by"], "all samples taken");
}

/// A run that finds nothing left to do traces nothing, however much its picture holds.
#[test]
fn rates_are_those_of_the_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let render = |flags: &[&str]| {
        CORNELL.succeed(folder.path(), &[&SMALL[..], &["--spp", "8", "--checkpoint", "all"], flags].concat())
    };
    let idle = "0.00 million samples and 0.00 million rays a second";
    assert!(!render(&[]).contains(idle));
    let said = render(&["--resume"]);
    assert!(said.contains(idle) && said.contains("samples       8 per pixel, 0.01 million in all"), "{said}");
}

/// However short the time: before the first pass of a run nothing is known of how long one takes.
#[test]
fn a_resumed_render_adds_at_least_one_pass() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = ["--width", "256", "--height", "256", "--pass-spp", "1", "--checkpoint", "all"];
    let render = |flags: &[&str]| CORNELL.succeed(folder.path(), &[&size[..], flags].concat());
    render(&["--spp", "1"]);
    let said = render(&["--spp", "100000", "--resume", "--seconds", "1e-6"]);
    assert!(said.contains("samples       2 per pixel"), "{said}");
}

/// A render that is killed a hundred times and resumed each time has the bits of one that was not.
#[test]
fn a_render_survives_being_killed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let flags = ["--spp", "1000", "--threads", "1", "--checkpoint"];
    CORNELL.succeed(folder, &[&SMALL[..], &flags, &["whole"]].concat());
    let resume = [&SMALL[..], &flags, &["parts", "--resume", "--save-every", "0"]].concat();
    for i in 0..100 {
        let mut command = CORNELL.command(folder, &resume);
        let mut child = command.stdout(Stdio::null()).spawn().expect("the program starts");
        std::thread::sleep(Duration::from_millis(10 + 37 * i % 29));
        child.kill().expect("it is our own");
        child.wait().expect("it is our own");
    }
    assert!(folder.join("parts").exists(), "none came as far as a first checkpoint");
    CORNELL.succeed(folder, &resume);
    assert_eq!(read(folder, "parts"), read(folder, "whole"));
    assert_eq!(names(folder), ["a.exr", "parts", "whole"], "what the killed ones left is gone");
}

/// Runs a command in a shell where no file may be longer than 16 blocks, which stands for a disk that fills up.
#[cfg(unix)]
fn run_limited(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let limit = "trap '' XFSZ; ulimit -f 16; exec \"$@\"";
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", limit, "sh", GLOBILLUM.path]).args(arguments).current_dir(folder);
    let output = shell.output().expect("there is a shell");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

/// A save that fails ends the render after its pass; what else can be written is.
#[cfg(unix)]
#[test]
fn pictures_are_written_if_the_checkpoint_cannot_be() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let size = ["cornell", "--width", "48", "--height", "48", "--pass-spp", "2", "--spp", "100000"];
    let files = ["--out", "a.png", "--out", "b.exr", "--out", "c.png", "--stats", "d.json"];
    let save = ["--checkpoint", "film", "--save-every", "0"];
    let (code, said, error) = run_limited(folder, &[&size[..], &files, &save].concat());
    assert_eq!((code, error.lines().count()), (Some(1), 1), "{error}");
    assert!(error.starts_with("error: film: can") && error.contains("; b.exr: can"), "{error}");
    assert_eq!(names(folder), ["a.png", "c.png", "d.json"]);
    assert!(said.contains("picture       a.png\npicture       c.png\n") && !said.contains("b.exr"), "{said}");
    let figures: serde_json::Value = serde_json::from_slice(&read(folder, "d.json")).expect("it is JSON");
    assert_eq!(figures["ended_by"], "a failed checkpoint");
    assert_eq!(figures["samples_per_pixel"], 2);
}

/// The same of factors.
#[cfg(unix)]
#[test]
fn factors_are_written_if_the_checkpoint_cannot_be() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let triangle = |i| format!("v {i} 0 0\nv {i} 1 0\nv {i} 0 1\nf -3 -2 -1\n");
    let scene: String = (0..400).map(triangle).collect();
    std::fs::write(folder.join("a.obj"), scene).expect("an empty folder can be filled");
    // What is written through has no length.
    std::os::unix::fs::symlink("/dev/null", folder.join("a.mtx")).expect("likewise");
    let run = ["view-factors", "a.obj", "--patches", "triangle", "--two-sided", "--rays", "1000000"];
    let files = ["--out", "a.mtx", "--checkpoint", "film", "--save-every", "0"];
    let (code, said, error) = run_limited(folder, &[&run[..], &files].concat());
    assert_eq!((code, error.lines().count()), (Some(1), 1), "{error}");
    assert!(error.starts_with("error: film: can"), "{error}");
    assert!(said.contains("ended by      a failed checkpoint\nfactors       a.mtx\n"), "{said}");
    assert_eq!(names(folder), ["a.mtx", "a.obj"]);
}
