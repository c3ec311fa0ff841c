//! Any bytes, read as an image slice, a picture or a table. The decoder of OpenEXR panics at some pictures, and the
//! parser makes a sentence of it.
#![no_main]

use brdf_fuzz::panics;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: panics::of_others_pass(), |data: &[u8]| {
    panics::caught(|| brdf_fuzz::held(brdf_measured::slice::parse(data)));
});
