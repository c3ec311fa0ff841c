//! The formats, byte by byte: what is refused, and why; and where each number of a good file ends up, by formulas
//! that are written anew here.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Debug;
use std::io::Cursor;

use brdf_measured::{csail, merl, rgl, slice};
use brdf_sdk::native::Data;
use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes};
use exr::prelude::{SpecificChannels, WritableImage};

type Vec3 = [f64; 3];

/// An error is one line, `reason; cure`, and says what is expected.
#[track_caller]
fn refused<T: Debug>(result: Result<T, String>, expected: &str) {
    let error = result.map(drop).expect_err(expected);
    assert!(error.contains("; ") && !error.contains(char::is_control), "{error}");
    assert!(error.contains(expected), "{error}\nand not: {expected}");
}

/// The direction at an angle from the normal and an azimuth.
fn at(theta: f64, phi: f64) -> Vec3 {
    [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
}

/// The bin of an angle among `bins` even ones over `range`.
fn even(angle: f64, range: f64, bins: usize) -> usize {
    (angle / range * bins as f64).floor() as usize
}

// MERL.

const COUNT: usize = 90 * 90 * 180;

/// A file; the sizes, and numbers of the planes where they are not 0.
fn merl_file(sizes: [i32; 3], numbers: &[(usize, f64)]) -> Vec<u8> {
    let mut bytes: Vec<u8> = sizes.iter().flat_map(|size| size.to_le_bytes()).collect();
    bytes.resize(12 + 24 * 90 * 90 * sizes[2] as usize, 0);
    for (index, number) in numbers {
        bytes[12 + 8 * index..][..8].copy_from_slice(&number.to_le_bytes());
    }
    bytes
}

/// `wo` and `wi` of half and difference angles: a direction about the pole is tilted by theta_h, then turned.
fn tilted([theta_h, theta_d, phi_d]: Vec3, phi_h: f64) -> (Vec3, Vec3) {
    let turned = |[x, y, z]: Vec3| {
        let (x, z) = (x * theta_h.cos() + z * theta_h.sin(), z * theta_h.cos() - x * theta_h.sin());
        [x * phi_h.cos() - y * phi_h.sin(), x * phi_h.sin() + y * phi_h.cos(), z]
    };
    let wi = turned(at(theta_d, phi_d));
    let h = at(theta_h, phi_h);
    let twice = 2.0 * (wi[0] * h[0] + wi[1] * h[1] + wi[2] * h[2]);
    ([0, 1, 2].map(|i| twice * h[i] - wi[i]), wi)
}

#[test]
fn merl_refuses() {
    let good = merl_file([90, 90, 180], &[]);
    for end in 0..12 {
        let expected = format!("it ends after {end} bytes; it was cut off, so fetch it again");
        refused(merl::parse(&good[..end]), &expected);
    }
    for end in [12, 19, 12 + 8 * COUNT, good.len() - 1] {
        let expected = format!(
            "it has {end} bytes and its header asks for 34992012; it was cut off or is another format, so fetch it \
             again"
        );
        refused(merl::parse(&good[..end]), &expected);
    }
    refused(merl::parse(&[&good[..], &[0]].concat()), "it has 34992013 bytes and its header asks");
    let mut longer = good.clone();
    longer[8..12].copy_from_slice(&360i32.to_le_bytes());
    refused(merl::parse(&longer), "it has 34992012 bytes and its header asks for 69984012");
    // A value is green times 1.15 / 1500, and 5.49e11 is the most.
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, 7.2e14];
    for (bad, shown) in
        bad.into_iter().zip(["NaN", "inf", "-inf", "1000000000000000", "720000000000000;"])
    {
        let file = merl_file([90, 90, 180], &[(COUNT + 7, bad)]);
        refused(merl::parse(&file), &format!("bin 7 of the green plane holds {shown}"));
        refused(merl::parse(&file), "; the file is damaged, so fetch it again");
    }
    let all: Vec<_> = (0..COUNT).map(|bin| (bin, -1.0)).collect();
    refused(
        merl::parse(&merl_file([90, 90, 180], &all)),
        "not one of its bins was measured; name a file with data",
    );
}

/// One bin is bright: directions in it see it, and those one bin further along any axis do not.
#[test]
fn merl_bins_are_where_the_format_says() {
    for (p, turn) in [(180, PI), (360, TAU)] {
        for [h, d, q] in [[0, 0, 0], [13, 45, 20], [44, 1, p - 1], [89, 89, p / 2], [1, 60, p / 4]]
        {
            let index = q + p * (d + 90 * h);
            let planes = [0, 1, 2].map(|c| (c * 8100 * p + index, 1500.0 * (c + 1) as f64));
            let table = merl::parse(&merl_file([90, 90, p as i32], &planes)).unwrap();
            assert_eq!((table.whole_turn, table.invalid), (p == 360, 0));
            let bright = [1.0f32, 2.0 * 1.15, 3.0 * 1.66];
            let seen = |[h, d, q]: [f64; 3]| {
                let root: f64 = (h + 0.5) / 90.0;
                let angles =
                    [root * root * FRAC_PI_2, (d + 0.5) * PI / 180.0, (q + 0.5) / p as f64 * turn];
                let (wo, wi) = tilted(angles, 0.3);
                table.values[table.bin(wo, wi)]
            };
            let here = [h, d, q].map(|n| n as f64);
            let found = seen(here);
            assert!((0..3).all(|c| (found[c] - bright[c]).abs() < 1e-6), "{found:?}");
            for axis in 0..3 {
                for step in [-1.0, 1.0] {
                    let mut beside = here;
                    beside[axis] += step;
                    let inside = (0.0..[90.0, 90.0, p as f64][axis]).contains(&beside[axis]);
                    // Around the turn, the other end is beside.
                    if inside || axis == 2 {
                        assert_eq!(seen(beside), [0.0; 3], "{here:?} {axis} {step}");
                    }
                }
            }
        }
    }
}

