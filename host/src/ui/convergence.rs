//! How the error of pictures fell, a curve for each integrator: as they estimate it of themselves, or as it is against
//! the picture that stands beside in Compare.

use std::sync::Arc;

use egui::Ui;
use egui_plot::{GridMark, Line, Plot as Drawn, PlotPoints, Points};

use super::beside::Side;
use super::key::key_ui;
use super::materials::pen;
use super::plots::{position, power, powers, short};
use super::viewer::State;
use crate::live::Frame;
use crate::render::{Effort, Stop};
use crate::session::{Chosen, Session};

/// Points against a reference follow each other with this many times the samples at least.
const STEP: f64 = 1.15;

/// The view's curves, all of one scene.
#[derive(Default)]
pub(super) struct Convergence {
    curves: Vec<Curve>,
    against: bool,
    /// The reference that errors were taken against last.
    reference: Option<u64>,
}

/// How the error of a scene's picture fell.
struct Curve {
    scene: Session,
    integrator: Chosen,
    /// Samples of a pixel, time [s], relMSE: estimated, and against the reference.
    estimated: Vec<[f64; 3]>,
    measured: Vec<[f64; 3]>,
}

/// What pictures of one curve share, and the integrator that they are told apart by. How many samples there shall be is
/// none of it.
fn scene_of(session: &Session) -> (Session, Chosen) {
    let mut scene = session.clone().bare();
    let integrator = std::mem::replace(&mut scene.integrator, scene.brdf.clone());
    scene.effort = Effort::new(1, 1);
    scene.stop = Stop::default();
    (scene, integrator)
}

impl State {
    /// Takes down how the error falls, as long as nothing but the integrator changes.
    pub(super) fn note_convergence(&mut self) {
        let Some(frame) = self.status.frame.clone().filter(|frame| !frame.preview) else { return };
        let (scene, integrator) = scene_of(&frame.session);
        let curves = &mut self.convergence.curves;
        curves.retain(|curve| curve.scene == scene);
        let points = frame.convergence.clone();
        match curves.iter_mut().find(|curve| curve.integrator == integrator) {
            Some(curve) => curve.estimated = points,
            None => {
                curves.push(Curve { scene, integrator, estimated: points, measured: Vec::new() });
            }
        }
        if self.convergence.against {
            self.ask_difference();
            self.note_measured();
        }
    }

    /// Takes down the newest error against the picture beside, where that is a reference.
    fn note_measured(&mut self) {
        let Some(found) = self.compare.found() else { return };
        let [Side::Rendered(frame), reference] = &found.pair.sides else { return };
        // A picture has no error against itself.
        if frame.number == reference.number() || !is_reference(reference, frame) {
            return;
        }
        let Convergence { curves, reference: known, .. } = &mut self.convergence;
        if known.replace(reference.number()) != Some(reference.number()) {
            curves.iter_mut().for_each(|curve| curve.measured.clear());
        }
        let (scene, integrator) = scene_of(&frame.session);
        let curve = curves.iter_mut().find(|c| c.scene == scene && c.integrator == integrator);
        let Some(curve) = curve else { return };
        let done = frame.done as f64;
        let last = curve.measured.last().map_or(0.0, |point| point[0]);
        if done < last {
            curve.measured.clear();
        }
        if done < last || done >= STEP * last || (frame.complete && done > last) {
            curve.measured.push([done, frame.seconds, found.relmse]);
        }
    }
}

/// Whether a picture can tell how wrong `frame` is: it shows the same scene and is finished, or comes from a file.
fn is_reference(side: &Side, frame: &Arc<Frame>) -> bool {
    match side {
        Side::Read(_) => true,
        Side::Rendered(other) => {
            other.complete && scene_of(&other.session).0 == scene_of(&frame.session).0
        }
    }
}

/// The relMSE against samples and against time, as it fell.
pub(super) fn convergence_ui(ui: &mut Ui, state: &mut State) {
    let log = |points: &[[f64; 3]], x: usize| {
        let point = |p: &[f64; 3]| [p[x].max(1e-6).log10(), p[2].max(1e-30).log10()];
        points.iter().map(point).collect::<Vec<_>>()
    };
    let power = |mark: GridMark, _: &_| power(mark);
    ui.horizontal_wrapped(|ui| {
        let against = &mut state.convergence.against;
        ui.selectable_value(against, false, "estimated")
            .on_hover_text("What pictures estimate of themselves; it sees no bias.");
        ui.selectable_value(against, true, "against a reference")
            .on_hover_text("Against the picture beside the lit object in Compare.");
    });
    let Convergence { curves, against, .. } = &state.convergence;
    let words = match *against {
        false => "Other integrators of this scene stay beside.",
        true if curves.iter().all(|curve| curve.measured.is_empty()) => {
            "In Compare, hold a finished picture of this scene or open one from a file, then render on."
        }
        true => "Against the picture beside in Compare, which has an error of its own.",
    };
    ui.label(words);
    let named = curves.iter().enumerate().map(|(index, curve)| {
        (curve.integrator.configured.plugin.manifest.name.as_str(), pen(index), false)
    });
    key_ui(ui, named);
    let height = 0.5 * (ui.available_height() - 8.0);
    for (x, words) in [(0, "samples of a pixel"), (1, "seconds of rendering")] {
        Drawn::new(("convergence", x, *against))
            .height(height)
            .x_axis_label(words)
            .y_axis_label(if *against { "relMSE" } else { "estimated relMSE" })
            .x_grid_spacer(|input| powers(&input))
            .y_grid_spacer(|input| powers(&input))
            .x_axis_formatter(power)
            .y_axis_formatter(power)
            .label_formatter(|at| {
                let point = position(at);
                Some(format!("{}\n{}", short(10f64.powf(point.x)), short(10f64.powf(point.y))))
            })
            .show(ui, |plot| {
                for (index, curve) in curves.iter().enumerate() {
                    let points = if *against { &curve.measured } else { &curve.estimated };
                    let points = log(points, x);
                    let name = &curve.integrator.configured.plugin.manifest.name;
                    let line = Line::new(name.clone(), PlotPoints::from(points.clone()));
                    plot.line(line.color(pen(index)).width(1.8));
                    // One alone would be no line.
                    let dots = Points::new(name.clone(), PlotPoints::from(points));
                    plot.points(dots.color(pen(index)).radius(2.5));
                }
            });
    }
}
