//! The oracle of tests/common/oracle is right: by closed forms, and by quadratures in other coordinates.

mod lobes;
#[path = "../common/oracle/mod.rs"]
mod oracle;
#[path = "../common/random.rs"]
mod random;

use std::f64::consts::{LN_2, PI, TAU};

use glam::{DMat3, DVec3};
use oracle::cells::{cells, direction};
use oracle::cubature::integrate;
use oracle::map::{on_face, on_lat_long};
use oracle::{Filter, Layout, Map, Model, Oracle, Point};
use random::Random;

const KINDS: [(Layout, Filter); 4] = [
    (Layout::LatLong, Filter::Nearest),
    (Layout::LatLong, Filter::Linear),
    (Layout::Cube, Filter::Nearest),
    (Layout::Cube, Filter::Linear),
];

/// A map with structure in every texel and channel: 16 x 8, or faces of 4 x 4.
fn structured(layout: Layout) -> Map {
    let texel = |x: usize, y: usize| {
        let hash = (x * 7 + y * 13 + x * y * 5) % 11;
        [0.1 + hash as f32, 1.0 + ((x + 2 * y) % 3) as f32, if hash == 4 { 30.0 } else { 0.5 }]
    };
    match layout {
        Layout::LatLong => Map::new(layout, 16, 8, texel),
        Layout::Cube => Map::new(layout, 4, 24, texel),
    }
}

/// A point whose normal and tangent are any, looked at under `theta` degrees from the normal.
fn point(random: &mut Random, theta: f64) -> Point {
    let normal = random.direction();
    let tangent = normal.any_orthonormal_vector();
    let (theta, phi) = (theta.to_radians(), TAU * random.unit());
    Point {
        wo: DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()),
        world_from_local: DMat3::from_cols(tangent, normal.cross(tangent), normal),
    }
}

fn near(found: [f64; 3], expected: [f64; 3], tolerance: f64, what: &str) {
    for c in 0..3 {
        let off = (found[c] - expected[c]).abs();
        assert!(off <= tolerance * expected[c].abs(), "{what}: {found:?} is not {expected:?}");
    }
}

/// The rule integrates every x^i y^j up to i + j = 7, the one that it is compared with up to 5, and
/// neither does more.
#[test]
fn the_rule_has_its_degree() {
    for degree in 0..10i32 {
        let (mut off, mut estimate) = (0.0f64, 0.0f64);
        for (i, j) in (0..=degree).map(|i| (i, degree - i)) {
            let sum = integrate([1.0, 3.0], [-2.0, 1.0], |x, y| [x.powi(i) * y.powi(j); 3]);
            let power =
                |from: f64, to: f64, n: i32| (to.powi(n + 1) - from.powi(n + 1)) / f64::from(n + 1);
            let expected = power(1.0, 3.0, i) * power(-2.0, 1.0, j);
            off = off.max((sum.value[0] - expected).abs() / expected.abs());
            estimate = estimate.max(sum.error[0] / expected.abs());
        }
        assert_eq!(off < 1e-12, degree <= 7, "degree {degree}: {off}");
        assert_eq!(estimate < 1e-12, degree <= 5, "degree {degree}: {estimate}");
    }
}

/// The pieces tile the sphere, and on each radiance is what its direction says.
#[test]
fn pieces_tile_the_sphere_with_the_maps_radiance() {
    let mut random = Random::new(1);
    for (layout, filter) in KINDS {
        let map = structured(layout);
        let mut area = 0.0;
        for cell in cells(&map, filter) {
            let rect = cell.rect;
            area += integrate(rect.a, rect.b, |a, b| [direction(layout, rect.face, a, b).1; 3])
                .value[0];
            for _ in 0..4 {
                let inside = |[from, to]: [f64; 2], x: f64| from + (0.01 + 0.98 * x) * (to - from);
                let (a, b) = (inside(rect.a, random.unit()), inside(rect.b, random.unit()));
                let (dir, _) = direction(layout, rect.face, a, b);
                near(cell.radiance(a, b), map.radiance(dir, filter), 1e-12, "a piece");
            }
        }
        // 17 points a piece leave 1e-8 of an area whose density is a sine or a power of r.
        assert!((area / (4.0 * PI) - 1.0).abs() < 1e-7, "{layout:?} {filter:?}: {area}");
    }
}