/// Anywhere in a bin, and with the directions exchanged, which is half a turn of phi_d.
#[test]
fn merl_bins_are_cut_where_the_format_says() {
    let table =
        |p, whole_turn| merl::Table { bins: [90, 90, p], whole_turn, values: vec![], invalid: 0 };
    for i in 0..20_000 {
        let part = |prime: f64| (f64::from(i) * prime).fract();
        let [h, d, q] = [part(0.618_034), part(0.754_878), part(0.569_840)];
        // Where bins meet, rounding decides.
        let between = |steps: f64| (steps - steps.round()).abs() > 1e-6;
        if !(between(90.0 * h.sqrt()) && between(90.0 * d) && between(360.0 * q)) {
            continue;
        }
        let (theta_h, theta_d, phi_d) = (h * FRAC_PI_2, d * FRAC_PI_2, q * TAU);
        let (wo, wi) = tilted([theta_h, theta_d, phi_d], part(0.414_214) * TAU);
        let row = even(theta_d, FRAC_PI_2, 90)
            + 90 * ((theta_h * 2.0 / PI).sqrt() * 90.0).floor() as usize;
        let half = even(phi_d % PI, PI, 180) + 180 * row;
        let whole = even(phi_d, TAU, 360) + 360 * row;
        assert_eq!(table(180, false).bin(wo, wi), half, "{h} {d} {q}");
        assert_eq!(table(180, false).bin(wi, wo), half, "{h} {d} {q}");
        assert_eq!(table(360, true).bin(wo, wi), whole, "{h} {d} {q}");
    }
    for bin in (0..COUNT).step_by(997) {
        for (wo, wi) in merl::pairs(bin, 4) {
            assert!(wo[2] > 0.0 && wi[2] > 0.0);
            assert_eq!(table(180, false).bin(wo, wi), bin);
        }
    }
}

/// What is written is read as it was, and what was not measured is counted once, and holds nothing.
#[test]
fn merl_comes_back() {
    let value = |bin: usize| {
        [0.0, 1.0, 2.0].map(|c| f64::from((0.37 * bin as f32).sin().abs() * 40.0 + c as f32))
    };
    let values: Vec<_> = (0..COUNT).map(|bin| (bin % 10 != 3).then(|| value(bin))).collect();
    let bytes = merl::bytes(&values);
    let table = merl::parse(&bytes).unwrap();
    assert_eq!(table.invalid, COUNT / 10);
    for (read, written) in table.values.iter().zip(&values) {
        assert_eq!(*read, written.unwrap_or_default().map(|c| c as f32));
    }
    let again = table.values.iter().enumerate();
    let again = again.map(|(bin, value)| (bin % 10 != 3).then(|| value.map(f64::from)));
    assert!(merl::bytes(&again.collect::<Vec<_>>()) == bytes);
    // One colour below 0 is enough.
    let table = merl::parse(&merl_file([90, 90, 180], &[(5, 3.0), (COUNT + 5, -1e-9)])).unwrap();
    assert_eq!((table.invalid, table.values[5]), (1, [0.0; 3]));
}

// MIT CSAIL.

