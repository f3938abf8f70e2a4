//! Bad input, numbered as in the project's plan for it: each row is an error of the right kind
//! with a message of one line, or is loaded with the right warning.
#![cfg(all(feature = "obj", feature = "gltf"))]
#![allow(clippy::unwrap_used, reason = "a test that can not go on has failed")]
#![allow(clippy::print_stderr, reason = "a test that is skipped says so")]

mod files;

use files::{Files, floats, glb};
use globillum_io::{IoError, Limits, Loaded, Loader, WarningKind};
use std::path::Path;

/// The name of an error's kind.
fn kind(error: &IoError) -> String {
    let debug = format!("{error:?}");
    debug[..debug.find(' ').unwrap()].to_owned()
}

/// Fails unless loading `name` is an error of that kind and message.
fn assert_refused(row: u32, files: &Files, name: &str, expected: [&str; 2]) {
    let error = files.load(name).expect_err(&format!("row {row}"));
    let message = files.shortened(&error);
    assert_eq!([kind(&error).as_str(), message.as_str()], expected, "row {row}");
    assert_eq!(message.lines().count(), 1, "row {row}: {message}");
}

fn load_obj(obj: impl AsRef<[u8]>) -> Result<Loaded, IoError> {
    Files::new(&[("a.obj", obj.as_ref())]).load("a.obj")
}

/// What was warned of, but that nothing shines.
fn warnings(loaded: &Loaded) -> Vec<WarningKind> {
    let kinds = loaded.report.warnings.iter().map(|warning| warning.kind.clone());
    kinds.filter(|kind| *kind != WarningKind::NoEmitter).collect()
}

/// The corners of a unit square; faces follow from line 5 on.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn rows_1_to_25_text() {
    let refused = [
        (1, "f 1 2 0", ["Index", "a.obj:5: index 0 refers to none of the 4 vertices above it"]),
        (2, "f 1 2 5", ["Index", "a.obj:5: index 5 refers to none of the 4 vertices above it"]),
        (3, "f 1 2 -5", ["Index", "a.obj:5: index -5 refers to none of the 4 vertices above it"]),
        (4, "f 1 2 99999999999999999999", ["Parse", "a.obj:5: f: `99999999999999999999` is not a number"]),
        (5, "f a b c", ["Parse", "a.obj:5: f: `a` is not a number"]),
        (6, "f", ["Parse", "a.obj:5: f: takes three corners or more"]),
        (9, "vt 0 0\nvn 0 0 1\nf 1/1/1/1 2 3", ["Parse", "a.obj:7: f: a corner has more than v/vt/vn"]),
        (10, "v 1 2", ["Parse", "a.obj:5: v: takes 3, 4 or 6 numbers"]),
        (11, "v 1 2 3 0", ["Parse", "a.obj:5: v: the weight is zero"]),
        (12, "v 0 nan 0", ["NonFinite", "a.obj:5: coordinate is not finite"]),
        (13, "v 0 0 inf", ["NonFinite", "a.obj:5: coordinate is not finite"]),
        (14, "v 1e999 0 0", ["NonFinite", "a.obj:5: coordinate is not finite"]),
        (15, "v 1 1 1 1e-45", ["NonFinite", "a.obj:5: coordinate is not finite"]),
        (15, "v 1 1 1e30", ["Domain", "a.obj:5: coordinate 1e30 is beyond 1.1529215e18"]),
        (16, "f 1/1 2 3", ["Index", "a.obj:5: index 1 refers to none of the 0 texture coordinates above it"]),
        (17, "f 1//2 2 3", ["Index", "a.obj:5: index 2 refers to none of the 0 normals above it"]),
        (25, "# \0", ["Parse", "a.obj:5: holds a NUL byte"]),
    ];
    for (row, line, expected) in refused {
        let files = Files::new(&[("a.obj", format!("{SQUARE}{line}\nf 1 2 3\n").as_bytes())]);
        assert_refused(row, &files, "a.obj", expected);
    }
    for (row, obj) in [(20, ""), (21, "# nothing\n"), (20, SQUARE), (20, "v 0 0 0\nf 1 1 1\n")] {
        let files = Files::new(&[("a.obj", obj.as_bytes())]);
        assert_refused(row, &files, "a.obj", ["Empty", "a.obj: has no triangles"]);
    }
    let latin = Files::new(&[("a.obj", b"# fine\n# caf\xe9\n")]);
    assert_refused(24, &latin, "a.obj", ["Parse", "a.obj:2: is not UTF-8"]);
}

