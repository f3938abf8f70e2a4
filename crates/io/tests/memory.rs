//! Scenes whose files are in memory.
#![cfg(all(feature = "obj", feature = "gltf"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]

use globillum_io::{IoError, Limits, Loaded, Loader, Place, WarningKind};
use serde_json::json;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

const OBJ: &[u8] = b"mtllib ./materials\\all.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
const MTL: &[u8] = b"newmtl red\nKd 0.75 0.25 0.125\n";

/// A glTF file of one triangle whose buffer is another file, and that file.
fn gltf() -> (Vec<u8>, Vec<u8>) {
    let json = json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "my%20data.bin"}],
    });
    let corners = [0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    (json.to_string().into_bytes(), corners.iter().flat_map(|x| x.to_le_bytes()).collect())
}

/// All that a file says, without the place of its folder.
fn content(loaded: &Loaded) -> String {
    let Loaded { model, cameras, materials, report, objects, .. } = loaded;
    let kinds: Vec<_> = report.warnings.iter().map(|warning| (warning.at.place, &warning.kind)).collect();
    format!("{:?} {:?} {cameras:?} {materials:?} {kinds:?} {objects:?}", model.triangles(), model.materials())
}

#[test]
fn a_scene_in_memory_is_that_on_disk() {
    let (gltf, bin) = gltf();
    let files: [(&str, &[u8]); 4] = [
        ("scene/a.obj", OBJ),
        ("scene/materials/all.mtl", MTL),
        ("scene/b.gltf", &gltf),
        ("scene/my data.bin", &bin),
    ];
    let folder = tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    for name in ["scene/a.obj", "scene/b.gltf"] {
        let loader = Loader::new().keep_objects();
        let on_disk = loader.load(folder.path().join(name)).unwrap();
        let in_memory = loader.files(&files).load(name).unwrap();
        assert_eq!(content(&in_memory), content(&on_disk), "{name}");
        assert_eq!(in_memory.model.triangles().len(), 1, "{name}");
        let of_folder: Vec<_> =
            on_disk.files.iter().map(|file| file.strip_prefix(folder.path()).unwrap()).collect();
        assert_eq!(in_memory.files, of_folder, "{name}");
        assert!(loader.files(&files).load(format!("./{name}")).is_ok(), "{name}");
    }
}

/// Files that exist, but not in memory, are not found.
#[test]
fn no_file_on_disk_is_read() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (gltf, bin) = gltf();
    fs::write(path("a.obj"), OBJ).unwrap();
    fs::create_dir(path("materials")).unwrap();
    fs::write(path("materials/all.mtl"), MTL).unwrap();
    fs::write(path("my data.bin"), bin).unwrap();

    let error = Loader::new().files(&[]).load(path("a.obj")).unwrap_err();
    let is_missing = |source: &std::io::Error| source.kind() == std::io::ErrorKind::NotFound;
    assert!(
        matches!(&error, IoError::Read { path, source } if is_missing(source) && path.ends_with("a.obj"))
    );

    let loaded = Loader::new().files(&[(&path("a.obj"), OBJ)]).load(path("a.obj")).unwrap();
    let warning = &loaded.report.warnings[0];
    let name = "./materials\\all.mtl".into();
    assert_eq!((warning.at.place, &warning.kind), (Place::Line(1), &WarningKind::MissingLibrary { name }));

    let error = Loader::new().files(&[(&path("b.gltf"), &gltf)]).load(path("b.gltf")).unwrap_err();
    let IoError::Reference { at, name, source } = error else { panic!("{error}") };
    assert!(at.place == Place::Buffer(0) && name == "my data.bin" && is_missing(&source), "{at}: {source}");
}

#[test]
fn bad_files_in_memory_are_errors() {
    let load = |name: &str, bytes: &[u8]| Loader::new().files(&[(name, bytes)]).load(name).unwrap_err();
    assert!(matches!(load("a.obj", b""), IoError::Parse { at, .. } if at.path == Path::new("a.obj")));
    assert!(matches!(load("a.stl", b"solid"), IoError::UnknownScene { .. }));
    let above = load("b/a.obj", b"mtllib ../a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(matches!(above, IoError::PathEscape { name, .. } if name == "../a.mtl"));

    let mut limits = Limits::default();
    limits.bytes = (OBJ.len() + MTL.len()) as u64;
    let files: [(&str, &[u8]); 2] = [("a.obj", OBJ), ("materials/all.mtl", MTL)];
    assert!(Loader::new().limits(limits).files(&files).load("a.obj").is_ok());
    limits.bytes -= 1;
    let error = Loader::new().limits(limits).files(&files).load("a.obj").unwrap_err();
    assert!(matches!(error, IoError::TooLarge { limit, .. } if limit == limits.bytes), "{error}");
}
