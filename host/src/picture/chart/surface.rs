//! Surfaces over the hemisphere of directions, seen from outside: what lies nearer hides what lies behind.

use brdf_sdk::Result;

use super::curves::{ROW, legend};
use super::panels::image;
use super::{Frame, colour, picture, text, title};

/// A surface that goes out from the origin: rings of points, each closed.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Its name in the legend.
    pub name: String,
    /// Points of a ring.
    pub around: usize,
    /// Points, ring by ring, none further from the origin than 1; z is up.
    pub points: Vec<[f64; 3]>,
}

/// A direction from the origin.
#[derive(Debug, Clone)]
pub struct Arrow<'a> {
    /// Where it goes.
    pub to: [f64; 3],
    /// Its colour.
    pub colour: [u8; 3],
    /// What it is.
    pub name: &'a str,
}

/// Surfaces in one picture.
#[derive(Debug, Clone)]
pub struct Surfaces<'a> {
    /// What they show.
    pub title: &'a str,
    /// Where they are seen from: azimuth and height [degrees].
    pub from: [f64; 2],
    /// The surfaces.
    pub surfaces: &'a [Surface],
    /// Directions to find one's way by.
    pub arrows: &'a [Arrow<'a>],
}

const SIZE: [f64; 2] = [440.0, 340.0];
const CENTRE: [f64; 2] = [220.0, 250.0];
const RADIUS: f64 = 180.0;
/// Pixels of the picture to a unit of the chart, and points to a side of a pixel, whose mean it has.
const PIXELS: usize = 2;
const POINTS: usize = 2;

impl Surfaces<'_> {
    /// The picture as an SVG element.
    ///
    /// # Errors
    /// Where a picture cannot be coded.
    pub fn svg(&self) -> Result<String> {
        let names: Vec<&str> = self.surfaces.iter().map(|surface| surface.name.as_str()).collect();
        let (legend, rows) = legend(&names, 16.0, SIZE[0] - 10.0);
        let below = ROW * (rows.max(1) - 1) as f64;
        let frame = Frame { at: [0.0, below], size: SIZE };
        let eye = Eye::new(self.from);
        let mut canvas = Canvas::new();
        for (index, surface) in self.surfaces.iter().enumerate() {
            eye.draw(surface, colour(index), &mut canvas);
        }
        self.arrows.iter().for_each(|arrow| eye.draw_arrow(arrow, &mut canvas));
        let mut inside = title([16.0, 15.0], self.title) + &eye.ground(below);
        inside += &image(&frame, &canvas.pixels(), SIZE.map(|side| side as usize * PIXELS))?;
        inside += &legend;
        for arrow in self.arrows {
            let [x, y, _] = eye.place(arrow.to.map(|c| 1.1 * c));
            inside += &text([x, y + below + 4.0], "middle", arrow.name);
        }
        Ok(picture("curves", self.title, [SIZE[0], SIZE[1] + below], &inside))
    }
}

/// Where a picture is seen from, without perspective.
struct Eye {
    right: [f64; 3],
    up: [f64; 3],
    towards: [f64; 3],
}

impl Eye {
    fn new([azimuth, height]: [f64; 2]) -> Self {
        let (sa, ca) = azimuth.to_radians().sin_cos();
        let (sh, ch) = height.to_radians().sin_cos();
        Self {
            right: [-sa, ca, 0.0],
            up: [-sh * ca, -sh * sa, ch],
            towards: [ch * ca, ch * sa, sh],
        }
    }

    /// Where a point is drawn, and how near it is.
    fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y] = [dot(point, self.right), dot(point, self.up)];
        [CENTRE[0] + RADIUS * x, CENTRE[1] - RADIUS * y, dot(point, self.towards)]
    }

    /// The unit circle of the surface: from above, all of the hemisphere lies before it.
    fn ground(&self, below: f64) -> String {
        let points = (0..72).map(|i| {
            let (sine, cosine) = f64::from(5 * i).to_radians().sin_cos();
            let [x, y, _] = self.place([cosine, sine, 0.0]);
            format!("{x:.1} {:.1}", y + below)
        });
        let outline = points.collect::<Vec<_>>().join("L");
        format!("<path class=\"grid\" d=\"M{outline}Z\"/>")
    }

    /// Draws the faces between the rings, lit from the left above the eye.
    fn draw(&self, surface: &Surface, base: [f64; 3], canvas: &mut Canvas) {
        let light = [0, 1, 2].map(|i| self.towards[i] + 0.5 * self.up[i] - 0.6 * self.right[i]);
        let light = normalised(light);
        let rings = surface.points.len() / surface.around;
        let at = |ring: usize, step: usize| {
            surface.points[ring * surface.around + step % surface.around]
        };
        let faces = (0..rings.saturating_sub(1))
            .flat_map(|ring| (0..surface.around).map(move |step| (ring, step)));
        for (ring, step) in faces {
            let corners =
                [at(ring, step), at(ring, step + 1), at(ring + 1, step + 1), at(ring + 1, step)];
            let [one, other] = [[2, 0], [3, 1]]
                .map(|[to, from]| [0, 1, 2].map(|i| corners[to][i] - corners[from][i]));
            let normal = cross(one, other);
            if dot(normal, normal) == 0.0 {
                continue;
            }
            // Both sides of a face are lit alike.
            let lit = dot(normalised(normal), light).abs();
            let shade = |c: f64| (255.0 * (0.25 + 0.75 * c) * (0.4 + 0.6 * lit)).round() as u8;
            let [a, b, c, d] = corners.map(|corner| self.place(corner));
            canvas.triangle([a, b, c], base.map(shade));
            canvas.triangle([a, c, d], base.map(shade));
        }
    }

    fn draw_arrow(&self, arrow: &Arrow<'_>, canvas: &mut Canvas) {
        // Half of a line's width, in units of the chart, and a little nearer than what it lies on.
        const HALF: f64 = 0.9;
        const NEARER: f64 = 4e-3;
        let ([x, y, _], [a, b, near]) = (self.place([0.0; 3]), self.place(arrow.to));
        let length = (a - x).hypot(b - y).max(1e-9);
        let [dx, dy] = [-(b - y) / length * HALF, (a - x) / length * HALF];
        let from = NEARER;
        let to = near + NEARER;
        let corners = [
            [x + dx, y + dy, from],
            [x - dx, y - dy, from],
            [a - dx, b - dy, to],
            [a + dx, b + dy, to],
        ];
        canvas.triangle([corners[0], corners[1], corners[2]], arrow.colour);
        canvas.triangle([corners[0], corners[2], corners[3]], arrow.colour);
    }
}

