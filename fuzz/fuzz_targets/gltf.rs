//! glTF files, as text.
#![no_main]

mod scene;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| scene::load(&[("c.gltf", bytes)]));
