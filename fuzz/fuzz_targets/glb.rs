//! Binary glTF files.
#![no_main]

mod scene;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| scene::load(&[("d.glb", bytes)]));
