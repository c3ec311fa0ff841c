//! Radiance files written by hand, byte by byte.

use super::*;

/// A file with this header (lines after the signature) and these scanline bytes.
fn file(header: &str, resolution: &str, scanlines: &[u8]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{header}\n{resolution}\n").into_bytes();
    bytes.extend_from_slice(scanlines);
    bytes
}

const RGBE: &str = "# a comment\nFORMAT=32-bit_rle_rgbe\n";

fn rgb(picture: &Picture) -> Vec<[f32; 3]> {
    picture.texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect()
}

fn problem(bytes: &[u8]) -> String {
    decode("m.hdr", bytes).unwrap_err().to_string()
}

#[test]
fn flat_texels_have_known_values() {
    // 128 x 2^(129 - 136) = 1; 1 x 2^(136 - 136) = 1; 255 x 2^(1 - 136), an f32 subnormal; 0 is black.
    let bytes = file(RGBE, "-Y 1 +X 2", &[128, 64, 32, 129, 1, 2, 255, 136]);
    let picture = decode("m.hdr", &bytes).unwrap();
    assert_eq!((picture.width, picture.height), (2, 1));
    assert_eq!(rgb(&picture), [[1.0, 0.5, 0.25], [1.0, 2.0, 255.0]]);
    assert!(picture.notes.is_empty());
    let extremes = file(RGBE, "-Y 1 +X 2", &[255, 9, 9, 1, 200, 100, 50, 0]);
    let picture = decode("m.hdr", &extremes).unwrap();
    assert_eq!(picture.texels[0][0], 255.0 * 2.0_f32.powi(-126) * 2.0_f32.powi(-9));
    assert_eq!(rgb(&picture)[1], [0.0; 3]);
}

#[test]
fn exposure_and_colour_correction_are_divided_out() {
    let header = format!("{RGBE}EXPOSURE=2\nEXPOSURE= 4.0\nCOLORCORR= 1 2 0.5\n\tEXPOSURE=9\n");
    let bytes = file(&header, "-Y 1 +X 2", &[128, 128, 128, 132, 0, 0, 0, 0]);
    let picture = decode("m.hdr", &bytes).unwrap();
    // The file holds 8; 8 / (2 x 4) = 1, then over 1, 2 and 0.5.
    assert_eq!(rgb(&picture)[0], [1.0, 0.5, 2.0]);
    assert_eq!(
        picture.notes,
        ["divided by the file's EXPOSURE 8", "divided by the file's COLORCORR 1 2 0.5"]
    );
}

#[test]
fn xyz_is_converted() {
    // Stored X = 0.5, Y = 1, Z = 0.25. IEC 61966-2-1: R = 3.2406 X - 1.5372 Y - 0.4986 Z.
    let header = "FORMAT=32-bit_rle_xyze\n";
    let bytes = file(header, "-Y 1 +X 2", &[64, 128, 32, 129, 0, 0, 0, 0]);
    let picture = decode("m.hdr", &bytes).unwrap();
    let expected = [
        3.2406 * 0.5 - 1.5372 - 0.4986 * 0.25,
        -0.9689 * 0.5 + 1.8758 + 0.0415 * 0.25,
        0.0557 * 0.5 - 0.2040 + 1.0570 * 0.25,
    ];
    for (got, expected) in rgb(&picture)[0].iter().zip(expected) {
        assert!((f64::from(*got) - expected).abs() < 5e-4, "{got} {expected}");
    }
    assert_eq!(picture.notes, ["converted from CIE XYZ to linear Rec. 709"]);
}

#[test]
fn other_primaries_are_converted() {
    let header = "PRIMARIES= .708 .292 .170 .797 .131 .046 .3127 .3290\n";
    let bytes = file(header, "-Y 1 +X 2", &[128, 0, 0, 129, 128, 128, 128, 129]);
    let picture = decode("m.hdr", &bytes).unwrap();
    // The first column of the inverse of ITU-R BT.2087's M2; white stays white.
    for (got, expected) in rgb(&picture)[0].iter().zip([1.6605, -0.1246, -0.0182]) {
        assert!((got - expected).abs() < 1e-4, "{got} {expected}");
    }
    for got in rgb(&picture)[1] {
        assert!((got - 1.0).abs() < 1e-6, "{got}");
    }
    assert!(picture.notes[0].starts_with("converted from PRIMARIES 0.708 0.292"));
    // Zeros, as real maps have them, say nothing.
    let silent = file("PRIMARIES=0 0 0 0 0 0 0 0\n", "-Y 1 +X 2", &[128, 64, 0, 129, 0, 0, 0, 0]);
    let picture = decode("m.hdr", &silent).unwrap();
    assert_eq!((rgb(&picture)[0], picture.notes.len()), ([1.0, 0.5, 0.0], 0));
}