fn csail_header(bins: [i32; 4], half: i32, channels: i32) -> Vec<u8> {
    let [a, b, c, d] = bins;
    let words = [a, b, c, d, 0, 0, 0, 0, 0, half, channels, 0, 0, 0, 0, 0];
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// A file whose planes hold these colours.
fn csail_file(bins: [i32; 4], half: i32, colours: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = csail_header(bins, half, 3);
    for c in 0..3 {
        bytes.extend(colours.iter().flat_map(|colour| colour[c].to_le_bytes()));
    }
    bytes
}

/// Three numbers of nine bits and their exponent, as graphics devices define them (RGB9E5).
fn rgb9e5(bits: u32) -> [f32; 3] {
    [0, 9, 18].map(|shift| ((bits >> shift) & 511) as f32 * 2f32.powi((bits >> 27) as i32 - 15 - 9))
}

#[test]
fn csail_refuses() {
    let bins = [1, 2, 3, 4];
    let mut colours = vec![[0.5f32; 3]; 24];
    let good = csail_file(bins, 0, &colours);
    assert!(csail::parse(&good).is_ok());
    for end in 0..64 {
        let expected = format!("it ends after {end} bytes; it was cut off, so fetch it again");
        refused(csail::parse(&good[..end]), &expected);
    }
    for end in [64, 65, 64 + 96, good.len() - 1, good.len() + 4] {
        let mut cut = good.clone();
        cut.resize(end, 0);
        let expected = format!(
            "it has {end} bytes and its 1 x 2 x 3 x 4 bins need 352; it was cut off or is another format, so fetch \
             it again"
        );
        refused(csail::parse(&cut), &expected);
    }
    let named = "it is no file of MIT's anisotropic materials, so name another";
    for wrong in [0, -1, 4097, i32::MIN, i32::MAX] {
        for axis in 0..4 {
            let mut bins = bins;
            bins[axis] = wrong;
            let expected = format!("its header asks for {wrong} bins of an angle; {named}");
            refused(csail::parse(&csail_header(bins, 0, 3)), &expected);
        }
    }
    for channels in [0, 1, 4, -3] {
        let expected = format!("its header says {channels} channels and not 3; {named}");
        refused(csail::parse(&csail_header(bins, 0, channels)), &expected);
    }
    for (bad, shown) in [(f32::NAN, "NaN"), (f32::NEG_INFINITY, "-inf"), (32705.0, "32705")] {
        colours[7] = [-1.0, bad, 0.0];
        let expected = format!(
            "bin 7 holds {shown}, and 32704 is the most that is kept; the file is damaged, so fetch it again"
        );
        refused(csail::parse(&csail_file(bins, 0, &colours)), &expected);
    }
    refused(
        csail::parse(&csail_file(bins, 0, &[[1.0, -0.5, 1.0]; 24])),
        "not one of its bins was measured; name a file with data",
    );
}

/// One bin is bright: directions in it see it, and those one bin further along any axis do not.
#[test]
fn csail_bins_are_where_the_format_says() {
    let bins = [4usize, 3, 6, 5];
    for (half, turn) in [(0, TAU), (1, PI)] {
        for bright in 0..bins.iter().product() {
            let mut colours = vec![[0.0f32; 3]; bins.iter().product()];
            colours[bright] = [1.0, 2.0, 4.0];
            let table = csail::parse(&csail_file(bins.map(|n| n as i32), half, &colours)).unwrap();
            assert_eq!((table.half, table.missing, table.loss), (half == 1, 0, 0.0));
            // The light's angle, the viewer's, the difference and the light's azimuth, at a third of the bin.
            let seen = |[i, o, d, p]: [usize; 4]| {
                let middle =
                    |bin: usize, bins: usize, range: f64| (bin as f64 + 0.3) / bins as f64 * range;
                let phi_in = middle(p, bins[3], TAU);
                let wi = at(middle(i, bins[0], FRAC_PI_2), phi_in);
                let wo = at(middle(o, bins[1], FRAC_PI_2), phi_in + middle(d, bins[2], turn));
                rgb9e5(table.values[table.bin(wo, wi)])
            };
            let here = [bright / 90, bright / 30 % 3, bright / 5 % 6, bright % 5];
            assert_eq!(here[3] + 5 * (here[2] + 6 * (here[1] + 3 * here[0])), bright);
            assert_eq!(seen(here), [1.0, 2.0, 4.0], "{here:?}");
            for axis in 0..4 {
                let mut beside = here;
                beside[axis] = (here[axis] + 1) % bins[axis];
                assert_eq!(seen(beside), [0.0; 3], "{here:?} {axis}");
            }
        }
    }
}

/// With half of the differences, an azimuth of the viewer that lies behind the light's is read with both exchanged.
#[test]
fn csail_halves_exchange_the_directions() {
    let table =
        csail::Table { bins: [9, 9, 18, 36], half: true, values: vec![], missing: 0, loss: 0.0 };
    for i in 0..2000 {
        let part = |prime: f64| (f64::from(i) * prime).fract();
        let [a, b] = [part(0.618_034), part(0.754_878)];
        let (phi, difference) = (part(0.569_840) * TAU, part(0.414_214) * PI);
        let (first, ahead) = (at(a * FRAC_PI_2, phi), at(b * FRAC_PI_2, phi + difference));
        let bin = even(phi, TAU, 36)
            + 36 * (even(difference, PI, 18) + 18 * ((b * 9.0) as usize + 9 * (a * 9.0) as usize));
        assert_eq!(table.bin(ahead, first), bin);
        assert_eq!(table.bin(first, ahead), bin);
    }
}

/// The loss that a table states is the largest there is; below 2^-16 there is another bound.
#[test]
fn csail_states_its_loss() {
    let spread = |i: usize| 10f64.powf((i as f64 * 0.618_034).fract() * 12.0 - 8.0) as f32;
    let colours: Vec<_> =
        (0..600).map(|i| [spread(3 * i), spread(3 * i + 1), spread(3 * i + 2)]).collect();
    // A single value that nine bits do not hold, above and below what the exponents reach.
    for colours in [colours, vec![[7.3e-4, 0.0, 0.0]; 600], vec![[0.2, 0.3, 1e-6]; 600]] {
        let mut colours = colours;
        colours[11] = [3.0, -0.1, 2.0];
        let table = csail::parse(&csail_file([10, 10, 6, 1], 0, &colours)).unwrap();
        assert_eq!((table.missing, table.values[11]), (1, 0));
        colours[11] = [0.0; 3];
        let mut loss = 0.0f32;
        for (bits, colour) in table.values.iter().zip(&colours) {
            let kept = rgb9e5(*bits);
            let off = (0..3).map(|c| (kept[c] - colour[c]).abs()).fold(0.0, f32::max);
            let largest = colour.iter().copied().fold(0.0, f32::max);
            match largest >= 1.0 / 65536.0 {
                true => loss = loss.max(off / largest),
                false => assert!(off <= 1.0 / 33_554_432.0, "{colour:?} {kept:?}"),
            }
        }
        assert!(
            (table.loss - loss).abs() < 1e-7 && loss > 0.0 && loss <= 1.0 / 512.0,
            "{loss} {}",
            table.loss
        );
    }
}

// RGL.

#[derive(Clone)]
struct Field {
    name: String,
    ty: u8,
    begin: Option<u64>,
    shape: Vec<u64>,
    data: Vec<u8>,
}

fn floats(name: &str, shape: &[u64], numbers: &[f32]) -> Field {
    let data = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    Field { name: name.to_owned(), ty: 10, begin: None, shape: shape.to_vec(), data }
}

/// A tensor file: the table of fields, then their bytes, or wherever a field says that it begins.
fn tensors(fields: &[Field]) -> Vec<u8> {
    let table: usize =
        fields.iter().map(|field| 13 + field.name.len() + 8 * field.shape.len()).sum();
    let mut begin = 18 + table as u64;
    let mut bytes = b"tensor_file\0\x01\0".to_vec();
    bytes.extend((fields.len() as u32).to_le_bytes());
    for field in fields {
        bytes.extend((field.name.len() as u16).to_le_bytes());
        bytes.extend(field.name.bytes());
        bytes.extend((field.shape.len() as u16).to_le_bytes());
        bytes.push(field.ty);
        bytes.extend(field.begin.unwrap_or(begin).to_le_bytes());
        bytes.extend(field.shape.iter().flat_map(|n| n.to_le_bytes()));
        begin += field.data.len() as u64;
    }
    bytes.extend(fields.iter().flat_map(|field| &field.data));
    bytes
}

/// The fields of a material of one colour, under these azimuths of the viewer.
fn material(phi: &[f32], colour: Field) -> Vec<Field> {
    let n = phi.len() as u64;
    let even = |name, shape: &[u64]| {
        floats(name, shape, &vec![0.5; shape.iter().product::<u64>() as usize])
    };
    let jacobian = Field { ty: 1, data: vec![1], ..floats("jacobian", &[1], &[]) };
    vec![
        jacobian,
        floats("theta_i", &[2], &[0.0, 1.5]),
        floats("phi_i", &[n], phi),
        even("ndf", &[2, 3]),
        even("sigma", &[2, 2]),
        even("vndf", &[n, 2, 2, 3]),
        even("luminance", &[n, 2, 2, 2]),
        colour,
    ]
}

fn white_rgb(n: u64) -> Field {
    floats("rgb", &[n, 2, 3, 2, 2], &vec![1.0; 24 * n as usize])
}

/// What `edit` makes of a field of a good isotropic material.
fn edited(name: &str, edit: impl Fn(&mut Field)) -> Result<rgl::Material, String> {
    let mut fields = material(&[0.0], white_rgb(1));
    edit(fields.iter_mut().find(|field| field.name == name).unwrap());
    rgl::parse(&tensors(&fields))
}

/// Of a field, the shape and the number that fills it.
fn shaped(name: &str, shape: &[u64], number: f32) -> Result<rgl::Material, String> {
    let filled = vec![number; shape.iter().product::<u64>() as usize];
    edited(name, |field| *field = floats(name, shape, &filled))
}

const DAMAGED: &str = "the file is damaged or was cut off, so fetch it again";

#[test]
fn rgl_refuses_containers() {
    let fields = material(&[0.0], white_rgb(1));
    let good = tensors(&fields);
    let data = good.len() - fields.iter().map(|field| field.data.len()).sum::<usize>();
    for end in 0..good.len() {
        let expected = match end {
            0..12 => {
                "it does not begin with `tensor_file`; name a file of the RGL material database"
            }
            _ if end < data => "its table of fields ends early; ",
            _ => " lies past the file's end; ",
        };
        refused(rgl::parse(&good[..end]), expected);
    }
    let patched = |at: usize, with: &[u8]| {
        let mut bytes = good.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        rgl::parse(&bytes)
    };
    refused(patched(0, b"T"), "it does not begin with `tensor_file`; name a file of the RGL");
    let version = "it is a tensor file of version 2.0 and not 1.0; save it as version 1.0";
    refused(patched(12, &[2, 0]), version);
    for count in [257u32, 1 << 31, u32::MAX] {
        let expected = format!("it tells of {count} fields; {DAMAGED}");
        refused(patched(14, &count.to_le_bytes()), &expected);
    }
    // The name of the first field reaches past the end.
    refused(patched(18, &[255; 2]), &format!("its table of fields ends early; {DAMAGED}"));
    let odd = |field: &mut Field| {
        field.shape = vec![1; 9];
        field.name = format!("{}\n\u{1b}[2J", "x".repeat(60));
    };
    let shown = format!("its field `{}...` has 9 dimensions; {DAMAGED}", "x".repeat(32));
    refused(edited("sigma", odd), &shown);
}

#[test]
fn rgl_refuses_fields() {
    let fields = material(&[0.0], white_rgb(1));
    assert!(rgl::parse(&tensors(&fields)).is_ok());
    for missing in ["theta_i", "phi_i", "ndf", "sigma", "vndf", "luminance", "rgb"] {
        let rest: Vec<_> = fields.iter().filter(|field| field.name != missing).cloned().collect();
        // Without colours, spectra are looked for.
        let named = if missing == "rgb" { "spectra" } else { missing };
        let expected =
            format!("it has no field `{named}`; name a file of a BRDF, not of something else");
        refused(rgl::parse(&tensors(&rest)), &expected);
    }
    let past = format!("its field `sigma` lies past the file's end; {DAMAGED}");
    for begin in [1 << 40, u64::MAX - 3, u64::MAX] {
        refused(edited("sigma", |field| field.begin = Some(begin)), &past);
    }
    for shape in [[1 << 31, 1], [1 << 31, 1 << 31], [1 << 62, 8], [u64::MAX, 2]] {
        refused(edited("sigma", |field| field.shape = shape.to_vec()), &past);
    }
    refused(shaped("ndf", &[0, 3], 0.0), &format!("its field `ndf` is empty; {DAMAGED}"));
    for ty in [0, 9, 11, 77] {
        let expected = format!("has elements of type {ty} and not 10; save it in 32-bit floats");
        refused(edited("vndf", |field| field.ty = ty), &expected);
    }
    let expected = "its field `jacobian` has elements of type 10 and not 1; save it in bytes";
    refused(shaped("jacobian", &[1], 1.0), expected);
    let expected = "its field `ndf` has 1 dimensions and not 2; name a file of a BRDF";
    refused(shaped("ndf", &[6], 1.0), expected);
    for (bad, shown) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (f32::NEG_INFINITY, "-inf")] {
        for name in ["theta_i", "phi_i", "ndf", "sigma", "vndf", "luminance", "rgb"] {
            let result = edited(name, |field| field.data[..4].copy_from_slice(&bad.to_le_bytes()));
            refused(result, &format!("its field `{name}` holds {shown} at 0; {DAMAGED}"));
        }
    }
    let expected =
        "its field `vndf` is for 2 x 1 directions, and it has 1 x 2; fetch the file again";
    refused(shaped("vndf", &[2, 1, 2, 3], 1.0), expected);
    for (name, shape, most) in
        [("vndf", [1, 6], 128), ("vndf", [2, 129], 128), ("luminance", [65, 2], 64)]
    {
        let [y, x] = shape;
        let expected = format!(
            "its field `{name}` has [{y}, {x}] nodes, and 2 to {most} an axis are read; store"
        );
        refused(shaped(name, &[1, 2, y, x], 1.0), &expected);
    }
    refused(
        shaped("sigma", &[1025, 2], 1.0),
        "has [1025, 2] nodes, and 2 to 1024 an axis are read",
    );
    let expected = "its colours have [2, 2] nodes and its field `luminance` [3, 2], and they are of the same points; fetch";
    refused(shaped("luminance", &[1, 2, 3, 2], 0.5), expected);
    let expected = "its field `rgb` has 4 channels; store it with 3";
    refused(shaped("rgb", &[1, 2, 4, 2, 2], 1.0), expected);
    for sigma in [0.0, -1.0] {
        let expected =
            "its field `sigma` is not above 0 everywhere; the file is damaged, so fetch it";
        refused(shaped("sigma", &[2, 2], sigma), expected);
    }
}

