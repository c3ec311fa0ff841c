//! Figures as one page, which needs nothing from outside: winners, curves, pictures after equal times.

use std::fmt::Write as _;

use brdf_sdk::{Problem, Result};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::table::{seconds, times};
use crate::bench::{CaseReport, CellReport, Limits, Pictured, Report};
use crate::picture::Raster;
use crate::picture::chart::{self, Axis, Curve, Curves, Pen, escape};

/// The page.
///
/// # Errors
/// Where a picture cannot be encoded.
pub(super) fn page(report: &Report, pictures: &[Pictured]) -> Result<String> {
    let mut body = "<h1>Speed against error</h1>\n".to_owned();
    let Report { version, limits: Limits { time, repeats, seed, .. }, .. } = report;
    let _ = writeln!(
        body,
        "<p class=\"aside\">brdf {version}, <code>brdf bench</code>: {time} s of rendering a cell, each timed {repeats} \
         times, seed {seed}; times are medians</p>"
    );
    for device in &report.devices {
        let _ = writeln!(
            body,
            "<p>On {}: the kernel that is the same everywhere makes {:.1} million samples a second ({:.1} to {:.1}).{}</p>",
            escape(&device.name),
            device.calibration.median,
            device.calibration.low,
            device.calibration.high,
            if device.disturbed {
                " <span class=\"failed\">The machine was disturbed: figures of speed spread by more than a quarter.</span>"
            } else {
                ""
            }
        );
        body += &winners(report, &device.name);
    }
    for (index, case) in report.cases.iter().enumerate() {
        body += &section(report, pictures, index, case)?;
    }
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>Speed against error: brdf bench</title>\n\
         <style>\n{}{}{}</style>\n</head>\n<body>\n{body}</body>\n</html>\n",
        include_str!("../page.css"),
        include_str!("page.css"),
        chart::STYLE,
    ))
}

/// BRDFs down, maps across: the best integrator of each, and how much better than the plain one.
fn winners(report: &Report, device: &str) -> String {
    let mut brdfs: Vec<&str> = Vec::new();
    let mut maps: Vec<&str> = Vec::new();
    for case in &report.cases {
        if !brdfs.contains(&case.brdf.as_str()) {
            brdfs.push(&case.brdf);
        }
        if !maps.contains(&case.map.as_str()) {
            maps.push(&case.map);
        }
    }
    let mut html =
        "<h3>Which integrator?</h3>\n<div class=\"wide\"><table class=\"winners\">\n".to_owned();
    // Scenes with a BRDF and a map of their own would leave most of a matrix empty.
    if 2 * report.cases.len() < brdfs.len() * maps.len() {
        html += "<tr><th>scene</th><th>to use</th></tr>\n";
        for (index, case) in report.cases.iter().enumerate() {
            let winner = winner(report, device, index, case);
            let _ = writeln!(html, "<tr><th>{}</th><td>{winner}</td></tr>", escape(&case.name));
        }
        return html + WINNERS_END;
    }
    html += "<tr><th></th>";
    for map in &maps {
        let _ = write!(html, "<th>{}</th>", escape(map));
    }
    html += "</tr>\n";
    for brdf in &brdfs {
        let _ = write!(html, "<tr><th>{}</th>", escape(brdf));
        for map in &maps {
            let of = |(_, case): &(usize, &CaseReport)| case.brdf == *brdf && case.map == *map;
            html += "<td>";
            for (index, case) in report.cases.iter().enumerate().filter(of) {
                html += &winner(report, device, index, case);
            }
            html += "</td>";
        }
        html += "</tr>\n";
    }
    html + WINNERS_END
}

const WINNERS_END: &str = "</table></div>\n<p class=\"aside\">Least relMSE times seconds; beside it 1 / (MSE s) over \
                           that of <code>uniform</code>, and the time to the target relMSE.</p>\n";

