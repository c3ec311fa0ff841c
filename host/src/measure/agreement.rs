//! Whether a reference and an estimate that knows nothing of it tell the same: numbers in, a finding out.
//!
//! They are compared on the mean of the whole picture and of its tiles, in each channel. How far they may
//! be apart follows from the spread of the estimate's replicates. A mean hides a mirrored map, a tile does not.

use std::collections::BTreeMap;
use std::fmt;

use rayon::prelude::*;
use serde::Serialize;

use super::student::{self, DOUBTFUL_SHARE};

/// The side of a tile [pixels]; smaller where the picture would have fewer than [`LEAST_TILES`].
const TILE: u32 = 16;
const LEAST_TILES: usize = 4;

/// The probability that a reference that is right is taken for wrong, over all comparisons together.
const LEVEL: f64 = 0.01;

/// This much of the reference may always lie between the two: what quadrature and f32 may miss.
pub const FLOOR: f64 = 2e-4;

/// Relative standard errors above which nothing is decided: of the picture's mean, and of most tiles'.
const SHARP_PICTURE: f64 = 0.002;
const SHARP_TILE: f64 = 0.01;

/// A part of the picture whose mean is compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// The tile's first and last pixel, as [x, y]; `None` for the whole picture.
    tile: Option<[[u32; 2]; 2]>,
    /// Rows of the film that lie in it.
    rows: Vec<usize>,
}

/// The whole picture, and its tiles with anything in them; `pixels` are those of the film's rows.
pub fn places(pixels: impl Iterator<Item = u32>, [width, height]: [u32; 2]) -> Vec<Place> {
    let pixels: Vec<u32> = pixels.collect();
    let tiles_of = |side: u32| {
        let mut tiles: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for (row, pixel) in pixels.iter().enumerate() {
            tiles.entry([pixel / width / side, pixel % width / side]).or_default().push(row);
        }
        tiles
    };
    let mut side = TILE;
    let mut tiles = tiles_of(side);
    while tiles.len() < LEAST_TILES && side > 1 {
        side /= 2;
        tiles = tiles_of(side);
    }
    let whole = Place { tile: None, rows: (0..pixels.len()).collect() };
    let tiles = tiles.into_iter().map(|([row, column], rows)| {
        let first = [column * side, row * side];
        let last = [(first[0] + side).min(width) - 1, (first[1] + side).min(height) - 1];
        Place { tile: Some([first, last]), rows }
    });
    std::iter::once(whole).chain(tiles).collect()
}

/// One channel of one place, by the reference and by the estimate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Comparison {
    /// The tile's first and last pixel, as [x, y]; `None` for the whole picture.
    pub tile: Option<[[u32; 2]; 2]>,
    /// 0 for red, 1 for green, 2 for blue.
    pub channel: usize,
    /// Mean radiance by the reference.
    pub reference: f64,
    /// Mean radiance by the estimate, and its standard error.
    pub found: f64,
    /// The standard error of `found`.
    pub std_error: f64,
    /// How far the two may be apart [radiance].
    pub allowed: f64,
    /// The part of the variance that one replicate holds.
    pub largest_share: f64,
}

impl Comparison {
    /// The estimate less the reference in standard errors.
    pub fn z(&self) -> f64 {
        ratio(self.found - self.reference, self.std_error)
    }

    /// The estimate less the reference as a part of the reference.
    pub fn off(&self) -> f64 {
        ratio(self.found - self.reference, self.reference.abs())
    }

    /// The standard error as a part of the reference or the estimate, whichever is larger.
    fn relative_error(&self) -> f64 {
        ratio(self.std_error, self.reference.abs().max(self.found.abs()))
    }

    /// How far apart they are in units of what is allowed; past 1 they disagree.
    fn excess(&self) -> f64 {
        ratio((self.found - self.reference).abs(), self.allowed)
    }

    /// Whether one replicate holds so much that its spread says little, and the spread matters.
    fn lopsided(&self) -> bool {
        self.largest_share > DOUBTFUL_SHARE && self.allowed > FLOOR * self.reference.abs()
    }
}

/// 0 / 0 is 0: black is as it should be where black is expected.
fn ratio(part: f64, of: f64) -> f64 {
    if part == 0.0 { 0.0 } else { part / of }
}

