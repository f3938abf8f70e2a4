//! Bad input by rows of a table. Each file is an error of the expected kind with a message of one line, or is
//! loaded with the expected warnings. `crates/cli/tests/suite/render.rs` checks that `render` prints the same.
#![cfg(all(feature = "obj", feature = "gltf"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]
#![allow(clippy::print_stderr, reason = "a skipped test prints a message")]

mod files;

use files::{Files, floats};
use globillum_io::{IoError, Limits, Loader, WarningKind};
use globillum_testkit::bad_input::{Case, Outcome, cases, glb};
use std::ops::RangeInclusive;
use std::path::Path;

/// The name of an error's variant.
fn kind(error: &IoError) -> String {
    let debug = format!("{error:?}");
    debug[..debug.find(' ').unwrap()].to_owned()
}

fn check_rows(rows: RangeInclusive<u32>) {
    cases().iter().filter(|case| rows.contains(&case.row)).for_each(check);
}

fn check(case: &Case) {
    let (row, files) = (case.row, Files::new(&[]));
    if !case.write(&files.path("")).unwrap() {
        eprintln!("SKIPPED: row {row} needs a pipe or a link, which cannot be made here");
        return;
    }
    match (files.load(case.scene()), &case.outcome) {
        (Err(error), Outcome::Refused { kind: expected, message }) => {
            assert_eq!((kind(&error).as_str(), &files.shortened(&error)), (*expected, message), "row {row}");
            assert_eq!(message.lines().count(), 1, "row {row}: {message}");
        }
        (Ok(loaded), Outcome::Loaded { warnings }) => {
            let matters = loaded.report.warnings.iter().filter(|w| w.kind != WarningKind::NoLight);
            let found: Vec<_> = matters.map(|warning| files.shortened(warning)).collect();
            assert_eq!(found, *warnings, "row {row}");
            assert!(!loaded.model.triangles().is_empty(), "row {row}");
        }
        (result, expected) => panic!("row {row}: {expected:?}, but {:?}", result.map(|loaded| loaded.report)),
    }
}

#[test]
fn rows_1_to_25_obj() {
    check_rows(1..=25);
}

#[test]
fn rows_26_to_41_libraries_materials_and_sizes() {
    check_rows(26..=41);
}

#[test]
fn rows_42_to_61_gltf_files_accessors_and_uris() {
    check_rows(42..=61);
}

#[test]
fn rows_62_to_74_gltf_nodes_extensions_and_containers() {
    check_rows(62..=74);
}

#[test]
fn rows_75_to_82_pictures_are_not_read() {
    check_rows(75..=82);
}

#[test]
fn rows_97_to_98_delta_lights() {
    check_rows(97..=98);
}

#[test]
fn row_99_numbers_that_gltf_forbids() {
    check_rows(99..=99);
}

#[test]
fn line_ends_marks_and_comments_change_nothing() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\n";
    let load = |obj: String| Files::new(&[("a.obj", obj.as_bytes())]).load("a.obj").unwrap().model;
    let plain = load(square.into());
    for obj in
        [format!("\u{feff}{square}"), square.replace('\n', "\r\n"), square.replace('\n', " # a comment\n")]
    {
        assert_eq!(load(obj.clone()), plain, "{obj:?}");
    }
}

/// Asserts that loading `name` within `limits` is the error `expected`, and within the default limits is not
/// an error.
fn assert_limited(files: &Files, name: &str, limits: Limits, expected: &str) {
    let error = Loader::new().limits(limits).load(files.path(name)).unwrap_err();
    assert_eq!([kind(&error), files.shortened(&error)], ["TooLarge", expected]);
    assert!(files.load(name).is_ok(), "{expected}");
}

