//! Curves over angles, with the values under the pointer; and the choices that plots share.

use clap::ValueEnum;
use egui::{Color32, DragValue, Ui};
use egui_plot::{
    FilledArea, GridInput, GridMark, HLine, HoverPosition, Line, LineStyle, Plot as Drawn,
    PlotPoint, PlotPoints,
};

use super::asked::{Question, ask, save_ui};
use super::key::{self, key_ui};
use super::materials::pen;
use super::parts::named;
use super::viewer::State;
use crate::live::Asked;
use crate::plot::{Channel, Channels, Plot, Series, Settings, View};

/// A view of curves.
pub(super) fn plot_ui(ui: &mut Ui, state: &mut State, view: View) {
    ui.horizontal_wrapped(|ui| {
        values_ui(ui, state, view);
        angles_ui(ui, &mut state.document.plot, view);
        save_ui(ui, state, view);
    });
    let found = ask(state, view);
    if let Some(problem) = state.plots.asked.get(&view).and_then(Asked::problem) {
        let words = match state.status.problem.as_ref() == Some(&problem) {
            true if found.is_some() => "of the last good form".to_owned(),
            true => "nothing to plot: a problem is told of below".to_owned(),
            false => problem.line(),
        };
        ui.colored_label(ui.visuals().warn_fg_color, words);
    }
    let Some(answer) = found else { return };
    for note in &answer.notes {
        ui.small(note);
    }
    if let Plot::Polar(series) | Plot::Lines(series, _) | Plot::Albedo(series) = &answer.plot {
        let line = (view == View::Albedo).then_some((ALL_LIGHT, Color32::GRAY, false));
        names_ui(ui, series, &answer.question, line);
    }
    match &answer.plot {
        Plot::Polar(series) => polar_ui(ui, series, &answer.question),
        Plot::Lines(series, line) => {
            let [low, high] = line.range();
            lines_ui(ui, view, series, &answer.question, [low, high]);
        }
        Plot::Albedo(series) => lines_ui(ui, view, series, &answer.question, [0.0, 90.0]),
        Plot::Slices(..) | Plot::Lobes(_) => {}
    }
}

/// The curves' names.
fn names_ui(ui: &mut Ui, series: &[Series], question: &Question, line: Option<key::Named<'_>>) {
    let all = series.iter();
    let named = all.map(|one| (&*one.name, colour(one, question), is_dashed(one, question)));
    key_ui(ui, named.chain(line));
}

/// Where the albedo is 1.
const ALL_LIGHT: &str = "all light leaves";

/// Where colours are channels, dashes tell the first BRDF from others.
fn is_dashed(series: &Series, question: &Question) -> bool {
    question.settings.rgb() && series.subject > 0
}

/// The colour of a curve: its BRDF's, or its channel's where there are three.
fn colour(series: &Series, question: &Question) -> Color32 {
    match series.channel {
        Channel::Red if question.settings.rgb() => pen(4),
        Channel::Green if question.settings.rgb() => pen(2),
        Channel::Blue if question.settings.rgb() => pen(0),
        _ => pen(question.pens.get(series.subject).copied().unwrap_or_default()),
    }
}

fn line<'a>(series: &'a Series, question: &Question, points: Vec<[f64; 2]>) -> Line<'a> {
    let style = match is_dashed(series, question) {
        true => LineStyle::dashed_loose(),
        false => LineStyle::Solid,
    };
    Line::new(series.name.clone(), PlotPoints::from(points))
        .color(colour(series, question))
        .width(1.8)
        .style(style)
}

pub(super) fn position(at: &HoverPosition<'_>) -> PlotPoint {
    match at {
        HoverPosition::NearDataPoint { position, .. } | HoverPosition::Elsewhere { position } => {
            *position
        }
    }
}

