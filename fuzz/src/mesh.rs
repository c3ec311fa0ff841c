//! A file as a mesh: loaded, and met by a few rays.

use std::sync::Arc;

use brdf_host::scene::{Camera, Mesh, Shape, cast};

/// Loads the bytes as a file of that ending; whatever a ray meets has a frame and a view above its horizon.
///
/// # Panics
/// It has not.
pub fn check(extension: &str, bytes: &[u8]) {
    let mesh = match Mesh::load(crate::file(extension, bytes)) {
        Ok(mesh) => mesh,
        Err(problem) => return crate::refused(&problem),
    };
    assert!(mesh.triangles() > 0);
    let shape = Shape::Mesh(Arc::new(mesh));
    for yaw in [0.0, 75.0, 150.0] {
        let camera = Camera { yaw, pitch: 20.0, ..Camera::default() };
        for point in cast(&camera, &shape, [9, 9]).points {
            let unit = |v: [f32; 3]| (v.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-4;
            let fine =
                unit(point.wo) && unit(point.tangent) && unit(point.normal) && point.wo[2] > 0.0;
            assert!(fine, "{point:?}");
        }
    }
}
