//! What is remembered, and what becomes of it where it cannot be written.

use super::*;

fn viewer_remembering(folder: PathBuf) -> Viewer {
    let registry = Registry::new(&[]);
    let mut session = Session::new(&registry).unwrap();
    session.film.resolution = [16, 16];
    session.environment.width = Some(16);
    session.camera.yaw = 12.0;
    let document = Document::new(session);
    let cores = Some("cpu".to_owned());
    Viewer::new(registry, document, cores, Some(folder), Arc::new(|| ())).unwrap()
}

fn window_remembering(folder: PathBuf) -> Window {
    in_window(viewer_remembering(folder))
}

#[test]
fn the_scene_is_there_the_next_time() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = window_remembering(folder.path().to_owned());
    finished(&mut first);
    slide(&mut first, "Alpha along the tangent", 0.6);
    let left = first.state().scene();
    let ctx = first.ctx.clone();
    first.state_mut().remember(&ctx);
    drop(first);
    let mut second = viewer_remembering(folder.path().to_owned());
    assert!(second.scene() != left);
    second.open_last();
    assert!(second.scene() == left);
}

#[test]
fn a_folder_that_cannot_be_written_is_told_of_and_nothing_stops() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("no folder");
    std::fs::write(&file, "a file").unwrap();
    let mut window = window_remembering(file.join("brdf"));
    finished(&mut window);
    wait_for_label(&mut window, "cannot be written", true);
    slide(&mut window, "Alpha along the tangent", 0.6);
    finished(&mut window);
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "a file");
}

#[test]
fn what_is_written_stays_while_another_file_is_shown_and_until_it_is_saved() {
    let (_folder, mine, mut window) = at_work();
    write_in_editor(&mut window, "// mine\n");
    let tab = |window: &mut Window, name: &str| {
        window.get_by_label(name).click();
        window.step();
        window.step();
    };
    tab(&mut window, "plugin.toml");
    assert!(!window.get_by_role(Role::MultilineTextInput).value().unwrap().contains("// mine"));
    tab(&mut window, "mine.wgsl");
    assert!(window.get_by_role(Role::MultilineTextInput).value().unwrap().contains("// mine"));

    let close = |window: &mut Window| {
        let viewports = &mut window.input_mut().viewports;
        let root = viewports.entry(egui::ViewportId::ROOT).or_default();
        root.events.push(egui::ViewportEvent::Close);
        window.step();
        window.step();
    };
    close(&mut window);
    tab(&mut window, "go on");
    assert!(window.query_by_label("save and quit").is_none());
    close(&mut window);
    tab(&mut window, "save and quit");
    assert!(std::fs::read_to_string(mine.join("mine.wgsl")).unwrap().contains("// mine"));
}
