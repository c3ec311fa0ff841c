//! Pictures of the window, a view each: those of docs/viewer.md. `UPDATE_SNAPSHOTS=1` writes them anew.
//!
//! Times and rates stand in them, and the device's name: of all pixels [`DIFFERENT`] may differ.

use std::path::Path;

use egui::Key;
use egui_kittest::SnapshotOptions;
use egui_kittest::kittest::Queryable;

use super::common::{root, skip};
use super::*;

/// Pixels that a line of figures may change, and somewhat more.
const DIFFERENT: usize = 4000;

fn scene(session: &mut Session) {
    session.film.resolution = [256, 256];
    session.environment.width = Some(512);
    (session.effort.samples, session.effort.passes) = (64, Some(4));
    session.brdf = Chosen::find(&Registry::new(&[]), Kind::Brdf, "disney").unwrap();
    session.beside = vec![Chosen::find(&Registry::new(&[]), Kind::Brdf, "ggx").unwrap()];
}

/// A window with this tab in front; `None` where there is nothing to draw it with.
fn at(tab: &str) -> Option<Window> {
    if !brdf_host::exec::has_adapter() {
        skip("pictures of the window need a graphics adapter");
        return None;
    }
    let mut window = window(scene);
    finished(&mut window);
    if !tab.is_empty() {
        window.get_by_role_and_label(Role::Button, tab).click();
    }
    settle(&mut window);
    Some(window)
}

/// Draws frames until nothing is asked of other threads any more.
fn settle(window: &mut Window) {
    until(window, "answers", |viewer| (!viewer.is_waiting()).then_some(()));
    for _ in 0..20 {
        window.step();
        std::thread::sleep(Duration::from_millis(5));
        until(window, "answers", |viewer| (!viewer.is_waiting()).then_some(()));
    }
}

/// The whole window, or a part of it.
#[derive(Clone, Copy)]
enum Part {
    Whole,
    Left,
    /// What is above the problems.
    Upper,
    Above,
    Below,
}

fn snapshot(window: &mut Window, name: &str, part: Part) {
    let folder = root().join("docs").join("viewer");
    let options = SnapshotOptions::new().output_path(folder).max_failed_pixels(DIFFERENT);
    let whole = window.render().unwrap();
    let [x, y, width, height] = match part {
        Part::Whole => [0, 0, 1280, 720],
        Part::Left => [322, 26, 526, 668],
        Part::Upper => [0, 0, 1280, 560],
        Part::Above => [849, 26, 431, 334],
        Part::Below => [849, 362, 431, 332],
    };
    let shown = image::imageops::crop_imm(&whole, x, y, width, height).to_image();
    egui_kittest::try_image_snapshot_options(&shown, name, &options).unwrap();
}

fn of_tab(tab: &str, name: &str, part: Part) {
    if let Some(mut window) = at(tab) {
        snapshot(&mut window, name, part);
    }
}

#[test]
fn the_lit_object() {
    of_tab("", "lit", Part::Whole);
}

#[test]
fn curves_over_theta_v() {
    of_tab("Theta v", "theta-v", Part::Above);
}

#[test]
fn curves_over_theta_h() {
    of_tab("Theta h", "theta-h", Part::Above);
}

#[test]
fn curves_over_theta_d() {
    of_tab("Theta d", "theta-d", Part::Above);
}

#[test]
fn curves_over_albedo() {
    of_tab("Albedo", "albedo", Part::Above);
}

#[test]
fn the_image_slice() {
    of_tab("Image slice", "slice", Part::Below);
}

#[test]
fn the_environment() {
    let Some(mut window) = at("Environment") else { return };
    window.get_by_label("2000 draws").click();
    window.step();
    settle(&mut window);
    snapshot(&mut window, "environment", Part::Left);
}

#[test]
fn two_pictures_beside_each_other() {
    let Some(mut window) = at("Compare") else { return };
    choose(&mut window, "Beside", "This BRDF with other parameters");
    window.step();
    let [_, other] =
        window.get_all_by_role_and_label(Role::Slider, "Roughness").collect::<Vec<_>>()[..]
    else {
        panic!("a slider on each side")
    };
    other.set_value_accesskit(0.15);
    window.step();
    settle(&mut window);
    snapshot(&mut window, "compare", Part::Left);
}

#[test]
fn how_errors_fell() {
    if !brdf_host::exec::has_adapter() {
        return skip("pictures of the window need a graphics adapter");
    }
    let mut window = window(|session| {
        scene(session);
        session.effort.passes = Some(32);
    });
    for integrator in ["Cosine", "MIS, balance heuristic"] {
        finished(&mut window);
        choose(&mut window, "Integrator", integrator);
    }
    finished(&mut window);
    window.get_by_role_and_label(Role::Button, "Convergence").click();
    settle(&mut window);
    window.get_by_label("Other integrators of this scene stay beside.");
    // Curves against time lie elsewhere at every run: this one is written, and not compared.
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        snapshot(&mut window, "convergence", Part::Left);
    }
}

#[test]
fn draws_against_their_density() {
    let Some(mut window) = at("Sampling") else { return };
    window.get_by_label("prove sampling").click();
    window.step();
    settle(&mut window);
    window.get_by_label("sampling");
    snapshot(&mut window, "sampling", Part::Below);
}

#[test]
fn lines_that_lose_digits() {
    let Some(mut window) = at("Numerics") else { return };
    window.get_by_label("measure").click();
    window.step();
    settle(&mut window);
    snapshot(&mut window, "numerics", Part::Below);
}

#[test]
fn a_broken_file_and_the_editor() {
    if !brdf_host::exec::has_adapter() {
        return skip("pictures of the window need a graphics adapter");
    }
    // A path that is the same on every machine.
    let folder = Path::new("target").join("mine");
    let _ = std::fs::remove_dir_all(root().join(&folder));
    let mut window = authored(&root().join(&folder));
    finished(&mut window);
    write(&root().join(&folder), "mine.wgsl", BROKEN);
    until(&mut window, "a problem", |viewer| viewer.status().problem);
    window.get_by_role_and_label(Role::Button, "Editor").click();
    settle(&mut window);
    window.get_by_label_contains("The last good picture stays");
    window.get_by_label_contains("mine.wgsl:2");
    // Without the problem's line, which names a path of this machine.
    snapshot(&mut window, "editor", Part::Upper);
}

#[test]
fn the_light_theme_and_the_page_of_keys() {
    let Some(mut window) = at("") else { return };
    window.ctx.set_theme(egui::Theme::Light);
    window.key_press(Key::F1);
    window.step();
    settle(&mut window);
    snapshot(&mut window, "keys", Part::Whole);
}

#[test]
fn draws_over_the_lobe() {
    let Some(mut window) = at("") else { return };
    choose(&mut window, "Sampling of the current BRDF", "draws");
    settle(&mut window);
    snapshot(&mut window, "lobe", Part::Below);
}