/// The largest value that can be drawn; 1 where there is none.
fn largest(series: &[Series]) -> f64 {
    let values = series.iter().flat_map(|one| one.points.iter().map(|point| point[1]));
    let largest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

fn lines_ui(
    ui: &mut Ui,
    view: View,
    series: &[Series],
    question: &Question,
    [low, high]: [f64; 2],
) {
    let decades = question.settings.decades;
    let floor = largest(series).log10().ceil() - decades.unwrap_or_default();
    let place = move |value: f64| match decades {
        Some(_) if value > 0.0 && value.log10() >= floor => value.log10(),
        Some(_) => f64::NAN,
        None => value,
    };
    let value = move |place: f64| if decades.is_some() { 10f64.powf(place) } else { place };
    let words = match view {
        View::Albedo => "albedo".to_owned(),
        _ => question.settings.words(),
    };
    let mut drawn = Drawn::new(("plot", view))
        // Room for the number at the end.
        .default_x_bounds(low - 0.02 * (high - low), high + 0.04 * (high - low))
        .x_axis_label(x_words(view))
        .y_axis_label(words)
        .x_grid_spacer(|input| degrees(&input))
        .x_axis_formatter(|mark: GridMark, _: &_| format!("{}", (1e3 * mark.value).round() / 1e3))
        .y_axis_formatter(move |mark: GridMark, _: &_| match decades {
            Some(_) => power(mark),
            None => stepped(mark),
        })
        .label_formatter(move |at| {
            let point = position(at);
            Some(format!("{:.2}°\n{}", point.x, short(value(point.y))))
        });
    drawn = match decades {
        Some(_) => drawn.y_grid_spacer(|input| powers(&input)),
        None => drawn.include_y(0.0),
    };
    drawn.show(ui, |plot| {
        if view == View::Albedo {
            plot.hline(HLine::new(ALL_LIGHT, place(1.0)).color(Color32::GRAY));
        }
        for one in series {
            let points: Vec<[f64; 2]> = one.points.iter().map(|[x, y]| [*x, place(*y)]).collect();
            // Bands reach two standard errors up and down.
            if !one.errors.is_empty() {
                let xs: Vec<f64> = one.points.iter().map(|[x, _]| *x).collect();
                let end = |sign: f64| -> Vec<f64> {
                    let both = std::iter::zip(&one.points, &one.errors);
                    both.map(|([_, y], error)| place(y + sign * 2.0 * error)).collect()
                };
                let fill = colour(one, question).gamma_multiply(0.3);
                plot.add(FilledArea::new("", &xs, &end(-1.0), &end(1.0)).fill_color(fill));
            }
            plot.line(line(one, question, points));
        }
    });
}

/// Curves around the normal, which goes up; positive angles lie on the right.
fn polar_ui(ui: &mut Ui, series: &[Series], question: &Question) {
    let peak = largest(series);
    let decades = question.settings.decades;
    let top = peak.log10().ceil();
    // By logarithm the centre lies so many decades below the ring.
    let radius = move |value: f64| match decades {
        Some(decades) if value > 0.0 => (1.0 + (value.log10() - top) / decades).max(0.0),
        Some(_) => 0.0,
        None => value,
    };
    let reach = if decades.is_some() { 1.0 } else { peak };
    let value = move |radius: f64| match decades {
        Some(decades) => 10f64.powf(top + (radius - 1.0) * decades),
        None => radius,
    };
    let at = |angle: f64, radius: f64| {
        let (sine, cosine) = angle.to_radians().sin_cos();
        [radius * sine, radius * cosine]
    };
    let grey = ui.visuals().weak_text_color().gamma_multiply(0.6);
    let theta = question.settings.wi.theta;
    let drawn = Drawn::new("polar").data_aspect(1.0).show_axes(false);
    let drawn = drawn.show_grid(false).label_formatter(move |at| {
        let point = position(at);
        let angle = point.x.atan2(point.y).to_degrees();
        Some(format!("{angle:.1}°\n{}", short(value(point.x.hypot(point.y)))))
    });
    let ring =
        |radius: f64| (-90..=90).map(|angle| at(f64::from(angle), radius)).collect::<Vec<_>>();
    drawn.show(ui, |plot| {
        for part in [0.25, 0.5, 0.75, 1.0] {
            let ring = Line::new("", PlotPoints::from(ring(part * reach))).color(grey).width(1.0);
            plot.line(ring.allow_hover(false));
        }
        for angle in [-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0] {
            let spoke = PlotPoints::from(vec![[0.0, 0.0], at(angle, reach)]);
            plot.line(Line::new("", spoke).color(grey).width(0.7).allow_hover(false));
            let place = at(angle, 1.06 * reach);
            let text = egui_plot::Text::new("", place.into(), format!("{angle}°"));
            plot.text(text.color(grey));
        }
        for (angle, name) in [(-theta, "wi"), (theta, "mirror")] {
            let spoke = PlotPoints::from(vec![[0.0, 0.0], at(angle, reach)]);
            let spoke = Line::new("", spoke).color(Color32::from_rgb(15, 143, 160)).width(1.0);
            plot.line(spoke.style(LineStyle::dashed_dense()).allow_hover(false));
            let text = egui_plot::Text::new("", at(angle, 1.13 * reach).into(), name);
            plot.text(text.color(Color32::from_rgb(15, 143, 160)));
        }
        let text = egui_plot::Text::new("", at(45.0, 1.2 * reach).into(), short(value(reach)));
        plot.text(text.color(grey));
        for one in series {
            let usable = one.points.iter().filter(|point| point[1].is_finite());
            let points = usable.map(|[angle, value]| at(*angle, radius(*value))).collect();
            plot.line(line(one, question, points));
        }
    });
}

fn x_words(view: View) -> &'static str {
    match view {
        View::ThetaV => "theta_v: wo from the normal [degrees]",
        View::ThetaH => "theta_h: the half vector from the normal [degrees]",
        View::ThetaD => "theta_d: wi from the half vector [degrees]",
        View::Albedo | View::Polar | View::Slice | View::Lobe => "wo from the normal [degrees]",
    }
}

