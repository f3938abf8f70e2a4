//! Valid glTF files.
#![cfg(feature = "gltf")]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]
#![allow(clippy::print_stderr, reason = "a skipped test prints a message")]

mod files;

use files::{Files, floats};
use glam::{DVec3, Vec3};
use globillum_geom::Triangle;
use globillum_integrator::{DeltaLight, PinholeCamera};
use globillum_io::{IoError, LoadMonitor, LoadProgress, Loaded, Loader, Place, WarningKind};
use globillum_material::{Emission, Material, Rgb, Sides};
use globillum_testkit::bad_input::glb;
use serde_json::{Value, json};
use std::cell::Cell;
use std::path::{Path, PathBuf};

/// Corners of a unit square, counter-clockwise.
const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

fn triangles(corners: &[[usize; 3]]) -> Vec<Triangle> {
    let at = |i: usize| Vec3::from(SQUARE[i]);
    corners.iter().map(|&[a, b, c]| Triangle::new(at(a), at(b), at(c))).collect()
}

/// A file whose first accessor has the first three positions of the square, with the members of `more`.
fn square(more: &Value) -> (Value, Vec<u8>) {
    let mut json = json!({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}],
        "buffers": [{"byteLength": 48}],
    });
    for (key, value) in more.as_object().unwrap() {
        json[key] = value.clone();
    }
    (json, floats(SQUARE.as_flattened()))
}

fn load((json, binary): (Value, Vec<u8>)) -> Loaded {
    Files::new(&[("a.glb", &glb(&json.to_string(), &binary))]).load("a.glb").unwrap()
}

/// All warnings except [`WarningKind::NoLight`].
fn warnings(loaded: &Loaded) -> Vec<(Place, WarningKind)> {
    let warnings = loaded.report.warnings.iter().filter(|w| w.kind != WarningKind::NoLight);
    warnings.map(|w| (w.at.place, w.kind.clone())).collect()
}

/// The square with indices of this component type, in this mode.
fn indexed(mode: u32, component_type: u32, indices: &[u32]) -> Loaded {
    let size = match component_type {
        5121 => 1,
        5123 => 2,
        _ => 4,
    };
    let (mut json, mut binary) = square(&json!({
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}]}],
    }));
    let length = indices.len() * size;
    let accessor =
        json!({"bufferView": 1, "componentType": component_type, "count": indices.len(), "type": "SCALAR"});
    json["accessors"][0]["count"] = json!(4);
    json["accessors"].as_array_mut().unwrap().push(accessor);
    let view = json!({"buffer": 0, "byteOffset": 48, "byteLength": length});
    json["bufferViews"].as_array_mut().unwrap().push(view);
    json["buffers"][0]["byteLength"] = json!(48 + length);
    binary.extend(indices.iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()));
    load((json, binary))
}

#[test]
fn all_modes_and_all_index_types_make_the_same_triangles() {
    let expected = triangles(&[[0, 1, 2], [0, 2, 3]]);
    for component_type in [5121, 5123, 5125] {
        let loaded = indexed(4, component_type, &[0, 1, 2, 0, 2, 3]);
        assert_eq!(loaded.model.triangles(), expected, "{component_type}");
        assert_eq!(warnings(&loaded), []);
    }
    assert_eq!(indexed(6, 5123, &[0, 1, 2, 3]).model.triangles(), expected);
    // All triangles of a strip have the same front.
    assert_eq!(indexed(5, 5123, &[0, 1, 3, 2]).model.triangles(), triangles(&[[0, 1, 3], [1, 2, 3]]));
    let odd = indexed(4, 5121, &[0, 1, 2, 0, 2]);
    assert_eq!(odd.model.triangles(), triangles(&[[0, 1, 2]]));
    let place = Place::Primitive { mesh: 0, primitive: 0 };
    assert_eq!(warnings(&odd), [(place, WarningKind::LeftOver { count: 2 })]);
}

#[test]
fn without_indices_vertices_follow_each_other() {
    let fan = json!({
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
    });
    assert_eq!(load(square(&fan)).model.triangles(), triangles(&[[0, 1, 2], [0, 2, 3]]));
}

