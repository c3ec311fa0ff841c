//! What crosses the border between the host and a library: C's types alone.
//!
//! A library exports one symbol, [`SYMBOL`], a static [`Plugin`]. Its first word is the version of this
//! interface, and no other word is read where that is another one. Memory is freed by who made it: what the
//! host hands over is the host's and lives as long as the call, what `load` gives is the library's until
//! `free`. Texts are UTF-8 without an end mark. Nothing unwinds across the border.

use std::ffi::c_void;

/// The version of this interface; it changes with any layout or meaning here.
pub const VERSION: u32 = 1;

/// Dimensions of an array at the most.
pub const MOST_DIMENSIONS: usize = 5;

/// The name of the exported [`Plugin`], with its end mark.
pub const SYMBOL: &[u8] = b"BRDF_PLUGIN\0";

/// The table that a library exports.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Plugin {
    /// [`VERSION`] of the SDK that built it.
    pub version: u32,
    /// The size of this table [bytes].
    pub size: u32,
    /// Its name and version, for messages.
    pub identify: extern "C" fn() -> Text,
    /// Fills the answer and returns 0, or returns another number and leaves a sentence in `last_error`.
    pub load: unsafe extern "C" fn(*const Settings, *mut Answer) -> i32,
    /// Takes back what `load` gave.
    pub free: unsafe extern "C" fn(*mut Answer),
    /// What went wrong in the last call on this thread, until its next one.
    pub last_error: extern "C" fn() -> Text,
}

/// A text.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Text {
    /// Its first byte; may be null where it is empty.
    pub data: *const u8,
    /// How many bytes.
    pub length: u64,
}

/// What is asked for: an entry, and the values of parameters.
#[repr(C)]
pub struct Settings {
    /// The manifest's `entry`: a library may serve several plugins.
    pub entry: Text,
    /// The first.
    pub data: *const Setting,
    /// How many.
    pub length: u64,
}

/// A parameter's value.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Setting {
    /// Its key.
    pub key: Text,
    /// 0: `numbers[0]`; 1: all of `numbers`; 2: `text`.
    pub kind: u32,
    /// A number, or a colour.
    pub numbers: [f64; 3],
    /// A choice or a path.
    pub text: Text,
}

/// What `load` gives.
#[repr(C)]
pub struct Answer {
    /// The first array.
    pub arrays: *const Array,
    /// How many.
    pub array_count: u64,
    /// The first note.
    pub notes: *const Text,
    /// How many.
    pub note_count: u64,
    /// The library's own.
    pub owner: *mut c_void,
}

/// An array.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Array {
    /// Its name in the manifest.
    pub name: Text,
    /// 0: 32-bit floats; 1: unsigned 32-bit integers.
    pub element: u32,
    /// How many of `shape` count.
    pub rank: u32,
    /// Its dimensions, the slowest first.
    pub shape: [u64; MOST_DIMENSIONS],
    /// The first element, aligned to four bytes.
    pub data: *const c_void,
    /// How many elements.
    pub length: u64,
}

impl Text {
    /// The text of a borrowed string.
    pub const fn of(text: &str) -> Self {
        Self { data: text.as_ptr(), length: text.len() as u64 }
    }
}
