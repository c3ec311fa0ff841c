//! Every plugin of the tree links with every other; every broken one is refused in its author's words.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::Path;

use brdf_host::link::{Form, View, link};
use brdf_host::session::{Chosen, Session};
use brdf_sdk::{Kind, Manifest, Problem};
use common::{brdf, integrator, registry, root};

#[test]
fn every_brdf_links_with_every_integrator() {
    let registry = registry();
    let brdfs = registry.all(Kind::Brdf);
    let integrators = registry.all(Kind::Integrator);
    assert!(brdfs.len() >= 3 && integrators.len() >= 2);
    for b in &brdfs {
        for i in &integrators {
            link(&View::Film {
                brdf: brdf(&b.id, &[]),
                integrator: integrator(&i.id, &[]),
                form: Form::default(),
            })
            .unwrap_or_else(|problem| panic!("{} with {}: {problem}", b.id, i.id));
        }
        link(&View::Eval { brdf: brdf(&b.id, &[]) }).unwrap();
    }
}

/// The examples in the document of the formats are whole files, and are read here as such.
#[test]
fn the_formats_are_as_their_document_says() {
    let text = fs::read_to_string(root().join("docs/formats.md")).unwrap();
    let blocks: Vec<&str> =
        text.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let [plugin, scene] = blocks[..] else { panic!("{} examples", blocks.len()) };
    let manifest =
        Manifest::parse("plugin.toml", plugin, "velvet").unwrap_or_else(|p| panic!("{p}"));
    assert_eq!(manifest.params.len(), 5);
    let session = Session::parse(&registry(), "scene.toml", scene, Path::new("."));
    let session = session.unwrap_or_else(|problem| panic!("{problem}"));
    // Written and read again it is the same.
    let written = session.to_toml();
    let again = Session::parse(&registry(), "scene.toml", &written, Path::new("")).unwrap();
    assert_eq!(again, session, "{written}");
}

/// Each folder under tests/cases holds a broken plugin or scene and the whole message that it gets.
/// BRDF_BLESS=1 writes the messages instead; look at them before you commit.
#[test]
fn every_broken_case_gets_its_message() {
    let folder = root().join("tests/cases");
    let mut wrong = Vec::new();
    let mut seen = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let case = entry.unwrap().path();
        seen += 1;
        let problem = match refusal(&case) {
            Some(problem) => problem.to_string(),
            None => String::from("(accepted)"),
        };
        let shown =
            problem.replace(&format!("{}/", case.display()), "").trim_end().to_owned() + "\n";
        let expected_file = case.join("expected_error.txt");
        if std::env::var_os("BRDF_BLESS").is_some() {
            fs::write(&expected_file, &shown).unwrap();
        }
        let expected = fs::read_to_string(&expected_file).unwrap_or_default();
        if shown != expected {
            wrong.push(format!("{}:\n{shown}instead of\n{expected}", case.display()));
        }
    }
    assert!(seen > 60, "the cases are gone");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn refusal(case: &Path) -> Option<Problem> {
    let scene = case.join("scene.toml");
    if scene.exists() {
        let source = fs::read_to_string(&scene).unwrap();
        return Session::parse(&registry(), "scene.toml", &source, case).err();
    }
    let path = case.to_str().unwrap();
    let manifest = fs::read_to_string(case.join("plugin.toml")).unwrap();
    let view = |kind| {
        let found = Chosen::find(&registry(), kind, path)?.configured;
        Ok(match kind {
            Kind::Brdf => View::Film {
                brdf: found,
                integrator: integrator("brdf-is", &[]),
                form: Form::default(),
            },
            Kind::Integrator => {
                View::Film { brdf: brdf("ggx", &[]), integrator: found, form: Form::default() }
            }
        })
    };
    let kind =
        if manifest.contains("kind = \"integrator\"") { Kind::Integrator } else { Kind::Brdf };
    view(kind).and_then(|view| link(&view)).err()
}
