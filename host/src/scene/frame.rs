//! From a hit to a shading point: faces the viewer, builds the local frame, rounds to f32.
//!
//! Depends on glam alone. The frame is right-handed always: bitangent = cross(normal, tangent), so
//! that a mirrored uv chart keeps its tangent and a surface seen from behind keeps its tangent too.

use glam::DVec3;

/// The least `wo.z` of a shading point: a view nearer to the local horizon is lifted to it, a turn
/// of at most 1e-6 radians.
const HORIZON: f64 = 1e-6;

/// What one covered pixel sees: a local frame in world space and the view direction in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShadingPoint {
    /// Index of the pixel, y * width + x.
    pub pixel: u32,
    /// Direction to the viewer in the local frame, unit, z > 0.
    pub wo: [f32; 3],
    /// x axis of the frame in world space, unit, orthogonal to `normal`.
    pub tangent: [f32; 3],
    /// z axis of the frame in world space, unit; the y axis is cross(normal, tangent).
    pub normal: [f32; 3],
}

/// Where a ray met a surface, in world space, whichever side it came from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hit {
    /// Normal of the surface itself, unit.
    pub geometric: DVec3,
    /// Interpolated normal, unit, or zero where interpolation gave none; `None` on exact shapes.
    pub shading: Option<DVec3>,
    /// Direction of the tangent, neither unit nor orthogonal yet.
    pub tangent: DVec3,
}

/// The shading point of a hit, and whether its interpolated normal had to give way.
///
/// Surfaces are two-sided: the geometric normal is turned to the viewer and the interpolated one to
/// the same side, so that a triangle's winding does not matter here. An interpolated normal that
/// turns the view below [`HORIZON`] is replaced by the geometric one.
pub(super) fn shading_point(pixel: u32, view: DVec3, hit: &Hit) -> (ShadingPoint, bool) {
    let geometric = if hit.geometric.dot(view) < 0.0 { -hit.geometric } else { hit.geometric };
    let shading = hit.shading.map(|n| if n.dot(geometric) < 0.0 { -n } else { n });
    let usable = |n: &DVec3| n.dot(view) >= HORIZON;
    let bent = shading.is_some() && !shading.as_ref().is_some_and(usable);
    let normal = shading.filter(usable).unwrap_or(geometric);

    let tangent = orthogonal_tangent(normal, hit.tangent);
    let bitangent = normal.cross(tangent);
    let wo = lift(DVec3::new(view.dot(tangent), view.dot(bitangent), view.dot(normal)));
    let round = |v: DVec3| v.as_vec3().to_array();
    (ShadingPoint { pixel, wo: round(wo), tangent: round(tangent), normal: round(normal) }, bent)
}

/// Brings a unit direction at or below the horizon to [`HORIZON`] above it, unit again.
pub(super) fn lift(wo: DVec3) -> DVec3 {
    if wo.z >= HORIZON {
        return wo.normalize();
    }
    let flat = DVec3::new(wo.x, wo.y, 0.0).normalize_or(DVec3::X);
    (flat * (1.0 - HORIZON * HORIZON).sqrt()).with_z(HORIZON)
}

/// The tangent of surfaces without one: along the parallels about +y, any fixed one at the poles.
pub(super) fn parallel_tangent(normal: DVec3) -> DVec3 {
    DVec3::Y.cross(normal).try_normalize().unwrap_or(DVec3::X)
}

/// The part of `tangent` orthogonal to `normal`, unit (Gram-Schmidt).
fn orthogonal_tangent(normal: DVec3, tangent: DVec3) -> DVec3 {
    let reject = |t: DVec3| t - normal * normal.dot(t);
    // Where the wanted direction is (nearly) the normal itself, rounding would choose: take ours.
    let wanted = reject(tangent.normalize_or_zero());
    let t = if wanted.length() > 1e-9 { wanted } else { reject(parallel_tangent(normal)) };
    // A second pass removes what rounding left of the normal when `wanted` was short.
    reject(t.normalize()).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wo_is_unit_and_above_the_horizon_whatever_the_hit() {
        let tilted = DVec3::new(0.9, 0.0, -0.1).normalize();
        let views = [DVec3::Z, DVec3::X, -DVec3::Z, DVec3::new(1.0, 0.0, 1e-9).normalize()];
        for view in views {
            for shading in [None, Some(tilted), Some(DVec3::ZERO), Some(DVec3::Z)] {
                for tangent in [DVec3::X, DVec3::Z, DVec3::ZERO] {
                    let hit = Hit { geometric: DVec3::Z, shading, tangent };
                    let (point, _) = shading_point(7, view, &hit);
                    let wo = glam::Vec3::from(point.wo).as_dvec3();
                    let (t, n) = (glam::Vec3::from(point.tangent), glam::Vec3::from(point.normal));
                    assert!(point.wo[2] > 0.0 && (wo.length() - 1.0).abs() < 1e-6, "{point:?}");
                    assert!(t.is_normalized() && n.is_normalized(), "{point:?}");
                    assert!(t.dot(n).abs() < 1e-6, "{point:?}");
                }
            }
        }
    }

    #[test]
    fn an_interpolated_normal_below_the_horizon_gives_way_and_is_counted() {
        let view = DVec3::new(0.6, 0.0, 0.8);
        let away = DVec3::new(-0.9, 0.0, 0.3).normalize();
        let hit = Hit { geometric: DVec3::Z, shading: Some(away), tangent: DVec3::X };
        let (point, bent) = shading_point(0, view, &hit);
        assert!(bent);
        assert_eq!(point.normal, [0.0, 0.0, 1.0]);
        assert_eq!(point.wo, [0.6, 0.0, 0.8]);
        // The same surface seen from behind: its interpolated normal turns with the geometric one.
        let (point, bent) = shading_point(0, DVec3::new(0.6, 0.0, -0.8), &hit);
        assert!(!bent);
        assert!((glam::Vec3::from(point.normal) + away.as_vec3()).length() < 1e-6);
    }
}
