//! Rows 42 to 74 and 97 to 99: glTF.

use super::{Case, Content, LFS_MESSAGE, LFS_POINTER, Outcome, loaded, refused};
use std::fmt::Write;

/// A triangle; each row replaces some of its text.
pub(super) const TRIANGLE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],
"accessors":[{"bufferView":0,"byteOffset":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],
"buffers":[{"byteLength":39}]}"#;

/// The binary chunk of [`TRIANGLE`].
pub(super) fn binary() -> Vec<u8> {
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    corners.into_iter().flat_map(f32::to_le_bytes).chain([0, 1, 2]).collect()
}

/// A .glb of that JSON and that binary chunk.
pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let mut chunks = Vec::new();
    for (kind, content, padding) in [(b"JSON", json.as_bytes(), b' '), (b"BIN\0", binary, 0)] {
        if !content.is_empty() {
            let length = content.len().next_multiple_of(4);
            chunks.extend((length as u32).to_le_bytes());
            chunks.extend(kind);
            chunks.extend(content);
            chunks.resize(chunks.len() + length - content.len(), padding);
        }
    }
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((chunks.len() as u32 + 12).to_le_bytes());
    file.extend(chunks);
    file
}

/// The triangle with `from` replaced once by `to`.
pub(super) fn but(row: u32, from: &str, to: &str, outcome: Outcome) -> Case {
    let json = TRIANGLE.replacen(from, to, 1);
    assert_ne!(json, TRIANGLE, "{from} is not there");
    Case::new(row, "a.glb", glb(&json, &binary()), outcome)
}

fn bad(row: u32, from: &str, to: &str, kind: &'static str, message: &str) -> Case {
    but(row, from, to, refused(kind, format!("a.glb: {message}")))
}

pub(super) fn cases() -> Vec<Case> {
    let good = Case::new(42, "a.glb", glb(TRIANGLE, &binary()), loaded(&[]));
    [vec![good], headers(), accessors(), primitives(), uris(), nodes(), extensions(), sparse(), containers()]
        .concat()
}