#[test]
fn a_vertex_that_is_not_finite_is_named() {
    for (vertex, x) in [(1, f32::NAN), (3, f32::INFINITY)] {
        // The vertices in reverse: a corner has another number than its vertex.
        let (json, mut binary) = square(&json!({
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 6}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 4}],
            "buffers": [{"byteLength": 52}],
        }));
        binary[12 * vertex + 8..12 * vertex + 12].copy_from_slice(&x.to_le_bytes());
        binary.extend([3, 2, 1, 0]);
        let files = Files::new(&[("a.glb", &glb(&json.to_string(), &binary))]);
        let error = files.load("a.glb").unwrap_err();
        let message = format!(
            "a.glb: meshes[0].primitives[0], vertex {vertex}: coordinate is not finite in single precision"
        );
        assert_eq!(files.shortened(&error), message);
        let IoError::NonFinite { at } = error else { panic!("{error}") };
        assert_eq!(at.place, Place::Vertex { mesh: 0, primitive: 0, vertex });
    }
}

#[test]
fn interleaved_vertices_are_read_by_their_stride() {
    let (json, _) = square(&json!({
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0}, "mode": 6}]}],
        "accessors": [{"bufferView": 0, "byteOffset": 4, "componentType": 5126, "count": 4, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 8, "byteLength": 88, "byteStride": 24}],
        "buffers": [{"byteLength": 96}],
    }));
    let between = [9.0; 3];
    let all: Vec<_> = SQUARE.iter().flat_map(|v| between.iter().chain(v)).copied().collect();
    let loaded = load((json, floats(&all)));
    assert_eq!(loaded.model.triangles(), triangles(&[[0, 1, 2], [0, 2, 3]]));
    let place = Place::Primitive { mesh: 0, primitive: 0 };
    assert_eq!(warnings(&loaded), [(place, WarningKind::NormalsIgnored { count: 4 })]);
}

#[test]
fn colors_of_vertices_and_missing_copies_are_named() {
    let file = square(&json!({
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 0}, "mode": 6}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
        "extensionsUsed": ["EXT_mesh_gpu_instancing", "KHR_materials_clearcoat"],
    }));
    let loaded = load(file);
    let place = Place::Primitive { mesh: 0, primitive: 0 };
    assert!(warnings(&loaded).contains(&(place, WarningKind::ColorsIgnored { count: 4 })), "{loaded:?}");
    let texts: Vec<_> = loaded.report.warnings.iter().map(|warning| warning.kind.to_string()).collect();
    for text in [
        "vertex colours are ignored: 4",
        "extension `EXT_mesh_gpu_instancing` is ignored: copies of meshes are missing",
        "extension `KHR_materials_clearcoat` is ignored",
    ] {
        assert!(texts.iter().any(|found| found == text), "{texts:?}");
    }
}

#[test]
fn sparse_accessors_replace_single_elements() {
    // Vertex 2 has a sparse replacement. Without a buffer view the other vertices are zero.
    let sparse = json!({
        "count": 1,
        "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 1, "byteOffset": 4},
    });
    let view = json!([{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 16}]);
    let accessor =
        json!({"componentType": 5126, "count": 4, "type": "VEC3", "sparse": sparse, "bufferView": 0});
    let (json, mut binary) = square(&json!({
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]}],
        "accessors": [accessor],
        "bufferViews": view,
        "buffers": [{"byteLength": 64}],
    }));
    binary.extend([2, 0, 0, 0]);
    binary.extend(floats(&[5.0, 6.0, 7.0]));
    let loaded = load((json.clone(), binary.clone()));
    let moved = Vec3::new(5.0, 6.0, 7.0);
    assert_eq!(loaded.model.triangles()[0].vertices, [Vec3::ZERO, Vec3::X, moved]);
    assert_eq!(loaded.model.triangles()[1].vertices, [Vec3::ZERO, moved, Vec3::Y]);
    let mut alone = json;
    alone["accessors"][0].as_object_mut().unwrap().remove("bufferView");
    let files = Files::new(&[("a.glb", &glb(&alone.to_string(), &binary))]);
    assert!(files.load("a.glb").is_err(), "all but one vertex are zero: nothing has an area");
}

