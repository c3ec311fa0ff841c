//! The documents are true: every command of their pages runs as its reader would run it, links lead somewhere,
//! and pictures are those that something makes. One test for each page.
//!
//! What a page has to keep to:
//!
//! - A page is one session in one fresh folder; its blocks are taken in their order.
//! - Blocks of `sh` are run line by line (`shell`, `session`). A command that is meant to fail says so behind it:
//!   `# exit code 1: why`. What cannot run stands in blocks of `text` or `console`.
//! - A block of `toml`, `wgsl`, `rust`, `json` or `text` whose first line is a comment with a path, as in
//!   `# velvet/plugin.toml`, is written to that file; nobody looks at the others.
//! - A block of `text` behind `brdf eval` or `brdf numerics` holds what that prints, shortened with `...` perhaps.
//! - Files that a reader brings are in the folder where the page names them (`bring`).
//!
//! To take seconds, commands are made small before they run (`cheap`); as they stand they are parsed.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a test says what it expects by unwrapping"
)]

mod bring;
mod cheap;
#[path = "../common/mod.rs"]
mod common;
mod crates;
mod links;
mod page;
mod pictures;
mod program;
mod session;
mod shell;
mod wrong;

use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use page::Page;

/// Commands that the book runs at the least; there are more, and fewer would mean that blocks are passed over.
const LEAST_COMMANDS: usize = 100;

fn main() -> ExitCode {
    let mut trials = vec![
        trial("a_wrong_page_fails", wrong::a_wrong_page_fails),
        trial("lines_that_are_not_understood_fail", wrong::lines_that_are_not_understood_fail),
        trial("the_book_is_long", the_book_is_long),
        trial("every_picture_is_shown", pictures::every_picture_is_shown),
        trial("every_picture_is_made_by_something", pictures::every_picture_is_made_by_something),
        trial("every_integrator_has_its_line", program::every_integrator_has_its_line),
    ];
    for page in Page::all() {
        trials.push(Trial::test(format!("page::{}", page.name), move || holds(&page)));
    }
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn trial(name: &str, test: fn()) -> Trial {
    Trial::test(name, move || {
        test();
        Ok(())
    })
}

/// All that is wrong with a page, a line each.
fn wrong_with(page: &Page) -> Vec<String> {
    let mut wrong = links::wrong(page);
    wrong.extend(program::wrong_in_prose(page));
    wrong.extend(session::wrong(page));
    wrong
}

fn holds(page: &Page) -> Result<(), Failed> {
    match wrong_with(page) {
        wrong if wrong.is_empty() => Ok(()),
        wrong => Err(Failed::from(wrong.join("\n"))),
    }
}

/// A block that nobody reads would pass, so what there is to run is counted, and what only is parsed is not.
fn the_book_is_long() {
    let commands: usize = Page::all().iter().map(session::commands).sum();
    assert!(commands >= LEAST_COMMANDS, "the book has {commands} commands");
}
