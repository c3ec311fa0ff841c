//! Axes of charts: where a value lies, and which round numbers stand beside.

/// An axis from a number to a larger one; what lies beyond takes the end's place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    low: f64,
    high: f64,
    kind: Kind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Linear,
    Degrees,
    Logarithmic,
}

/// Factors of ten that a logarithmic axis spans at the most.
const DECADES: i32 = 12;

impl Axis {
    /// A linear axis.
    pub fn linear(low: f64, high: f64) -> Self {
        let high = if high > low { high } else { low + 1.0 };
        Self { low, high, kind: Kind::Linear }
    }

    /// A linear axis of angles [degrees], whose round numbers are those of a circle.
    pub fn degrees(low: f64, high: f64) -> Self {
        Self { kind: Kind::Degrees, ..Self::linear(low, high) }
    }

    /// A linear axis from 0 to a round number above all values, and above `least`, which is
    /// positive.
    pub fn from_zero(values: impl Iterator<Item = f64>, least: f64) -> Self {
        let largest = values.filter(|value| value.is_finite()).fold(least, f64::max);
        let step = round_step(largest, 5);
        Self::linear(0.0, (largest / step - 1e-9).ceil() * step)
    }

    /// A logarithmic axis between the powers of ten around all positive values, and around `held`.
    pub fn logarithmic(values: impl Iterator<Item = f64>, held: f64) -> Self {
        let positive = values.filter(|value| value.is_finite() && *value > 0.0);
        let [low, high] =
            positive.fold([held; 2], |[low, high], value| [low.min(value), high.max(value)]);
        let high = high.log10().ceil() as i32;
        let low = (low.log10().floor() as i32).min(high - 1).max(high - DECADES);
        Self { low: 10f64.powi(low), high: 10f64.powi(high), kind: Kind::Logarithmic }
    }

    /// Where a value lies: 0 at the lower end, 1 at the upper.
    pub fn place(&self, value: f64) -> f64 {
        let place = match self.kind {
            Kind::Logarithmic => (value / self.low).log10() / (self.high / self.low).log10(),
            Kind::Linear | Kind::Degrees => (value - self.low) / (self.high - self.low),
        };
        // The logarithm of a negative value.
        if place.is_nan() { 0.0 } else { place.clamp(0.0, 1.0) }
    }

    /// What the lower end says.
    pub fn lowest(&self) -> String {
        of_number(self.low)
    }

    /// What the upper end says.
    pub fn highest(&self) -> String {
        of_number(self.high)
    }

    /// Whether a value lies between its ends.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// Places of round numbers, some `count` of them at the most, and what they say.
    pub fn ticks(&self, count: usize) -> Vec<(f64, String)> {
        if self.kind == Kind::Logarithmic {
            let [low, high] = [self.low, self.high].map(|end| end.log10().round() as i32);
            if (high - low) as usize * FINE.len() < count {
                let all =
                    (low..high).flat_map(|power| FINE.map(|factor| factor * 10f64.powi(power)));
                let values = all.chain([self.high]).rev();
                return values.map(|value| (self.place(value), of_number(value))).collect();
            }
            let every = ((high - low) as usize).div_ceil(count.max(1)).max(1);
            let powers = (low..=high).rev().step_by(every).map(|power| 10f64.powi(power));
            return powers.map(|power| (self.place(power), of_number(power))).collect();
        }
        let length = self.high - self.low;
        let of_circle = match self.kind {
            Kind::Degrees if length > 45.0 => {
                CIRCLE.into_iter().find(|s| s * count as f64 >= length)
            }
            _ => None,
        };
        let step = of_circle.unwrap_or_else(|| round_step(length, count));
        let decimals = (-(step.log10() + 1e-9).floor()).max(0.0) as usize;
        // Long numbers would not fit beside an axis.
        let long = self.kind == Kind::Linear
            && (decimals > 3 || self.low.abs().max(self.high.abs()) >= 1e5);
        let first = (self.low / step - 1e-6).ceil() as i64;
        let last = (self.high / step + 1e-6).floor() as i64;
        let tick = |index: i64| {
            let value = index as f64 * step;
            let label = match index {
                // No -0.
                0 if long => "0".to_owned(),
                0 => format!("{:.decimals$}", 0.0),
                _ if long => of_number(value),
                _ => format!("{value:.decimals$}"),
            };
            (self.place(value), label)
        };
        (first..=last).map(tick).collect()
    }
}

/// Round parts of a circle [degrees].
const CIRCLE: [f64; 5] = [10.0, 15.0, 30.0, 45.0, 90.0];

/// 1, 2 or 5 times a power of ten that a length holds at most `count` times.
fn round_step(length: f64, count: usize) -> f64 {
    let least = length / count.max(1) as f64;
    let power = 10f64.powf(least.log10().floor());
    let factor =
        [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= least * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// Round numbers of a decade, where there is room for them.
const FINE: [f64; 3] = [1.0, 2.0, 5.0];

/// A round number of few digits, with its power of ten where that is shorter.
fn of_number(value: f64) -> String {
    let digits: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    match digits.abs() {
        0.0 => "0".to_owned(),
        0.0099..=9999.0 => format!("{digits}"),
        _ => format!("{digits:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(axis: Axis, count: usize) -> String {
        let ticks = axis.ticks(count).into_iter();
        ticks.map(|(_, text)| text).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn numbers_beside_an_axis_are_round() {
        assert_eq!(shown(Axis::degrees(0.0, 90.0), 4), "0 30 60 90");
        assert_eq!(shown(Axis::degrees(-90.0, 270.0), 4), "-90 0 90 180 270");
        assert_eq!(shown(Axis::degrees(29.991, 30.017), 5), "30.00 30.01");
        assert_eq!(shown(Axis::linear(-0.02, 0.021), 5), "-0.02 -0.01 0.00 0.01 0.02");
        let share = Axis::from_zero([0.3, 0.93, f64::NAN].into_iter(), 1.0);
        assert_eq!(shown(share, 5), "0.0 0.2 0.4 0.6 0.8 1.0");
        let wide = Axis::logarithmic([0.0, 3e-4, 55.0, f64::INFINITY].into_iter(), 1.0);
        assert_eq!(shown(wide, 6), "100 10 1 0.1 0.01 1e-3 1e-4");
        assert_eq!(shown(wide, 3), "100 1 0.01 1e-4");
        assert_eq!(shown(Axis::logarithmic([].into_iter(), 1.0), 6), "1 0.5 0.2 0.1");
        assert_eq!(shown(Axis::linear(0.0, 150_000.0), 4), "0 5e4 1e5 1.5e5");
        assert_eq!(shown(Axis::linear(0.0, 4e-8), 4), "0 1e-8 2e-8 3e-8 4e-8");
    }

    #[test]
    fn values_lie_where_they_belong() {
        let axis = Axis::logarithmic([0.01, 10.0].into_iter(), 1.0);
        assert!((axis.place(0.1) - 1.0 / 3.0).abs() < 1e-12);
        for (value, place) in [(0.0, 0.0), (-3.0, 0.0), (f64::NAN, 0.0), (1e9, 1.0)] {
            assert_eq!(axis.place(value), place, "{value}");
        }
        assert_eq!(Axis::linear(2.0, 4.0).place(3.5), 0.75);
        assert_eq!(Axis::linear(2.0, 2.0).place(2.0), 0.0);
    }
}