fn headers() -> Vec<Case> {
    let text = |row, json: &str, message: &str| {
        Case::new(row, "a.gltf", json, refused("Parse", format!("a.gltf:{message}")))
    };
    let version = |row, asset: &str, version: &str| {
        let message = format!("glTF version `{version}` is not supported (supported: 2.0)");
        bad(row, r#""version":"2.0""#, asset, "Version", &message)
    };
    vec![
        text(42, "", " file is empty"),
        Case::new(44, "a.glb", LFS_POINTER, refused("Read", format!("a.glb: {LFS_MESSAGE}"))),
        text(43, &TRIANGLE[..200], "3: column 36: EOF while parsing a string"),
        text(44, "# not JSON", " is neither GLB nor a JSON object"),
        text(44, "{}", "1: column 2: missing field `asset`"),
        version(45, r#""version":"1.0""#, "1.0"),
        version(45, r#""version":"1.0\n\u001b[2J""#, r"1.0\n\u{1b}[2J"),
        version(46, r#""version":"2.0","minVersion":"3.1""#, "3.1"),
        but(46, r#""2.0""#, r#""2.1","minVersion":"2.0""#, loaded(&[])),
    ]
}

fn accessors() -> Vec<Case> {
    let accessor = |row, from: &str, to: &str, message: &str| bad(row, from, to, "Accessor", message);
    let (count, offset) = (r#"5126,"count":3"#, r#""byteOffset":0,"componentType""#);
    let (length, bytes) = (r#""byteLength":36"#, r#"[{"byteLength":39"#);
    let beyond = "elements exceed the buffer view";
    let (huge, last) = ("9223372036854775808", "18446744073709551615");
    let (draco, degenerate) = ("KHR_draco_mesh_compression", "degenerate triangles are dropped: 1");
    let nowhere = r#""bufferView":0,"byteOffset":0,"#;
    let endless = format!(r#""componentType":5126,"count":{huge}"#);
    vec![
        accessor(47, r#""POSITION":0"#, r#""POSITION":9"#, "accessors[9]: does not exist (accessors: 2)"),
        accessor(48, count, &format!(r#"5126,"count":{huge}"#), &format!("accessors[0]: {huge} {beyond}")),
        bad(
            48,
            &format!(r#"{nowhere}"componentType":{count}"#),
            &endless,
            "TooLarge",
            "accessors[0]: too many elements without a buffer view (limit: 8388608)",
        ),
        bad(48, nowhere, "", "Empty", &format!("scene has no triangles ({degenerate})")),
        bad(
            48,
            &format!(r#""accessors":[{{{nowhere}"#),
            &format!(r#""extensionsUsed":["{draco}","KHR_materials_ior"],"accessors":[{{"#),
            "Empty",
            &format!("scene has no triangles (extension `{draco}` is ignored; {degenerate})"),
        ),
        accessor(
            49,
            offset,
            &format!(r#""byteOffset":{last},"componentType""#),
            &format!("accessors[0]: 3 {beyond}"),
        ),
        accessor(50, length, r#""byteLength":40"#, "bufferViews[0]: buffer view exceeds its buffer"),
        accessor(
            50,
            r#""byteOffset":36"#,
            &format!(r#""byteOffset":{last}"#),
            "bufferViews[1]: buffer view exceeds its buffer",
        ),
        accessor(
            50,
            length,
            r#""byteLength":36,"byteStride":8"#,
            "accessors[0]: byte stride 8 is less than the element size of 12",
        ),
        accessor(51, bytes, r#"[{"byteLength":41"#, "buffers[0]: buffer has 40 bytes; 41 are declared"),
        accessor(52, "VEC3", "SCALAR", "accessors[0]: positions must be VEC3 of floats"),
        accessor(53, "5126", "5123", "accessors[0]: positions must be VEC3 of floats"),
        accessor(54, "5121", "5126", "accessors[1]: indices must be SCALAR of unsigned integers"),
    ]
}

fn primitives() -> Vec<Case> {
    let index = |message: &str| format!("{message} is out of range");
    let mode = r#""mode":4"#;
    let points = "a.glb: meshes[0].primitives[1]: primitives of points or lines are skipped: 1";
    vec![
        bad(
            55,
            r#"5126,"count":3"#,
            r#"5126,"count":2"#,
            "Index",
            &format!("{} (vertices: 2)", index("accessors[1]: index 2")),
        ),
        bad(
            55,
            mode,
            r#""material":3"#,
            "Index",
            &format!("{} (materials: 0)", index("meshes[0].primitives[0]: index 3")),
        ),
        bad(56, mode, r#""mode":7"#, "Parse", "meshes[0].primitives[0]: primitive mode is not supported"),
        but(56, r#""mode":4}"#, r#""mode":4},{"attributes":{"POSITION":0},"mode":0}"#, loaded(&[points])),
        but(56, mode, r#""mode":5"#, loaded(&[])),
        but(56, mode, r#""mode":6"#, loaded(&[])),
    ]
}

fn uris() -> Vec<Case> {
    let uri = |row, uri: &str, kind, message: &str| {
        let buffer = format!(r#"[{{"uri":"{uri}","byteLength":39"#);
        bad(row, r#"[{"byteLength":39"#, &buffer, kind, &format!("buffers[0]: {message}"))
    };
    let outside = |name: &str| format!("`{name}` is outside the scene's folder");
    vec![
        uri(57, "%FF.bin", "Uri", "malformed URI: is not UTF-8"),
        uri(58, "../x.bin", "PathEscape", &outside("../x.bin")),
        uri(58, "%2e%2e/x.bin", "PathEscape", &outside("../x.bin")),
        uri(59, "/etc/passwd", "PathEscape", &outside("/etc/passwd")),
        uri(60, "file:///etc/hosts", "Scheme", "URI scheme `file:` is not supported"),
        uri(61, ".", "Reference", "`.` cannot be read: is not a regular file"),
        uri(61, "http://a/b.bin", "Scheme", "URI scheme `http:` is not supported"),
    ]
}

fn nodes() -> Vec<Case> {
    let nodes = |row, graph: &str, kind, message: &str| bad(row, r#"[{"mesh":0}]"#, graph, kind, message);
    let scaled = |x: &str| format!(r#"[{{"mesh":0,"matrix":[{x},0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}}]"#);
    let rotated = |w: &str, length: &str| {
        let message = format!("nodes[0]: rotation is not a unit quaternion: its length is {length}");
        nodes(65, &format!(r#"[{{"mesh":0,"rotation":[0,0,0,{w}]}}]"#), "Domain", &message)
    };
    let (own, two) = ("node is its own ancestor", "node has more than one parent");
    let limit = "1.152921504606847e18";
    let mut chain = String::from("[");
    for child in 1..1_000_000 {
        write!(chain, r#"{{"children":[{child}]}},"#).expect("memory can be written to");
    }
    chain.push_str(r#"{"mesh":0}]"#);
    vec![
        nodes(62, r#"[{"mesh":0,"children":[0]}]"#, "Cycle", &format!("nodes[0]: {own}")),
        nodes(62, r#"[{"mesh":0},{"children":[2]},{"children":[1]}]"#, "Cycle", &format!("nodes[1]: {own}")),
        bad(62, r#""scene":0"#, r#""scene":5"#, "Index", "scene: index 5 is out of range (scenes: 1)"),
        nodes(62, r#"[{"mesh":7}]"#, "Index", "nodes[0]: index 7 is out of range (meshes: 1)"),
        nodes(62, r#"[{"children":[7]}]"#, "Index", "nodes[0]: index 7 is out of range (nodes: 1)"),
        nodes(63, r#"[{"children":[1,1]},{"mesh":0}]"#, "NotATree", &format!("nodes[1]: {two}")),
        nodes(63, r#"[{"mesh":0},{"children":[0]}]"#, "NotATree", &format!("nodes[0]: {two}")),
        but(64, r#"[{"mesh":0}]"#, &chain, loaded(&[])),
        nodes(65, &scaled("0"), "Domain", "nodes[0]: matrix is singular"),
        nodes(
            65,
            r#"[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"scale":[2,2,2]}]"#,
            "Domain",
            "nodes[0]: `matrix` excludes `translation`, `rotation` and `scale`",
        ),
        rotated("0", "0"),
        rotated("2", "2"),
        rotated("1.5", "1.5"),
        nodes(
            66,
            &scaled("1e300"),
            "Domain",
            &format!("nodes[0]: transform component inf exceeds {limit} in magnitude"),
        ),
        nodes(
            66,
            r#"[{"mesh":0,"scale":[1e18,1,1],"translation":[1e18,0,0]}]"#,
            "Domain",
            "nodes[0]: coordinate 2e18 exceeds 1.1529215e18 in magnitude",
        ),
        nodes(
            66,
            r#"[{"scale":[1e18,1,1],"children":[1]},{"mesh":0,"scale":[2,1,1]}]"#,
            "Domain",
            &format!("nodes[1]: transform component 1.999999968613499e18 exceeds {limit} in magnitude"),
        ),
    ]
}

/// Row 99: factors that the specification forbids.
pub(super) fn ranges() -> Vec<Case> {
    let factor = |name: &str, x: &str| {
        bad(
            99,
            r#""nodes":[{"mesh":0}]"#,
            &format!(r#""nodes":[{{"mesh":0}}],"materials":[{{"pbrMetallicRoughness":{{"{name}":{x}}}}}]"#),
            "Domain",
            &format!("materials[0]: {name} {x} is not within [0, 1]"),
        )
    };
    vec![factor("metallicFactor", "5"), factor("metallicFactor", "-0.5"), factor("roughnessFactor", "1.5")]
}

fn extensions() -> Vec<Case> {
    let required = |row, extensions: &str| {
        let names = extensions.replace(", ", r#"",""#);
        let required = format!(r#","extensionsRequired":["KHR_materials_unlit","{names}"],"scene""#);
        let message = format!("requires extensions that are not supported: {extensions}");
        bad(row, r#","scene""#, &required, "Unsupported", &message)
    };
    let unlit = r#","extensionsUsed":["KHR_materials_unlit"],"extensionsRequired":
        ["KHR_materials_unlit","EXT_texture_webp","KHR_texture_transform"],"scene""#;
    let ignored = ["KHR_materials_unlit", "EXT_texture_webp"]
        .map(|name| format!("a.glb: extension `{name}` is ignored"));
    let used = r#","extensionsUsed":["KHR_materials_ior"],"scene""#;
    let lights = r#","extensionsRequired":["KHR_lights_punctual"],"scene""#;
    vec![
        required(67, "VENDOR_magic"),
        required(68, "KHR_draco_mesh_compression"),
        required(68, "KHR_mesh_quantization, EXT_meshopt_compression"),
        but(67, r#","scene""#, unlit, Outcome::Loaded { warnings: ignored.into() }),
        but(67, r#","scene""#, used, loaded(&["a.glb: extension `KHR_materials_ior` is ignored"])),
        but(67, r#","scene""#, lights, loaded(&[])),
    ]
}

/// Rows 97 and 98: delta lights.
pub(super) fn lights() -> Vec<Case> {
    let node = |light: u32, scale: u32| {
        let extension = format!(r#"{{"KHR_lights_punctual":{{"light":{light}}}}}"#);
        format!(r#""nodes":[{{"mesh":0,"scale":[{scale},1,{scale}],"extensions":{extension}}}]"#)
    };
    let json = |light: &str, node: String| {
        let extensions = format!(r#","extensions":{{"KHR_lights_punctual":{{"lights":[{light}]}}}},{node}"#);
        TRIANGLE.replacen(r#","nodes":[{"mesh":0}]"#, &extensions, 1)
    };
    let case = |row, light: &str, node, outcome| {
        Case::new(row, "a.glb", glb(&json(light, node), &binary()), outcome)
    };
    let bad = |light: &str, kind, message: &str| {
        let message = format!("a.glb: extensions.KHR_lights_punctual.lights[0]: {message}");
        case(97, light, node(0, 1), refused(kind, message))
    };
    let cone = |angles: &str| format!(r#"{{"type":"spot","spot":{{{angles}}}}}"#);
    let cone_message = |inner, outer| {
        format!("the cone of a spot light has the angles {inner} and {outer}, not 0 <= inner < outer <= pi/2")
    };
    let index = "a.glb: nodes[0]: index 1 is out of range (lights: 1)";
    let range = "a.glb: extensions.KHR_lights_punctual.lights[0]: ranges of delta lights are ignored: 1";
    vec![
        bad(&cone(r#""innerConeAngle":0.5,"outerConeAngle":0.25"#), "Light", &cone_message("0.5", "0.25")),
        bad(&cone(r#""outerConeAngle":2"#), "Light", &cone_message("0", "2")),
        bad(&cone(r#""innerConeAngle":-0.5"#), "Light", &cone_message("-0.5", "0.7853981852531433")),
        bad(r#"{"type":"spot"}"#, "Parse", "spot light has no `spot`"),
        bad(r#"{"type":"area"}"#, "Parse", "light type is none of point, spot and directional"),
        bad(r#"{"type":"point","intensity":-683}"#, "Parse", "intensity is negative: -683"),
        case(97, r#"{"type":"point"}"#, node(1, 1), refused("Index", index.to_owned())),
        case(98, r#"{"type":"point","range":2}"#, node(0, 1), loaded(&[range])),
        case(98, &cone(r#""innerConeAngle":0.5,"outerConeAngle":0.5"#), node(0, 1), loaded(&[])),
    ]
}

fn sparse() -> Vec<Case> {
    let sparse = |row, all: u32, count: u32, outcome| {
        let to = format!(
            r#""count":{all},"type":"VEC3","sparse":{{"count":{count},"indices":{{"bufferView":1,
            "componentType":5121}},"values":{{"bufferView":0}}}}"#
        );
        but(row, r#""count":3,"type":"VEC3""#, &to, outcome)
    };
    let accessor = |message: &str| refused("Accessor", format!("a.glb: accessors[0]: {message}"));
    vec![
        sparse(69, 2, 3, accessor("sparse index 2 is out of range (elements: 2)")),
        sparse(70, 3, 4, accessor("4 elements exceed the buffer view")),
        sparse(70, 3, 3, loaded(&[])),
    ]
}

fn containers() -> Vec<Case> {
    let image = |row, image: &str, message: &str| {
        let images = format!(r#","images":[{image}],"scene""#);
        bad(row, r#","scene""#, &images, "Parse", &format!("images[0]: {message}"))
    };
    let good = glb(TRIANGLE, &binary());
    let changed = |row, at: usize, value: u32, kind, message: &str| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        Case::new(row, "a.glb", bytes, refused(kind, format!("a.glb: {message}")))
    };
    let length = good.len() as u32;
    let wrong_length = format!("file has {length} bytes, but its header says {}", length + 1);
    let extra = loaded(&["a.glb: bytes after the end of the GLB are ignored: 4"]);
    let cut_off = refused("Parse", "a.glb: header is truncated");
    vec![
        image(71, "{}", "image has neither a URI nor a buffer view"),
        image(72, r#"{"bufferView":0}"#, "image in a buffer view has no MIME type"),
        changed(73, 12, 0, "Parse", "chunk is empty"),
        changed(74, 8, length + 1, "Parse", &wrong_length),
        changed(74, 8, 11, "Parse", &format!("file has {length} bytes, but its header says 11")),
        Case::new(74, "a.glb", [&good[..], b"more"].concat(), extra),
        changed(74, 12, length, "Parse", "chunk is truncated"),
        changed(74, 16, 0, "Parse", "first chunk is not JSON"),
        changed(74, 4, 1, "Version", "glTF version `1` is not supported (supported: 2.0)"),
        Case::new(74, "a.glb", b"glTF\x02\0", cut_off).beside("b.bin", Content::Bytes(Vec::new())),
    ]
}
