//! The test of the test: pages with a mistake each, which have to be told with their line.

use super::page::Page;
use super::{shell, wrong_with};

/// A page, and what is to be said of it; nothing where it is right.
const PAGES: [(&str, &[&str]); 18] = [
    (
        "# A page\n\n```sh\nbrdf list   # all of them\necho 0 0 1 0.6 0 0.8 | brdf eval lambert\n```\n\n[here](#a-page)\n",
        &[],
    ),
    (
        "```sh\nbrdf list --no-such-option\n```\n",
        &["page.md:2: brdf list --no-such-option: error: unexpected argument"],
    ),
    (
        "```sh\nbrdf list\n\nbrdf eval nothing --albedo\n```\n",
        &["page.md:4: brdf eval nothing --albedo: exit code 2 and not 0"],
    ),
    (
        "```sh\nbrdf list   # exit code 1: nobody knows why\n```\n",
        &["page.md:2: brdf list   # exit code 1", "exit code 0 and not 1"],
    ),
    ("```sh\nbrdf eval nothing --albedo   # exit code 2: there is no such BRDF\n```\n", &[]),
    (
        "```sh\nbrdf list > list.txt\n```\n",
        &["page.md:2: brdf list > list.txt: `>` is not understood"],
    ),
    ("```sh\nmake all\n```\n", &["nothing is known of this program"]),
    (
        "```sh\ncargo test -p brdf-host --test nothing\nscripts/nothing\n```\n",
        &["there is no test nothing", "there is no scripts/nothing"],
    ),
    (
        "```sh\nbrdf view --nothing\n```\n",
        &["page.md:2: brdf view --nothing: error: unexpected argument"],
    ),
    ("```\nbrdf list\n```\n", &["page.md:2: brdf list: a command in a block without a language"]),
    (
        "```toml\n# scene.toml, shortened\n```\n",
        &["page.md:2: # scene.toml, shortened: write the path alone"],
    ),
    (
        "```toml\n# a/plugin.toml\nkind = \"brdf\"\n```\n```sh\nbrdf expand ./a   # exit code 2: it has no name\n```\n",
        &[],
    ),
    (
        "```sh\necho 0 0 1 0 0 1 | brdf eval lambert\n```\n\n```text\nf_r,f_g,f_b,pdf,weight_r,weight_g,weight_b\n...\nf_g\n```\n",
        &["page.md:8: f_g: the command above does not print this"],
    ),
    (
        "[a](docs/nothing.md)\n",
        &["page.md:1: the link docs/nothing.md: there is no docs/nothing.md"],
    ),
    ("[a](docs/plots.md#nothing)\n", &["docs/plots.md has no heading #nothing"]),
    (
        "`brdf render ggx --nothing 3`, `--nothing`\n",
        &["page.md:1: `brdf render ggx --nothing 3`: ", "page.md:1: `--nothing`: no verb has"],
    ),
    (
        "`brdf render ggx nothing --rendering uniform`\n",
        &["page.md:1: `brdf render ggx nothing --rendering uniform`: there is no plugin nothing"],
    ),
    ("`tests/nothing.rs`\n", &["page.md:1: `tests/nothing.rs`: there is no tests/nothing.rs"]),
];

pub fn a_wrong_page_fails() {
    for (text, expected) in PAGES {
        let page = Page { name: "page.md".to_owned(), text: text.to_owned() };
        let told = wrong_with(&page);
        assert_eq!(told.is_empty(), expected.is_empty(), "{text}\n{told:?}");
        for part in expected {
            assert!(
                told.iter().any(|line| line.contains(part)),
                "{text}\nsays {told:?} and not {part}"
            );
        }
    }
}

pub fn lines_that_are_not_understood_fail() {
    for line in [
        "brdf list; brdf list",
        "brdf list && brdf list",
        "brdf list $HOME",
        "brdf list \"$HOME\"",
        "brdf list 'open",
        "brdf list *.toml",
        "cat rows.txt | brdf eval lambert",
        "echo 1 | brdf eval lambert | sort",
        "brdf list # exit code 3: there is none",
        "brdf list # exit code 1",
        "brdf list \\",
    ] {
        assert!(shell::parse(line).is_err(), "{line}");
    }
    let command = shell::parse("brdf plot --vary 'base_color=1,0,0;0,1,0' #f").unwrap().unwrap();
    assert_eq!(command.words, ["brdf", "plot", "--vary", "base_color=1,0,0;0,1,0"]);
    let piped = shell::parse("echo 0 0 1 | brdf eval ./a#b  # words").unwrap().unwrap();
    assert_eq!((piped.words.len(), piped.input.as_deref(), piped.code), (3, Some("0 0 1\n"), 0));
    assert_eq!(shell::parse("  # a comment alone").unwrap(), None);
}