#[test]
fn rgl_refuses_angles() {
    let theta = |angles: &[f32]| {
        edited("theta_i", |field| *field = floats("theta_i", &[angles.len() as u64], angles))
    };
    let expected = "angles of its field `theta_i` do not ascend or are more than 24; the file is damaged, so fetch";
    refused(theta(&[0.5, 0.5]), expected);
    refused(theta(&[1.0, 0.5]), expected);
    refused(theta(&(0..33).map(|i| 0.01 * i as f32).collect::<Vec<_>>()), expected);
    refused(theta(&[0.0, 45.0]), "its angles of the viewer go from 0 to 45, and radians");
    refused(theta(&[-0.1, 0.5]), "its angles of the viewer go from -0.1 to 0.5, and radians");
    refused(theta(&[0.5]), "its field `theta_i` has one angle, and views need two; fetch the file");

    let around = |phi: &[f64]| {
        let phi: Vec<f32> = phi.iter().map(|phi| *phi as f32).collect();
        rgl::parse(&tensors(&material(&phi, white_rgb(phi.len() as u64))))
    };
    for part in [1.0, 2.0, 4.0] {
        let material = around(&[-PI, -PI + 0.5 * TAU / part, -PI + TAU / part]).unwrap();
        assert_eq!((material.theta.len(), material.phi.len()), (2, 3));
    }
    for phi in [
        [-PI, -2.0, -PI + TAU / 3.0],
        [-PI, -2.9, -PI + TAU / 8.0],
        [-PI, 0.0, 8.0],
        [0.0, 1.0, PI],
        [-1e30, 0.0, 1e30],
    ] {
        refused(
            around(&phi),
            ", which is no turn, half or quarter from -pi on; fetch the file again",
        );
    }
    refused(around(&[0.0, 1.0, 0.5]), "the 3 angles of its field `phi_i` do not ascend");
    // One azimuth or two: the same isotropic material.
    assert_eq!(around(&[0.0]).unwrap().phi, [0.0]);
    assert_eq!(around(&[0.0, PI]), around(&[0.0]));
}

