//! Signals that end a render.

use crate::{CORNELL, MERGE};
use globillum::io::PictureData;
use globillum_testkit::program::names;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

fn start(folder: &Path, arguments: &[&str]) -> Child {
    let mut command = CORNELL.command(folder, arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

/// [`start`], but with SIGHUP as a terminal leaves it, also if these tests run below `nohup`.
#[cfg(target_os = "linux")]
fn start_in_terminal(folder: &Path, arguments: &[&str], stdout: Stdio) -> Child {
    let mut env = Command::new("env");
    env.args(["--default-signal=HUP", CORNELL.path, "cornell"]).args(arguments).current_dir(folder);
    env.stdout(stdout).stderr(Stdio::piped()).spawn().expect("there is `env`")
}

/// Waits until a file whose name begins with `prefix` is in `folder`.
fn wait_for(folder: &Path, prefix: &str, child: &mut Child) {
    let is_there = || names(folder).iter().any(|name| name.to_string_lossy().starts_with(prefix));
    while !is_there() {
        assert_eq!(child.try_wait().expect("it is our own"), None, "it ended before {prefix} was there");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(status.expect("there is a `kill`").success());
}

fn end(child: Child) -> (Output, String) {
    let output = child.wait_with_output().expect("it is our own");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (output, said)
}

/// A checkpoint that exceeds the limit on the size of files does not end the program: the picture is written.
#[test]
fn a_limit_on_the_size_of_files_is_an_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    // Limits are in units of 512 or 1024 bytes.
    let limited = ["-c", "ulimit -f 8 && exec \"$@\"", "sh", CORNELL.path, "cornell"];
    let size = ["--width", "24", "--height", "24", "--spp", "32", "--threads", "1"];
    let mut command = Command::new("sh");
    command.args(limited).args(size).args(["--checkpoint", "parts", "--out", "a.png"]).current_dir(folder);
    let (output, said) = end(command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a shell"));
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.starts_with("error: parts: cannot be written: File too large"), "{said}");
    assert_eq!(names(folder), ["a.png"]);
}

/// One thread builds, another one renders, and the first one of the program waits for both.
#[cfg(target_os = "linux")]
#[test]
fn threads_are_as_many_as_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut child = start(folder.path(), &[&ENDLESS[..], &["--threads", "1", "--scene", "1"]].concat());
    let tasks = format!("/proc/{}/task", child.id());
    let (mut most, mut looks_at_most) = (0, 0);
    while most < 3 || looks_at_most < 100 {
        assert_eq!(child.try_wait().expect("it is our own"), None, "it ended too soon");
        most = most.max(std::fs::read_dir(&tasks).map_or(0, Iterator::count));
        looks_at_most += u32::from(most >= 3);
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().expect("it is our own");
    end(child);
    assert_eq!(most, 3);
}

/// Nothing but a signal ends this render.
const ENDLESS: [&str; 6] = ["--width", "48", "--height", "32", "--error", "1e-12"];

/// The first of these signals, once a pass is complete, keeps what is complete.
fn assert_signals_keep_passes(start: impl Fn(&Path, &[&str]) -> Child, signals: &[&str], code: i32) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let files = ["--out", "a.exr", "--checkpoint", "parts", "--save-every", "0", "--stats", "stats.json"];
    let mut child = start(folder, &[&ENDLESS[..], &files, &["--pass-spp", "1"]].concat());
    wait_for(folder, "parts", &mut child);
    signals.iter().for_each(|signal| send(signal, &child));
    let (output, said) = end(child);
    assert_eq!(output.status.code(), Some(code), "{said}");
    let stats = std::fs::read(folder.join("stats.json")).expect("it was written");
    let stats: serde_json::Value = serde_json::from_slice(&stats).expect("it is JSON");
    let samples = stats["samples_per_pixel"].as_u64().filter(|&samples| samples > 0).expect("one pass");
    let kept = format!("interrupted: complete passes are kept, {samples} samples per pixel\n");
    assert_eq!((said, &stats["ended_by"]), (kept, &"a signal".into()));
    assert!(String::from_utf8_lossy(&output.stdout).contains("ended by      a signal"));
    MERGE.succeed(folder, &["parts", "--out", "b.exr"]);
    let [a, b] = ["a.exr", "b.exr"].map(|name| PictureData::read(folder.join(name)).expect("a picture"));
    assert!(a.estimates == b.estimates, "picture and checkpoint hold the same passes");
    assert_eq!(names(folder), ["a.exr", "b.exr", "parts", "stats.json"]);
}

#[test]
fn the_first_signal_keeps_complete_passes() {
    assert_signals_keep_passes(start, &["-INT"], 130);
    assert_signals_keep_passes(start, &["-TERM"], 143);
}

/// The terminal and its shell both send SIGHUP.
#[cfg(target_os = "linux")]
#[test]
fn hangups_keep_complete_passes() {
    let start = |folder: &Path, arguments: &[&str]| start_in_terminal(folder, arguments, Stdio::piped());
    assert_signals_keep_passes(start, &["-HUP", "-HUP"], 129);
}

/// A terminal that has closed takes no table: that is no error.
#[cfg(target_os = "linux")]
#[test]
fn a_hangup_needs_no_terminal() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let files = ["--out", "a.exr", "--checkpoint", "parts", "--save-every", "0", "--pass-spp", "1"];
    let closed = std::fs::File::options().write(true).open("/dev/full").expect("it is there");
    let mut child = start_in_terminal(folder, &[&ENDLESS[..], &files].concat(), closed.into());
    wait_for(folder, "parts", &mut child);
    send("-HUP", &child);
    let (output, said) = end(child);
    assert_eq!(output.status.code(), Some(129), "{said}");
    assert_eq!(names(folder), ["a.exr", "parts"]);
}

