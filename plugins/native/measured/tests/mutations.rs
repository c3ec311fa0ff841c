//! Thousands of damaged files, the same in every run: each parser gives a value or a sentence, and never panics.
//!
//! The small valid files that the damage begins from are the seeds of `fuzz/` too; `BRDF_BLESS=1` writes them there.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

use std::collections::BTreeSet;
use std::f32::consts::{FRAC_PI_2, PI};
use std::fs;
use std::io::Cursor;
use std::panic::catch_unwind;
use std::path::Path;

use brdf_measured::{csail, merl, rgl, slice};
use exr::prelude::{Blocks, Compression, Encoding, Image, Layer, LayerAttributes, LineOrder};
use exr::prelude::{SpecificChannels, Vec2, WritableImage};

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Below `end`, or 0 where that is 0.
    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }
}

/// Words that lengths, counts and numbers break at.
const WORDS: [u64; 18] = [
    0,
    1,
    2,
    90,
    360,
    0x7f,
    0x80,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7f80_0000,           // infinity of 32 bits
    0xffc0_0000,           // NaN of 32 bits
    0x7f7f_ffff,           // the largest float of 32 bits
    0x7ff0_0000_0000_0000, // infinity of 64 bits
    1 << 62,
    1 << 63,
    u64::MAX,
];

/// What breaks a table of numbers.
const PIECES: [&str; 14] = [
    " nan ",
    " -inf ",
    " 1e39 ",
    " -1 ",
    " 0 ",
    " 4097 ",
    "\n",
    "#",
    ",",
    ".",
    "\u{2028}",
    "\u{1b}[2J",
    "\0",
    " ü ",
];

fn damaged(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = random.one(seeds).clone();
    for _ in 0..=random.below(3) {
        // Half of the damage is done where headers are.
        let near = if random.below(2) == 0 { 64 } else { usize::MAX };
        let at = random.below(bytes.len().min(near));
        match random.below(8) {
            0 | 1 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            2 | 3 => {
                let word = random.one(&WORDS).to_le_bytes();
                let room = (1 << random.below(4)).min(bytes.len() - at);
                bytes[at..at + room].copy_from_slice(&word[..room]);
            }
            4 => bytes.truncate(at),
            5 => {
                let other = random.one(seeds);
                let from = random.below(other.len());
                bytes.truncate(at);
                bytes.extend(&other[from..]);
            }
            6 => {
                let piece = bytes[at..(at + random.below(32)).min(bytes.len())].to_vec();
                let to = random.below(bytes.len());
                bytes.splice(to..to, piece);
            }
            _ => {
                let piece = random.one(&PIECES).bytes();
                bytes.splice(at..at, piece);
            }
        }
    }
    bytes
}

/// Reads `count` damaged files. An error is one line of reason and cure, and what is read is sound.
fn survive<T>(
    name: &str,
    seeds: &[Vec<u8>],
    count: u64,
    parse: fn(&[u8]) -> Result<T, String>,
    sound: fn(&T) -> bool,
) {
    for seed in seeds {
        assert!(parse(seed).is_ok_and(|value| sound(&value)), "a seed of {name}");
    }
    let (mut read, mut refusals) = (0, BTreeSet::new());
    for number in 0..count {
        let bytes = damaged(&mut Random(number), seeds);
        let result = catch_unwind(|| parse(&bytes));
        match result.unwrap_or_else(|_| panic!("{name} {number} panics")) {
            Ok(value) => {
                assert!(sound(&value), "{name} {number} is read as something unsound");
                read += 1;
            }
            Err(error) => {
                let line = error.len() < 400 && !error.contains(char::is_control);
                assert!(line && error.contains("; "), "{name} {number}: {error:?}");
                refusals.insert(error.replace(|c: char| !c.is_ascii_alphabetic(), ""));
            }
        }
    }
    // Damage that is only ever read, or only ever refused for one reason, tests little.
    assert!(read * 100 > count && refusals.len() >= 6, "{name}: {read} read, {refusals:#?}");
}

