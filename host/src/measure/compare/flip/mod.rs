//! FLIP: how different two pictures look when one takes the other's place on a screen.
//!
//! LDR-FLIP of Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom and Fairchild 2020, "FLIP: A
//! Difference Evaluator for Alternating Images". Both pictures pass the eye's contrast sensitivity;
//! what differs in colour then is a distance in a space that is about uniform; what differs in edges
//! and points makes that distance larger. The symbols are the paper's.

mod colour;
mod filter;

use std::f64::consts::{PI, SQRT_2};

use glam::DVec3;

use filter::{Plane, weights};

/// Pixels per degree of visual angle for a 0.7 m wide screen of 3840 pixels seen from 0.7 m: the
/// paper's observer.
pub const PIXELS_PER_DEGREE: f64 = 67.0;

/// Exponent of the colour distance, and where the first of its two straight pieces ends (section 4.1.4).
const Q_C: f64 = 0.7;
const P_C: f64 = 0.4;
const P_T: f64 = 0.95;
/// Width of the feature detector [degrees], and exponent of the feature difference (section 4.2).
const W: f64 = 0.082;
const Q_F: f64 = 0.5;

/// A term a sqrt(pi/b) exp(-pi^2 d^2 / b) of a contrast sensitivity, d in degrees (table 1).
struct Term {
    a: f64,
    b: f64,
}

/// Contrast sensitivity of Y, Cx and Cz.
const SENSITIVITY: [&[Term]; 3] = [
    &[Term { a: 1.0, b: 0.0047 }],
    &[Term { a: 1.0, b: 0.0053 }],
    &[Term { a: 34.1, b: 0.04 }, Term { a: 13.5, b: 0.025 }],
];
/// The widest of them decides how far all filters reach: three standard deviations.
const WIDEST_B: f64 = 0.04;

/// FLIP of each pixel, in [0, 1]: 0 where no difference is seen.
///
/// `a` and `b` hold a screen's linear light, Rec. 709 in [0, 1], row by row, `width` to a row;
/// `pixels_per_degree` is at least 1.
pub fn flip(a: &[[f32; 3]], b: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> Vec<f64> {
    let [a, b] = [a, b].map(|picture| Seen::new(picture, width, pixels_per_degree));
    let largest = colour::hyab(colour::hunt_lab(DVec3::Y), colour::hunt_lab(DVec3::Z)).powf(Q_C);
    let colours = a.lab.iter().zip(&b.lab);
    let features = a.features.iter().zip(&b.features);
    let both = colours.zip(features);
    both.map(|((lab_a, lab_b), (features_a, features_b))| {
        let colour = redistributed(colour::hyab(*lab_a, *lab_b).powf(Q_C), largest);
        let [edge, point] = [0, 1].map(|kind| (features_a[kind] - features_b[kind]).abs());
        let feature = (edge.max(point) / SQRT_2).powf(Q_F);
        // 0^0 would be 1: where no colour differs nothing is seen, whatever the features say.
        if colour == 0.0 { 0.0 } else { colour.powf(1.0 - feature) }
    })
    .collect()
}

/// Colour distances up to `P_C` of the largest take the range up to `P_T`, the others what is left.
fn redistributed(distance: f64, largest: f64) -> f64 {
    let bend = P_C * largest;
    if distance < bend {
        P_T / bend * distance
    } else {
        P_T + (distance - bend) / (largest - bend) * (1.0 - P_T)
    }
}

/// What the eye has of one picture.
struct Seen {
    /// After the contrast sensitivity, Hunt-adjusted CIELAB.
    lab: Vec<DVec3>,
    /// Strengths of edges and of points.
    features: Vec<[f64; 2]>,
}

impl Seen {
    fn new(light: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> Self {
        let opponents: Vec<DVec3> = light
            .iter()
            .map(|pixel| colour::opponent(DVec3::from_array(pixel.map(f64::from))))
            .collect();
        let plane = |channel: usize| Plane {
            width,
            values: opponents.iter().map(|opponent| opponent[channel]).collect(),
        };
        let [y, cx, cz] = [0, 1, 2]
            .map(|channel| sensed(&plane(channel), SENSITIVITY[channel], pixels_per_degree).values);
        let lab = y.iter().zip(&cx).zip(&cz).map(|((y, cx), cz)| {
            // Lightness and colour are blurred differently: together they may leave the screen's range.
            let rgb = colour::rgb_of_opponent(DVec3::new(*y, *cx, *cz));
            colour::hunt_lab(rgb.clamp(DVec3::ZERO, DVec3::ONE))
        });
        Self { lab: lab.collect(), features: features(&plane(0), pixels_per_degree) }
    }
}

/// A plane behind a contrast sensitivity, which leaves a constant as it is.
fn sensed(plane: &Plane, sensitivity: &[Term], pixels_per_degree: f64) -> Plane {
    let radius = (3.0 * (WIDEST_B / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
    let mut total = 0.0;
    let mut sum = Plane { width: plane.width, values: vec![0.0; plane.values.len()] };
    for Term { a, b } in sensitivity {
        let line = weights(radius, |offset| {
            let degrees = offset / pixels_per_degree;
            (-PI * PI * degrees * degrees / b).exp()
        });
        let factor = a * (PI / b).sqrt();
        total += factor * line.iter().sum::<f64>().powi(2);
        let term = plane.filtered(&line, &line);
        sum.values.iter_mut().zip(term.values).for_each(|(sum, value)| *sum += factor * value);
    }
    sum.values.iter_mut().for_each(|value| *value /= total);
    sum
}

/// Strengths of edges and of points in luminance: first and second derivatives of a Gaussian, whose
/// positive weights add up to 1 and negative ones to -1 (section 4.2).
fn features(y: &Plane, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let luminance = Plane {
        width: y.width,
        values: y.values.iter().map(|value| (value + 16.0) / 116.0).collect(),
    };
    let deviation = 0.5 * W * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as usize;
    let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
    let smooth = weights(radius, gaussian);
    let total: f64 = smooth.iter().sum();
    let smooth: Vec<f64> = smooth.iter().map(|weight| weight / total).collect();
    let edge = balanced(&weights(radius, |x| -x * gaussian(x)));
    let point =
        balanced(&weights(radius, |x| (x * x / (deviation * deviation) - 1.0) * gaussian(x)));
    let strength = |detector: &[f64]| {
        let x = luminance.filtered(detector, &smooth);
        let y = luminance.filtered(&smooth, detector);
        x.values.into_iter().zip(y.values).map(|(x, y)| x.hypot(y)).collect::<Vec<_>>()
    };
    strength(&edge).into_iter().zip(strength(&point)).map(|(edge, point)| [edge, point]).collect()
}

/// Scales positive and negative weights to sums of 1 and -1.
fn balanced(weights: &[f64]) -> Vec<f64> {
    let of_sign = |sign: f64| weights.iter().map(|weight| (sign * weight).max(0.0)).sum::<f64>();
    let (positive, negative) = (of_sign(1.0), of_sign(-1.0));
    let scaled =
        weights.iter().map(|weight| weight / if *weight > 0.0 { positive } else { negative });
    scaled.collect()
}

#[cfg(test)]
mod tests;
