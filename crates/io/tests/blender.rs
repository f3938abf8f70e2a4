//! Files that Blender's own exporters wrote (`blender/make.py`), beside what Blender says of them.
#![cfg(all(feature = "obj", feature = "gltf"))]

use glam::{DMat4, DVec3};
use globillum_integrator::DeltaLight;
use globillum_io::{Loaded, WarningKind, load};
use globillum_material::{Emission, Material, Rgb, Sides};
use serde_json::Value;
use std::f64::consts::PI;
use std::path::PathBuf;

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/blender").join(name)
}

fn loaded(name: &str) -> Loaded {
    load(path(name)).unwrap_or_else(|error| panic!("{error}"))
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
        ("room", &["room.obj", "room_pbr.obj", "room.glb"][..]),
        ("room_plain", &["room_plain.obj", "room_plain.glb"]),
        ("startup", &["startup.glb"]),
        ("spot", &["spot.glb"]),
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

/// The transform of an object of Blender, to glTF's frame (y up).
fn placed(object: &Value) -> DMat4 {
    let rows = object["matrix"].as_array().expect("rows");
    let number = |row: usize, column: usize| rows[row][column].as_f64().expect("a number");
    let matrix = DMat4::from_cols_array(&std::array::from_fn(|i| number(i % 4, i / 4)));
    DMat4::from_rotation_x(-PI / 2.0) * matrix
}

/// The delta light that an object of Blender is, by Blender's units: watts, of a sun watts per square metre.
fn delta_light(object: &Value) -> DeltaLight {
    let number = |key: &str| object[key].as_f64().expect("a number");
    let colour: [f64; 3] = std::array::from_fn(|i| object["colour"][i].as_f64().expect("a number"));
    let watts = Rgb::from(colour) * number("energy");
    let matrix = placed(object);
    let position = matrix.transform_point3(DVec3::ZERO).as_vec3();
    let direction = matrix.transform_vector3(DVec3::NEG_Z).as_vec3();
    let light = match object["light"].as_str().expect("a name") {
        "SUN" => DeltaLight::directional(direction, watts),
        "POINT" => DeltaLight::point(position, watts / (4.0 * PI)),
        _ => {
            let outer = number("outer_angle");
            let inner = (outer * (1.0 - number("blend"))).min(outer.next_down());
            DeltaLight::spot(position, direction, watts / (4.0 * PI), inner, outer)
        }
    };
    light.expect("it is valid")
}

/// The numbers in the text of `value`.
fn numbers(value: &impl std::fmt::Debug) -> Vec<f64> {
    let text = format!("{value:?}");
    let parts = text.split(|c: char| !(c.is_ascii_digit() || ".-e".contains(c)));
    parts.filter_map(|part| part.parse().ok()).collect()
}

#[test]
fn delta_lights_are_where_blender_has_them() {
    for (scene, name, count) in [
        ("startup", "startup.glb", 1),
        ("room", "room.glb", 3),
        ("room_plain", "room_plain.glb", 3),
        ("spot", "spot.glb", 1),
    ] {
        let loaded = loaded(name);
        let found = loaded.model.delta_lights();
        let expected: Vec<_> =
            objects(scene).iter().filter(|o| o["type"] == "LIGHT").map(delta_light).collect();
        assert_eq!((found.len(), expected.len()), (count, count), "{name}");
        for light in expected {
            let near = |other: &&DeltaLight| {
                let (a, b) = (numbers(&light), numbers(other));
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 2e-6 * (1.0 + a.abs()))
            };
            assert!(found.iter().any(|other| near(&other)), "{name}: {light:?} is not in {found:?}");
        }
        assert!(loaded.report.warnings.iter().all(|warning| warning.kind != WarningKind::NoLight), "{name}");
    }
}

#[test]
fn instances_and_mirrored_objects_lie_where_blender_has_them() {
    // The wedge is the last mesh of the room: six triangles for each of its three objects.
    let model = loaded("room.glb").model;
    let wedges = &model.triangles()[model.triangles().len() - 18..];
    let corners = [[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.4, 0.3, 0.0], [0.0, 0.3, 0.0], [0.1, 0.1, 0.6]];
    let room = objects("room");
    let of_wedges: Vec<_> = room.iter().filter(|object| object["material"] == "clay").map(placed).collect();
    for (triangles, name) in wedges.chunks(6).zip(["wedge", "instance", "mirrored"]) {
        let is_there = |matrix: &&DMat4| {
            corners.iter().all(|&corner| {
                let corner = matrix.transform_point3(DVec3::from(corner)).as_vec3();
                triangles.iter().flat_map(|t| t.vertices).any(|vertex| vertex.distance(corner) < 1e-6)
            })
        };
        let matrix = of_wedges.iter().find(is_there).unwrap_or_else(|| panic!("{name} is elsewhere"));
        // All faces look outward, which a mirrored object must keep.
        let middle = matrix.transform_point3(DVec3::new(0.2, 0.15, 0.1));
        assert!(triangles.iter().all(|t| t.normal().dot(t.vertices[0].as_dvec3() - middle) > 0.0), "{name}");
    }
}

#[test]
fn a_room_equals_its_twin_without_textures() {
    let (room, plain) = (loaded("room.glb"), loaded("room_plain.glb"));
    assert_eq!(room.model, plain.model);
    assert_eq!(room.cameras, plain.cameras);
    let ignored = |name: &str| WarningKind::TexturesIgnored { name: name.into() };
    let textures = |loaded: &Loaded| {
        let kinds = loaded.report.warnings.iter().map(|warning| &warning.kind);
        kinds.filter(|kind| matches!(kind, WarningKind::TexturesIgnored { .. })).cloned().collect::<Vec<_>>()
    };
    assert_eq!((textures(&room), textures(&plain)), (vec![ignored("floor")], vec![]));
}

#[test]
fn metals_are_mirrors_and_dielectrics_are_diffuse() {
    let model = loaded("room.glb").model;
    let rgb = |rgb: [f32; 3]| Rgb::from(rgb.map(f64::from));
    let lambert = |colour| Material::lambert(rgb(colour)).expect("it is valid").bsdf;
    let bsdf = |index: usize| model.materials()[index].bsdf;
    assert_eq!(bsdf(1), lambert([0.75, 0.75, 0.75]));
    assert_eq!(bsdf(5), Material::mirror(rgb([0.9, 0.7, 0.3])).expect("it is valid").bsdf);
    assert_eq!(bsdf(6), lambert([0.15, 0.25, 0.7]));
    assert_eq!(bsdf(4), lambert([0.0; 3]));
    let radiance = rgb([1.0, 0.9, 0.8]) * 6.0;
    assert_eq!(model.materials()[4].emission, Emission::new(radiance, Sides::Both).expect("it is valid"));
}
