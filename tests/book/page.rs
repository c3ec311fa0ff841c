//! A page of Markdown: its blocks of code, its prose, the code within the prose, its headings.
//!
//! Fences of three backticks, spans, headings with `#` are understood: what the pages have. Nothing runs here.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use super::common::root;

/// A page, its path from the root of the tree with `/`.
pub struct Page {
    pub name: String,
    pub text: String,
}

/// A block of code.
#[derive(Debug)]
pub struct Block {
    /// The line of the page that its first line is, from 1.
    pub line: usize,
    pub language: String,
    pub lines: Vec<String>,
}

impl Page {
    /// Every page that people read.
    pub fn all() -> Vec<Self> {
        let mut names: Vec<String> = [
            "ARCHITECTURE",
            "CHANGELOG",
            "CONTRIBUTING",
            "README",
            "envmaps/README",
            "examples/README",
        ]
        .map(|name| format!("{name}.md"))
        .into();
        for entry in fs::read_dir(root().join("docs")).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if name.ends_with(".md") {
                names.push(format!("docs/{name}"));
            }
        }
        names.sort();
        assert!(names.len() > 20, "the pages are gone: {names:?}");
        names.into_iter().map(Self::read).collect()
    }

    fn read(name: String) -> Self {
        let text = fs::read_to_string(root().join(&name)).unwrap();
        Self { name, text }
    }

    /// Where its links begin.
    pub fn folder(&self) -> &Path {
        Path::new(&self.name).parent().unwrap()
    }

    /// The blocks, and the lines between them with their numbers.
    fn split(&self) -> (Vec<Block>, Vec<(usize, &str)>) {
        let (mut blocks, mut prose) = (Vec::new(), Vec::new());
        let mut open: Option<Block> = None;
        for (number, line) in (1..).zip(self.text.lines()) {
            let fence = line.trim_start().strip_prefix("```");
            match (fence, open.take()) {
                (Some(language), None) => {
                    let language = language.trim().to_owned();
                    open = Some(Block { line: number + 1, language, lines: Vec::new() });
                }
                (Some(_), Some(block)) => blocks.push(block),
                (None, Some(mut block)) => {
                    block.lines.push(line.to_owned());
                    open = Some(block);
                }
                (None, None) => prose.push((number, line)),
            }
        }
        assert!(open.is_none(), "{}: a block of code does not end", self.name);
        (blocks, prose)
    }

    pub fn blocks(&self) -> Vec<Block> {
        self.split().0
    }

    /// Lines that are no code, with their numbers.
    pub fn prose(&self) -> Vec<(usize, &str)> {
        self.split().1
    }

    /// Code within the prose, with its line.
    pub fn spans(&self) -> Vec<(usize, String)> {
        let prose = self.prose().into_iter();
        prose
            .flat_map(|(line, text)| spans(text).0.into_iter().map(move |span| (line, span)))
            .collect()
    }

    /// What may stand behind `#` in a link to the page.
    pub fn anchors(&self) -> Vec<String> {
        let mut anchors = Vec::new();
        let mut seen: HashMap<String, usize> = HashMap::new();
        for (_, line) in self.prose() {
            anchors.extend(
                line.split("id=\"")
                    .skip(1)
                    .filter_map(|id| id.split('"').next())
                    .map(str::to_owned),
            );
            let text = line.trim_start_matches('#');
            if !(1..=6).contains(&(line.len() - text.len())) || !text.starts_with(' ') {
                continue;
            }
            let slug = slug(text);
            let times = seen.entry(slug.clone()).or_insert(0);
            anchors.push(if *times == 0 { slug } else { format!("{slug}-{times}") });
            *times += 1;
        }
        anchors
    }
}

/// The code within a line, and the line with its code left out.
pub fn spans(line: &str) -> (Vec<String>, String) {
    let (mut found, mut rest, mut prose) = (Vec::new(), line, String::new());
    while let Some(at) = rest.find('`') {
        prose.push_str(&rest[..at]);
        let ticks = rest[at..].chars().take_while(|c| *c == '`').count();
        let (mark, behind) = rest[at..].split_at(ticks);
        match behind.find(mark) {
            Some(end) => {
                // What a table escapes.
                found.push(behind[..end].trim().replace("\\|", "|"));
                rest = &behind[end + ticks..];
            }
            None => {
                prose.push_str(mark);
                rest = behind;
            }
        }
    }
    (found, prose + rest)
}

/// A heading as an anchor: letters, digits, `-` and `_` in lower case, blanks as `-`; of a link its words.
fn slug(heading: &str) -> String {
    let mut words = String::new();
    let mut rest = heading.trim();
    while let Some((before, behind)) = rest.split_once("](") {
        words.push_str(before);
        rest = behind.split_once(')').map_or("", |(_, rest)| rest);
    }
    words.push_str(rest);
    let mut tag = false;
    let mut slug = String::new();
    for c in words.chars() {
        match c {
            '<' => tag = true,
            '>' => tag = false,
            _ if tag => {}
            ' ' => slug.push('-'),
            c if c.is_alphanumeric() || c == '-' || c == '_' => slug.extend(c.to_lowercase()),
            _ => {}
        }
    }
    slug
}