#[test]
fn every_limit_can_be_lowered() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl m\nf 1 2 3 4 # round\n";
    let obj = Files::new(&[("a.obj", square.as_bytes())]);
    let cases: [(Limits, &str); 5] = [
        (change(|l| l.line_bytes = 10), "a.obj:6: too many bytes in a line (limit: 10)"),
        (change(|l| l.polygon_corners = 3), "a.obj:6: too many vertices in a polygon (limit: 3)"),
        (change(|l| l.triangles = 1), "a.obj:6: too many triangles (limit: 1)"),
        (change(|l| l.materials = 0), "a.obj:5: too many materials (limit: 0)"),
        (change(|l| l.bytes = 20), "a.obj: too many bytes in all files of the scene (limit: 20)"),
    ];
    for (limits, expected) in cases {
        assert_limited(&obj, "a.obj", limits, expected);
    }
    let glb = Files::new(&[("a.glb", &instances(1, 1, 3))]);
    let cases: [(Limits, &str); 3] = [
        (change(|l| l.triangles = 0), "a.glb: too many triangles (limit: 0)"),
        (change(|l| l.json_values = 20), "a.glb: too many values in JSON (limit: 20)"),
        (change(|l| l.bytes = 100), "a.glb: too many bytes in all files of the scene (limit: 100)"),
    ];
    for (limits, expected) in cases {
        assert_limited(&glb, "a.glb", limits, expected);
    }
    let camera =
        r#""cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}},{"type":"orthographic"}]"#;
    let seen = gltf(&format!(
        r#"{camera},"nodes":[{{"mesh":0}},{{"camera":0}},{{"camera":1}},{{"camera":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}]"#
    ));
    assert_limited(&seen, "a.glb", change(|l| l.cameras = 1), "a.glb: too many cameras (limit: 1)");
    let lit = gltf(
        r#""extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},
        "nodes":[{"mesh":0,"extensions":{"KHR_lights_punctual":{"light":0}}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
        "bufferViews":[{"buffer":0,"byteLength":36}]"#,
    );
    assert_limited(&lit, "a.glb", change(|l| l.delta_lights = 0), "a.glb: too many delta lights (limit: 0)");
    assert_limited(
        &lit,
        "a.glb",
        change(|l| l.json_objects = 9),
        "a.glb: too many objects in JSON (limit: 9)",
    );
    let libraries = format!("mtllib a\nmtllib b\nmtllib a\n{square}");
    let obj = Files::new(&[("a.obj", libraries.as_bytes())]);
    let expected = "a.obj:2: too many material libraries (limit: 1)";
    assert_limited(&obj, "a.obj", change(|l| l.materials = 1), expected);
    assert!(Loader::new().limits(change(|l| l.materials = 2)).load(obj.path("a.obj")).is_ok());
    let no_limit = change(|l| l.bytes = u64::MAX);
    assert_eq!(Loader::new().limits(no_limit).load(obj.path("a.obj")).unwrap().model.triangles().len(), 2);
}

fn change(change: impl FnOnce(&mut Limits)) -> Limits {
    let mut limits = Limits::default();
    change(&mut limits);
    limits
}

/// A binary file with `nodes` nodes that place one mesh. The mesh has `primitives` equal primitives, each a
/// triangle fan of `corners` corners.
fn instances(nodes: usize, primitives: usize, corners: usize) -> Vec<u8> {
    let list = |what: &str, count: usize| vec![what; count].join(",");
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{}],"meshes":[{{"primitives":[{}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{corners},"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{bytes}}}],"buffers":[{{"byteLength":{bytes}}}]}}"#,
        list(r#"{"mesh":0}"#, nodes),
        list(r#"{"attributes":{"POSITION":0},"mode":6}"#, primitives),
        bytes = 12 * corners,
    );
    let corner = |i: usize| [(i as f32).cos(), (i as f32).sin(), 0.0];
    glb(&json, &floats((0..corners).map(corner).collect::<Vec<_>>().as_flattened()))
}

#[test]
fn a_small_file_of_many_instances_is_refused_before_it_takes_memory() {
    // 10^12 triangles in 1 MB, and 40 million in 20 kB.
    for (nodes, primitives, corners, message) in [
        (2000, 9000, 61_000, "too many triangles (limit: 536870912)"),
        (200, 200, 1002, "too many triangles of repeated mesh instances (limit: 33554432)"),
    ] {
        let bytes = instances(nodes, primitives, corners);
        assert!(bytes.len() < 2 << 20, "{}", bytes.len());
        let files = Files::new(&[("a.glb", &bytes)]);
        let mut refused = None;
        let allocated = allocation_counter::measure(|| refused = files.load("a.glb").err());
        assert_eq!(files.shortened(&refused.unwrap()), format!("a.glb: {message}"));
        assert!(allocated.bytes_max < 16 * bytes.len() as u64, "{allocated:?} for {}", bytes.len());
    }
    let small = Files::new(&[("a.glb", &instances(100, 50, 202))]);
    for (limits, message) in [
        (change(|l| l.triangles = 999_999), "a.glb: too many triangles (limit: 999999)"),
        (
            change(|l| l.instanced = 900_000),
            "a.glb: too many triangles of repeated mesh instances (limit: 900000)",
        ),
    ] {
        assert_limited(&small, "a.glb", limits, message);
    }
}

#[test]
fn primitives_without_triangles_cost_nothing_however_often_they_are_placed() {
    // 10^10 placed primitives. A loop over them would take a minute.
    let files = Files::new(&[("a.glb", &instances(100_000, 100_000, 2))]);
    let message = files.shortened(&files.load("a.glb").unwrap_err());
    let left_over = "vertices after the last complete triangle are ignored: 200000";
    assert_eq!(message, format!("a.glb: scene has no triangles ({left_over})"));
}

/// A glTF file with these members, and the positions of one triangle in its buffer.
fn gltf(members: &str) -> Files {
    let json = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":36}}],{members}}}"#);
    Files::new(&[("a.glb", &glb(&json, &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])))])
}

fn repeated(element: &str, count: usize) -> String {
    vec![element; count].join(",")
}

#[test]
fn what_many_elements_refer_to_is_read_once() {
    // Thousands of elements refer to 2 MB. Reading these for each element would take minutes.
    let large = format!(r#""extras":"{}""#, "a".repeat(2 << 20));
    let vertices = r#"{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}"#;
    let shape = |own: [&str; 3], accessors: &str, primitives: &str, nodes: &str| {
        format!(
            r#""nodes":[{nodes}],"meshes":[{{"primitives":[{primitives}]{}}}],"accessors":[{accessors}],
            "bufferViews":[{{"buffer":0,"byteLength":36{}}}],
            "cameras":[{{"type":"perspective","perspective":{{"yfov":1,"znear":1}}{}}}]"#,
            own[0], own[1], own[2]
        )
    };
    let large = format!(",{large}");
    let primitive = r#"{"attributes":{"POSITION":0}}"#;
    let count = 30_000;
    let primitives: Vec<_> = (0..count).map(|i| format!(r#"{{"attributes":{{"POSITION":{i}}}}}"#)).collect();
    let large_vertices = vertices.replace('}', &format!("{large}}}"));
    let cases = [
        shape([&large, "", ""], vertices, primitive, &repeated(r#"{"mesh":0}"#, count)),
        shape(["", &large, ""], &repeated(vertices, count), &primitives.join(","), r#"{"mesh":0}"#),
        shape(["", "", ""], &large_vertices, &repeated(primitive, count), r#"{"mesh":0}"#),
        shape(["", "", &large], vertices, &repeated(primitive, count), &{
            let cameras = repeated(r#"{"camera":0}"#, count);
            format!(r#"{cameras},{{"mesh":0}}"#)
        }),
    ];
    for members in cases {
        assert_eq!(gltf(&members).load("a.glb").unwrap().model.triangles().len(), count);
    }
}

#[test]
fn sparse_elements_that_accessors_share_are_limited() {
    // 10^10 sparse elements in 30 MB.
    let accessor = r#"{"componentType":5126,"count":1000000,"type":"VEC3","sparse":{"count":100000,
        "indices":{"bufferView":0,"componentType":5125},"values":{"bufferView":1}}}"#;
    let count = 100_000;
    let primitives: Vec<_> = (0..count).map(|i| format!(r#"{{"attributes":{{"POSITION":{i}}}}}"#)).collect();
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{}]}}],
        "accessors":[{}],"bufferViews":[{{"buffer":0,"byteLength":400000}},
        {{"buffer":0,"byteLength":1200000}}],"buffers":[{{"byteLength":1200000}}]}}"#,
        primitives.join(","),
        repeated(accessor, count)
    );
    let mut binary: Vec<u8> = (0..100_000_u32).flat_map(u32::to_le_bytes).collect();
    binary.resize(1_200_000, 0);
    let bytes = glb(&json, &binary);
    let files = Files::new(&[("a.glb", &bytes)]);
    let message = files.shortened(&files.load("a.glb").unwrap_err());
    let accessors = bytes.len() / 100_000;
    let size = bytes.len();
    assert_eq!(
        message,
        format!("a.glb: accessors[{accessors}]: too many elements of sparse accessors (limit: {size})")
    );
}

#[test]
fn warnings_beyond_what_a_report_holds_are_counted() {
    let extensions: Vec<_> = (0..10_000).map(|i| format!(r#""X_{i}""#)).collect();
    let files = gltf(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"extensionsUsed":[{}]"#,
        extensions.join(",")
    ));
    let report = files.load("a.glb").unwrap().report;
    let shown: Vec<_> = report.warnings.iter().map(|warning| files.shortened(warning)).collect();
    let named = shown.len() - 2;
    assert!((500..2000).contains(&named), "{named}");
    for (i, warning) in shown[..named].iter().enumerate() {
        assert_eq!(*warning, format!("a.glb: extension `X_{i}` is ignored"));
    }
    let left_out = format!("a.glb: further warnings are omitted: {}", 10_000 - named);
    assert_eq!(shown[named..], [left_out, "a.glb: scene has no lights".into()]);
}

#[test]
fn a_file_cut_off_anywhere_is_an_error() {
    let whole = instances(1, 1, 3);
    for length in 0..whole.len() {
        let files = Files::new(&[("a.glb", &whole[..length])]);
        assert!(files.load("a.glb").is_err(), "{length} bytes");
    }
}

#[test]
fn an_index_beyond_32_bits_does_not_become_a_small_one() {
    let json = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":4294967296}],"meshes":[{"primitives":[]}]}"#;
    let error = Files::new(&[("a.gltf", json.as_bytes())]).load("a.gltf").unwrap_err();
    assert_eq!(kind(&error), "Parse", "{error}");
}

#[test]
fn json_is_utf_8_also_where_it_is_not_read() {
    let json = b"{\"asset\":{\"version\":\"2.0\"},\n\"extras\":\"\xe4\"}";
    let message = |name: &str, bytes: &[u8]| {
        let files = Files::new(&[(name, bytes)]);
        files.shortened(&files.load(name).unwrap_err())
    };
    assert_eq!(message("a.gltf", json), "a.gltf:2: column 11: is not UTF-8");
    let mut chunk = glb(&" ".repeat(json.len().next_multiple_of(4)), &[]);
    chunk[20..][..json.len()].copy_from_slice(json);
    assert_eq!(message("a.glb", &chunk), "a.glb: JSON chunk: is not UTF-8 at line 2 column 11");
}

#[test]
fn a_missing_buffer_is_named_with_its_scene() {
    let json = r#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"my%20data/gone.bin"}]}"#;
    let files = Files::new(&[("a.gltf", json.as_bytes())]);
    let error = files.load("a.gltf").unwrap_err();
    assert_eq!(kind(&error), "Reference");
    let message = files.shortened(&error);
    assert!(message.starts_with("a.gltf: buffers[0]: `my data/gone.bin` cannot be read: "), "{message}");
}

#[test]
fn unknown_extensions_and_missing_files_are_named() {
    let message = |name: &str| globillum_io::load(Path::new(name)).unwrap_err().to_string();
    assert_eq!(message("a.stl"), "a.stl: unknown scene format; supported formats are .obj, .gltf and .glb");
    assert!(message("no/such.glb").starts_with("no/such.glb: cannot be read: "));
}
