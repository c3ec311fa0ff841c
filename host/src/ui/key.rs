//! Names beside samples of their curves, in rows above what they are drawn in, where they hide nothing.

use egui::{Color32, Sense, Shape, Stroke, Ui, Vec2};

/// Length of a sample.
const SAMPLE: f32 = 18.0;

/// A curve's name, its colour, and whether it is dashed.
pub(super) type Named<'a> = (&'a str, Color32, bool);

pub(super) fn key_ui<'a>(ui: &mut Ui, all: impl IntoIterator<Item = Named<'a>>) {
    ui.horizontal_wrapped(|ui| {
        for (name, colour, dashed) in all {
            // A name stays with its sample when the row ends.
            let text = egui::WidgetText::from(name).into_galley(
                ui,
                Some(egui::TextWrapMode::Truncate),
                (ui.max_rect().width() - SAMPLE - 12.0).max(40.0),
                egui::TextStyle::Small,
            );
            let size = Vec2::new(SAMPLE + 5.0 + text.size().x, text.size().y.max(12.0));
            let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
            let label = || egui::WidgetInfo::labeled(egui::Role::Label, true, name);
            response.widget_info(label);
            let middle = rect.left_center();
            let ends = [middle, middle + Vec2::new(SAMPLE, 0.0)];
            let stroke = Stroke::new(2.0, colour);
            match dashed {
                true => ui.painter().extend(Shape::dashed_line(&ends, stroke, 4.0, 3.0)),
                false => _ = ui.painter().line_segment(ends, stroke),
            }
            let place = middle + Vec2::new(SAMPLE + 5.0, -0.5 * text.size().y);
            ui.painter().galley(place, text, ui.visuals().text_color());
        }
    });
}
