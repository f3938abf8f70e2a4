//! `globillum diff`: two pictures beside each other.

use crate::{CORNELL, GLOBILLUM};
use std::path::Path;
use std::process::Output;

const SMALL: [&str; 6] = ["--width", "32", "--height", "32", "--spp", "32"];

fn render(folder: &Path, out: &str, flags: &[&str]) {
    let pass: &[&str] = if flags.contains(&"--pass-spp") { &[] } else { &["--pass-spp", "4"] };
    CORNELL.succeed(folder, &[&SMALL[..], &["--out", out], pass, flags].concat());
}

fn diff(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = GLOBILLUM.run(folder, &[&["diff"], arguments].concat());
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    (status.code(), text(&stdout), text(&stderr))
}

#[test]
fn seeds_are_equal_and_another_scene_is_different() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    for seed in ["0", "1", "2", "3"] {
        render(folder, &format!("{seed}.exr"), &["--seed", seed]);
        let size = ["--width", "96", "--height", "96", "--spp", "16"];
        CORNELL
            .succeed(folder, &[&size[..], &["--seed", seed, "--out", &format!("large{seed}.exr")]].concat());
    }
    let few_tiles = diff(folder, &["0.exr", "1.exr", "--with", "2.exr", "3.exr"]);
    assert_eq!(few_tiles.0, Some(5), "{few_tiles:?}");
    for arguments in
        [&["0.exr", "1.exr"][..], &["large0.exr", "large1.exr", "--with", "large2.exr", "large3.exr"]]
    {
        let (code, said, warnings) = diff(folder, arguments);
        assert_eq!((code, warnings.as_str()), (Some(0), ""), "{said}");
        assert!(said.contains("verdict       no difference found: p = "), "{said}");
    }
    render(folder, "mirror.exr", &["--seed", "9", "--specular"]);
    let maps = ["--map", "z.png", "--block-map", "blocks.png"];
    let (code, said, error) = diff(folder, &[&["0.exr", "mirror.exr"], &maps[..]].concat());
    assert!(code == Some(4) && said.contains("verdict       different: p = "), "{said}");
    assert!(error.starts_with("error: different: by more than chance"), "{error}");
    for name in ["z.png", "blocks.png"] {
        let map = image::open(folder.join(name)).expect("a picture").into_rgb8();
        assert_eq!(map.dimensions(), (32, 32), "{name}");
        assert!(map.pixels().any(|pixel| pixel.0[0] == 255 && pixel.0[1] < 200), "{name}: is red somewhere");
    }
}

/// Files of another program are stood for by those of a single pass, which have no errors either.
#[test]
fn examples_that_write_a_map_show_something_in_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let said = GLOBILLUM.succeed(folder, &["diff", "--help"]);
    let (_, examples) = said.split_once("\nExamples:\n").expect("there are examples");
    let mut maps = 0;
    for line in examples.lines().filter_map(|line| line.trim().strip_prefix("globillum diff ")) {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let Some(map) = arguments.iter().find(|name| name.ends_with(".png")) else { continue };
        for (seed, name) in arguments.iter().filter(|name| name.ends_with(".exr")).enumerate() {
            let pass = if *name == "a.exr" { "4" } else { "32" };
            render(folder, name, &["--pass-spp", pass, "--seed", &seed.to_string()]);
        }
        let (code, _, error) = diff(folder, &arguments);
        assert!(matches!(code, Some(0 | 5)), "{line}: {error}");
        let picture = image::open(folder.join(map)).expect("a picture").into_rgb8();
        let first = picture.get_pixel(0, 0);
        assert!(picture.pixels().any(|pixel| pixel != first), "{line}: {map} is {first:?} everywhere");
        maps += 1;
    }
    assert!(maps > 0, "{examples}");
}