#[test]
fn buffers_lie_in_uris_and_in_files_beside_the_scene() {
    let (mut json, binary) = square(&json!({}));
    json["buffers"][0]["uri"] = json!("my%20data/a.bin");
    let files = Files::new(&[("a.gltf", json.to_string().as_bytes())]);
    std::fs::create_dir(files.path("my data")).unwrap();
    std::fs::write(files.path("my data/a.bin"), &binary).unwrap();
    let loaded = files.load("a.gltf").unwrap();
    assert_eq!(loaded.model.triangles(), triangles(&[[0, 1, 2]]));
    assert_eq!(loaded.files, ["a.gltf", "my data/a.bin"].map(|name| files.path(name)));
    // Percent encoding. The unit tests of `uri` cover base64.
    let data: String = binary.iter().map(|byte| format!("%{byte:02x}")).collect();
    json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream,{data}"));
    let files = Files::new(&[("a.gltf", json.to_string().as_bytes())]);
    assert_eq!(files.load("a.gltf").unwrap().model.triangles(), triangles(&[[0, 1, 2]]));
}

/// The vertices of the square's first triangle, placed by these nodes.
fn placed(nodes: &Value) -> Vec<[Vec3; 3]> {
    load(square(&json!({"nodes": nodes}))).model.triangles().iter().map(|t| t.vertices).collect()
}

#[test]
fn nodes_move_what_they_hold() {
    let corners = |f: fn(Vec3) -> Vec3| [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0)].map(f);
    let moved = json!([{"translation": [1, 2, 3], "children": [1]}, {"mesh": 0, "scale": [2, 2, 2]}]);
    assert_eq!(placed(&moved), [corners(|v| 2.0 * v + Vec3::new(1.0, 2.0, 3.0))]);
    let turned = json!([{"mesh": 0, "rotation": [0, 0, 1.0009, 0]}]);
    assert_eq!(placed(&turned), [corners(|v| Vec3::new(-v.x, -v.y, v.z))]);
    let matrix = json!([{"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 7, 0, 0, 1]}]);
    assert_eq!(placed(&matrix), [corners(|v| Vec3::new(7.0 - v.y, v.x, v.z))]);
}

#[test]
fn a_mirrored_triangle_keeps_its_front() {
    let mirrored = [Vec3::ZERO, Vec3::new(-1.0, 1.0, 0.0), Vec3::new(-1.0, 0.0, 0.0)];
    assert_eq!(placed(&json!([{"mesh": 0, "scale": [-1, 1, 1]}])), [mirrored]);
    let twice = json!([{"scale": [-1, 1, 1], "children": [1]}, {"mesh": 0, "scale": [-1, 1, 1]}]);
    assert_eq!(placed(&twice), placed(&json!([{"mesh": 0}])));
}

#[test]
fn the_files_own_scene_is_loaded_and_children_come_in_order() {
    let graph = json!([
        {"mesh": 0, "translation": [9, 9, 9]},
        {"children": [2, 3]},
        {"mesh": 0, "translation": [1, 0, 0]},
        {"mesh": 0, "translation": [2, 0, 0]},
    ]);
    let scenes = json!({"nodes": graph, "scene": 1, "scenes": [{"nodes": [0]}, {"nodes": [1]}]});
    let loaded = load(square(&scenes));
    let firsts: Vec<_> = loaded.model.triangles().iter().map(|t| t.vertices[0].x).collect();
    assert_eq!(firsts, [1.0, 2.0]);
}

#[test]
fn materials_become_the_nearer_of_two() {
    let lambert = |x| Material::lambert(Rgb::splat(x)).unwrap();
    let mirror = |x| Material::mirror(Rgb::splat(x)).unwrap();
    let base = |metallic: f64, roughness: f64| {
        json!({"name": "m", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1],
            "metallicFactor": metallic, "roughnessFactor": roughness}})
    };
    let extended = |roughness: f64, extension: &str, factor: &str, value: f64| {
        let mut material = base(0.0, roughness);
        material["extensions"] = json!({format!("KHR_materials_{extension}"): {factor: value}});
        material
    };
    let approximated = |by| vec![WarningKind::Approximated { name: "m".into(), by }];
    let (diffuse, specular) = ("an ideal diffuse surface", "an ideal mirror");
    let cases = [
        (base(0.0, 1.0), lambert(0.5), vec![]),
        (base(1.0, 0.0), mirror(0.5), vec![]),
        (base(0.0, 0.0), lambert(0.5), approximated(diffuse)),
        (base(1.0, 0.9), mirror(0.5), approximated(specular)),
        (base(0.3, 0.4), lambert(0.5), approximated(diffuse)),
        (json!({"name": "m"}), lambert(1.0), vec![WarningKind::Unspecified { name: "m".into() }]),
        (extended(0.5, "specular", "specularFactor", 0.0), lambert(0.5), vec![]),
        (extended(0.5, "specular", "specularFactor", 0.1), lambert(0.5), approximated(diffuse)),
        (extended(1.0, "transmission", "transmissionFactor", 0.0), lambert(0.5), vec![]),
        (
            extended(1.0, "transmission", "transmissionFactor", 0.5),
            lambert(0.5),
            vec![WarningKind::TransparencyIgnored { name: "m".into() }],
        ),
        // With a texture, the factor 1 says nothing. Blender writes this for a metallic input with a texture.
        (
            json!({"name": "m", "pbrMetallicRoughness":
                {"metallicRoughnessTexture": {"index": 0}, "roughnessFactor": 0.5}}),
            lambert(1.0),
            vec![
                WarningKind::TexturesIgnored { name: "m".into() },
                WarningKind::Approximated { name: "m".into(), by: diffuse },
            ],
        ),
        (
            json!({"name": "m", "alphaMode": "BLEND", "pbrMetallicRoughness":
                {"metallicFactor": 0, "baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": {"index": 0}}}),
            lambert(0.25),
            vec![
                WarningKind::TexturesIgnored { name: "m".into() },
                WarningKind::TransparencyIgnored { name: "m".into() },
            ],
        ),
        (
            json!({"name": "m", "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0},
                "pbrMetallicRoughness": {"metallicFactor": 0}}),
            lambert(1.0),
            vec![WarningKind::EmissionIgnored { name: "m".into() }],
        ),
        (
            json!({"name": "m", "emissiveTexture": {"index": 0}, "pbrMetallicRoughness": {"metallicFactor": 0}}),
            lambert(1.0),
            vec![],
        ),
    ];
    for (json, expected, kinds) in cases {
        let (json, binary) = square(&json!({
            "materials": [json],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        }));
        let loaded = load((json.clone(), binary));
        assert_eq!(*loaded.model.material(0), expected, "{json}");
        let expected: Vec<_> = kinds.into_iter().map(|kind| (Place::Material(0), kind)).collect();
        assert_eq!(warnings(&loaded), expected, "{json}");
    }
    assert_eq!(*load(square(&json!({}))).model.material(0), lambert(1.0));
}

