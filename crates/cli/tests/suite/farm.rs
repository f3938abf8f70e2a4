//! A picture that is rendered by the tasks of a farm.

use crate::{CORNELL, GLOBILLUM, MERGE};
use globillum_testkit::program::names;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const PICTURE: [&str; 8] = ["cornell", "--width", "24", "--height", "40", "--pass-spp", "1", "--spp"];

fn plan(folder: &Path, job: &str, flags: &[&str], spp: &str) -> String {
    GLOBILLUM.succeed(folder, &[&["plan", job], flags, &["--"], &PICTURE[..], &[spp]].concat())
}

fn task(folder: &Path, index: u32) -> Command {
    let mut command = GLOBILLUM.command(folder, &["task", "job.json", "--index", &index.to_string()]);
    command.env_remove("SLURM_ARRAY_TASK_ID").env_remove("SLURM_CPUS_PER_TASK");
    command
}

fn run(command: &mut Command) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = command.output().expect("the program starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (status.code(), text(&stdout), text(&stderr))
}

fn run_task(folder: &Path, index: u32) -> String {
    let (code, said, error) = run(&mut task(folder, index));
    assert_eq!(code, Some(0), "{error}");
    said + &error
}

fn status(folder: &Path) -> (Option<i32>, String) {
    let (code, said, _) = run(&mut GLOBILLUM.command(folder, &["status", "job.json"]));
    (code, said)
}

/// The exit code and the error of a merge.
fn merge(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let (code, _, error) = run(&mut MERGE.command(folder, arguments));
    (code, error)
}

fn part(folder: &Path, index: u32) -> std::path::PathBuf {
    folder.join(format!("job.parts/task-{index:06}.part"))
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A job of 12 tasks, four ranges of passes of three strips, of which all are rendered.
fn rendered() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let said = plan(folder.path(), "job.json", &["--tasks", "12"], "4");
    assert!(said.contains("tasks         12\n") && said.contains("array         0-11, offset 0\n"), "{said}");
    (0..12).for_each(|index| assert!(run_task(folder.path(), index).contains("is complete")));
    folder
}

#[test]
fn tasks_have_the_bytes_of_one_run() {
    let folder = rendered();
    let folder = folder.path();
    CORNELL
        .succeed(folder, &[&PICTURE[1..], &["4", "--out", "one.exr", "--checkpoint", "one.film"]].concat());
    let said = MERGE.succeed(folder, &["--expect", "job.json", "--out", "a.exr", "--checkpoint", "a.film"]);
    assert!(said.contains("samples       4 per pixel, passes 0..4\nerror "), "{said}");
    let same = |film: &str| assert!(read(folder, film) == read(folder, "one.film"), "{film}");
    same("a.film");
    assert!(read(folder, "a.exr") == read(folder, "one.exr"));
    for fan_in in [2_usize, 5, 12] {
        let mut films = Vec::new();
        for first in (0..12).step_by(fan_in) {
            let (tasks, film) = (format!("{first}..{}", first + fan_in), format!("{first}.film"));
            MERGE.succeed(folder, &["--expect", "job.json", "--tasks", &tasks, "--checkpoint", &film]);
            films.push(film);
        }
        let films: Vec<&str> = films.iter().rev().map(String::as_str).collect();
        MERGE.succeed(folder, &[&films[..], &["--expect", "job.json", "--checkpoint", "tree.film"]].concat());
        same("tree.film");
    }
    let (code, said) = status(folder);
    assert!(
        code == Some(0) && said.starts_with("tasks         12 of 12 complete, 100.0 % of the work\n"),
        "{said}"
    );
    assert!(!said.contains("submit"), "{said}");
}