/// A file of another program may be such, and then a map shows nothing.
#[test]
fn maps_are_grey_beside_a_file_without_errors() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    render(folder, "a.exr", &[]);
    render(folder, "b.exr", &["--pass-spp", "32", "--seed", "1"]);
    diff(folder, &["a.exr", "b.exr", "--map", "z.png", "--block-map", "blocks.png"]);
    for name in ["z.png", "blocks.png"] {
        let map = image::open(folder.join(name)).expect("a picture").into_rgb8();
        assert!(map.pixels().all(|pixel| pixel.0 == [124; 3]), "{name}");
    }
}

/// A single pass tells no errors. A single tile then tells nothing, 256 of them do.
#[test]
fn small_pictures_without_errors_are_undecided() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    for (side, name) in [("16", "small"), ("64", "large")] {
        for seed in ["1", "2"] {
            let size = ["--width", side, "--height", side, "--spp", "4", "--pass-spp", "4"];
            let out = format!("{name}{seed}.exr");
            let reuse = if name == "small" { "tiles" } else { "off" };
            let flags = ["--path-reuse", reuse, "--seed", seed, "--out", &out];
            CORNELL.succeed(folder, &[&size[..], &flags].concat());
        }
    }
    let (code, said, error) = diff(folder, &["small1.exr", "small2.exr"]);
    assert_eq!(code, Some(5), "{said}{error}");
    assert!(said.contains("verdict       cannot tell: p = "), "{said}");
    assert!(
        error.starts_with("error: undecided: the picture beside black") && error.lines().count() == 1,
        "{error}"
    );
    let (code, said, error) = diff(folder, &["large1.exr", "large2.exr"]);
    assert_eq!((code, error.as_str()), (Some(0), ""), "{said}");
    assert!(said.contains("verdict       no difference found"), "{said}");
}

#[test]
fn the_same_seed_is_warned_of() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    // Enough independent blocks in a small picture.
    render(folder, "a.exr", &["--path-reuse", "off"]);
    let (code, said, warning) = diff(folder, &["a.exr", "a.exr"]);
    assert_eq!((code, warning.lines().count()), (Some(0), 1), "{warning}");
    assert!(warning.starts_with("warning: a.exr and a.exr: have the same seed"), "{warning}");
    assert!(said.contains("ratio         1.000000") && said.contains("differences are too small"), "{said}");
    // Pictures by other settings have the same random numbers.
    render(folder, "b.exr", &["--path-reuse", "off", "--estimator", "light"]);
    let (_, _, warning) = diff(folder, &["a.exr", "b.exr"]);
    assert!(warning.starts_with("warning: a.exr and b.exr: have the same seed"), "{warning}");
    render(folder, "c.exr", &["--path-reuse", "off", "--seed", "1"]);
    assert_eq!(diff(folder, &["a.exr", "c.exr"]).2, "");
}

#[test]
fn pictures_that_cannot_be_compared_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    render(folder, "a.exr", &[]);
    CORNELL.succeed(folder, &["--width", "33", "--height", "32", "--spp", "1", "--out", "wide.exr"]);
    for (name, crop) in [("left.exr", "0,0,16,32"), ("right.exr", "16,0,16,32")] {
        render(folder, name, &["--crop", crop]);
    }
    std::fs::write(folder.join("b.exr"), "no picture").expect("it can be written");
    for (arguments, message) in [
        (&["a.exr"][..], "--with is missing"),
        (&["a.exr", "none.exr"], "none.exr: cannot be read"),
        (&["a.exr", "b.exr"], "b.exr: "),
        (&["a.exr", "wide.exr"], "wide.exr: has 33 x 32 pixels, a.exr 32 x 32"),
        (
            &["left.exr", "right.exr"],
            "right.exr: shows the pixels from (16, 0) on of 32 x 32, left.exr from (0, 0) on of 32 x 32",
        ),
        (&["a.exr", "a.exr", "--false-alarm", "1"], "--false-alarm 1: must be a number above 0 and below 1"),
        (&["a.exr", "a.exr", "--map", "z.exr"], "z.exr: a map is a PNG"),
    ] {
        let (code, _, error) = diff(folder, arguments);
        assert!(code == Some(1) && error.starts_with(&format!("error: {message}")), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}
