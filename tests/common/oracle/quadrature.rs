//! The light that leaves a point: the integral of f cos L over the hemisphere, piece by piece.
//!
//! Every piece of the map is cut towards the mirror direction until no part is larger than the lobe
//! or than its distance from it, so that no lobe is missed however narrow; then along the horizon.
//! From there on the rectangle with the largest estimated error is halved, until the sum of all
//! estimates is below the tolerance.

use std::collections::BinaryHeap;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::cells::{Cell, Rect, cells, direction};
use super::cubature::{POINTS, Sum, integrate};
use super::horizon::{End, Horizon, Piece};
use super::map::{Filter, Layout, Map};
use super::models::Model;

/// No part of the sphere is integrated at once beyond this radius [radians].
const LARGEST: f64 = 0.4;

/// Evaluations after which a pixel is given up, with the error that it then has.
const MOST_EVALUATIONS: u64 = 50_000_000;

/// A shading point.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// To the viewer, unit, local.
    pub wo: DVec3,
    /// Columns: tangent, bitangent, normal.
    pub world_from_local: DMat3,
}

impl Point {
    /// From f32 vectors: the frame is made orthonormal anew, the normal kept.
    pub fn new(tangent: [f32; 3], normal: [f32; 3], wo: [f32; 3]) -> Self {
        let [t, n, wo] = [tangent, normal, wo].map(|v| DVec3::from(v.map(f64::from)).normalize());
        let t = (t - n * n.dot(t)).normalize();
        Self { wo, world_from_local: DMat3::from_cols(t, n.cross(t), n) }
    }
}

/// Radiance that leaves a point towards its viewer.
#[derive(Debug, Clone, Copy)]
pub struct Value {
    pub radiance: [f64; 3],
    /// Estimated error, relative to the channel's radiance; the largest of the three.
    pub error: f64,
    pub evaluations: u64,
}

/// A map, ready for any point and BRDF.
pub struct Oracle {
    layout: Layout,
    cells: Vec<Cell>,
    map_from_world: DMat3,
}

/// A part of the sphere that is integrated at once: `a` from the piece, `w` from end to end of it.
struct Part {
    cell: usize,
    face: usize,
    ends: [End; 2],
    a: [f64; 2],
    w: [f64; 2],
    sum: Sum,
}

/// A part's place in the heap: the largest error first.
#[derive(PartialEq)]
struct Ranked(f64, usize);

impl Eq for Ranked {}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// What one call looks at.
struct Scene<'a> {
    oracle: &'a Oracle,
    model: &'a Model,
    wo: DVec3,
    local_from_map: DMat3,
    normal: DVec3,
    /// The mirror direction (map space) and how narrow the lobe around it is.
    lobe: Option<(DVec3, f64)>,
}

impl Oracle {
    /// `world_from_map` turns the map in the world.
    pub fn new(map: &Map, filter: Filter, world_from_map: DMat3) -> Self {
        let cells = cells(map, filter);
        Self { layout: map.layout, cells, map_from_world: world_from_map.transpose() }
    }

    /// What leaves `point`, to the relative `tolerance` of each channel.
    pub fn radiance(&self, point: &Point, model: &Model, tolerance: f64) -> Value {
        let map_from_local = self.map_from_world * point.world_from_local;
        let wo = point.wo;
        let mirror = map_from_local * DVec3::new(-wo.x, -wo.y, wo.z);
        Scene {
            oracle: self,
            model,
            wo,
            local_from_map: map_from_local.transpose(),
            normal: map_from_local.z_axis,
            lobe: model.lobe_width(wo).map(|width| (mirror, width)),
        }
        .integrate(tolerance)
    }

    /// A picture: every point, in parallel.
    pub fn picture(&self, points: &[Point], model: &Model, tolerance: f64) -> Vec<[f64; 3]> {
        let value = |point: &Point| {
            let value = self.radiance(point, model, tolerance);
            assert!(value.error <= tolerance, "the oracle gives up: {value:?} at {point:?}");
            value.radiance
        };
        points.par_iter().map(value).collect()
    }
}