#[test]
fn a_merge_does_not_replace_a_part_of_its_job() {
    let folder = rendered();
    let before = read(folder.path(), "job.parts/task-000003.part");
    let arguments = ["--expect", "job.json", "--checkpoint", "job.parts/task-000003.part", "--out", "a.png"];
    let expected = "error: a task's part job.parts/task-000003.part and --checkpoint job.parts/task-000003.part \
                    are the same file\n";
    for tasks in [&[][..], &["--tasks", "4..8"]] {
        let said = merge(folder.path(), &[&arguments[..], tasks].concat());
        assert_eq!(said, (Some(1), expected.to_owned()));
    }
    assert!(read(folder.path(), "job.parts/task-000003.part") == before);
    assert_eq!(names(folder.path()), ["job.json", "job.parts"]);
}

#[test]
fn a_job_does_not_take_over_parts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    plan(folder, "job.json", &["--tasks", "12"], "4");
    run_task(folder, 0);
    fs::remove_file(folder.join("job.json")).expect("it is there");
    let again = [&["plan", "job.json", "--"], &PICTURE[..], &["4"]].concat();
    let (code, _, said) = run(&mut GLOBILLUM.command(folder, &again));
    let expected = "error: job.parts: is not empty: move it away, or give the job another name\n";
    assert_eq!((code, said.as_str()), (Some(1), expected));
    assert_eq!(names(folder), ["job.parts"]);
}

#[test]
fn the_index_is_the_schedulers() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    plan(folder, "job.json", &["--tasks", "12"], "4");
    let run_with = |variables: &[(&str, &str)], arguments: &[&str]| {
        let mut command = GLOBILLUM.command(folder, &[&["task", "job.json"], arguments].concat());
        command.env_remove("SLURM_ARRAY_TASK_ID").envs(variables.iter().copied());
        run(&mut command)
    };
    for (variables, arguments, index) in [
        (&[("SLURM_ARRAY_TASK_ID", "3"), ("SLURM_CPUS_PER_TASK", "2")][..], &[][..], 3),
        (&[("AWS_BATCH_JOB_ARRAY_INDEX", "0")], &["--offset", "10"], 10),
        (&[("JOB_COMPLETION_INDEX", "4")], &["--threads", "1"], 4),
        (&[("SLURM_ARRAY_TASK_ID", "3")], &["--index", "5"], 5),
        (&[("SLURM_CPUS_PER_TASK", "")], &["--index", "6"], 6),
        (&[("SLURM_CPUS_PER_TASK", "x")], &["--index", "7", "--threads", "1"], 7),
    ] {
        let (code, said, error) = run_with(variables, arguments);
        assert!(code == Some(0) && said.starts_with(&format!("task {index}: ")), "{said}{error}");
    }
    for (variables, arguments, words) in [
        (&[][..], &[][..], "neither --index nor SLURM_ARRAY_TASK_ID"),
        (&[("SLURM_ARRAY_TASK_ID", "x")], &[], "SLURM_ARRAY_TASK_ID=x"),
        (&[("SLURM_CPUS_PER_TASK", "x")], &["--index", "1"], "SLURM_CPUS_PER_TASK=x"),
        (&[], &["--index", "12"], "job.json: has only tasks 0 to 11"),
        (&[], &["--index", "4294967295", "--offset", "1"], "job.json: has only tasks 0 to 11"),
    ] {
        let (code, _, error) = run_with(variables, arguments);
        assert!(code == Some(1) && error.contains(words), "{error}");
    }
}

