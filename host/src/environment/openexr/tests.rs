//! OpenEXR files written with the exr crate; expected values stand in the tests.

use exr::compression::Compression;
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatImage, FlatSamples, Image, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{EnvironmentMap, IntegerBounds, LineOrder};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{WritableImage, f16};

use super::*;
use crate::environment::Arrangement;
use crate::environment::arrangement::settle;

type PartOf = Layer<AnyChannels<FlatSamples>>;

/// Sample `i` of channel `c` in a 4 x 2 picture; exact in f16.
fn value(c: usize, i: usize) -> f32 {
    (c * 8 + i) as f32 * 0.25
}

fn floats(c: usize) -> FlatSamples {
    FlatSamples::F32((0..8).map(|i| value(c, i)).collect())
}

fn halves(c: usize) -> FlatSamples {
    FlatSamples::F16((0..8).map(|i| f16::from_f32(value(c, i))).collect())
}

fn part(channels: &[(&str, FlatSamples)], encoding: Encoding) -> PartOf {
    let list = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone()));
    let channels = AnyChannels::sort(list.collect());
    Layer::new((4, 2), LayerAttributes::named("first"), encoding, channels)
}

fn rgb_part(make: impl Fn(usize) -> FlatSamples, encoding: Encoding) -> PartOf {
    part(&[("R", make(0)), ("G", make(1)), ("B", make(2))], encoding)
}

fn zip() -> Encoding {
    Encoding::SMALL_LOSSLESS
}

fn image(parts: Vec<PartOf>) -> FlatImage {
    let window = IntegerBounds::new((0, 0), (4, 2));
    Image { attributes: ImageAttributes::new(window), layer_data: parts.into() }
}

fn bytes(image: &FlatImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn problem(bytes: &[u8]) -> String {
    decode("m.exr", bytes).unwrap_err().to_string()
}

fn assert_is_the_pattern(picture: &Picture) {
    assert_eq!((picture.width, picture.height), (4, 2));
    for (i, texel) in picture.texels.iter().enumerate() {
        assert_eq!(*texel, [value(0, i), value(1, i), value(2, i), 0.0], "texel {i}");
    }
}

#[test]
fn floats_halves_and_integers_in_every_lossless_compression() {
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ];
    let tiles = Blocks::Tiles(Vec2(3, 1));
    for compression in compressions {
        for blocks in [Blocks::ScanLines, tiles] {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            for samples in [floats as fn(usize) -> FlatSamples, halves] {
                let file = bytes(&image(vec![rgb_part(samples, encoding)]));
                assert_is_the_pattern(&decode("m.exr", &file).unwrap());
            }
        }
    }
    let integers = |c: usize| FlatSamples::U32((0..8).map(|i| (c * 1000 + i) as u32).collect());
    let file = bytes(&image(vec![rgb_part(integers, zip())]));
    assert_eq!(decode("m.exr", &file).unwrap().texels[5], [5.0, 1005.0, 2005.0, 0.0]);
}

#[test]
fn lossy_compressions_come_close() {
    // B44 keeps 6 bits of each difference within a block, on the bit patterns of the halves. From 0 to
    // 8 those span some 17,000 steps: they are cut to multiples of 512, and come back up to 256 off,
    // a quarter of the octave that a value lies in.
    let lossy = [
        (Compression::PXR24, 0.1),
        (Compression::B44, 0.25),
        (Compression::B44A, 0.25),
        (Compression::DWAA(None), 0.1),
        (Compression::DWAB(None), 0.1),
    ];
    for (compression, tolerance) in lossy {
        let encoding = Encoding { compression, ..zip() };
        let file = bytes(&image(vec![rgb_part(halves, encoding)]));
        let picture = decode("m.exr", &file).unwrap();
        for (i, texel) in picture.texels.iter().enumerate() {
            for (c, got) in texel[..3].iter().enumerate() {
                let expected = value(c, i);
                assert!(
                    (got - expected).abs() <= tolerance * expected.max(1.0),
                    "{compression} {got} {expected}"
                );
            }
        }
    }
}