/// `nohup` ignores SIGHUP: the render goes on.
#[cfg(target_os = "linux")]
#[test]
fn an_ignored_hangup_stays_ignored() {
    use std::os::unix::fs::MetadataExt;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let files = ["--out", "a.exr", "--checkpoint", "parts", "--save-every", "0", "--pass-spp", "1"];
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' HUP; exec \"$@\"", "sh", CORNELL.path, "cornell"]).args(ENDLESS).args(files);
    let shell = shell.current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = shell.spawn().expect("there is a shell");
    wait_for(folder, "parts", &mut child);
    send("-HUP", &child);
    // Each save is a new file.
    let save = || std::fs::metadata(folder.join("parts")).expect("it is there").ino();
    for _ in 0..4 {
        let before = save();
        while save() == before {
            assert_eq!(child.try_wait().expect("it is our own"), None, "it ended");
            std::thread::sleep(Duration::from_millis(2));
        }
    }
    send("-TERM", &child);
    let (output, said) = end(child);
    assert_eq!(output.status.code(), Some(143), "{said}");
}

/// A preview is a whole picture of the passes so far.
#[test]
fn a_picture_is_there_before_its_render_ends() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let files = ["--out", "a.exr", "--out", "a.png", "--preview"];
    let mut child = start(folder, &[&ENDLESS[..], &files, &["--pass-spp", "1"]].concat());
    wait_for(folder, "a.png", &mut child);
    let samples = || PictureData::read(folder.join("a.exr")).expect("a picture").estimates.samples[0];
    let before = samples();
    send("-INT", &child);
    let (output, said) = end(child);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(0 < before && before <= samples(), "{before}");
    assert_eq!(names(folder), ["a.exr", "a.png"]);
}

#[test]
fn a_signal_before_the_first_complete_pass_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = ["--out", "a.png", "--checkpoint", "parts", "--stats", "stats.json", "--pass-spp", "65536"];
    let mut child = start(folder.path(), &[&ENDLESS[..], &files].concat());
    // Its temporary files are there once signals are caught.
    wait_for(folder.path(), ".a.png.", &mut child);
    send("-INT", &child);
    let (output, said) = end(child);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert_eq!(said, "interrupted: nothing is complete, so no file is written\n");
    assert!(output.stdout.is_empty() && names(folder.path()).is_empty(), "{:?}", names(folder.path()));
}

/// Making and building the scene cannot be interrupted: only the second signal ends it at once.
#[test]
fn the_second_signal_ends_the_program_at_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut child = start(folder.path(), &["--scene", "3", "--triangles", "3000000", "--out", "a.png"]);
    wait_for(folder.path(), ".a.png.", &mut child);
    send("-INT", &child);
    send("-TERM", &child);
    let (output, said) = end(child);
    // The system may deliver two signals in either order.
    assert!(matches!(output.status.code(), Some(130 | 143)), "{:?}", output.status);
    assert!(said.is_empty() && output.stdout.is_empty(), "{said}");
}
