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

use common::program::{brdf, folder, run, small};

/// A running `brdf render --watch`, its lines as they come, and its end when the test ends.
struct Watching {
    child: Child,
    lines: Receiver<String>,
    file: PathBuf,
}

impl Watching {
    fn start(folder: &Path) -> Self {
        assert!(run(folder, &["new", "brdf", "live"]).status.success());
        let mut child =
            brdf(folder, &small(&["./live", "--watch", "--export", "p", "--ibl", "furnace"]))
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
        let watching = Self { child, lines, file: folder.join("live/live.wgsl") };
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
    let picture = || fs::read(folder.path().join("p.png")).unwrap();
    let scaled = |factor: &str| {
        let text = good.replace("return (1.0 -", &format!("return {factor} * (1.0 -"));
        assert!(text != good, "the template no longer reads as this test expects");
        text
    };
    let mut last = picture();
    let mut changed = |what: &str| {
        watching.expect("reloaded: first pixel");
        let now = picture();
        assert!(now != last, "{what}: the picture stayed the same");
        last = now;
    };

    // Truncate and write in place, in two parts with a pause between them.
    let mut open = fs::File::create(file).unwrap();
    let text = scaled("0.5");
    let (first, second) = text.split_at(text.len() / 2);
    open.write_all(first.as_bytes()).unwrap();
    open.write_all(second.as_bytes()).unwrap();
    drop(open);
    changed("in place");

    // A new file renamed over the old one, as many editors and `sed -i` do.
    let other = folder.path().join("live/.live.wgsl.tmp");
    fs::write(&other, scaled("0.25")).unwrap();
    fs::rename(&other, file).unwrap();
    changed("rename over");

    // The old file moved away first, as vim does with a backup.
    fs::rename(file, folder.path().join("live/live.wgsl~")).unwrap();
    fs::write(file, scaled("0.125")).unwrap();
    changed("backup and write");

    if Command::new("sed")
        .arg("--version")
        .stdout(Stdio::null())
        .status()
        .is_ok_and(|s| s.success())
    {
        Command::new("sed").args(["-i", "s/0.125/0.75/"]).arg(file).status().unwrap();
        changed("sed -i");
    }

    // Broken: one message, with the author's place; the picture stays. Renames are whole at once, so
    // that no half file is seen in between.
    let save = |text: String| {
        fs::write(&other, text).unwrap();
        fs::rename(&other, file).unwrap();
    };
    let before = picture();
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
    assert!(before != picture());

    // The manifest counts too: what nobody set follows its defaults.
    let before = picture();
    let manifest = folder.path().join("live/plugin.toml");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("default = 0.3", "default = 0.9")).unwrap();
    watching.expect("reloaded: first pixel");
    assert!(before != picture());
}
