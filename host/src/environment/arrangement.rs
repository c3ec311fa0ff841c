//! How six faces stand in a picture, and how they come into a cube's order and back.
//!
//! Pictures of cubes (crosses, strips, six files) name their faces by the OpenGL convention: px is what is seen
//! to the right of pz, py above it, each picture upright and readable as seen from the inside. OpenGL's own
//! table gives px the side of +x, where the right of +z is in a left-handed world. This world is
//! right-handed: looking to +z with +y up, the right is -x. So the pictures keep their sides and ±y and ±z their
//! names, and px is seen at -x, nx at +x: pz is the middle, px the right half of a lat-long map, and nothing is
//! mirrored. OpenEXR's cubes are right-handed themselves and keep all names. BRDF Explorer looked its
//! probes up by OpenGL's table, so `ptex` fills the cube's faces as they are.

use super::{Arrangement, MAX_FACE, MAX_SIZE};
use brdf_sdk::{Problem, Result};

/// The shapes that a map may have, for messages.
const SHAPES: &str = "give a lat-long panorama (2:1), a cross of six faces (4:3 or 3:4), a row or a \
                      column of them (6:1 or 1:6), or six square files named with a % (probe_%.hdr)";

/// Where a face of a cube stands in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Stand {
    /// Column and row, in faces.
    cell: (usize, usize),
    /// Whether it is turned over left to right.
    flip_s: bool,
    /// Whether it is turned over top to bottom.
    flip_t: bool,
}

/// The arrangement that pictures of this shape have; none for squares and all other shapes.
pub fn of_shape(width: u64, height: u64) -> Option<Arrangement> {
    [
        Arrangement::LatLong,
        Arrangement::CrossH,
        Arrangement::CrossV,
        Arrangement::StripRow,
        Arrangement::StripCol,
    ]
    .into_iter()
    .find(|arrangement| fits(*arrangement, width, height))
}

/// Whether a picture of this size can be arranged so.
pub fn fits(arrangement: Arrangement, width: u64, height: u64) -> bool {
    let (across, down) = cells(arrangement);
    width > 0
        && width.is_multiple_of(across)
        && height.checked_mul(across).is_some_and(|scaled| scaled == width.saturating_mul(down))
}

/// Faces side by side and one below the other; for a lat-long map its proportions.
fn cells(arrangement: Arrangement) -> (u64, u64) {
    match arrangement {
        Arrangement::LatLong | Arrangement::OpenExrLatLong => (2, 1),
        Arrangement::CrossH => (4, 3),
        Arrangement::CrossV => (3, 4),
        Arrangement::StripRow => (6, 1),
        Arrangement::StripCol | Arrangement::OpenExrCube => (1, 6),
    }
}

/// Refuses sizes that are neither a map nor a single face, or too large; called before anything is allocated.
pub fn check_size(name: &str, width: u64, height: u64) -> Result<(u32, u32)> {
    let shown = format!("the picture is {width}x{height}");
    let shape = of_shape(width, height);
    if width == 0 || (shape.is_none() && width != height) {
        return Err(Problem::new(name, format!("{shown}, which is no shape of a map"), SHAPES));
    }
    let (most, what) = match shape {
        Some(Arrangement::LatLong) => (u64::from(MAX_SIZE.0), "map is"),
        Some(arrangement) => (u64::from(MAX_FACE) * cells(arrangement).0, "cube has faces of"),
        None => (u64::from(MAX_FACE), "face is"),
    };
    match (u32::try_from(width), u32::try_from(height)) {
        (Ok(columns), Ok(rows)) if width <= most => Ok((columns, rows)),
        _ => {
            let (wide, high) = match shape {
                Some(Arrangement::LatLong) => MAX_SIZE,
                _ => (MAX_FACE, MAX_FACE),
            };
            let reason = format!("{shown}, the largest {what} {wide}x{high}");
            Err(Problem::new(name, reason, "give a smaller one"))
        }
    }
}

/// How a picture is to be read: as asked, as its file says, or as its shape says.
pub fn settle(
    name: &str,
    size: (u32, u32),
    declared: Option<Arrangement>,
    asked: Option<Arrangement>,
) -> Result<Arrangement> {
    let (width, height) = (u64::from(size.0), u64::from(size.1));
    let Some(arrangement) = asked.or(declared).or_else(|| of_shape(width, height)) else {
        return Err(Problem::new(
            name,
            format!("the picture is {width}x{height}, a single face of a cube"),
            SHAPES,
        ));
    };
    if !fits(arrangement, width, height) {
        let (across, down) = cells(arrangement);
        let whose = if asked.is_some() { "was asked for" } else { "its `envmap` attribute says" };
        return Err(Problem::new(
            name,
            format!(
                "the picture is {width}x{height}, and {}, as {whose}, is {across}:{down}",
                crate::layout::word(&arrangement)
            ),
            "leave the layout to the picture's shape, or give a picture of that shape",
        ));
    }
    Ok(arrangement)
}