/// What is left of a row behind a node is told from what came before by its sign, also where products below 1.2e-38
/// are 0, as they are on cards: of what is left at the last node, which is nothing, a quarter is still below 0.
#[test]
fn rgl_rests_keep_their_sign() {
    let loaded = rgl::load(None).unwrap();
    let cells = loaded.arrays.iter().find(|array| array.name == "normal_cells").unwrap();
    let Data::F32(cells) = &cells.data else { panic!("integrals are floats") };
    assert!(cells.iter().any(|cell| *cell < 0.0));
    assert!(cells.iter().all(|cell| *cell >= 0.0 || *cell * 0.25 < -f32::MIN_POSITIVE));
}

/// A spectrum of ones is the colour of ones, on any wavelengths; what cannot be seen is refused.
#[test]
fn rgl_spectra() {
    let spectra = |wavelengths: &[f32], value: f32| {
        let n = wavelengths.len() as u64;
        let field = floats("spectra", &[1, 2, n, 2, 2], &vec![value; 8 * n as usize]);
        let mut fields = material(&[0.0], field);
        fields.push(floats("wavelengths", &[n], wavelengths));
        fields
    };
    let parsed = |wavelengths: &[f32], value| rgl::parse(&tensors(&spectra(wavelengths, value)));
    let white = rgl::parse(&tensors(&material(&[0.0], white_rgb(1))));
    let fine: Vec<f32> = (0..81).map(|i| 360.0 + 5.0 * i as f32).collect();
    for wavelengths in [&fine[..], &[400.0, 450.0, 520.0, 640.0, 1000.0], &[450.0, 550.0, 610.0]] {
        assert_eq!(parsed(wavelengths, 1.0), white);
    }
    // White at one node of one view alone: bands, then nodes along y and x, are planes of a view as colours are.
    for lit in 0..8usize {
        let planes = |name: &str, n: usize| {
            let lit = |i: usize| f32::from(i / (4 * n) == lit / 4 && i % 4 == lit % 4);
            floats(name, &[1, 2, n as u64, 2, 2], &(0..8 * n).map(lit).collect::<Vec<_>>())
        };
        let mut fields = spectra(&[400.0, 450.0, 520.0, 640.0, 700.0], 0.0);
        fields[7] = planes("spectra", 5);
        let as_colours = rgl::parse(&tensors(&material(&[0.0], planes("rgb", 3))));
        assert_eq!(rgl::parse(&tensors(&fields)), as_colours);
    }
    assert!(parsed(&fine, -1.0).is_ok_and(|material| Ok(material) != white));
    let wrong = "lie beyond what is seen; fetch the file again";
    refused(parsed(&[450.0, 610.0, 550.0], 1.0), wrong);
    refused(parsed(&[2000.0, 3000.0], 1.0), wrong);
    let mut fewer = spectra(&[450.0, 550.0, 610.0], 1.0);
    *fewer.last_mut().unwrap() = floats("wavelengths", &[2], &[450.0, 550.0]);
    let expected =
        "its 2 wavelengths do not ascend, are not the 3 of its spectra, or lie beyond what is seen";
    refused(rgl::parse(&tensors(&fewer)), expected);
    // Finite in the file, but not as a colour.
    let mut bright = spectra(&[450.0, 550.0, 610.0], 0.0);
    let high = [0.0, f32::MAX, f32::MAX].map(|value| [value; 4]).concat().repeat(2);
    bright[7] = floats("spectra", &[1, 2, 3, 2, 2], &high);
    let expected = "its field `spectra` holds numbers that are too large for colours; the file is damaged, so fetch";
    refused(rgl::parse(&tensors(&bright)), expected);
}

