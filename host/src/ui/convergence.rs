//! How the error of pictures fell, a curve for each integrator.

use egui::Ui;
use egui_plot::{GridMark, Legend, Line, Plot as Drawn, PlotPoints};

use super::materials::pen;
use super::plots::{position, power, short};
use super::viewer::State;

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