/// The side of a face in a picture of this width.
pub fn side(arrangement: Arrangement, width: u32) -> u32 {
    width / cells(arrangement).0 as u32
}

/// The six stands, in the cube's order; none for lat-long maps.
fn stands(arrangement: Arrangement) -> Option<[Stand; 6]> {
    // Turned over left to right, all of them, and with px and nx changing sides: x negated.
    let seen = |cells: [(usize, usize); 6]| {
        let [px, nx, py, ny, pz, nz] = cells;
        [nx, px, py, ny, pz, nz].map(|cell| Stand { cell, flip_s: true, flip_t: false })
    };
    match arrangement {
        Arrangement::LatLong | Arrangement::OpenExrLatLong => None,
        Arrangement::StripRow => Some(seen([0, 1, 2, 3, 4, 5].map(|face| (face, 0)))),
        Arrangement::StripCol => Some(seen([0, 1, 2, 3, 4, 5].map(|face| (0, face)))),
        Arrangement::CrossH => Some(seen([(2, 1), (0, 1), (1, 0), (1, 2), (1, 1), (3, 1)])),
        Arrangement::CrossV => {
            let mut stands = seen([(2, 1), (0, 1), (1, 0), (1, 2), (1, 1), (1, 3)]);
            // On its head: half a turn more.
            stands[5] = Stand { cell: (1, 3), flip_s: false, flip_t: true };
            Some(stands)
        }
        // ImfEnvmap.h: seen from the inside, the right of +X is +z, of -X -z, of +Z -x, of -Z +x; the right
        // of ±Y is +x, and down is -z on +Y, +z on -Y. On the cube each of these points the other way,
        // but for the right of ±Y.
        Arrangement::OpenExrCube => Some([0, 1, 2, 3, 4, 5].map(|face| {
            let polar = face == 2 || face == 3;
            Stand { cell: (0, face), flip_s: !polar, flip_t: polar }
        })),
    }
}

/// The faces of a picture in the cube's order, one below the other; pictures of lat-long maps stay as they are.
pub fn unpack(texels: Vec<[f32; 4]>, width: u32, arrangement: Arrangement) -> Vec<[f32; 4]> {
    let Some(stands) = stands(arrangement) else { return texels };
    let width = width as usize;
    let side = width / cells(arrangement).0 as usize;
    let mut cube = Vec::with_capacity(6 * side * side);
    for stand in stands {
        for row in 0..side {
            for column in 0..side {
                let (x, y) = stand.place(side, column, row);
                cube.push(texels[y * width + x]);
            }
        }
    }
    cube
}

/// Width, height and texels of a cube as a picture; what no face covers is black.
pub fn pack(cube: &[[f32; 4]], side: u32, arrangement: Arrangement) -> (u32, u32, Vec<[f32; 4]>) {
    let (across, down) = cells(arrangement);
    let (width, height) = (side * across as u32, side * down as u32);
    let side = side as usize;
    let mut texels = vec![[0.0; 4]; width as usize * height as usize];
    for (face, stand) in stands(arrangement).into_iter().flatten().enumerate() {
        for row in 0..side {
            for column in 0..side {
                let (x, y) = stand.place(side, column, row);
                texels[y * width as usize + x] = cube[(face * side + row) * side + column];
            }
        }
    }
    (width, height, texels)
}

