//! Files that request as much memory as possible for their size. Loading takes at most four times the
//! size of the files beyond what they declare, and in glTF beyond what the objects and values of the JSON take.
//! The test counts allocations, so it runs in its own process. A vector that grows counts twice while its
//! content moves.
//!
//! `cargo test -p globillum-io --test hostile -- --nocapture` prints the multiples.
#![cfg(all(feature = "obj", feature = "gltf"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]
#![allow(clippy::print_stderr, reason = "figures are printed with --nocapture")]

mod files;

use files::{Files, floats};
use globillum_geom::Triangle;
use globillum_io::{IoError, Loaded};
use globillum_testkit::bad_input::glb;
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The bound on the memory for loading as a multiple of the files' size, beyond what they declare.
const TIMES: u64 = 4;

/// The same for files of vertices: tobj stores 12 bytes for a line of 8, and a growing vector takes up to three
/// times the memory of its content.
const OBJ_TIMES: u64 = 6;

/// Bytes that an empty file may take: the report, and one block of the stack of nodes.
const SMALL: u64 = 256 << 10;

/// Bytes of a triangle in a model, with the index of its material.
const TRIANGLE: u64 = (size_of::<Triangle>() + size_of::<u32>()) as u64;

/// Bytes that a material or a library may take. There are at most 65,536 of each.
const NAMED: u64 = 1280;

/// Bytes that a light may take in the check for lights that overlap another triangle.
const LIGHT: u64 = 256;

/// Bytes of a camera or a delta light that a node places. There are at most 65,536 of each.
const CAMERA: u64 = 384;

/// Bytes that a JSON object may take. There are at most 2^20.
const OBJECT: u64 = 1024;

/// Bytes that any JSON value may take. There are at most 2^23.
const VALUE: u64 = 128;

/// A scene file, first in `files`, and the files beside it.
struct Hostile {
    name: &'static str,
    files: Vec<(&'static str, Vec<u8>)>,
    /// The number of loaded triangles, or a part of the error message.
    outcome: Result<usize, &'static str>,
    /// Triangles that it declares beyond those that are loaded.
    declared: usize,
    /// The number of lights.
    lights: usize,
    /// The number of cameras and delta lights that nodes place, and of materials and libraries that the files name.
    cameras: usize,
    named: usize,
    /// The bound on the memory for loading as a multiple of the files' size.
    most: u64,
}

impl Hostile {
    fn new(name: &'static str, file: &'static str, content: Vec<u8>) -> Self {
        Self {
            name,
            files: vec![(file, content)],
            outcome: Err("scene has no triangles"),
            declared: 0,
            lights: 0,
            cameras: 0,
            named: 0,
            most: TIMES,
        }
    }

    /// A glTF file with these members, and the positions of one triangle in its binary chunk.
    fn json(name: &'static str, members: &str) -> Self {
        let json = format!(r#"{{"asset":{{"version":"2.0"}},{members}}}"#);
        Self::new(name, "a.glb", glb(&json, &floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])))
    }

    fn obj(name: &'static str, text: String) -> Self {
        Self::new(name, "a.obj", text.into_bytes())
    }

    /// An OBJ file of one triangle, with the material library `text`.
    fn mtl(name: &'static str, text: String) -> Self {
        Self::obj(name, format!("mtllib a.mtl\n{FLAT}f 1 2 3\n")).beside("a.mtl", text.into_bytes()).loads(1)
    }

    fn beside(mut self, name: &'static str, content: Vec<u8>) -> Self {
        self.files.push((name, content));
        self
    }

    fn loads(self, triangles: usize) -> Self {
        Self { outcome: Ok(triangles), ..self }
    }

    fn refused(self, message: &'static str) -> Self {
        Self { outcome: Err(message), ..self }
    }

    /// Triangles that the refused file declares.
    fn declares(self, declared: usize) -> Self {
        Self { declared, ..self }
    }

