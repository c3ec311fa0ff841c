//! Files of BRDF Explorer, as users bring them: rendered, imported, refused.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::Path;

use common::program::{folder, refused, run, small, text};
use common::root;

/// A folder with the example's two files in it.
fn with_example() -> tempfile::TempDir {
    let folder = folder();
    for name in ["satin.brdf", "brocade.bparam"] {
        let from = root().join("examples/brdf-explorer").join(name);
        fs::copy(from, folder.path().join(name)).unwrap();
    }
    folder
}

/// The linear picture of what the arguments name.
fn picture(folder: &Path, arguments: &[&str], name: &str) -> Vec<u8> {
    let device = ["--device", "cpu", "--export", name];
    let output = run(folder, &small(&[arguments, &device].concat()));
    assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
    fs::read(folder.join(format!("{name}.png"))).unwrap()
}

#[test]
fn a_model_renders_by_its_file_and_again_from_its_picture() {
    let folder = with_example();
    let own = picture(folder.path(), &["satin.brdf"], "own");
    // By any path, with values in the author's order of magnitude, from the header of its picture.
    let path = folder.path().join("satin.brdf").display().to_string();
    assert!(picture(folder.path(), &[&path], "path") == own);
    assert!(picture(folder.path(), &["--session", "own.exr"], "again") == own);
    let wider = picture(folder.path(), &["satin.brdf", "--set", "gloss=0.4"], "wider");
    assert!(wider != own);
}

#[test]
fn values_open_as_a_brdf() {
    let folder = with_example();
    let brocade = picture(folder.path(), &["brocade.bparam"], "brocade");
    let set = ["--set", "ground=0.3,0.2,0.04", "--set", "gloss=0.08", "--set", "stretch=8"];
    let same = picture(folder.path(), &[&["satin.brdf"], &set[..]].concat(), "same");
    assert!(brocade == same);

    let values = fs::read_to_string(folder.path().join("brocade.bparam")).unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("lost.bparam", &values.replace("satin.brdf", "nowhere/velvet.brdf"));
    write("wrong.bparam", &values.replace("float gloss", "float glaze"));
    write("other.bparam", &values.replace("color ground .3 .2 .04", "float ground 0 1 .2"));
    write("twice.bparam", &values.replace("::end", "float gloss 0 1 .2\n::end"));
    for (file, line) in [
        (
            "lost.bparam",
            "error: lost.bparam: the model that it is for, nowhere/velvet.brdf, is not there; put it beside this file, or mend the first line",
        ),
        (
            "wrong.bparam",
            "error: wrong.bparam:5:7: satin.brdf has no parameter `glaze`; remove its line, or name the model that has it",
        ),
        (
            "other.bparam",
            "error: other.bparam:4:7: the parameter `ground` of satin.brdf is of another type; write its line as the model has it",
        ),
        ("twice.bparam", "error: twice.bparam:8:7: the parameter `gloss` stands twice; remove one"),
    ] {
        assert_eq!(refused(folder.path(), &small(&[file])), line);
    }
}

#[test]
fn an_imported_plugin_is_the_same_and_says_which_laws_it_breaks() {
    let folder = with_example();
    let import = ["import", "satin.brdf", "-o", "mine/satin", "--device", "cpu"];
    let output = run(folder.path(), &import);
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(
        printed.starts_with("made mine/satin/plugin.toml and mine/satin/satin.wgsl\n"),
        "{printed}"
    );
    // At the horizon floats lose the digits of a Gaussian over slopes; its symmetry is there in f64.
    let told = |law: &str| printed.lines().find(|line| line.contains(law)).unwrap_or_default();
    assert!(told(" stability ").trim_start().starts_with("FAILED"), "{printed}");
    assert!(told(" reciprocity ").trim_start().starts_with("ok"), "{printed}");
    assert!(told(" energy ").trim_start().starts_with("ok"), "{printed}");
    assert!(fs::metadata(folder.path().join("mine/satin/conformance.html")).unwrap().len() > 1000);
    let wgsl = fs::read_to_string(folder.path().join("mine/satin/satin.wgsl")).unwrap();
    assert!(
        wgsl.starts_with("\n// Satin: fibres") || wgsl.starts_with("// Satin: fibres"),
        "{wgsl}"
    );
    assert!(wgsl.contains("// A Gaussian over the slopes of the half vector.\nfn lobe("), "{wgsl}");
    let manifest = fs::read_to_string(folder.path().join("mine/satin/plugin.toml")).unwrap();
    assert!(
        manifest.contains("about = \"width of the highlight across the fibres\""),
        "{manifest}"
    );

    let own = picture(folder.path(), &["satin.brdf"], "own");
    assert!(picture(folder.path(), &["./mine/satin"], "imported") == own);

    // Values become a preset.
    let import = ["import", "brocade.bparam", "-o", "mine/cloth", "--no-report"];
    assert!(run(folder.path(), &import).status.success());
    let brocade = picture(folder.path(), &["brocade.bparam"], "brocade");
    let preset = picture(folder.path(), &["./mine/cloth", "--preset", "brocade"], "preset");
    assert!(preset == brocade);

    let line = refused(folder.path(), &["import", "satin.brdf", "-o", "mine/satin"]);
    assert!(line.starts_with("error: mine/satin: it exists already"), "{line}");
    fs::write(folder.path().join("notes.txt"), "hello").unwrap();
    let line = refused(folder.path(), &["import", "notes.txt", "-o", "mine/notes"]);
    assert_eq!(
        line,
        "error: notes.txt: it is no file of BRDF Explorer; name a .brdf or a .bparam file"
    );
    let line = refused(folder.path(), &["import", "none.brdf", "-o", "mine/none"]);
    assert_eq!(line, "error: none.brdf: there is no such file; name a .brdf or a .bparam file");
}

#[test]
fn mistakes_are_told_by_the_files_own_lines() {
    let folder = with_example();
    let good = fs::read_to_string(folder.path().join("satin.brdf")).unwrap();
    for (from, to, line) in [
        (
            "float gloss 0.02 0.6 0.15",
            "float gloss 0.02 0,6 0.15",
            "error: bad.brdf:7:18: `0,6` is no number; write `float NAME MIN MAX DEFAULT`",
        ),
        (
            "sqr(h.y / across)",
            "sqr(h.y / acros)",
            "error: bad.brdf:21:49: there is nothing of the name `acros` here; declare it, or write it into the parameters",
        ),
        ("return x*x;", "return sqr(x)*x;", "error: bad.brdf:16:"),
        (
            "::end shader",
            "",
            "error: bad.brdf:12:1: the section `shader` never ends; write `::end shader`",
        ),
    ] {
        fs::write(folder.path().join("bad.brdf"), good.replace(from, to)).unwrap();
        let told = refused(folder.path(), &small(&["bad.brdf"]));
        assert!(told.starts_with(line), "{told}");
    }
}
