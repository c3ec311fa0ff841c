//! Surfaces over the hemisphere of directions, seen from outside: what lies nearer hides what lies behind.

use brdf_sdk::Result;
use glam::DVec3;

use super::legend::{LEGEND, Pen, ROW, legend};
use super::panels::image;
use super::{Frame, colour, heading, picture, text};

/// A surface that goes out from the origin: rings of points, each closed.
#[derive(Debug, Clone)]
pub struct Surface {
    /// Its name in the legend.
    pub name: String,
    /// The number of its colour.
    pub pen: usize,
    /// Points of a ring.
    pub around: usize,
    /// Points, ring by ring, none further from the origin than 1; z is up.
    pub points: Vec<DVec3>,
}

/// A direction from the origin.
#[derive(Debug, Clone)]
pub struct Arrow<'a> {
    /// Where it goes: a unit vector.
    pub to: DVec3,
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
    /// More of that in a line below.
    pub detail: &'a str,
    /// Where they are seen from: azimuth and height [degrees].
    pub from: [f64; 2],
    /// The surfaces.
    pub surfaces: &'a [Surface],
    /// Directions to find one's way by.
    pub arrows: &'a [Arrow<'a>],
    /// Points over the surfaces, none further from the origin than 1.
    pub dots: &'a [DVec3],
}

const WIDTH: f64 = 600.0;
const RADIUS: f64 = 170.0;
/// How far from the origin the names of arrows stand [radii], and room for them above and below.
const NAMES: f64 = 1.1;
const MARGIN: f64 = 16.0;
/// Where titles and legends begin.
const LEFT: f64 = 16.0;
/// Pixels of the picture to a unit of the chart, and points to a side of a pixel, whose mean it has.
const PIXELS: usize = 2;
const POINTS: usize = 2;

impl Surfaces<'_> {
    /// The picture as an SVG element.
    ///
    /// # Errors
    /// Where a picture cannot be coded.
    pub fn svg(&self) -> Result<String> {
        // Surfaces are solid, and so are the samples of their colours.
        let solid = |index| Pen { dash: 0, thin: false, ..Pen::of(index) }.classes();
        let named: Vec<(&str, String)> = self
            .surfaces
            .iter()
            .map(|surface| (surface.name.as_str(), solid(surface.pen)))
            .collect();
        let (head, top) = heading(LEFT, self.title, self.detail);
        let (legend, rows) = legend(&named, [LEFT, WIDTH - LEFT], top + LEGEND);
        let below = top + LEGEND + ROW * (rows.max(1) - 1) as f64;
        let eye = Eye::new(self.from);
        let frame = Frame { at: [0.0, below], size: eye.size() };
        let mut inside = head + &legend + &eye.ground(below);
        let Raster { size, pixels } = self.raster(None);
        inside += &image(&frame, &pixels, size)?;
        for Label { at: [x, y], anchor, names } in eye.labels(self.arrows) {
            inside += &text([x, y + below + 4.0], anchor, &names);
        }
        Ok(picture("curves", self.title, [WIDTH, below + eye.size()[1]], &inside))
    }

    /// Surfaces and arrows alone, as pixels; with the unit circle of the surface where a colour is given.
    pub fn raster(&self, circle: Option<[u8; 3]>) -> Raster {
        let eye = Eye::new(self.from);
        let mut canvas = Canvas::new(eye.size());
        if let Some(colour) = circle {
            eye.draw_circle(colour, &mut canvas);
        }
        for surface in self.surfaces {
            eye.draw(surface, colour(surface.pen), &mut canvas);
        }
        self.arrows.iter().for_each(|arrow| eye.draw_arrow(arrow, &mut canvas));
        self.dots.iter().for_each(|dot| eye.draw_dot(*dot, &mut canvas));
        Raster { size: canvas.size.map(|side| side / POINTS), pixels: canvas.pixels() }
    }
}

/// A picture with transparency.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Red, green, blue and coverage of each pixel, row by row.
    pub pixels: Vec<u8>,
}

/// Names of arrows, and which side of them lies at a point.
struct Label {
    at: [f64; 2],
    anchor: &'static str,
    names: String,
}

/// Where a picture is seen from, without perspective.
struct Eye {
    right: DVec3,
    up: DVec3,
    towards: DVec3,
}

impl Eye {
    fn new([azimuth, height]: [f64; 2]) -> Self {
        let (sa, ca) = azimuth.to_radians().sin_cos();
        let (sh, ch) = height.to_radians().sin_cos();
        Self {
            right: DVec3::new(-sa, ca, 0.0),
            up: DVec3::new(-sh * ca, -sh * sa, ch),
            towards: DVec3::new(ch * ca, ch * sa, sh),
        }
    }

