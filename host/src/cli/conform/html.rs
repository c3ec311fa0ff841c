//! Verdicts and plots as one page, which needs nothing from outside.

use std::fmt::Write as _;
use std::path::Path;

use brdf_sdk::{Problem, Result};

use super::plots::plots;
use super::table::{closing, heading, mark, numbers, shown};
use crate::conformance::{Law, Outcome, Report, Verdict};
use crate::picture;
use crate::picture::chart::{self, escape};

/// Refuses a path that the page cannot be written to, before any work is done for it.
pub fn check(path: &Path) -> Result<()> {
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html")) {
        return Err(Problem::new(
            format!("--html {}", path.display()),
            "the page is HTML",
            "give a name that ends in .html",
        ));
    }
    picture::check_writable(path)
}

/// Writes the page on BRDFs, each with the words that the user named it by.
pub fn write(path: &Path, reports: &[(&str, &Report)], deep: bool) -> Result<()> {
    picture::write_text(path, &page(reports, deep)?)
}

fn page(reports: &[(&str, &Report)], deep: bool) -> Result<String> {
    let names: Vec<String> =
        reports.iter().map(|(reference, report)| heading(reference, report)).collect();
    let several = names.len() > 1;
    let title = if several { format!("{} BRDFs", names.len()) } else { names.join("") };
    let mut body = format!("<h1>Conformance of {}</h1>\n", escape(&title));
    let all: Vec<&Report> = reports.iter().map(|(_, report)| *report).collect();
    let _ = writeln!(body, "<p>{}</p>", escape(closing(&all).trim_end()));
    let depth = if deep { " with <code>--deep</code>" } else { "" };
    let version = env!("CARGO_PKG_VERSION");
    let _ =
        writeln!(body, "<p class=\"aside\">brdf {version}, <code>brdf conform</code>{depth}</p>");
    if several {
        body += &overview(reports);
    }
    for (index, (reference, report)) in reports.iter().enumerate() {
        body += &section(index, reference, report, deep)?;
    }
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>{}: brdf conform</title>\n\
         <style>\n{}{}</style>\n</head>\n<body>\n{body}</body>\n</html>\n",
        escape(&title),
        include_str!("../page.css"),
        chart::STYLE,
    ))
}

/// What became of each law for each BRDF, with links to the verdicts.
fn overview(reports: &[(&str, &Report)]) -> String {
    let all = || reports.iter().flat_map(|(_, report)| &report.verdicts);
    let judged = |law: &Law| all().any(|verdict| verdict.law == *law);
    let laws: Vec<Law> = Law::ALL.into_iter().filter(judged).collect();
    let mut html = "<div class=\"wide\"><table class=\"overview\">\n<tr><th></th>".to_owned();
    for law in &laws {
        let _ = write!(html, "<th>{}</th>", law.word());
    }
    html += "</tr>\n";
    for (index, (reference, report)) in reports.iter().enumerate() {
        let name = escape(&heading(reference, report));
        let _ = write!(html, "<tr><th><a href=\"#b{index}\">{name}</a></th>");
        for law in &laws {
            let verdict = report.verdicts.iter().find(|verdict| verdict.law == *law);
            let _ = match verdict {
                Some(Verdict { outcome, .. }) => write!(
                    html,
                    "<td class=\"{}\"><a href=\"#b{index}-{}\">{}</a></td>",
                    class(*outcome),
                    law.word(),
                    mark(*outcome)
                ),
                None => write!(html, "<td></td>"),
            };
        }
        html += "</tr>\n";
    }
    html + "</table></div>\n"
}

/// One BRDF: its verdicts and its plots.
fn section(index: usize, reference: &str, report: &Report, deep: bool) -> Result<String> {
    let [name, device] = [&report.name, &report.device].map(|text| escape(text));
    let reference_shown = escape(reference);
    let mut html = format!(
        "<section id=\"b{index}\">\n<h2>{name} <code>{reference_shown}</code></h2>\n<p class=\"aside\">on {device}</p>\n\
         <div class=\"wide\"><table class=\"verdicts\">\n<tr><th>law</th><th>verdict</th>\
         <th title=\"the number is at most the threshold, or at least where both are probabilities\">\
         number / threshold</th><th>what was found</th><th>cases</th><th>time</th></tr>\n"
    );
    for verdict in &report.verdicts {
        html += &row(index, reference, verdict, deep);
    }
    html += "</table></div>\n";
    html += &plots(&report.plots)?;
    Ok(html + "</section>\n")
}

fn row(index: usize, reference: &str, verdict: &Verdict, deep: bool) -> String {
    let Verdict { law, outcome, said, cases, seconds, .. } = verdict;
    let mut found = escape(said);
    if let Some(reproduce) = &verdict.reproduce {
        let reproduce = escape(&shown(reproduce, reference));
        let _ = write!(found, "<div class=\"more\">see <code>{reproduce}</code></div>");
    }
    for note in &verdict.notes {
        let _ = write!(found, "<div class=\"more\">note: {}</div>", escape(note));
    }
    // Budgets hold where nobody wants it deep.
    let (over, budget) = match law.budget() {
        _ if deep => ("", String::new()),
        // As it is printed.
        budget if (10.0 * seconds).round() > 10.0 * budget => {
            (" class=\"over\"", format!(" of {budget} s, over"))
        }
        budget => ("", format!(" of {budget} s")),
    };
    let cases = if *cases == 0 { String::new() } else { cases.to_string() };
    format!(
        "<tr id=\"b{index}-{law}\"><th>{law}</th><td class=\"{}\">{}</td><td class=\"number\">{}</td>\
         <td>{found}</td><td class=\"number\">{cases}</td><td{over}>{seconds:.1} s{budget}</td></tr>\n",
        class(*outcome),
        mark(*outcome),
        numbers(verdict),
        law = law.word(),
    )
}

fn class(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Passed => "passed",
        Outcome::Failed => "failed",
        Outcome::Skipped => "skipped",
        Outcome::Reported => "reported",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conformance::Plots;

    #[test]
    fn what_a_plugin_says_stays_text() {
        let said = "1 < 2 & <script src=\"x\">";
        let verdict =
            Verdict::new(Law::Energy, Outcome::Failed, said).shown_by("brdf eval BRDF <x>");
        let report = Report {
            brdf: "a".to_owned(),
            name: "A<b>".to_owned(),
            device: "d".to_owned(),
            verdicts: vec![Verdict { seconds: 9.0, ..verdict }],
            plots: Plots::default(),
        };
        let both = [("./a", &report), ("b", &report)];
        let found = page(&both, false).unwrap();
        assert!(!found.contains("<script") && !found.contains("<b>") && !found.contains("<x>"));
        for part in
            ["1 &lt; 2 &amp;", "brdf eval ./a &lt;x&gt;", "9.0 s of 4 s, over", "#b1-energy"]
        {
            assert!(found.contains(part), "{part} is not in {found}");
        }
        assert!(!page(&both, true).unwrap().contains("of 4 s"));
    }
}
