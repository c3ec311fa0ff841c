//! A rectangle cut along a point's horizon, so that no piece has the cosine's kink inside.
//!
//! For a fixed first coordinate the part above the horizon is one interval of the second one, in
//! both layouts; where its end passes a corner line of the rectangle the pieces are parted.

use std::f64::consts::TAU;

use glam::DVec3;

use super::cells::Rect;
use super::map::{Layout, on_face};

/// One end of the interval of the second coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    At(f64),
    Horizon,
}

/// What of a rectangle lies above the horizon, between two values of the first coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    pub a: [f64; 2],
    pub ends: [End; 2],
}

/// The horizon of a point with the unit normal `normal` (map space) over one face of a map.
#[derive(Debug, Clone, Copy)]
pub enum Horizon {
    /// The height above it is sin(theta) along cos(azimuth - towards) + up cos(theta).
    LatLong { along: f64, towards: f64, up: f64 },
    /// The height above it has the sign of c[0] + c[1] s + c[2] t.
    Cube { c: [f64; 3] },
}

impl Horizon {
    pub fn new(layout: Layout, face: usize, normal: DVec3) -> Self {
        match layout {
            Layout::LatLong => Self::LatLong {
                along: normal.x.hypot(normal.z),
                towards: normal.x.atan2(normal.z),
                up: normal.y,
            },
            Layout::Cube => {
                let at = |s: f64, t: f64| normal.dot(on_face(face, s, t));
                let c = at(0.0, 0.0);
                Self::Cube { c: [c, at(1.0, 0.0) - c, at(0.0, 1.0) - c] }
            }
        }
    }

    /// The height above the horizon, up to a positive factor.
    fn height(&self, a: f64, b: f64) -> f64 {
        match *self {
            Self::LatLong { along, towards, up } => {
                b.sin() * along * (TAU * (0.5 - a) - towards).cos() + up * b.cos()
            }
            Self::Cube { c } => c[0] + c[1] * a + c[2] * b,
        }
    }

    /// The second coordinate at which the horizon passes, where it does.
    pub fn crossing(&self, a: f64) -> f64 {
        match *self {
            // tan(theta) = -up / along', in [0, pi].
            Self::LatLong { along, towards, up } => {
                let along = along * (TAU * (0.5 - a) - towards).cos();
                if up < 0.0 { (-up).atan2(along) } else { up.atan2(-along) }
            }
            Self::Cube { c } => -(c[0] + c[1] * a) / c[2],
        }
    }

    /// First coordinates inside `span` at which the horizon passes the line of second coordinate `b`.
    fn passes(&self, span: [f64; 2], b: f64) -> Vec<f64> {
        let found: Vec<f64> = match *self {
            Self::LatLong { along, towards, up } => {
                let turn = (-up * b.cos() / (along * b.sin())).acos();
                let around =
                    |azimuth: f64| (-1..=2).map(move |k| 0.5 - azimuth / TAU + f64::from(k));
                around(towards + turn).chain(around(towards - turn)).collect()
            }
            Self::Cube { c } => vec![-(c[0] + c[2] * b) / c[1]],
        };
        // Where it does not pass, acos and the division gave NaN or infinity.
        found.into_iter().filter(|a| span[0] < *a && *a < span[1]).collect()
    }

    /// The pieces of a rectangle above the horizon.
    pub fn cut(&self, rect: &Rect) -> Vec<Piece> {
        let mut at: Vec<f64> = rect.b.iter().flat_map(|b| self.passes(rect.a, *b)).collect();
        at.extend(rect.a);
        at.sort_by(f64::total_cmp);
        let pieces = at.windows(2).filter_map(|a| {
            let middle = 0.5 * (a[0] + a[1]);
            // Looked at a little inside: at a pole the height of a level normal is zero.
            let inwards = 1e-9 * (rect.b[1] - rect.b[0]);
            let above =
                [rect.b[0] + inwards, rect.b[1] - inwards].map(|b| self.height(middle, b) > 0.0);
            let end = |i: usize| if above[i] { End::At(rect.b[i]) } else { End::Horizon };
            ((above[0] || above[1]) && a[0] < a[1])
                .then(|| Piece { a: [a[0], a[1]], ends: [end(0), end(1)] })
        });
        pieces.collect()
    }
}