fn winner(report: &Report, device: &str, index: usize, case: &CaseReport) -> String {
    let ranked = report.ranked(device, &case.name);
    let Some(best) = ranked.first().filter(|cell| cell.last().is_some()) else {
        return "<span class=\"skipped\">none</span>".to_owned();
    };
    let over = best.over_plain.map(|over| format!(" ×{}", times(over))).unwrap_or_default();
    let target = best.seconds_to_target.map(|time| {
        format!(
            "<br><span class=\"aside\">{} s to {:.0e}</span>",
            seconds(time),
            report.limits.target
        )
    });
    let scene = match report
        .cases
        .iter()
        .filter(|other| (&other.brdf, &other.map) == (&case.brdf, &case.map))
        .count()
    {
        1 => String::new(),
        _ => format!("<span class=\"aside\">{}</span> ", escape(&case.name)),
    };
    format!(
        "<div>{scene}<a href=\"#c{index}\"><b>{}</b></a>{over}{}</div>",
        escape(&best.integrator),
        target.unwrap_or_default()
    )
}

/// A scene: its figures, curves and pictures.
fn section(
    report: &Report,
    pictures: &[Pictured],
    index: usize,
    case: &CaseReport,
) -> Result<String> {
    let mut html = format!(
        "<section id=\"c{index}\">\n<h2>{}</h2>\n<p class=\"aside\">{} pixels; reference {}</p>\n",
        escape(&case.name),
        case.covered_pixels,
        escape(&case.reference_said)
    );
    for note in &case.notes {
        let _ = writeln!(html, "<p class=\"aside\">note: {}</p>", escape(note));
    }
    for device in &report.devices {
        if report.devices.len() > 1 {
            let _ = writeln!(html, "<h3>{}</h3>", escape(&device.name));
        }
        let cells = report.ranked(&device.name, &case.name);
        html += &table(report, &cells);
        html += &format!("<div class=\"row\">{}</div>\n", curves(report, &device.name, case));
        let shown: Vec<&Pictured> = pictures
            .iter()
            .filter(|one| one.case == case.name && one.device == device.name)
            .collect();
        html += &row_of_pictures(report, &cells, &shown)?;
    }
    let _ = writeln!(
        html,
        "<details><summary>The scene, for <code>brdf render --session</code></summary>\n<pre>{}</pre></details>",
        escape(&case.scene)
    );
    Ok(html + "</section>\n")
}

fn table(report: &Report, cells: &[&CellReport]) -> String {
    let mut html = format!(
        "<div class=\"wide\"><table class=\"verdicts\">\n<tr><th>integrator</th><th>spp</th><th>time [s]</th>\
         <th>M samples/s</th><th>relMSE</th><th>its own estimate</th><th>bias / its error</th><th>FLIP</th>\
         <th>slope</th><th>s to {:.0e}</th><th title=\"1 / (MSE s) over that of uniform\">× uniform</th><th>of best</th><th>peak memory</th></tr>\n",
        report.limits.target
    );
    for cell in cells {
        let name = escape(&cell.integrator);
        let Some(last) = cell.last().filter(|_| cell.problem.is_none()) else {
            let problem = cell.problem.clone().unwrap_or_else(|| "nothing was measured".to_owned());
            let _ = writeln!(
                html,
                "<tr><th>{name}</th><td colspan=\"12\">{}</td></tr>",
                escape(&problem)
            );
            continue;
        };
        let errors = &last.errors;
        let or_none = |text: Option<String>| text.unwrap_or_else(|| "–".to_owned());
        let done = match cell.texels {
            Some([done, of]) if done < of => {
                format!("{:.0} % of {of} texels", 100.0 * f64::from(done) / f64::from(of))
            }
            Some([_, of]) => format!("{of} texels"),
            None => last.spp.to_string(),
        };
        let z = errors.bias_std_error.filter(|e| *e > 0.0).map(|e| errors.bias / e);
        let rate = cell.rate.map(|rate| {
            format!(
                "{:.2} <span class=\"aside\">{:.2}–{:.2}</span>",
                rate.median, rate.low, rate.high
            )
        });
        let on_device = last.device_seconds.map(|spread| {
            let own = seconds(spread.median);
            format!(" <span class=\"aside\" title=\"dispatches alone, by the device's clock\">{own}</span>")
        });
        let on_device = on_device.unwrap_or_default();
        let fields = [
            done,
            format!("{}{on_device}", seconds(last.seconds.median)),
            or_none(rate),
            format!("{:.2e}", errors.relmse),
            or_none(errors.estimate.map(|own| format!("{own:.2e}"))),
            or_none(z.map(|z| format!("{z:.1}"))),
            format!("{:.4}", errors.flip),
            or_none(cell.slope.map(|slope| format!("{slope:.2}"))),
            or_none(cell.seconds_to_target.map(seconds)),
            or_none(cell.over_plain.map(times)),
            or_none(cell.of_best.map(|part| format!("{part:.2}"))),
            or_none(cell.peak_memory.map(crate::exec::memory::shown)),
        ];
        let fields: String =
            fields.iter().map(|field| format!("<td class=\"number\">{field}</td>")).collect();
        let bad = match errors.nonfinite {
            0 => String::new(),
            count => format!("<div class=\"failed\">{count} samples were Inf or NaN</div>"),
        };
        let _ = writeln!(html, "<tr><th>{name}{bad}</th>{fields}</tr>");
    }
    html + "</table></div>\n"
}

