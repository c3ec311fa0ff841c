//! What stands beside the lit object, and errors against it.

use egui_kittest::kittest::NodeT;

use super::*;

fn tab(window: &mut Window, name: &str) {
    window.get_by_role_and_label(Role::Button, name).click();
    window.step();
    window.step();
}

/// Opens Compare with something to stand beside.
fn beside(window: &mut Window, words: &str) {
    finished(window);
    tab(window, "Compare");
    choose(window, "Beside", words);
}

/// The relMSE that Compare tells, once nothing changes any more.
fn relmse(window: &mut Window) -> f64 {
    let mut last = f64::NAN;
    for _ in 0..5 {
        until(window, "answers", |viewer| (!viewer.is_waiting()).then_some(()));
        wait_for_label(window, "relMSE of the lit object against the other", true);
        let label = window.get_by_label_contains("relMSE of the lit object against the other");
        let words = label.value().or_else(|| label.accesskit_node().label()).unwrap();
        last = words.split_whitespace().nth(8).unwrap().parse().unwrap();
    }
    last
}

#[test]
fn other_parameters_of_one_brdf_stand_beside_and_change_places() {
    let mut window = window(|_| ());
    beside(&mut window, "This BRDF with other parameters");
    assert_eq!(relmse(&mut window), 0.0, "the same scene from the same seed");
    let sliders = window.get_all_by_role_and_label(Role::Slider, "Alpha along the tangent");
    let sliders: Vec<_> = sliders.collect();
    let [_, other] = sliders[..] else { panic!("{} sliders", sliders.len()) };
    other.set_value_accesskit(0.7);
    window.step();
    let start = Instant::now();
    while relmse(&mut window) == 0.0 {
        assert!(start.elapsed() < PATIENCE);
    }
    let value = |window: &Window| {
        window.state().scene().brdf.configured.values.get("alpha_x").unwrap().to_toml()
    };
    assert_ne!(value(&window), "0.7");
    window.get_by_label("swap with the lit object").click();
    window.step();
    window.step();
    assert_eq!(value(&window), "0.7");
}

#[test]
fn another_environment_stands_beside() {
    let mut window = window(|_| ());
    beside(&mut window, "Environment: furnace");
    assert!(relmse(&mut window) > 0.01);
    assert_eq!(window.state().scene().environment.map, "studio");
}

/// The error against a picture of many samples: larger than nothing, and falling about as the samples rise.
#[test]
fn errors_are_taken_against_a_picture_that_is_held() {
    let mut window = window(|session| {
        session.integrator = integrator_of("mis-balance");
        session.effort.passes = Some(128);
    });
    finished(&mut window);
    tab(&mut window, "Compare");
    window.get_by_label("hold this picture").click();
    window.step();
    assert_eq!(relmse(&mut window), 0.0);
    tab(&mut window, "Convergence");
    window.get_by_label("against a reference").click();
    window.step();
    tab(&mut window, "Lit object");
    choose(&mut window, "Integrator", "Cosine");
    finished(&mut window);
    tab(&mut window, "Convergence");
    wait_for_label(&mut window, "Against the picture beside in Compare", true);
    // Another scene has no error against this picture.
    slide(&mut window, "Alpha along the tangent", 0.6);
    finished(&mut window);
    wait_for_label(&mut window, "hold a finished picture of this scene", true);
}