/// What is deleted and what is damaged is named and nothing else; submitting it completes the picture.
#[test]
fn missing_and_damaged_parts_are_named() {
    let folder = rendered();
    let folder = folder.path();
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "before.film"]);
    fs::remove_file(part(folder, 2)).expect("it is there");
    let cut = fs::read(part(folder, 7)).expect("it is there");
    fs::write(part(folder, 7), &cut[..cut.len() - 1]).expect("it can be written");
    fs::copy(part(folder, 5), part(folder, 5).with_file_name("copy.part")).expect("it can be copied");
    let (code, said) = status(folder);
    let expected = "tasks         10 of 12 complete, 85.0 % of the work\n\
        missing       task 2: passes 0..1 of rows 32..40\n\
        missing       task 7: passes 2..3 of rows 16..32\n\
        damaged       job.parts/task-000007.part: has a length that does not match its header \
        (task 7: passes 2..3 of rows 16..32)\n\
        duplicate     task 5: passes 1..2 of rows 32..40: job.parts/copy.part, job.parts/task-000005.part\n\
        submit        2,7, offset 0\n";
    assert_eq!((code, said.as_str()), (Some(3), expected));
    let arrays =
        |size| GLOBILLUM.succeed(folder, &["status", "job.json", "--arrays", "--max-array-size", size]);
    assert_eq!([arrays("1001"), arrays("3")], ["0 2,7\n", "0 2\n6 1\n"]);
    for wanted in [&["--expect", "job.json"][..], &["--expect", "job.json", "--tasks", "2..3"]] {
        let (code, error) = merge(folder, &[wanted, &["--out", "a.exr", "--checkpoint", "a.film"]].concat());
        assert!(
            code == Some(3) && error.starts_with("error: incomplete: job.parts/task-000002.part: "),
            "{error}"
        );
    }
    let (code, error) = merge(folder, &["job.parts/copy.part", "--expect", "job.json", "--out", "a.png"]);
    assert!(code == Some(3) && error.contains("task 0: passes 0..1 of rows 0..16 is missing"), "{error}");
    assert_eq!(names(folder), ["before.film", "job.json", "job.parts"], "an incomplete merge leaves nothing");

    assert!(!run_task(folder, 2).contains("set aside"));
    let said = run_task(folder, 7);
    assert!(said.contains("has a length that does not match its header; set aside as"), "{said}");
    assert!(part(folder, 7).with_extension("part.damaged").exists());
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "after.film"]);
    assert!(read(folder, "before.film") == read(folder, "after.film"));
}

/// A merge among the parts is not counted for each of its tasks.
#[test]
fn the_error_is_that_of_the_tasks_own_parts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    plan(folder, "job.json", &["--tasks", "4"], "16");
    (0..4).for_each(|index| assert!(run_task(folder, index).contains("is complete")));
    let error = || {
        let (code, said) = status(folder);
        let line = said.lines().find(|line| line.starts_with("error ")).map(str::to_owned);
        assert!(code == Some(0) && line.is_some(), "{said}");
        line
    };
    let before = error();
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "job.parts/all.part"]);
    assert_eq!(error(), before);
}

/// A part under the name of another task's is set aside, and the task is rendered.
#[test]
fn a_part_of_another_task_is_set_aside() {
    let folder = rendered();
    let folder = folder.path();
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "before.film"]);
    let wrong = fs::read(part(folder, 0)).expect("it is there");
    for (index, held) in
        [(1, "passes 0..1 of rows 0..16"), (3, "passes 0..1 of rows 0..16"), (5, "passes 0..4")]
    {
        let (from, aside) =
            (if index == 5 { "before.film" } else { "job.parts/task-000000.part" }, part(folder, index));
        fs::copy(folder.join(from), &aside).expect("it can be copied");
        let said = run_task(folder, index);
        let aside = aside.with_extension("part.misplaced");
        let expected =
            format!("warning: job.parts/task-{index:06}.part: holds {held}, which is not task {index}: ");
        assert!(said.contains(&expected) && said.contains("is complete"), "{said}");
        assert!(fs::read(aside).expect("it is set aside") == read(folder, from));
    }
    // What was set aside before is kept.
    fs::write(part(folder, 1), &wrong).expect("it can be written");
    fs::write(part(folder, 1).with_extension("part.misplaced"), "before").expect("it can be written");
    let said = run_task(folder, 1);
    assert!(said.contains("set aside as job.parts/task-000001.part.misplaced2"), "{said}");
    assert_eq!(read(folder, "job.parts/task-000001.part.misplaced"), b"before");
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "after.film"]);
    assert!(read(folder, "before.film") == read(folder, "after.film"));
}

