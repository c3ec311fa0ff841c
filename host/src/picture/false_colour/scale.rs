//! How numbers become places on a legend's bar.

use super::colours::{NO_VALUE, diverging, sequential};

/// Factors of ten that a logarithmic scale spans at the most.
const DECADES: i32 = 6;

/// A scale that colours values; what lies beyond its ends takes the end's colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// From `largest` some factors of ten down; a value of 0 lies at the lower end.
    Logarithmic {
        /// The upper end, positive.
        largest: f64,
        /// How many factors of ten, at least one.
        decades: i32,
    },
    /// From 0 to `largest`.
    Linear {
        /// The upper end, positive.
        largest: f64,
    },
    /// From `-largest` to `largest`, blue below and red above.
    Diverging {
        /// The upper end, positive.
        largest: f64,
    },
}

impl Scale {
    /// Six factors of ten below the power of ten above all finite values.
    pub fn logarithmic(values: &[f64]) -> Self {
        let exponent = exponents(values).map_or(0, |[_, high]| high);
        Self::Logarithmic { largest: 10f64.powi(exponent), decades: DECADES }
    }

    /// As many factors of ten as hold all positive values; six of them at the most.
    pub fn spanning(values: &[f64]) -> Self {
        let [low, high] = exponents(values).unwrap_or([-1, 0]);
        Self::Logarithmic { largest: 10f64.powi(high), decades: (high - low).clamp(1, DECADES) }
    }

    /// The diverging scale that holds 99 % of the values that are finite and not 0; it ends at 1, 2 or 5
    /// times a power of ten. Few large values would leave the others without colour.
    pub fn diverging(values: &[f64]) -> Self {
        let mut sizes: Vec<f64> = values
            .iter()
            .map(|value| value.abs())
            .filter(|size| size.is_finite() && *size > 0.0)
            .collect();
        sizes.sort_by(f64::total_cmp);
        let held = sizes.get((sizes.len() * 99).div_ceil(100).saturating_sub(1));
        let Some(held) = held else { return Self::Diverging { largest: 1.0 } };
        let power = 10f64.powf(held.log10().floor());
        let round = [1.0, 2.0, 5.0].into_iter().find(|factor| factor * power >= *held);
        Self::Diverging { largest: round.unwrap_or(10.0) * power }
    }

    /// The colour of a value; grey for NaN.
    pub fn colour(&self, value: f64) -> [u8; 3] {
        if value.is_nan() {
            return NO_VALUE;
        }
        match *self {
            Self::Logarithmic { largest, decades } => {
                let down = (value.max(0.0) / largest).log10() / f64::from(decades);
                sequential(1.0 + down as f32)
            }
            Self::Linear { largest } => sequential((value / largest) as f32),
            Self::Diverging { largest } => diverging((value / largest) as f32),
        }
    }

    /// The value at a place on the bar, from 0 to 1.
    pub fn value(&self, place: f64) -> f64 {
        match *self {
            Self::Logarithmic { largest, decades } => {
                largest * 10f64.powf(f64::from(decades) * (place - 1.0))
            }
            Self::Linear { largest } => place * largest,
            Self::Diverging { largest } => (2.0 * place - 1.0) * largest,
        }
    }

    /// Where numbers stand on the bar, from 0 to 1, and what they say.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let steps = match self {
            Self::Logarithmic { decades: decades @ (4 | 6), .. } => decades / 2,
            Self::Logarithmic { decades, .. } => *decades,
            Self::Linear { .. } | Self::Diverging { .. } => 4,
        };
        let place = |step: i32| f64::from(step) / f64::from(steps);
        (0..=steps).map(|step| (place(step), number(self.value(place(step))))).collect()
    }

    /// How the legend calls it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Logarithmic { .. } => "LOG SCALE",
            Self::Linear { .. } | Self::Diverging { .. } => "LINEAR SCALE",
        }
    }
}

/// The powers of ten around all values that are positive and finite.
fn exponents(values: &[f64]) -> Option<[i32; 2]> {
    let positive = || values.iter().copied().filter(|value| value.is_finite() && *value > 0.0);
    let [low, high] = [positive().reduce(f64::min)?, positive().reduce(f64::max)?];
    Some([low.log10().floor() as i32, high.log10().ceil() as i32])
}

/// Two digits, with a power of ten where the number is far from 1.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if (0.01..1000.0).contains(&value.abs()) {
        let digits = format!("{value:.3}");
        return digits.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{value:.1e}").replace(".0e", "e").to_uppercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(scale: &Scale) -> String {
        scale.ticks().into_iter().map(|(_, text)| text).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn scales_hold_their_values() {
        let scale = Scale::logarithmic(&[0.0, 3e-4, 0.02, f64::NAN, f64::INFINITY]);
        assert_eq!(shown(&scale), "1E-7 1E-5 1E-3 0.1");
        assert_eq!(shown(&Scale::logarithmic(&[0.0])), "1E-6 1E-4 0.01 1");
        let spanning = Scale::spanning(&[0.0, 3e-4, 0.02, f64::NAN]);
        assert_eq!(spanning, Scale::Logarithmic { largest: 0.1, decades: 3 });
        assert_eq!(shown(&spanning), "1E-4 1E-3 0.01 0.1");
        assert_eq!(shown(&Scale::spanning(&[1e-9, 500.0])), "1E-3 0.1 10 1E3");
        assert_eq!(shown(&Scale::spanning(&[10.0])), "1 10");
        assert_eq!(shown(&Scale::spanning(&[0.0])), "0.1 1");
        assert_eq!(shown(&Scale::Linear { largest: 1.0 }), "0 0.25 0.5 0.75 1");
        // Of 100 values 0.01 to 1 and one of 50, 99 % lie up to 1.
        let mut values: Vec<f64> = (1..=100).map(|i| f64::from(i) * -0.01).collect();
        values.extend([50.0, 0.0, f64::NAN]);
        assert_eq!(shown(&Scale::diverging(&values)), "-1 -0.5 0 0.5 1");
        assert_eq!(shown(&Scale::diverging(&[0.0031])), "-5E-3 -2.5E-3 0 2.5E-3 5E-3");
        assert_eq!(Scale::diverging(&[7.0]), Scale::Diverging { largest: 10.0 });
        assert_eq!(Scale::diverging(&[0.0, f64::NAN]), Scale::Diverging { largest: 1.0 });
    }

    #[test]
    fn the_bar_shows_the_colours_of_the_picture() {
        let scales = [
            Scale::Logarithmic { largest: 0.1, decades: 6 },
            Scale::Linear { largest: 3.0 },
            Scale::Diverging { largest: 5.0 },
        ];
        for scale in scales {
            let ends = [scale.colour(scale.value(0.0)), scale.colour(scale.value(1.0))];
            assert_eq!(ends, [scale.colour(-1e30), scale.colour(f64::INFINITY)]);
            assert_ne!(scale.colour(scale.value(0.4)), scale.colour(scale.value(0.6)));
            assert_eq!(scale.colour(f64::NAN), NO_VALUE);
        }
        // One factor of ten below the upper end: a sixth of the bar.
        assert_eq!(scales[0].colour(0.01), sequential(1.0 - 1.0 / 6.0));
        assert_eq!(scales[0].colour(0.0), sequential(0.0));
        assert_eq!(scales[2].colour(2.5), diverging(0.5));
    }
}