/// Points of a picture, each with how near it is; none where nothing was drawn.
struct Canvas {
    size: [usize; 2],
    near: Vec<f32>,
    colours: Vec<[u8; 3]>,
}

impl Canvas {
    fn new() -> Self {
        let size = SIZE.map(|side| side as usize * PIXELS * POINTS);
        let count = size[0] * size[1];
        Self { size, near: vec![f32::NEG_INFINITY; count], colours: vec![[0; 3]; count] }
    }

    /// Draws a triangle wherever it is the nearest so far; corners in units of the chart, with their nearness.
    fn triangle(&mut self, corners: [[f64; 3]; 3], colour: [u8; 3]) {
        let scale = (PIXELS * POINTS) as f64;
        let [a, b, c] = corners.map(|[x, y, near]| [x * scale - 0.5, y * scale - 0.5, near]);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 {
            return;
        }
        let range = |axis: usize| {
            let sides = [a[axis], b[axis], c[axis]];
            let low = sides.iter().copied().fold(f64::INFINITY, f64::min).ceil().max(0.0);
            let high = sides.iter().copied().fold(0.0, f64::max).floor();
            low as usize..self.size[axis].min(high as usize + 1)
        };
        let (columns, rows) = (range(0), range(1));
        for (row, column) in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let (x, y) = (column as f64, row as f64);
            let of = |p: [f64; 3], q: [f64; 3]| {
                ((q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])) / area
            };
            let shares = [of(b, c), of(c, a), of(a, b)];
            // Seams are drawn from both sides.
            if shares.iter().any(|share| *share < -1e-9) {
                continue;
            }
            let near = (shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2]) as f32;
            let at = row * self.size[0] + column;
            if near > self.near[at] {
                (self.near[at], self.colours[at]) = (near, colour);
            }
        }
    }

    /// Red, green, blue and coverage of each pixel.
    fn pixels(&self) -> Vec<u8> {
        let [wide, high] = self.size.map(|side| side / POINTS);
        let mut pixels = Vec::with_capacity(4 * wide * high);
        for (row, column) in (0..high).flat_map(|row| (0..wide).map(move |column| (row, column))) {
            let points = (0..POINTS * POINTS)
                .map(|i| (row * POINTS + i / POINTS) * self.size[0] + column * POINTS + i % POINTS);
            let drawn: Vec<usize> =
                points.filter(|at| self.near[*at] > f32::NEG_INFINITY).collect();
            let mean = |c: usize| {
                let sum: usize = drawn.iter().map(|at| usize::from(self.colours[*at][c])).sum();
                (sum / drawn.len().max(1)) as u8
            };
            let coverage = (255 * drawn.len() / (POINTS * POINTS)) as u8;
            pixels.extend([mean(0), mean(1), mean(2), coverage]);
        }
        pixels
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normalised(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt();
    a.map(|c| c / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the side the normal points up, and what lies nearer hides what lies behind, whichever is drawn first.
    #[test]
    fn what_lies_nearer_hides_what_lies_behind() {
        let eye = Eye::new([0.0, 0.0]);
        let [x, y, near] = eye.place([0.25, 0.0, 1.0]);
        assert!((x - CENTRE[0]).abs() < 1e-9 && (y - (CENTRE[1] - RADIUS)).abs() < 1e-9);
        assert!((near - 0.25).abs() < 1e-9);
        let triangle = |near: f64| [[10.0, 10.0, near], [40.0, 10.0, near], [10.0, 40.0, near]];
        for order in [[0.1, 0.9], [0.9, 0.1]] {
            let mut canvas = Canvas::new();
            for near in order {
                canvas.triangle(triangle(near), [(100.0 * near) as u8; 3]);
            }
            let pixels = canvas.pixels();
            let at = |x: usize, y: usize| {
                let first = 4 * (PIXELS * y * SIZE[0] as usize * PIXELS + PIXELS * x);
                [pixels[first], pixels[first + 3]]
            };
            assert_eq!([at(15, 15), at(38, 38), at(5, 15)], [[90, 255], [0, 0], [0, 0]]);
        }
    }
}
