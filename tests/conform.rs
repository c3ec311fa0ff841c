//! `brdf conform` as its users call it: exit codes, the table, the page.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;

use common::program::{folder, refused, run, text};
use common::root;

/// What does not link is told by its place, before any verdict.
#[test]
fn a_folder_that_does_not_link_gets_its_diagnostic() {
    let folder = folder();
    let f = folder.path();
    let broken = root().join("tests/cases/return-type-mismatch");
    let broken = broken.to_str().unwrap();
    let line = refused(f, &["conform", broken, "--law", "finite", "--device", "cpu"]);
    assert!(line.contains("return-type-mismatch.wgsl:2:12: "), "{line}");
    let line = refused(f, &["conform", "./nowhere"]);
    assert!(line.contains("there is no such plugin folder"), "{line}");
    let line = refused(f, &["conform", "lambert", "--references", "nowhere.toml"]);
    assert!(line.contains("--references nowhere.toml"), "{line}");
    fs::create_dir(f.join("none")).unwrap();
    let line = refused(f, &["conform", "lambert", "--references", "none"]);
    assert!(line.contains("there is no .toml file in it"), "{line}");
    let head = "brdf = \"lambert\"\nsource = \"t\"\n";
    for (text, part) in [
        ("values = []", "there are no values"),
        ("tolerance = -1.0\n[[values]]\ntheta = 1.0\nalbedo = 0.5", "tolerance above 0"),
        ("[[values]]\ntheta = 120.0\nalbedo = 0.5", "give 0 <= theta < 90"),
        ("[[values]]\ntheta = 20.0\nalbedo = nan", "finite"),
    ] {
        fs::write(f.join("bad.toml"), format!("{head}{text}\n")).unwrap();
        // Told before anything is judged.
        let line = refused(f, &["conform", "ggx", "lambert", "--references", "bad.toml"]);
        assert!(line.contains(part), "{part} is not in {line}");
    }
}

/// A law that fails makes exit code 1, and its line says what shows it: a command that can be run.
#[test]
fn a_failure_is_exit_code_1_and_can_be_reproduced() {
    let folder = folder();
    let f = folder.path();
    let mutant = root().join("tests/mutants/brdf/nan-at-an-azimuth");
    let mutant = mutant.to_str().unwrap();
    let output = run(f, &["conform", mutant, "--law", "finite", "--device", "cpu"]);
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{told} {}", text(&output.stderr));
    assert!(told.contains("FAILED finite"), "{told}");
    assert!(told.contains("1 BRDF: 0 laws hold, 1 fail"), "{told}");
    // echo wo wi | brdf eval FOLDER OPTIONS
    let shown = told.lines().find_map(|line| line.trim().strip_prefix("see echo ")).unwrap();
    let (pair, command) = shown.split_once(" | brdf ").unwrap();
    fs::write(f.join("pair.txt"), pair).unwrap();
    let arguments: Vec<&str> = command.split(' ').collect();
    let mut again = common::program::brdf(f, &arguments);
    let again = again.stdin(fs::File::open(f.join("pair.txt")).unwrap()).output().unwrap();
    let values = text(&again.stdout);
    assert!(values.to_lowercase().contains("nan"), "{values} {}", text(&again.stderr));
}

/// The page of verdicts stands alone, whatever it says, and is refused before any work where it cannot be written.
#[test]
fn conform_writes_a_page_that_stands_alone() {
    let folder = folder();
    let f = folder.path();
    let arguments = [
        "conform",
        "lambert",
        "--law",
        "finite",
        "--law",
        "sampling",
        "--html",
        "page.html",
        "--json",
    ];
    let output = run(f, &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let reports: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let page = fs::read_to_string(f.join("page.html")).unwrap();
    let verdicts = reports[0]["verdicts"].as_array().unwrap();
    assert_eq!(verdicts.len(), 2);
    for verdict in verdicts {
        let law = verdict["law"].as_str().unwrap();
        let row = page.split(&format!("<tr id=\"b0-{law}\">")).nth(1).unwrap();
        let row = row.split("</tr>").next().unwrap();
        assert!(row.contains("<td class=\"passed\">ok</td>"), "{row}");
        assert!(row.contains(verdict["said"].as_str().unwrap()), "{row}");
    }
    // Six views, each of three panels above two legends.
    assert_eq!(page.matches("<figure>").count(), 6);
    assert_eq!(page.matches("<image ").count(), 6 * 5);
    assert_balanced(&page);
    for link in ["href=\"", "src=\"", "url("].iter().flat_map(|start| page.split(start).skip(1)) {
        assert!(link.starts_with("data:image/png;base64,") || link.starts_with('#'), "{link:.60}");
    }
    assert!(!page.contains("://") && !page.contains("@import") && !page.contains("<script"));
    assert_eq!(fs::read_dir(f).unwrap().count(), 1, "no half file stays");

    let long = format!("{}.html", "a".repeat(300));
    for (path, part) in [
        ("nowhere/page.html", "its folder does not exist"),
        ("page.txt", "ends in .html"),
        ("lambert", "ends in .html"),
        (long.as_str(), "the file cannot be written"),
    ] {
        let line = refused(f, &["conform", "--html", path]);
        assert!(line.contains(part), "{part} is not in {line}");
    }
}

/// Every element of a page is closed where it was opened.
fn assert_balanced(page: &str) {
    const EMPTY: [&str; 2] = ["meta", "!DOCTYPE"];
    let mut open = Vec::new();
    // What is escaped holds no `<`, so each begins a tag.
    for tag in page.split('<').skip(1) {
        let tag = tag.split('>').next().unwrap();
        let name = tag.split([' ', '/']).find(|part| !part.is_empty()).unwrap();
        match tag {
            tag if tag.starts_with('/') => assert_eq!(open.pop(), Some(name), "</{name}>"),
            tag if tag.ends_with('/') || EMPTY.contains(&name) => {}
            _ => open.push(name),
        }
    }
    assert!(open.is_empty(), "{open:?} stay open");
}
