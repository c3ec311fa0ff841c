//! The viewer without its window: what is clicked, typed, saved and dropped, and what is seen of it.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

#[path = "../common/mod.rs"]
mod common;
mod compare;
mod memory;
mod mistakes;
mod pictures;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use brdf_host::live::{Document, Doing, Frame};
use brdf_host::registry::Registry;
use brdf_host::session::{Chosen, Session};
use brdf_host::ui::Viewer;
use brdf_sdk::Kind;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

/// Nothing here takes as long on any machine.
const PATIENCE: Duration = Duration::from_secs(120);

type Window = Harness<'static, Viewer>;

/// A viewer of a small scene, rendered on the cores.
fn window(change: impl FnOnce(&mut Session)) -> Window {
    let registry = Registry::new(&[]);
    let mut session = Session::new(&registry).unwrap();
    session.film.resolution = [96, 64];
    session.environment.width = Some(64);
    (session.effort.samples, session.effort.passes) = (16, Some(4));
    change(&mut session);
    window_of(registry, session)
}

fn window_of(registry: Registry, session: Session) -> Window {
    let viewer = Viewer::new(
        registry,
        Document::new(session),
        Some("cpu".to_owned()),
        None,
        Arc::new(|| ()),
    )
    .unwrap();
    in_window(viewer)
}

fn in_window(viewer: Viewer) -> Window {
    Harness::builder().with_size([1280.0, 720.0]).build_ui_state(
        |ui, viewer: &mut Viewer| {
            viewer.logic(&ui.ctx().clone());
            viewer.ui(ui);
        },
        viewer,
    )
}

/// Draws frames until something is so.
fn until<T>(window: &mut Window, what: &str, found: impl Fn(&Viewer) -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        window.step();
        if let Some(found) = found(window.state()) {
            return found;
        }
        assert!(start.elapsed() < PATIENCE, "{what}: {:?}", window.state().status().problem);
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The finished picture of the scene as it is now.
fn finished(window: &mut Window) -> Arc<Frame> {
    until(window, "a finished picture", |viewer| {
        let frame = viewer.status().frame?;
        let mut wanted = viewer.scene();
        wanted.beside.clear();
        let mut shown = (*frame.session).clone();
        shown.beside.clear();
        (frame.complete && shown == wanted).then_some(frame)
    })
}

fn slide(window: &mut Window, name: &str, value: f64) {
    window.get_by_role_and_label(Role::Slider, name).set_value_accesskit(value);
    window.step();
}

/// Chooses in a list; what is wanted begins with these words.
fn choose(window: &mut Window, list: &str, words: &str) {
    window.get_by_role_and_label(Role::ComboBox, list).click();
    window.step();
    window.step();
    window.get_by_label(words).click();
    window.step();
}

fn integrator_of(name: &str) -> Chosen {
    Chosen::find(&Registry::new(&[]), Kind::Integrator, name).unwrap()
}

/// The picture that the command line makes of the same scene, on the same executor.
fn headless(scene: &Session) -> Vec<[f32; 3]> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.toml");
    std::fs::write(&file, scene.to_toml()).unwrap();
    let picture = folder.path().join("picture");
    let done = std::process::Command::new(env!("CARGO_BIN_EXE_brdf"))
        .args(["render", "--device", "cpu", "--session"])
        .arg(&file)
        .arg("--export")
        .arg(&picture)
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    brdf_host::picture::read::read(&picture.with_extension("exr")).unwrap().rgb
}

#[test]
fn the_window_and_the_command_line_make_the_same_picture() {
    for integrator in ["brdf-is", "convolution"] {
        let mut window = window(|session| {
            session.integrator = integrator_of(integrator);
            session.film.resolution = [40, 30];
            session.environment.width = Some(16);
        });
        let frame = finished(&mut window);
        assert_eq!(frame.picture.rgb, headless(&window.state().scene()));
    }
}

#[test]
fn a_slider_changes_the_picture_and_undo_takes_it_back() {
    let mut window = window(|_| ());
    let before = finished(&mut window);
    slide(&mut window, "Alpha along the tangent", 0.6);
    let after = finished(&mut window);
    assert_ne!(before.picture.rgb, after.picture.rgb);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.step();
    let undone = finished(&mut window);
    assert_eq!(before.picture.rgb, undone.picture.rgb);
    window.key_press_modifiers(egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::Z);
    window.step();
    assert_eq!(finished(&mut window).picture.rgb, after.picture.rgb);
}