#[test]
fn lights_shine_with_their_strength_from_the_sides_they_have() {
    for (double_sided, sides) in [(false, Sides::Front), (true, Sides::Both)] {
        let light = json!({
            "emissiveFactor": [1, 0.5, 0.25], "doubleSided": double_sided,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
            "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]},
        });
        let loaded = load(square(&json!({
            "materials": [light],
            "extensionsUsed": ["KHR_materials_emissive_strength"],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        })));
        let emission = Emission::new(Rgb::new(8.0, 4.0, 2.0), sides).unwrap();
        assert_eq!(loaded.model.material(0).emission, emission);
        assert_eq!(loaded.report.warnings, []);
    }
}

#[test]
fn perspective_cameras_are_placed_by_their_nodes() {
    let loaded = load(square(&json!({
        "nodes": [
            {"mesh": 0}, {"translation": [0, 0, 3], "children": [2, 3, 4, 5, 6]},
            {"camera": 0}, {"camera": 1}, {"camera": 2}, {"camera": 3}, {"camera": 4},
        ],
        "cameras": [
            {"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1.5, "znear": 0.1}},
            {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1}},
            {"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 0, "znear": 0.1}},
            {"type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1e300, "znear": 0.1}},
            {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}},
        ],
    })));
    let expected = PinholeCamera::look_at(DVec3::Z * 3.0, DVec3::ZERO, DVec3::Y, 0.7_f32.into()).unwrap();
    assert_eq!(warnings(&loaded), [(Place::Camera(1), WarningKind::CameraIgnored)]);
    assert_eq!(loaded.cameras, [expected; 4]);
    assert_eq!(loaded.aspect_ratios, [Some(1.5), None, None, None]);
}

#[test]
fn cameras_that_their_nodes_flatten_are_left_out() {
    let loaded = load(square(&json!({
        "nodes": [
            {"mesh": 0},
            {"camera": 0, "scale": [0, 0, 0]},
            {"camera": 0, "scale": [1, 0, 1], "translation": [0, 0.3, 3]},
            {"scale": [1, 1, 0], "children": [4]},
            {"camera": 0},
            {"camera": 0, "scale": [0, 1, 1], "translation": [0, 0, 3]},
        ],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}],
    })));
    let expected = PinholeCamera::look_at(DVec3::Z * 3.0, DVec3::ZERO, DVec3::Y, 0.7_f32.into()).unwrap();
    assert_eq!(loaded.cameras, [expected]);
    let flattened = [1, 2, 4].map(|node| (Place::Node(node), WarningKind::CameraFlattened));
    assert_eq!(warnings(&loaded), flattened);
}