/// Where `status` finds a task complete, so does `merge`.
#[test]
fn parts_are_merged_whatever_their_names() {
    let folder = rendered();
    let folder = folder.path();
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "before.film"]);
    let rename = |from: &Path, to: &Path| fs::rename(from, to).expect("it can be renamed");
    let aside = part(folder, 0).with_file_name("other.part");
    let merges = || {
        assert_eq!(status(folder).0, Some(0));
        MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "after.film"]);
        assert!(read(folder, "before.film") == read(folder, "after.film"));
    };
    rename(&part(folder, 3), &aside);
    merges();
    rename(&part(folder, 5), &part(folder, 3));
    rename(&aside, &part(folder, 5));
    merges();
    // All of the picture under the name of one task.
    fs::copy(folder.join("before.film"), part(folder, 4)).expect("it can be copied");
    merges();
}

/// Damage between header and end is found when the rows are read.
#[test]
fn damage_inside_a_part_is_found_by_merge_and_by_its_task() {
    let folder = rendered();
    let folder = folder.path();
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "before.film"]);
    let mut damaged = fs::read(part(folder, 9)).expect("it is there");
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    fs::write(part(folder, 9), damaged).expect("it can be written");
    assert_eq!(status(folder).0, Some(0), "only header and end are read");
    let (code, error) = merge(folder, &["--expect", "job.json", "--checkpoint", "a.film", "--out", "a.png"]);
    let expected = "error: incomplete: job.parts/task-000009.part: is damaged: its checksum is wrong\n";
    assert_eq!((code, error.as_str()), (Some(3), expected));
    let (code, error) = merge(folder, &["job.parts/task-000009.part", "--out", "a.png"]);
    assert!(code == Some(1) && error.contains("task-000009.part: is damaged"), "{error}");
    assert_eq!(names(folder), ["before.film", "job.json", "job.parts"]);
    assert!(run_task(folder, 9).contains("is damaged: its checksum is wrong; set aside as"));
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "after.film"]);
    assert!(read(folder, "before.film") == read(folder, "after.film"));
}

#[test]
fn parts_of_another_picture_are_refused_and_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    plan(folder, "job.json", &["--tasks", "2"], "2");
    run_task(folder, 0);
    CORNELL.succeed(
        folder,
        &[
            &PICTURE[1..],
            &["2", "--seed", "1", "--passes", "1..2", "--checkpoint", "job.parts/task-000001.part"],
        ]
        .concat(),
    );
    let foreign = "job.parts/task-000001.part: belongs to another picture: the scene, camera, settings or build differs";
    let (code, said) = status(folder);
    assert!(code == Some(3) && said.contains(&format!("foreign       {foreign} (task 1")), "{said}");
    let (code, _, error) = run(&mut task(folder, 1));
    assert_eq!((code, error), (Some(1), format!("error: {foreign}\n")));
    let (code, error) = merge(folder, &["--expect", "job.json", "--out", "a.png"]);
    assert_eq!((code, error), (Some(1), format!("error: {foreign}\n")));
    // A job of another scene or of another build, whose key differs.
    let text = fs::read_to_string(folder.join("job.json")).expect("it is there");
    let key = text.split("\"key\": \"").nth(1).and_then(|rest| rest.get(..16)).expect("it has a key");
    fs::write(folder.join("job.json"), text.replace(key, "0123456789abcdef")).expect("it can be written");
    let _ = fs::remove_dir_all(folder.join("job.parts"));
    let (code, _, error) = run(&mut task(folder, 0));
    assert_eq!(code, Some(1));
    assert!(error.contains("job.json: was planned by another build or for another scene"), "{error}");
}

