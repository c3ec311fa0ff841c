//! Arrays as programs bind them: words in a few buffers, texels in textures, and where each array begins.
//!
//! Arrays of one part lie one after the other in one buffer; an array that may take several has buffers of its
//! own. A device binds at least 128 MiB, so no buffer is larger. What is read four numbers at once is a texture:
//! on a software driver such a read costs what one word of a buffer costs.

use std::sync::Arc;

use brdf_sdk::manifest::{Array, Element};
use brdf_sdk::native::{Data, Loaded};
use brdf_sdk::{Problem, Result};
use half::f16;

/// Words in one buffer at the most: 128 MiB, which every device binds.
pub const PART_WORDS: usize = 1 << 25;

/// Texels in a row of a texture, and rows at the most, which every device has.
pub const TEXTURE_WIDTH: usize = 4096;
const MOST_ROWS: usize = 8192;

/// A library's arrays.
#[derive(Debug)]
pub struct Packed {
    /// Where each array of the manifest lies, in its order.
    pub places: Vec<Place>,
    /// The words of each of [`buffer_names`].
    pub buffers: Vec<Arc<[u32]>>,
    /// The texels of each array of vec4f or vec4u, in whole rows; of vec4u the floats are its words' bits.
    pub textures: Vec<Arc<Vec<[f32; 4]>>>,
    /// What the user should know.
    pub notes: Vec<String>,
}

/// Where an array lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    /// Its first word in its first buffer.
    pub first: u32,
    /// The index of its last element.
    pub last: u32,
    /// Its dimensions, the slowest first; what it has not is 1.
    pub shape: [u32; 4],
}

impl Place {
    fn new(count: usize, shape: &[u32]) -> Self {
        let mut place = Self { first: 0, last: count as u32 - 1, shape: [1; 4] };
        place.shape[..shape.len()].copy_from_slice(shape);
        place
    }
}

impl Packed {
    /// These arrays and behind them others, as of a manifest that declares both; `declared` are the first ones.
    ///
    /// # Errors
    /// Where the buffer that they share would be too large.
    pub fn followed_by(&self, id: &str, declared: &[Array], mut more: Packed) -> Result<Packed> {
        let mut buffers = self.buffers.clone();
        let shared = more.buffers.first().cloned().unwrap_or_else(|| Arc::from([]));
        if declared.iter().any(is_small) {
            let before = Arc::clone(&buffers[0]);
            if before.len() + shared.len() > PART_WORDS {
                return Err(Problem::new(
                    id,
                    "its arrays leave no room for the tables of a fitted sampler",
                    "leave --fit-sampler out",
                ));
            }
            for place in &mut more.places {
                place.first += before.len() as u32;
            }
            buffers[0] = before.iter().chain(shared.iter()).copied().collect();
        } else {
            buffers.insert(0, shared);
        }
        Ok(Packed {
            places: [self.places.as_slice(), &more.places].concat(),
            buffers,
            textures: [self.textures.as_slice(), &more.textures].concat(),
            notes: [self.notes.as_slice(), &more.notes].concat(),
        })
    }

    /// What it takes [bytes].
    pub fn bytes(&self) -> usize {
        let texels = self.textures.iter().map(|texels| texels.len() * 16);
        self.buffers.iter().map(|words| words.len() * 4).chain(texels).sum()
    }
}

/// The buffers of a manifest's arrays: the one that they share, then those of large ones.
pub fn buffer_names(arrays: &[Array]) -> Vec<String> {
    let shared = arrays.iter().any(is_small).then(|| "brdf_data".to_owned());
    let own = arrays.iter().filter(|array| array.parts > 1);
    let own = own
        .flat_map(|array| (0..array.parts).map(|part| format!("brdf_data_{}_{part}", array.name)));
    shared.into_iter().chain(own).collect()
}

/// Whether it lies in the buffer that all such share.
fn is_small(array: &Array) -> bool {
    array.parts == 1 && array.element.of_list().is_none()
}

/// The texture of an array of vec4f or vec4u.
pub fn texture_name(array: &Array) -> String {
    format!("brdf_texels_{}", array.name)
}

