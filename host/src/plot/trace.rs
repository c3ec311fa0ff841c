//! A function of one number, looked at as closely as a drawing of it shows.

use brdf_sdk::Result;

/// No chord of a drawn curve is longer, in parts of the drawing, unless the function jumps.
const CHORD: f64 = 0.012;

/// The values beside the peak are not further below it, in parts of it: a peak is written with three digits.
const SUMMIT: f64 = 1e-3;

/// How often a step is halved: a quarter of a degree becomes less than f32 tells apart.
const ROUNDS: usize = 16;

/// The values at a list of places.
pub type Values<'a> = dyn FnMut(&[f64]) -> Result<Vec<f64>> + 'a;

/// Where a place and its value are drawn, beside the largest value of all; sides of the drawing are about 1.
pub type Drawn<'a> = dyn Fn(f64, f64, f64) -> [f64; 2] + 'a;

/// Places and values in the order of the places: `first` and what lies between them, until a line through them is the
/// curve.
pub fn trace(first: Vec<f64>, drawn: &Drawn<'_>, values: &mut Values<'_>) -> Result<Vec<[f64; 2]>> {
    let mut places = first;
    let mut curve: Vec<[f64; 2]> = Vec::new();
    for _ in 0..=ROUNDS {
        if places.is_empty() {
            break;
        }
        let found = values(&places)?;
        curve.extend(places.iter().zip(found).map(|(place, value)| [*place, value]));
        curve.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let peak = peak_of(&curve);
        let coarse = |pair: &&[[f64; 2]]| {
            let ([a, f], [b, g]) = (pair[0], pair[1]);
            usable(f)
                && usable(g)
                && peak > 0.0
                && (chord(drawn(a, f, peak), drawn(b, g, peak)) > CHORD || beside_peak(f, g, peak))
        };
        let middle = |pair: &[[f64; 2]]| 0.5 * (pair[0][0] + pair[1][0]);
        places = curve.windows(2).filter(coarse).map(middle).collect();
    }
    Ok(curve)
}

/// The largest value; 0 where there is none.
pub fn peak_of(curve: &[[f64; 2]]) -> f64 {
    curve.iter().map(|point| point[1]).filter(|value| usable(*value)).fold(0.0, f64::max)
}

/// Whether a value can be drawn.
pub fn usable(value: f64) -> bool {
    value.is_finite() && value >= 0.0
}

/// Whether one of two neighbours is the peak and the other so far below that the true one may lie between.
fn beside_peak(f: f64, g: f64, peak: f64) -> bool {
    f.max(g) == peak && f.min(g) < (1.0 - SUMMIT) * peak
}

fn chord([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (c - a).hypot(d - b)
}
