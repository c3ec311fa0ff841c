//! Any bytes, read as a file of the RGL database.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| brdf_fuzz::held(brdf_measured::rgl::parse(data)));