// Image slices.

const FORM: &str = "write columns and rows, then each row's pixels as one number or three";

#[test]
fn slice_refuses_tables() {
    let cases = [
        ("", "it has no number of columns; "),
        ("# 3 2\n", "it has no number of columns; "),
        ("3", "it has no number of rows; "),
        ("0 2\n", "line 1: `0` is no number of columns up to 4096; "),
        ("# slice\n\n3\n-2", "line 4: `-2` is no number of rows up to 4096; "),
        ("4097 1", "line 1: `4097` is no number of columns up to 4096; "),
        ("2147483648 2147483648", "line 1: `2147483648` is no number of columns up to 4096; "),
        ("99999999999999999999 1", "line 1: `99999999999999999999` is no number of columns up to"),
        ("2.0 1 1 1", "line 1: `2.0` is no number of columns up to 4096; "),
        ("2 1\n1 # one\ntwo", "line 3: `two` is no number; "),
        ("2 1\n0x1 2", "line 2: `0x1` is no number; "),
        ("1 1 \u{1b}[2J", "line 1: `\\u{1b}[2J` is no number; "),
        ("2 2\n1 2 3", "it has 3 numbers behind its size, and 2 x 2 pixels need 4 or 12; "),
        ("2 2", "it has 0 numbers behind its size, and 2 x 2 pixels need 4 or 12; "),
        ("1 2 1 2 3 4 5 6 7", "it has 7 numbers behind its size, and 1 x 2 pixels need 2 or 6; "),
        (
            "4096 4096 1",
            "it has 1 numbers behind its size, and 4096 x 4096 pixels need 16777216 or",
        ),
    ];
    for (text, expected) in cases {
        refused(slice::parse(text.as_bytes()), expected);
        refused(slice::parse(text.as_bytes()), FORM);
    }
    let long = format!("1 1 {}", "9e".repeat(1000));
    let shown = format!("line 1: `{}...` is no number; {FORM}", "9e".repeat(16));
    refused(slice::parse(long.as_bytes()), &shown);
    let neither = "it is neither an OpenEXR image nor text; name a file of either kind";
    refused(slice::parse(b"1 1 \xff"), neither);
    refused(slice::parse(b"\x89PNG\r\n\x1a\n"), neither);
    for (bad, shown) in [("nan", "NaN"), ("-inf", "-inf"), ("1e39", "inf")] {
        let expected = format!("its pixel (1, 2) holds {shown}; give every pixel a finite number");
        refused(slice::parse(format!("2 3 0 0 0 0 0 {bad}").as_bytes()), &expected);
    }
}

