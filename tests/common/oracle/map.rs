//! Texels on the sphere, and the radiance of a direction straight from the definition.
//!
//! Lat-long: row 0 is +y, the middle looks to +z, u = 0.25 is +x. Cube: six faces, one below the
//! other, +x -x +y -y +z -z; s grows to the right and t downwards, both from -1 to 1.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// How texels lie on the sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// W columns of longitude, H rows of polar angle from +y.
    LatLong,
    /// N columns, 6 N rows.
    Cube,
}

/// Radiance between texel centres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// Constant on each texel.
    Nearest,
    /// Bilinear between texel centres.
    Linear,
}

/// A texel: column and row.
pub type Texel = (usize, usize);

/// Radiance in all directions, linear Rec. 709, in the map's own units.
#[derive(Debug, Clone)]
pub struct Map {
    pub layout: Layout,
    pub width: usize,
    pub height: usize,
    pub texels: Vec<[f64; 3]>,
}

/// The direction of (s, t) on a face, not normalised: its largest coordinate is 1.
pub fn on_face(face: usize, s: f64, t: f64) -> DVec3 {
    match face {
        0 => DVec3::new(1.0, -t, -s),
        1 => DVec3::new(-1.0, -t, s),
        2 => DVec3::new(s, 1.0, t),
        3 => DVec3::new(s, -1.0, -t),
        4 => DVec3::new(s, -t, 1.0),
        _ => DVec3::new(-s, -t, -1.0),
    }
}

/// The face that a direction falls on, with its s and t there.
pub fn face_of(d: DVec3) -> (usize, f64, f64) {
    let size = d.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    let face = 2 * axis + usize::from(d[axis] < 0.0);
    let p = d / size[axis];
    let (s, t) = match face {
        0 => (-p.z, -p.y),
        1 => (p.z, -p.y),
        2 => (p.x, p.z),
        3 => (p.x, -p.z),
        4 => (p.x, -p.y),
        _ => (-p.x, -p.y),
    };
    (face, s, t)
}

/// The direction of longitude position `u` and polar angle `theta` [radians].
pub fn on_lat_long(u: f64, theta: f64) -> DVec3 {
    let azimuth = TAU * (0.5 - u);
    DVec3::new(theta.sin() * azimuth.sin(), theta.cos(), theta.sin() * azimuth.cos())
}

pub fn mix(a: [f64; 3], b: [f64; 3], x: f64) -> [f64; 3] {
    std::array::from_fn(|c| a[c] * (1.0 - x) + b[c] * x)
}

pub fn mean(values: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|c| values.iter().map(|v| v[c]).sum::<f64>() / values.len() as f64)
}

impl Map {
    pub fn new(
        layout: Layout,
        width: usize,
        height: usize,
        texel: impl Fn(usize, usize) -> [f32; 3],
    ) -> Self {
        match layout {
            Layout::LatLong => assert!(width.is_multiple_of(2), "half a turn must be whole texels"),
            Layout::Cube => assert!(height == 6 * width),
        }
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let texels = places.map(|(x, y)| texel(x, y).map(f64::from)).collect();
        Self { layout, width, height, texels }
    }

    pub fn at(&self, (x, y): Texel) -> [f64; 3] {
        self.texels[y * self.width + x]
    }

    /// The texel that a direction falls into.
    pub fn texel_of(&self, d: DVec3) -> Texel {
        match self.layout {
            Layout::LatLong => {
                let u = (0.5 - d.x.atan2(d.z) / TAU).rem_euclid(1.0);
                let v = d.x.hypot(d.z).atan2(d.y) / PI;
                let place = |x: f64, size: usize| ((x * size as f64) as usize).min(size - 1);
                (place(u, self.width), place(v, self.height))
            }
            Layout::Cube => {
                let (face, s, t) = face_of(d);
                let n = self.width;
                let place = |x: f64| ((0.5 * (x + 1.0) * n as f64) as usize).min(n - 1);
                (place(s), face * n + place(t))
            }
        }
    }

    /// Radiance from the direction `d` (map space, any length).
    pub fn radiance(&self, d: DVec3, filter: Filter) -> [f64; 3] {
        if filter == Filter::Nearest {
            return self.at(self.texel_of(d));
        }
        // The position counted in texel centres: the four around it, and how far between them.
        let n = self.width as f64;
        let (face, x, y) = match self.layout {
            Layout::LatLong => {
                let u = 0.5 - d.x.atan2(d.z) / TAU;
                (0, u * n - 0.5, d.x.hypot(d.z).atan2(d.y) / PI * self.height as f64 - 0.5)
            }
            Layout::Cube => {
                let (face, s, t) = face_of(d);
                (face, 0.5 * (s + 1.0) * n - 0.5, 0.5 * (t + 1.0) * n - 0.5)
            }
        };
        let (left, top) = (x.floor(), y.floor());
        let value = |dx: i64, dy: i64| self.beyond(face, left as i64 + dx, top as i64 + dy);
        let upper = mix(value(0, 0), value(1, 0), x - left);
        mix(upper, mix(value(0, 1), value(1, 1), x - left), y - top)
    }

    /// The value that the linear filter finds at column `x` and row `y` of a face, which may lie
    /// one texel beyond the edge of the map or of the face.
    pub fn beyond(&self, face: usize, x: i64, y: i64) -> [f64; 3] {
        let (width, n) = (self.width as i64, self.width as i64);
        if self.layout == Layout::LatLong {
            // Beyond a pole lies the same row, half a turn away.
            let last = self.height as i64 - 1;
            let turn = if (0..=last).contains(&y) { 0 } else { width / 2 };
            let column = (x + turn).rem_euclid(width);
            return self.at((column as usize, y.clamp(0, last) as usize));
        }
        let inside = |i: i64| (0..n).contains(&i);
        if inside(x) && inside(y) {
            return self.at((x as usize, face * self.width + y as usize));
        }
        let (nearest_x, nearest_y) = (x.clamp(0, n - 1), y.clamp(0, n - 1));
        if !inside(x) && !inside(y) {
            let corner = [(nearest_x, nearest_y), (x, nearest_y), (nearest_x, y)];
            return mean(&corner.map(|(x, y)| self.beyond(face, x, y)));
        }
        // A step over the edge, along which the position is a texel's centre.
        let place =
            |i: i64| (2.0 * (i as f64 + 0.5) / n as f64 - 1.0).clamp(-1.0 - 1e-9, 1.0 + 1e-9);
        self.at(self.texel_of(on_face(face, place(x), place(y))))
    }

    /// The same layout with each texel replaced.
    pub fn with(&self, texel: impl Fn(usize, usize) -> [f32; 3]) -> Self {
        Self::new(self.layout, self.width, self.height, texel)
    }
}