    /// The picture's size. A hemisphere always reaches a radius up, and down as far as its rim is seen from above.
    fn size(&self) -> [f64; 2] {
        let reach = NAMES * RADIUS * (1.0 + self.towards.z);
        [WIDTH, (reach + 2.0 * MARGIN).ceil()]
    }

    /// Where a point is drawn, and how near it is.
    fn place(&self, point: DVec3) -> [f64; 3] {
        let x = 0.5 * WIDTH + RADIUS * point.dot(self.right);
        let y = MARGIN + NAMES * RADIUS - RADIUS * point.dot(self.up);
        [x, y, point.dot(self.towards)]
    }

    /// The unit circle of the surface: from above, all of the hemisphere lies before it.
    fn ground(&self, below: f64) -> String {
        let points = (0..72).map(|i| {
            let (sine, cosine) = f64::from(5 * i).to_radians().sin_cos();
            let [x, y, _] = self.place(DVec3::new(cosine, sine, 0.0));
            format!("{x:.1} {:.1}", y + below)
        });
        let outline = points.collect::<Vec<_>>().join("L");
        format!("<path class=\"grid\" d=\"M{outline}Z\"/>")
    }

    /// Where the arrows' names stand; those that would lie on each other stand together, and an arrow that is seen
    /// from its point has none.
    fn labels(&self, arrows: &[Arrow<'_>]) -> Vec<Label> {
        const NEAR: [f64; 2] = [58.0, 14.0];
        let mut all: Vec<Label> = Vec::new();
        for arrow in arrows {
            let length = arrow.to.dot(self.right).hypot(arrow.to.dot(self.up));
            if length < 0.15 {
                continue;
            }
            let anchor = match arrow.to.dot(self.right) {
                -0.6..=0.6 => "middle",
                aside if aside < 0.0 => "end",
                _ => "start",
            };
            // Beside the arrow's end, and a little further out where a name stands in its way.
            let out = if anchor == "middle" { NAMES - 1.0 } else { 0.03 };
            let [x, y, _] = self.place(arrow.to * (1.0 + out / length));
            let near = |[a, b]: [f64; 2]| (a - x).abs() < NEAR[0] && (b - y).abs() < NEAR[1];
            match all.iter_mut().find(|label| near(label.at)) {
                Some(label) => label.names += &format!(", {}", arrow.name),
                None => all.push(Label { at: [x, y], anchor, names: arrow.name.to_owned() }),
            }
        }
        all
    }

    /// Draws the faces between the rings, lit from the left above the eye.
    fn draw(&self, surface: &Surface, base: [f64; 3], canvas: &mut Canvas) {
        let light = (self.towards + 0.5 * self.up - 0.6 * self.right).normalize();
        let rings = surface.points.len() / surface.around;
        let at = |ring: usize, step: usize| {
            surface.points[ring * surface.around + step % surface.around]
        };
        let faces = (0..rings.saturating_sub(1))
            .flat_map(|ring| (0..surface.around).map(move |step| (ring, step)));
        for (ring, step) in faces {
            let corners =
                [at(ring, step), at(ring, step + 1), at(ring + 1, step + 1), at(ring + 1, step)];
            let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
            // Both sides of a face are lit alike.
            let Some(lit) = normal.try_normalize().map(|normal| normal.dot(light).abs()) else {
                continue;
            };
            let shade = |c: f64| (255.0 * (0.25 + 0.75 * c) * (0.4 + 0.6 * lit)).round() as u8;
            let [a, b, c, d] = corners.map(|corner| self.place(corner));
            canvas.triangle([a, b, c], base.map(shade));
            canvas.triangle([a, c, d], base.map(shade));
        }
    }

    /// A dot with a rim, a little nearer than what it lies on.
    fn draw_dot(&self, dot: DVec3, canvas: &mut Canvas) {
        const NEARER: f64 = 4e-3;
        let [x, y, near] = self.place(dot);
        for (size, nearer, colour) in [(1.5, NEARER, [0; 3]), (0.9, 2.0 * NEARER, [255; 3])] {
            let at = |dx: f64, dy: f64| [x + size * dx, y + size * dy, near + nearer];
            let [left, above, right, below] =
                [at(-1.0, 0.0), at(0.0, -1.0), at(1.0, 0.0), at(0.0, 1.0)];
            canvas.triangle([left, above, right], colour);
            canvas.triangle([left, right, below], colour);
        }
    }

    /// The unit circle as a thin ring.
    fn draw_circle(&self, colour: [u8; 3], canvas: &mut Canvas) {
        const THIN: f64 = 0.992;
        let at = |step: u32, radius: f64| {
            let (sine, cosine) = f64::from(3 * step).to_radians().sin_cos();
            self.place(radius * DVec3::new(cosine, sine, 0.0))
        };
        for step in 0..120 {
            let [a, b] = [at(step, 1.0), at(step + 1, 1.0)];
            let [c, d] = [at(step, THIN), at(step + 1, THIN)];
            canvas.triangle([a, b, c], colour);
            canvas.triangle([b, d, c], colour);
        }
    }

    fn draw_arrow(&self, arrow: &Arrow<'_>, canvas: &mut Canvas) {
        // Half of a line's width, in units of the chart, and a little nearer than what it lies on.
        const HALF: f64 = 0.9;
        const NEARER: f64 = 4e-3;
        let ([x, y, _], [a, b, near]) = (self.place(DVec3::ZERO), self.place(arrow.to));
        let length = (a - x).hypot(b - y).max(1e-9);
        let [dx, dy] = [-(b - y) / length * HALF, (a - x) / length * HALF];
        let [from, to] = [NEARER, near + NEARER];
        let [one, other] = [[x + dx, y + dy, from], [x - dx, y - dy, from]];
        let [far, end] = [[a - dx, b - dy, to], [a + dx, b + dy, to]];
        canvas.triangle([one, other, far], arrow.colour);
        canvas.triangle([one, far, end], arrow.colour);
    }
}

/// Points of a picture, each with how near it is; none where nothing was drawn.
struct Canvas {
    size: [usize; 2],
    near: Vec<f32>,
    colours: Vec<[u8; 3]>,
}

impl Canvas {
    /// `size` is in units of the chart.
    fn new(size: [f64; 2]) -> Self {
        let size = size.map(|side| side as usize * PIXELS * POINTS);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// From the side the normal points up, and what lies nearer hides what lies behind, whichever is drawn first.
    #[test]
    fn what_lies_nearer_hides_what_lies_behind() {
        let eye = Eye::new([0.0, 0.0]);
        let [x, y, near] = eye.place(DVec3::new(0.25, 0.0, 1.0));
        assert!((x - 0.5 * WIDTH).abs() < 1e-9 && y > MARGIN && y < 0.2 * RADIUS + MARGIN);
        assert!((near - 0.25).abs() < 1e-9);
        let triangle = |near: f64| [[10.0, 10.0, near], [40.0, 10.0, near], [10.0, 40.0, near]];
        for order in [[0.1, 0.9], [0.9, 0.1]] {
            let mut canvas = Canvas::new([60.0, 60.0]);
            for near in order {
                canvas.triangle(triangle(near), [(100.0 * near) as u8; 3]);
            }
            let pixels = canvas.pixels();
            let at = |x: usize, y: usize| {
                let first = 4 * (PIXELS * y * 60 * PIXELS + PIXELS * x);
                [pixels[first], pixels[first + 3]]
            };
            assert_eq!([at(15, 15), at(38, 38), at(5, 15)], [[90, 255], [0, 0], [0, 0]]);
        }
    }

    /// Whatever the height of the eye, all of the ring and of the hemisphere lies in the picture, with its names.
    #[test]
    fn everything_lies_in_the_picture() {
        for height in [0.0, 20.0, 60.0, 90.0] {
            for azimuth in [0.0, 45.0, 180.0] {
                let eye = Eye::new([azimuth, height]);
                let [width, high] = eye.size();
                let axes = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y];
                // The longest names that come together: a grazing light's mirror direction and an axis.
                let names = ["tangent", "bitangent", "normal", "mirror", "wi"];
                let [x, y, z, ..] = axes;
                let arrows = std::iter::zip([x, y, z, y, x], names)
                    .map(|(to, name)| Arrow { to, colour: [0; 3], name })
                    .collect::<Vec<_>>();
                let ring = (0..360).map(|i| {
                    let (sine, cosine) = f64::from(i).to_radians().sin_cos();
                    DVec3::new(cosine, sine, 0.0)
                });
                for [x, y, _] in ring.chain(axes).map(|to| eye.place(to)) {
                    assert!((0.0..width).contains(&x) && (0.0..high).contains(&y), "{x} {y}");
                }
                for Label { at: [x, y], anchor, names } in eye.labels(&arrows) {
                    let length = 7.2 * names.chars().count() as f64;
                    let [before, behind] = match anchor {
                        "start" => [0.0, length],
                        "end" => [length, 0.0],
                        _ => [0.5 * length; 2],
                    };
                    assert!(x - before > 0.0 && x + behind < width, "{x} {names}");
                    assert!(y > 8.0 && y + 4.0 < high, "{y} {names}");
                }
            }
        }
    }
}
