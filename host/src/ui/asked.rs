//! Numbers of plots: what is asked for, on a desk, and what becomes a file.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use brdf_sdk::{Problem, Result};
use clap::ValueEnum;
use egui::Ui;

use super::files::Purpose;
use super::viewer::State;
use crate::exec::Executor;
use crate::figure;
use crate::live::{Answered, Asked};
use crate::picture::write_text;
use crate::plot::{Channels, Named, Plot, Settings, View, rows, shown, told_apart};
use crate::plugin::Configured;

/// What a plot is asked for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Question {
    pub view: View,
    pub settings: Settings,
    pub named: Vec<Named>,
    /// The colour of each.
    pub pens: Vec<usize>,
    by_samples: Configured,
}

/// A plot's numbers.
pub(super) struct Answer {
    pub question: Question,
    pub plot: Plot,
    pub notes: Vec<String>,
}

/// The plots that were asked for.
#[derive(Default)]
pub(super) struct Plots {
    pub asked: HashMap<View, Asked<Question, Answer>>,
}

impl Plots {
    /// The views that have numbers, in the order of the command line's.
    pub(super) fn views(&self) -> Vec<View> {
        let has = |view: &&View| self.asked.get(view).is_some_and(|asked| asked.answer().is_some());
        View::value_variants().iter().filter(has).copied().collect()
    }

    /// Whether an answer is still to come.
    pub(super) fn is_waiting(&self) -> bool {
        self.asked.values().any(Asked::is_waiting)
    }
}

/// The newest numbers of a view for the BRDFs that plots show.
pub(super) fn ask(state: &mut State, view: View) -> Option<Arc<Answered<Answer>>> {
    let question = question(state, view);
    let asked = state.plots.asked.entry(view).or_default();
    asked.ask(&state.desk, &question, answer);
    asked.answer()
}

fn question(state: &State, view: View) -> Question {
    let plotted = state.document.plotted();
    let names: Vec<String> = plotted.iter().map(|m| m.chosen.name().to_owned()).collect();
    let named = std::iter::zip(told_apart(&names), &plotted)
        .map(|(name, material)| Named { name, brdf: material.chosen.configured.clone() });
    let usual = Settings::default();
    let mut settings = state.document.plot;
    // What only the drawing shows needs no other numbers.
    (settings.eye, settings.exposure, settings.chroma) = (usual.eye, usual.exposure, usual.chroma);
    if view == View::Lobe && settings.rgb() {
        settings.channels = Channels::Luminance;
    }
    Question {
        view,
        settings,
        named: named.collect(),
        pens: plotted.iter().map(|material| material.pen).collect(),
        by_samples: state.by_samples.clone(),
    }
}

fn answer(question: &Question, executor: &mut dyn Executor) -> Result<Answer> {
    let mut question = question.clone();
    let mut notes = Vec::new();
    let drawn = |question: &Question, executor: &mut dyn Executor| {
        let Question { view, settings, named, by_samples, .. } = question;
        shown(executor, by_samples, *view, settings, named)
    };
    let plot = match drawn(&question, executor) {
        // One that is broken takes no other with it.
        Err(problem) if question.named.len() > 1 => {
            let all = std::iter::zip(&question.named, &question.pens);
            // What is wrong with a file shows only where it is read.
            let mut works = |one: &Named| {
                let alone = Question { named: vec![one.clone()], ..question.clone() };
                drawn(&alone, executor).map(|_| ())
            };
            let (mut named, mut pens) = (Vec::new(), Vec::new());
            for (one, pen) in all {
                match works(one) {
                    Ok(()) => {
                        named.push(one.clone());
                        pens.push(*pen);
                    }
                    Err(problem) => {
                        notes.push(format!("{} is left out: {}", one.name, problem.line()));
                    }
                }
            }
            if named.is_empty() || named.len() == question.named.len() {
                return Err(problem);
            }
            (question.named, question.pens) = (named, pens);
            drawn(&question, executor)?
        }
        other => other?,
    };
    notes.extend(executor.take_notes());
    notes.extend(figure::notes(&plot, &question.settings));
    Ok(Answer { question, plot, notes })
}

/// The button that saves a view.
pub(super) fn save_ui(ui: &mut Ui, state: &mut State, view: View) {
    let button = ui.button("save…").on_hover_text("A drawing (.svg) or its numbers (.csv).");
    if button.clicked() {
        let endings = ["svg", "csv"].map(str::to_owned);
        let name = view.to_possible_value().map(|word| format!("{}.svg", word.get_name()));
        let name = name.unwrap_or_default();
        state.dialogs.ask(ui.ctx(), Purpose::SavePlot(view), &endings, &name);
    }
}

/// Writes a view as it is shown: a drawing, or rows of numbers.
pub(super) fn save(state: &State, view: View, path: &Path) -> Result<String> {
    let shown = path.display().to_string();
    let answer = state.plots.asked.get(&view).and_then(Asked::answer);
    let answer = answer.ok_or_else(|| {
        Problem::new(&shown, "this view has no numbers yet", "open its tab, then save again")
    })?;
    let Settings { eye, exposure, chroma, .. } = state.document.plot;
    let settings = Settings { eye, exposure, chroma, ..answer.question.settings };
    let text = match path.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => figure::svg(&answer.plot, &settings, &answer.question.pens)?,
        Some("csv") => rows(&answer.plot),
        _ => {
            let cure = "end the name in .svg or in .csv";
            return Err(Problem::new(shown, "a plot is a drawing or rows of numbers", cure));
        }
    };
    write_text(path, &text)?;
    Ok(format!("wrote {shown}"))
}