/// relMSE against time, and against samples; both by logarithms, a colour for each integrator wherever it ranks.
fn curves(report: &Report, device: &str, case: &CaseReport) -> String {
    let of = |cell: &&CellReport| cell.case == case.name && cell.device == device;
    let cells: Vec<&CellReport> = report.cells.iter().filter(of).collect();
    let mut html = String::new();
    for (title, detail, words, by_time) in [
        ("relMSE against time", "equal error lies at equal height", "seconds of rendering", true),
        (
            "relMSE against samples",
            "-1 is the slope of independent samples",
            "samples of a pixel",
            false,
        ),
    ] {
        let x = |step: &crate::bench::Step| match by_time {
            true => step.seconds.median,
            false => step.spp as f64,
        };
        let curve = |(index, cell): (usize, &&CellReport)| Curve {
            name: cell.integrator.clone(),
            pen: Pen::of(index),
            points: cell
                .steps
                .iter()
                .filter(|step| (by_time || step.spp > 0) && !cell.unfinished())
                .map(|step| [x(step), step.errors.relmse])
                .filter(|point| point.iter().all(|value| *value > 0.0))
                .collect(),
            band: Vec::new(),
        };
        let curves: Vec<Curve> =
            cells.iter().enumerate().map(curve).filter(|c| !c.points.is_empty()).collect();
        let values =
            |axis: usize| curves.iter().flat_map(move |c| c.points.iter().map(move |p| p[axis]));
        let Some(first) = curves.first().and_then(|c| c.points.first()).copied() else { continue };
        let chart = Curves {
            title,
            detail,
            x: (Axis::logarithmic(values(0), first[0]), words),
            y: Axis::logarithmic(values(1), first[1]),
            curves: &curves,
            line: None,
        };
        html += &chart.svg();
    }
    html
}

/// What each integrator shows after the time that all have, and how wrong it is.
fn row_of_pictures(
    report: &Report,
    cells: &[&CellReport],
    pictures: &[&Pictured],
) -> Result<String> {
    if pictures.is_empty() {
        return Ok(String::new());
    }
    let mut html = format!(
        "<h3>After {} s</h3>\n<p class=\"aside\">Below, the relative error: black is a tenth of a percent and less, white all \
         of the radiance.</p>\n<div class=\"shots\">",
        report.limits.time
    );
    let by = |name: Option<&str>| pictures.iter().find(|one| one.integrator.as_deref() == name);
    let names =
        std::iter::once(None).chain(cells.iter().map(|cell| Some(cell.integrator.as_str())));
    for one in names.filter_map(by) {
        let name = one.integrator.as_deref().unwrap_or("reference");
        let _ = write!(
            html,
            "<figure><figcaption>{}</figcaption>{}",
            escape(name),
            shot(&one.picture, name)?
        );
        if let Some(error) = &one.error {
            html += &shot(error, &format!("relative error of {name}"))?;
        }
        html += "</figure>";
    }
    Ok(html + "</div>\n")
}

/// Points that a picture is wide at the least.
const SHOT: u32 = 128;

fn shot(raster: &Raster, name: &str) -> Result<String> {
    let [width, height] = raster.resolution;
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(raster.rgb.as_flattened(), width, height, ExtendedColorType::Rgb8)
        .map_err(|error| {
            Problem::new(name, format!("its picture cannot be encoded ({error})"), "report this")
        })?;
    let data = base64::encode(png);
    let name = escape(name);
    // Small ones are shown larger, in whole pixels.
    let factor = SHOT.div_ceil(width.max(1));
    let [width, height] = [width * factor, height * factor];
    Ok(format!(
        "<img width=\"{width}\" height=\"{height}\" alt=\"{name}\" src=\"data:image/png;base64,{data}\">"
    ))
}