/// Holds what a library gave against the manifest, and packs it.
pub fn pack(id: &str, declared: &[Array], loaded: Loaded) -> Result<Packed> {
    let problem = |reason: String, cure: &str| Problem::new(id, reason, cure);
    let mut notes = loaded.notes;
    let mut given = loaded.arrays;
    let (mut places, mut shared, mut own) = (Vec::new(), Vec::new(), Vec::new());
    let mut textures = Vec::new();
    for array in declared {
        let name = &array.name;
        let Some(position) = given.iter().position(|given| given.name == *name) else {
            return Err(problem(
                format!("the library gives no array `{name}`"),
                "let `load` return it, or remove it from [arrays]",
            ));
        };
        let found = given.swap_remove(position);
        let count = found.data.len();
        if count == 0 {
            return Err(problem(
                format!("the array `{name}` has 0 elements"),
                "give it at least one",
            ));
        }
        let product = found.shape.iter().try_fold(1u64, |product, n| product.checked_mul(*n));
        if product != Some(count as u64) || count > u32::MAX as usize {
            return Err(problem(
                format!("the array `{name}` has {count} elements and the shape {:?}", found.shape),
                "give it as many elements as its shape has, up to 2^32 - 1",
            ));
        }
        let mut shape: Vec<u32> = found.shape.iter().map(|n| *n as u32).collect();
        let of_list = array.element.of_list();
        let own_dimensions = shape.len() - usize::from(of_list.is_some() && !shape.is_empty());
        if own_dimensions > 4 {
            return Err(problem(
                format!("the array `{name}` has {own_dimensions} dimensions"),
                "give it up to four, and one more of 4 for vec4f and vec4u",
            ));
        }
        let words = match (found.data, array.element) {
            (Data::F32(data), Element::Vec4F) => {
                textures.push(texels(id, array, &data, shape.pop())?);
                places.push(Place::new(count / 4, &shape));
                continue;
            }
            (Data::U32(data), Element::Vec4U) => {
                let data: Vec<f32> = data.into_iter().map(f32::from_bits).collect();
                textures.push(texels(id, array, &data, shape.pop())?);
                places.push(Place::new(count / 4, &shape));
                continue;
            }
            (Data::F32(data), Element::F32) => bits(data),
            (Data::U32(data), Element::U32) => data,
            (Data::F32(data), Element::F16) => halves(id, name, &data, &mut notes)?,
            (_, element) => {
                let single = if element == Element::U32 { "u32" } else { "floats" };
                let word = element.of_list().unwrap_or(single);
                return Err(problem(
                    format!(
                        "the array `{name}` is declared as {word}, and the library gives another type"
                    ),
                    "let both agree",
                ));
            }
        };
        let mut place = Place::new(count, &shape);
        let most = array.parts as usize * PART_WORDS;
        if words.len() > most || (array.parts == 1 && shared.len() + words.len() > PART_WORDS) {
            let taken = words.len() + if array.parts == 1 { shared.len() } else { 0 };
            return Err(problem(
                format!(
                    "with the array `{name}` {:.1} MiB are taken, and its buffers hold {}",
                    taken as f64 / f64::from(1 << 18),
                    most >> 18
                ),
                "give it more `parts` in [arrays], store it as f16, or make it smaller",
            ));
        }
        if array.parts == 1 {
            place.first = shared.len() as u32;
            shared.extend(words);
        } else {
            let mut parts = words.chunks(PART_WORDS).map(Arc::from);
            // WGSL has no empty arrays.
            own.extend((0..array.parts).map(|_| parts.next().unwrap_or_else(|| Arc::from([0]))));
        }
        places.push(place);
    }
    if let Some(unknown) = given.first() {
        return Err(problem(
            format!(
                "the library gives an array `{}` that the manifest does not declare",
                unknown.name
            ),
            "declare it in [arrays]",
        ));
    }
    let shared = (!shared.is_empty()).then(|| Arc::from(shared));
    let buffers = shared.into_iter().chain(own).collect();
    Ok(Packed { places, buffers, textures, notes })
}

