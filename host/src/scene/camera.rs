//! The camera: a pinhole on an orbit around the origin, looking at it, +y up.
//!
//! Depends on `brdf_sdk::Problem` and glam. It has no lens, no roll and no target but the origin; the picture can be
//! shifted over the film, as by a view camera.

use std::fmt;

use brdf_sdk::{Problem, Result};
use glam::DVec3;

const CURE: &str = "give any of yaw, pitch, distance, fov, shift_x, shift_y, as in yaw=30,pitch=20,distance=4.5,fov=30";

/// A camera on an orbit around the origin, looking at it, +y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Turn about +y [degrees]: 0 looks from +z, 90 from +x.
    pub yaw: f64,
    /// Height above the xz-plane [degrees], in [-90, 90].
    pub pitch: f64,
    /// From the eye to the origin, in radii of the unit sphere; above 0.
    pub distance: f64,
    /// Vertical field of view [degrees], in (0, 180).
    pub fov: f64,
    /// How far the picture is moved to the right and up [half heights of the picture].
    pub shift: [f64; 2],
}

/// A ray in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes, unit.
    pub dir: DVec3,
}

impl Default for Camera {
    fn default() -> Self {
        Self { yaw: 0.0, pitch: 0.0, distance: 4.5, fov: 30.0, shift: [0.0; 2] }
    }
}

impl fmt::Display for Camera {
    /// Writes what [`Camera::parse`] reads.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { yaw, pitch, distance, fov, shift: [x, y] } = self;
        write!(f, "yaw={yaw},pitch={pitch},distance={distance},fov={fov}")?;
        match self.shift {
            [0.0, 0.0] => Ok(()),
            _ => write!(f, ",shift_x={x},shift_y={y}"),
        }
    }
}

impl Camera {
    /// Reads `key=value` pairs separated by commas; keys left out keep their default.
    pub fn parse(text: &str) -> Result<Self> {
        let problem = |reason: String| Problem::new(format!("camera \"{text}\""), reason, CURE);
        let mut camera = Self::default();
        let mut seen = Vec::new();
        for pair in text.split(',').map(str::trim).filter(|pair| !pair.is_empty()) {
            let (key, value) = pair
                .split_once('=')
                .map(|(key, value)| (key.trim(), value.trim()))
                .ok_or_else(|| problem(format!("\"{pair}\" is not key=value")))?;
            let field = match key {
                "yaw" => &mut camera.yaw,
                "pitch" => &mut camera.pitch,
                "distance" => &mut camera.distance,
                "fov" => &mut camera.fov,
                "shift_x" => &mut camera.shift[0],
                "shift_y" => &mut camera.shift[1],
                _ => return Err(problem(format!("it has no key \"{key}\""))),
            };
            if seen.contains(&key) {
                return Err(problem(format!("{key} is given twice")));
            }
            seen.push(key);
            *field = value.parse().map_err(|_| problem(format!("{key} is not a number")))?;
        }
        camera.check()?;
        Ok(camera)
    }

    /// Whether the camera defines an image: every field finite and in its range.
    pub fn check(&self) -> Result<()> {
        let fail =
            |reason: &str, cure: &str| Err(Problem::new(format!("camera {self}"), reason, cure));
        let Self { yaw, pitch, distance, fov, shift: [x, y] } = *self;
        if ![yaw, pitch, distance, fov, x, y].iter().all(|value| value.is_finite()) {
            return fail("a value is not finite", CURE);
        }
        if !(-90.0..=90.0).contains(&pitch) {
            return fail("pitch is out of range", "choose -90 to 90 degrees");
        }
        if distance <= 0.0 {
            return fail("distance is not positive", "choose one above 0, for example 4.5");
        }
        if fov <= 0.0 || fov >= 180.0 {
            return fail("fov is out of range", "choose above 0 and below 180 degrees");
        }
        Ok(())
    }

    /// Where the camera stands, in world space.
    pub fn eye(&self) -> DVec3 {
        self.distance * self.backward()
    }