/// The top row is listed first, and theta_d grows upwards.
#[test]
fn slice_tables_stand_upright() {
    let grey = slice::parse(b"3 2\n1, 2, 3 # the top\n4 -5 6e-1").unwrap();
    assert_eq!((grey.columns, grey.negative), (3, 1));
    assert_eq!(grey.pixels, [4.0, 0.0, 0.6, 1.0, 2.0, 3.0].map(|c| [c; 3]));
    let colours = slice::parse(b"1 2  1 2 3  -4 5 -6").unwrap();
    assert_eq!((colours.columns, colours.negative), (1, 1));
    assert_eq!(colours.pixels, [[0.0, 5.0, 0.0], [1.0, 2.0, 3.0]]);
}

fn picture(columns: usize, rows: usize, colour: impl Sync + Fn(usize, usize) -> f32) -> Vec<u8> {
    let pixels = SpecificChannels::rgb(|at: exr::prelude::Vec2<usize>| {
        (colour(at.0, at.1), 2.0f32, 0.25f32)
    });
    let mut bytes = Cursor::new(Vec::new());
    let image = Image::from_channels((columns, rows), pixels);
    image.write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn any_picture<'a>(
    size: (usize, usize),
    channels: impl IntoIterator<Item = (&'a str, FlatSamples)>,
) -> Vec<u8> {
    let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples));
    let channels = AnyChannels::sort(channels.collect());
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// One pixel is bright, and it alone.
#[test]
fn slice_pictures_stand_upright() {
    for (x, y) in [(0, 0), (4, 0), (1, 2), (4, 2), (0, 2)] {
        let bytes = picture(5, 3, |column, row| if (column, row) == (x, y) { 7.0 } else { -1.0 });
        let slice = slice::parse(&bytes).unwrap();
        assert_eq!((slice.columns, slice.pixels.len(), slice.negative), (5, 15, 14));
        for (index, pixel) in slice.pixels.iter().enumerate() {
            let bright = index == x + 5 * (2 - y);
            assert_eq!(*pixel, [if bright { 7.0 } else { 0.0 }, 2.0, 0.25]);
        }
    }
}

#[test]
fn slice_refuses_pictures() {
    let unreadable = "it cannot be read as an OpenEXR image with R, G and B (";
    let good = picture(5, 3, |_, _| 1.0);
    for end in 4..good.len() {
        refused(slice::parse(&good[..end]), unreadable);
        refused(slice::parse(&good[..end]), "); save it again");
    }
    let bad = picture(2, 2, |x, y| if (x, y) == (1, 0) { f32::INFINITY } else { 0.0 });
    refused(slice::parse(&bad), "its pixel (1, 0) holds inf; give every pixel a finite number");
    let grey = any_picture((2, 2), [("Y", FlatSamples::F32(vec![1.0; 4]))]);
    refused(slice::parse(&grey), unreadable);
    refused(
        slice::parse(&picture(4097, 1, |_, _| 1.0)),
        "it has 4097 x 1 pixels, and 4096 a side are the most",
    );
}