#[test]
fn the_display_window_is_the_picture() {
    // The data is 4 x 2 and starts one column right of and one row above the display window.
    let mut moved = image(vec![rgb_part(floats, zip())]);
    moved.attributes.display_window = IntegerBounds::new((10, 20), (4, 2));
    moved.layer_data[0].attributes.layer_position = Vec2(11, 19);
    let picture = decode("m.exr", &bytes(&moved)).unwrap();
    let reds: Vec<f32> = picture.texels.iter().map(|texel| texel[0]).collect();
    let [a, b, c] = [value(0, 4), value(0, 5), value(0, 6)];
    assert_eq!(reds, [0.0, a, b, c, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(picture.notes, ["data and display window differ: outside the data is black"]);
    // A smaller display window crops; one that the data does not touch is black.
    let mut cropped = image(vec![rgb_part(floats, zip())]);
    cropped.attributes.display_window = IntegerBounds::new((1, 1), (2, 1));
    let picture = decode("m.exr", &bytes(&cropped)).unwrap();
    assert_eq!(picture.texels.iter().map(|t| t[0]).collect::<Vec<_>>(), [value(0, 5), value(0, 6)]);
    cropped.attributes.display_window = IntegerBounds::new((-50, 7), (2, 1));
    assert_eq!(decode("m.exr", &bytes(&cropped)).unwrap().texels, [[0.0; 4]; 2]);
}

#[test]
fn the_first_channels_that_make_a_picture_are_taken() {
    // Alpha and depth lie between the colours in the file's alphabetical order.
    let with_more = [
        ("A", floats(9)),
        ("B", halves(2)),
        ("G", floats(1)),
        ("N.R", floats(7)),
        ("R", floats(0)),
        ("Z", floats(8)),
    ];
    assert_is_the_pattern(&decode("m.exr", &bytes(&image(vec![part(&with_more, zip())]))).unwrap());

    let layer = [
        ("beauty.R", floats(0)),
        ("beauty.G", floats(1)),
        ("beauty.B", floats(2)),
        ("a.R", floats(5)),
    ];
    let picture = decode("m.exr", &bytes(&image(vec![part(&layer, zip())]))).unwrap();
    assert_is_the_pattern(&picture);
    assert_eq!(picture.notes, ["read from the channels beauty.R, beauty.G, beauty.B"]);

    let grey = decode("m.exr", &bytes(&image(vec![part(&[("Y", halves(1))], zip())]))).unwrap();
    assert_eq!(grey.texels[3], [value(1, 3), value(1, 3), value(1, 3), 0.0]);

    let mut second = rgb_part(floats, zip());
    second.attributes = LayerAttributes::named("second");
    let parts = vec![part(&[("Z", floats(3))], zip()), second];
    assert_is_the_pattern(&decode("m.exr", &bytes(&image(parts))).unwrap());
}

#[test]
fn other_chromaticities_are_converted() {
    let mut wide =
        image(vec![rgb_part(|c| FlatSamples::F32(vec![if c == 1 { 1.0 } else { 0.0 }; 8]), zip())]);
    let chromaticities = |numbers: [f64; 8]| {
        let n = numbers.map(|number| number as f32);
        exr::meta::attribute::Chromaticities {
            red: Vec2(n[0], n[1]),
            green: Vec2(n[2], n[3]),
            blue: Vec2(n[4], n[5]),
            white: Vec2(n[6], n[7]),
        }
    };
    wide.attributes.chromaticities = Some(chromaticities(colour::tests::REC2020));
    let picture = decode("m.exr", &bytes(&wide)).unwrap();
    // The green column of the inverse of ITU-R BT.2087's M2.
    for (got, expected) in picture.texels[0].iter().zip([-0.5876, 1.1329, -0.1006]) {
        assert!((got - expected).abs() < 1e-4, "{got} {expected}");
    }
    assert_eq!(
        picture.notes,
        [
            "converted from chromaticities 0.7080 0.2920 0.1700 0.7970 0.1310 0.0460 0.3127 0.3290 to linear Rec. 709"
        ]
    );
    wide.attributes.chromaticities =
        Some(chromaticities([0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290]));
    assert_eq!(decode("m.exr", &bytes(&wide)).unwrap().texels[0], [0.0, 1.0, 0.0, 0.0]);
}

#[test]
fn the_envmap_attribute_speaks_of_the_data_window() {
    let mut map = image(vec![rgb_part(floats, zip())]);
    map.attributes.display_window = IntegerBounds::new((10, 20), (40, 20));
    for (attribute, expected) in [
        (EnvironmentMap::LatitudeLongitude, Arrangement::OpenExrLatLong),
        (EnvironmentMap::Cube, Arrangement::OpenExrCube),
    ] {
        map.layer_data[0].attributes.environment_map = Some(attribute);
        let picture = decode("m.exr", &bytes(&map)).unwrap();
        assert_is_the_pattern(&picture);
        assert_eq!((picture.declared, picture.notes.len()), (Some(expected), 0));
    }
}

#[test]
fn what_is_no_map_is_refused() {
    let other = image(vec![part(&[("U", floats(0)), ("V", floats(1))], zip())]);
    assert_eq!(
        problem(&bytes(&other)),
        "m.exr: it has no channels R, G and B, nor Y (it has U, V); write it with those channel names"
    );
    let chroma =
        image(vec![part(&[("Y", floats(0)), ("RY", floats(1)), ("BY", floats(2))], zip())]);
    assert_eq!(
        problem(&bytes(&chroma)),
        "m.exr: it holds luminance and chroma, or subsampled channels; \
         write it with channels R, G and B in full resolution"
    );
    let mut square = image(vec![rgb_part(floats, zip())]);
    square.attributes.display_window = IntegerBounds::new((0, 0), (3, 2));
    assert!(problem(&bytes(&square)).starts_with(
        "m.exr: the picture is 3x2, which is no shape of a map; give a lat-long panorama (2:1), "
    ));
    square.attributes.display_window = IntegerBounds::new((0, 0), (65536, 32768));
    assert_eq!(
        problem(&bytes(&square)),
        "m.exr: the picture is 65536x32768, the largest map is 32768x16384; give a smaller one"
    );
}

/// Overwrites the box attribute `name` of a file.
fn with_window(bytes: &[u8], name: &str, window: [i32; 4]) -> Vec<u8> {
    with_numbers(bytes, &format!("{name}\0box2i\0"), &window)
}

/// Overwrites the whole numbers of the attribute whose name and type are `key`.
fn with_numbers(bytes: &[u8], key: &str, numbers: &[i32]) -> Vec<u8> {
    let at = bytes.windows(key.len()).position(|part| part == key.as_bytes()).unwrap();
    let mut changed = bytes.to_vec();
    for (i, number) in numbers.iter().enumerate() {
        changed[at + key.len() + 4 + 4 * i..][..4].copy_from_slice(&number.to_le_bytes());
    }
    changed
}

#[test]
fn a_small_file_cannot_claim_a_large_picture() {
    let file = bytes(&image(vec![rgb_part(floats, zip())]));
    let window = [0, 0, 32767, 16383];
    let claimed = with_window(&with_window(&file, "dataWindow", window), "displayWindow", window);
    // The exr crate compares the number of blocks (16 rows each) itself; with that forged as well:
    let claimed = with_numbers(&claimed, "chunkCount\0int\0", &[1024]);
    let told = problem(&claimed);
    assert!(told.starts_with("m.exr: its header claims 32768x16384 texels"), "{told}");
    // Windows at the ends of the integers, and empty or inverted ones.
    for window in [[i32::MIN, i32::MIN, i32::MAX, i32::MAX], [5, 5, -5, -5], [0, 0, -1, -1]] {
        problem(&with_window(&file, "dataWindow", window));
        // An inverted window is taken for a square one: a small face, and no map.
        if let Ok(face) = decode("m.exr", &with_window(&file, "displayWindow", window)) {
            let size = (face.width, face.height);
            assert!(size.0 < 16, "{size:?}");
            assert!(settle("m.exr", size, face.declared, None).is_err(), "{window:?}");
        }
    }
}

#[test]
fn cut_or_damaged_files_are_told_in_one_line() {
    for compression in
        [Compression::ZIP16, Compression::PIZ, Compression::DWAA(None), Compression::B44]
    {
        let encoding = Encoding { compression, ..zip() };
        let file = bytes(&image(vec![rgb_part(halves, encoding)]));
        for length in 4..file.len() {
            let told = problem(&file[..length]);
            assert!(!told.contains('\n'), "{told}");
        }
        // Every single byte damaged: a picture or one line, never a panic.
        for at in 4..file.len() {
            let mut damaged = file.clone();
            damaged[at] ^= 0x55;
            if let Err(problem) = decode("m.exr", &damaged) {
                assert!(!problem.to_string().contains('\n'), "{problem}");
            }
        }
    }
    let file = bytes(&image(vec![rgb_part(floats, zip())]));
    assert_eq!(
        problem(&file[..file.len() - 1]),
        "m.exr: the file is cut short or damaged (reference to missing bytes); fetch it again"
    );
}

#[test]
fn deep_data_is_refused() {
    let file = bytes(&image(vec![rgb_part(floats, zip())]));
    // The type attribute of a deep part, in place of a flat one's.
    let from = b"scanlineimage";
    let at = file.windows(from.len()).position(|part| part == from);
    let Some(at) = at else { panic!("the exr crate writes the type attribute") };
    let mut deep = file.clone();
    deep[at - 4..at].copy_from_slice(&12_i32.to_le_bytes());
    deep.splice(at..at + from.len(), *b"deepscanline");
    deep[5] |= 0x08;
    let told = problem(&deep);
    assert!(told.starts_with("m.exr: it holds deep data; flatten it"), "{told}");
}