    fn shines(self, lights: usize) -> Self {
        Self { lights, ..self }
    }

    fn sees(self, cameras: usize) -> Self {
        Self { cameras, ..self }
    }

    fn at_most(self, most: u64) -> Self {
        Self { most, ..self }
    }

    fn names(self, named: usize) -> Self {
        Self { named, ..self }
    }

    /// Loads the files, prints the memory that loading took, and returns a message if the check fails.
    fn check(&self) -> Option<String> {
        let list: Vec<_> = self.files.iter().map(|(name, content)| (*name, &content[..])).collect();
        let size = self.files.iter().map(|(_, content)| content.len() as u64).sum::<u64>();
        let files = Files::new(&list);
        let mut result = None;
        let allocated = allocation_counter::measure(|| result = Some(files.load(self.files[0].0)));
        let (triangles, outcome) = outcome(&files, &result.unwrap());
        let beside = (triangles + self.declared) as u64 * TRIANGLE + self.cameras as u64 * CAMERA;
        let taken = allocated.bytes_max.saturating_sub(beside);
        let (objects, values) = json_counts(&self.files[0].1);
        let mut line = format!(
            "{:46} {:5.2} MB, {:5.2} times, beside {:.2} MB",
            self.name,
            size as f64 / 1e6,
            taken as f64 / size as f64,
            beside as f64 / 1e6,
        );
        let counts = [(self.named as u64, "name"), (self.lights as u64, "light"), (objects, "object")];
        for (count, what) in counts.into_iter().chain([(values, "value")]) {
            if let Some(each) = taken.saturating_sub(size).checked_div(count) {
                write!(line, ", {each} bytes a {what}").unwrap();
            }
        }
        eprintln!("{line}");
        let expected = match (&outcome, self.outcome) {
            (Ok(found), Ok(expected)) => *found == expected,
            (Err(found), Err(expected)) => found.contains(expected),
            _ => false,
        };
        if !expected {
            return Some(format!("{}: {outcome:.200?} instead of {:?}", self.name, self.outcome));
        }
        let json = objects * OBJECT + values * VALUE;
        let allowed =
            self.most * size + json + self.named as u64 * NAMED + self.lights as u64 * LIGHT + SMALL;
        (taken > allowed).then_some(line)
    }
}

/// The number of objects and of all values in the JSON of a .glb; zero for other files. Of members of one name,
/// one counts.
fn json_counts(bytes: &[u8]) -> (u64, u64) {
    let length = bytes.get(12..16).filter(|_| bytes.starts_with(b"glTF"));
    let length = length.map(|length| u32::from_le_bytes(length.try_into().unwrap()) as usize);
    let json = length.and_then(|length| bytes.get(20..20 + length));
    let counts = json.and_then(|json| serde_json::from_slice(json).ok());
    counts.map_or((0, 0), |JsonCounts { objects, values }| (objects, values))
}

/// What a JSON value consists of, itself included, counted while it is read.
struct JsonCounts {
    objects: u64,
    values: u64,
}

impl JsonCounts {
    fn scalar<E>() -> Result<Self, E> {
        Ok(Self { objects: 0, values: 1 })
    }

    fn add(&mut self, inner: &Self) {
        self.objects += inner.objects;
        self.values += inner.values;
    }
}

impl<'de> Deserialize<'de> for JsonCounts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Counter)
    }
}

struct Counter;

impl<'de> Visitor<'de> for Counter {
    type Value = JsonCounts;

    fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E>(self) -> Result<JsonCounts, E> {
        JsonCounts::scalar()
    }

    fn visit_bool<E>(self, _: bool) -> Result<JsonCounts, E> {
        JsonCounts::scalar()
    }

    fn visit_u64<E>(self, _: u64) -> Result<JsonCounts, E> {
        JsonCounts::scalar()
    }

    fn visit_i64<E>(self, _: i64) -> Result<JsonCounts, E> {
        JsonCounts::scalar()
    }

