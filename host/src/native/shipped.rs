//! The libraries that are a part of the program, behind the same table as any other: they work wherever the
//! program was copied to, and trust is no question.

use brdf_sdk::native::abi;

/// The table of the library of that name.
pub fn table(name: &str) -> Option<&'static abi::Plugin> {
    match name {
        "measured" => Some(&brdf_measured::BRDF_PLUGIN),
        _ => None,
    }
}