fn floats(count: usize, value: impl Fn(usize) -> f32) -> Vec<u8> {
    (0..count).flat_map(|i| value(i).to_le_bytes()).collect()
}

fn materials_of_mit() -> Vec<Vec<u8>> {
    let with = |half: i32, bins: [i32; 4]| {
        let mut header = [0; 16];
        header[..4].copy_from_slice(&bins);
        (header[9], header[10]) = (half, 3);
        let count: i32 = bins.iter().product();
        let mut bytes: Vec<u8> = header.iter().flat_map(|word| word.to_le_bytes()).collect();
        bytes.extend(floats(3 * count as usize, |i| if i == 5 { -1.0 } else { 0.01 * i as f32 }));
        bytes
    };
    vec![with(0, [1, 2, 3, 4]), with(1, [2, 2, 2, 1]), with(0, [1; 4])]
}

/// A tensor file; fields with their types, shapes and bytes.
fn tensors(fields: &[(&str, u8, &[u64], Vec<u8>)]) -> Vec<u8> {
    let table: usize =
        fields.iter().map(|(name, _, shape, _)| 13 + name.len() + 8 * shape.len()).sum();
    let mut begin = 18 + table;
    let mut bytes = b"tensor_file\0\x01\0".to_vec();
    bytes.extend((fields.len() as u32).to_le_bytes());
    for (name, ty, shape, data) in fields {
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend(name.bytes());
        bytes.extend((shape.len() as u16).to_le_bytes());
        bytes.push(*ty);
        bytes.extend((begin as u64).to_le_bytes());
        bytes.extend(shape.iter().flat_map(|n| n.to_le_bytes()));
        begin += data.len();
    }
    bytes.extend(fields.iter().flat_map(|(_, _, _, data)| data));
    bytes
}

fn materials_of_rgl() -> Vec<Vec<u8>> {
    let even = |count: usize| floats(count, |i| 0.1 + 0.01 * i as f32);
    let theta = floats(2, |i| i as f32 * FRAC_PI_2);
    let isotropic = tensors(&[
        ("description", 1, &[4], b"made".to_vec()),
        ("theta_i", 10, &[2], theta.clone()),
        ("phi_i", 10, &[1], floats(1, |_| 0.0)),
        ("ndf", 10, &[2, 2], even(4)),
        ("sigma", 10, &[2, 2], even(4)),
        ("vndf", 10, &[1, 2, 2, 3], even(12)),
        ("luminance", 10, &[1, 2, 2, 2], even(8)),
        ("rgb", 10, &[1, 2, 3, 2, 2], even(24)),
        ("jacobian", 1, &[1], vec![1]),
    ]);
    let anisotropic = tensors(&[
        ("theta_i", 10, &[2], theta),
        ("phi_i", 10, &[3], floats(3, |i| PI * (0.5 * i as f32 - 1.0))),
        ("ndf", 10, &[2, 2], even(4)),
        ("sigma", 10, &[2, 2], even(4)),
        ("vndf", 10, &[3, 2, 2, 2], even(24)),
        ("luminance", 10, &[3, 2, 2, 2], even(24)),
        ("wavelengths", 10, &[3], floats(3, |i| 450.0 + 75.0 * i as f32)),
        ("spectra", 10, &[3, 2, 3, 2, 2], even(72)),
    ]);
    vec![isotropic, anisotropic]
}

fn tables() -> Vec<Vec<u8>> {
    let grey = "# A table of numbers.\n3 2\n0.5 0.25, 1e-3\n1 2 -3 # below 0\n";
    vec![grey.into(), "1,2\n0.1 0.2 0.3\n.4 5. +6\n".into()]
}

