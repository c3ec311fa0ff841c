//! Pictures below `docs`: each is shown by a page and made by a script, a verb or a test.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::common::root;
use super::links;
use super::page::Page;

/// Files below `docs` that are no pages, from the root of the tree.
fn pictures() -> Vec<PathBuf> {
    fn gather(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(root().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let path = folder.join(&name);
            // What a failed test of pictures leaves.
            let left =
                [".diff.png", ".old.png", ".new.png"].iter().any(|ending| name.ends_with(ending));
            match root().join(&path).is_dir() {
                true => gather(&path, found),
                false if name.ends_with(".md") || left => {}
                false => found.push(path),
            }
        }
    }
    let mut found = Vec::new();
    gather(Path::new("docs"), &mut found);
    found.sort();
    assert!(found.len() > 100, "the pictures are gone: {found:?}");
    found
}

pub fn every_picture_is_shown() {
    let mut shown = BTreeSet::new();
    for page in Page::all() {
        shown.extend(
            links::targets(&page)
                .into_iter()
                .map(|(_, target)| links::joined(page.folder(), &target)),
        );
    }
    let mut unseen = pictures();
    unseen.retain(|picture| !shown.contains(picture));
    assert!(unseen.is_empty(), "no page shows {unseen:?}");
}

/// By the folder it lies in, a picture has a maker that names it.
pub fn every_picture_is_made_by_something() {
    let text = |file: &str| fs::read_to_string(root().join(file)).unwrap();
    let (script, plots, window) =
        (text("scripts/pictures"), text("docs/plots.md"), text("tests/viewer/pictures.rs"));
    let plugin = |name: &str| root().join("plugins/brdf").join(name).is_dir();
    let benched = |page: &str| text(page).contains("Made by `brdf bench`");
    let made = |picture: &PathBuf| {
        let stem = picture.file_stem().unwrap().to_str().unwrap();
        match picture.parent().unwrap().to_str().unwrap() {
            "docs/catalogue" => plugin(stem) && script.contains("brdf docs"),
            "docs/plots" => {
                plots.contains(&format!(" -o plots/{stem}.svg\n"))
                    && script.contains("docs/plots.md")
            }
            "docs/sampling" => {
                let name = stem.strip_suffix("-16").or(stem.strip_suffix("-sum"));
                name.is_some_and(plugin) && script.contains("out=docs/sampling")
            }
            "docs/viewer" => window.contains(&format!("\"{stem}\"")),
            "docs/hard-cases" => benched("docs/hard-cases.md"),
            "docs/seed" => benched("docs/seed.md"),
            "docs/pictures" => script.split_whitespace().any(|word| word == stem),
            _ => false,
        }
    };
    let mut lost = pictures();
    lost.retain(|picture| !made(picture));
    assert!(lost.is_empty(), "nothing makes {lost:?}");
}