#[test]
fn another_integrator_takes_over_in_the_midst_of_a_picture() {
    // A million samples of a pixel: nobody waits for the last one.
    let mut window = window(|session| session.effort.passes = Some(1 << 16));
    until(&mut window, "a picture under way", |viewer| {
        let frame = viewer.status().frame?;
        (!frame.preview && frame.done > 0).then_some(())
    });
    choose(&mut window, "Integrator", "Cosine");
    let frame = until(&mut window, "the other integrator's picture", |viewer| {
        let frame = viewer.status().frame?;
        let id = &frame.session.integrator.configured.plugin.id;
        (id == "cosine" && !frame.preview).then_some(frame)
    });
    assert!(!frame.complete);
}

/// A BRDF on disk, in a viewer.
fn authored(folder: &Path) -> Window {
    std::fs::create_dir_all(folder).unwrap();
    write(folder, "plugin.toml", MANIFEST);
    write(folder, "mine.wgsl", GREY);
    let folder = folder.to_owned();
    window(move |session| {
        let reference = folder.display().to_string();
        session.brdf = Chosen::find(&Registry::new(&[]), Kind::Brdf, &reference).unwrap();
    })
}

/// The same in a folder of its own, once its first picture is done.
fn at_work() -> (tempfile::TempDir, PathBuf, Window) {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine");
    let mut window = authored(&mine);
    finished(&mut window);
    (folder, mine, window)
}

const MANIFEST: &str = "kind = \"brdf\"\nname = \"Mine\"\nabout = \"A test's own.\"\n\n[params.grey]\n\
                        type = \"float\"\ndefault = 0.5\nrange = [0.0, 1.0]\nlabel = \"Grey\"\n\
                        about = \"How bright it is.\"\n";
const GREY: &str =
    "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    return vec3f(p.grey) * INV_PI;\n}\n";
const RED: &str = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    return vec3f(p.grey, 0.0, 0.0) * INV_PI;\n}\n";
const BROKEN: &str =
    "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    return vec3f(p.gray) * INV_PI;\n}\n";

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

#[test]
fn a_saved_file_is_seen_and_a_broken_one_is_told_and_keeps_the_picture() {
    let (_folder, mine, mut window) = at_work();
    slide(&mut window, "Grey", 0.8);
    let before = finished(&mut window);

    write(&mine, "mine.wgsl", BROKEN);
    let problem = until(&mut window, "a problem", |viewer| viewer.status().problem);
    assert_eq!(problem.place.as_ref().unwrap().line, 2, "{problem}");
    window.step();
    window.get_by_label_contains("The last good picture stays");
    // What worked goes on, and takes other numbers still.
    slide(&mut window, "Grey", 0.4);
    let darker = until(&mut window, "a darker picture", |viewer| {
        let frame = viewer.status().frame?;
        let grey = frame.session.brdf.configured.values.get("grey")?.to_toml();
        (grey == "0.4" && frame.complete).then_some(frame)
    });
    assert_ne!(before.picture.rgb, darker.picture.rgb);
    slide(&mut window, "Grey", 0.8);

    write(&mine, "mine.wgsl", RED);
    until(&mut window, "no problem", |viewer| viewer.status().problem.is_none().then_some(()));
    let red = finished(&mut window);
    let grey = red.session.brdf.configured.values.get("grey").unwrap().to_toml();
    assert_eq!(grey, "0.8", "parameters are kept by name");
    let covered = red.picture.coverage.iter().position(|covered| *covered > 0.0).unwrap();
    assert_eq!(red.picture.rgb[covered][1], 0.0);

    // Undo takes the slider back, and not the file.
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.step();
    let undone = finished(&mut window);
    assert_ne!(undone.session.brdf.configured.values, red.session.brdf.configured.values);
    assert_eq!(undone.picture.rgb[covered][1], 0.0);
}

