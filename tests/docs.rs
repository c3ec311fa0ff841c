//! The catalogue of BRDFs is what the plugin folders say, the page on the command line what the program reads; the
//! checks notice where they are not.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::Path;
use std::process::Output;
use std::sync::Arc;

use brdf_host::catalogue::{Catalogue, INTEGRATOR, Workshop};
use brdf_host::environment::Environment;
use brdf_host::picture::Raster;
use common::program::{brdf as program, folder, refused, run, text};
use common::{brdf, from_text, integrator, root};

/// `brdf docs --check` with the plugins of the tree, and none of the user's own.
fn checked(home: &Path, docs: &Path) -> Output {
    let plugins = root().join("plugins").display().to_string();
    let docs = docs.display().to_string();
    let mut command = program(home, &["--plugins", &plugins, "docs", "--check", &docs]);
    command.env("XDG_DATA_HOME", home).env("HOME", home).env("APPDATA", home);
    command.output().unwrap()
}

#[test]
fn the_catalogue_of_the_tree_is_up_to_date() {
    let home = folder();
    let output = checked(home.path(), &root().join("docs"));
    let said = text(&output.stdout) + &text(&output.stderr);
    assert!(output.status.success(), "run `brdf docs`, and look at what it changes:\n{said}");
    assert!(said.contains("is up to date"), "{said}");
}

