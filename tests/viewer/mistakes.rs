//! What becomes of the picture while a plugin's files are wrong, or gone.

use egui_kittest::kittest::NodeT;

use super::*;

/// One whose loop has no end for any direction.
const ENDLESS: &str = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {\n    var x = p.grey;\n    \
                       loop {\n        x = fract(1.7 * x + 0.1);\n        if x > 2.0 {\n            break;\n        \
                       }\n    }\n    return vec3f(x);\n}\n";

/// The picture of these numbers, finished.
fn finished_at(window: &mut Window, grey: &str) -> Arc<Frame> {
    until(window, "a picture of these numbers", |viewer| {
        let frame = viewer.status().frame?;
        let shown = frame.session.brdf.configured.values.get("grey")?.to_toml();
        (shown == grey && frame.complete).then_some(frame)
    })
}

#[test]
fn a_finished_picture_stays_as_it_is_where_a_mistake_is_saved() {
    let (_folder, mine, mut window) = at_work();
    let at_rest = |window: &mut Window, wrong: bool| {
        until(window, "nothing left to do", |viewer| {
            let status = viewer.status();
            let told = status.problem.is_some() == wrong && status.doing == Doing::Waiting;
            told.then_some(status.frame.filter(|frame| frame.complete)?.number)
        })
    };
    for wrong in [BROKEN, ENDLESS] {
        let before = at_rest(&mut window, false);
        write(&mine, "mine.wgsl", wrong);
        assert_eq!(at_rest(&mut window, true), before, "the picture was begun anew");
        write(&mine, "mine.wgsl", GREY);
    }
    at_rest(&mut window, false);
}

#[test]
fn sliders_stay_in_the_hand_while_a_mistake_is_told() {
    let (_folder, mine, mut window) = at_work();
    let grey =
        |window: &Window| window.get_by_role_and_label(Role::Slider, "Grey").accesskit_node().id();
    let before = grey(&window);
    write(&mine, "mine.wgsl", BROKEN);
    wait_for_label(&mut window, "The last good picture stays", true);
    assert_eq!(grey(&window), before);
}

#[test]
fn behind_an_endless_loop_sliders_still_work_and_other_mistakes_are_told_by_themselves() {
    let (_folder, mine, mut window) = at_work();
    let before = finished(&mut window);
    write(&mine, "mine.wgsl", ENDLESS);
    let problem = until(&mut window, "a problem", |viewer| viewer.status().problem);
    assert!(problem.reason.contains("endless") || problem.cure.contains("endless"), "{problem}");
    slide(&mut window, "Grey", 0.4);
    assert_ne!(before.picture.rgb, finished_at(&mut window, "0.4").picture.rgb);

    write(&mine, "mine.wgsl", BROKEN);
    until(&mut window, "the other problem", |viewer| {
        let place = viewer.status().problem?.place?;
        (place.line == 2).then_some(())
    });
    slide(&mut window, "Grey", 0.6);
    finished_at(&mut window, "0.6");
}

#[test]
fn a_folder_that_is_gone_is_told_of_and_another_one_in_its_place_is_followed() {
    let (_folder, mine, mut window) = at_work();
    let before = finished(&mut window);
    std::fs::remove_dir_all(&mine).unwrap();
    wait_for_label(&mut window, "there is no such plugin folder", true);
    assert_eq!(window.state().status().frame.unwrap().number, before.number);
    std::fs::create_dir(&mine).unwrap();
    write(&mine, "plugin.toml", MANIFEST);
    write(&mine, "mine.wgsl", RED);
    for text in [RED, GREY, RED] {
        write(&mine, "mine.wgsl", text);
        until(&mut window, "the folder's picture", |viewer| {
            let frame = viewer.status().frame.filter(|frame| frame.complete)?;
            let covered = frame.picture.coverage.iter().position(|covered| *covered > 0.0)?;
            ((frame.picture.rgb[covered][1] == 0.0) == (text == RED)).then_some(())
        });
    }
}
