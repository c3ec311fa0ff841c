//! Links of the pages: files that are there, and headings that are there. What lies outside of the tree is not visited.

use std::path::{Component, Path, PathBuf};

use super::common::root;
use super::page::{Page, spans};

/// Links that lead nowhere.
pub fn wrong(page: &Page) -> Vec<String> {
    let wrong = targets(page).into_iter().filter_map(|(line, target)| {
        let what = broken(page, &target)?;
        Some(format!("{}:{line}: the link {target}: {what}", page.name))
    });
    wrong.collect()
}

/// What links and pictures of a page name, in Markdown and in HTML, with their lines.
pub fn targets(page: &Page) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (line, text) in page.prose() {
        let (_, text) = spans(text);
        for (mark, end) in [("](", ')'), ("href=\"", '"'), ("src=\"", '"')] {
            let targets = text.split(mark).skip(1).filter_map(|rest| rest.split_once(end));
            found.extend(targets.map(|(target, _)| (line, target.to_owned())));
        }
    }
    found
}

fn broken(page: &Page, target: &str) -> Option<String> {
    if target.starts_with("https://") {
        return None;
    }
    if target.contains("://") || target.starts_with('/') {
        return Some("neither https nor a path from here".to_owned());
    }
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let file = match path {
        "" => PathBuf::from(&page.name),
        path => joined(page.folder(), path),
    };
    if !path.is_empty() && !root().join(&file).exists() {
        return Some(format!("there is no {}", file.display()));
    }
    if anchor.is_empty() {
        return None;
    }
    let text = match path {
        "" => page.text.clone(),
        _ => std::fs::read_to_string(root().join(&file)).unwrap_or_default(),
    };
    let other = Page { name: file.display().to_string(), text };
    match other.anchors().iter().any(|known| known == anchor) {
        true => None,
        false => Some(format!("{} has no heading #{anchor}", other.name)),
    }
}

/// A path seen from a folder, without `..`.
pub fn joined(folder: &Path, path: &str) -> PathBuf {
    let mut whole = PathBuf::new();
    for part in folder.join(path).components() {
        match part {
            Component::ParentDir => {
                whole.pop();
            }
            Component::CurDir => {}
            part => whole.push(part),
        }
    }
    whole
}