#[test]
fn a_broken_manifest_is_told_and_mended() {
    let (_folder, mine, mut window) = at_work();
    write(&mine, "plugin.toml", "kind = brdf");
    wait_for_label(&mut window, "plugin.toml", true);
    write(&mine, "plugin.toml", MANIFEST);
    wait_for_label(&mut window, "plugin.toml", false);
}

fn wait_for_label(window: &mut Window, part: &str, there: bool) {
    let start = Instant::now();
    while window.query_all_by_label_contains(part).next().is_some() != there {
        assert!(start.elapsed() < PATIENCE, "{part}");
        std::thread::sleep(Duration::from_millis(5));
        window.step();
    }
}

/// A file as the system drops it on a window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("nobody asks".to_owned())
    }
}

fn drop_on(window: &mut Window, path: &Path) {
    window.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    window.step();
}

#[test]
fn files_are_dropped_and_known_by_their_content() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window(|_| ());
    let mine = folder.path().join("mine");
    std::fs::create_dir(&mine).unwrap();
    write(&mine, "plugin.toml", MANIFEST);
    write(&mine, "mine.wgsl", GREY);
    drop_on(&mut window, &mine);
    assert_eq!(window.state().scene().brdf.configured.plugin.id, "mine");
    assert_eq!(window.state().scene().beside.len(), 1, "the other one stays open");

    let mesh = folder.path().join("triangle.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    drop_on(&mut window, &mesh);
    assert_eq!(window.state().scene().shape, mesh.display().to_string());

    let scene = folder.path().join("scene.toml");
    let mut wanted = window.state().scene();
    wanted.camera.yaw = 33.0;
    std::fs::write(&scene, wanted.to_toml()).unwrap();
    drop_on(&mut window, &scene);
    assert_eq!(window.state().scene().camera.yaw, 33.0);
    assert_eq!(window.state().scene().beside.len(), 1, "scenes hold what is open beside");

    let before = window.state().scene();
    let broken = folder.path().join("broken.obj");
    std::fs::write(&broken, "no mesh").unwrap();
    drop_on(&mut window, &broken);
    window.step();
    assert_eq!(window.state().scene(), before, "nothing is lost");
    window.get_by_label_contains("broken.obj");
}

/// Opens the editor, which shows the file as it is, and types.
fn write_in_editor(window: &mut Window, text: &str) {
    window.get_by_role_and_label(Role::Button, "Editor").click();
    window.step();
    window.step();
    let field = window.get_by_role(Role::MultilineTextInput);
    assert_eq!(field.value().unwrap().trim(), GREY.trim());
    field.focus();
    window.step();
    window.get_by_role(Role::MultilineTextInput).type_text(text);
    window.step();
    window.step();
}

#[test]
fn the_editor_writes_the_file_that_others_write_too() {
    let (_folder, mine, mut window) = at_work();
    write_in_editor(&mut window, "// mine\n");
    window.get_by_label_contains("Ctrl+S saves");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    window.step();
    window.step();
    let written = std::fs::read_to_string(mine.join("mine.wgsl")).unwrap();
    assert!(written.contains("// mine"), "{written}");
    // Another editor's text comes in.
    write(&mine, "mine.wgsl", RED);
    let start = Instant::now();
    while window.get_by_role(Role::MultilineTextInput).value().unwrap().trim() != RED.trim() {
        assert!(start.elapsed() < PATIENCE);
        window.step();
    }
}

#[test]
fn plugins_that_appear_on_disk_appear_in_the_list() {
    let folder = tempfile::tempdir().unwrap();
    let registry = Registry::new(&[folder.path().to_owned()]);
    let mut session = Session::new(&registry).unwrap();
    session.film.resolution = [16, 16];
    session.environment.width = Some(16);
    let mut window = window_of(registry, session);
    window.step();
    let fresh = folder.path().join("brdf").join("fresh");
    std::fs::create_dir_all(&fresh).unwrap();
    write(&fresh, "plugin.toml", &MANIFEST.replace("Mine", "Fresh"));
    write(&fresh, "fresh.wgsl", GREY);
    window.get_by_label("add…").click();
    window.step();
    wait_for_label(&mut window, "Fresh", true);
    std::fs::remove_dir_all(&fresh).unwrap();
    wait_for_label(&mut window, "Fresh", false);
}