#[test]
fn rows_7_to_23_text_that_loads() {
    let short = load_obj(format!("{SQUARE}f 1\nf 1 2\nf 1 2 3\n")).unwrap();
    assert_eq!(warnings(&short), [WarningKind::ShortFaces { count: 2 }], "rows 7 and 8");
    let partly = load_obj(format!("{SQUARE}vn 0 0 0\nf 1//1 2 3\n")).unwrap();
    assert_eq!(warnings(&partly), [WarningKind::NormalsIgnored { count: 1 }], "rows 18 and 19");
    let plain = load_obj(format!("{SQUARE}f 1 2 3\n")).unwrap();
    for obj in [format!("\u{feff}{SQUARE}f 1 2 3"), format!("{SQUARE}f 1 2 3\n").replace('\n', "\r\n")] {
        assert_eq!(load_obj(&obj).unwrap().model, plain.model, "rows 22 and 23: {obj:?}");
    }
    let comments = format!("{}f 1 2 3 # done\n", SQUARE.replace('\n', " # a corner\n"));
    assert_eq!(load_obj(comments).unwrap().model, plain.model);
}

#[test]
fn rows_26_to_30_libraries() {
    let with = |name: &str| {
        let obj = format!("mtllib {name}\n{SQUARE}f 1 2 3\n");
        let files = Files::new(&[("a.obj", obj.as_bytes())]);
        std::fs::create_dir(files.path("folder.mtl")).unwrap();
        files
    };
    let loaded = with("none.mtl").load("a.obj").unwrap();
    assert_eq!(warnings(&loaded), [WarningKind::MissingLibrary { name: "none.mtl".into() }], "row 26");
    let refused = [
        (27, "../../x.mtl", ["PathEscape", "a.obj:1: `../../x.mtl` is not within the file's own folder"]),
        (28, "/etc/passwd", ["PathEscape", "a.obj:1: `/etc/passwd` is not within the file's own folder"]),
        (29, "folder.mtl", ["NotRegularFile", "folder.mtl: is not a regular file"]),
    ];
    for (row, name, expected) in refused {
        assert_refused(row, &with(name), "a.obj", expected);
    }
}

#[cfg(unix)]
#[test]
fn row_30_pipes_and_links_that_lead_outside() {
    let obj = format!("mtllib a.mtl\n{SQUARE}f 1 2 3\n");
    let files = Files::new(&[("a.obj", obj.as_bytes())]);
    let made = std::process::Command::new("mkfifo").arg(files.path("a.mtl")).status();
    if made.is_ok_and(|status| status.success()) {
        assert_refused(30, &files, "a.obj", ["NotRegularFile", "a.mtl: is not a regular file"]);
        std::fs::remove_file(files.path("a.mtl")).unwrap();
    } else {
        eprintln!("SKIPPED: no pipe can be made here");
    }
    let elsewhere = Files::new(&[("b.mtl", b"newmtl m\n")]);
    std::os::unix::fs::symlink(elsewhere.path("b.mtl"), files.path("a.mtl")).unwrap();
    let expected = ["PathEscape", "a.obj:1: `a.mtl` is not within the file's own folder"];
    assert_refused(30, &files, "a.obj", expected);
    std::os::unix::fs::symlink("/dev/zero", files.path("zero.obj")).unwrap();
    assert_refused(30, &files, "zero.obj", ["NotRegularFile", "zero.obj: is not a regular file"]);
}

