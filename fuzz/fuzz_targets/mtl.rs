//! MTL files.
#![no_main]

mod scene;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| scene::load(&[
    ("b.obj", b"mtllib b.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ("b.mtl", bytes)
]));
