//! Checkpoints.
#![no_main]

use globillum_integrator::check_checkpoint;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    check_checkpoint(bytes);
});