/// Lines of a grid of degrees: some four with numbers, and finer ones between.
fn degrees(input: &GridInput) -> Vec<GridMark> {
    const STEPS: [f64; 12] = [0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0];
    let (low, high) = input.bounds;
    let wide = STEPS.into_iter().find(|step| (high - low) / step <= 4.5).unwrap_or(360.0);
    let marks = |step: f64| {
        let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
        (first..=last).map(move |i| GridMark { value: i as f64 * step, step_size: step })
    };
    marks(wide).chain(marks(wide / 5.0)).collect()
}

/// The number of a mark with the digits that its step has.
fn stepped(mark: GridMark) -> String {
    let digits = (-mark.step_size.log10().floor()).clamp(0.0, 9.0) as usize;
    match mark.value.abs() {
        size if size >= 1e5 => format!("{:.1e}", mark.value),
        _ => format!("{:.digits$}", mark.value),
    }
}

/// Lines of a grid of logarithms: powers of ten, with 2 and 5 times them between, and more where little is seen.
pub(super) fn powers(input: &GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    // Over many decades not all of them.
    let stride = ((high - low) / 12.0).ceil().max(1.0);
    let times: &[(f64, f64)] = match high - low {
        wide if wide > 12.0 => &[(1.0, 1.0)],
        wide if wide > 0.8 => &[(1.0, 1.0), (2.0, 0.3), (5.0, 0.3)],
        _ => &[
            (1.0, 1.0),
            (1.2, 0.08),
            (1.5, 0.08),
            (2.0, 0.3),
            (3.0, 0.08),
            (4.0, 0.08),
            (5.0, 0.3),
            (7.0, 0.08),
        ],
    };
    let (first, last) = ((low / stride).floor() as i64, (high / stride).ceil() as i64);
    let marks = (first..=last).flat_map(|decade| {
        times.iter().map(move |(times, step)| GridMark {
            value: decade as f64 * stride + times.log10(),
            step_size: step * stride,
        })
    });
    marks.filter(|mark| (low..=high).contains(&mark.value)).collect()
}