fn pictures() -> Vec<Vec<u8>> {
    let tiles = Blocks::Tiles(Vec2(2, 2));
    let codings = [
        (Compression::Uncompressed, Blocks::ScanLines),
        (Compression::RLE, tiles),
        (Compression::ZIP16, Blocks::ScanLines),
        (Compression::ZIP1, tiles),
        (Compression::PIZ, Blocks::ScanLines),
        (Compression::PXR24, Blocks::ScanLines),
        (Compression::B44, Blocks::ScanLines),
    ];
    let picture = |(compression, blocks)| {
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let pixels =
            SpecificChannels::rgb(|at: Vec2<usize>| (at.0 as f32, 0.5f32, (at.1 / 2) as f32));
        let layer = Layer::new((5, 4), LayerAttributes::named("slice"), encoding, pixels);
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    };
    codings.map(picture).into()
}

fn sound_slice(slice: &slice::Slice) -> bool {
    let kept = slice.pixels.iter().flatten().all(|c| c.is_finite() && *c >= 0.0);
    kept && !slice.pixels.is_empty() && slice.pixels.len().is_multiple_of(slice.columns)
}

#[test]
fn csail_survives() {
    survive("csail", &materials_of_mit(), 200_000, csail::parse, |table| {
        table.values.len() == table.bins.iter().product() && table.missing < table.values.len()
    });
}

#[test]
fn rgl_survives() {
    survive("rgl", &materials_of_rgl(), 200_000, rgl::parse, |material| {
        material.theta.len() >= 2 && !material.phi.is_empty()
    });
}

#[test]
fn tables_survive() {
    survive("table", &tables(), 100_000, slice::parse, sound_slice);
}

#[test]
fn pictures_survive() {
    survive("picture", &pictures(), 100_000, slice::parse, sound_slice);
}

/// A file of MERL has one length: most damage is to it or to the header, and is refused before the data is read.
#[test]
fn merl_survives() {
    let header: Vec<u8> = [90i32, 90, 180].iter().flat_map(|size| size.to_le_bytes()).collect();
    let count = 90 * 90 * 180;
    let mut file = header.clone();
    file.extend((0..3 * count).flat_map(|i| (f64::from(i % 7) - 1.0).to_le_bytes()));
    for number in 0..2000 {
        let bytes = damaged(&mut Random(number), std::slice::from_ref(&header));
        let error = merl::parse(&bytes).unwrap_err();
        assert!(error.contains("; ") && !error.contains(char::is_control), "{number}: {error:?}");
    }
    let mut random = Random(1);
    for number in 0..12 {
        let at = random.below(file.len() - 8);
        let kept: [u8; 8] = file[at..at + 8].try_into().unwrap();
        file[at..at + 8].copy_from_slice(&random.one(&WORDS).to_le_bytes());
        match merl::parse(&file) {
            Ok(table) => assert!(table.values.len() == count as usize && table.invalid > 0),
            Err(error) => assert!(error.contains("; "), "{number}: {error}"),
        }
        file[at..at + 8].copy_from_slice(&kept);
        let end = random.below(file.len());
        assert!(merl::parse(&file[..end]).unwrap_err().contains("; "));
    }
}

/// What is committed for the fuzzers is what this file makes.
#[test]
fn the_fuzzers_begin_from_the_same_files() {
    let header = [90i32, 90, 180].iter().flat_map(|size| size.to_le_bytes());
    let merl = header.chain(0.5f64.to_le_bytes()).chain((-1.0f64).to_le_bytes()).collect();
    let seeds = [
        ("merl", vec![merl]),
        ("csail", materials_of_mit()),
        ("rgl", materials_of_rgl()),
        ("slice", [tables(), pictures()].concat()),
    ];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fuzz/seeds");
    for (name, files) in seeds {
        for (number, bytes) in files.iter().enumerate() {
            let path = folder.join(name).join(number.to_string());
            if std::env::var_os("BRDF_BLESS").is_some() {
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(&path, bytes).unwrap();
            }
            let same = fs::read(&path).is_ok_and(|kept| kept == *bytes);
            assert!(same, "{} differs; run the test with BRDF_BLESS=1", path.display());
        }
    }
}
