//! `examples/cornell.rs`, which is what people copy to begin with.

#[allow(dead_code, reason = "its `main` is not called")]
#[path = "../../../../examples/cornell.rs"]
mod cornell;

use crate::CORNELL;

#[test]
fn the_example_renders_the_bits_of_the_program() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let parse =
        |words: &[&str]| cornell::Options::parse(lexopt::Parser::from_args(words)).expect("good words");
    let defaults = parse(&[]).expect("no help is asked for");
    assert_eq!((defaults.width, defaults.height, defaults.spp), (512, 512, 64));
    let [ours, theirs] = ["ours.png", "theirs.png"].map(|name| folder.path().join(name));
    let out = ours.to_str().expect("a plain name");
    let size = ["--width", "96", "--height", "64"];
    let options = parse(&[&size[..], &["--out", out]].concat()).expect("likewise");
    cornell::render(&options).expect("it renders");
    CORNELL.succeed(folder.path(), &[&size[..], &["--out", "theirs.png"]].concat());
    let read = |path| std::fs::read(path).expect("it was written");
    assert!(read(&ours) == read(&theirs));
}

#[test]
fn the_example_refuses_what_it_does_not_know() {
    let parse = |words: &[&str]| cornell::Options::parse(lexopt::Parser::from_args(words));
    assert!(parse(&["--help"]).expect("a good word").is_none());
    for (words, message) in [
        (&["--scene", "2"][..], "globillum cornell --help"),
        (&["--width", "many"], "many"),
        (&["--spp"], "--spp"),
        (&["box"], "box"),
    ] {
        let said = parse(words).err().expect("bad words").to_string();
        assert!(said.contains(message) && said.lines().count() == 1, "{said}");
    }
}