    /// The ray through the centre of pixel (x, y); row 0 is the top. Images that are not square
    /// keep the vertical field of view.
    pub fn ray(&self, resolution: [u32; 2], x: u32, y: u32) -> Ray {
        let backward = self.backward();
        // `right` comes from yaw alone, so that straight up and down have a defined up as well.
        let (sin_yaw, cos_yaw) = self.yaw.to_radians().sin_cos();
        let right = DVec3::new(cos_yaw, 0.0, -sin_yaw);
        let up = backward.cross(right);
        let [width, height] = resolution.map(f64::from);
        let half_height = (0.5 * self.fov.to_radians()).tan();
        let half_width = half_height * width / height;
        let [right_by, up_by] = self.shift.map(|shift| shift * half_height);
        let across = (2.0 * (f64::from(x) + 0.5) / width - 1.0) * half_width - right_by;
        let upward = (1.0 - 2.0 * (f64::from(y) + 0.5) / height) * half_height - up_by;
        let dir = (across * right + upward * up - backward).normalize();
        Ray { origin: self.eye(), dir }
    }

    /// The unit vector from the origin to the eye.
    fn backward(&self) -> DVec3 {
        let (sin_yaw, cos_yaw) = self.yaw.to_radians().sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.to_radians().sin_cos();
        DVec3::new(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, b: DVec3) -> bool {
        (a - b).length() < 1e-14
    }

    #[test]
    fn rays_of_the_default_camera_are_those_of_a_pinhole() {
        // One pixel: straight on. Two by two: the centres lie half-way to the edge of the image.
        let camera = Camera::default();
        let ray = camera.ray([1, 1], 0, 0);
        assert!(close(ray.origin, DVec3::new(0.0, 0.0, 4.5)));
        assert!(close(ray.dir, -DVec3::Z));
        let half = 15.0_f64.to_radians().tan() / 2.0;
        assert!(close(camera.ray([2, 2], 0, 0).dir, DVec3::new(-half, half, -1.0).normalize()));
        assert!(close(camera.ray([2, 2], 1, 1).dir, DVec3::new(half, -half, -1.0).normalize()));
        // Moved right by the whole height, the middle looks where the left edge of a square did.
        let shifted = Camera { shift: [1.0, 0.0], ..camera };
        assert!(close(
            shifted.ray([1, 1], 0, 0).dir,
            DVec3::new(-2.0 * half, 0.0, -1.0).normalize()
        ));
        // Twice as wide: the same vertical angle, and across centres at -3, -1, 1, 3 quarters of 2.
        let wide = camera.ray([4, 2], 3, 0).dir;
        assert!(close(wide, DVec3::new(3.0 * half, half, -1.0).normalize()));
    }

    #[test]
    fn the_orbit_turns_about_y_and_keeps_an_up_at_the_poles() {
        let side = Camera { yaw: 90.0, ..Camera::default() };
        assert!(close(side.eye(), 4.5 * DVec3::X));
        // From +x, +y up, the right of the image is -z.
        let half = 15.0_f64.to_radians().tan() / 2.0;
        let ray = side.ray([2, 2], 1, 0);
        assert!(close(ray.dir, DVec3::new(-1.0, half, -half).normalize()));
        // From above at yaw 0, the top of the image is -z and its right is +x.
        let above = Camera { pitch: 90.0, ..Camera::default() };
        let ray = above.ray([2, 2], 1, 0);
        assert!(close(ray.dir, DVec3::new(half, -1.0, -half).normalize()));
        let below = Camera { pitch: -90.0, ..Camera::default() };
        let ray = below.ray([2, 2], 1, 0);
        assert!(close(ray.dir, DVec3::new(half, 1.0, half).normalize()));
    }

    #[test]
    fn a_camera_reads_back_what_it_writes() {
        let camera =
            Camera { yaw: 30.0, pitch: -20.5, distance: 3.25, fov: 45.0, shift: [0.5, -0.25] };
        assert_eq!(Camera::parse(&camera.to_string()), Ok(camera));
        let expected = Camera { fov: 20.0, ..Camera::default() };
        assert_eq!(Camera::parse(" fov = 20 "), Ok(expected));
        assert_eq!(Camera::parse(""), Ok(Camera::default()));
    }

    #[test]
    fn bad_cameras_are_told_what_to_do() {
        for (text, reason) in [
            ("zoom=2", "no key \"zoom\""),
            ("yaw", "not key=value"),
            ("yaw=left", "yaw is not a number"),
            ("yaw=1,yaw=2", "given twice"),
            ("yaw=nan", "not finite"),
            ("pitch=91", "pitch is out of range"),
            ("distance=0", "distance is not positive"),
            ("fov=180", "fov is out of range"),
        ] {
            let shown = Camera::parse(text).unwrap_err().to_string();
            assert!(shown.contains(reason) && shown.contains("; "), "{shown}");
            assert_eq!(shown.lines().count(), 1);
        }
        assert!(Camera::parse("zoom=2").unwrap_err().cure.contains("yaw, pitch, distance, fov"));
    }
}
