//! What is wrong, where, and what helps.

use std::process::Command;

use brdf_sdk::Problem;
use egui::{RichText, ScrollArea, Ui};

use super::viewer::State;

/// What was refused last, what is wrong with files, and with what is rendered.
fn all(state: &State) -> impl Iterator<Item = &Problem> {
    state.refused.iter().chain(&state.problems).chain(&state.status.problem)
}

/// Whether there is any.
pub(super) fn any(state: &State) -> bool {
    all(state).next().is_some()
}

pub(super) fn problems_ui(ui: &mut Ui, state: &mut State) {
    let problems: Vec<Problem> = all(state).cloned().collect();
    ui.horizontal(|ui| {
        ui.strong(match problems.len() {
            1 => "A problem".to_owned(),
            count => format!("{count} problems"),
        });
        if state.status.problem.is_some() && state.status.frame.is_some() {
            ui.label("The last good picture stays.");
        }
        let may_go = !state.problems.is_empty() || state.refused.is_some();
        if may_go && ui.small_button("dismiss").clicked() {
            state.problems.clear();
            state.refused = None;
        }
    });
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        for (index, problem) in problems.iter().enumerate() {
            ui.push_id(index, |ui| problem_ui(ui, problem, &mut state.message));
        }
    });
}

/// A red that is read on the ground of either theme.
fn red(ui: &Ui) -> egui::Color32 {
    match ui.visuals().dark_mode {
        true => egui::Color32::from_rgb(255, 125, 115),
        false => egui::Color32::from_rgb(176, 28, 20),
    }
}

fn problem_ui(ui: &mut Ui, problem: &Problem, message: &mut String) {
    ui.label(RichText::new(problem.line()).color(red(ui)));
    let Some(place) = &problem.place else { return };
    let under = " ".repeat(place.column.saturating_sub(1)) + &"^".repeat(place.length.max(1));
    ui.label(RichText::new(format!("{}\n{under}", place.excerpt)).monospace());
    ui.horizontal(|ui| {
        let at = format!("{}:{}:{}", problem.thing, place.line, place.column);
        if ui.small_button("copy place").on_hover_text(&at).clicked() {
            ui.ctx().copy_text(at.clone());
            *message = format!("copied {at}");
        }
        if ui.small_button("open in editor").on_hover_text("By $VISUAL or $EDITOR.").clicked() {
            *message = edit(problem, place.line);
        }
    });
}

/// Opens a file at a line, and says what became of it.
fn edit(problem: &Problem, line: usize) -> String {
    let editor = std::env::var("VISUAL").or_else(|_| std::env::var("EDITOR"));
    let Ok(editor) = editor else {
        return "set VISUAL or EDITOR to an editor with a window of its own".to_owned();
    };
    let mut words = editor.split_whitespace();
    let Some(program) = words.next() else { return "EDITOR is empty".to_owned() };
    let file = &problem.thing;
    let started = Command::new(program).args(words).arg(format!("+{line}")).arg(file).spawn();
    match started {
        Ok(_) => format!("opened {file} by {program}"),
        Err(error) => format!("{program} does not start ({error}); set EDITOR to another"),
    }
}
