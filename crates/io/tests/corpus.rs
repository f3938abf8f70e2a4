//! The corpus of the fuzzer: each file is a scene, or an error with a message of one line.
#![cfg(all(feature = "obj", feature = "gltf"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]

mod files;

use files::Files;
use std::path::Path;

/// Loads `scene` from the files that `files` makes of each file of a corpus.
fn replay(corpus: &str, scene: &str, files: impl Fn(&[u8]) -> Files) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(corpus);
    let mut loaded = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match files(&std::fs::read(&path).unwrap()).load(scene) {
            Ok(_) => loaded += 1,
            Err(error) => assert_eq!(error.to_string().lines().count(), 1, "{}: {error}", path.display()),
        }
    }
    assert!(loaded > 0, "{corpus}: not one file is good");
}

#[test]
fn obj() {
    replay("obj", "a.obj", |bytes| Files::new(&[("a.obj", bytes), ("a.mtl", b"newmtl m\nKe 1\n")]));
}

#[test]
fn mtl() {
    let obj = b"mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    replay("mtl", "a.obj", |bytes| Files::new(&[("a.obj", obj), ("a.mtl", bytes)]));
}

#[test]
fn gltf() {
    replay("gltf", "a.gltf", |bytes| Files::new(&[("a.gltf", bytes)]));
}

#[test]
fn glb() {
    replay("glb", "a.glb", |bytes| Files::new(&[("a.glb", bytes)]));
}
