//! A scene written by hand in two formats gives the same triangles, materials and pictures.

use globillum::glam::DVec3;
use globillum::integrator::{Film, Model, PinholeCamera, Settings, render};
use globillum::io::load;
use globillum_testkit::accelerators::ACCELERATORS;
use globillum_testkit::scenes;

const OBJ: &str = "
mtllib scene.mtl
v -1 0 1
v 1 0 1
v 1 0 -1
v -1 0 -1
v -1 1.5 -1
v 1 1.5 -1
v -0.25 1.25 -0.25
v 0.25 1.25 -0.25
v 0.25 1.25 0.25
v -0.25 1.25 0.25
usemtl floor
f 1 2 3 4
usemtl mirror
f -7 -8 -5 -6
usemtl light
f 7/ 8 9 10 # faces down
";

const MTL: &str = "
newmtl floor
Kd 0.75 0.5 0.25
newmtl mirror
Ks 0.9 0.9 0.9
illum 3
newmtl light
Kd 0
Ke 12 10 8
";

const GLTF: &str = r#"{
  "asset": {"version": "2.0"},
  "extensionsUsed": ["KHR_materials_emissive_strength"],
  "nodes": [{"mesh": 0}, {"mesh": 1}],
  "meshes": [
    {"primitives": [
      {"attributes": {"POSITION": 0}, "indices": 1, "material": 0},
      {"attributes": {"POSITION": 0}, "indices": 2, "material": 2, "mode": 6}
    ]},
    {"primitives": [{"attributes": {"POSITION": 0}, "indices": 3, "material": 1, "mode": 6}]}
  ],
  "materials": [
    {"name": "floor", "pbrMetallicRoughness":
      {"baseColorFactor": [0.75, 0.5, 0.25, 1], "metallicFactor": 0, "roughnessFactor": 1}},
    {"name": "light", "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0},
      "emissiveFactor": [0.75, 0.625, 0.5],
      "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 16}}},
    {"name": "mirror", "pbrMetallicRoughness":
      {"baseColorFactor": [0.9, 0.9, 0.9, 1], "metallicFactor": 1, "roughnessFactor": 0}}
  ],
  "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 10, "type": "VEC3"},
    {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"},
    {"bufferView": 1, "byteOffset": 6, "componentType": 5121, "count": 4, "type": "SCALAR"},
    {"bufferView": 1, "byteOffset": 10, "componentType": 5121, "count": 4, "type": "SCALAR"}
  ],
  "bufferViews": [
    {"buffer": 0, "byteLength": 120},
    {"buffer": 0, "byteOffset": 120, "byteLength": 14}
  ],
  "buffers": [{"uri": "scene.bin", "byteLength": 134}]
}"#;

const CORNERS: [[f32; 3]; 10] = [
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [-1.0, 1.5, -1.0],
    [1.0, 1.5, -1.0],
    [-0.25, 1.25, -0.25],
    [0.25, 1.25, -0.25],
    [0.25, 1.25, 0.25],
    [-0.25, 1.25, 0.25],
];
const INDICES: [u8; 14] = [0, 1, 2, 0, 2, 3, 3, 2, 5, 4, 6, 7, 8, 9];

fn picture(model: &Model) -> Film {
    let scene = scenes::scene(model, ACCELERATORS[1].1);
    let camera =
        PinholeCamera::look_at(DVec3::new(0.3, 1.0, 4.0), DVec3::Y * 0.6, DVec3::Y, 0.7).expect("it is good");
    render(&scene, &camera, &Settings::new(24, 24, 16)).expect("it is good").film
}

#[test]
fn both_formats_give_the_same_triangles_materials_and_image_bits() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let corners = CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes());
    let binary: Vec<u8> = corners.chain(INDICES).collect();
    for (name, content) in [
        ("scene.obj", OBJ.as_bytes()),
        ("scene.mtl", MTL.as_bytes()),
        ("scene.gltf", GLTF.as_bytes()),
        ("scene.bin", &binary),
    ] {
        std::fs::write(folder.path().join(name), content).expect("the folder is writable");
    }
    let [obj, gltf] =
        ["scene.obj", "scene.gltf"].map(|name| load(folder.path().join(name)).expect("it is good"));
    assert_eq!(obj.report.warnings, []);
    assert_eq!(gltf.report.warnings, []);
    assert_eq!(obj.model.triangles(), gltf.model.triangles());
    for index in 0..obj.model.triangles().len() {
        assert_eq!(obj.model.material(index), gltf.model.material(index), "triangle {index}");
    }
    let (obj, gltf) = (picture(&obj.model), picture(&gltf.model));
    assert_eq!(obj, gltf);
    assert!(obj.image_mean().max_component() > 0.0, "the scene is dark");
}