impl Scene<'_> {
    fn integrate(&self, tolerance: f64) -> Value {
        let mut parts = Vec::new();
        for (index, cell) in self.oracle.cells.iter().enumerate() {
            self.descend(index, cell.rect, &mut parts);
        }
        let mut evaluations = parts.len() as u64 * POINTS;
        let (mut value, mut error) = totals(&parts);
        let scale = value.map(|value| value.abs().max(f64::MIN_POSITIVE));
        let rank = |sum: &Sum| (0..3).map(|c| sum.error[c] / scale[c]).fold(0.0, f64::max);
        let mut heap: BinaryHeap<_> =
            parts.iter().enumerate().map(|(i, part)| Ranked(rank(&part.sum), i)).collect();
        while (0..3).any(|c| error[c] > 0.9 * tolerance * value[c].abs())
            && evaluations < MOST_EVALUATIONS
        {
            let Some(Ranked(_, index)) = heap.pop() else { break };
            let halves = self.halves(&parts[index]);
            for c in 0..3 {
                let old = parts[index].sum;
                value[c] += halves[0].sum.value[c] + halves[1].sum.value[c] - old.value[c];
                error[c] += halves[0].sum.error[c] + halves[1].sum.error[c] - old.error[c];
            }
            evaluations += 2 * POINTS;
            let [first, second] = halves;
            heap.push(Ranked(rank(&first.sum), index));
            heap.push(Ranked(rank(&second.sum), parts.len()));
            parts[index] = first;
            parts.push(second);
        }
        let (radiance, error) = totals(&parts);
        let relative = |c: usize| if error[c] == 0.0 { 0.0 } else { error[c] / radiance[c].abs() };
        Value { radiance, error: relative(0).max(relative(1)).max(relative(2)), evaluations }
    }

    /// Cuts a rectangle of a cell until the lobe cannot hide in any part, then along the horizon.
    fn descend(&self, cell: usize, rect: Rect, parts: &mut Vec<Part>) {
        let layout = self.oracle.layout;
        let [a, b] = rect.centre();
        let (centre, _) = direction(layout, rect.face, a, b);
        let radius = rect.radius(layout);
        if radius < 0.5 && self.normal.dot(centre) < -radius.sin() {
            return;
        }
        let limit = self.lobe.map_or(LARGEST, |(mirror, width)| {
            let apart = centre.cross(mirror).length().atan2(centre.dot(mirror));
            (apart - radius).clamp(width.min(LARGEST), LARGEST)
        });
        if radius > limit {
            rect.halves(layout).into_iter().for_each(|half| self.descend(cell, half, parts));
            return;
        }
        for Piece { a, ends } in Horizon::new(layout, rect.face, self.normal).cut(&rect) {
            parts.push(self.part(cell, rect.face, ends, a, [0.0, 1.0]));
        }
    }

    fn part(&self, cell: usize, face: usize, ends: [End; 2], a: [f64; 2], w: [f64; 2]) -> Part {
        let layout = self.oracle.layout;
        let horizon = Horizon::new(layout, face, self.normal);
        let source = &self.oracle.cells[cell];
        let sum = integrate(a, w, |a, w| {
            let [low, high] = ends.map(|end| match end {
                End::At(b) => b,
                End::Horizon => horizon.crossing(a),
            });
            let b = low + w * (high - low);
            let (dir, density) = direction(layout, face, a, b);
            let f_cos = self.model.cosine_weighted(self.wo, self.local_from_map * dir);
            let light = source.radiance(a, b);
            let area = density * (high - low);
            std::array::from_fn(|c| f_cos[c] * light[c] * area)
        });
        Part { cell, face, ends, a, w, sum }
    }

    fn halves(&self, part: &Part) -> [Part; 2] {
        let Part { cell, face, ends, a, w, ref sum } = *part;
        let (middle_a, middle_w) = (0.5 * (a[0] + a[1]), 0.5 * (w[0] + w[1]));
        if sum.axis == 0 {
            [[a[0], middle_a], [middle_a, a[1]]].map(|a| self.part(cell, face, ends, a, w))
        } else {
            [[w[0], middle_w], [middle_w, w[1]]].map(|w| self.part(cell, face, ends, a, w))
        }
    }
}

/// The sums over all parts: value and error.
fn totals(parts: &[Part]) -> ([f64; 3], [f64; 3]) {
    let (mut value, mut error) = ([0.0; 3], [0.0; 3]);
    for part in parts {
        for c in 0..3 {
            value[c] += part.sum.value[c];
            error[c] += part.sum.error[c];
        }
    }
    (value, error)
}
