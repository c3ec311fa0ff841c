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
            _ => format!("its library ({}) failed without a reason (status {status})", name(table)),
        });
    }
    // SAFETY: the library has filled it, and it is given back once, after the last look.
    unsafe {
        let mut answer = answer.assume_init();
        let copied = copied(&answer);
        (table.free)(&raw mut answer);
        copied.map_err(|error| format!("its library ({}) gives {error}", name(table)))
    }
}

/// What a library says that it is.
fn name(table: &abi::Plugin) -> String {
    // SAFETY: the text is the library's for good.
    unsafe { text((table.identify)()) }.unwrap_or_else(|_| "of no name".to_owned())
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
                    return Err(format!("`{name}` with the unknown type {other}"));
                }
            };
            let shape = array.shape.get(..array.rank as usize);
            let shape = shape.ok_or("an array of more than five dimensions")?;
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
    String::from_utf8(bytes.to_vec()).map_err(|_| "a text that is not UTF-8".to_owned())
}

/// # Safety
/// `data` points to `length` elements, where it is not null and aligned.
unsafe fn slice<'a, T>(data: *const T, length: u64) -> Result<&'a [T], String> {
    if length == 0 {
        return Ok(&[]);
    }
    if data.is_null() || !data.is_aligned() || length > MOST_ELEMENTS {
        return Err(format!("{length} elements at an impossible place"));
    }
    // SAFETY: by the caller's word.
    Ok(unsafe { std::slice::from_raw_parts(data, length as usize) })
}

#[cfg(test)]
mod tests {
    use std::ptr::{null, null_mut};

    use super::*;

    extern "C" fn identify() -> abi::Text {
        abi::Text::of("odd 1.0")
    }

    extern "C" fn silent() -> abi::Text {
        abi::Text { data: null(), length: 0 }
    }

    unsafe extern "C" fn keep(_: *mut abi::Answer) {}

    /// Answers one array of four floats, with one thing wrong: the text of the entry says which.
    unsafe extern "C" fn odd(settings: *const abi::Settings, answer: *mut abi::Answer) -> i32 {
        static DATA: [f32; 4] = [1.0, 2.0, 3.0, 4.0];
        static BYTES: [u8; 2] = [0xff, 0xfe];
        // SAFETY: the test hands over what lives as long as the call.
        let entry = unsafe { text((*settings).entry) }.unwrap_or_default();
        let mut array = abi::Array {
            name: abi::Text::of("values"),
            element: 0,
            rank: 1,
            shape: [4, 1, 1, 1, 1],
            data: DATA.as_ptr().cast(),
            length: 4,
        };
        let mut count = 1;
        match entry.as_str() {
            "null" => array.data = null(),
            "unaligned" => array.data = array.data.wrapping_byte_add(1),
            "endless" => array.length = u64::MAX,
            "element" => array.element = 7,
            "rank" => array.rank = 6,
            "name" => array.name = abi::Text { data: BYTES.as_ptr(), length: 2 },
            "count" => count = u64::MAX,
            "status" => return -3,
            _ => {}
        }
        let arrays = Box::leak(Box::new(array));
        let filled = abi::Answer {
            arrays,
            array_count: count,
            notes: null(),
            note_count: 0,
            owner: null_mut(),
        };
        // SAFETY: as above.
        unsafe { answer.write(filled) };
        0
    }

    /// What another language's library may get wrong is told and not followed.
    #[test]
    fn answers_that_cannot_be_are_refused() {
        let table = abi::Plugin {
            version: abi::VERSION,
            size: size_of::<abi::Plugin>() as u32,
            identify,
            load: odd,
            free: keep,
            last_error: silent,
        };
        let ask =
            |entry: &str| load(&table, &Request { entry: entry.to_owned(), settings: vec![] });
        assert_eq!(ask("good").map(|loaded| loaded.arrays.len()), Ok(1));
        for (entry, said) in [
            ("null", "gives 4 elements at an impossible place"),
            ("unaligned", "gives 4 elements at an impossible place"),
            ("endless", "gives 18446744073709551615 elements at an impossible place"),
            ("element", "gives `values` with the unknown type 7"),
            ("rank", "gives an array of more than five dimensions"),
            ("name", "gives a text that is not UTF-8"),
            ("count", "gives 18446744073709551615 elements at an impossible place"),
            ("status", "failed without a reason (status -3)"),
        ] {
            assert_eq!(ask(entry), Err(format!("its library (odd 1.0) {said}")), "{entry}");
        }
    }
}