    fn visit_f64<E>(self, _: f64) -> Result<JsonCounts, E> {
        JsonCounts::scalar()
    }

    fn visit_str<E>(self, _: &str) -> Result<JsonCounts, E> {
        JsonCounts::scalar()
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<JsonCounts, A::Error> {
        let mut counts = JsonCounts { objects: 0, values: 1 };
        while let Some(inner) = elements.next_element()? {
            counts.add(&inner);
        }
        Ok(counts)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<JsonCounts, A::Error> {
        let mut counts = JsonCounts { objects: 1, values: 1 };
        let mut names = BTreeSet::<String>::new();
        while let Some((name, inner)) = members.next_entry()? {
            if names.insert(name) {
                counts.add(&inner);
            }
        }
        Ok(counts)
    }
}

/// The number of triangles with degenerate ones, and the number without them or the error.
fn outcome(files: &Files, result: &Result<Loaded, IoError>) -> (usize, Result<usize, String>) {
    match result {
        Ok(loaded) => {
            let count = loaded.model.triangles().len();
            (count + loaded.report.degenerate_triangles, Ok(count))
        }
        Err(error) => (0, Err(files.shortened(error))),
    }
}

fn check(rows: impl IntoIterator<Item = Hostile>) {
    let failed: Vec<_> = rows.into_iter().filter_map(|row| row.check()).collect();
    assert!(failed.is_empty(), "not as it should be:\n{}", failed.join("\n"));
}

/// A JSON array.
fn array(count: usize, element: impl Fn(usize) -> String) -> String {
    let mut text = String::from("[");
    for i in 0..count {
        text += if i == 0 { "" } else { "," };
        text += &element(i);
    }
    text + "]"
}

/// A JSON array of `count` equal elements.
fn same(count: usize, element: &str) -> String {
    let rest = format!(",{element}").repeat(count.saturating_sub(1));
    format!("[{element}{rest}]")
}

/// One more than a power of two: a vector that doubles has just grown.
const MILLION: usize = (1 << 20) + 1;
const QUARTER: usize = (1 << 18) + 1;
const EIGHTH: usize = (1 << 17) + 1;
/// One more than the files may have of many things.
const MANY: usize = (1 << 16) + 1;
const FEW: usize = (1 << 15) + 1;

/// The members that a mesh of one triangle refers to.
const SHAPE: &str = r#""accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]"#;

const PRIMITIVE: &str = r#"{"attributes":{"POSITION":0}}"#;

#[test]
fn nodes() {
    let json = |name, nodes: &str| Hostile::json(name, &format!(r#""nodes":{nodes}"#));
    let leaf = || String::from("{}");
    let parent = |own: &str, children: String| format!(r#"{{{own}"children":[{children}]}}"#);
    let chain = |own| array(MANY + 1, |i| if i < MANY { parent(own, format!("{}", i + 1)) } else { leaf() });
    let comb =
        |own| {
            let is_parent = |i| i % 2 == 0 && i < 2 * MANY;
            array(2 * MANY + 1, |i| {
                if is_parent(i) { parent(own, format!("{},{}", i + 2, i + 1)) } else { leaf() }
            })
        };
    let mirrored = r#""scale":[-1,1,1],"#;
    let numbers = |range: std::ops::Range<usize>| array(range.len(), |i| (range.start + i).to_string());
    let identity = r#"{"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}"#;
    let scene = |nodes: &str, roots: &str| format!(r#"{nodes},"scenes":[{{"nodes":{roots}}}]"#);
    let empty = r#","meshes":[{"primitives":[]}]"#;
    check([
        json("nodes", &same(MANY, "{}")),
        json("nodes, too many", &same(MILLION, "{}")).refused("too many objects in JSON (limit: 1048576)"),
        json("nodes with names", &same(MANY, r#"{"name":"a"}"#)),
        json("nodes with extras", &same(MANY, r#"{"extras":0}"#)),
        json("nodes with weights", &same(MANY, r#"{"weights":[0]}"#)),
        json("nodes in a chain", &chain("")),
        json("nodes in a chain, mirrored", &chain(mirrored)),
        json("nodes in a comb", &comb("")),
        json("nodes in a comb, mirrored", &comb(mirrored)),
        json("nodes in a ring", &array(MANY, |i| format!(r#"{{"children":[{}]}}"#, (i + 1) % MANY)))
            .refused("nodes[0]: node is its own ancestor"),
        json(
            "nodes that are children of one",
            &format!(r#"[{{"children":{}}},{}]"#, numbers(1..MANY), "{},".repeat(MANY - 2) + "{}"),
        ),
        json("children that are all the same", &format!(r#"[{{}},{{"children":{}}}]"#, same(MILLION, "0")))
            .refused("nodes[0]: node has more than one parent"),
        json("nodes of a scene", &scene(&same(MANY, "{}"), &numbers(0..MANY))),
        json("roots that are all the same", &scene("[{}]", &same(MILLION, "0")))
            .refused("nodes[0]: node has more than one parent"),
        json("nodes with a matrix", &same(MANY, identity)),
        json("nodes with a scale", &same(MANY, r#"{"scale":[-1,1,1]}"#)),
        json("nodes of a mesh without triangles", &(same(MANY, r#"{"mesh":0}"#) + empty)),
        json(
            "nodes of a mesh without triangles, mirrored",
            &(same(MANY, r#"{"scale":[-1,1,1],"mesh":0}"#) + empty),
        ),
        json("nodes of a mesh with a skin", &(same(MANY, r#"{"mesh":0,"skin":0}"#) + empty)),
    ]);
}

#[test]
fn meshes() {
    let placed = |name, mesh: &str| {
        Hostile::json(name, &format!(r#""nodes":[{{"mesh":0}}],"meshes":[{mesh}],{SHAPE}"#))
    };
    let primitives = |primitives: String| format!(r#"{{"primitives":{primitives}}}"#);
    let each = |mesh: &str| {
        let nodes = array(MANY, |i| format!(r#"{{"mesh":{i}}}"#));
        format!(r#""nodes":{nodes},"meshes":{},{SHAPE}"#, same(MANY, mesh))
    };
    let targets = format!(r#"[{{"attributes":{{"POSITION":0}},"targets":{}}}]"#, same(MANY, "{}"));
    check([
        Hostile::json(
            "meshes without primitives",
            &format!(r#""meshes":{}"#, same(MANY, r#"{"primitives":[]}"#)),
        ),
        Hostile::json("meshes without primitives, placed", &each(r#"{"primitives":[]}"#)),
        Hostile::json("meshes of a triangle, placed", &each(&primitives(format!("[{PRIMITIVE}]"))))
            .loads(MANY),
        placed("primitives without positions", &primitives(same(MANY, r#"{"attributes":{}}"#))),
        placed("primitives of points", &primitives(same(MANY, r#"{"attributes":{},"mode":0}"#))),
        placed("primitives of a triangle", &primitives(same(MANY, PRIMITIVE))).loads(MANY),
        placed("attributes", &primitives(same(MANY, r#"{"attributes":{"COLOR_0":0}}"#))),
        placed("morph targets", &primitives(targets)).loads(1),
    ]);
}

#[test]
fn accessors_and_buffers() {
    let json =
        |name, member: &str, elements: String| Hostile::json(name, &format!(r#""{member}":{elements}"#));
    let vertex = r#"{"componentType":5126,"count":0,"type":"VEC3"}"#;
    let sparse = r#"{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,
        "indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}"#;
    let used = |accessor: &str| {
        let primitives = array(MANY, |i| format!(r#"{{"attributes":{{"POSITION":{i}}}}}"#));
        format!(
            r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":{primitives}}}],"accessors":{},
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36}}]"#,
            same(MANY, accessor)
        )
    };
    let bounded = |min: &str| format!(r#"[{{"componentType":5126,"count":0,"type":"VEC3","min":{min}}}]"#);
    let views = same(MANY, r#"{"buffer":0,"byteLength":0}"#);
    let shared = same(2000, r#"{"uri":"b.bin","byteLength":1000000}"#);
    let data = format!(r#"[{{"uri":"data:,{}","byteLength":0}}]"#, "a".repeat(4 << 20));
    let escaped = format!(r#"[{{"uri":"data:,\n{}","byteLength":0}}]"#, "a".repeat(4 << 20));
    check([
        json("accessors", "accessors", same(MANY, vertex)),
        json("bounds of numbers", "accessors", bounded(&same(MILLION, "0"))),
        json("bounds of lists", "accessors", bounded(&same(MANY, "[0]"))),
        json("bounds of objects", "accessors", bounded(&same(MANY, r#"{"":0}"#))),
        Hostile::json("accessors that primitives use", &used(vertex)),
        Hostile::json("sparse accessors that primitives use", &used(sparse)),
        json("buffer views", "bufferViews", views),
        json("buffers", "buffers", same(MANY, r#"{"byteLength":0}"#)),
        json("buffers of one file", "buffers", shared).beside("b.bin", vec![0; 1_000_000]),
        json("a buffer in the JSON", "buffers", data),
        json("a buffer in the JSON, escaped", "buffers", escaped),
    ]);
}

#[test]
fn the_rest_of_gltf() {
    let json =
        |name, member: &str, elements: String| Hostile::json(name, &format!(r#""{member}":{elements}"#));
    let placed = |cameras: &str, count| {
        format!(r#"{cameras},"nodes":{}"#, array(count, |i| format!(r#"{{"camera":{}}}"#, i % 2)))
    };
    let odd = array(MANY, |_| r#"{"type":""}"#.into());
    let each = format!(r#"{odd},"nodes":{}"#, array(MANY / 2, |i| format!(r#"{{"camera":{i}}}"#)));
    let seeing = r#"[{"type":"perspective","perspective":{"yfov":1,"znear":1}},{"type":"perspective","perspective":{"yfov":1,"znear":1}}]"#;
    let light = r#"{"type":"point"}"#;
    let lights = |list: &str| format!(r#"{{"KHR_lights_punctual":{{"lights":{list}}}}}"#);
    let lit = |count| {
        let node = r#"{"extensions":{"KHR_lights_punctual":{"light":0}}}"#;
        format!(r#","nodes":{}"#, same(count, node))
    };
    let text = |start: &str| format!(r#"[{{"name":"{start}{}"}}]"#, "a".repeat(4 << 20));
    check([
        json("materials, too many", "materials", same(MANY, "{}"))
            .refused("a.glb: too many materials (limit: 65536)"),
        json("materials", "materials", same(FEW, "{}")).names(FEW),
        json("a material's name", "materials", text("")),
        json("a material's name, escaped", "materials", text(r"\n")),
        json("cameras", "cameras", same(MANY, r#"{"type":""}"#)),
        json("cameras that are not perspective, placed", "cameras", each),
        json("cameras, too many", "cameras", placed(seeing, MANY)).refused("too many cameras (limit: 65536)"),
        json("cameras placed", "cameras", placed(seeing, FEW)).sees(FEW),
        json("images", "images", same(MANY, r#"{"uri":""}"#)),
        json("images of nothing", "images", same(MANY, "{}"))
            .refused("images[0]: image has neither a URI nor a buffer view"),
        json("scenes", "scenes", same(MANY, "{}")),
        json("extensions used", "extensionsUsed", same(MILLION, r#""""#)),
        json("extensions required", "extensionsRequired", same(MILLION, r#""KHR_texture_transform""#)),
        json("a string for a number", "scene", format!("\"{}\"", "a".repeat(4 << 20)))
            .refused(NO_NUMBER)
            .at_most(5),
        json(
            "a string for a number, of control characters",
            "scene",
            format!("\"{}\"", "\u{7f}".repeat(1 << 20)),
        )
        .refused(NO_NUMBER)
        .at_most(25),
        json("animations", "animations", same(MANY, "{}")),
        json("values, too many", "a", same(MILLION << 3, "0"))
            .refused("too many values in JSON (limit: 8388608)"),
        json("lights", "extensions", lights(&same(MANY, light))),
        json("lights placed", "extensions", lights(&format!("[{light}]")) + &lit(FEW)).sees(FEW),
        json("lights placed, too many", "extensions", lights(&format!("[{light}]")) + &lit(MANY))
            .refused("too many delta lights (limit: 65536)")
            .sees(65_536),
        json("brackets", "extras", "[".repeat(MILLION) + &"]".repeat(MILLION)),
        json("members that are not known", "a", format!("0{}", r#","a":0"#.repeat(MILLION))),
    ]);
}

/// The end of the message for a value that is not a number.
const NO_NUMBER: &str = ", expected index into child of root";

const FLAT: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// A text of `count` lines.
fn lines(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).map(|i| line(i) + "\n").collect()
}

#[test]
#[ignore = "takes a gigabyte: as many objects or values as the limits allow"]
fn the_limits_on_json_bound_the_memory() {
    let json =
        |name, member: &str, elements: String| Hostile::json(name, &format!(r#""{member}":{elements}"#));
    let accessor = |min: &str| format!(r#"[{{"componentType":5126,"count":0,"type":"VEC3","min":{min}}}]"#);
    let (objects, values) = ((1 << 20) - 16, (1 << 22) - 16);
    check([
        json("materials", "materials", same(objects, "{}")).refused("too many materials"),
        json("nodes", "nodes", same(objects, "{}")),
        json("bounds of numbers", "accessors", accessor(&same(values + 32, "0"))),
        json("bounds of lists", "accessors", accessor(&same(values, "[0]"))),
        json("bounds of objects", "accessors", accessor(&same(objects, r#"{"":0}"#))),
        json("extensions used", "extensionsUsed", same(values + 32, r#""a""#)),
    ]);
}

#[test]
fn obj() {
    let obj = |name, text: String| Hostile::obj(name, format!("{FLAT}{text}"));
    let polygon = |corners: usize, ring: &str| format!("f{}\n", ring.repeat(corners / 3));
    check([
        obj("vertices", "v 0 0 0\n".repeat(QUARTER)),
        obj("vertices, just more than a vector of tobj holds", "v 0 0 0\n".repeat((1 << 20) / 3))
            .at_most(OBJ_TIMES),
        obj("vertices of nothing", "v \n".repeat(QUARTER)).refused("expected 3, 4 or 6 numbers"),
        obj("faces", "f 1 2 3\n".repeat(QUARTER)).loads(QUARTER),
        obj("faces without area", "f 1 1 1\n".repeat(QUARTER) + "f 1 2 3\n").loads(1),
        obj("faces that end in comments", "f 1 1 1 # 1 1 1 1 1 1\n".repeat(EIGHTH) + "f 1 2 3").loads(1),
        obj("polygons", polygon(60_000, " 1 2 3").repeat(10)).loads(200_000),
        obj("one polygon", polygon(60_000, " 1 2 3")).loads(20_000),
        obj("one polygon, too large", polygon(69_000, " 1 2 3"))
            .refused("too many vertices in a polygon (limit: 65536)")
            .declares(65_536),
        obj("polygons without area", polygon(60_000, " 1 1 1").repeat(10) + "f 1 2 3").loads(1),
        obj("faces and vertices in turns", "v 0 0 0\nf -1 1 2\n".repeat(EIGHTH) + "f 1 2 3\n").loads(1),
        obj("faces of three and four corners", "f 1 2 3\nf 1 2 3 3\n".repeat(EIGHTH)).loads(2 * EIGHTH),
        obj("faces that change the material", "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n".repeat(EIGHTH))
            .loads(2 * EIGHTH),
        obj("faces of two corners", "f 1 1\n".repeat(QUARTER)),
        obj("faces over many lines", "f 1 \\\n2 \\\n3\n".repeat(EIGHTH)).loads(EIGHTH),
        obj("texture coordinates and normals", "vt\nvn\n".repeat(QUARTER)),
        obj("groups", "g\n".repeat(QUARTER)),
        obj("empty lines", "\n".repeat(QUARTER)),
        obj("changes of material", "usemtl a\n".repeat(QUARTER)),
        obj("materials", lines(FEW, |i| format!("usemtl {i:x}"))).names(FEW),
        obj("materials, too many", lines(EIGHTH, |i| format!("usemtl {i:x}")))
            .refused("too many materials (limit: 65536)")
            .names(65_536),
        obj("one library", "mtllib a\n".repeat(QUARTER)),
        obj("libraries", lines(FEW, |i| format!("mtllib {i:x}")) + "f 1 2 3").loads(1).names(FEW),
        obj("libraries, too many", lines(EIGHTH, |i| format!("mtllib {i:x}")))
            .refused("too many material libraries (limit: 65536)")
            .names(65_536),
        obj("libraries, many of a line", lines(4096, |i| format!("mtllib {i:x}{}", " a".repeat(100))))
            .refused("too many material libraries (limit: 65536)")
            .names(4096),
        obj("a word", format!("v {}\n", "a".repeat(4 << 20))).refused("is not a number"),
    ]);
}

#[test]
fn mtl() {
    let shining = |name, faces: String| {
        let scene = format!("mtllib a.mtl\nusemtl a\n{FLAT}{faces}");
        Hostile::obj(name, scene).beside("a.mtl", b"newmtl a\nKe 1\n".into()).loads(EIGHTH).shines(EIGHTH)
    };
    let on_a_ball = |i: usize| {
        let (z, turn) = (i as f64 / 501.0 - 1.0, i as f64 * 2.4);
        let radius = (1.0 - z * z).sqrt();
        format!("v {:.4} {:.4} {z}", radius * turn.cos(), radius * turn.sin())
    };
    let corners = |i: usize| format!("f {} {} {}", i % 997 + 4, i % 991 + 5, i % 983 + 6);
    let not_utf8 = [b"newmtl ", &b"\xffa".repeat(2 << 20)[..], b"\nmap_Kd a\nTr 1\n"].concat();
    let of_their_own = lines(1002, on_a_ball) + &lines(EIGHTH, corners);
    check([
        Hostile::mtl("materials of one name", "newmtl a\n".repeat(FEW)).names(FEW),
        Hostile::mtl("materials of a library", lines(FEW, |i| format!("newmtl {i:x}"))).names(FEW),
        Hostile::mtl("materials of a library, too many", lines(EIGHTH, |i| format!("newmtl {i:x}")))
            .refused("too many materials (limit: 65536)")
            .names(65_536),
        shining("lights in one plane", "f 1 2 3\n".repeat(EIGHTH)),
        shining("lights in planes of their own", of_their_own),
        Hostile::mtl("colours", "newmtl a\n".to_owned() + &"Kd 1\n".repeat(QUARTER)),
        Hostile::mtl(
            "statements of their own",
            "newmtl a\n".to_owned() + &lines(EIGHTH, |i| format!("{i:x} 1")),
        ),
        Hostile::mtl("a colour", format!("newmtl a\nKd{}\n", " 1".repeat(QUARTER)))
            .refused("expected 1 or 3 numbers"),
        Hostile::mtl("a name that is not UTF-8", String::new()).beside("a.mtl", not_utf8).at_most(OBJ_TIMES),
        Hostile::mtl("a name", format!("newmtl {}\nmap_Kd a\nTr 1\n", "a".repeat(4 << 20))),
    ]);
}