#[test]
fn jobs_that_cannot_be_are_refused() {
    let refused = |arguments: &[&str], words: &[&str]| GLOBILLUM.assert_refused(|_| (), arguments, words);
    let with = |flag: &[&'static str]| [&["plan", "job.json", "--", "cornell"][..], flag].concat();
    for flag in [&["--checkpoint", "a"][..], &["--passes", "0..1"], &["--error", "1"], &["--out", "a.png"]] {
        refused(&with(flag), &[flag[0], "not allowed in `plan`"]);
    }
    refused(&with(&["--sped"]), &["unexpected argument --sped"]);
    refused(&["plan", "job.json", "--", "merge", "a"], &["unknown command merge"]);
    refused(&with(&["--help"]), &["--help: not allowed in `plan`; see `globillum render --help`"]);
    refused(&["plan", "job.json", "--error", "0.1", "--", "cornell"], &["--pilot"]);
    refused(&["status", "job.json"], &["job.json: cannot be read"]);
    let written = |text: &'static str, words: &[&str]| {
        let fill = |folder: &Path| fs::write(folder.join("job.json"), text).expect("an empty folder");
        GLOBILLUM.assert_refused(fill, &["status", "job.json"], words);
    };
    written("{}", &["job.json: is no job file: missing field `version`"]);
    let impossible = r#"{"version": "", "key": "0", "picture": [], "samples": 1, "tasks": 1, "division":
        {"height": 16, "first_pass": 0, "end_pass": 3, "task_passes": 3, "task_rows": 16}}"#;
    written(impossible, &["job.json: is no plan"]);
}

/// A pilot says how many passes an error needs; none of them is the pilot's.
#[test]
fn an_error_is_planned_by_a_pilot() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let picture = ["--", "cornell", "--width", "32", "--height", "32", "--pass-spp", "2"];
    GLOBILLUM
        .succeed(folder, &[&["plan", "pilot.json", "--tasks", "2"], &picture[..], &["--spp", "16"]].concat());
    for index in ["0", "1"] {
        GLOBILLUM.succeed(folder, &["task", "pilot.json", "--index", index]);
    }
    MERGE.succeed(folder, &["--expect", "pilot.json", "--checkpoint", "pilot.film"]);
    let plan = ["plan", "job.json", "--error", "0.1", "--pilot", "pilot.film", "--tasks", "4"];
    GLOBILLUM.succeed(folder, &[&plan, &picture[..]].concat());
    let job: serde_json::Value = serde_json::from_slice(&read(folder, "job.json")).expect("it is JSON");
    let tasks = job["tasks"].as_u64().expect("a number");
    assert_eq!(job["division"]["first_pass"], 8);
    // The same passes as those of one run with the same pilot.
    let one = ["--width", "32", "--height", "32", "--pass-spp", "2", "--error", "0.1", "--pilot", "8"];
    CORNELL.succeed(folder, &[&one[..], &["--out", "one.exr", "--checkpoint", "one.film"]].concat());
    for index in 0..tasks {
        GLOBILLUM.succeed(folder, &["task", "job.json", "--index", &index.to_string()]);
    }
    MERGE.succeed(folder, &["--expect", "job.json", "--checkpoint", "job.film"]);
    assert!(read(folder, "job.film") == read(folder, "one.film"));
}

/// Few files may be open at first: many systems allow 1,024, and a job may have more parts.
#[cfg(target_os = "linux")]
#[test]
fn a_merge_takes_more_parts_than_files_may_be_open() {
    let folder = rendered();
    let folder = folder.path();
    let merge = ["merge", "--expect", "job.json", "--checkpoint", "a.film"];
    let mut shell = Command::new("sh");
    shell.args(["-c", "ulimit -Sn 12 && exec \"$@\"", "sh", GLOBILLUM.path]).args(merge).current_dir(folder);
    let (code, _, error) = run(&mut shell);
    assert_eq!(code, Some(0), "{error}");
}

