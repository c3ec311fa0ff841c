//! `brdf render --watch`: every way of saving a file, broken files, manifests.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod common;

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use common::native::{built, cargo_build};
use common::program::{brdf, folder, run, small};
use common::root;

/// A running `brdf render --watch`, its lines as they come, and its end when the test ends.
struct Watching {
    child: Child,
    lines: Receiver<String>,
    file: PathBuf,
    picture: PathBuf,
}

impl Watching {
    /// The folder that `brdf new` makes.
    fn start(folder: &Path) -> Self {
        assert!(run(folder, &["new", "brdf", "live"]).status.success());
        Self::of(folder, &["./live"], "live/live.wgsl")
    }

    /// What the arguments name; `file` is what the test edits.
    fn of(folder: &Path, arguments: &[&str], file: &str) -> Self {
        let watch = ["--watch", "--export", "p", "--ibl", "furnace"];
        let mut child = brdf(folder, &small(&[arguments, &watch].concat()))
            .stderr(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let (sender, lines) = channel();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        std::thread::spawn(move || {
            for line in stderr.lines().map_while(Result::ok) {
                let _ = sender.send(line);
            }
        });
        let (file, picture) = (folder.join(file), folder.join("p.png"));
        let watching = Self { child, lines, file, picture };
        watching.expect("watching; stop with Ctrl-C");
        watching
    }

    /// Waits for a line that contains `part`, and returns the lines before it.
    fn expect(&self, part: &str) -> Vec<String> {
        let mut seen = Vec::new();
        loop {
            match self.lines.recv_timeout(Duration::from_secs(60)) {
                Ok(line) if line.contains(part) => return seen,
                Ok(line) => seen.push(line),
                Err(_) => panic!("`{part}` never came; seen: {seen:?}"),
            }
        }
    }

    /// The picture as it is.
    fn picture(&self) -> Vec<u8> {
        fs::read(&self.picture).unwrap()
    }

    /// Waits for the next picture, which must be another one than `last`, and takes its place.
    fn changed(&self, last: &mut Vec<u8>, what: &str) {
        self.expect("reloaded: first pixel");
        let now = self.picture();
        assert!(now != *last, "{what}: the picture stayed the same");
        *last = now;
    }
}

impl Drop for Watching {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn watching_follows_every_way_of_saving_and_keeps_the_last_good_picture() {
    let folder = folder();
    let watching = Watching::start(folder.path());
    let file = &watching.file;
    let good = fs::read_to_string(file).unwrap();
    let scaled = |factor: &str| {
        let text = good.replace("return (1.0 -", &format!("return {factor} * (1.0 -"));
        assert!(text != good, "the template no longer reads as this test expects");
        text
    };
    let mut last = watching.picture();

    // Truncate and write in place, in two parts with a pause between them.
    let mut open = fs::File::create(file).unwrap();
    let text = scaled("0.5");
    let (first, second) = text.split_at(text.len() / 2);
    open.write_all(first.as_bytes()).unwrap();
    open.write_all(second.as_bytes()).unwrap();
    drop(open);
    watching.changed(&mut last, "in place");

    // A new file renamed over the old one, as many editors and `sed -i` do.
    let other = folder.path().join("live/.live.wgsl.tmp");
    fs::write(&other, scaled("0.25")).unwrap();
    fs::rename(&other, file).unwrap();
    watching.changed(&mut last, "rename over");

    // The old file moved away first, as vim does with a backup.
    fs::rename(file, folder.path().join("live/live.wgsl~")).unwrap();
    fs::write(file, scaled("0.125")).unwrap();
    watching.changed(&mut last, "backup and write");

    if Command::new("sed")
        .arg("--version")
        .stdout(Stdio::null())
        .status()
        .is_ok_and(|s| s.success())
    {
        Command::new("sed").args(["-i", "s/0.125/0.75/"]).arg(file).status().unwrap();
        watching.changed(&mut last, "sed -i");
    }

