//! A teapot without a file: a turned body with a lid, a spout and a handle, which bend and overlap as a real pot does.
//!
//! The body turns a cubic B-spline about the y axis; spout and handle are tubes along Bezier curves in the xy-plane.
//! Tangents go around the axis, as a lathe does, and around the tubes. Parts reach into each other; nothing is cut.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::{Soup, is_degenerate};

/// Corners of the body's profile from the middle of the foot to the top of the knob: distance from the axis, height.
/// The curve lies inside of them and bends without a break.
const PROFILE: [[f64; 2]; 20] = [
    [0.0, 0.0],
    [0.3, 0.0],
    [0.62, -0.01],
    [0.67, 0.0],
    [0.68, 0.05],
    [0.9, 0.2],
    [1.06, 0.55],
    [0.95, 0.95],
    [0.74, 1.17],
    [0.73, 1.25],
    [0.68, 1.26],
    [0.66, 1.2],
    [0.6, 1.24],
    [0.38, 1.38],
    [0.1, 1.42],
    [0.04, 1.5],
    [0.17, 1.55],
    [0.17, 1.67],
    [0.07, 1.71],
    [0.0, 1.71],
];

/// A tube: the corners of its Bezier curve, its radius at both ends.
const SPOUT: ([[f64; 2]; 4], [f64; 2]) =
    ([[0.6, 0.42], [1.42, 0.42], [1.08, 1.02], [1.62, 1.2]], [0.27, 0.085]);
const HANDLE: ([[f64; 2]; 4], [f64; 2]) =
    ([[-0.72, 1.0], [-1.72, 1.28], [-1.62, 0.28], [-0.8, 0.3]], [0.075, 0.075]);

/// Steps of a stretch of the profile, of a turn about the axis, along a tube and around it.
const ALONG_STRETCH: usize = 6;
const AROUND_BODY: usize = 96;
const ALONG_TUBE: usize = 40;
const AROUND_TUBE: usize = 32;

/// Its surface; bottom at y = 0, y up, spout towards +x.
pub(super) fn teapot() -> Soup {
    let mut soup = Soup::default();
    let profile = profile();
    sheet(&mut soup, profile.len(), AROUND_BODY, |along, turn| {
        let [radius, height] = profile[along].to_array();
        let (sine, cosine) = turn.sin_cos();
        let place = DVec3::new(radius * cosine, height, -radius * sine);
        (place, DVec3::new(-sine, 0.0, -cosine))
    });
    for (corners, radii) in [SPOUT, HANDLE] {
        let corners = corners.map(DVec2::from);
        sheet(&mut soup, ALONG_TUBE + 1, AROUND_TUBE, |along, turn| {
            let t = along as f64 / ALONG_TUBE as f64;
            let (centre, direction) = bezier(corners, t);
            let across = DVec2::new(-direction.y, direction.x).extend(0.0);
            let radius = radii[0] + (radii[1] - radii[0]) * t;
            let (sine, cosine) = turn.sin_cos();
            let place = centre.extend(0.0) + radius * (cosine * across + sine * DVec3::Z);
            (place, cosine * DVec3::Z - sine * across)
        });
    }
    soup
}

/// Points of the profile, both ends on the axis.
fn profile() -> Vec<DVec2> {
    let inner = PROFILE.map(DVec2::from);
    let mirrored = |corner: DVec2| DVec2::new(-corner.x, corner.y);
    let [.., before_last, _] = inner;
    // Mirrored at the axis, so that the curve ends there, square to it.
    let corners: Vec<DVec2> =
        [mirrored(inner[1])].into_iter().chain(inner).chain([mirrored(before_last)]).collect();
    let mut points: Vec<DVec2> = Vec::new();
    for stretch in corners.windows(4) {
        let first = usize::from(!points.is_empty());
        points.extend((first..=ALONG_STRETCH).map(|step| {
            let t = step as f64 / ALONG_STRETCH as f64;
            let (t2, t3, s) = (t * t, t * t * t, 1.0 - t);
            let weights =
                [s * s * s, 3.0 * t3 - 6.0 * t2 + 4.0, -3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0, t3];
            std::iter::zip(stretch, weights)
                .map(|(corner, weight)| *corner * weight / 6.0)
                .sum::<DVec2>()
        }));
    }
    points
}

/// The point of a cubic Bezier curve, and its direction there.
fn bezier([a, b, c, d]: [DVec2; 4], t: f64) -> (DVec2, DVec2) {
    let (ab, bc, cd) = (a.lerp(b, t), b.lerp(c, t), c.lerp(d, t));
    let (abc, bcd) = (ab.lerp(bc, t), bc.lerp(cd, t));
    (abc.lerp(bcd, t), (bcd - abc).normalize())
}

/// Adds a sheet of rings, each of which closes; `at` gives place and tangent for a ring and a turn [radians].
fn sheet(soup: &mut Soup, rings: usize, around: usize, at: impl Fn(usize, f64) -> (DVec3, DVec3)) {
    let first = soup.positions.len();
    for ring in 0..rings {
        for step in 0..around {
            let (place, tangent) = at(ring, step as f64 / around as f64 * TAU);
            soup.positions.push(place);
            soup.tangents.push(tangent);
        }
    }
    let index = |ring: usize, step: usize| (first + ring * around + step % around) as u32;
    for (ring, step) in (1..rings).flat_map(|ring| (0..around).map(move |step| (ring, step))) {
        let [a, b] = [index(ring - 1, step), index(ring - 1, step + 1)];
        let [c, d] = [index(ring, step), index(ring, step + 1)];
        // A ring on the axis is one point: of two triangles one has an area.
        let is_whole = |triangle: &[u32; 3]| {
            !is_degenerate(triangle.map(|vertex| soup.positions[vertex as usize]))
        };
        soup.triangles.extend([[a, b, d], [a, d, c]].into_iter().filter(is_whole));
    }
    soup.normals.resize(soup.positions.len(), DVec3::ZERO);
    soup.uvs.resize(soup.positions.len(), DVec2::NAN);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_starts_and_ends_square_to_the_axis() {
        let points = profile();
        let [first, second, .., before_last, last] = points[..] else { panic!("{points:?}") };
        for (end, next) in [(first, second), (last, before_last)] {
            assert!(end.x.abs() < 1e-12, "{end}");
            let rise = (next - end).normalize();
            // The step from the axis falls by no more than its own square.
            assert!(rise.y.abs() < 0.05, "{rise}");
        }
        assert!(points.iter().all(|point| point.x > -1e-12));
    }

    #[test]
    fn the_whole_is_a_mesh_whose_parts_touch() {
        let Soup { positions, tangents, triangles, .. } = teapot();
        assert_eq!(positions.len(), tangents.len());
        assert!(tangents.iter().all(|tangent| (tangent.length() - 1.0).abs() < 1e-12));
        assert!(triangles.iter().flatten().all(|index| (*index as usize) < positions.len()));
        // Both ends of the handle and the spout's root lie inside the body: nearer to the axis than its profile there.
        let profile = profile();
        let inside = |[x, y]: [f64; 2]| {
            let mut sides = profile.windows(2).filter(|pair| pair[0].y <= y && y < pair[1].y);
            sides.any(|pair| x.abs() < pair[0].x.min(pair[1].x))
        };
        for end in [SPOUT.0[0], HANDLE.0[0], HANDLE.0[3]] {
            assert!(inside(end), "{end:?}");
        }
        assert!(!inside(SPOUT.0[3]));
    }
}