/// Nothing but zeros: the smallest files that pictures can have.
#[test]
fn slice_pictures_may_be_small() {
    use exr::prelude::{Blocks, Compression, LineOrder, Vec2};
    for compression in [Compression::RLE, Compression::ZIP16, Compression::PIZ, Compression::PXR24]
    {
        let blocks = Blocks::Tiles(Vec2(1024, 1024));
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let black = SpecificChannels::rgb(|_: Vec2<usize>| (0.0f32, 0.0f32, 0.0f32));
        let layer = Layer::new((1024, 1024), LayerAttributes::default(), encoding, black);
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
        assert_eq!(slice::parse(bytes.get_ref()).unwrap().pixels.len(), 1 << 20, "{compression}");
    }
}

/// A line that comes twice leaves another without a value.
#[test]
fn slice_pictures_are_whole() {
    let pixels = SpecificChannels::rgb(|_: exr::prelude::Vec2<usize>| (1.0f32, 1.0f32, 1.0f32));
    let attributes = LayerAttributes::default();
    let layer = Layer::new((5, 3), attributes, Encoding::UNCOMPRESSED, pixels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
    let mut bytes = bytes.into_inner();
    assert!(slice::parse(&bytes).is_ok());
    // The last line: y, a length, and five pixels of three channels.
    let last = bytes.len() - (8 + 5 * 3 * 4);
    assert_eq!(bytes[last..last + 8], [2, 0, 0, 0, 60, 0, 0, 0]);
    bytes[last] = 1;
    refused(slice::parse(&bytes), "its pixel (0, 2) holds NaN; give every pixel a finite number");
}

/// A picture of these channels that has 64 x 16 pixels and claims to have others.
fn claimed(channels: &[String], columns: u32, rows: u32) -> Vec<u8> {
    let empty = || FlatSamples::F32(vec![0.0; 64 * 16]);
    let mut bytes = any_picture((64, 16), channels.iter().map(|name| (name.as_str(), empty())));
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    let at = bytes.windows(name.len()).position(|window| window == name).unwrap() + name.len();
    let window = [0, 0, columns - 1, rows - 1].map(u32::to_le_bytes).concat();
    bytes[at..at + 16].copy_from_slice(&window);
    bytes
}

/// Headers that ask for more than there is are refused before memory is taken: the test calls itself where a
/// process may have 400 MB.
#[cfg(target_os = "linux")]
#[test]
fn headers_that_ask_for_much_take_nothing() {
    const LIMITED: &str = "BRDF_TEST_UNDER_A_LIMIT";
    if std::env::var_os(LIMITED).is_none() {
        let limit = "ulimit -v 400000 && exec \"$0\" --exact \"$1\" --test-threads 1 --nocapture";
        let name = "headers_that_ask_for_much_take_nothing";
        let program = std::env::current_exe().unwrap();
        let mut child = std::process::Command::new("sh");
        child.arg("-c").arg(limit).arg(program).arg(name).env(LIMITED, "1");
        let output = child.output().unwrap();
        let said =
            [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        assert!(output.status.success() && said[0].contains("1 passed"), "{}", said.concat());
        return;
    }
    for sizes in [[i32::MAX; 3], [-90, -90, 180], [i32::MIN; 3], [90, 90, 181], [0; 3]] {
        let bytes: Vec<u8> = sizes.iter().flat_map(|size| size.to_le_bytes()).collect();
        let [h, d, p] = sizes;
        let expected = format!(
            "its bins are {h} x {d} x {p} and not 90 x 90 x 180; it is no MERL file, so name another"
        );
        refused(merl::parse(&bytes), &expected);
    }
    let expected = "its 4096 x 4096 x 4096 x 4096 bins are more than the 67108864 that fit; store it with fewer";
    refused(csail::parse(&csail_header([4096; 4], 0, 3)), expected);
    let expected = "it has 64 bytes and its 4096 x 4096 x 4 x 1 bins need 805306432; ";
    refused(csail::parse(&csail_header([4096, 4096, 4, 1], 0, 3)), expected);
    for shape in [vec![1 << 31], vec![1 << 30; 8], vec![u64::MAX]] {
        let result = edited("theta_i", |field| field.shape = shape.clone());
        refused(result, "its field `theta_i` lies past the file's end; ");
    }
    let rgb = ["R", "G", "B"].map(str::to_owned);
    for (columns, rows) in [(1 << 29, 1 << 29), (1 << 28, 16), (64, 1 << 28)] {
        let expected = format!(
            "it has {columns} x {rows} pixels, and 4096 a side are the most; make it smaller"
        );
        refused(slice::parse(&claimed(&rgb, columns, rows)), &expected);
    }
    let expected = " bytes cannot hold its 4096 x 4096 pixels; it was cut off, so fetch it again";
    refused(slice::parse(&claimed(&rgb, 4096, 4096)), expected);
    // Sixteen lines are a block.
    let more: Vec<_> = rgb.into_iter().chain((0..1100).map(|i| i.to_string())).collect();
    let expected = format!(
        "a block of its pixels takes {} bytes, and 268435456 are the most; save it with R, G and B alone",
        4096 * 16 * 4 * 1103
    );
    refused(slice::parse(&claimed(&more, 4096, 16)), &expected);
}
