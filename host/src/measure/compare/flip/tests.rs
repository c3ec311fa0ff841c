//! FLIP against the authors' own program, on pictures that a formula makes.

use super::*;

const WIDTH: usize = 36;
const HEIGHT: usize = 24;

/// A formula from column, row and channel to an sRGB value.
type Formula = fn(usize, usize, usize) -> f32;

fn picture(formula: Formula) -> Vec<[f32; 3]> {
    // From sRGB to the light of the screen.
    let linear = |srgb: f32| {
        if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
    };
    let pixel = |i: usize| [0, 1, 2].map(|c| linear(formula(i % WIDTH, i / WIDTH, c)));
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

/// 1 on a disc of radius 7 around column `centre`.
fn disc(x: usize, y: usize, centre: usize) -> f32 {
    let inside = x.abs_diff(centre).pow(2) + y.abs_diff(12).pow(2) <= 49;
    f32::from(u8::from(inside))
}

/// Noise-like, a disc that moves and changes colour, and plain colours.
const CHECKS: [Formula; 2] = [
    |x, y, c| ((7 * x + 13 * y + 5 * c) % 17) as f32 / 16.0,
    |x, y, c| ((5 * x + 11 * y + 3 * c) % 19) as f32 / 18.0,
];
const SHIFT: [Formula; 2] = [
    |x, y, _| 0.125 + 0.625 * disc(x, y, 14),
    |x, y, c| 0.125 + (0.625 - 0.125 * c as f32) * disc(x, y, 16),
];
const FLAT: [Formula; 2] = [|_, _, c| [0.5, 0.25, 0.75][c], |_, _, c| [0.5, 0.375, 0.625][c]];

/// Pixels per degree, the mean, and the pixels (0, 0), (7, 12), (23, 12) and (35, 23).
type Known = (f64, f64, [f64; 4]);

/// From `flip_evaluator.evaluate(b, a, "LDR", parameters={"ppd": ...})` of the package flip-evaluator
/// 1.7. It computes in f32: of the plain colours, whose FLIP cannot depend on pixels per degree, it says
/// 0.438605 at 67 and 0.438592 at 20, in exact arithmetic 0.438565. Hence 5e-5.
const KNOWN: [([Formula; 2], Known); 5] = [
    (CHECKS, (67.0, 0.235_087, [0.204_552, 0.151_172, 0.295_403, 0.543_993])),
    (CHECKS, (20.0, 0.792_003, [0.502_591, 0.975_298, 0.983_714, 0.876_002])),
    (SHIFT, (67.0, 0.247_088, [0.000_028, 0.882_314, 0.792_285, 0.0])),
    (SHIFT, (20.0, 0.175_114, [0.0, 0.980_486, 0.975_107, 0.0])),
    (FLAT, (67.0, 0.438_601, [0.438_605; 4])),
];

#[test]
fn it_agrees_with_the_authors_program() {
    for ([a, b], (pixels_per_degree, mean, pixels)) in KNOWN {
        let map = flip(&picture(a), &picture(b), WIDTH, pixels_per_degree);
        let ours = map.iter().sum::<f64>() / map.len() as f64;
        let told = [(0, 0), (7, 12), (23, 12), (35, 23)].map(|(x, y)| map[y * WIDTH + x]);
        assert!((ours - mean).abs() < 5e-5, "{ours} {mean}");
        for (ours, theirs) in told.iter().zip(pixels) {
            assert!((ours - theirs).abs() < 5e-5, "{told:?} {pixels:?}");
        }
    }
}

/// Filters leave plain colours as they are: what remains is the distance of two colours, by hand.
#[test]
fn of_plain_colours_it_is_their_distance() {
    let [a, b] = FLAT.map(picture);
    let map = flip(&a, &b, WIDTH, 67.0);
    // With the published sRGB matrix these colours are (41.155, 21.158, -23.232) and (46.129, 11.952,
    // -13.735) in CIELAB with the Hunt effect: 4.974 + hypot(9.207, 9.497) = 18.201, against 203.297
    // from green (87.735, -75.612, 72.977) to blue (32.297, 25.575, -34.836). (18.201 / 203.297)^0.7 =
    // 0.18466 lies below the bend at 0.4 and becomes 0.18466 / 0.4 * 0.95 = 0.43857.
    for value in &map {
        assert!((value - 0.43857).abs() < 2e-5, "{value}");
    }
    assert_eq!(map, flip(&b, &a, WIDTH, 67.0));
    assert_eq!(flip(&a, &a, WIDTH, 67.0), vec![0.0; WIDTH * HEIGHT]);
}