/// The place in words, with its channel.
impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let channel = ["red", "green", "blue"][self.channel];
        match self.tile {
            None => write!(f, "the picture, {channel}"),
            Some([[x0, y0], [x1, y1]]) => write!(f, "x {x0} to {x1}, y {y0} to {y1}, {channel}"),
        }
    }
}

/// What the comparison found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Finding {
    /// Nowhere are they farther apart than allowed, and the estimate is sharp enough to tell.
    Agrees,
    /// Somewhere they are farther apart than allowed.
    Disagrees,
    /// The estimate is not sharp enough to tell.
    Undecided,
}

/// A reference beside an estimate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// What follows.
    pub finding: Finding,
    /// Why the estimate is not sharp enough.
    pub doubt: Option<String>,
    /// The whole picture's channels.
    pub picture: [Comparison; 3],
    /// The tile and channel where they are farthest apart for what is allowed there.
    pub worst_tile: Comparison,
    /// Tiles with anything in them.
    pub tiles: usize,
    /// Tiles whose standard error is below 1 % in each channel.
    pub sharp_tiles: usize,
    /// Standard errors that may lie between the two.
    pub quantile: f64,
}

impl Agreement {
    /// Compares at these places, the first of them the whole picture; `reference` gives the radiance of a
    /// row, `estimate` that of a row in one of `replicates` replicates.
    ///
    /// They may be apart by t standard errors, t being Student's quantile at 1 % for all comparisons
    /// together, or by 2e-4 of the reference.
    ///
    /// `None` where nothing is covered.
    pub fn new(
        places: &[Place],
        reference: impl Fn(usize) -> [f64; 3] + Sync,
        estimate: impl Fn(usize, usize) -> [f64; 3] + Sync,
        replicates: usize,
    ) -> Option<Self> {
        let tests = (places.len() * 3) as f64;
        let quantile = match replicates {
            0 | 1 => f64::INFINITY,
            n => student::quantile(student::sidak(LEVEL, tests), n as u32 - 1),
        };
        let compared: Vec<[Comparison; 3]> = places
            .par_iter()
            .map(|place| {
                let truth = place.mean(&reference);
                let means: Vec<[f64; 3]> =
                    (0..replicates).map(|r| place.mean(|row| estimate(row, r))).collect();
                std::array::from_fn(|channel| {
                    let means: Vec<f64> = means.iter().map(|mean| mean[channel]).collect();
                    compare(place.tile, channel, truth[channel], &means, quantile)
                })
            })
            .collect();
        let [picture, tiles @ ..] = compared.as_slice() else { return None };
        let worst = |a: &Comparison, b: &Comparison| a.excess().total_cmp(&b.excess());
        let worst_tile = *tiles.iter().flatten().max_by(|a, b| worst(a, b))?;
        let is_sharp =
            |tile: &&[Comparison; 3]| tile.iter().all(|c| c.relative_error() < SHARP_TILE);
        let sharp_tiles = tiles.iter().filter(is_sharp).count();
        let doubt = doubt(picture, [sharp_tiles, tiles.len()]);
        // A tile that never met what is rare and bright does not know of it. The picture as a whole does:
        // as long as it is not sharp, no tile is believed.
        let apart = |c: &&Comparison| c.excess() > 1.0;
        let blamed = tiles.iter().flatten().filter(apart).max_by(|a, b| worst(a, b));
        let (finding, doubt) = match (doubt, blamed) {
            (doubt, _) if picture.iter().any(|c| apart(&c) && !c.lopsided()) => {
                (Finding::Disagrees, doubt)
            }
            (Some(doubt), _) => (Finding::Undecided, Some(doubt)),
            (None, Some(c)) if c.lopsided() => {
                let share = c.largest_share * 100.0;
                let told = format!("one replicate holds {share:.0} % of the variance of {c}");
                (Finding::Undecided, Some(told))
            }
            (None, Some(_)) => (Finding::Disagrees, None),
            (None, None) => (Finding::Agrees, None),
        };
        let tiles = tiles.len();
        Some(Self { finding, doubt, picture: *picture, worst_tile, tiles, sharp_tiles, quantile })
    }

    /// Whether the estimate is sharp enough to tell, whatever it tells.
    pub fn sharp(&self) -> bool {
        doubt(&self.picture, [self.sharp_tiles, self.tiles]).is_none()
    }

    /// The whole picture's channel where they are farthest apart for what is allowed.
    pub fn worst_channel(&self) -> &Comparison {
        let [mut worst, rest @ ..] = self.picture.each_ref();
        for other in rest {
            if other.excess() > worst.excess() {
                worst = other;
            }
        }
        worst
    }
}