#[test]
fn the_four_row_orientations() {
    // Four rows would be as good; two rows of four keep the file 2:1.
    let texels: Vec<u8> = (1..=8).flat_map(|i| [i, 2, 3, 136]).collect();
    let firsts = |resolution: &str| -> Vec<f32> {
        let picture = decode("m.hdr", &file(RGBE, resolution, &texels)).unwrap();
        picture.texels.iter().map(|texel| texel[0]).collect()
    };
    assert_eq!(firsts("-Y 2 +X 4"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    assert_eq!(firsts("+Y 2 +X 4"), [5.0, 6.0, 7.0, 8.0, 1.0, 2.0, 3.0, 4.0]);
    assert_eq!(firsts("-Y 2 -X 4"), [4.0, 3.0, 2.0, 1.0, 8.0, 7.0, 6.0, 5.0]);
    assert_eq!(firsts("+Y 2 -X 4"), [8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]);
    assert_eq!(
        problem(&file(RGBE, "+X 4 -Y 2", &texels)),
        "m.hdr: the resolution line `+X 4 -Y 2` is not of the form `-Y height +X width`; \
         turn the picture upright and write it again"
    );
}

#[test]
fn the_three_codings_agree() {
    let (a, b) = ([10, 20, 30, 130], [40, 50, 60, 131]);
    let flat: Vec<u8> = [[a; 4], [b; 4]].concat().concat().repeat(4);
    let flat = decode("m.hdr", &file(RGBE, "-Y 4 +X 8", &flat)).unwrap();
    // Old: one texel, then (1, 1, 1, n).
    let old = [a, [1, 1, 1, 3], b, [1, 1, 1, 3]].concat().repeat(4);
    let old = decode("m.hdr", &file(RGBE, "-Y 4 +X 8", &old)).unwrap();
    assert_eq!(old.texels, flat.texels);
    // New: red as two runs, green as a literal, blue and exponent as run and literal.
    let mut row = vec![2, 2, 0, 8, 132, 10, 132, 40, 8];
    row.extend([20, 20, 20, 20, 50, 50, 50, 50, 132, 30, 4, 60, 60, 60, 60]);
    row.extend([4, 130, 130, 130, 130, 132, 131]);
    let new = decode("m.hdr", &file(RGBE, "-Y 4 +X 8", &row.repeat(4))).unwrap();
    assert_eq!(new.texels, flat.texels);
    // Two successive repeats are one number: 2 + 1 x 256.
    let long: Vec<u8> = [a, [1, 1, 1, 2], [1, 1, 1, 1]].concat();
    let mut texels = Vec::new();
    assert_eq!(scanline::append(&long, 259, &mut texels), Ok(&[][..]));
    assert_eq!(texels, [a; 259]);
}

#[test]
fn damage_is_told_in_one_line() {
    let row = [[10, 20, 30, 130_u8]; 8].concat();
    let ends = file(RGBE, "-Y 4 +X 8", &row.repeat(3)[..row.len() * 3 - 1]);
    assert_eq!(
        problem(&ends),
        "m.hdr: the file ends in scanline 3 of 4; it was cut short: fetch it again"
    );
    let damaged = "m.hdr: the coding is damaged in scanline 1 of 4; fetch the file again";
    assert_eq!(problem(&file(RGBE, "-Y 4 +X 8", &[2, 2, 0, 9, 0, 0, 0, 0])), damaged);
    let overrun = [[2, 2, 0, 8, 137, 1], [0; 6], [0; 6]].concat();
    assert_eq!(problem(&file(RGBE, "-Y 4 +X 8", &overrun)), damaged);
    assert_eq!(problem(&file(RGBE, "-Y 4 +X 8", &[1, 1, 1, 8])), damaged);
    // A tiny file that claims the largest picture fails at once, without its memory.
    assert_eq!(
        problem(&file(RGBE, "-Y 16384 +X 32768", &[2, 2, 127, 255])),
        "m.hdr: the file ends in scanline 1 of 16384; it was cut short: fetch it again"
    );
    assert_eq!(
        problem(b"#?RADIANCE\nFORMAT="),
        "m.hdr: the file ends in its header; fetch it again"
    );
    assert_eq!(problem(b"#?RGBE\n\n"), "m.hdr: the file ends in its header; fetch it again");
}

#[test]
fn unusable_headers_are_refused() {
    let with = |line: &str| problem(&file(line, "-Y 1 +X 2", &[0; 8]));
    assert_eq!(
        with("EXPOSURE=0\n"),
        "m.hdr: the header line `EXPOSURE=0` does not give 1 positive number; correct that line"
    );
    assert_eq!(
        with("COLORCORR=1 2\n"),
        "m.hdr: the header line `COLORCORR=1 2` does not give 3 numbers; correct that line"
    );
    assert_eq!(
        with("FORMAT=32-bit_rle_spec\n"),
        "m.hdr: its FORMAT is `32-bit_rle_spec`; convert it to 32-bit_rle_rgbe or 32-bit_rle_xyze"
    );
    assert_eq!(
        with("PRIMARIES=.3 .3 .3 .3 .3 .3 .3 .3\n"),
        "m.hdr: 0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3 are no usable primaries; \
         correct the PRIMARIES line, or remove it for Rec. 709"
    );
    assert_eq!(
        problem(&file(RGBE, "-Y 700 +X 1000", &[])),
        "m.hdr: the picture is 1000x700, which is no shape of a map; give a lat-long panorama (2:1), \
         a cross of six faces (4:3 or 3:4), a row or a column of them (6:1 or 1:6), or six square files \
         named with a % (probe_%.hdr)"
    );
    assert_eq!(
        problem(&file(RGBE, "-Y 4000000000 +X 8000000000", &[])),
        "m.hdr: the picture is 8000000000x4000000000, the largest map is 32768x16384; \
         give a smaller one"
    );
}
