//! The glue behind `export_plugin!`: a safe trait on the inside, C on the outside.
//!
//! Panics end here, shapes are checked before they cross, and what was handed over is kept until it is given back.
//! The only `unsafe` of this crate.
#![allow(unsafe_code, reason = "pointers cross the border here")]

use std::cell::RefCell;
use std::ffi::c_void;
use std::panic::catch_unwind;

use super::quiet::quietly;
use super::{Data, Loaded, Native, Request, Setting, abi};

thread_local! {
    static LAST_ERROR: RefCell<String> = const { RefCell::new(String::new()) };
}

/// What stays alive until `free`.
struct Owner {
    _loaded: Loaded,
    arrays: Vec<abi::Array>,
    notes: Vec<abi::Text>,
}

/// `load` of the exported table.
///
/// # Safety
/// `settings` and its texts are valid for the call, and `answer` may be written.
pub unsafe extern "C" fn export_load<P: Native>(
    settings: *const abi::Settings,
    answer: *mut abi::Answer,
) -> i32 {
    // SAFETY: the caller keeps `settings` valid for the call.
    let request = unsafe { request(settings) };
    let (loaded, said) =
        quietly(|| catch_unwind(|| request.and_then(|request| checked(P::load(&request)?))));
    let error = match loaded {
        Ok(Ok(loaded)) => {
            // SAFETY: the caller lets `answer` be written.
            unsafe { answer.write(hand_over(loaded)) };
            return 0;
        }
        Ok(Err(error)) => error,
        Err(panic) => {
            // Dropping what was thrown may throw again.
            std::mem::forget(panic);
            format!("the library panicked {}; mend it and build it again", said.unwrap_or_default())
        }
    };
    let _ = LAST_ERROR.try_with(|last| last.replace(error));
    1
}

/// `free` of the exported table.
///
/// # Safety
/// `answer` was filled by [`export_load`] of the same library and is freed once.
pub unsafe extern "C" fn export_free(answer: *mut abi::Answer) {
    // SAFETY: `owner` came from `hand_over`, and nobody freed it before.
    unsafe {
        let owner = std::mem::replace(&mut (*answer).owner, std::ptr::null_mut());
        if !owner.is_null() {
            drop(Box::from_raw(owner.cast::<Owner>()));
        }
    }
}

/// `last_error` of the exported table.
pub extern "C" fn export_last_error() -> abi::Text {
    let text = LAST_ERROR.try_with(|last| abi::Text::of(&last.borrow()));
    text.unwrap_or(abi::Text::of("the thread is ending"))
}

/// Shapes that do not fit are the author's mistake and the author's words.
fn checked(loaded: Loaded) -> Result<Loaded, String> {
    for array in &loaded.arrays {
        let count = array.shape.iter().try_fold(1u64, |product, n| product.checked_mul(*n));
        if array.shape.len() > abi::MOST_DIMENSIONS || count != Some(array.data.len() as u64) {
            return Err(format!(
                "the array `{}` has {} elements and the shape {:?}",
                array.name,
                array.data.len(),
                array.shape
            ));
        }
    }
    Ok(loaded)
}

/// # Safety
/// `settings` and its texts are valid.
unsafe fn request(settings: *const abi::Settings) -> Result<Request, String> {
    // SAFETY: by the caller's word.
    let (entry, settings) = unsafe {
        let abi::Settings { entry, data, length } = *settings;
        (text(entry)?, slice(data, length))
    };
    let read = |setting: &abi::Setting| {
        // SAFETY: texts are as valid as their settings.
        let (key, text) = unsafe { (text(setting.key)?, text(setting.text)?) };
        let value = match setting.kind {
            0 => Setting::Number(setting.numbers[0]),
            1 => Setting::Color(setting.numbers),
            2 => Setting::Text(text),
            other => return Err(format!("the host sent a setting of the unknown kind {other}")),
        };
        Ok((key, value))
    };
    Ok(Request { entry, settings: settings.iter().map(read).collect::<Result<_, String>>()? })
}

/// # Safety
/// The text is valid.
unsafe fn text(text: abi::Text) -> Result<String, String> {
    // SAFETY: by the caller's word.
    let bytes = unsafe { slice(text.data, text.length) };
    String::from_utf8(bytes.to_vec())
        .map_err(|_| "the host sent a text that is not UTF-8".to_owned())
}

/// # Safety
/// `data` points to `length` elements, or `length` is 0.
unsafe fn slice<'a, T>(data: *const T, length: u64) -> &'a [T] {
    match length {
        0 => &[],
        // SAFETY: by the caller's word.
        _ => unsafe { std::slice::from_raw_parts(data, length as usize) },
    }
}

fn hand_over(loaded: Loaded) -> abi::Answer {
    let arrays = loaded.arrays.iter().map(|array| {
        let (element, data) = match &array.data {
            Data::F32(data) => (0, data.as_ptr().cast::<c_void>()),
            Data::U32(data) => (1, data.as_ptr().cast::<c_void>()),
        };
        let mut shape = [1; abi::MOST_DIMENSIONS];
        shape[..array.shape.len()].copy_from_slice(&array.shape);
        abi::Array {
            name: abi::Text::of(&array.name),
            element,
            rank: array.shape.len() as u32,
            shape,
            data,
            length: array.data.len() as u64,
        }
    });
    let arrays: Vec<abi::Array> = arrays.collect();
    let notes: Vec<abi::Text> = loaded.notes.iter().map(|note| abi::Text::of(note)).collect();
    // What the pointers lead to lies on the heap and does not move with its owner.
    let owner = Box::new(Owner { _loaded: loaded, arrays, notes });
    abi::Answer {
        arrays: owner.arrays.as_ptr(),
        array_count: owner.arrays.len() as u64,
        notes: owner.notes.as_ptr(),
        note_count: owner.notes.len() as u64,
        owner: Box::into_raw(owner).cast(),
    }
}

/// Exports a type that is [`Native`](crate::native::Native) as a plugin; the text names it and its version.
#[macro_export]
macro_rules! export_plugin {
    ($plugin:ty, $name:expr) => {
        /// What the host looks for.
        #[allow(unsafe_code, reason = "an exported symbol")]
        #[unsafe(no_mangle)]
        pub static BRDF_PLUGIN: $crate::native::abi::Plugin = {
            extern "C" fn identify() -> $crate::native::abi::Text {
                $crate::native::abi::Text::of($name)
            }
            $crate::native::abi::Plugin {
                version: $crate::native::abi::VERSION,
                size: ::core::mem::size_of::<$crate::native::abi::Plugin>() as u32,
                identify,
                load: $crate::native::export_load::<$plugin>,
                free: $crate::native::export_free,
                last_error: $crate::native::export_last_error,
            }
        };
    };
}
