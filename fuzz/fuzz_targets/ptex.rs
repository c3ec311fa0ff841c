//! Any bytes, read as an environment map, from seeds that are a Ptex cube.
#![no_main]

use brdf_fuzz::{map, panics};
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: panics::of_others_pass(), |data: &[u8]| panics::caught(|| map::check("ptx", data)));
