//! Pictures of every kind that is read, and what is said of the others.

use exr::math::Vec2;
use exr::meta::attribute::{Chromaticities, IntegerBounds};
use exr::prelude::*;

use super::*;

/// Values that are exact as halves: negative ones and large ones too.
fn value(channel: usize, i: usize) -> f32 {
    (channel as f32 + 1.0) * (i as f32 - 2.0) * 1.5
}

fn floats(channel: usize) -> FlatSamples {
    FlatSamples::F32((0..6).map(|i| value(channel, i)).collect())
}

fn halves(channel: usize) -> FlatSamples {
    FlatSamples::F16((0..6).map(|i| f16::from_f32(value(channel, i))).collect())
}

type Part = Layer<AnyChannels<FlatSamples>>;

/// A part of 3x2 pixels.
fn part(name: &str, channels: &[(&str, FlatSamples)], compression: Compression) -> Part {
    let channels = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone()));
    let encoding = Encoding { compression, ..Encoding::SMALL_LOSSLESS };
    let attributes = LayerAttributes::named(name);
    Layer::new((3, 2), attributes, encoding, AnyChannels::sort(channels.collect()))
}

fn image(parts: Vec<Part>) -> Image<Layers<AnyChannels<FlatSamples>>> {
    let window = IntegerBounds::new((0, 0), (3, 2));
    Image { attributes: ImageAttributes::new(window), layer_data: parts.into() }
}

