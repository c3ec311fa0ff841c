//! What a camera sees at one size: the shading points, and the environment past them. Both are kept as long as nothing
//! moves that they depend on.

use brdf_sdk::Result;

use super::kept::Kept;
use crate::open;
use crate::render::background::Backdrop;
use crate::scene::{Camera, Coverage, cast};
use crate::session::{Background, Light, Session};

/// Points and background of one size.
pub(super) struct Seen {
    of: (Camera, String, [u32; 2]),
    pub(super) coverage: Coverage,
    light: Option<Light>,
    pub(super) background: Vec<[f32; 3]>,
}

impl Seen {
    /// Width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.of.2
    }
}

impl Kept {
    /// Casts rays for a picture of this size, if `seen` is of another view, and gives the stage what they hit.
    pub(super) fn cover(
        &mut self,
        seen: Option<Seen>,
        session: &Session,
        size: [u32; 2],
    ) -> Result<Seen> {
        let of = (session.camera, session.shape.clone(), size);
        let seen = match seen {
            Some(seen) if seen.of == of => seen,
            _ => {
                let coverage = match &self.shape {
                    Some((_, shape)) if size == session.film.resolution => {
                        open::shading_points(session, shape)?
                    }
                    Some((_, shape)) => cast(&session.camera, shape, size),
                    None => Coverage::default(),
                };
                Seen { of, coverage, light: None, background: Vec::new() }
            }
        };
        if let Some(stage) = &mut self.stage {
            stage.set_points(self.executor.as_mut(), seen.coverage.points.clone());
        }
        Ok(seen)
    }

    /// Looks the environment up past the object, if it has turned or is another.
    pub(super) fn look_past(&mut self, seen: &mut Seen, session: &Session) -> Result<()> {
        let wanted = (session.film.background == Background::Env).then_some(&session.environment);
        if seen.light.as_ref() == wanted {
            return Ok(());
        }
        seen.background.clear();
        seen.light = None;
        let (Some(stage), Some(light)) = (self.stage.as_mut(), wanted) else { return Ok(()) };
        let executor = self.executor.as_mut();
        let backdrop = match self.backdrop.take() {
            Some(backdrop) => backdrop,
            None => Backdrop::new(executor, stage)?,
        };
        let rays = seen.coverage.rays_past(&session.camera, seen.size());
        let radiance = backdrop.radiance(executor, stage, &rays);
        self.backdrop = Some(backdrop);
        seen.background = radiance?;
        seen.light = Some(light.clone());
        Ok(())
    }
}
