//! The scripts for Slurm, with stand-ins of `scontrol` and of an `sbatch` that runs its jobs at once. A real Slurm is in
//! `.ci/slurm`.

use crate::{CORNELL, GLOBILLUM};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

const SCONTROL: &str = "#!/usr/bin/env bash\necho 'MaxArraySize            = 6'\n";

/// Notes its arguments, runs its script for each index, and prints an id.
const SBATCH: &str = r#"#!/usr/bin/env bash
[ ! -e sbatch-fails ] || { echo "sbatch: error: no partition" >&2; exit 1; }
echo "$*" >> calls
array=none
for word in "$@"; do
  case $word in --array=*) array=${word#*=} ;; *.sbatch) script=$word ;; esac
done
for range in ${array//,/ }; do
  if [ "$range" = none ]; then bash "$script" >> log 2>&1; continue; fi
  for index in $(seq "${range%-*}" "${range#*-}"); do SLURM_ARRAY_TASK_ID=$index bash "$script" >> log 2>&1; done
done
wc -l < calls
"#;

const PICTURE: [&str; 9] = ["cornell", "--width", "24", "--height", "40", "--pass-spp", "1", "--spp", "8"];

/// A job of 8 tasks, and the stand-ins.
fn planned() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    GLOBILLUM.succeed(folder.path(), &[&["plan", "job.json", "--tasks", "8", "--"], &PICTURE[..]].concat());
    fs::create_dir(folder.path().join("bin")).expect("it is not there yet");
    for (name, script) in [("scontrol", SCONTROL), ("sbatch", SBATCH)] {
        let path = folder.path().join("bin").join(name);
        fs::write(&path, script).expect("it can be written");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("it is our own");
    }
    folder
}

/// The exit code of `submit.sh`, what it prints, and its error.
fn submit(folder: &Path, picture: &str, fan_in: &str) -> (Option<i32>, String, String) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../farm/slurm/submit.sh");
    let path = format!("{}:{}", folder.join("bin").display(), std::env::var("PATH").expect("there is one"));
    let mut command = Command::new("bash");
    command.arg(script).args(["job.json", picture, "--cpus-per-task=1"]).current_dir(folder);
    command.env("PATH", path).env("GLOBILLUM", GLOBILLUM.path).env("FAN_IN", fan_in);
    command.env_remove("SLURM_CPUS_PER_TASK");
    let Output { status, stdout, stderr } = command.output().expect("there is a `bash`");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (status.code(), text(&stdout), text(&stderr))
}

#[test]
fn what_is_submitted_is_the_picture() {
    let folder = planned();
    let folder = folder.path();
    CORNELL.succeed(folder, &[&PICTURE[1..], &["--out", "one.exr", "--checkpoint", "one.film"]].concat());
    let read = |name: &str| fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let same = || ["exr", "film"].iter().all(|end| read(&format!("one.{end}")) == read(&format!("a.{end}")));
    let (code, said, error) = submit(folder, "a.exr", "3");
    let expected = "tasks 1 0-5, offset 0\ntasks 2 0-1, offset 6\nmerges 3 0-2\npicture 4\n";
    assert_eq!((code, said.as_str()), (Some(0), expected), "{error}");
    let calls = String::from_utf8(read("calls")).expect("it is text");
    assert!(
        calls.contains("--dependency=afterany:1:2 ") && calls.contains("--dependency=afterany:3 "),
        "{calls}"
    );
    assert!(same(), "{}", String::from_utf8_lossy(&read("log")));
    // Again, with other merges: what is there is replaced by the same.
    let (code, said, error) = submit(folder, "a.exr", "5");
    assert_eq!((code, said.as_str()), (Some(0), "merges 5 0-1\npicture 6\n"), "{error}");
    assert!(same(), "{}", String::from_utf8_lossy(&read("log")));
    assert!(!String::from_utf8_lossy(&read("log")).contains("error: "));
}

#[test]
fn what_cannot_be_submitted_is_an_error() {
    let folder = planned();
    let folder = folder.path();
    let refused = |picture: &str, message: &str| {
        let (code, said, error) = submit(folder, picture, "64");
        assert!(code == Some(1) && said.is_empty() && error.contains(message), "{code:?}: {said}{error}");
        assert!(!folder.join("calls").exists(), "something is submitted");
    };
    refused("a.jpg", "a.jpg: must end in .png or .exr");
    let (code, _, error) = submit(folder, "a.png", "0");
    assert_eq!((code, error.as_str()), (Some(1), "submit.sh: FAN_IN=0: must be a number above 0\n"));
    fs::write(folder.join("sbatch-fails"), "").expect("it can be written");
    refused("a.PNG", "no partition");
    for index in 0..8 {
        GLOBILLUM.succeed(folder, &["task", "job.json", "--index", &index.to_string(), "--threads", "1"]);
    }
    refused("a.png", "no partition");
    fs::remove_file(folder.join("sbatch-fails")).expect("it is there");
    // The shell finds the number of tasks in it, but it is no job.
    fs::write(folder.join("job.json"), "{\n  \"tasks\": 8\n}\n").expect("it can be written");
    refused("a.png", "job.json: is no job file");
}
