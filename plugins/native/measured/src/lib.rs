//! Measured materials: files become arrays that the plugins' WGSL reads and samples.
//!
//! One library for four plugins, by their manifests' `entry`. Files come from anywhere: every size is held
//! against the file's own before memory is taken, and what does not fit is one sentence. Where no file is
//! named, each format shows a material that is made up here (`made_up`), so that a plugin can be seen, proved
//! and compared without anybody's data.

pub mod csail;
mod file;
mod made_up;
pub mod merl;
pub mod rgl;
mod shared_exponent;
pub mod slice;

use brdf_sdk::native::{Loaded, Native, Request};

/// Weights of a colour's luminance, linear Rec. 709.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// The plugins that this library serves.
pub struct Measured;

impl Native for Measured {
    fn load(request: &Request) -> Result<Loaded, String> {
        let file = request.text("file")?;
        let file = (!file.is_empty()).then_some(file);
        match request.entry.as_str() {
            "merl" => merl::load(file),
            "csail" => csail::load(file),
            "rgl" => rgl::load(file),
            "image-slice" => slice::load(file),
            other => Err(format!(
                "the library `measured` has no entry `{other}`; write `entry = \"merl\"`, csail, rgl or image-slice"
            )),
        }
    }
}

brdf_sdk::export_plugin!(Measured, concat!("measured ", env!("CARGO_PKG_VERSION")));