/// The page on the command line is what the program reads now.
#[test]
fn the_page_on_the_command_line_is_up_to_date() {
    let home = folder();
    let output = run(home.path(), &["man", ".", "--markdown"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let made = fs::read_to_string(home.path().join("cli.md")).unwrap();
    let kept = fs::read_to_string(root().join("docs/cli.md")).unwrap();
    let line = made.lines().zip(kept.lines()).position(|(made, kept)| made != kept);
    assert!(made == kept, "run `brdf man docs --markdown`: the pages differ from line {line:?} on");
}

/// A copy of the tree's catalogue, spoilt in every way: each gets its line, and nothing else does.
#[test]
fn the_check_fails_with_a_line_for_each_file() {
    let home = folder();
    let docs = home.path().join("docs");
    fs::create_dir_all(docs.join("catalogue")).unwrap();
    for entry in fs::read_dir(root().join("docs/catalogue")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, docs.join("catalogue").join(path.file_name().unwrap())).unwrap();
    }
    let page = fs::read_to_string(root().join("docs/catalogue.md")).unwrap();
    fs::write(docs.join("catalogue.md"), page.replacen("Catalogue", "Catalog", 1)).unwrap();
    fs::remove_file(docs.join("catalogue/lambert.svg")).unwrap();
    fs::write(docs.join("catalogue/gone.png"), "").unwrap();
    let output = checked(home.path(), &docs);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let docs = docs.display();
    let expected = format!(
        "{docs}/catalogue/lambert.svg is missing\n\
         {docs}/catalogue.md is out of date from line 1 on\n\
         {docs}/catalogue/gone.png belongs to no BRDF: remove it\n"
    );
    assert_eq!(text(&output.stdout), expected);
}

#[test]
fn a_folder_that_is_not_there_is_refused_before_any_work() {
    let home = folder();
    for arguments in [&["docs"][..], &["docs", "nowhere", "--check"]] {
        let line = refused(home.path(), arguments);
        assert!(
            line.contains("there is no such folder; name the folder of the documents"),
            "{line}"
        );
    }
}

/// A workshop under light from everywhere, which is ready at once.
fn workshop() -> Workshop {
    let furnace = Arc::new(Environment::constant(1.0));
    Workshop::new(furnace, integrator(INTEGRATOR, &[])).unwrap()
}

#[test]
fn what_is_written_is_up_to_date_and_what_is_changed_is_not() {
    let home = folder();
    let entry = workshop().entry(&brdf("lambert", &[]).plugin).unwrap();
    let catalogue = Catalogue::new(&[entry]);
    catalogue.write(home.path()).unwrap();
    assert_eq!(catalogue.stale(home.path()).unwrap(), [""; 0]);
    let at = |name: &str| home.path().join(name);

    // Line ends do not count, and neither does what a machine may round another way.
    let page = fs::read_to_string(at("catalogue.md")).unwrap();
    fs::write(at("catalogue.md"), page.replace('\n', "\r\n")).unwrap();
    let mut raster = Raster::read(&at("catalogue/lambert.png")).unwrap();
    raster.rgb[99][0] += 2;
    raster.stage(&at("catalogue/lambert.png")).unwrap().keep().unwrap();
    assert_eq!(catalogue.stale(home.path()).unwrap(), [""; 0]);

    raster.rgb[99][0] += 1;
    raster.rgb[500] = [255; 3];
    raster.stage(&at("catalogue/lambert.png")).unwrap().keep().unwrap();
    let svg = fs::read_to_string(at("catalogue/lambert.svg")).unwrap();
    fs::write(at("catalogue/lambert.svg"), svg.replace("0.159", "0.158")).unwrap();
    fs::write(at("catalogue/.hidden"), "").unwrap();
    let stale = catalogue.stale(home.path()).unwrap();
    assert_eq!(stale.len(), 2, "{stale:?}");
    assert!(
        stale[0].contains("lambert.png is out of date: 2 pixels differ, by up to "),
        "{stale:?}"
    );
    assert!(stale[1].contains("lambert.svg is out of date from line "), "{stale:?}");

    fs::write(at("catalogue/lambert.png"), "no picture").unwrap();
    assert!(catalogue.stale(home.path()).unwrap()[0].contains("lambert.png cannot be read"));
    // Written again all is well, and the hidden file is still there.
    catalogue.write(home.path()).unwrap();
    assert_eq!(catalogue.stale(home.path()).unwrap(), [""; 0]);
    assert!(at("catalogue/.hidden").exists());
}

/// A page and pictures, or neither: where one file cannot be written, none is.
#[test]
fn a_catalogue_is_written_whole_or_not_at_all() {
    let home = folder();
    let entry = workshop().entry(&brdf("lambert", &[]).plugin).unwrap();
    let catalogue = Catalogue::new(&[entry]);
    // A file where the folder of the pictures would be.
    fs::write(home.path().join("catalogue"), "mine").unwrap();
    assert!(catalogue.write(home.path()).is_err());
    let names: Vec<_> =
        fs::read_dir(home.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["catalogue"]);
}

/// What an author writes is shown as it stands, and is neither HTML nor Markdown on the page.
#[test]
fn texts_of_plugins_are_escaped() {
    let manifest = r##"
        kind = "brdf"
        name = "<b>Nasty</b> & | `co`"
        about = "# <script>alert(1)</script>\n| a | b |"
        formula = "f = a | b ` <i>"
        sources = ["- <img src=x>", "[a](javascript:b)"]
        [params.a]
        type = "float"
        default = 0.5
        range = [0.0, 1.0]
        unit = "1/sr | m"
        label = "*A*"
        about = "x | y\n\n| z |"
        [presets."<u> | `q`"]
        about = "a | b"
        set = { a = 0.25 }
        [laws]
        not_reciprocal = { reason = "</ul> | r" }
    "##;
    let source = "fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f { return vec3f(p.a); }";
    let nasty = from_text("nasty", manifest, source);
    let home = folder();
    Catalogue::new(&[workshop().entry(&nasty.plugin).unwrap()]).write(home.path()).unwrap();
    let page = fs::read_to_string(home.path().join("catalogue.md")).unwrap();
    for tag in ["<b>", "<script>", "<img src=x>", "</ul>"] {
        assert!(!page.contains(tag), "{page}");
    }
    for line in [
        r#"## <a id="nasty"></a>\<b\>Nasty\</b\> \& \| \`co\` (`nasty`)"#,
        r"\# \<script\>alert(1)\</script\> \| a \| b \|",
        "``f = a | b ` <i>``",
        r"| `a` | \*A\* | float | 0 to 1 | 0.5 | 1/sr \| m | x \| y \| z \| |",
        r"| `` <u> \| `q` `` | a \| b | `a=0.25` |",
        r"- Not reciprocal: \</ul\> \| r",
        r"- \- \<img src=x\>",
        r"- \[a\](javascript:b)",
    ] {
        assert!(page.lines().any(|found| found == line), "no {line} in\n{page}");
    }
    let svg = fs::read_to_string(home.path().join("catalogue/nasty.svg")).unwrap();
    assert!(svg.contains("<title>Lobes of &lt;b&gt;Nasty&lt;/b&gt; &amp; | `co`</title>"), "{svg}");
}