impl Place {
    fn mean(&self, radiance: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for row in &self.rows {
            for (total, channel) in sum.iter_mut().zip(radiance(*row)) {
                *total += channel;
            }
        }
        sum.map(|total| total / self.rows.len() as f64)
    }
}

fn compare(
    tile: Option<[[u32; 2]; 2]>,
    channel: usize,
    reference: f64,
    means: &[f64],
    quantile: f64,
) -> Comparison {
    let n = means.len() as f64;
    let found = means.iter().sum::<f64>() / n.max(1.0);
    let squares = means.iter().map(|mean| (mean - found).powi(2));
    let (total, largest) = squares.fold((0.0, 0.0), |(sum, most), s| (sum + s, s.max(most)));
    let std_error = if n < 2.0 { f64::INFINITY } else { (total / (n - 1.0) / n).sqrt() };
    let allowed = (quantile * std_error).max(FLOOR * reference.abs());
    let largest_share = ratio(largest, total);
    Comparison { tile, channel, reference, found, std_error, allowed, largest_share }
}

/// Why such an estimate decides nothing.
fn doubt(picture: &[Comparison; 3], [sharp, tiles]: [usize; 2]) -> Option<String> {
    if let Some(c) = picture.iter().find(|c| c.relative_error() >= SHARP_PICTURE) {
        let [error, wanted] = [c.relative_error(), SHARP_PICTURE].map(|part| part * 100.0);
        return Some(format!(
            "the standard error of {c}, is {error:.2} % of it, and {wanted} % is wanted"
        ));
    }
    if let Some(c) = picture.iter().find(|c| c.lopsided()) {
        let share = c.largest_share * 100.0;
        return Some(format!("one replicate holds {share:.0} % of the variance of {c}"));
    }
    (2 * sharp <= tiles).then(|| {
        let wanted = SHARP_TILE * 100.0;
        format!("only {sharp} of {tiles} tiles have a standard error below {wanted} %")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four tiles of one pixel each.
    fn four() -> Vec<Place> {
        places(0..4, [2, 2])
    }

    #[test]
    fn tiles_hold_what_is_covered_and_are_at_least_four() {
        let all = places(0..40 * 20, [40, 20]);
        assert_eq!(all.len(), 1 + 3 * 2);
        assert_eq!(all[6].tile, Some([[32, 16], [39, 19]]));
        assert_eq!(all[6].rows.len(), 8 * 4);
        assert_eq!(all.iter().skip(1).map(|place| place.rows.len()).sum::<usize>(), 800);
        // The lower half alone: no tile lies above; and its 16 tiles of 4 are found by halving.
        let lower = places(128..256, [16, 16]);
        assert!(lower.iter().skip(1).all(|place| place.tile.unwrap()[0][1] >= 8));
        assert_eq!(lower.len(), 1 + 8);
        assert_eq!(four().len(), 5);
        assert_eq!(places(std::iter::once(3), [2, 2]).len(), 2);
    }

    /// Replicates lie at 1 +- d in turn: sample variance d^2 16/15, so SE = d sqrt(16/15) / 4 at each
    /// pixel and, all moving together, of the picture. With 15 comparisons t follows.
    #[test]
    fn they_may_be_apart_by_what_student_allows() {
        let d = 0.005;
        let std_error = d * (16.0f64 / 15.0).sqrt() / 4.0;
        let t = student::quantile(student::sidak(0.01, 15.0), 15);
        let found = |off: f64| {
            let sign = |replicate: usize| if replicate.is_multiple_of(2) { 1.0 } else { -1.0 };
            let estimate = |row: usize, replicate: usize| {
                [1.0 + d * sign(replicate) + if row == 2 { off } else { 0.0 }; 3]
            };
            Agreement::new(&four(), |_| [1.0; 3], estimate, 16).unwrap()
        };
        let near = found(0.99 * t * std_error);
        assert!((near.worst_tile.std_error / std_error - 1.0).abs() < 1e-12);
        assert!((near.worst_tile.z() - 0.99 * t).abs() < 1e-9 && (near.quantile - t).abs() < 1e-12);
        assert_eq!((near.finding, near.tiles, near.sharp_tiles), (Finding::Agrees, 4, 4));
        let far = found(1.01 * t * std_error);
        assert_eq!(far.finding, Finding::Disagrees);
        assert_eq!(far.worst_tile.tile, Some([[0, 1], [0, 1]]));
        // A quarter of it reaches the mean, where it may be.
        assert!((far.worst_channel().off() - 0.25 * 1.01 * t * std_error).abs() < 1e-12);
    }

    #[test]
    fn an_exact_estimate_may_miss_by_the_floor() {
        let found = |off: f64| {
            Agreement::new(&four(), |_| [1.0; 3], |_, _| [1.0 + off; 3], 16).unwrap().finding
        };
        assert_eq!(found(0.99 * FLOOR), Finding::Agrees);
        assert_eq!(found(1.01 * FLOOR), Finding::Disagrees);
        // Black where black is expected, and where it is not.
        let black = |reference: f64| {
            Agreement::new(&four(), |_| [reference; 3], |_, _| [0.0; 3], 16).unwrap().finding
        };
        assert_eq!((black(0.0), black(1e-9)), (Finding::Agrees, Finding::Disagrees));
        assert!(Agreement::new(&places(0..0, [2, 2]), |_| [0.0; 3], |_, _| [0.0; 3], 16).is_none());
    }

    #[test]
    fn what_is_not_sharp_decides_nothing_unless_it_is_far_off() {
        let found = |spread: f64, off: f64, lone: bool| {
            let estimate = |_: usize, replicate: usize| {
                let moved = if lone { replicate == 5 } else { replicate.is_multiple_of(2) };
                [1.0 + off + if moved { spread } else { 0.0 }; 3]
            };
            Agreement::new(&four(), |_| [1.0; 3], estimate, 16).unwrap()
        };
        // SE = 0.02 / 2 sqrt(16/15) / 4 = 0.26 %; t is 4.3.
        let vague = found(0.02, -0.01, false);
        assert_eq!(vague.finding, Finding::Undecided);
        assert!(vague.doubt.unwrap().contains("0.26 % of it, and 0.2 % is wanted"));
        assert_eq!(found(0.02, 0.2, false).finding, Finding::Disagrees);
        // One replicate alone is off: it holds 15/16 of the variance.
        for off in [0.0, 0.02] {
            let lone = found(0.02, off, true);
            assert_eq!(lone.finding, Finding::Undecided);
            assert!(lone.doubt.unwrap().contains("one replicate holds 94 %"));
        }
        let one = Agreement::new(&four(), |_| [1.0; 3], |_, _| [1.0; 3], 1).unwrap();
        assert_eq!(one.finding, Finding::Undecided);
    }

    /// Two tiles of four never met the light that the others met rarely: nothing is said against them
    /// before the picture is sharp.
    #[test]
    fn a_tile_that_saw_nothing_is_not_believed_before_the_picture_is_sharp() {
        let found = |spread: f64| {
            let estimate = |row: usize, replicate: usize| {
                let met = 1.0 + spread * (replicate as f64 - 7.5) / 7.5;
                [if row < 2 { met } else { 0.0 }; 3]
            };
            let reference = |row: usize| [if row < 2 { 0.99 } else { 0.01 }; 3];
            Agreement::new(&four(), reference, estimate, 16).unwrap().finding
        };
        assert_eq!((found(0.5), found(0.005)), (Finding::Undecided, Finding::Disagrees));
    }

    /// A right reference beside normal noise is refused in 1 of 100 trials: with independent tiles the
    /// correction is exact but for the picture's mean, which goes with its tiles.
    #[test]
    fn one_right_reference_of_a_hundred_is_refused() {
        let places = four();
        let trials = 3000;
        let mut state = 7u64;
        let mut uniform = move || {
            // Knuth's MMIX generator, the upper bits.
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
        };
        let mut refused = 0;
        for _ in 0..trials {
            // Box and Muller 1958.
            let mut normal =
                || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
            let noise: Vec<[f64; 3]> =
                (0..64).map(|_| std::array::from_fn(|_| 1.0 + 0.003 * normal())).collect();
            let found =
                Agreement::new(&places, |_| [1.0; 3], |row, r| noise[row * 16 + r], 16).unwrap();
            refused += u32::from(found.finding == Finding::Disagrees);
        }
        // 30 are expected, with a standard deviation of 5.5; a quantile of the normal in place of
        // Student's would refuse about 170.
        assert!((14..=46).contains(&refused), "{refused}");
    }
}
