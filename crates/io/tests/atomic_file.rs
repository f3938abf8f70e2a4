//! `AtomicFile`: regular files are replaced as a whole, special files are written through.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]
#![allow(clippy::print_stderr, reason = "a skipped test prints a message")]

use globillum_io::{AtomicFile, IoError};
use std::fs;
use std::io;
use std::path::Path;
use tempfile::tempdir;

const OLD: &[u8] = b"what was there before";
const NEW: &[u8] = b"what comes instead, rather longer than that";

fn names_in(folder: &Path) -> Vec<String> {
    fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

fn write(target: &Path, content: &[u8]) -> Result<(), IoError> {
    AtomicFile::create(target)?.commit(|writer| writer.write_all(content))
}

#[test]
fn a_failed_writer_leaves_the_old_file_and_no_other() {
    let folder = tempdir().unwrap();
    let target = folder.path().join("picture");
    fs::write(&target, OLD).unwrap();
    for k in 0..=NEW.len() {
        let result = AtomicFile::create(&target).unwrap().commit(|writer| {
            writer.write_all(&NEW[..k])?;
            writer.flush()?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert!(matches!(result, Err(IoError::Write { .. })));
        assert_eq!(fs::read(&target).unwrap(), OLD, "failed after {k} bytes");
        assert_eq!(names_in(folder.path()), ["picture"]);
    }
}

#[test]
fn a_complete_file_takes_the_place_of_the_old_one() {
    let folder = tempdir().unwrap();
    let target = folder.path().join("picture");
    for content in [OLD, NEW] {
        write(&target, content).unwrap();
        assert_eq!(fs::read(&target).unwrap(), content);
        assert_eq!(names_in(folder.path()), ["picture"]);
    }
}

#[test]
fn nothing_is_left_of_an_abandoned_file() {
    let folder = tempdir().unwrap();
    drop(AtomicFile::create(folder.path().join("picture")).unwrap());
    assert!(names_in(folder.path()).is_empty());
}

#[test]
fn leftovers_of_the_dead_are_removed_and_files_of_the_living_stay() {
    let folder = tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let living = AtomicFile::create(at("a.png")).unwrap();
    let strangers = [".a.png.x.tmp", ".a.png.123456.TMP", ".b.png.123456.tmp", "a.png.123456.tmp"];
    for name in strangers.iter().chain(&[".a.png.123456.tmp", ".a.png.abcXYZ.tmp"]) {
        fs::write(at(name), "left").unwrap();
    }
    fs::create_dir(at(".a.png.folder.tmp")).unwrap();
    write(&at("a.png"), NEW).unwrap();
    let left = names_in(folder.path());
    assert!(strangers.iter().all(|name| left.contains(&(*name).into())), "{left:?}");
    // The folder also contains the new file and the temporary file of the open writer.
    assert_eq!(left.len(), strangers.len() + 3, "{left:?}");
    living.commit(|writer| writer.write_all(OLD)).unwrap();
    assert_eq!(fs::read(at("a.png")).unwrap(), OLD);
}

#[test]
fn many_writers_of_one_name_do_not_take_each_others_files() {
    let folder = tempdir().unwrap();
    let target = folder.path().join("a.png");
    let write_often = |content: &[u8]| (0..50).for_each(|_| write(&target, content).unwrap());
    std::thread::scope(|scope| {
        [OLD, NEW, OLD, NEW].map(|content| scope.spawn(move || write_often(content))).map(drop)
    });
    assert_eq!(names_in(folder.path()), ["a.png"]);
    assert!([OLD, NEW].contains(&&fs::read(&target).unwrap()[..]));
}

#[test]
fn the_longest_names_can_be_written() {
    let folder = tempdir().unwrap();
    let target = folder.path().join("\u{e4}".repeat(127));
    write(&target, NEW).unwrap();
    assert_eq!(fs::read(&target).unwrap(), NEW);
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::fs::File;
    use std::io::{Read, Write};
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    use std::os::unix::net::UnixListener;
    use std::path::PathBuf;
    use std::process::Command;
    use tempfile::TempDir;

    #[test]
    fn permissions_are_those_of_any_new_file() {
        let folder = tempdir().unwrap();
        let [ours, plain] = ["ours", "plain"].map(|name| folder.path().join(name));
        write(&ours, NEW).unwrap();
        File::create(&plain).unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(ours), mode(plain));
    }

    /// Runs a command that makes a special file. `false` if that is not permitted.
    fn made(program: &str, path: &Path, arguments: &[&str]) -> bool {
        let made = Command::new(program).arg(path).args(arguments).output().unwrap().status.success();
        if !made {
            eprintln!("SKIPPED: {program} {} {arguments:?} is not permitted", path.display());
        }
        made
    }

    /// A folder with a FIFO of this name.
    fn fifo(name: &str) -> (TempDir, PathBuf) {
        let folder = tempdir().unwrap();
        let path = folder.path().join(name);
        assert!(made("mkfifo", &path, &[]));
        (folder, path)
    }

    /// Opens a FIFO for reading and writing, which does not block.
    fn reader_of(fifo: &Path) -> File {
        File::options().read(true).write(true).open(fifo).unwrap()
    }

    /// Asserts that the FIFO still is one and that its next bytes are `content`.
    fn assert_written_through(fifo: &Path, reader: &mut File, content: &[u8]) {
        assert!(fs::metadata(fifo).unwrap().file_type().is_fifo(), "the FIFO has been replaced");
        let mut found = vec![0; content.len()];
        reader.read_exact(&mut found).unwrap();
        assert_eq!(found, content);
    }

    #[test]
    fn a_fifo_is_written_through() {
        let (folder, path) = fifo("pipe");
        let link = folder.path().join("link");
        symlink("pipe", &link).unwrap();
        let mut reader = reader_of(&path);
        for (target, content) in [(&path, OLD), (&path, NEW), (&link, OLD)] {
            let file = AtomicFile::create(target).unwrap();
            assert_eq!(names_in(folder.path()).len(), 2, "there is a temporary file");
            file.commit(|writer| writer.write_all(content)).unwrap();
            assert_written_through(&path, &mut reader, content);
        }
        assert!(link.is_symlink());
    }

    #[test]
    fn a_fifo_takes_as_much_as_its_reader_does() {
        let (_folder, path) = fifo("pipe");
        // More than the buffer of a pipe.
        let content: Vec<u8> = (0..1_000_000_u32).map(|i| i as u8).collect();
        // Reading ends when the writer closes the FIFO.
        let fifo = path.clone();
        let reader = std::thread::spawn(move || fs::read(fifo).unwrap());
        write(&path, &content).unwrap();
        assert!(fs::metadata(&path).unwrap().file_type().is_fifo(), "the FIFO has been replaced");
        assert_eq!(reader.join().unwrap(), content);
    }

    #[test]
    fn a_reader_that_goes_away_is_an_error() {
        let (_folder, path) = fifo("pipe");
        let reader = reader_of(&path);
        let file = AtomicFile::create(&path).unwrap();
        drop(reader);
        let error = file.commit(|writer| writer.write_all(NEW)).unwrap_err();
        assert!(
            matches!(&error, IoError::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
        );
    }

    #[test]
    fn a_target_that_becomes_special_meanwhile_is_not_replaced() {
        let folder = tempdir().unwrap();
        let path = folder.path().join("pipe");
        let file = AtomicFile::create(&path).unwrap();
        assert!(made("mkfifo", &path, &[]));
        assert!(matches!(file.commit(|writer| writer.write_all(NEW)), Err(IoError::Write { .. })));
        assert!(fs::metadata(&path).unwrap().file_type().is_fifo());
        assert_eq!(names_in(folder.path()), ["pipe"]);
    }

    /// The test makes its own devices, since faulty code may replace them.
    #[test]
    fn a_device_is_written_through_by_name_and_by_link() {
        let folder = tempdir().unwrap();
        let [null, full, link] = ["null", "full", "link"].map(|name| folder.path().join(name));
        if !made("mknod", &null, &["c", "1", "3"]) || !made("mknod", &full, &["c", "1", "7"]) {
            return;
        }
        symlink("full", &link).unwrap();
        if let Err(error) = File::options().write(true).open(&null) {
            eprintln!("SKIPPED: devices in {} cannot be opened: {error}", folder.path().display());
            return;
        }
        write(&null, NEW).unwrap();
        for path in [&full, &link] {
            let error = write(path, NEW).unwrap_err();
            assert!(
                matches!(&error, IoError::Write { source, .. } if source.kind() == io::ErrorKind::StorageFull)
            );
        }
        assert!([null, full].iter().all(|path| fs::metadata(path).unwrap().file_type().is_char_device()));
        assert!(link.is_symlink());
        assert_eq!(names_in(folder.path()).len(), 3);
    }

    #[test]
    fn a_socket_is_refused() {
        let folder = tempdir().unwrap();
        let path = folder.path().join("socket");
        let _listener = UnixListener::bind(&path).unwrap();
        let message = AtomicFile::create(&path).unwrap_err().to_string();
        assert_eq!(message, format!("{}: cannot be written: is a socket", path.display()));
        assert!(fs::metadata(&path).unwrap().file_type().is_socket());
    }

    #[test]
    fn the_target_of_links_is_replaced_and_they_stay() {
        let folder = tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("sub")).unwrap();
        symlink("sub/second", at("first")).unwrap();
        symlink("file", at("sub/second")).unwrap();
        // At first the last link has no target.
        for content in [OLD, NEW] {
            write(&at("first"), content).unwrap();
            assert!(fs::symlink_metadata(at("sub/file")).unwrap().is_file());
            assert_eq!(fs::read(at("sub/file")).unwrap(), content);
        }
        for link in ["first", "sub/second"] {
            assert!(at(link).is_symlink(), "{link}");
        }
        assert_eq!((names_in(folder.path()).len(), names_in(&at("sub")).len()), (2, 2));
    }

    #[test]
    fn links_in_a_circle_are_an_error() {
        let folder = tempdir().unwrap();
        let path = folder.path().join("self");
        symlink("self", &path).unwrap();
        assert!(matches!(AtomicFile::create(&path), Err(IoError::Write { .. })));
        assert!(path.is_symlink());
    }

    fn shared(file: File) -> [File; 3] {
        [file.try_clone().unwrap(), file.try_clone().unwrap(), file]
    }

    #[test]
    fn standard_output_and_error_are_written_through_where_they_stand() {
        const ROLE: &str = "GLOBILLUM_WRITES_TO_ITS_OWN_STREAM";
        if let Some(target) = std::env::var_os(ROLE) {
            for content in ["one ", "two "] {
                write(Path::new(&target), content.as_bytes()).unwrap();
            }
            return;
        }
        let folder = tempdir().unwrap();
        let out = folder.path().join("out");
        let this = "unix::standard_output_and_error_are_written_through_where_they_stand";
        // Links, since faulty code may replace the targets.
        let [stdout, stderr] = [1, 2].map(|descriptor| {
            let link = folder.path().join(descriptor.to_string());
            symlink(format!("/proc/self/fd/{descriptor}"), &link).unwrap();
            link
        });
        let by_descriptor = if cfg!(target_os = "linux") { vec![stdout, stderr] } else { vec![] };
        for target in by_descriptor.iter().chain([&out]) {
            // All writers share one file offset.
            let [mut before, stdout, stderr] = shared(File::create(&out).unwrap());
            before.write_all(b"before ").unwrap();
            let mut command = Command::new(std::env::current_exe().unwrap());
            command.args(["--exact", this, "--quiet"]).env(ROLE, target).stdout(stdout).stderr(stderr);
            assert!(command.status().unwrap().success());
            let found = fs::read_to_string(&out).unwrap();
            assert!(found.starts_with("before ") && found.contains("one two "), "{target:?}: {found:?}");
        }
        assert_eq!(names_in(folder.path()).len(), 3);
        assert!(by_descriptor.iter().all(|link| link.is_symlink()));
    }
}
