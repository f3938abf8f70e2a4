//! Scenes whose files are in memory.
#![cfg(all(feature = "obj", feature = "gltf"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]

use globillum_io::{IoError, Limits, Loaded, Loader, Place, WarningKind};
use globillum_material::{Material, Rgb};
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

/// A glTF file of two triangles whose corners are in these buffers.
fn of_two_buffers(uris: [&str; 2]) -> Vec<u8> {
    let json = json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 1}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 1, "byteLength": 36}],
        "buffers": uris.map(|uri| json!({"byteLength": 36, "uri": uri})),
    });
    json.to_string().into_bytes()
}

/// Two files in memory are two, also if their names on disk are of one file.
#[test]
#[cfg(unix)]
fn links_on_disk_do_not_count() {
    let folder = tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("a.bin"), b"on disk").unwrap();
    std::os::unix::fs::symlink(path("a.bin"), path("b.bin")).unwrap();
    let (_, first) = gltf();
    let second: Vec<u8> =
        first.as_chunks::<4>().0.iter().flat_map(|x| (2.0 * f32::from_le_bytes(*x)).to_le_bytes()).collect();
    let scene = of_two_buffers(["a.bin", "b.bin"]);
    let names = ["c.gltf", "a.bin", "b.bin"].map(path);
    let files: Vec<(&str, &[u8])> =
        names.iter().map(String::as_str).zip([&*scene, &first, &second]).collect();
    let loaded = Loader::new().files(&files).load(&names[0]).unwrap();
    let corners = loaded.model.triangles().iter().map(|triangle| triangle.vertices[1].x);
    assert!(corners.eq([1.0, 2.0]), "{:?}", loaded.model.triangles());
}

/// A file of two names is read once, and so counts once.
#[test]
fn a_file_of_two_names_counts_once() {
    let (scene, (_, bin)) = (of_two_buffers(["a.bin", "./a.bin"]), gltf());
    let mut limits = Limits::default();
    limits.bytes = (scene.len() + bin.len()) as u64;
    let files: [(&str, &[u8]); 2] = [("c.gltf", &scene), ("a.bin", &bin)];
    let loaded = Loader::new().limits(limits).files(&files).load("c.gltf").unwrap();
    assert_eq!((loaded.model.triangles().len(), loaded.files.len()), (2, 2));
}

#[test]
fn of_equal_names_the_first_counts_and_case_does_too() {
    let other: &[u8] = b"newmtl blue\n";
    let files: [(&str, &[u8]); 4] = [
        ("a.obj", OBJ),
        ("materials/ALL.mtl", other),
        ("./materials/all.mtl", MTL),
        ("materials/all.mtl", other),
    ];
    let loaded = Loader::new().files(&files).load("a.obj").unwrap();
    let red = loaded.model.material(0);
    assert_eq!(red.bsdf, Material::lambert(Rgb::new(0.75, 0.25, 0.125)).unwrap().bsdf);
    assert!(Loader::new().files(&files[..2]).load("A.obj").is_err());
    let kind = &Loader::new().files(&files[..2]).load("a.obj").unwrap().report.warnings[0].kind;
    assert!(matches!(kind, WarningKind::MissingLibrary { .. }), "{kind:?}");
}

#[test]
fn bad_files_in_memory_are_errors() {
    let load = |name: &str, bytes: &[u8]| Loader::new().files(&[(name, bytes)]).load(name).unwrap_err();
    assert!(matches!(load("a.obj", b""), IoError::Parse { at, .. } if at.path == Path::new("a.obj")));
    assert!(matches!(load("a.stl", b"solid"), IoError::UnknownScene { .. }));
    for above in ["../a.mtl", "..\\a.mtl", "/a.mtl"] {
        let obj = format!("mtllib {above}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let error = load("b/a.obj", obj.as_bytes());
        assert!(matches!(&error, IoError::PathEscape { .. }), "{above}: {error}");
    }
    let obj: &[u8] = b"mtllib .\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let folder = Loader::new().files(&[("b/a.obj", obj), ("b", MTL)]).load("b/a.obj").unwrap_err();
    assert!(folder.to_string().contains("is not a regular file"), "{folder}");

    let mut limits = Limits::default();
    limits.bytes = (OBJ.len() + MTL.len()) as u64;
    let files: [(&str, &[u8]); 2] = [("a.obj", OBJ), ("materials/all.mtl", MTL)];
    assert!(Loader::new().limits(limits).files(&files).load("a.obj").is_ok());
    limits.bytes -= 1;
    let error = Loader::new().limits(limits).files(&files).load("a.obj").unwrap_err();
    assert!(matches!(error, IoError::TooLarge { limit, .. } if limit == limits.bytes), "{error}");
}