#[test]
fn rows_31_to_37_materials() {
    let with = |mtl: &str| {
        let obj = format!("mtllib a.mtl\nusemtl m\n{SQUARE}f 1 2 3\n");
        Files::new(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())])
    };
    let refused = [
        (32, "Kd", ["Parse", "a.mtl:2: Kd: takes 1 or 3 numbers"]),
        (
            33,
            "Kd nan 0 0",
            ["Material", "a.mtl:1: material `m`: reflectance (NaN, 0, 0) is not within [0, 1]"],
        ),
        (34, "Kd -1 0 0", ["Material", "a.mtl:1: material `m`: reflectance (-1, 0, 0) is not within [0, 1]"]),
        (35, "Kd 5 5 5", ["Material", "a.mtl:1: material `m`: reflectance (5, 5, 5) is not within [0, 1]"]),
    ];
    for (row, line, expected) in refused {
        assert_refused(row, &with(&format!("newmtl m\n{line}\n")), "a.obj", expected);
    }
    assert!(warnings(&with("newmtl m\nKd 0.5\n").load("a.obj").unwrap()).is_empty(), "row 31");
    let twice = with("newmtl m\nKd 0\nnewmtl m\nKd 1\n").load("a.obj").unwrap();
    assert_eq!(warnings(&twice), [WarningKind::DuplicateMaterial { name: "m".into() }], "row 36");
    let lost = with("newmtl other\n").load("a.obj").unwrap();
    assert_eq!(warnings(&lost), [WarningKind::UnknownMaterial { name: "m".into() }], "row 37");
    let glass = with("newmtl m\nKd 0.5\nKs 0.5\nd 0.1\nmap_Kd a.png\n").load("a.obj").unwrap();
    let name = || "m".to_owned();
    let expected = [
        WarningKind::TexturesIgnored { name: name() },
        WarningKind::TransparencyIgnored { name: name() },
        WarningKind::Approximated { name: name(), by: "an ideal diffuse surface" },
    ];
    assert_eq!(warnings(&glass), expected);
}

/// Fails unless loading `name` is refused within `limits` for having too much of `what`, and
/// loaded within the default ones.
fn assert_limited(files: &Files, name: &str, limits: Limits, expected: &str) {
    let error = Loader::new().limits(limits).load(&files.path(name)).unwrap_err();
    assert_eq!([kind(&error), files.shortened(&error)], ["TooLarge", expected]);
    assert!(files.load(name).is_ok(), "{expected}");
}

#[test]
fn rows_39_to_41_limits_and_odd_polygons() {
    let limits = Limits::default;
    let square = Files::new(&[("a.obj", format!("{SQUARE}usemtl m\nf 1 2 3 4 # round\n").as_bytes())]);
    let cases: [(Limits, &str); 5] = [
        (change(limits(), |l| l.line_bytes = 10), "a.obj:6: more than 10 bytes in a line"),
        (change(limits(), |l| l.polygon_corners = 3), "a.obj:6: more than 3 corners of a polygon"),
        (change(limits(), |l| l.triangles = 1), "a.obj:6: more than 1 triangles"),
        (change(limits(), |l| l.materials = 0), "a.obj:5: more than 0 materials"),
        (change(limits(), |l| l.bytes = 20), "a.obj: more than 20 bytes in all files of the scene"),
    ];
    for (limits, expected) in cases {
        assert_limited(&square, "a.obj", limits, expected);
    }
    let dart = format!("{SQUARE}v 0.9 0.5 0\nf 1 2 3 4\nf 1 2 5 3 4\nf 2 5 3\n");
    let loaded = load_obj(dart).unwrap();
    assert_eq!(warnings(&loaded), [WarningKind::NonConvex { count: 1 }]);
    assert!(loaded.report.warnings[0].to_string().contains("a.obj:7: "));
    let too_many = format!("{SQUARE}f {}\n", "1 2 3 ".repeat(30_000));
    let files = Files::new(&[("a.obj", too_many.as_bytes())]);
    let expected = ["TooLarge", "a.obj:5: more than 65536 corners of a polygon"];
    assert_refused(40, &files, "a.obj", expected);
}

fn change(mut limits: Limits, change: impl FnOnce(&mut Limits)) -> Limits {
    change(&mut limits);
    limits
}

/// A triangle; each row replaces some of its text.
const TRIANGLE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],
"accessors":[{"bufferView":0,"byteOffset":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],
"buffers":[{"byteLength":39}]}"#;

/// The binary chunk of [`TRIANGLE`].
fn binary() -> Vec<u8> {
    let mut bytes = floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    bytes.extend([0, 1, 2]);
    bytes
}

fn triangle_but(from: &str, to: &str) -> Files {
    let json = TRIANGLE.replacen(from, to, 1);
    assert_ne!(json, TRIANGLE, "{from} is not there");
    Files::new(&[("a.glb", &glb(&json, &binary()))])
}

#[test]
fn the_triangle_is_good_before_it_is_broken() {
    let loaded = Files::new(&[("a.glb", &glb(TRIANGLE, &binary()))]).load("a.glb").unwrap();
    assert_eq!(loaded.model.triangles().len(), 1);
    assert!(warnings(&loaded).is_empty());
}