impl Stand {
    /// The picture's texel for a texel of the face.
    fn place(self, side: usize, column: usize, row: usize) -> (usize, usize) {
        let x = if self.flip_s { side - 1 - column } else { column };
        let y = if self.flip_t { side - 1 - row } else { row };
        (self.cell.0 * side + x, self.cell.1 * side + y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::cube::direction_of;

    /// Each texel of a cube named by its direction, as a picture.
    fn picture(side: u32, arrangement: Arrangement) -> impl Fn(usize, usize) -> [f32; 3] {
        let mut cube = Vec::new();
        for face in 0..6 {
            for row in 0..side {
                for column in 0..side {
                    let at = |i: u32| (2.0 * f64::from(i) + 1.0) / f64::from(side) - 1.0;
                    let d = direction_of(face, at(column), at(row)).as_vec3();
                    cube.push([d.x, d.y, d.z, 1.0]);
                }
            }
        }
        let (width, _, texels) = pack(&cube, side, arrangement);
        assert_eq!(unpack(texels.clone(), width, arrangement), cube, "{arrangement:?}");
        move |x, y| {
            let [a, b, c, _] = texels[y * width as usize + x];
            [a, b, c]
        }
    }

    /// Derived by hand: standing inside, looking to +z, the right is -x and up is +y.
    #[test]
    fn pictures_are_seen_from_the_inside() {
        // Three texels a side: the middle one of a face is its axis, its neighbours are 2/3 off.
        let off = 2.0 / 3.0;
        let strip = picture(3, Arrangement::StripRow);
        // px, nx, py, ny, pz, nz: px stands to the right of pz, which is -x.
        assert_eq!(strip(1, 1), [-1.0, 0.0, 0.0]);
        assert_eq!(strip(4, 1), [1.0, 0.0, 0.0]);
        assert_eq!(strip(7, 1), [0.0, 1.0, 0.0]);
        assert_eq!(strip(13, 1), [0.0, 0.0, 1.0]);
        // The right end of pz leads over to px, its top to py.
        assert_eq!(strip(14, 1), [-off as f32, 0.0, 1.0]);
        assert_eq!(strip(13, 0), [0.0, off as f32, 1.0]);
        // Looking to -x the right is -z; looking up with +z below, the right stays -x.
        assert_eq!(strip(2, 1), [-1.0, 0.0, -off as f32]);
        assert_eq!(strip(8, 1), [-off as f32, 1.0, 0.0]);
        assert_eq!(strip(7, 2), [0.0, 1.0, off as f32]);

        // ImfEnvmap.h's picture of +X: its right is +z, its down -y; of +Y: right +x, down -z.
        let openexr = picture(3, Arrangement::OpenExrCube);
        assert_eq!(openexr(2, 1), [1.0, 0.0, off as f32]);
        assert_eq!(openexr(1, 2), [1.0, -off as f32, 0.0]);
        assert_eq!(openexr(2, 4), [-1.0, 0.0, -off as f32]);
        assert_eq!(openexr(2, 7), [off as f32, 1.0, 0.0]);
        assert_eq!(openexr(1, 8), [0.0, 1.0, -off as f32]);
        assert_eq!(openexr(1, 11), [0.0, -1.0, off as f32]);
        assert_eq!(openexr(2, 13), [-off as f32, 0.0, 1.0]);
        assert_eq!(openexr(2, 16), [off as f32, 0.0, -1.0]);
    }

    /// Across the seams inside a cross the sphere goes on: neighbours there are as near as inside a face.
    #[test]
    fn crosses_have_no_seams() {
        let side = 16;
        let inside =
            |cells: &[(usize, usize)], x: usize, y: usize| cells.contains(&(x / side, y / side));
        let middle = [(0, 1), (1, 1), (2, 1), (1, 0), (1, 2)];
        for (arrangement, last) in [(Arrangement::CrossH, (3, 1)), (Arrangement::CrossV, (1, 3))] {
            let cells = [&middle[..], &[last]].concat();
            let at = picture(side as u32, arrangement);
            let mut seams = 0;
            for y in 0..4 * side - 1 {
                for x in 0..4 * side - 1 {
                    for (nx, ny) in [(x + 1, y), (x, y + 1)] {
                        if !inside(&cells, x, y) || !inside(&cells, nx, ny) {
                            continue;
                        }
                        seams += usize::from((x / side, y / side) != (nx / side, ny / side));
                        let (a, b) = (at(x, y), at(nx, ny));
                        let distance: f32 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
                        assert!(distance.sqrt() < 2.01 / side as f32, "{arrangement:?} {x} {y}");
                    }
                }
            }
            assert_eq!(seams, 5 * side, "{arrangement:?}");
        }
    }

    #[test]
    fn shapes_are_told_apart_and_bounded() {
        for (size, expected) in [
            ((2, 1), Some(Arrangement::LatLong)),
            ((8, 6), Some(Arrangement::CrossH)),
            ((6, 8), Some(Arrangement::CrossV)),
            ((6, 1), Some(Arrangement::StripRow)),
            ((3, 18), Some(Arrangement::StripCol)),
            ((5, 5), None),
            ((7, 5), None),
            ((0, 0), None),
            ((u64::MAX, u64::MAX / 2), None),
        ] {
            assert_eq!(of_shape(size.0, size.1), expected, "{size:?}");
        }
        let told = |width, height| check_size("m", width, height).unwrap_err().to_string();
        assert!(told(30, 10).starts_with("m: the picture is 30x10, which is no shape of a map; "));
        assert!(told(0, 0).contains("no shape"));
        assert!(told(65_536, 32_768).contains("the largest map is 32768x16384"));
        assert!(told(5462, 6 * 5462).contains("the largest cube has faces of 5461x5461"));
        assert!(told(5462, 5462).contains("the largest face is 5461x5461"));
        assert!(told(1 << 40, 1 << 39).contains("the largest map"));
        assert_eq!(check_size("m", 4 * 5461, 3 * 5461).unwrap(), (21_844, 16_383));
    }
}
