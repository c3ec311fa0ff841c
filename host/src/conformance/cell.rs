//! Rectangles of directions in (theta, phi), and where their angles begin.

/// Theta is the angle from the normal; phi goes round it from a direction that is across `wo`, so that phi
/// begins and ends where neither a mirror's nor a retroreflector's lobe lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chart {
    /// The azimuth at which phi is 0 [radians].
    pub zero: f64,
}

/// A rectangle of (theta, phi) [radians]; phi in [-pi, pi].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Smallest theta and phi.
    pub low: [f32; 2],
    /// Largest theta and phi.
    pub high: [f32; 2],
}

/// Cells are not halved across a side of less than this [radians]: directions in f32 lie on a grid of some
/// 1e-7, which must not show.
pub const LEAST_SIDE: f64 = 2e-5;

impl Cell {
    /// All directions above the horizon.
    pub const HEMISPHERE: Cell = Cell {
        low: [0.0, -std::f32::consts::PI],
        high: [std::f32::consts::FRAC_PI_2, std::f32::consts::PI],
    };

    /// Its four quarters.
    pub fn quarters(self) -> [Cell; 4] {
        let [[t0, p0], [t1, p1]] = [self.low, self.high];
        let [t, p] = [0.5 * (t0 + t1), 0.5 * (p0 + p1)];
        [[t0, p0, t, p], [t0, p, t, p1], [t, p0, t1, p], [t, p, t1, p1]]
            .map(|[t0, p0, t1, p1]| Cell { low: [t0, p0], high: [t1, p1] })
    }

    /// Whether a direction lies in it.
    pub fn holds(&self, at: [f32; 2]) -> bool {
        (0..2).all(|axis| self.low[axis] <= at[axis] && at[axis] < self.high[axis])
    }

    /// Its sides as lengths on the unit sphere, through its middle.
    pub fn sides(self) -> [f64; 2] {
        let [theta, phi] = [0, 1].map(|i| f64::from(self.high[i]) - f64::from(self.low[i]));
        let middle = 0.5 * (f64::from(self.high[0]) + f64::from(self.low[0]));
        [theta, phi * middle.sin()]
    }

    /// Whether directions in f32 hardly tell its sides.
    pub fn is_tiny(self) -> bool {
        self.sides().iter().all(|side| *side < 0.1 * LEAST_SIDE)
    }

    /// Its solid angle [sr].
    pub fn solid_angle(self) -> f64 {
        let [theta, phi] = [0, 1].map(|i| f64::from(self.high[i]) - f64::from(self.low[i]));
        let middle = 0.5 * (f64::from(self.high[0]) + f64::from(self.low[0]));
        // cos a - cos b, without the difference of close numbers.
        2.0 * middle.sin() * (0.5 * theta).sin() * phi
    }
}

impl Chart {
    /// The one for a view.
    pub fn of(wo: [f32; 3]) -> Self {
        let [x, y, _] = wo.map(f64::from);
        Self { zero: y.atan2(x) + std::f64::consts::FRAC_PI_2 }
    }

    /// Theta and phi of a direction [radians].
    pub fn angles(self, w: [f32; 3]) -> [f64; 2] {
        use std::f64::consts::{PI, TAU};
        let [x, y, z] = w.map(f64::from);
        let phi = y.atan2(x) - self.zero;
        let phi = if phi < -PI { phi + TAU } else { phi };
        [x.hypot(y).atan2(z), if phi > PI { phi - TAU } else { phi }]
    }

    /// The direction in the middle of a cell.
    pub fn middle(self, cell: Cell) -> [f32; 3] {
        let [theta, phi] = [0, 1].map(|i| 0.5 * (f64::from(cell.high[i]) + f64::from(cell.low[i])));
        let (sine, phi) = (theta.sin(), phi + self.zero);
        [sine * phi.cos(), sine * phi.sin(), theta.cos()].map(|c| c as f32)
    }
}