fn bytes(image: &Image<Layers<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn rgb(make: fn(usize) -> FlatSamples) -> [(&'static str, FlatSamples); 3] {
    [("R", make(0)), ("G", make(1)), ("B", make(2))]
}

fn exr_of(channels: &[(&str, FlatSamples)]) -> Vec<u8> {
    bytes(&image(vec![part("only", channels, Compression::ZIP16)]))
}

fn problem(bytes: &[u8]) -> String {
    let problem = decode("p", bytes).unwrap_err().to_string();
    assert!(!problem.contains('\n'), "{problem}");
    problem
}

#[test]
fn floats_and_halves_with_coverage_and_standard_errors() {
    let [r, g, b] = rgb(floats);
    let all = [
        r,
        g,
        b,
        ("A", floats(3)),
        ("Z", floats(9)),
        ("std_error.R", halves(4)),
        ("std_error.G", floats(5)),
        ("std_error.B", floats(6)),
    ];
    let full = decode("p", &exr_of(&all)).unwrap();
    assert_eq!((full.resolution, full.for_display), ([3, 2], false));
    let pixels = |first: usize| -> Vec<[f32; 3]> {
        (0..6).map(|i| [0, 1, 2].map(|c| value(first + c, i))).collect()
    };
    assert_eq!(full.rgb, pixels(0));
    assert_eq!(full.std_error, Some(pixels(4)));
    assert_eq!(full.coverage, Some((0..6).map(|i| value(3, i)).collect()));
    for compression in [Compression::Uncompressed, Compression::PIZ, Compression::RLE] {
        let plain =
            decode("p", &bytes(&image(vec![part("a", &rgb(halves), compression)]))).unwrap();
        assert_eq!((&plain.rgb, plain.coverage, plain.std_error), (&pixels(0), None, None));
    }
    // Of several parts the one with R, G and B.
    let parts = vec![
        part("depth", &[("Z", floats(7))], Compression::ZIP16),
        part("colour", &rgb(floats), Compression::ZIP16),
    ];
    assert_eq!(decode("p", &bytes(&image(parts))).unwrap().rgb, pixels(0));
}

#[test]
fn values_that_are_no_radiance_are_kept() {
    let odd = FlatSamples::F32(vec![f32::NAN, f32::INFINITY, -1.0, 1e30, 0.0, -0.0]);
    let picture = decode("p", &exr_of(&[("R", odd), ("G", floats(0)), ("B", floats(1))])).unwrap();
    let red: Vec<f32> = picture.rgb.iter().map(|pixel| pixel[0]).collect();
    assert!(red[0].is_nan());
    assert_eq!(red[1..4], [f32::INFINITY, -1.0, 1e30]);
}

#[test]
fn what_is_no_one_picture_is_refused() {
    let [r, g, b] = rgb(floats);
    assert_eq!(
        problem(&exr_of(&[("a.R", floats(0)), ("a.G", floats(1)), ("a.B", floats(2))])),
        "p: it has no channels R, G and B (it has a.B, a.G, a.R); write it with those channel names, in one part"
    );
    let two = vec![
        part("a", &rgb(floats), Compression::ZIP16),
        part("b", &rgb(floats), Compression::ZIP16),
    ];
    assert_eq!(
        problem(&bytes(&image(two))),
        "p: it holds 2 parts with R, G and B: which is the picture?; \
         write the one that is meant to a file of its own"
    );
    assert_eq!(
        problem(&exr_of(&[r, g, b, ("std_error.R", floats(3))])),
        "p: it has not all of the channels std_error.R, std_error.G, std_error.B; write all three, or none"
    );
    let mut moved = image(vec![part("a", &rgb(floats), Compression::ZIP16)]);
    moved.layer_data[0].attributes.layer_position = Vec2(1, 0);
    assert!(problem(&bytes(&moved)).starts_with("p: its data window is not its display window"));
    let mut wide = image(vec![part("a", &rgb(floats), Compression::ZIP16)]);
    let mut primaries = Chromaticities {
        red: Vec2(0.64, 0.33),
        green: Vec2(0.30, 0.60),
        blue: Vec2(0.15, 0.06),
        white: Vec2(0.3127, 0.3290),
    };
    wide.attributes.chromaticities = Some(primaries);
    assert!(decode("p", &bytes(&wide)).is_ok());
    primaries.green = Vec2(0.17, 0.797);
    wide.attributes.chromaticities = Some(primaries);
    assert!(problem(&bytes(&wide)).starts_with("p: its chromaticities are not those of Rec. 709"));
    assert!(
        problem(b"GIF89a").starts_with("p: this is no picture that can be read; give an OpenEXR")
    );
    assert!(problem(b"").starts_with("p: this is no picture"));
}

fn png(colour: image::ExtendedColorType, bytes: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut file);
    image::ImageEncoder::write_image(encoder, bytes, 2, 1, colour).unwrap();
    file
}

#[test]
fn a_png_is_the_light_that_it_asks_for() {
    let picture =
        decode("p", &png(image::ExtendedColorType::Rgb8, &[0, 255, 128, 10, 20, 30])).unwrap();
    assert!(picture.for_display && picture.coverage.is_none());
    assert_eq!(picture.resolution, [2, 1]);
    // ((128/255 + 0.055) / 1.055)^2.4 = 0.21586.
    let [r, g, b] = picture.rgb[0];
    assert!(r == 0.0 && (g - 1.0).abs() < 1e-6 && (b - 0.21586).abs() < 1e-5, "{:?}", picture.rgb);
    let grey = decode("p", &png(image::ExtendedColorType::L8, &[128, 255])).unwrap();
    assert!(grey.rgb[0].iter().all(|channel| (channel - 0.21586).abs() < 1e-5));
}

#[test]
fn a_radiance_picture_is_what_was_there_before_its_exposure() {
    let file = |header: &str| -> Vec<u8> {
        let mut file =
            format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{header}\n-Y 1 +X 2\n").into_bytes();
        // 2^(129 - 128) / 256 = 1/128 a step: 128 is 1; then 64 32 16 a quarter of that scale up.
        file.extend([128, 64, 32, 129, 64, 32, 16, 131]);
        file
    };
    let picture = decode("p", &file("")).unwrap();
    assert_eq!(picture.rgb, [[1.0, 0.5, 0.25], [2.0, 1.0, 0.5]]);
    assert!(!picture.for_display);
    let exposed = decode("p", &file("EXPOSURE=2.0\n")).unwrap();
    assert_eq!(exposed.rgb, [[0.5, 0.25, 0.125], [1.0, 0.5, 0.25]]);
    assert!(problem(&file("EXPOSURE=0\n")).starts_with("p: its EXPOSURE is 0"));
}

#[test]
fn a_small_file_cannot_claim_a_large_picture() {
    let header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n";
    assert!(problem(header.as_bytes()).contains("its header claims 100000x100000 pixels"));
    let mut wide = png(image::ExtendedColorType::Rgb8, &[0; 6]);
    // Width and height lie behind the signature and the first chunk's length and name; its checksum is
    // set anew.
    wide[16..24].copy_from_slice(&[0, 1, 0x86, 0xa0, 0, 1, 0x86, 0xa0]);
    let mut checksum = u32::MAX;
    for byte in &wide[12..29] {
        checksum ^= u32::from(*byte);
        for _ in 0..8 {
            checksum = if checksum & 1 == 1 { checksum >> 1 ^ 0xedb8_8320 } else { checksum >> 1 };
        }
    }
    wide[29..33].copy_from_slice(&(!checksum).to_be_bytes());
    assert!(
        problem(&wide).contains("its header claims 100000x100000 pixels"),
        "{}",
        problem(&wide)
    );
    let claim = |width: u64, height: u64| check_size("p", [width, height], 1, 1, usize::MAX);
    assert!(claim(0, 5).unwrap_err().reason.contains("the picture is 0x5"));
    assert!(claim(1 << 26, 2).is_err() && claim(u64::MAX, u64::MAX).is_err());
    assert_eq!(claim(1 << 26, 1), Ok([1 << 26, 1]));
}

/// Cut anywhere or with any byte damaged: a picture or one line, never a panic.
#[test]
fn cut_or_damaged_files_are_told_in_one_line() {
    let files = [
        exr_of(&rgb(floats)),
        bytes(&image(vec![part("a", &rgb(halves), Compression::PIZ)])),
        png(image::ExtendedColorType::Rgb8, &[9, 8, 7, 6, 5, 4]),
    ];
    for file in files {
        for length in 0..file.len() {
            // The end of a PNG may be missing.
            if let Err(problem) = decode("p", &file[..length]) {
                assert!(!problem.to_string().contains('\n'), "{problem}");
            }
        }
        problem(&file[..file.len() / 2]);
        for at in 0..file.len() {
            let mut damaged = file.clone();
            damaged[at] ^= 0x55;
            if let Err(problem) = decode("p", &damaged) {
                assert!(!problem.to_string().contains('\n'), "{problem}");
            }
        }
    }
}
