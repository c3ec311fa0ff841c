//! OBJ: one mesh in all the ways in which files write it.

use super::*;

const SQUARE: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n";

/// Positions and normals of each triangle's corners.
fn triangles(text: impl AsRef<[u8]>) -> Vec<[(DVec3, DVec3); 3]> {
    let mesh = load("m.OBJ", text).unwrap();
    let corner = |v: u32| (mesh.positions[v as usize], mesh.normals[v as usize]);
    mesh.triangles.iter().map(|triangle| triangle.map(corner)).collect()
}

#[test]
fn a_square_is_one_mesh_however_it_is_written() {
    let half = 0.5_f64.sqrt();
    let at = |x: f64, y: f64| (DVec3::new(x * half, y * half, 0.0), DVec3::Z);
    let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    let expected = [[a, b, c], [a, c, d]];
    let plain = format!("{SQUARE}f 1 2 3 4\n");
    let uv = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let texts = [
        ("v", plain.clone()),
        ("v/", format!("{SQUARE}f 1/ 2// 3/ 4//\n")),
        ("v/t", format!("{SQUARE}{uv}f 1/1 2/2 3/3 4/4\n")),
        ("v//n", format!("{SQUARE}vn 0 0 1\nf 1//1 2//1 3//1 4//1\n")),
        ("v/t/n", format!("{SQUARE}vn 0 0 7\n{uv}f 1/1/1 2/2/1 3/3/1 4/4/1\n")),
        ("uv of one and three numbers", format!("{SQUARE}vt 0\nvt 1 0 0\nf 1/1 2/2 3/2 4/1\n")),
        ("normals without length", format!("{SQUARE}vn 0 0 0\nf 1//1 2//1 3//1 4//1\n")),
        ("triangles", format!("{SQUARE}f 1 2 3\nf 1 3 4\n")),
        ("relative", format!("{SQUARE}f -4 -3 -2 -1\nv 100 0 0\n")),
        ("relative, all three", format!("{SQUARE}{uv}vn 0 0 1\nf -4/-4/-1 2/2/1 -2/-2/-1 4/4/1\n")),
        (
            "signs and exponents",
            plain.replace("v 1 1 0", "v +1e0 .1E+1 -0.").replace("f 1", "f +1"),
        ),
        ("w and colours", plain.replace("1 1 0", "2 2 0 2").replace("1 -1 0", "1 -1 0 .5 .5 .5")),
        ("CR LF", plain.replace('\n', "\r\n")),
        ("CR LF that goes on", plain.replace("2 3", "2\\\r\n3").replace('\n', "\r\n")),
        ("CR", plain.replace('\n', "\r")),
        ("a mark of byte order", format!("\u{feff}{plain}")),
        ("blanks and tabs", plain.replace(' ', " \t ").replace('\n', " \n\n  ")),
        ("no end of line", plain.trim_end().to_owned()),
        ("comments", format!("# C:\\\n{}# f 1 2 9\n", plain.replace('\n', " # 9 \\\n"))),
        ("a line that goes on", plain.replace(" 3 4", "\\\n 3 \\\n4")),
        ("faces first", format!("g a\nf 1 2 3\ng b\nf 1 3 4\ng c\n{SQUARE}")),
        ("an unused vertex", format!("{SQUARE}v 100 100 100\nf 1 2 3 4\n")),
        (
            "groups, materials and what is no face",
            format!(
                "mtllib\nmtllib a.mtl b.mtl\no lines\ng\n{SQUARE}vp 1\nl 1 2 3\no points\np 1 2\n\
                 s off\nusemtl\nusemtl x\ncstype bezier\ng a\nf 1 2 3\ns 1\ng b c\nf 1 3 4\n"
            ),
        ),
    ];
    for (name, text) in texts {
        for (found, expected) in triangles(&text).as_flattened().iter().zip(expected.as_flattened())
        {
            let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-15;
            assert!(close(found.0, expected.0) && close(found.1, expected.1), "{name}: {found:?}");
        }
        assert_eq!(triangles(&text).len(), 2, "{name}");
    }
}

#[test]
fn a_corner_without_a_normal_takes_none_from_its_neighbours() {
    let found = triangles(format!("{SQUARE}vn 0 3 0\nf 1//1 2//1 3\nf 1 3 4\n"));
    let normals = found.iter().map(|triangle| triangle.map(|corner| corner.1));
    assert!(normals.eq([[DVec3::Y, DVec3::Y, DVec3::Z], [DVec3::Z; 3]]), "{found:?}");
}

#[test]
fn polygons_have_two_triangles_less_than_corners() {
    // BRDF Explorer stops at 255 corners.
    for corners in [3, 5, 300] {
        let ring = (0..corners).map(|i| (TAU * f64::from(i) / f64::from(corners)).sin_cos());
        let vertices: String = ring.map(|(y, x)| format!("v {x} {y} 0\n")).collect();
        let face: String = (1..=corners).map(|i| format!(" {i}")).collect();
        let found = triangles(format!("{vertices}f{face}\n"));
        assert_eq!(found.len(), corners as usize - 2);
        assert!(found.as_flattened().iter().all(|(_, normal)| normal.distance(DVec3::Z) < 1e-12));
    }
}

#[test]
fn a_concave_face_covers_what_its_triangles_cover_wherever_it_begins() {
    // An arrow head to the right whose notch is its fourth corner.
    let arrow = "v -1 -1 0\nv 1 0 0\nv -1 1 0\nv -0.25 0 0\n";
    let seen = |faces: &str| {
        let mesh = load("arrow.obj", format!("{arrow}{faces}\n")).unwrap();
        let coverage = cast(&Camera::default(), &Shape::Mesh(Arc::new(mesh)), [64, 64]);
        coverage.points.iter().map(|point| (point.pixel, point.normal)).collect::<Vec<_>>()
    };
    let expected = seen("f 1 2 4\nf 2 3 4");
    assert!(expected.len() > 100);
    for face in ["f 1 2 3 4", "f 2 3 4 1", "f 3 4 1 2", "f 4 1 2 3"] {
        assert_eq!(seen(face), expected, "{face}");
    }
}
