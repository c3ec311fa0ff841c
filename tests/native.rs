//! Native libraries: what may run, what is wrong with those that cannot, and the cycle of edit, build and look.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use common::native::{built, compiled, file_name, plugin};
use common::program::{self, folder, text};
use common::{root, skip};

/// The program, with a configuration folder of the test's own.
fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = program::brdf(folder, arguments);
    command.env("XDG_CONFIG_HOME", folder.join("config")).env("HOME", folder);
    command.output().unwrap()
}

/// What `render` on the cores says when it refuses, without the pictures of a drawn frame.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let device = ["--device", "cpu", "--ibl", "furnace"];
    let output = run(folder, &[&program::small(arguments)[..], &device].concat());
    let error = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(!error.contains("thread '"), "{error}");
    let problems: Vec<&str> = error.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(problems.len(), 1, "{error}");
    problems[0].trim_start_matches("error: ").to_owned()
}

fn example() -> PathBuf {
    built(root().join("examples/gloss-curve"))
}

/// A library runs by word or by an entry of the trust file, until it changes; the refusal says both.
#[test]
fn only_trusted_libraries_run() {
    let folder = folder();
    let name = file_name("good");
    let library = built(root().join("tests/fixtures/native/misbehaving"))
        .join("target/release")
        .join(file_name("misbehaving"));
    let own = plugin(folder.path(), "good", "good");
    fs::copy(&library, own.join(&name)).unwrap();

    let said = refusal(folder.path(), &["./good"]);
    assert!(said.contains(&name), "{said}");
    assert!(said.contains("this is native code from outside of the program"), "{said}");
    assert!(said.contains("--allow-native") && said.contains("`brdf trust`"), "{said}");
    let render = |more: &[&str]| {
        run(folder.path(), &[&program::small(&["./good", "--ibl", "furnace"])[..], more].concat())
    };
    assert!(render(&["--allow-native"]).status.success());

    // For good, as long as it does not change.
    let trusted = run(folder.path(), &["trust", "./good"]);
    assert!(text(&trusted.stdout).starts_with("trusted: "), "{}", text(&trusted.stdout));
    assert!(text(&run(folder.path(), &["trust"]).stdout).contains("sha256 "));
    let output = render(&[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let mut bytes = fs::read(own.join(&name)).unwrap();
    bytes.push(0);
    fs::write(own.join(&name), bytes).unwrap();
    let said = refusal(folder.path(), &["./good"]);
    assert!(said.contains("has changed since it was trusted"), "{said}");
    // Named by its file too.
    let by_file = format!("good/{name}");
    assert!(text(&run(folder.path(), &["trust", &by_file]).stdout).starts_with("trusted: "));
    assert!(render(&[]).status.success());
    // Forgotten, also when the library is gone.
    fs::remove_file(own.join(&name)).unwrap();
    let forgotten = run(folder.path(), &["trust", "./good", "--forget"]);
    assert!(text(&forgotten.stdout).contains("trusted no longer"), "{}", text(&forgotten.stderr));
    assert!(!text(&run(folder.path(), &["trust"]).stdout).contains("sha256 "));
    let said = refusal(folder.path(), &["./good"]);
    assert!(said.contains("there is no such library"), "{said}");
    // A trust file that cannot be understood trusts nobody.
    fs::copy(&library, own.join(&name)).unwrap();
    let file = folder.path().join("config/brdf/trusted.toml");
    fs::write(&file, "format = 1\n\n[[library]]\npath = 3\n").unwrap();
    let said = refusal(folder.path(), &["./good"]);
    assert!(said.contains("trusted.toml:4:"), "{said}");
}

/// Code that runs as soon as the library is opened leaves a mark: nobody opens it by listing, linking or refusing.
#[test]
#[cfg(target_os = "linux")]
fn nothing_is_loaded_by_looking() {
    let folder = folder();
    let plugins = folder.path().join("plugins/brdf");
    let own = plugin(&plugins, "marked", "marked");
    let mark = folder.path().join("mark");
    let source = format!(
        "#[used]\n#[unsafe(link_section = \".init_array\")]\nstatic RUN: extern \"C\" fn() = run;\n\
         extern \"C\" fn run() {{ let _ = std::fs::write({:?}, \"\"); }}\n",
        mark.display().to_string()
    );
    compiled(&own, "marked", &source);
    for arguments in [
        &["list"][..],
        &["expand", "marked", "brdf-is"],
        &["trust", "./plugins/brdf/marked"],
        &["trust", "./plugins/brdf/marked", "--forget"],
    ] {
        let output = run(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        assert!(!mark.exists(), "{arguments:?}");
    }
    refusal(folder.path(), &["marked"]);
    assert!(!mark.exists());
    let said = refusal(folder.path(), &["marked", "--allow-native"]);
    assert!(said.contains("exports no plugin"), "{said}");
    assert!(mark.exists(), "the mark is no proof");
}

/// Files that are no library, or not one of ours.
#[test]
fn libraries_that_do_not_fit_are_refused() {
    let folder = folder();
    let put = |name: &str, bytes: &[u8]| {
        let own = plugin(folder.path(), name, name);
        fs::write(own.join(file_name(name)), bytes).unwrap();
    };
    let refused = |name: &str, expected: &str| {
        let said = refusal(folder.path(), &[&format!("./{name}"), "--allow-native"]);
        assert!(said.contains(&file_name(name)), "{said}");
        assert!(said.contains(expected) && said.contains("; "), "{name}: {said}");
    };
    let compile = |name: &str, source: &str| {
        let own = plugin(folder.path(), name, name);
        compiled(&own, name, source);
        fs::read(own.join(file_name(name))).unwrap()
    };
    put("prose", b"not a library");
    refused("prose", "the system cannot load it");
    put("nothing", b"");
    refused("nothing", "the system cannot load it");
    let whole = compile("plain", "pub fn nothing() {}");
    refused(
        "plain",
        "it exports no plugin (there is no symbol BRDF_PLUGIN); write `brdf_sdk::export_plugin!",
    );
    for part in [50, 300, 5000] {
        put("cut", &whole[..part]);
        let expected =
            if cfg!(target_os = "linux") { "ends before its code does" } else { "cannot load" };
        refused("cut", expected);
    }
    let table =
        |words: &str| format!("#[unsafe(no_mangle)]\npub static BRDF_PLUGIN: [u32; 4] = {words};");
    compile("newer", &table("[99, 48, 0, 0]"));
    refused(
        "newer",
        "it was built for version 99 of the native interface, and this program speaks version 1; build it again",
    );
    compile("smaller", &table("[1, 8, 0, 0]"));
    refused("smaller", "its table has 8 bytes and not ");
    if cfg!(target_os = "linux") {
        // The machine of an ELF file stands at byte 18: 183 is AArch64's, 62 x86-64's.
        let mut other = whole;
        other[18] = if other[18] == 183 { 62 } else { 183 };
        put("foreign", &other);
        refused("foreign", "the system cannot load it");
    }
    let said =
        refusal(folder.path(), &[&plugin(folder.path(), "absent", "absent").display().to_string()]);
    assert!(
        said.contains(
            "there is no such library, and none of its name beside the program; build it"
        ),
        "{said}"
    );
}

/// What a library may do wrong in `load`: each is one line about the plugin, and the program ends in order.
#[test]
fn what_goes_wrong_in_a_library_is_told() {
    let library = built(root().join("tests/fixtures/native/misbehaving"))
        .join("target/release")
        .join(file_name("misbehaving"));
    let folder = folder();
    for (entry, expected) in [
        (
            "panics",
            "panics: the library panicked at src/lib.rs:14: index 7 is out of range; mend it",
        ),
        (
            "panics-oddly",
            "panics-oddly: the library panicked at src/lib.rs:15: no reason given; mend it",
        ),
        ("fails", "fails: the lamp was off; switch it on"),
        ("fails-in-two-lines", "fails-in-two-lines: the lamp was off; "),
        ("says-nothing", "its library (misbehaving 0.1) failed without a reason (status 1)"),
        ("wrong-shape", "the array `values` has 4 elements and the shape [3, 2]"),
        ("shape-that-overflows", "has 4 elements and the shape"),
        ("too-many-dimensions", "has 4 elements and the shape [1, 1, 1, 1, 1, 4]"),
        ("other-name", "the library gives no array `values`; let `load` return it"),
        ("one-too-many", "an array `more` that the manifest does not declare; declare it"),
        (
            "other-type",
            "the array `values` is declared as floats, and the library gives another type",
        ),
        ("empty", "the array `values` has 0 elements; give it at least one"),
        ("unasked", "the parameter `nobody` was not handed over; name it in the manifest's `load`"),
    ] {
        let own = plugin(folder.path(), "misbehaving", entry);
        fs::copy(&library, own.join(file_name("misbehaving"))).unwrap();
        let said = refusal(folder.path(), &[&format!("./{entry}"), "--allow-native"]);
        assert!(said.contains(expected), "{said}\n  instead of {expected}");
    }
}

/// The example as its document says: refused at first, then rendered, and sampled by its own tables.
#[test]
fn the_example_stands_alone() {
    let example = example();
    let folder = folder();
    let named = example.display().to_string();
    assert!(refusal(folder.path(), &[&named]).contains("--allow-native"));
    let arguments =
        ["eval", &named, "--allow-native", "--device", "cpu", "--albedo", "--angles", "30"];
    let output = run(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let bad = folder.path().join("bad.curve");
    fs::write(&bad, "0 1\n10 high\n").unwrap();
    let set = format!("curve={}", bad.display());
    let said = refusal(folder.path(), &[&named, "--allow-native", "--set", &set]);
    assert!(
        said.contains("bad.curve: line 2: `10 high` is no point of the curve; write"),
        "{said}"
    );
}

/// The very library of the shipped plugins, built as a cdylib and opened as anybody's, gives the same arrays as
/// the one inside the program.
#[test]
fn the_shipped_library_opens_as_a_file() {
    let beside = Path::new(env!("CARGO_BIN_EXE_brdf")).parent().unwrap();
    let library = beside.join(file_name("brdf_measured"));
    if !library.exists() {
        return skip("the shipped library was not built as a file: `cargo build --workspace` does");
    }
    let folder = folder();
    let own = folder.path().join("rgl");
    fs::create_dir(&own).unwrap();
    for file in ["plugin.toml", "rgl.wgsl"] {
        fs::copy(root().join("plugins/brdf/rgl").join(file), own.join(file)).unwrap();
    }
    fs::copy(&library, own.join(file_name("measured"))).unwrap();
    fs::write(folder.path().join("rows.txt"), "0 0 1 0.6 0 0.8\n0.6 0 0.8 -0.5 0.1 0.8602325\n")
        .unwrap();
    let rows = |brdf: &str| {
        let arguments = ["eval", brdf, "rows.txt", "--device", "cpu", "--allow-native"];
        let output = run(folder.path(), &arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    assert_eq!(rows("./rgl"), rows("rgl"));
}