/// The linear filter is continuous everywhere, across the seam, the poles, edges and corners too.
/// Texels differ by up to 30 over 0.39 radians of longitude or polar angle: 0.02 radians beside a pole
/// a step of 2e-9 radians changes at most 30 / 0.39 / 0.02 * 2e-9 = 8e-6. At a pole itself every
/// longitude has a value of its own, and only the way straight across it is continuous.
#[test]
fn the_linear_filter_is_continuous() {
    let mut random = Random::new(2);
    let compare = |map: &Map, at: DVec3, step: DVec3| {
        let step = 1e-9 * step;
        let [a, b] = [at - step, at + step].map(|d| map.radiance(d, Filter::Linear));
        (0..3).all(|c| (a[c] - b[c]).abs() < 1e-5)
    };
    for layout in [Layout::LatLong, Layout::Cube] {
        let map = structured(layout);
        for _ in 0..2000 {
            let [x, y] = [random.unit(), random.unit()].map(|x| 2.0 * x - 1.0);
            // Anywhere, on the seam, on an edge and at a corner of faces.
            let corner = [x, y, x * y].map(f64::signum);
            let places = [
                random.direction(),
                DVec3::new(0.0, 0.9 * y, -1.0),
                DVec3::new(1.0, -1.0, y),
                DVec3::new(x, 1.0, 1.0),
                DVec3::new(-1.0, x, 1.0),
                DVec3::from(corner),
            ];
            for place in places {
                let step = random.direction();
                let beside_pole = place.x.hypot(place.z) < 0.02;
                assert!(
                    beside_pole || compare(&map, place, step),
                    "{layout:?} at {place} along {step}"
                );
            }
            let across = DVec3::new(x, 0.0, y);
            assert!(compare(&map, DVec3::Y, across) && compare(&map, DVec3::NEG_Y, across));
        }
    }
}

/// In the furnace Lambert reflects its albedo, whatever the layout, the filter, the normal: the
/// clamped cosine integrates to pi, so this is the horizon's test too.
#[test]
fn lambert_reflects_its_albedo_in_the_furnace() {
    let mut random = Random::new(3);
    let albedo = [0.5, 1.0, 0.1];
    for (layout, filter) in KINDS {
        let map = structured(layout).with(|_, _| [1.0; 3]);
        let oracle = Oracle::new(&map, filter, DMat3::IDENTITY);
        let mut normals: Vec<Point> = (0..40).map(|_| point(&mut random, 30.0)).collect();
        for (n, t) in [(DVec3::X, DVec3::Y), (DVec3::Y, DVec3::Z), (DVec3::NEG_Z, DVec3::X)] {
            normals
                .push(Point { wo: DVec3::Z, world_from_local: DMat3::from_cols(t, n.cross(t), n) });
        }
        for point in normals {
            let value = oracle.radiance(&point, &Model::Lambert { albedo }, 1e-8);
            near(value.radiance, albedo, 1e-8, "the furnace");
        }
    }
}

