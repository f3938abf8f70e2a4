//! Files that Blender's own exporters wrote (`blender/make.py`), beside what Blender says of them.
#![cfg(all(feature = "obj", feature = "gltf"))]

use globillum_io::{Loaded, load};
use serde_json::Value;
use std::path::PathBuf;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/blender").join(name)
}

fn loaded(name: &str) -> Loaded {
    load(&path(name)).unwrap_or_else(|error| panic!("{error}"))
}

/// The objects of a scene in Blender.
fn objects(scene: &str) -> Vec<Value> {
    let text = std::fs::read(path("truth.json")).expect("it is beside the files");
    let truth: Value = serde_json::from_slice(&text).expect("it is JSON");
    truth[scene].as_object().expect("an object for each scene").values().cloned().collect()
}

#[test]
fn every_triangle_is_there() {
    for (scene, names) in [
        ("room", &["room.obj", "room_pbr.obj"][..]),
        ("room_plain_obj", &["room_plain.obj"]),
        ("bust", &["bust.obj"]),
        ("flat", &["flat.glb"]),
    ] {
        let expected: u64 = objects(scene).iter().filter_map(|object| object["triangles"].as_u64()).sum();
        for name in names {
            let found = loaded(name);
            assert_eq!(found.model.triangles().len() as u64, expected, "{name}");
            assert_eq!(found.report.degenerate_triangles, 0, "{name}");
        }
    }
}
