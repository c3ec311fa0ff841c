//! Casting: one ray per pixel, in parallel over rows; covered pixels become shading points.
//!
//! Depends on its siblings and rayon. The result is the same whatever the number of threads.
//! Only primary hits: nothing here tests what a point sees or what shadows it.

use glam::DVec3;
use rayon::prelude::*;

use super::camera::Camera;
use super::frame::{ShadingPoint, lift, shading_point};
use super::shape::Shape;

/// The covered pixels of an image.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Coverage {
    /// One point per covered pixel, along Z curves in squares of 64 pixels; background pixels are absent.
    pub points: Vec<ShadingPoint>,
    /// Points whose interpolated normal turned the view below the horizon, and gave way to the
    /// geometric normal.
    pub bent: usize,
}

impl Coverage {
    /// World directions through the centres of the pixels that the object leaves free, in their
    /// order, for the camera and the resolution of [`cast`].
    pub fn rays_past(&self, camera: &Camera, resolution: [u32; 2]) -> Vec<[f32; 3]> {
        let [width, height] = resolution;
        let mut covered = vec![false; width as usize * height as usize];
        self.points.iter().for_each(|point| covered[point.pixel as usize] = true);
        (0..width * height)
            .filter(|pixel| !covered[*pixel as usize])
            .map(|pixel| {
                let ray = camera.ray(resolution, pixel % width, pixel / width);
                ray.dir.as_vec3().to_array()
            })
            .collect()
    }
}

/// Tiles of an image, and the pixels of each, so that pixels that follow each other lie near each other in both
/// directions: whatever number of them is worked on together sees much the same, and looks at much the same places of
/// maps and tables, which then are in the caches. Squares of 64 pixels come row by row, each along a Z (Morton 1966).
fn order([width, height]: [u32; 2]) -> Vec<impl Iterator<Item = [u32; 2]>> {
    const SQUARE: u32 = 64;
    const TILE: u32 = 16;
    let squares = |pixels: u32| pixels.div_ceil(SQUARE);
    let corners = (0..squares(height)).flat_map(move |row| {
        (0..squares(width)).map(move |column| [column * SQUARE, row * SQUARE])
    });
    let tiles = corners.flat_map(|[left, top]| {
        (0..(SQUARE / TILE).pow(2))
            .map(along_z)
            .map(move |[x, y]| [left + TILE * x, top + TILE * y])
    });
    tiles
        .map(|[left, top]| {
            let pixels = (0..TILE * TILE).map(along_z).map(move |[x, y]| [left + x, top + y]);
            pixels.filter(move |[x, y]| *x < width && *y < height)
        })
        .collect()
}

/// Column and row of a place along a Z curve: its even bits, and its odd ones. Eight bits of each at most.
fn along_z(place: u32) -> [u32; 2] {
    let of = |place: u32| (0..8).map(|bit| (place >> (2 * bit) & 1) << bit).sum();
    [of(place), of(place >> 1)]
}

/// Casts a ray through every pixel's centre and keeps what it hits first.
///
/// `resolution` is [width, height], with at most 2^32 pixels. A camera that fails
/// [`Camera::check`] covers no promised set of pixels, but does no harm.
pub fn cast(camera: &Camera, shape: &Shape, resolution: [u32; 2]) -> Coverage {
    let tiles: Vec<(Vec<ShadingPoint>, usize)> = order(resolution)
        .into_par_iter()
        .map(|tile| {
            let mut bent = 0;
            let points = tile
                .filter_map(|[x, y]| {
                    let ray = camera.ray(resolution, x, y);
                    let hit = shape.intersect(&ray)?;
                    let pixel = y.wrapping_mul(resolution[0]).wrapping_add(x);
                    let (point, gave_way) = shading_point(pixel, -ray.dir, &hit);
                    bent += usize::from(gave_way);
                    Some(point)
                })
                .collect();
            (points, bent)
        })
        .collect();
    let bent = tiles.iter().map(|(_, bent)| bent).sum();
    let points = tiles.into_iter().flat_map(|(points, _)| points).collect();
    Coverage { points, bent }
}