#[test]
fn everything_is_found_by_its_name() {
    let mut window = window(|_| ());
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::P);
    window.step();
    window.step();
    window.event(egui::Event::Text("lamb".to_owned()));
    window.step();
    window.step();
    window.key_press(egui::Key::Enter);
    window.step();
    window.step();
    assert_eq!(window.state().scene().brdf.configured.plugin.id, "lambert");
}

#[test]
fn the_palette_does_what_was_typed_although_enter_comes_in_the_same_frame() {
    let mut window = window(|_| ());
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::P);
    window.step();
    window.step();
    let enter = egui::Event::Key {
        key: egui::Key::Enter,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: egui::Modifiers::NONE,
    };
    window.input_mut().events.extend([egui::Event::Text("shape torus".to_owned()), enter]);
    window.step();
    window.step();
    assert_eq!(window.state().scene().shape, "torus");
}

/// Keys that come together count one by one, and what lies beneath gets none of them.
#[test]
fn the_palette_has_its_keys_to_itself() {
    let mut window = window(|_| ());
    let before = window.state().scene();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::P);
    window.step();
    window.input_mut().events.push(egui::Event::Text("shape".to_owned()));
    window.step();
    let pressed = |key| egui::Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: egui::Modifiers::NONE,
    };
    let keys = [egui::Key::ArrowDown, egui::Key::ArrowDown, egui::Key::Enter];
    window.input_mut().events.extend(keys.map(pressed));
    window.step();
    window.step();
    let after = window.state().scene();
    assert_eq!(after.shape, brdf_host::scene::Shape::NAMES[2]);
    assert_eq!(after.brdf, before.brdf);
    assert_eq!(after.film, before.film);
}

/// The way to a plot's file where the system has no dialogs.
#[test]
fn the_palette_saves_plots() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window(|_| ());
    let drawing = folder.path().join("polar.svg");
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Num4);
    window.step();
    until(&mut window, "answers", |viewer| (!viewer.is_waiting()).then_some(()));
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::P);
    window.step();
    window.step();
    window.input_mut().events.push(egui::Event::Text(drawing.display().to_string()));
    window.step();
    window.step();
    let entry = format!("Save the plot `polar` as {}", drawing.display());
    window.get_by_label(&entry).click();
    window.step();
    window.step();
    assert!(std::fs::read_to_string(&drawing).unwrap().starts_with("<svg"));
}

#[test]
fn a_drag_turns_the_camera_and_with_shift_the_environment() {
    let mut window = window(|_| ());
    finished(&mut window);
    let before = window.state().scene();
    let at = window.get_by_role_and_label(Role::Image, "Lit object").rect().center();
    window.drag_at(at);
    window.step();
    window.hover_at(at + egui::vec2(50.0, 0.0));
    window.step();
    window.drop_at(at + egui::vec2(50.0, 0.0));
    window.step();
    let after = window.state().scene();
    assert!(after.camera.yaw < before.camera.yaw, "{:?}", after.camera);
    assert_eq!(after.environment, before.environment);
    finished(&mut window);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    window.step();
    assert_eq!(window.state().scene().camera, before.camera, "a drag is one step");
}

#[test]
fn a_scene_is_saved_to_the_file_that_it_came_from() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = ["one.toml", "other.toml"].map(|name| folder.path().join(name));
    let mut window = window(|_| ());
    for (path, yaw) in [(&one, 10.0), (&other, 20.0)] {
        let mut scene = window.state().scene();
        scene.camera.yaw = yaw;
        std::fs::write(path, scene.to_toml()).unwrap();
    }
    let text = |path: &Path| std::fs::read_to_string(path).unwrap();
    drop_on(&mut window, &one);
    slide(&mut window, "Alpha along the tangent", 0.6);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    window.step();
    assert!(text(&one).contains("alpha_x = 0.6") && text(&one).contains("yaw = 10.0"));
    drop_on(&mut window, &other);
    slide(&mut window, "Alpha along the tangent", 0.7);
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::S);
    window.step();
    assert!(text(&other).contains("alpha_x = 0.7") && text(&other).contains("yaw = 20.0"));
    assert!(text(&one).contains("alpha_x = 0.6"), "the scene before is not written over");
}