    // Broken: one message, with the author's place; the picture stays. Renames are whole at once, so
    // that no half file is seen in between.
    let save = |text: String| {
        fs::write(&other, text).unwrap();
        fs::rename(&other, file).unwrap();
    };
    let before = watching.picture();
    save(good.replace("p.gloss", "p.glos"));
    let (line, text) = good.lines().enumerate().find(|(_, line)| line.contains("p.gloss")).unwrap();
    let place = format!("{}:{}", line + 1, text.find("p.gloss").unwrap() + 3);
    watching.expect(&format!(
        "live.wgsl:{place}: invalid field accessor `glos`; did you mean `gloss`?"
    ));
    watching.expect("the last good picture stays");
    // Saved again with the same fault: nothing new to tell.
    save(good.replace("p.gloss", "p.glos"));
    save(good.replace("p.gloss", "p.glos") + "\n");
    save(scaled("1.5"));
    let between = watching.expect("reloaded: first pixel");
    assert!(!between.iter().any(|line| line.contains("error")), "{between:?}");
    assert!(before != watching.picture());

    // The manifest counts too: what nobody set follows its defaults.
    let before = watching.picture();
    let manifest = folder.path().join("live/plugin.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("default = 0.3", "default = 0.9")).unwrap();
    watching.expect("reloaded: first pixel");
    assert!(before != watching.picture());
}

/// A copy of the native example with `brdf-sdk` where it is.
fn native_copy(folder: &Path) {
    let example = root().join("examples/gloss-curve");
    fs::create_dir_all(folder.join("gloss-curve/src")).unwrap();
    for file in ["plugin.toml", "gloss-curve.wgsl", "satin.txt", "Cargo.lock", "src/lib.rs"] {
        fs::copy(example.join(file), folder.join("gloss-curve").join(file)).unwrap();
    }
    let cargo = fs::read_to_string(example.join("Cargo.toml")).unwrap();
    let sdk = format!("{:?}", root().join("brdf-sdk"));
    let cargo = cargo.replace("\"../../brdf-sdk\"", &sdk);
    fs::write(folder.join("gloss-curve/Cargo.toml"), cargo).unwrap();
}

/// Edit, `cargo build`, look: the picture is the new library's, what was set stays set, and a library that fails or
/// cannot be built takes nothing down.
#[test]
fn watching_follows_a_native_library_through_its_builds() {
    let folder = folder();
    native_copy(folder.path());
    let own = built(folder.path().join("gloss-curve"));
    let arguments =
        ["./gloss-curve", "--allow-native", "--device", "cpu", "--set", "base=0.5,0.25,0.125"];
    let watching = Watching::of(folder.path(), &arguments, "gloss-curve/src/lib.rs");
    let source = fs::read_to_string(&watching.file).unwrap();
    let edit = |text: &str, by: &str| {
        assert!(source.contains(text), "the example no longer reads as this test expects");
        fs::write(&watching.file, source.replace(text, by)).unwrap();
        cargo_build(&own).status.success()
    };
    // The picture's mean, by which more or less gloss is seen: the PNG alone would not tell which.
    let mean = || {
        let picture = brdf_host::picture::read::read(&folder.path().join("p.exr")).unwrap();
        picture_mean(&picture.rgb)
    };
    let at_first = mean();

    // Twice the gloss.
    assert!(edit(
        "curve.at(root * root * FRAC_PI_2) as f32",
        "2.0 * curve.at(root * root * FRAC_PI_2) as f32"
    ));
    watching.expect("reloaded: first pixel");
    let doubled = mean();
    assert!((0..3).all(|c| doubled[c] > 1.02 * at_first[c]), "{at_first:?} {doubled:?}");
    // What was set stays set: the base is red.
    assert!(doubled[0] - doubled[2] > 0.5 * (at_first[0] - at_first[2]), "{doubled:?}");

    // What cannot be built changes nothing; what panics is told, and the picture stays.
    assert!(!edit("struct GlossCurve;", "struct GlossCurve"));
    assert!(edit(
        "let curve = Curve::parse(&text)?;",
        "let curve = Curve::parse(&text)?; assert!(text.is_empty(), \"no gloss today\");"
    ));
    watching.expect("the library panicked at src/lib.rs");
    watching.expect("the last good picture stays");
    assert_eq!(mean(), doubled);

    // Back to the first source: the first picture, bit for bit.
    assert!(edit("struct GlossCurve;", "struct GlossCurve;\n"));
    watching.expect("reloaded: first pixel");
    assert_eq!(mean(), at_first);

    // The data file is followed too.
    fs::write(own.join("satin.txt"), "0 0\n90 0\n").unwrap();
    watching.expect("reloaded: first pixel");
    let dull = mean();
    assert!((0..3).all(|c| dull[c] < at_first[c]), "{dull:?}");
}

fn picture_mean(pixels: &[[f32; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for pixel in pixels {
        (0..3).for_each(|c| sum[c] += f64::from(pixel[c]) / pixels.len() as f64);
    }
    sum
}

/// An edited manifest names another data file; from then on that one is watched.
#[test]
fn watching_follows_the_file_that_an_edited_manifest_names() {
    let folder = folder();
    let (live, slice) = (folder.path().join("live"), root().join("plugins/brdf/image-slice"));
    fs::create_dir(&live).unwrap();
    fs::copy(slice.join("image-slice.wgsl"), live.join("live.wgsl")).unwrap();
    let manifest = fs::read_to_string(slice.join("plugin.toml")).unwrap();
    let naming = |file: &str| {
        manifest
            .replace("library = \"measured\"", "library = \"measured\"\nentry = \"image-slice\"")
            .replace("type = \"file\"", &format!("type = \"file\"\ndefault = \"{file}\""))
    };
    let write = |file: &str, value: &str| fs::write(live.join(file), format!("1 1\n{value}\n"));
    write("a.txt", "0.1").unwrap();
    write("b.txt", "0.2").unwrap();
    fs::write(live.join("plugin.toml"), naming("a.txt")).unwrap();
    let watching = Watching::of(folder.path(), &["./live"], "live/b.txt");
    let mut last = watching.picture();
    write("a.txt", "0.05").unwrap();
    watching.changed(&mut last, "the first file");
    fs::write(live.join("plugin.toml"), naming("b.txt")).unwrap();
    watching.changed(&mut last, "the manifest");
    fs::write(&watching.file, "1 1\n0.02\n").unwrap();
    watching.changed(&mut last, "the second file");
}

#[test]
fn watching_follows_a_file_of_brdf_explorer() {
    let folder = folder();
    let source = fs::read_to_string(root().join("examples/brdf-explorer/satin.brdf")).unwrap();
    fs::write(folder.path().join("satin.brdf"), &source).unwrap();
    let watching = Watching::of(folder.path(), &["satin.brdf"], "satin.brdf");
    let first = watching.picture();

    let edited = source.replace("return ground / PI", "return ground");
    assert!(edited != source);
    fs::write(&watching.file, edited).unwrap();
    watching.expect("reloaded: first pixel");
    assert!(watching.picture() != first);

    // A mistake in a parameter's line, and one in the code: the picture stays.
    let last = watching.picture();
    fs::write(&watching.file, source.replace("bool divide", "flag divide")).unwrap();
    watching.expect("satin.brdf:9:1: there is no parameter type `flag`");
    fs::write(&watching.file, source.replace("float F =", "vec3 F =")).unwrap();
    watching.expect("satin.brdf:33:14: a vec3 does not begin with a float");
    assert!(watching.picture() == last);

    fs::write(&watching.file, &source).unwrap();
    watching.expect("reloaded: first pixel");
    assert!(watching.picture() == first);

    // Of a file of values the model is followed, too.
    let values = root().join("examples/brdf-explorer/brocade.bparam");
    fs::copy(values, folder.path().join("brocade.bparam")).unwrap();
    drop(watching);
    let watching = Watching::of(folder.path(), &["brocade.bparam"], "satin.brdf");
    let last = watching.picture();
    fs::write(&watching.file, source.replace("return ground / PI", "return ground")).unwrap();
    watching.expect("reloaded: first pixel");
    assert!(watching.picture() != last);
}

#[test]
fn watching_follows_another_folder_in_the_place_of_the_first() {
    let folder = folder();
    let watching = Watching::start(folder.path());
    let live = folder.path().join("live");
    let text = fs::read_to_string(&watching.file).unwrap();
    let manifest = fs::read_to_string(live.join("plugin.toml")).unwrap();
    fs::remove_dir_all(&live).unwrap();
    watching.expect("there is no such plugin folder");
    fs::create_dir(&live).unwrap();
    fs::write(live.join("plugin.toml"), manifest).unwrap();
    for factor in ["0.5", "0.25"] {
        let scaled = text.replace("return (", &format!("return {factor} * ("));
        fs::write(&watching.file, scaled).unwrap();
        watching.expect("reloaded: first pixel");
    }
}