/// One point per local view direction, on a flat surface: tangent +x, normal +z, pixel = index.
///
/// Directions are made unit, and lifted to the horizon as in [`cast`].
pub fn flat_points(views: &[[f64; 3]]) -> Vec<ShadingPoint> {
    let point = |(pixel, view): (u32, &[f64; 3])| ShadingPoint {
        pixel,
        wo: lift(DVec3::from(*view).normalize_or(DVec3::Z)).as_vec3().to_array(),
        tangent: [1.0, 0.0, 0.0],
        normal: [0.0, 0.0, 1.0],
    };
    (0..).zip(views).map(point).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use glam::Vec3;

    use super::*;

    /// The world direction that a point's frame and `wo` stand for.
    fn world_view(point: &ShadingPoint) -> DVec3 {
        let [t, n, wo] = [point.tangent, point.normal, point.wo].map(|v| Vec3::from(v).as_dvec3());
        wo.x * t + wo.y * n.cross(t) + wo.z * n
    }

    #[test]
    fn the_sphere_covers_the_area_of_its_silhouette() {
        // The unit sphere at distance 4.5 is seen under the half-angle asin(1/4.5), which the image
        // plane shows as a disc of radius tan(asin(1/4.5)) / tan(15 deg), in half heights. Pixel
        // centres inside a disc of radius r pixels number pi r^2, with an error that Gauss bounded
        // by 2 sqrt(2) pi r and that in truth is of the order of sqrt(r): we grant 4 sqrt(r).
        let size = 512;
        let coverage = cast(&Camera::default(), &Shape::Sphere, [size, size]);
        let radius = (1.0_f64 / 4.5).asin().tan() / 15.0_f64.to_radians().tan();
        let r = radius * f64::from(size) / 2.0;
        let missed = (coverage.points.len() as f64 - PI * r * r).abs();
        assert!(missed < 4.0 * r.sqrt(), "off by {missed} pixels");
        assert_eq!(coverage.bent, 0);
    }

    /// Every pixel once, whatever the size; and of a row of points neighbours in both directions.
    #[test]
    fn points_that_follow_each_other_lie_near_each_other() {
        for size in [[1, 1], [5, 200], [64, 64], [130, 67], [0, 3]] {
            let mut pixels: Vec<_> = order(size).into_iter().flatten().collect();
            pixels.sort_unstable_by_key(|[x, y]| (*y, *x));
            let rows = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
            assert!(pixels.into_iter().eq(rows), "{size:?}");
        }
        let size = 512;
        let points = cast(&Camera::default(), &Shape::Sphere, [size, size]).points;
        let extents = points.chunks(256).map(|points| {
            let of = |axis: fn(u32) -> u32| {
                let places = points.iter().map(|point| axis(point.pixel));
                places.clone().max().unwrap_or(0) - places.min().unwrap_or(0)
            };
            of(|pixel| pixel % 512).max(of(|pixel| pixel / 512))
        });
        let extents: Vec<u32> = extents.collect();
        // A square of 256 pixels has 16 on a side; runs that begin inside of one reach into others, here to 36 in the
        // mean. Row by row it would be some 250.
        let mean = f64::from(extents.iter().sum::<u32>()) / extents.len() as f64;
        assert!(mean < 64.0, "{mean}");
    }

    #[test]
    fn wo_and_frame_give_back_the_view_direction_on_every_shape() {
        let camera = Camera { yaw: 25.0, pitch: 35.0, ..Camera::default() };
        let [width, height] = [96, 64];
        for shape in [Shape::Sphere, Shape::Torus, Shape::Plane] {
            let coverage = cast(&camera, &shape, [width, height]);
            assert!(coverage.points.len() > 500, "{shape:?}");
            for point in &coverage.points {
                let ray = camera.ray([width, height], point.pixel % width, point.pixel / width);
                // The lift at the silhouette turns by at most 1e-6; rounding adds about 2e-7.
                assert!((world_view(point) + ray.dir).length() < 1.5e-6, "{shape:?} {point:?}");
                assert!(point.wo[2] > 0.0);
                assert!((Vec3::from(point.wo).length() - 1.0).abs() < 1e-6);
                assert!(Vec3::from(point.tangent).dot(point.normal.into()).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_plane_from_behind_turns_its_normal_and_keeps_its_tangent() {
        let front = cast(&Camera::default(), &Shape::Plane, [64, 64]);
        let back = cast(&Camera { yaw: 180.0, ..Camera::default() }, &Shape::Plane, [64, 64]);
        // The square of half-side 1 at distance 4.5 covers 1 / (4.5 tan 15 deg) of the half height.
        let half = (64.0 * 0.5 / (4.5 * 15.0_f64.to_radians().tan())).round() as usize;
        assert_eq!(front.points.len(), 4 * half * half);
        assert_eq!(back.points.len(), front.points.len());
        for (point, z) in
            front.points.iter().map(|p| (p, 1.0)).chain(back.points.iter().map(|p| (p, -1.0)))
        {
            assert_eq!((point.normal, point.tangent), ([0.0, 0.0, z], [1.0, 0.0, 0.0]));
        }
    }

    #[test]
    fn flat_points_are_identity_frames() {
        let points = flat_points(&[[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [1.0, 0.0, 0.0]]);
        assert_eq!(points[1].wo, [0.6, 0.0, 0.8]);
        assert_eq!(points[2].pixel, 2);
        assert!(points[2].wo[2] > 0.0);
        assert_eq!((points[0].tangent, points[0].normal), ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]));
    }

    #[test]
    fn an_empty_image_and_an_absurd_camera_do_no_harm() {
        assert_eq!(cast(&Camera::default(), &Shape::Sphere, [0, 0]), Coverage::default());
        let absurd = Camera { yaw: f64::NAN, ..Camera::default() };
        for shape in [Shape::Sphere, Shape::Torus, Shape::Plane] {
            assert!(cast(&absurd, &shape, [4, 4]).points.is_empty());
        }
    }
}
