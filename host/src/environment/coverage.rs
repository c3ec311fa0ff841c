//! How much of a texel a light of a recipe covers, by area.
//!
//! A texel is cut into quarters of equal solid angle until each lies inside the light, outside it,
//! or is small against it. Only texels on an edge are cut, and a sun far smaller than its texel is
//! found all the same: the energy does not depend on the resolution.

use glam::DVec3;

use super::orientation::at_longitude;

/// Quarters of quarters that a texel on an edge has at least: 16 x 16.
const MIN_DEPTH: u32 = 4;
/// Enough for the smallest light in the coarsest map.
const MAX_DEPTH: u32 = 24;
/// Pieces on a hard edge end at this fraction of the light's smaller extent.
const FINENESS: f64 = 1.0 / 96.0;
/// A soft edge that changes less than this inside a piece is taken at its centre.
const SOFT_TOLERANCE: f64 = 1.0 / 64.0;

/// A light's outline, map space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// All directions within `radius` [radians] of `axis`; `edge` is the soft fraction of it.
    Disk { axis: DVec3, radius: f64, edge: f64 },
    /// A rectangle on the tangent plane at `axis`, `half` = tangents of its half extents along `right` and
    /// `up`; `edge` is the soft fraction of the smaller one.
    Rectangle { axis: DVec3, right: DVec3, up: DVec3, half: [f64; 2], edge: f64 },
}

/// What a cone of directions sees of a light.
enum Sight {
    Nothing,
    All,
    /// So smooth that one value serves.
    About(f64),
    Mixed,
}

/// A piece of the sphere between two longitudes (as u) and two cosines of the polar angle.
#[derive(Debug, Clone, Copy)]
pub struct Piece {
    pub u: [f64; 2],
    pub cos_theta: [f64; 2],
}

impl Shape {
    /// Axis and angle [radians] of a cone that holds the whole light.
    pub fn bound(&self) -> (DVec3, f64) {
        match *self {
            Self::Disk { axis, radius, .. } => (axis, radius),
            Self::Rectangle { axis, half, .. } => (axis, half[0].hypot(half[1]).atan()),
        }
    }

    /// The mean over a piece, by solid angle, of the light's profile (0 outside to 1 inside).
    pub fn coverage(&self, piece: Piece) -> f64 {
        self.refined(piece, 0)
    }

    fn refined(&self, piece: Piece, depth: u32) -> f64 {
        let (centre, reach) = piece.cone();
        match self.sight(centre, reach) {
            Sight::Nothing => 0.0,
            Sight::All => 1.0,
            Sight::About(value) => value,
            Sight::Mixed => {
                let small = reach < self.smaller_extent() * FINENESS;
                if depth >= MAX_DEPTH || (depth >= MIN_DEPTH && small) {
                    return self.smallest(centre, reach);
                }
                piece.quarters().map(|quarter| self.refined(quarter, depth + 1)).iter().sum::<f64>()
                    / 4.0
            }
        }
    }

    /// A piece that is cut no more: a hard edge crosses it as a straight line at its distance from
    /// the centre, in a square whose half diagonal is `reach`.
    fn smallest(&self, centre: DVec3, reach: f64) -> f64 {
        let inwardness = self.inwardness(centre);
        if self.edge() > 0.0 {
            return self.profile(inwardness);
        }
        let distance = inwardness / self.steepness(centre, 0.0);
        (0.5 + distance / (reach * std::f64::consts::SQRT_2)).clamp(0.0, 1.0)
    }

    fn smaller_extent(&self) -> f64 {
        match self {
            Self::Disk { radius, .. } => 2.0 * radius,
            Self::Rectangle { half, .. } => 2.0 * half[0].min(half[1]).atan(),
        }
    }

    fn edge(&self) -> f64 {
        match self {
            Self::Disk { edge, .. } | Self::Rectangle { edge, .. } => *edge,
        }
    }

    /// Distance inwards from the outline, in units of the radius or of the smaller half extent.
    fn inwardness(&self, dir: DVec3) -> f64 {
        match *self {
            Self::Disk { axis, radius, .. } => 1.0 - angle(dir, axis) / radius,
            Self::Rectangle { axis, right, up, half, .. } => {
                let depth = dir.dot(axis);
                if depth <= 0.0 {
                    return -1.0;
                }
                let (x, y) = (dir.dot(right) / depth, dir.dot(up) / depth);
                (half[0] - x.abs()).min(half[1] - y.abs()) / half[0].min(half[1])
            }
        }
    }

    /// How fast `inwardness` may change per radian within `reach` of `dir`.
    fn steepness(&self, dir: DVec3, reach: f64) -> f64 {
        match *self {
            Self::Disk { radius, .. } => 1.0 / radius,
            Self::Rectangle { axis, half, .. } => {
                // The tangent plane stretches by 1 / cos^2 at most.
                let cos = (angle(dir, axis) + reach).min(1.57).cos();
                1.0 / (cos * cos * half[0].min(half[1]))
            }
        }
    }

    fn profile(&self, inwardness: f64) -> f64 {
        let edge = self.edge();
        if edge == 0.0 {
            return if inwardness > 0.0 { 1.0 } else { 0.0 };
        }
        let t = (inwardness / edge).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }

    fn sight(&self, centre: DVec3, reach: f64) -> Sight {
        let (axis, radius) = self.bound();
        if angle(centre, axis) - reach >= radius {
            return Sight::Nothing;
        }
        let inwardness = self.inwardness(centre);
        let change = reach * self.steepness(centre, reach);
        let edge = self.edge();
        if inwardness + change <= 0.0 {
            Sight::Nothing
        } else if inwardness - change >= edge {
            Sight::All
        } else if edge > 0.0 && 1.5 * change / edge < SOFT_TOLERANCE {
            // 1.5 is the steepest slope of the profile's cubic.
            Sight::About(self.profile(inwardness))
        } else {
            Sight::Mixed
        }
    }
}

impl Piece {
    /// The centre, by solid angle, and the angle [radians] to the farthest corner.
    fn cone(&self) -> (DVec3, f64) {
        let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
        let centre = direction(middle(self.u), middle(self.cos_theta));
        let corner = |i: usize| angle(centre, direction(self.u[i % 2], self.cos_theta[i / 2]));
        (centre, (0..4).map(corner).fold(0.0, f64::max))
    }

    fn quarters(self) -> [Self; 4] {
        let halves = |[a, b]: [f64; 2]| {
            let middle = 0.5 * (a + b);
            [[a, middle], [middle, b]]
        };
        let (u, c) = (halves(self.u), halves(self.cos_theta));
        [0, 1, 2, 3].map(|i| Self { u: u[i % 2], cos_theta: c[i / 2] })
    }
}

fn direction(u: f64, cos_theta: f64) -> DVec3 {
    at_longitude(u, ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt(), cos_theta)
}

/// The angle between unit directions [radians]; from the chord, so that small ones keep their digits.
fn angle(a: DVec3, b: DVec3) -> f64 {
    2.0 * ((a - b).length() / 2.0).min(1.0).asin()
}
