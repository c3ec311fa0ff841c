//! The lobes of a BRDF: f in the plane that holds the normal and the tangent, traced as closely as a
//! drawing shows it.

use std::sync::Arc;

use brdf_sdk::Result;

use crate::exec::Executor;
use crate::link::{View, link};
use crate::plot::trace::{Values, peak_of, trace, usable};
use crate::plugin::Configured;
use crate::render::evaluate::{Pair, evaluate_rows};
use crate::render::rows::Rows;
use crate::tone::luminance;

/// Where the viewer stands: angles from the normal [degrees].
pub const VIEWS: [f64; 3] = [0.0, 30.0, 60.0];

/// The largest angle of a curve [degrees]: some models have no limit at the horizon.
pub const END: f64 = 89.5;

/// Angle between the directions that are looked at first [degrees].
const STEP: f64 = 0.25;

/// One curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    /// The viewer's angle from the normal [degrees].
    pub view: f64,
    /// Its largest value [1/sr]; 0 where it has none.
    pub peak: f64,
    /// Angle from the normal [radians], positive on the mirror direction's side, and radius in [0, 1], the
    /// cube root of f / peak; in the order of the angle, in pieces where f is not finite in between.
    pub pieces: Vec<Vec<[f64; 2]>>,
    /// Directions whose value is negative or not finite.
    pub left_out: usize,
}

/// The lobes for the viewers of [`VIEWS`]; the value is the luminance of f, without the cosine.
pub fn lobes(executor: &mut dyn Executor, brdf: &Configured) -> Result<Vec<Lobe>> {
    let program = Arc::new(link(&View::Eval { brdf: brdf.clone() })?);
    let mut rows = Rows::new(executor, program)?;
    let lobes = VIEWS.iter().map(|view| {
        lobe(*view, &mut |angles| {
            let wo = direction(-view.to_radians());
            let pairs: Vec<Pair> =
                angles.iter().map(|angle| Pair { wo, wi: direction(*angle) }).collect();
            let values = evaluate_rows(executor, &mut rows, brdf, &pairs)?;
            Ok(values.iter().map(|value| luminance(value.f)).collect())
        })
    });
    let lobes = lobes.collect();
    rows.free(executor);
    lobes
}

/// The direction at an angle from the normal, towards the tangent where it is positive.
fn direction(angle: f64) -> [f32; 3] {
    [angle.sin() as f32, 0.0, angle.cos() as f32]
}

/// One viewer's lobe.
fn lobe(view: f64, values: &mut Values<'_>) -> Result<Lobe> {
    let drawn = |angle: f64, value: f64, peak: f64| {
        let r = radius(value, peak);
        [r * angle.sin(), r * angle.cos()]
    };
    let curve = trace(first_angles(view), &drawn, values)?;
    let peak = peak_of(&curve);
    let pieces =
        curve.split(|point| !usable(point[1])).filter(|piece| piece.len() > 1 && peak > 0.0);
    Ok(Lobe {
        view,
        peak,
        left_out: curve.iter().filter(|point| !usable(point[1])).count(),
        pieces: pieces
            .map(|piece| {
                piece.iter().map(|[angle, value]| [*angle, radius(*value, peak)]).collect()
            })
            .collect(),
    })
}

/// Directions at equal angles, and the three at which models are sharp, in order [radians].
fn first_angles(view: f64) -> Vec<f64> {
    let count = (2.0 * END / STEP).round() as usize;
    let mut angles: Vec<f64> = (0..=count).map(|i| -END + i as f64 * STEP).collect();
    angles.extend([-view, 0.0, view]);
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    angles.iter().map(|angle| angle.to_radians()).collect()
}

fn radius(value: f64, peak: f64) -> f64 {
    (value / peak).cbrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn traced(view: f64, f: impl Fn(f64) -> f64) -> Lobe {
        lobe(view, &mut |angles| Ok(angles.iter().map(|angle| f(*angle)).collect())).unwrap()
    }

    #[test]
    fn a_constant_is_a_half_circle() {
        let lobe = traced(30.0, |_| 0.25);
        assert_eq!((lobe.peak, lobe.left_out, lobe.pieces.len()), (0.25, 0, 1));
        assert!(lobe.pieces[0].iter().all(|[_, radius]| *radius == 1.0));
        let ends = [lobe.pieces[0][0][0], lobe.pieces[0].last().unwrap()[0]];
        assert_eq!(ends, [-END, END].map(f64::to_radians));
    }

    /// A peak a hundred times narrower than the first steps, away from any of them, with a foot below
    /// that leads there.
    #[test]
    fn a_narrow_lobe_is_found_in_full_height_and_drawn_by_short_lines() {
        let centre = 0.700_123;
        let f = |angle: f64| 1e4 / (1.0 + ((angle - centre) / 4e-5).powi(2)).powi(2) + 1e-3;
        let lobe = traced(40.0, f);
        assert!(lobe.peak > 0.9995e4, "{}", lobe.peak);
        let [piece] = &lobe.pieces[..] else { panic!("{} pieces", lobe.pieces.len()) };
        let long = piece.windows(2).filter(|pair| (pair[0][1] - pair[1][1]).abs() > 0.012).count();
        assert_eq!(long, 0);
        // The cube root of 1e-7: the foot can be seen.
        assert!(piece.iter().all(|[_, radius]| *radius > 4e-3));
        assert!(piece.len() < 2000, "{} points", piece.len());
    }

    #[test]
    fn a_jump_ends_the_search_and_what_is_no_value_parts_the_curve() {
        let step = traced(0.0, |angle| if angle > 0.5 { 1.0 } else { 0.01 });
        assert_eq!((step.pieces.len(), step.left_out), (1, 0));
        let gap = traced(0.0, |angle| if angle.abs() < 0.1 { f64::NAN } else { 1.0 });
        assert_eq!(gap.pieces.len(), 2);
        assert!(gap.left_out > 10);
        let none = traced(0.0, |_| f64::INFINITY);
        assert_eq!((none.peak, none.pieces.len()), (0.0, 0));
        let black = traced(0.0, |_| 0.0);
        assert_eq!((black.peak, black.pieces.len(), black.left_out), (0.0, 0, 0));
    }
}