/// SIGTERM keeps whole passes, and says that the task is to be run again.
#[cfg(unix)]
#[test]
fn a_task_that_is_terminated_goes_on() {
    use std::process::Stdio;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    plan(folder, "job.json", &["--tasks", "1"], "1024");
    for signal in ["-TERM", "-INT"] {
        let mut command = task(folder, 0);
        let mut child = command.stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
        while !folder.join("job.parts").exists() {
            assert_eq!(child.try_wait().expect("it is our own"), None, "it ended too soon");
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
        let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
        assert!(sent.expect("there is a `kill`").success());
        let output = child.wait_with_output().expect("it is our own");
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(75), "{error}");
        assert!(error.contains("interrupted: task 0: passes 0..1024 of rows 0..40: "), "{error}");
        assert!(error.ends_with(" of 1024 passes are kept\n"), "{error}");
    }
    let (code, said) = status(folder);
    assert!(code == Some(3) && said.starts_with("tasks         0 of 1 complete, "), "{said}");
    let (code, error) = merge(folder, &["--expect", "job.json", "--out", "a.png"]);
    assert!(code == Some(3) && error.contains("is not finished"), "{error}");
    let said = run_task(folder, 0);
    assert!(said.contains("goes on after ") && said.contains("is complete"), "{said}");
    assert!(run_task(folder, 0).starts_with("task 0: passes 0..1024 of rows 0..40: is complete\n"));
    CORNELL
        .succeed(folder, &[&PICTURE[1..], &["1024", "--checkpoint", "one.film", "--out", "a.png"]].concat());
    assert!(fs::read(part(folder, 0)).expect("it is there") == read(folder, "one.film"));
}

/// A job file is text.
#[cfg(target_os = "linux")]
#[test]
fn names_of_a_plan_are_utf_8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut command = GLOBILLUM.command(folder.path(), &["plan", "job.json", "--", "render"]);
    let (code, _, error) = run(command.arg(OsStr::from_bytes(b"a\xff.glb")));
    assert_eq!(code, Some(1), "{error}");
    assert!(error.ends_with("a\u{fffd}.glb: is not UTF-8, which a job file must be\n"), "{error}");
    assert!(!folder.path().join("job.json").exists());
}

/// Threads that the system refuses now may be had later. It refuses those with stacks larger than all memory.
#[cfg(target_os = "linux")]
#[test]
fn a_lack_of_threads_is_worth_another_try() {
    let folder = rendered();
    let folder = folder.path();
    fs::remove_file(part(folder, 0)).expect("it is there");
    let without_threads =
        |command: &mut Command| run(command.env("RUST_MIN_STACK", (1_u64 << 47).to_string()));
    let arguments: [&[&str]; 5] = [
        &["task", "job.json", "--index", "0", "--threads", "1"],
        &["merge", "job.parts/task-000001.part", "--out", "a.png"],
        &["cornell", "--width", "8", "--height", "8", "--spp", "1", "--threads", "1"],
        &["plan", "b.json", "--", "cornell", "--spp", "16"],
        &["irradiance", "a.obj", "--points", "points.csv", "--samples", "1"],
    ];
    fs::write(folder.join("points.csv"), "0,0,0,0,1,0\n").expect("an empty folder");
    fs::write(folder.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("an empty folder");
    for arguments in arguments {
        let (code, said, error) = without_threads(&mut GLOBILLUM.command(folder, arguments));
        assert_eq!((code, &*said), (Some(75), ""), "{arguments:?}: {error}");
        assert!(error.starts_with("error: worker threads: ") && error.lines().count() == 1, "{error}");
    }
}

/// A full disk may have room later.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_worth_another_try() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let size = ["--width", "16", "--height", "8", "--spp", "4"];
    let files = ["--stats", "/dev/full", "--out", "a.png"];
    let (code, _, error) = run(&mut CORNELL.command(folder.path(), &[&size[..], &files].concat()));
    assert!(code == Some(75) && error.starts_with("error: /dev/full: "), "{error}");
}
