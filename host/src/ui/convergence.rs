//! How the error of pictures fell, a curve for each integrator.

use egui::Ui;
use egui_plot::{GridMark, Legend, Line, Plot as Drawn, PlotPoints};

use super::materials::pen;
use super::plots::{position, power, short};
use super::viewer::State;
use crate::session::{Chosen, Session};

/// How the error of a scene's picture fell.
pub(super) struct Curve {
    /// The scene, but for its integrator.
    scene: Session,
    integrator: Chosen,
    /// Samples of a pixel, time [s], estimated relMSE.
    points: Vec<[f64; 3]>,
}

impl State {
    /// Takes down how the error falls: a curve for each integrator, as long as nothing else of the scene changes.
    pub(super) fn note_convergence(&mut self) {
        let Some(frame) = self.status.frame.as_ref().filter(|frame| !frame.preview) else { return };
        let mut scene = (*frame.session).clone();
        let integrator = std::mem::replace(&mut scene.integrator, scene.brdf.clone());
        scene.beside = Vec::new();
        scene.film.exposure = 0.0;
        self.curves.retain(|curve| curve.scene == scene);
        let points = frame.convergence.clone();
        match self.curves.iter_mut().find(|curve| curve.integrator == integrator) {
            Some(curve) => curve.points = points,
            None => self.curves.push(Curve { scene, integrator, points }),
        }
    }
}

/// The relMSE against time, as it fell.
pub(super) fn convergence_ui(ui: &mut Ui, state: &mut State) {
    let log = |points: &[[f64; 3]], x: usize| {
        let point = |p: &[f64; 3]| [p[x].max(1e-6).log10(), p[2].max(1e-30).log10()];
        points.iter().map(point).collect::<Vec<_>>()
    };
    let power = |mark: GridMark, _: &_| power(mark);
    ui.label("The error that pictures estimate of themselves; other integrators of this scene stay beside.");
    let height = 0.5 * (ui.available_height() - 8.0);
    for (x, words) in [(0, "samples of a pixel"), (1, "seconds of rendering")] {
        Drawn::new(("convergence", x))
            .height(height)
            .legend(Legend::default())
            .x_axis_label(words)
            .y_axis_label("estimated relMSE")
            .x_axis_formatter(power)
            .y_axis_formatter(power)
            .label_formatter(|at| {
                let point = position(at);
                Some(format!("{}\n{}", short(10f64.powf(point.x)), short(10f64.powf(point.y))))
            })
            .show(ui, |plot| {
                for (index, curve) in state.curves.iter().enumerate() {
                    let points = PlotPoints::from(log(&curve.points, x));
                    let name = &curve.integrator.configured.plugin.manifest.name;
                    plot.line(Line::new(name.clone(), points).color(pen(index)).width(1.8));
                }
            });
    }
}
