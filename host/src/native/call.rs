//! One call of a library: values go in, arrays are copied out, and what the library made is given back.
#![allow(unsafe_code, reason = "pointers cross the border here")]

use std::mem::MaybeUninit;

use brdf_sdk::native::{Array, Data, Loaded, Request, Setting, abi};

/// Elements of one array at the most: sixteen gigabytes.
const MOST_ELEMENTS: u64 = 1 << 32;

/// What the library gives for a request, or its sentence.
pub fn load(table: &abi::Plugin, request: &Request) -> Result<Loaded, String> {
    let setting = |(key, setting): &(String, Setting)| {
        let (kind, numbers, text) = match setting {
            Setting::Number(number) => (0, [*number, 0.0, 0.0], ""),
            Setting::Color(rgb) => (1, *rgb, ""),
            Setting::Text(text) => (2, [0.0; 3], text.as_str()),
        };
        abi::Setting { key: abi::Text::of(key), kind, numbers, text: abi::Text::of(text) }
    };
    let settings: Vec<abi::Setting> = request.settings.iter().map(setting).collect();
    let handed = abi::Settings {
        entry: abi::Text::of(&request.entry),
        data: settings.as_ptr(),
        length: settings.len() as u64,
    };
    let mut answer = MaybeUninit::<abi::Answer>::uninit();
    // SAFETY: what is handed over lives as long as the call, and the table says that it fills the answer or
    // returns another number than 0.
    let status = unsafe { (table.load)(&raw const handed, answer.as_mut_ptr()) };
    if status != 0 {
        // SAFETY: the text lives until the library's next call on this thread.
        let said = unsafe { text((table.last_error)()) };
        return Err(match said {
            Ok(said) if !said.trim().is_empty() => said,
            _ => format!("its library failed without a reason (status {status})"),
        });
    }
    // SAFETY: the library has filled it, and it is given back once, after the last look.
    unsafe {
        let mut answer = answer.assume_init();
        let copied = copied(&answer);
        (table.free)(&raw mut answer);
        copied
    }
}

/// # Safety
/// The answer is a library's and was not given back.
unsafe fn copied(answer: &abi::Answer) -> Result<Loaded, String> {
    // SAFETY: by the caller's word.
    let (arrays, notes) = unsafe {
        (slice(answer.arrays, answer.array_count)?, slice(answer.notes, answer.note_count)?)
    };
    let mut loaded = Loaded::default();
    for array in arrays {
        // SAFETY: texts and data live as long as the answer.
        unsafe {
            let name = text(array.name)?;
            let data = match array.element {
                0 => Data::F32(slice(array.data.cast::<f32>(), array.length)?.to_vec()),
                1 => Data::U32(slice(array.data.cast::<u32>(), array.length)?.to_vec()),
                other => {
                    return Err(format!(
                        "its library gives `{name}` with the unknown type {other}"
                    ));
                }
            };
            let shape = array.shape.get(..array.rank as usize);
            let shape = shape.ok_or("its library gives an array of more than five dimensions")?;
            loaded.arrays.push(Array { name, shape: shape.to_vec(), data });
        }
    }
    for note in notes {
        // SAFETY: as above.
        loaded.notes.push(unsafe { text(*note)? });
    }
    Ok(loaded)
}

/// # Safety
/// The text is valid.
unsafe fn text(text: abi::Text) -> Result<String, String> {
    // SAFETY: by the caller's word.
    let bytes = unsafe { slice(text.data, text.length)? };
    String::from_utf8(bytes.to_vec())
        .map_err(|_| "its library gives a text that is not UTF-8".to_owned())
}

/// # Safety
/// `data` points to `length` elements, where it is not null and aligned.
unsafe fn slice<'a, T>(data: *const T, length: u64) -> Result<&'a [T], String> {
    if length == 0 {
        return Ok(&[]);
    }
    if data.is_null() || !data.is_aligned() || length > MOST_ELEMENTS {
        return Err(format!("its library gives {length} elements at an impossible place"));
    }
    // SAFETY: by the caller's word.
    Ok(unsafe { std::slice::from_raw_parts(data, length as usize) })
}
