//! Memory and progress reports of loading large files. The test counts allocations, so it runs in its own
//! process.
#![cfg(all(feature = "obj", feature = "gltf"))]
#![allow(clippy::unwrap_used, reason = "a test that cannot continue fails")]
#![allow(clippy::print_stderr, reason = "figures are printed with --nocapture")]

mod files;

use files::Files;
use globillum_geom::Triangle;
use globillum_io::{LoadMonitor, LoadProgress, Loader};
use globillum_testkit::bad_input::glb;
use std::cell::Cell;
use std::fmt::Write;
use std::time::Instant;

/// Bytes of a triangle in a model, with the index of its material.
const TRIANGLE_BYTES: usize = size_of::<Triangle>() + size_of::<u32>();

#[derive(Default)]
struct Reports {
    count: Cell<u32>,
    last: Cell<Option<LoadProgress>>,
}

impl LoadMonitor for Reports {
    fn progress(&self, progress: LoadProgress) {
        assert!(self.last.get().is_none_or(|last| last.done <= progress.done));
        self.count.set(self.count.get() + 1);
        self.last.set(Some(progress));
    }
}

/// Loads `content` as `name`. Returns and prints the peak of allocated bytes beyond those of the triangles, as
/// a multiple of the file's size.
fn overhead(name: &str, content: &[u8], triangles: usize) -> f64 {
    let files = Files::new(&[(name, content)]);
    let reports = Reports::default();
    let (mut loaded, start) = (None, Instant::now());
    let allocated = allocation_counter::measure(|| {
        loaded = Some(Loader::new().monitor(&reports).load(files.path(name)).unwrap());
    });
    assert_eq!(loaded.unwrap().model.triangles().len(), triangles);
    assert!(reports.count.get() > 2, "{name}: hardly a report");
    let last = reports.last.get().unwrap();
    assert_eq!(last.done, last.total);
    let times = (allocated.bytes_max as f64 - (triangles * TRIANGLE_BYTES) as f64) / content.len() as f64;
    eprintln!(
        "{name}: {triangles} triangles, {:.1} MB, {:.2} s, {} reports, {times:.2} times the file",
        content.len() as f64 / 1e6,
        start.elapsed().as_secs_f64(),
        reports.count.get(),
    );
    times
}

/// The triangles of a sheet of `side` by `side` squares.
fn sheet(side: u32) -> impl Iterator<Item = [u32; 3]> {
    let corner = move |x: u32, y: u32| x * (side + 1) + y;
    (0..side * side).flat_map(move |i| {
        let (x, y) = (i / side, i % side);
        let [a, b, c, d] = [corner(x, y), corner(x + 1, y), corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    })
}

fn vertices(side: u32) -> impl Iterator<Item = [f32; 3]> {
    let height = |x: f32, y: f32| (x * 0.37).sin() * (y * 0.23).cos();
    (0..=side).flat_map(move |x| (0..=side).map(move |y| [x as f32, y as f32, height(x as f32, y as f32)]))
}

fn obj(side: u32) -> String {
    let mut text = String::new();
    for [x, y, z] in vertices(side) {
        writeln!(text, "v {x:.6} {y:.6} {z:.6}").unwrap();
    }
    for [a, b, c] in sheet(side) {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn binary(side: u32) -> Vec<u8> {
    let mut bytes: Vec<u8> = vertices(side).flatten().flat_map(f32::to_le_bytes).collect();
    let (vertex_bytes, vertex_count) = (bytes.len(), bytes.len() / 12);
    bytes.extend(sheet(side).flatten().flat_map(u32::to_le_bytes));
    let (length, index_count) = (bytes.len(), 6 * side * side);
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{vertex_count},"type":"VEC3"}},
        {{"bufferView":1,"componentType":5125,"count":{index_count},"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{vertex_bytes}}},
        {{"buffer":0,"byteOffset":{vertex_bytes},"byteLength":{}}}],"buffers":[{{"byteLength":{length}}}]}}"#,
        length - vertex_bytes
    );
    glb(&json, &bytes)
}

fn assert_small(side: u32) {
    let triangles = 2 * (side * side) as usize;
    let obj = overhead("a.obj", obj(side).as_bytes(), triangles);
    let glb = overhead("a.glb", &binary(side), triangles);
    assert!(obj < 4.0 && glb < 4.0, "{triangles} triangles: OBJ {obj:.2}, glTF {glb:.2} times the file");
}

#[test]
fn loading_takes_at_most_four_times_the_file_beside_the_triangles() {
    assert_small(300);
}

#[test]
#[ignore = "takes a while: three million triangles"]
fn so_it_does_for_three_million_triangles() {
    assert_small(1225);
}

#[test]
fn row_38_a_million_changes_of_material() {
    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    for _ in 0..500_000 {
        text.push_str("usemtl red\nf 1 2 3\nusemtl blue\nf 3 2 1\n");
    }
    let times = overhead("a.obj", text.as_bytes(), 1_000_000);
    assert!(times < 4.0, "{times:.2} times the file");
}
