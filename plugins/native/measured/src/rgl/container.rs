//! The "tensor file": named arrays behind a table of where they lie.
//!
//! "tensor_file" and a zero byte, a version of two bytes (1, 0), a 32-bit count of fields, and for each field the
//! length of its name (16 bits) and the name, its dimensions (16 bits), its type (8 bits), where it begins
//! (64 bits) and its shape (64 bits each).

use crate::file::shown;

/// What such files begin with.
pub const MAGIC: &[u8; 12] = b"tensor_file\0";

/// A file's fields; the bytes stay where they are.
pub struct Container<'a> {
    bytes: &'a [u8],
    fields: Vec<Field>,
}

struct Field {
    name: String,
    ty: u8,
    begin: u64,
    shape: Vec<u64>,
}

/// Types of elements, by their number in the file.
const U8: u8 = 1;
const F32: u8 = 10;

/// Fields and dimensions at the most; whatever has more was not meant as one of these files.
const MOST_FIELDS: u32 = 256;
const MOST_DIMENSIONS: u16 = 8;

const DAMAGED: &str = "the file is damaged or was cut off, so fetch it again";

impl<'a> Container<'a> {
    /// Reads the table of fields.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        let Some(mut rest) = bytes.strip_prefix(MAGIC) else {
            return Err(
                "it does not begin with `tensor_file`; name a file of the RGL material database"
                    .to_owned(),
            );
        };
        let [major, minor] = take(&mut rest)?;
        if (major, minor) != (1, 0) {
            return Err(format!(
                "it is a tensor file of version {major}.{minor} and not 1.0; save it as version 1.0"
            ));
        }
        let count = u32::from_le_bytes(take(&mut rest)?);
        if count > MOST_FIELDS {
            return Err(format!("it tells of {count} fields; {DAMAGED}"));
        }
        let fields = (0..count).map(|_| field(&mut rest)).collect::<Result<_, _>>()?;
        Ok(Self { bytes, fields })
    }

    /// Whether there is a field of that name.
    pub fn has(&self, name: &str) -> bool {
        self.fields.iter().any(|field| field.name == name)
    }

    /// The shape and the numbers of a field with that many dimensions.
    pub fn floats(&self, name: &str, dimensions: usize) -> Result<(Vec<usize>, Vec<f32>), String> {
        let (field, bytes) = self.field(name, F32, 4)?;
        if field.shape.len() != dimensions {
            return Err(format!(
                "its field `{name}` has {} dimensions and not {dimensions}; name a file of a BRDF",
                field.shape.len()
            ));
        }
        let numbers: Vec<f32> =
            bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
        if let Some(bad) = numbers.iter().position(|number| !number.is_finite()) {
            return Err(format!("its field `{name}` holds {} at {bad}; {DAMAGED}", numbers[bad]));
        }
        // What fits into the file fits into a usize.
        Ok((field.shape.iter().map(|n| *n as usize).collect(), numbers))
    }

    /// The first byte of a field.
    pub fn byte(&self, name: &str) -> Result<u8, String> {
        let (_, bytes) = self.field(name, U8, 1)?;
        Ok(bytes[0])
    }

    /// A field and its bytes, at least one element.
    fn field(&self, name: &str, ty: u8, size: u64) -> Result<(&Field, &'a [u8]), String> {
        let found = self.fields.iter().find(|field| field.name == name);
        let field = found.ok_or_else(|| {
            format!("it has no field `{name}`; name a file of a BRDF, not of something else")
        })?;
        if field.ty != ty {
            let wanted = if ty == F32 { "32-bit floats" } else { "bytes" };
            return Err(format!(
                "its field `{name}` has elements of type {} and not {ty}; save it in {wanted}",
                field.ty
            ));
        }
        let shape = field.shape.iter();
        let length = shape.copied().try_fold(size, u64::checked_mul);
        let range = length.and_then(|length| {
            let end = field.begin.checked_add(length)?;
            let range = usize::try_from(field.begin).ok()?..usize::try_from(end).ok()?;
            self.bytes.get(range)
        });
        match range {
            Some([]) => Err(format!("its field `{name}` is empty; {DAMAGED}")),
            Some(bytes) => Ok((field, bytes)),
            None => Err(format!("its field `{name}` lies past the file's end; {DAMAGED}")),
        }
    }
}

fn field(rest: &mut &[u8]) -> Result<Field, String> {
    let length = u16::from_le_bytes(take(rest)?);
    let (name, behind) = rest.split_at_checked(usize::from(length)).ok_or(ended())?;
    *rest = behind;
    let name = String::from_utf8_lossy(name).into_owned();
    let dimensions = u16::from_le_bytes(take(rest)?);
    if dimensions > MOST_DIMENSIONS {
        let name = shown(&name, 32);
        return Err(format!("its field `{name}` has {dimensions} dimensions; {DAMAGED}"));
    }
    let [ty] = take(rest)?;
    let begin = u64::from_le_bytes(take(rest)?);
    let shape =
        (0..dimensions).map(|_| take(rest).map(u64::from_le_bytes)).collect::<Result<_, _>>()?;
    Ok(Field { name, ty, begin, shape })
}

fn take<const N: usize>(rest: &mut &[u8]) -> Result<[u8; N], String> {
    let (bytes, behind) = rest.split_first_chunk::<N>().ok_or(ended())?;
    *rest = behind;
    Ok(*bytes)
}

fn ended() -> String {
    format!("its table of fields ends early; {DAMAGED}")
}
