//! Parameters as their manifest describes them. A double click on a name takes its default back.

use brdf_sdk::manifest::Scale;
use brdf_sdk::{Manifest, Param, ParamType, ParamValue, ParamValues};
use egui::{DragValue, RichText, Sense, Slider, SliderClamping, Ui};

use super::files::{Dialogs, Purpose};
use super::parts::file_name;
use crate::tone::byte;

/// One row for each parameter. Without dialogs, files are shown and not chosen.
pub(super) fn parameters_ui(
    ui: &mut Ui,
    manifest: &Manifest,
    values: &mut ParamValues,
    dialogs: Option<&Dialogs>,
) {
    egui::Grid::new("parameters").num_columns(2).spacing([8.0, 6.0]).show(ui, |ui| {
        for param in &manifest.params {
            let Some(value) = values.get(&param.key).cloned() else { continue };
            let mut new = value.clone();
            let default = ParamValue::default_of(param);
            let label = label_ui(ui, param, value == default);
            if label.double_clicked() {
                new = default;
            }
            ui.push_id(&param.key, |ui| value_ui(ui, param, &mut new, label.id, dialogs));
            ui.end_row();
            if new != value {
                values.set(&param.key, new);
            }
        }
    });
}

fn label_ui(ui: &mut Ui, param: &Param, usual: bool) -> egui::Response {
    let name = param.label.as_ref().unwrap_or(&param.key);
    let text = RichText::new(name);
    let text = if usual { text } else { text.strong() };
    let label = ui.add(egui::Label::new(text).selectable(false).sense(Sense::click()));
    let unit = param.unit.as_ref().map(|unit| format!(" [{unit}]")).unwrap_or_default();
    label.on_hover_text(format!(
        "{}{unit}\n{}\nDouble-click: back to the default.",
        param.about,
        param.usage().replace('`', ""),
    ))
}

fn value_ui(
    ui: &mut Ui,
    param: &Param,
    value: &mut ParamValue,
    label: egui::Id,
    dialogs: Option<&Dialogs>,
) {
    match (&param.ty, value) {
        (ParamType::Float { range, slider, scale, .. }, ParamValue::Float(number)) => {
            ui.spacing_mut().slider_width = 110.0;
            let log = *scale == Scale::Log;
            let widget = Slider::new(number, slider[0]..=slider[1])
                .logarithmic(log)
                .smallest_positive(slider[0].max(1e-6))
                // Beyond the slider's ends by typing, where the manifest allows.
                .clamping(SliderClamping::Never)
                .max_decimals(6);
            ui.add(widget).labelled_by(label);
            *number = number.clamp(range[0], range[1]);
        }
        (ParamType::Int { range, slider, .. }, ParamValue::Int(number)) => {
            ui.spacing_mut().slider_width = 110.0;
            let widget = Slider::new(number, slider[0]..=slider[1]).clamping(SliderClamping::Never);
            ui.add(widget).labelled_by(label);
            *number = (*number).clamp(range[0], range[1]);
        }
        (ParamType::Bool { .. }, ParamValue::Bool(on)) => {
            ui.checkbox(on, "").labelled_by(label);
        }
        (ParamType::Color { range, .. }, ParamValue::Color(rgb)) => {
            colour_ui(ui, rgb, *range, label);
        }
        (ParamType::Choice { options, .. }, ParamValue::Choice(chosen)) => {
            let shown = chosen.clone();
            let combo = egui::ComboBox::from_id_salt("choice").selected_text(shown);
            let response = combo.show_ui(ui, |ui| {
                for option in options {
                    ui.selectable_value(chosen, option.clone(), option);
                }
            });
            response.response.labelled_by(label);
        }
        (ParamType::File { extensions, .. }, ParamValue::File(path)) => {
            let name = if path.is_empty() { "open…".to_owned() } else { file_name(path) };
            let button = ui.add_enabled(dialogs.is_some(), egui::Button::new(name));
            let button = button.labelled_by(label).on_hover_text(path.as_str());
            if let Some(dialogs) = dialogs.filter(|_| button.clicked()) {
                dialogs.ask(ui.ctx(), Purpose::Data(param.key.clone()), extensions, "");
            }
        }
        // Values come checked against their manifest.
        _ => {}
    }
}

/// A picker in linear light, the three numbers, and what sRGB they are.
fn colour_ui(ui: &mut Ui, rgb: &mut [f64; 3], range: [f64; 2], label: egui::Id) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        let mut short = rgb.map(|channel| channel as f32);
        let picker = ui.color_edit_button_rgb(&mut short).labelled_by(label);
        // The picker thinks in hues, and gives back other last digits than it took.
        if picker.changed() {
            *rgb = short.map(f64::from);
        }
        let [r, g, b] = rgb.map(|channel| byte(channel as f32));
        picker.on_hover_text(format!("linear Rec. 709; as sRGB #{r:02x}{g:02x}{b:02x}"));
        for (channel, name) in rgb.iter_mut().zip(["R", "G", "B"]) {
            let drag =
                DragValue::new(channel).speed(0.005).max_decimals(4).range(range[0]..=range[1]);
            ui.add(drag).on_hover_text(name);
        }
    });
}
