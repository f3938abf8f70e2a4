//! OBJ files.
#![no_main]

mod scene;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| scene::load(&[("a.obj", bytes), ("a.mtl", b"newmtl m\nKe 1\n")]));