/// An array of vec4f or vec4u, of which `last` is the last dimension, in whole rows.
fn texels(id: &str, array: &Array, data: &[f32], last: Option<u32>) -> Result<Arc<Vec<[f32; 4]>>> {
    let (name, listed) = (&array.name, array.element.of_list().unwrap_or_default());
    let single = array.element.of_one();
    if last != Some(4) {
        return Err(Problem::new(
            id,
            format!("the array `{name}` is declared as {listed}, and its last dimension is not 4"),
            format!("give it one of 4, or declare it as {single}"),
        ));
    }
    let mut texels = data.as_chunks::<4>().0.to_vec();
    let rows = texels.len().div_ceil(TEXTURE_WIDTH);
    if rows > MOST_ROWS {
        return Err(Problem::new(
            id,
            format!(
                "the array `{name}` has {} texels, and a texture holds {}",
                texels.len(),
                MOST_ROWS * TEXTURE_WIDTH
            ),
            format!("declare it as {single} with `parts`, or make it smaller"),
        ));
    }
    texels.resize(rows * TEXTURE_WIDTH, [0.0; 4]);
    Ok(Arc::new(texels))
}

fn bits(data: Vec<f32>) -> Vec<u32> {
    data.into_iter().map(f32::to_bits).collect()
}

/// Two halves a word, the even one low, and how much was lost.
fn halves(id: &str, name: &str, data: &[f32], notes: &mut Vec<String>) -> Result<Vec<u32>> {
    let mut lost = 0.0f32;
    for value in data {
        let rounded = f16::from_f32(*value).to_f32();
        if rounded.is_infinite() && value.is_finite() {
            return Err(Problem::new(
                id,
                format!("the array `{name}` holds {value}, and 16 bits reach 65504"),
                "scale it down in `load` and up in WGSL, or declare it as f32",
            ));
        }
        // Below the least normal number the error is absolute.
        if value.abs() >= f16::MIN_POSITIVE.to_f32() {
            lost = lost.max((rounded / value - 1.0).abs());
        }
    }
    if lost > 0.0 {
        notes.push(format!(
            "`{name}` is held in 16 bits: values are off by up to {lost:.1e} of themselves"
        ));
    }
    let word = |pair: &[f32]| {
        let bits = |value: f32| u32::from(f16::from_f32(value).to_bits());
        bits(pair[0]) | bits(pair.get(1).copied().unwrap_or(0.0)) << 16
    };
    Ok(data.chunks(2).map(word).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(element: Element, given: brdf_sdk::native::Array) -> Result<Packed> {
        let declared = Array { name: "list".to_owned(), element, parts: 1, about: None };
        pack("p", &[declared], Loaded::new([given]))
    }

    /// Lists keep their numbers, words bit by bit, in whole rows; what does not fit its declaration is told.
    #[test]
    fn lists_lie_in_rows_of_texels() {
        let words = vec![0, 1, 0x7f80_0001, u32::MAX, 5, 6, 7, 8];
        let found =
            packed(Element::Vec4U, brdf_sdk::native::Array::u32("list", [2, 4], words.clone()));
        let found = found.unwrap();
        let texels = &found.textures[0];
        assert_eq!(texels.len(), TEXTURE_WIDTH);
        assert_eq!(
            texels[..2].as_flattened().iter().map(|f| f.to_bits()).collect::<Vec<_>>(),
            words
        );
        assert_eq!((found.places[0].last, found.places[0].shape), (1, [2, 1, 1, 1]));

        for (element, given, expected) in [
            (
                Element::Vec4U,
                brdf_sdk::native::Array::u32("list", [4, 2], words),
                "the array `list` is declared as vec4u, and its last dimension is not 4; give it one of 4, or declare it as u32",
            ),
            (
                Element::Vec4U,
                brdf_sdk::native::Array::f32("list", [1, 4], vec![0.0; 4]),
                "the array `list` is declared as vec4u, and the library gives another type",
            ),
            (
                Element::Vec4F,
                brdf_sdk::native::Array::u32("list", [1, 4], vec![0; 4]),
                "the array `list` is declared as vec4f, and the library gives another type",
            ),
        ] {
            let said = packed(element, given).unwrap_err().to_string();
            assert!(said.contains(expected), "{said}");
        }
    }
}
