//! Pieces that several views are made of: areas, pictures in them, bars of colours, names. They know of no view.

use egui::{Color32, Pos2, Rect, Response, Role, Sense, TextureId, Ui, Vec2};

use crate::picture::Scale;

/// What is left of a view above so many lines of text, to be dragged in.
pub(super) fn area_ui(ui: &mut Ui, lines: f32) -> (Rect, Response) {
    let line = ui.text_style_height(&egui::TextStyle::Body) + ui.spacing().item_spacing.y;
    let space = ui.available_size() - Vec2::new(0.0, lines * line);
    ui.allocate_exact_size(space.max(Vec2::splat(16.0)), Sense::click_and_drag())
}

/// The largest rectangle of these proportions in the middle of an area.
pub(super) fn fitted(area: Rect, size: Vec2) -> Rect {
    let scale = (area.width() / size.x).min(area.height() / size.y);
    Rect::from_center_size(area.center(), size * scale)
}

/// Draws a whole texture.
pub(super) fn draw(ui: &Ui, texture: TextureId, rect: Rect) {
    let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
    ui.painter().image(texture, rect, whole, Color32::WHITE);
}

/// What the colours of a picture mean: a bar in its lower left corner, with the numbers of both ends.
pub(super) fn bar_ui(ui: &Ui, picture: Rect, scale: &Scale) {
    const BAR: Vec2 = Vec2::new(128.0, 10.0);
    const STEPS: usize = 64;
    let font = egui::FontId::proportional(11.0);
    let paper = Rect::from_min_size(
        picture.left_bottom() + Vec2::new(6.0, -36.0),
        BAR + Vec2::new(16.0, 20.0),
    );
    ui.painter().rect_filled(paper, 3.0, Color32::from_black_alpha(180));
    let bar = Rect::from_min_size(paper.min + Vec2::new(8.0, 4.0), BAR);
    let width = BAR.x / STEPS as f32;
    for step in 0..STEPS {
        let place = (step as f64 + 0.5) / STEPS as f64;
        let [r, g, b] = scale.colour(scale.value(place));
        let least = bar.min + Vec2::new(step as f32 * width, 0.0);
        let part = Rect::from_min_size(least, Vec2::new(width + 0.5, BAR.y));
        ui.painter().rect_filled(part, 0.0, Color32::from_rgb(r, g, b));
    }
    let ticks = scale.ticks();
    let least = ticks.iter().min_by(|a, b| a.0.total_cmp(&b.0));
    let most = ticks.iter().max_by(|a, b| a.0.total_cmp(&b.0));
    for (tick, align) in [(least, egui::Align2::LEFT_TOP), (most, egui::Align2::RIGHT_TOP)] {
        let Some((place, words)) = tick else { continue };
        let x = bar.left() + *place as f32 * bar.width();
        let at = Pos2::new(x, bar.bottom() + 1.0);
        ui.painter().text(at, align, words, font.clone(), Color32::WHITE);
    }
}

/// A texture of its own size in points.
pub(super) fn picture_ui(ui: &mut Ui, texture: TextureId, size: Vec2) -> (Rect, Response) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    draw(ui, texture, rect);
    (rect, response)
}

/// Column and row under the pointer of a picture in `rect`, from its upper left corner; none beside it.
pub(super) fn pixel_at(rect: Rect, pointer: Option<Pos2>, size: [usize; 2]) -> Option<[usize; 2]> {
    let at = pointer.filter(|at| rect.contains(*at))?;
    let part = (at - rect.min) / rect.size();
    let pixel = |part: f32, count: usize| ((part * count as f32) as usize).min(count - 1);
    Some([pixel(part.x, size[0]), pixel(part.y, size[1])])
}

/// The name by which a combo box is found.
pub(super) fn named(response: &Response, name: &'static str) {
    response.clone().on_hover_text(name);
    response.widget_info(|| egui::WidgetInfo::labeled(Role::ComboBox, true, name));
}

/// The last part of a path, or a name as it is.
pub(super) fn file_name(path: &str) -> String {
    let name = std::path::Path::new(path).file_name();
    name.map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// An angle in [-180, 180).
pub(super) fn wrapped(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}
