//! Reflectance spectra as linear Rec. 709, under daylight: what is white in the spectrum is white in colour.
//!
//! The observer is the CIE's of 1931 by the fit of Wyman, Sloan, Shirley 2013 (Simple Analytic Approximations to
//! the CIE XYZ Color Matching Functions, equation 4), the illuminant the CIE's D65.

/// Linear Rec. 709 from XYZ (ITU-R BT.709-6, white D65).
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.2404542, -1.5371385, -0.4985314],
    [-0.9692660, 1.8760108, 0.0415560],
    [0.0556434, -0.2040259, 1.0572252],
];

/// D65 from 360 nm on in steps of 10 nm (ISO 11664-2).
const D65: [f64; 48] = [
    46.6383, 52.0891, 49.9755, 54.6482, 82.7549, 91.4860, 93.4318, 86.6823, 104.865, 117.008,
    117.812, 114.861, 115.923, 108.811, 109.354, 107.802, 104.790, 107.689, 104.405, 104.046,
    100.000, 96.3342, 95.7880, 88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268,
    80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.3490, 61.6040, 69.8856, 75.0870, 63.5927,
    46.4182, 66.8054, 63.3828, 64.3040, 59.4519, 51.9590, 57.4406, 60.3125,
];

fn daylight(wavelength: f64) -> f64 {
    let steps = ((wavelength - 360.0) / 10.0).clamp(0.0, (D65.len() - 1) as f64);
    let low = (steps as usize).min(D65.len() - 2);
    D65[low] + (D65[low + 1] - D65[low]) * (steps - low as f64)
}

/// X, Y, Z of one wavelength [nm].
fn observer(wavelength: f64) -> [f64; 3] {
    let lobe = |mean: f64, below: f64, above: f64| {
        let width = if wavelength < mean { below } else { above };
        (-0.5 * ((wavelength - mean) / width).powi(2)).exp()
    };
    [
        1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7)
            - 0.065 * lobe(501.1, 20.4, 26.2),
        0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
        1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8),
    ]
}

/// What each wavelength adds to red, green and blue; over all of them each colour's weights add up to 1. The
/// wavelengths [nm] ascend, and each stands for half of the way to its neighbours. `None` where they see nothing.
pub fn weights(wavelengths: &[f32]) -> Option<Vec<[f64; 3]>> {
    let at = |i: usize| f64::from(wavelengths[i]);
    let last = wavelengths.len() - 1;
    let mut weights: Vec<[f64; 3]> = (0..=last)
        .map(|i| {
            let width = if last == 0 {
                1.0
            } else {
                0.5 * (at((i + 1).min(last)) - at(i.saturating_sub(1)))
            };
            let xyz = observer(at(i)).map(|value| value * daylight(at(i)) * width);
            FROM_XYZ.map(|row| (0..3).map(|k| row[k] * xyz[k]).sum())
        })
        .collect();
    for colour in 0..3 {
        let sum: f64 = weights.iter().map(|weight| weight[colour]).sum();
        if sum.is_nan() || sum <= 1e-6 {
            return None;
        }
        weights.iter_mut().for_each(|weight| weight[colour] /= sum);
    }
    Some(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn xyz_of(spectrum: impl Fn(f64) -> f64) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for wavelength in 360..=830 {
            let wavelength = f64::from(wavelength);
            let xyz = observer(wavelength);
            (0..3).for_each(|k| sum[k] += xyz[k] * spectrum(wavelength));
        }
        sum
    }

    /// D65 lies at (0.3127, 0.3290) and the equal spectrum at (1/3, 1/3); the fit of the observer moves both by
    /// less than 0.002. A slip in a number of either table would move them further.
    #[test]
    fn whites_lie_where_they_should() {
        for (spectrum, expected) in [
            (&daylight as &dyn Fn(f64) -> f64, [0.3127, 0.3290]),
            (&|_| 1.0, [1.0 / 3.0, 1.0 / 3.0]),
        ] {
            let xyz = xyz_of(spectrum);
            let sum: f64 = xyz.iter().sum();
            for axis in 0..2 {
                assert!((xyz[axis] / sum - expected[axis]).abs() < 0.002, "{xyz:?}");
            }
        }
    }

    /// White stays white on any grid, and a spectrum below 490 nm is blue, above 600 nm red.
    #[test]
    fn colours_are_what_they_look_like() {
        let grids: [Vec<f32>; 2] = [
            (36..=100).map(|n| 10.0 * n as f32).collect(),
            vec![380.0, 420.0, 470.0, 550.0, 640.0, 700.0],
        ];
        for grid in grids {
            let weights = weights(&grid).unwrap_or_default();
            let seen = |reflects: &dyn Fn(f32) -> bool| {
                let lit =
                    grid.iter().zip(&weights).filter(|(wavelength, _)| reflects(**wavelength));
                lit.fold([0.0; 3], |sum, (_, weight)| [0, 1, 2].map(|c| sum[c] + weight[c]))
            };
            assert!(seen(&|_| true).iter().all(|c| (c - 1.0).abs() < 1e-12));
            let [red, green, blue] = seen(&|wavelength| wavelength < 490.0);
            assert!(blue > 0.5 && red < 0.2 && green < 0.2, "{red} {green} {blue}");
            let [red, green, blue] = seen(&|wavelength| wavelength > 600.0);
            assert!(red > 0.3 && green < 0.1 && blue < 0.05, "{red} {green} {blue}");
        }
        assert!(weights(&[2000.0, 3000.0]).is_none());
    }
}