/// The number whose logarithm a mark is.
pub(super) fn power(mark: GridMark) -> String {
    let decade = (mark.value + 1e-6).floor();
    let times = (10.0 * 10f64.powf(mark.value - decade)).round() / 10.0;
    match decade {
        -3.0..=4.0 => {
            let value = times * 10f64.powi(decade as i32);
            format!("{}", (1e5 * value).round() / 1e5)
        }
        _ => format!("{times}e{decade}"),
    }
}

/// A number as an axis has room for it.
pub(super) fn short(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e5).contains(&size) => {
            let digits = (3.0 - size.max(1e-3).log10().ceil()).clamp(0.0, 6.0) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.2e}"),
    }
}

/// What is plotted of a value, and how.
pub(super) fn values_ui(ui: &mut Ui, state: &mut State, view: View) {
    let plot = &mut state.document.plot;
    let combo = egui::ComboBox::from_id_salt("channels").width(90.0);
    let word = |channels: &Channels| {
        channels.to_possible_value().map(|word| word.get_name().to_owned()).unwrap_or_default()
    };
    let shown = combo.selected_text(word(&plot.channels)).show_ui(ui, |ui| {
        // Three surfaces of one BRDF would hide each other.
        let several = |channels: &&Channels| view != View::Lobe || **channels != Channels::Rgb;
        for channels in Channels::value_variants().iter().filter(several) {
            ui.selectable_value(&mut plot.channels, *channels, word(channels));
        }
    });
    named(&shown.response, "Channel");
    let mut log = plot.decades.is_some();
    if ui.checkbox(&mut log, "log").changed() {
        plot.decades = log.then_some(4.0);
    }
    if let Some(decades) = &mut plot.decades {
        ui.add(DragValue::new(decades).range(1.0..=10.0).max_decimals(0).suffix(" decades"));
    }
    if view != View::Albedo {
        ui.checkbox(&mut plot.cosine, "times cosine");
    }
}

/// The angles that a view holds fixed.
fn angles_ui(ui: &mut Ui, plot: &mut Settings, view: View) {
    match view {
        View::Polar => wi_ui(ui, plot),
        View::ThetaV => {
            wi_ui(ui, plot);
            let mut locked = plot.phi_v == (plot.wi.phi + 180.0).rem_euclid(360.0);
            if ui.checkbox(&mut locked, "in wi's plane").changed() && !locked {
                plot.phi_v = (plot.wi.phi + 90.0).rem_euclid(360.0);
            }
            if locked {
                plot.phi_v = (plot.wi.phi + 180.0).rem_euclid(360.0);
            } else {
                angle_ui(ui, &mut plot.phi_v, "phi_v", 0.0..=360.0);
            }
        }
        View::ThetaH => {
            angle_ui(ui, &mut plot.theta_d, "theta_d", 0.0..=90.0);
            angle_ui(ui, &mut plot.phi_d, "phi_d", 0.0..=360.0);
        }
        View::ThetaD => {
            angle_ui(ui, &mut plot.theta_h, "theta_h", 0.0..=90.0);
            angle_ui(ui, &mut plot.phi_d, "phi_d", 0.0..=360.0);
        }
        View::Albedo => angle_ui(ui, &mut plot.albedo_azimuth, "azimuth", 0.0..=360.0),
        View::Slice | View::Lobe => {}
    }
}

/// The fixed direction; where `wo` lay in its plane, it goes on to.
pub(super) fn wi_ui(ui: &mut Ui, plot: &mut Settings) {
    let locked = plot.phi_v == (plot.wi.phi + 180.0).rem_euclid(360.0);
    angle_ui(ui, &mut plot.wi.theta, "theta_i", 0.0..=89.9);
    angle_ui(ui, &mut plot.wi.phi, "phi_i", 0.0..=360.0);
    if locked {
        plot.phi_v = (plot.wi.phi + 180.0).rem_euclid(360.0);
    }
}

pub(super) fn angle_ui(
    ui: &mut Ui,
    angle: &mut f64,
    name: &str,
    range: std::ops::RangeInclusive<f64>,
) {
    let drag = DragValue::new(angle).speed(0.5).range(range).max_decimals(2);
    ui.add(drag.prefix(format!("{name} ")).suffix("°"));
}
