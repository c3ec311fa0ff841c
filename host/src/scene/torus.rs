//! The torus, hit exactly: its quartic, solved by isolating every root.
//!
//! Depends on its siblings and glam. Sphere tracing is deliberately absent: near a grazing ray its
//! steps shrink with the square of the distance, so that it either leaks or never ends.

use glam::DVec3;

use super::camera::Ray;
use super::frame::Hit;
use super::shape::{Chord, chord};

/// Radius of the ring.
const MAJOR: f64 = 0.7;
/// Radius of the tube.
const MINOR: f64 = 0.3;

/// First hit with the torus: the ring's tangent, the tube's normal.
pub(super) fn intersect(ray: &Ray) -> Option<Hit> {
    let point = hit_point(ray)?;
    let outward = DVec3::new(point.x, point.y, 0.0).normalize();
    let geometric = (point - MAJOR * outward).normalize();
    Some(Hit { geometric, shading: None, tangent: DVec3::Z.cross(outward) })
}

/// Where the ray first meets the torus.
///
/// With p(s) = middle + s dir and middle orthogonal to dir, the implicit equation
/// (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2) is a quartic in s without a cubic term. The roots of
/// its second derivative split the chord into stretches where the first is monotone, and that one's
/// roots into stretches where the quartic is; a change of sign then is one root, and no root hides.
fn hit_point(ray: &Ray) -> Option<DVec3> {
    // The torus touches the unit sphere: a chord of exactly that sphere could start on the surface
    // already, with a sign left to rounding.
    let Chord { middle, start, half } = chord(ray, MAJOR + MINOR + 1e-3)?;
    let (m, d) = (middle.truncate(), ray.dir.truncate());
    let k = middle.length_squared() + MAJOR * MAJOR - MINOR * MINOR;
    let ring = 4.0 * MAJOR * MAJOR;
    let c2 = 2.0 * k - ring * d.length_squared();
    let c1 = -2.0 * ring * m.dot(d);
    let c0 = k * k - ring * m.length_squared();
    let quartic = |s: f64| ((s * s + c2) * s + c1) * s + c0;
    let slope = |s: f64| (4.0 * s * s + 2.0 * c2) * s + c1;

    let (from, to) = (start.max(-half), half);
    let bend = (-c2 / 6.0).max(0.0).sqrt();
    let bends = [from, (-bend).clamp(from, to), bend.clamp(from, to), to];
    let turn = |i: usize| root(slope, bends[i], bends[i + 1]).unwrap_or(bends[i + 1]);
    let turns = [from, turn(0), turn(1), turn(2), to];
    let s = turns.windows(2).find_map(|ends| root(quartic, ends[0], ends[1]))?;
    Some(middle + s * ray.dir)
}

/// The root of a monotone function in [a, b] if it changes sign there: regula falsi where it
/// converges (Illinois' variant), to the last digit.
fn root(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> Option<f64> {
    let (mut fa, mut fb) = (f(a), f(b));
    if fa == 0.0 {
        return Some(a);
    }
    if fa * fb > 0.0 {
        return None;
    }
    for step in 0..200 {
        // Every third step bisects, which bounds the number of steps whatever the function.
        let chord = (a * fb - b * fa) / (fb - fa);
        let middle = 0.5 * (a + b);
        let inside = chord > a && chord < b;
        let s = if step % 3 == 2 || !inside { middle } else { chord };
        if middle <= a || middle >= b {
            break;
        }
        let fs = f(s);
        if fs == 0.0 {
            return Some(s);
        }
        if fs * fa > 0.0 {
            (a, fa) = (s, fs);
            fb *= 0.5;
        } else {
            (b, fb) = (s, fs);
            fa *= 0.5;
        }
    }
    Some(0.5 * (a + b))
}

#[cfg(test)]
mod tests {
    use super::super::camera::Camera;
    use super::*;

    /// Distance to the torus, negative inside: exact, and unlike the quartic.
    fn distance(p: DVec3) -> f64 {
        (p.truncate().length() - MAJOR).hypot(p.z) - MINOR
    }

    #[test]
    fn every_hit_lies_on_the_torus_and_every_miss_stays_off_it() {
        let size = 160;
        for (yaw, pitch) in [(0.0, 0.0), (35.0, 50.0), (90.0, 0.0), (80.0, 3.0), (0.0, 90.0)] {
            let camera = Camera { yaw, pitch, ..Camera::default() };
            for pixel in 0..size * size {
                let ray = camera.ray([size, size], pixel % size, pixel / size);
                // March in small steps with the distance function as judge: 1-Lipschitz, so a step
                // of its value never jumps over the surface.
                let end = match hit_point(&ray) {
                    Some(point) => {
                        assert!(distance(point).abs() < 1e-9, "{point}");
                        (point - ray.origin).length() - 1e-5
                    }
                    None => 6.0,
                };
                let mut t = 3.0;
                while t < end {
                    let gap = distance(ray.origin + t * ray.dir);
                    assert!(gap > -1e-9, "passed through the surface at {t} of {end}");
                    t += gap.max(1e-3);
                }
            }
        }
    }

    #[test]
    fn grazing_rays_hit_just_inside_the_silhouette_and_miss_just_outside() {
        // Edge-on along -x above the tube's top, z = 0.3: the line touches at x = +-0.7.
        for (offset, hits) in [(-1e-12, true), (-1e-6, true), (1e-12, false), (1e-6, false)] {
            let origin = DVec3::new(5.0, 0.0, 0.3 + offset);
            let hit = hit_point(&Ray { origin, dir: -DVec3::X });
            assert_eq!(hit.is_some(), hits, "{offset}");
            if let Some(point) = hit {
                assert!((point.x - 0.7).abs() < 2e-3, "the near tube first: {point}");
            }
        }
        // Through the hole along the axis: a miss; into the ring: the top of the tube.
        let down = |x| Ray { origin: DVec3::new(x, 0.0, 5.0), dir: -DVec3::Z };
        assert!(hit_point(&down(0.0)).is_none());
        assert!(hit_point(&down(0.4 - 1e-9)).is_none());
        let hit = intersect(&down(0.7)).unwrap();
        assert!((hit.geometric - DVec3::Z).length() < 1e-12);
        assert!((hit.tangent - DVec3::Y).length() < 1e-12, "counter-clockwise about +z");
    }

    #[test]
    fn an_eye_inside_the_tube_sees_its_wall() {
        let ray = Ray { origin: DVec3::new(0.7, 0.0, 0.0), dir: DVec3::X };
        assert!((hit_point(&ray).unwrap() - DVec3::X).length() < 1e-12);
    }
}