#[test]
fn rows_42_to_46_no_gltf() {
    let text = |text: &str| Files::new(&[("a.gltf", text.as_bytes())]);
    let refused = [
        (42, "", ["Parse", "a.gltf:1: column 0: EOF while parsing a value"]),
        (43, &TRIANGLE[..200], ["Parse", "a.gltf:3: column 36: EOF while parsing a string"]),
        (44, "# not JSON", ["Parse", "a.gltf:1: column 1: expected value"]),
        (44, "{}", ["Parse", "a.gltf:1: column 2: missing field `asset`"]),
    ];
    for (row, json, expected) in refused {
        assert_refused(row, &text(json), "a.gltf", expected);
    }
    let version = |version: &str| [format!("a.glb: glTF version {version} is not supported, only 2.0")];
    for (row, asset, [message]) in [
        (45, r#""version":"1.0""#, version("1.0")),
        (46, r#""version":"2.0","minVersion":"3.1""#, version("3.1")),
    ] {
        let files = triangle_but(r#""version":"2.0""#, asset);
        assert_refused(row, &files, "a.glb", ["Version", &message]);
    }
    assert!(triangle_but(r#""2.0""#, r#""2.1","minVersion":"2.0""#).load("a.glb").is_ok());
}

#[test]
fn rows_47_to_56_accessors() {
    let count = r#"5126,"count":3"#;
    let refused = [
        (47, r#""POSITION":0"#, r#""POSITION":9"#, ["Accessor", "accessors[9]: does not exist, there are 2"]),
        (
            48,
            count,
            r#"5126,"count":9223372036854775808"#,
            ["Accessor", "accessors[0]: 9223372036854775808 elements reach beyond the buffer view"],
        ),
        (
            49,
            r#""byteOffset":0,"componentType""#,
            r#""byteOffset":18446744073709551615,"componentType""#,
            ["Accessor", "accessors[0]: 3 elements reach beyond the buffer view"],
        ),
        (
            50,
            r#""byteLength":36"#,
            r#""byteLength":40"#,
            ["Accessor", "bufferViews[0]: reaches beyond its buffer"],
        ),
        (
            50,
            r#""byteOffset":36"#,
            r#""byteOffset":18446744073709551615"#,
            ["Accessor", "bufferViews[1]: reaches beyond its buffer"],
        ),
        (
            51,
            r#"[{"byteLength":39"#,
            r#"[{"byteLength":41"#,
            ["Accessor", "buffers[0]: has 40 bytes instead of 41"],
        ),
        (52, "VEC3", "SCALAR", ["Accessor", "accessors[0]: positions must be VEC3 of floats"]),
        (53, "5126", "5123", ["Accessor", "accessors[0]: positions must be VEC3 of floats"]),
        (54, "5121", "5126", ["Accessor", "accessors[1]: indices must be SCALAR of unsigned integers"]),
        (55, count, r#"5126,"count":2"#, ["Index", "accessors[1]: index 2 refers to none of the 2 vertices"]),
        (
            56,
            r#""mode":4"#,
            r#""material":3"#,
            ["Index", "meshes[0].primitives[0]: index 3 refers to none of the 0 materials"],
        ),
        (56, r#""mode":4"#, r#""mode":7"#, ["Parse", "meshes[0].primitives[0]: mode 7 is not known"]),
        (
            50,
            r#""byteLength":36"#,
            r#""byteLength":36,"byteStride":8"#,
            ["Accessor", "accessors[0]: a stride of 8 is less than an element of 12 bytes"],
        ),
    ];
    for (row, from, to, [kind, message]) in refused {
        assert_refused(row, &triangle_but(from, to), "a.glb", [kind, &format!("a.glb: {message}")]);
    }
    let points = triangle_but(r#""mode":4}"#, r#""mode":4},{"attributes":{"POSITION":0},"mode":0}"#);
    assert_eq!(warnings(&points.load("a.glb").unwrap()), [WarningKind::NotTriangles { count: 1 }], "row 56");
    // 2^32 must not become 0.
    let wrapped = triangle_but(r#""POSITION":0"#, r#""POSITION":4294967296"#).load("a.glb").unwrap_err();
    assert_eq!(kind(&wrapped), "Parse");
    let nowhere = triangle_but(r#""bufferView":0,"byteOffset":0,"#, "");
    assert_refused(48, &nowhere, "a.glb", ["Empty", "a.glb: has no triangles"]);
    let endless = triangle_but(
        r#""bufferView":0,"byteOffset":0,"componentType":5126,"count":3"#,
        r#""componentType":5126,"count":9223372036854775808"#,
    );
    let message = "a.glb: accessors[0]: more than 8388608 elements without a buffer view";
    assert_refused(48, &endless, "a.glb", ["TooLarge", message]);
}

#[test]
fn rows_57_to_61_uris() {
    let refused = [
        (57, "%FF.bin", ["Uri", "buffers[0]: malformed URI: is not UTF-8"]),
        (58, "../x.bin", ["PathEscape", "buffers[0]: `../x.bin` is not within the file's own folder"]),
        (58, "%2e%2e/x.bin", ["PathEscape", "buffers[0]: `../x.bin` is not within the file's own folder"]),
        (59, "/etc/passwd", ["PathEscape", "buffers[0]: `/etc/passwd` is not within the file's own folder"]),
        (60, "file:///etc/hosts", ["Scheme", "buffers[0]: URIs of scheme `file:` are not followed"]),
        (61, "http://a/b.bin", ["Scheme", "buffers[0]: URIs of scheme `http:` are not followed"]),
    ];
    for (row, uri, [kind, message]) in refused {
        let files = triangle_but(r#"[{"byteLength":39"#, &format!(r#"[{{"uri":"{uri}","byteLength":39"#));
        assert_refused(row, &files, "a.glb", [kind, &format!("a.glb: {message}")]);
    }
}

#[test]
fn rows_62_to_66_nodes() {
    let nodes = r#"[{"mesh":0}]"#;
    let identity_with =
        |first: &str| format!(r#"[{{"mesh":0,"matrix":[{first},0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}}]"#);
    let refused = [
        (62, r#"[{"mesh":0,"children":[0]}]"#.into(), ["Cycle", "nodes[0]: is its own ancestor"]),
        (
            62,
            r#"[{"mesh":0},{"children":[2]},{"children":[1]}]"#.into(),
            ["Cycle", "nodes[1]: is its own ancestor"],
        ),
        (63, r#"[{"children":[1,1]},{"mesh":0}]"#.into(), ["NotATree", "nodes[1]: has more than one parent"]),
        (63, r#"[{"mesh":0},{"children":[0]}]"#.into(), ["NotATree", "nodes[0]: has more than one parent"]),
        (65, identity_with("0"), ["Domain", "nodes[0]: the matrix can not be inverted"]),
        (
            66,
            identity_with("1e300"),
            ["Domain", "nodes[0]: transform has 1e300, which is beyond 1.152921504606847e18"],
        ),
        (
            66,
            r#"[{"mesh":0,"scale":[1e18,1,1],"translation":[1e18,0,0]}]"#.into(),
            ["Domain", "nodes[0]: coordinate 2e18 is beyond 1.1529215e18"],
        ),
        (62, r#"[{"mesh":7}]"#.into(), ["Index", "nodes[0]: index 7 refers to none of the 1 meshes"]),
        (62, r#"[{"children":[7]}]"#.into(), ["Index", "nodes[0]: index 7 refers to none of the 1 nodes"]),
    ];
    for (row, graph, [kind, message]) in refused {
        assert_refused(row, &triangle_but(nodes, &graph), "a.glb", [kind, &format!("a.glb: {message}")]);
    }
    let far = r#"[{"scale":[1e18,1,1],"children":[1]},{"mesh":0,"scale":[2,1,1]}]"#;
    let message = "a.glb: nodes[1]: transform has 2e18, which is beyond 1.152921504606847e18";
    assert_refused(66, &triangle_but(nodes, far), "a.glb", ["Domain", message]);
}

#[test]
fn row_64_a_chain_of_a_million_nodes() {
    use std::fmt::Write;
    let mut nodes = String::from("[");
    for child in 1..1_000_000 {
        write!(nodes, r#"{{"children":[{child}]}},"#).unwrap();
    }
    nodes.push_str(r#"{"mesh":0}]"#);
    let loaded = triangle_but(r#"[{"mesh":0}]"#, &nodes).load("a.glb").unwrap();
    assert_eq!(loaded.model.triangles().len(), 1);
}

#[test]
fn rows_67_to_70_extensions_and_sparse_accessors() {
    for (row, extension) in
        [(67, "VENDOR_magic"), (68, "KHR_draco_mesh_compression"), (68, "EXT_meshopt_compression")]
    {
        let required = format!(r#","extensionsRequired":["{extension}"],"scene""#);
        let message = format!("a.glb: extension `{extension}` is required and not supported");
        assert_refused(row, &triangle_but(r#","scene""#, &required), "a.glb", ["Unsupported", &message]);
    }
    let used = triangle_but(r#","scene""#, r#","extensionsUsed":["KHR_lights_punctual"],"scene""#);
    let expected = WarningKind::ExtensionIgnored { name: "KHR_lights_punctual".into() };
    assert_eq!(warnings(&used.load("a.glb").unwrap()), [expected]);
    let sparse = |count: u32, offset: u32| {
        let sparse = format!(
            r#""VEC3","sparse":{{"count":{count},"indices":{{"bufferView":1,"byteOffset":{offset},
            "componentType":5121}},"values":{{"bufferView":0}}}}"#
        );
        triangle_but(r#""VEC3""#, &sparse)
    };
    assert!(sparse(3, 0).load("a.glb").is_ok());
    let message = "a.glb: accessors[0]: 4 elements reach beyond the buffer view";
    assert_refused(70, &sparse(4, 0), "a.glb", ["Accessor", message]);
    let few = sparse(3, 0);
    let json = TRIANGLE.replacen(
        r#""count":3,"type":"VEC3""#,
        r#""count":2,"type":"VEC3","sparse":
        {"count":3,"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0}}"#,
        1,
    );
    std::fs::write(few.path("a.glb"), glb(&json, &binary())).unwrap();
    let message = "a.glb: accessors[0]: sparse index 2 is beyond its 2 elements";
    assert_refused(69, &few, "a.glb", ["Accessor", message]);
}

#[test]
fn rows_71_to_74_images_and_containers() {
    let image = |image: &str| triangle_but(r#","scene""#, &format!(r#","images":[{image}],"scene""#));
    let message = "a.glb: images[0]: has neither a URI nor a buffer view";
    assert_refused(71, &image("{}"), "a.glb", ["Parse", message]);
    let message = "a.glb: images[0]: lies in a buffer view and has no MIME type";
    assert_refused(72, &image(r#"{"bufferView":0}"#), "a.glb", ["Parse", message]);
    let good = glb(TRIANGLE, &binary());
    let changed = |at: usize, value: u32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let length = good.len() as u32;
    let wrong_length = format!("a.glb: has {length} bytes, but its header says {}", length + 1);
    let cases: [(u32, Vec<u8>, [&str; 2]); 6] = [
        (73, changed(12, 0), ["Parse", "a.glb: a chunk is empty"]),
        (74, changed(8, length + 1), ["Parse", &wrong_length]),
        (74, changed(12, length), ["Parse", "a.glb: a chunk is cut off"]),
        (74, changed(16, 0), ["Parse", "a.glb: the first chunk is not JSON"]),
        (74, changed(4, 1), ["Version", "a.glb: glTF version 1 is not supported, only 2.0"]),
        (74, b"glTF\x02\0".to_vec(), ["Parse", "a.glb: the header is cut off"]),
    ];
    for (row, bytes, expected) in cases {
        assert_refused(row, &Files::new(&[("a.glb", &bytes)]), "a.glb", expected);
    }
}

#[test]
fn a_file_cut_off_anywhere_is_an_error() {
    let whole = glb(TRIANGLE, &binary());
    for length in 0..whole.len() {
        let files = Files::new(&[("a.glb", &whole[..length])]);
        assert!(files.load("a.glb").is_err(), "{length} bytes");
    }
}

#[test]
fn limits_hold_for_gltf_too() {
    let files = Files::new(&[("a.glb", &glb(TRIANGLE, &binary()))]);
    let cases: [(Limits, &str); 3] = [
        (change(Limits::default(), |l| l.triangles = 0), "a.glb: more than 0 triangles"),
        (change(Limits::default(), |l| l.json_values = 20), "a.glb: more than 20 values in JSON"),
        (
            change(Limits::default(), |l| l.bytes = 100),
            "a.glb: more than 100 bytes in all files of the scene",
        ),
    ];
    for (limits, expected) in cases {
        assert_limited(&files, "a.glb", limits, expected);
    }
}

#[test]
fn unknown_extensions_and_missing_files_are_named() {
    let message = |name: &str| globillum_io::load(Path::new(name)).unwrap_err().to_string();
    assert_eq!(message("a.stl"), "a.stl: unknown scene format; supported are .obj, .gltf and .glb");
    assert!(message("no/such.glb").starts_with("no/such.glb: can not be read: "));
}