/// The members of a file with these lights, each of them at a node.
fn lit(lights: &Value, nodes: &[Value]) -> Value {
    let extend = |(i, node): (usize, &Value)| {
        let mut node = node.clone();
        node["extensions"] = json!({"KHR_lights_punctual": {"light": i}});
        node
    };
    let nodes: Vec<_> = nodes.iter().enumerate().map(extend).chain([json!({"mesh": 0})]).collect();
    json!({"extensions": {"KHR_lights_punctual": {"lights": lights}}, "nodes": nodes,
        "extensionsRequired": ["KHR_lights_punctual"]})
}

#[test]
fn delta_lights_shine_along_their_nodes() {
    let lights = json!([
        {"type": "point", "color": [1, 0.5, 0.25], "intensity": 1366},
        {"type": "spot", "intensity": 683, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
        {"type": "directional", "intensity": 341.5},
        {"type": "spot", "spot": {}},
    ]);
    // The second is turned by 180 degrees about y and scaled, which does not change its intensity.
    let nodes = [
        json!({"translation": [1, 2, 3], "scale": [5, 5, 5]}),
        json!({"rotation": [0, 1, 0, 0], "scale": [2, 3, 4]}),
        json!({"matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1]}),
        json!({}),
    ];
    let loaded = load(square(&lit(&lights, &nodes)));
    let (grey, down) = (Rgb::splat, Vec3::NEG_Z);
    let expected = [
        DeltaLight::point(Vec3::new(1.0, 2.0, 3.0), Rgb::new(2.0, 1.0, 0.5)),
        DeltaLight::spot(Vec3::ZERO, Vec3::Z, grey(1.0), 0.25, 0.5),
        DeltaLight::directional(Vec3::Y, grey(0.5)),
        DeltaLight::spot(Vec3::ZERO, down, grey(1.0 / 683.0), 0.0, std::f32::consts::FRAC_PI_4.into()),
    ];
    assert_eq!(loaded.model.delta_lights(), expected.map(Result::unwrap));
    assert_eq!(loaded.report.warnings, []);
}

#[test]
fn the_luminous_efficacy_scales_delta_lights_only() {
    let (json, binary) = square(&lit(&json!([{"type": "point", "intensity": 100}]), &[json!({})]));
    let files = Files::new(&[("a.glb", &glb(&json.to_string(), &binary))]);
    let loaded = Loader::new().luminous_efficacy(50.0).load(files.path("a.glb")).unwrap();
    assert_eq!(loaded.model.delta_lights(), [DeltaLight::point(Vec3::ZERO, Rgb::splat(2.0)).unwrap()]);
    for efficacy in [0.0, -1.0, f64::NAN] {
        let error = Loader::new().luminous_efficacy(efficacy).load(files.path("a.glb")).unwrap_err();
        assert!(matches!(error, IoError::Light { .. }), "{error}");
    }
}

#[test]
fn a_light_without_a_direction_is_ignored() {
    let lights = json!([{"type": "directional"}, {"type": "point"}, {"type": "spot", "spot": {}}]);
    let hidden = || json!({"scale": [0, 0, 0]});
    let loaded = load(square(&lit(&lights, &[hidden(), hidden(), hidden()])));
    assert_eq!(loaded.model.delta_lights().len(), 1);
    let ignored = [0, 2].map(|node| (Place::Node(node), WarningKind::LightIgnored));
    assert_eq!(warnings(&loaded), ignored);
}

#[test]
fn what_moves_stands_still_and_is_reported() {
    let loaded = load(square(&json!({
        "nodes": [{"mesh": 0, "skin": 0}],
        "skins": [{"joints": [0]}],
        "animations": [{"channels": [], "samplers": []}],
    })));
    let expected = [
        (Place::File, WarningKind::AnimationsIgnored { count: 1 }),
        (Place::Node(0), WarningKind::PoseIgnored),
    ];
    assert_eq!(warnings(&loaded), expected);
}

struct StopAfter(Cell<u32>);

impl LoadMonitor for StopAfter {
    fn progress(&self, progress: LoadProgress) {
        assert!(progress.done <= progress.total);
        self.0.set(self.0.get().saturating_sub(1));
    }

    fn cancelled(&self) -> bool {
        self.0.get() == 0
    }
}

#[test]
fn loading_is_watched_and_can_be_stopped() {
    let (json, binary) = square(&json!({}));
    let files = Files::new(&[("a.glb", &glb(&json.to_string(), &binary))]);
    let load = |monitor| Loader::new().monitor(monitor).load(files.path("a.glb"));
    let patient = StopAfter(Cell::new(100));
    assert!(load(&patient).is_ok());
    assert!(patient.0.get() < 100, "nothing was reported");
    let message = load(&StopAfter(Cell::new(1))).unwrap_err().to_string();
    assert!(message.ends_with("a.glb: loading was cancelled"), "{message}");
}

/// A reference scene, if it exists.
fn reference(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/reference").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("SKIPPED: {name} is not there");
    None
}

#[test]
fn the_gltf_crate_reads_the_same_triangles() {
    for name in ["box.glb", "box_mirror.glb", "box_bunny.glb"] {
        let Some(path) = reference(name) else { continue };
        let loaded = globillum_io::load(&path).unwrap();
        let theirs = gltf::Gltf::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let blob = theirs.blob.as_deref().unwrap();
        let mut expected = Vec::new();
        for mesh in theirs.default_scene().unwrap().nodes().filter_map(|node| node.mesh()) {
            for primitive in mesh.primitives() {
                let reader = primitive.reader(|_| Some(blob));
                let positions: Vec<_> = reader.read_positions().unwrap().map(Vec3::from).collect();
                let indices: Vec<_> = reader.read_indices().unwrap().into_u32().collect();
                let (faces, _) = indices.as_chunks::<3>();
                expected
                    .extend(faces.iter().map(|f| Triangle { vertices: f.map(|i| positions[i as usize]) }));
            }
        }
        expected.retain(|triangle| !triangle.is_degenerate());
        assert_eq!(loaded.model.triangles(), expected, "{name}");
        assert_eq!(warnings(&loaded), [], "{name}");
    }
}

#[test]
fn objects_are_the_nodes_that_place_meshes() {
    let (json, binary) =
        square(&json!({"nodes": [{"mesh": 0}, {"name": "b", "children": [2]}, {"mesh": 0, "name": "c"}],
        "scene": 0, "scenes": [{"nodes": [0, 1]}]}));
    let files = Files::new(&[("a.glb", &glb(&json.to_string(), &binary))]);
    let loaded = Loader::new().keep_objects().load(files.path("a.glb")).unwrap();
    let objects: Vec<_> = loaded.objects.into_iter().map(|object| (object.name, object.triangles)).collect();
    assert_eq!(objects, [("node 0".to_owned(), 0..1), ("c".to_owned(), 1..2)]);
    assert_eq!(files.load("a.glb").unwrap().objects, []);
}

#[test]
fn materials_have_their_names() {
    let (json, binary) = square(&json!({
        "materials": [{"name": "wood"}, {}, {"name": "wood"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 1}]}],
    }));
    let files = Files::new(&[("a.glb", &glb(&json.to_string(), &binary))]);
    let loaded = files.load("a.glb").unwrap();
    let names: Vec<_> = loaded.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["wood", "material 1", "wood"]);
    assert_eq!(loaded.materials[1].id, loaded.model.material_id(0));
}
