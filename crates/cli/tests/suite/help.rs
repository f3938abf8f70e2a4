//! Help, version, and what the program says to commands that it does not have.

use crate::GLOBILLUM;
use std::path::Path;

fn help(arguments: &[&str]) -> String {
    GLOBILLUM.succeed(Path::new("."), arguments)
}

#[test]
fn help_is_headed_by_what_the_program_does_and_ends_with_examples() {
    for (arguments, head) in [
        (&["--help"][..], "Renders pictures with global illumination"),
        (&["render", "--help"], "Renders a scene file"),
        (&["cornell", "--help"], "Renders a built-in scene"),
        (&["irradiance", "--help"], "Measures irradiance"),
        (&["merge", "--help"], "Joins checkpoints"),
        (&["plan", "--help"], "Divides a picture into tasks"),
        (&["task", "--help"], "Renders one task"),
        (&["status", "--help"], "Says how far a job is"),
        (&["view-factors", "--help"], "Computes view factors"),
        (&["diff", "--help"], "Tells whether two pictures"),
    ] {
        let said = help(arguments);
        assert!(said.starts_with(head), "{said}");
        let (_, examples) = said.split_once("\nExamples:\n").expect("there are examples");
        assert!(examples.lines().all(|line| line.starts_with("  ")), "{examples}");
        assert!(examples.contains("globillum "), "{examples}");
        for code in ["0   done", "1   permanent error", "3   incomplete", "75  temporary error"] {
            assert!(said.contains(code), "{code}");
        }
        let short = help(&[&arguments[..arguments.len() - 1], &["-h"]].concat());
        assert!(short.starts_with(head) && short.len() < said.len(), "{short}");
    }
}

#[test]
fn flags_are_grouped_and_in_the_terms_of_the_field() {
    for command in ["render", "cornell"] {
        let said = help(&[command, "--help"]);
        let headings =
            ["Scene:", "Picture:", "Sampling:", "When to stop:", "Checkpoints:", "Output:", "Speed (the"];
        let places = headings.map(|heading| said.find(&format!("\n{heading}")));
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
        for term in [
            "Samples per pixel",
            "next event estimation",
            "Russian roulette",
            "multiple importance sampling",
            "standard error",
            "[default: 512]",
            "[default: 64, or no limit",
        ] {
            assert!(said.contains(term), "{term}");
        }
        assert!(!said.to_lowercase().contains("lamp"));
    }
}

/// `an_error_can_be_asked_for` and its like of view factors test that it is so.
#[test]
fn help_says_that_a_missed_error_is_no_failure() {
    for command in ["render", "cornell", "irradiance", "view-factors"] {
        let said = help(&[command, "--help"]);
        let error = said.split("\n      --").find(|entry| entry.starts_with("error <E>"));
        let words: Vec<&str> = error.expect("there is such a flag").split_whitespace().collect();
        let error = words.join(" ");
        assert!(error.contains("before, it is done all the same, with exit code 0"), "{command}: {error}");
    }
}

/// An example that names a flag or a value that is not there would be refused.
#[test]
fn examples_can_be_parsed() {
    for command in
        ["render", "cornell", "irradiance", "merge", "plan", "task", "status", "view-factors", "diff"]
    {
        let said = help(&[command, "--help"]).replace("\\\n", " ");
        let (_, examples) = said.split_once("\nExamples:\n").expect("there are examples");
        for line in examples.lines().filter_map(|line| line.trim().strip_prefix("globillum ")) {
            // `plan` ends with the command of a picture.
            for part in line.split(" | ").next().unwrap_or(line).split(" -- ") {
                let arguments: Vec<&str> = part.split_whitespace().chain(["--help"]).collect();
                let heads = ["Renders", "Measures", "Joins", "Divides", "Says", "Computes", "Tells"];
                assert!(heads.iter().any(|head| help(&arguments).starts_with(head)), "{line}");
            }
        }
    }
}

#[test]
fn the_version_is_that_of_the_package() {
    assert_eq!(help(&["--version"]), format!("globillum {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn commands_that_are_not_there_are_named() {
    let refused = |arguments: &[&str], words: &[&str]| GLOBILLUM.assert_refused(|_| (), arguments, words);
    refused(
        &[],
        &[
            "a command is missing: render, cornell, irradiance, merge, plan, task, status, view-factors, diff, help; \
           see `globillum --help`",
        ],
    );
    refused(&["render", "."], &["error: .: is a folder, not a scene file\n"]);
    refused(
        &["view-factors", ".", "--patches", "object", "--out", "a.csv"],
        &["is a folder, not a scene file\n"],
    );
    refused(&["rendr"], &["unknown command rendr (a similar command exists: render)"]);
    refused(&["--sped"], &["unexpected argument --sped"]);
    refused(&["merge"], &["<CHECKPOINT>... is missing"]);
    refused(&["merge", "a"], &["neither --out nor --checkpoint is given"]);
    refused(&["render", "a.obj", "b.obj"], &["unexpected argument b.obj"]);
}