/// The irradiance of one lit cube texel is known in closed form: its sides are great circles.
/// Lambert's theorem (1760): E = 1/2 sum over the sides of angle * (side's plane . n), after the
/// polygon was clipped at the horizon.
#[test]
fn lambert_under_one_cube_texel_has_its_closed_form() {
    let mut random = Random::new(4);
    let (mut lit, mut cut) = (0, 0);
    for n in [1, 4] {
        for _ in 0..200 {
            let texel =
                ((random.unit() * n as f64) as usize, (random.unit() * 6.0 * n as f64) as usize);
            let map =
                Map::new(Layout::Cube, n, 6 * n, |x, y| [f32::from(u8::from((x, y) == texel)); 3]);
            let point = point(&mut random, 0.0);
            let normal = point.world_from_local.z_axis;
            let line = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
            let (face, row) = (texel.1 / n, texel.1 % n);
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
                .map(|(i, j)| on_face(face, line(texel.0 + i), line(row + j)));
            let mut clipped = Vec::new();
            for i in 0..4 {
                let (from, to) = (corners[i], corners[(i + 1) % 4]);
                let (h0, h1) = (from.dot(normal), to.dot(normal));
                clipped.extend((h0 > 0.0).then_some(from));
                clipped.extend(
                    ((h0 > 0.0) != (h1 > 0.0)).then(|| from + (to - from) * (h0 / (h0 - h1))),
                );
            }
            let irradiance: f64 = (0..clipped.len())
                .map(|i| {
                    let (from, to) = (clipped[i], clipped[(i + 1) % clipped.len()]);
                    let plane = from.cross(to);
                    plane.length().atan2(from.dot(to)) * plane.normalize().dot(normal) / 2.0
                })
                .sum();
            let expected = irradiance.abs() / PI;
            let oracle = Oracle::new(&map, Filter::Nearest, DMat3::IDENTITY);
            let found = oracle.radiance(&point, &Model::Lambert { albedo: [1.0; 3] }, 1e-9);
            let off = (found.radiance[0] - expected).abs();
            assert!(off <= 1e-8 * expected + 1e-15, "{found:?} is not {expected}");
            lit += usize::from(expected > 0.0);
            cut += usize::from(expected > 0.0 && corners.iter().any(|c| c.dot(normal) < 0.0));
        }
    }
    assert!(lit > 150 && cut > 50, "{lit} {cut}");
}

/// The same for a lat-long texel that lies wholly above the horizon: with the azimuth from a0 to a1
/// and the polar angle from t0 to t1, the integral of the direction over it is
/// ( [t/2 - sin 2t/4] [-cos a], [sin^2 t / 2] [a], [t/2 - sin 2t/4] [sin a] ).
#[test]
fn lambert_under_one_lat_long_texel_has_its_closed_form() {
    let mut random = Random::new(5);
    let mut compared = 0;
    for _ in 0..400 {
        let texel = ((random.unit() * 16.0) as usize, (random.unit() * 8.0) as usize);
        let map =
            Map::new(Layout::LatLong, 16, 8, |x, y| [f32::from(u8::from((x, y) == texel)); 3]);
        let point = point(&mut random, 0.0);
        let normal = point.world_from_local.z_axis;
        let [u0, u1] = [0, 1].map(|i| (texel.0 + i) as f64 / 16.0);
        let [t0, t1] = [0, 1].map(|i| PI * (texel.1 + i) as f64 / 8.0);
        let edge = |i: usize| {
            let x = i as f64 / 20.0;
            [(x, 0.0), (x, 1.0), (0.0, x), (1.0, x)]
                .map(|(a, b)| on_lat_long(u0 + a * (u1 - u0), t0 + b * (t1 - t0)).dot(normal))
        };
        if (0..=20).flat_map(edge).any(|height| height < 0.01) {
            continue;
        }
        let (a0, a1) = (TAU * (0.5 - u1), TAU * (0.5 - u0));
        let side = 0.5 * (t1 - t0) - 0.25 * ((2.0 * t1).sin() - (2.0 * t0).sin());
        let up = 0.5 * (t1.sin().powi(2) - t0.sin().powi(2)) * (a1 - a0);
        let vector = DVec3::new(side * (a0.cos() - a1.cos()), up, side * (a1.sin() - a0.sin()));
        let oracle = Oracle::new(&map, Filter::Nearest, DMat3::IDENTITY);
        let found = oracle.radiance(&point, &Model::Lambert { albedo: [1.0; 3] }, 1e-9);
        near(found.radiance, [vector.dot(normal) / PI; 3], 1e-9, "a texel");
        compared += 1;
    }
    assert!(compared > 100, "{compared}");
}

/// Albedo of GGX with F0 = 1 seen along the normal, as an integral over half vectors: with
/// c = x / (alpha^2 + x), x = tan^2(theta_h), D cos dw is dc, and G2 is 1 / (1 + Lambda) at 2 theta_h.
fn albedo_along_the_normal(alpha: f64) -> f64 {
    let integrand = |c: f64| {
        let x = alpha * alpha * c / (1.0 - c);
        2.0 / (1.0 + (1.0 + alpha * alpha * 4.0 * x / (1.0 - x).powi(2)).sqrt())
    };
    let (end, steps) = (1.0 / (1.0 + alpha * alpha), 400_000);
    (0..steps).map(|i| integrand(end * (f64::from(i) + 0.5) / f64::from(steps))).sum::<f64>() * end
        / f64::from(steps)
}

