//! Native plugins: compiled code that prepares arrays for the plugin's own WGSL.
//!
//! The author writes one safe trait, [`Native`], and one line, [`export_plugin!`](crate::export_plugin):
//!
//! ```
//! use brdf_sdk::native::{Array, Loaded, Native, Request};
//!
//! struct Ramp;
//!
//! impl Native for Ramp {
//!     fn load(request: &Request) -> Result<Loaded, String> {
//!         let steps = request.number("steps")? as usize;
//!         let ramp = (0..steps).map(|i| i as f32 / steps as f32).collect();
//!         Ok(Loaded::new([Array::f32("ramp", [steps as u64], ramp)]))
//!     }
//! }
//!
//! brdf_sdk::export_plugin!(Ramp, "ramp 1.0");
//! # fn main() {}
//! ```
//!
//! A library never runs per sample: it turns a file or parameters into named arrays, which the WGSL reads
//! by `<array>_at(i)`. What crosses the border is described in [`abi`]; the author never meets it.

pub mod abi;
pub mod directions;
mod export;
pub mod lobes;
mod quiet;
pub mod slots;
pub mod tree;

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

pub use export::{export_free, export_last_error, export_load};

/// `make(0)`, `make(1)`, ... up to `count` values, by as many threads as the machine has.
pub fn in_parallel<T: Send>(count: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(count.max(1));
    let each = count.div_ceil(threads);
    std::thread::scope(|scope| {
        let work = |thread: usize| {
            let range = (thread * each).min(count)..((thread + 1) * each).min(count);
            let make = &make;
            scope.spawn(move || {
                quiet::quietly(|| {
                    catch_unwind(AssertUnwindSafe(|| range.map(make).collect::<Vec<T>>()))
                })
            })
        };
        let working: Vec<_> = (0..threads).map(work).collect();
        let made = working.into_iter().flat_map(|thread| match thread.join() {
            Ok((Ok(made), _)) => made,
            // Said again on the thread that asked, where it is told.
            Ok((Err(_), said)) => panic!("{}", said.unwrap_or_default()),
            Err(panic) => resume_unwind(panic),
        });
        made.collect()
    })
}

/// What a native plugin does.
pub trait Native {
    /// Turns a file or parameters into arrays. It may be called from any thread, and again for other values.
    ///
    /// # Errors
    /// One sentence for the user, `reason; cure`: it stands behind the name of the file or the plugin. A panic
    /// becomes one too.
    fn load(request: &Request) -> Result<Loaded, String>;
}

/// What is asked for: the values of the parameters that the manifest's `load` names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Request {
    /// The manifest's `entry`, by default the name of the plugin's folder: a library may serve several plugins.
    pub entry: String,
    /// Each parameter with its value.
    pub settings: Vec<(String, Setting)>,
}

/// A parameter's value.
#[derive(Debug, Clone, PartialEq)]
pub enum Setting {
    /// A number, an integer, or a switch (0 or 1).
    Number(f64),
    /// A colour, linear Rec. 709.
    Color([f64; 3]),
    /// A choice's option, or a file's path.
    Text(String),
}

impl Request {
    /// The value of a number, an integer or a switch.
    ///
    /// # Errors
    /// The manifest does not hand it over.
    pub fn number(&self, key: &str) -> Result<f64, String> {
        match self.find(key)? {
            Setting::Number(value) => Ok(*value),
            _ => Err(format!("the parameter `{key}` is no number")),
        }
    }

    /// The value of a switch.
    ///
    /// # Errors
    /// The manifest does not hand it over.
    pub fn switch(&self, key: &str) -> Result<bool, String> {
        Ok(self.number(key)? != 0.0)
    }

    /// The value of a choice, or the path of a file; empty where no file is named.
    ///
    /// # Errors
    /// The manifest does not hand it over.
    pub fn text(&self, key: &str) -> Result<&str, String> {
        match self.find(key)? {
            Setting::Text(value) => Ok(value),
            _ => Err(format!("the parameter `{key}` is no text")),
        }
    }

    fn find(&self, key: &str) -> Result<&Setting, String> {
        let found = self.settings.iter().find(|(name, _)| name == key);
        found.map(|(_, setting)| setting).ok_or_else(|| {
            format!("the parameter `{key}` was not handed over; name it in the manifest's `load`")
        })
    }
}

/// What a library gives.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loaded {
    /// The arrays that the manifest declares, in any order.
    pub arrays: Vec<Array>,
    /// What the user should know beside, a sentence each: values that were clamped, digits that were lost.
    pub notes: Vec<String>,
}

impl Loaded {
    /// These arrays, and nothing to be told.
    pub fn new(arrays: impl IntoIterator<Item = Array>) -> Self {
        Self { arrays: arrays.into_iter().collect(), notes: Vec::new() }
    }
}

/// A named array of up to four dimensions; one of vec4f or vec4u has a fifth, of 4.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Its name in the manifest.
    pub name: String,
    /// Its dimensions, the slowest first; their product is the number of elements.
    pub shape: Vec<u64>,
    /// Its elements.
    pub data: Data,
}

/// The elements of an array.
#[derive(Debug, Clone, PartialEq)]
pub enum Data {
    /// 32-bit floats.
    F32(Vec<f32>),
    /// Unsigned integers.
    U32(Vec<u32>),
}

impl Array {
    /// An array of floats.
    pub fn f32(name: &str, shape: impl Into<Vec<u64>>, data: Vec<f32>) -> Self {
        Self { name: name.to_owned(), shape: shape.into(), data: Data::F32(data) }
    }

    /// An array of integers.
    pub fn u32(name: &str, shape: impl Into<Vec<u64>>, data: Vec<u32>) -> Self {
        Self { name: name.to_owned(), shape: shape.into(), data: Data::U32(data) }
    }
}

impl Data {
    /// How many elements.
    pub fn len(&self) -> usize {
        match self {
            Data::F32(data) => data.len(),
            Data::U32(data) => data.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
