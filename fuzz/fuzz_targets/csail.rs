//! Any bytes, read as a file of MIT CSAIL.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| brdf_fuzz::held(brdf_measured::csail::parse(data)));