#[test]
fn ggx_has_its_albedo() {
    let mut random = Random::new(6);
    assert!((albedo_along_the_normal(1.0) - (1.0 - LN_2)).abs() < 1e-8);
    for (alpha, four_digits) in [(0.1, 0.988), (0.25, 0.916), (0.5, 0.688)] {
        assert!((albedo_along_the_normal(alpha) - four_digits).abs() < 5e-4);
    }
    for (layout, filter) in KINDS {
        let map = structured(layout).with(|_, _| [1.0; 3]);
        let oracle = Oracle::new(&map, filter, DMat3::IDENTITY);
        for alpha in [1.0, 0.5, 0.25, 0.1, 0.01, 0.001] {
            let point = point(&mut random, 0.0);
            let value = oracle.radiance(&point, &Model::ggx(alpha, [1.0; 3]), 1e-6);
            let expected = albedo_along_the_normal(alpha);
            near(value.radiance, [expected; 3], 1e-6, &format!("{layout:?} {filter:?} {alpha}"));
        }
        // Mitsuba 3's figures, to four digits.
        for (theta, separable, expected) in [
            (60.0, false, 0.6982),
            (60.0, true, 0.6860),
            (80.0, false, 0.8053),
            (80.0, true, 0.7469),
        ] {
            let model = Model::Ggx { alpha: [0.5; 2], f0: [1.0; 3], separable };
            let value = oracle.radiance(&point(&mut random, theta), &model, 1e-6);
            assert!((value.radiance[0] - expected).abs() < 1e-4, "{theta} {separable}: {value:?}");
        }
    }
}

/// Every texel in four equal ones is the same map to the nearest filter: other cells, other cuts at
/// the horizon, the same light.
#[test]
fn a_map_of_split_texels_is_the_same_map() {
    let mut random = Random::new(10);
    for layout in [Layout::LatLong, Layout::Cube] {
        let map = structured(layout);
        let split = Map::new(layout, 2 * map.width, 2 * map.height, |x, y| {
            map.at((x / 2, y / 2)).map(|value| value as f32)
        });
        let [coarse, fine] =
            [&map, &split].map(|m| Oracle::new(m, Filter::Nearest, DMat3::IDENTITY));
        for model in [
            Model::Lambert { albedo: [1.0; 3] },
            Model::ggx(0.5, [1.0, 0.5, 0.04]),
            Model::ggx(0.01, [1.0, 0.5, 0.04]),
            Model::ggx(0.001, [1.0, 0.5, 0.04]),
            Model::ModifiedPhong { kd: [0.2; 3], ks: [0.5; 3], n: 40.0 },
        ] {
            for theta in [5.0, 50.0, 80.0, 89.0] {
                let point = point(&mut random, theta);
                let [a, b] = [&coarse, &fine].map(|oracle| oracle.radiance(&point, &model, 1e-6));
                near(a.radiance, b.radiance, 1e-6, &format!("{layout:?} {model:?} {theta}"));
            }
        }
    }
}

/// A turned map under a point is the map under the point turned back; and a coarse tolerance is kept.
#[test]
fn rotations_and_tolerances_mean_what_they_say() {
    let mut random = Random::new(9);
    let turn = DMat3::from_rotation_x(0.4) * DMat3::from_rotation_y(2.0);
    for (layout, filter) in KINDS {
        let map = structured(layout);
        for model in [Model::ggx(0.1, [1.0; 3]), Model::ggx(0.002, [0.5; 3])] {
            let point = point(&mut random, 40.0);
            let turned = Point { world_from_local: turn * point.world_from_local, ..point };
            let fine = Oracle::new(&map, filter, DMat3::IDENTITY).radiance(&point, &model, 1e-8);
            let other = Oracle::new(&map, filter, turn).radiance(&turned, &model, 1e-8);
            near(other.radiance, fine.radiance, 2e-8, "turned");
            let coarse = Oracle::new(&map, filter, DMat3::IDENTITY).radiance(&point, &model, 1e-3);
            near(coarse.radiance, fine.radiance, 1e-3, "coarse");
            assert!(coarse.evaluations < fine.evaluations && fine.error < 1e-8);
        }
    }
}
