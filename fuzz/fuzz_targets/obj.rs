//! Any bytes, read as a Wavefront OBJ file.
#![no_main]

use brdf_fuzz::{mesh, panics};
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: panics::of_others_pass(), |data: &[u8]| panics::caught(|| mesh::check("obj", data)));
