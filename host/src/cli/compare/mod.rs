//! `brdf compare`: how far one picture is from another, and where.

mod report;

use std::path::{Path, PathBuf};

use brdf_sdk::{Problem, Result};
use clap::ValueEnum;

use super::{Verdict, print};
use crate::exec::memory;
use crate::measure::compare::{self, Bias, ZScores, flip};
use crate::picture::read::{self, Stored};
use crate::picture::{self, FalseColour, Scale};
use crate::tone::Tone;
use report::Report;

#[derive(Debug, clap::Args)]
pub(super) struct Arguments {
    /// The picture in question: .exr, .hdr or .png
    a: PathBuf,
    /// The reference
    b: PathBuf,
    /// The figure
    #[arg(long, value_enum, default_value_t = Metric::Relmse)]
    metric: Metric,
    /// Exit with code 1 where the figure is above this, is no number, or a pixel is not finite
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    fail: Option<f64>,
    /// Average relmse, mean difference and z over all pixels, not only over those that the reference
    /// covers (alpha above 0); all are taken where it has no alpha, and always for the other metrics
    #[arg(long)]
    all_pixels: bool,
    /// Write a false-colour picture with its legend here (.png); few values may lie beyond a linear
    /// scale's ends and take their colours
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// What the false-colour picture shows
    #[arg(long, value_enum, default_value_t = Map::Error, requires = "output")]
    map: Map,
    /// Exposure in stops before the display curve; flip alone sees through that curve
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true)]
    exposure: f64,
    /// Pixels in a degree of the viewer's sight, for flip
    #[arg(long, value_name = "N", default_value_t = flip::PIXELS_PER_DEGREE)]
    pixels_per_degree: f64,
    /// Print JSON; what is not finite becomes null
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Metric {
    /// Mean of (a - b)^2 over pixels and channels
    Mse,
    /// Its square root
    Rmse,
    /// Mean of (a - b)^2 / (b^2 + eps), eps = (0.01 mean of b)^2
    Relmse,
    /// Mean of |a - b|
    Mae,
    /// Mean of FLIP (Andersson et al. 2020): what the eye sees of the tone-mapped pictures' difference
    Flip,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Map {
    /// The metric of each pixel
    Error,
    /// a - b, mean of the channels: blue where A is darker, red where it is brighter
    Signed,
    /// z = (a - b) / standard error, mean of the channels, from -5 to 5; it supposes that the noise of
    /// both is independent: render with different seeds
    Z,
}

impl Metric {
    fn name(self) -> &'static str {
        match self {
            Self::Mse => "mse",
            Self::Rmse => "rmse",
            Self::Relmse => "relmse",
            Self::Mae => "mae",
            Self::Flip => "flip",
        }
    }
}

/// Memory for measuring and drawing a pixel, as allocated at the peak [bytes].
const BYTES_PER_PIXEL: u64 = 96;
/// And for FLIP, which holds many planes of each picture at once.
const FLIP_BYTES_PER_PIXEL: u64 = 256;

/// Where |z| ends on its map.
const LARGEST_Z: f64 = 5.0;

/// Two pictures of one size, and which of their pixels count.
struct Pair {
    a: Stored,
    b: Stored,
    /// Pixels that are finite in both.
    finite: Vec<bool>,
    /// Those of them that the reference covers, or all.
    covered: Vec<bool>,
}

pub(super) fn run(arguments: &Arguments) -> Result<Verdict> {
    check(arguments)?;
    let pair = Pair::read(arguments)?;
    let (per_pixel, figure) = pair.measure(arguments);
    let bias = compare::bias(&pair.a.rgb, &pair.b.rgb, pair.errors(), &pair.covered);
    let scores = pair.scores();
    if let Some(path) = &arguments.output {
        let map = pair.map(arguments, &per_pixel, scores.as_ref())?;
        picture::stage_false_colour(path, &map.shown(&pair))?.keep()?;
    }
    let report = Report::new(arguments, &pair, figure, bias, scores.as_ref());
    print(&if arguments.json { report.json() } else { report.text() })?;
    Ok(if report.passed { Verdict::Passed } else { Verdict::Failed })
}

/// Refuses options that cannot be, before anything is read.
fn check(arguments: &Arguments) -> Result<()> {
    let refuse = |option: String, reason: &str, cure: &str| Err(Problem::new(option, reason, cure));
    if let Some(limit) = arguments.fail.filter(|limit| !(limit.is_finite() && *limit >= 0.0)) {
        return refuse(
            format!("--fail {limit}"),
            "no figure can be held to this",
            "give a finite number of at least 0",
        );
    }
    if !arguments.exposure.is_finite() || arguments.exposure.abs() > 100.0 {
        return refuse(
            format!("--exposure {}", arguments.exposure),
            "this is no exposure",
            "give stops from -100 to 100",
        );
    }
    if !(1.0..=1000.0).contains(&arguments.pixels_per_degree) {
        return refuse(
            format!("--pixels-per-degree {}", arguments.pixels_per_degree),
            "no screen is seen like this",
            "give a number from 1 to 1000; a desktop has about 67",
        );
    }
    let Some(path) = &arguments.output else { return Ok(()) };
    if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
        return refuse(
            format!("--output {}", path.display()),
            "the false-colour picture is a PNG",
            "give a name that ends in .png",
        );
    }
    let same = |other: &Path| match (path.canonicalize(), other.canonicalize()) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    };
    if same(&arguments.a) || same(&arguments.b) {
        return refuse(
            format!("--output {}", path.display()),
            "this would replace a picture that is compared",
            "choose another name",
        );
    }
    picture::check_writable(path)
}

/// Refuses pictures that need more memory than this machine can give.
fn check_memory([width, height]: [u32; 2], metric: Metric) -> Result<()> {
    let bytes = match metric {
        Metric::Flip => FLIP_BYTES_PER_PIXEL,
        _ => BYTES_PER_PIXEL,
    };
    let needed = u64::from(width) * u64::from(height) * bytes;
    let budget = memory::budget();
    if needed <= budget {
        return Ok(());
    }
    Err(Problem::new(
        format!("pictures of {width}x{height}"),
        format!(
            "comparing them takes {} of memory, half of what is free is {}",
            memory::shown(needed),
            memory::shown(budget)
        ),
        "compare smaller ones, or free memory",
    ))
}

impl Pair {
    fn read(arguments: &Arguments) -> Result<Self> {
        let [a, b] = [read::read(&arguments.a)?, read::read(&arguments.b)?];
        if a.resolution != b.resolution {
            let size = |[width, height]: [u32; 2]| format!("{width}x{height}");
            return Err(Problem::new(
                arguments.a.display().to_string(),
                format!(
                    "it is {}, and {} is {}",
                    size(a.resolution),
                    arguments.b.display(),
                    size(b.resolution)
                ),
                "compare pictures of one size",
            ));
        }
        check_memory(a.resolution, arguments.metric)?;
        let finite = compare::finite(&a.rgb, &b.rgb);
        let covered = match &b.coverage {
            Some(coverage) if !arguments.all_pixels => {
                finite.iter().zip(coverage).map(|(finite, a)| *finite && *a > 0.0).collect()
            }
            _ => finite.clone(),
        };
        Ok(Self { a, b, finite, covered })
    }

    /// Each pixel's error, and the figure.
    fn measure(&self, arguments: &Arguments) -> (Vec<f64>, Figure) {
        let (a, b) = (&self.a.rgb, &self.b.rgb);
        let per_pixel = match arguments.metric {
            Metric::Mse | Metric::Rmse => compare::squared(a, b),
            Metric::Relmse => compare::relative(a, b, compare::relative_eps(b, &self.covered)),
            Metric::Mae => compare::absolute(a, b),
            Metric::Flip => {
                let [a, b] = [&self.a, &self.b].map(|side| self.light(side, arguments.exposure));
                let width = self.b.resolution[0] as usize;
                let mut map = flip::flip(&a, &b, width, arguments.pixels_per_degree);
                let values = map.iter_mut().zip(&self.finite);
                values.filter(|(_, finite)| !**finite).for_each(|(value, _)| *value = f64::NAN);
                map
            }
        };
        let counted = match arguments.metric {
            Metric::Relmse => &self.covered,
            _ => &self.finite,
        };
        let mean = compare::mean(&per_pixel, counted);
        let pixels = counted.iter().filter(|counted| **counted).count();
        match arguments.metric {
            Metric::Rmse => (
                per_pixel.into_iter().map(f64::sqrt).collect(),
                Figure { value: mean.sqrt(), pixels },
            ),
            _ => (per_pixel, Figure { value: mean, pixels }),
        }
    }

    /// A screen's light: radiance goes through the display curve, and what is a display's stays as it is.
    /// Pixels that are not finite in both pictures are black in both.
    fn light(&self, side: &Stored, exposure: f64) -> Vec<[f32; 3]> {
        let shown = |pixel: &[f32; 3]| match side.for_display {
            true => *pixel,
            false => pixel.map(|radiance| Tone::exposed(exposure).light(radiance)),
        };
        let pixels = side.rgb.iter().zip(&self.finite);
        pixels.map(|(pixel, finite)| if *finite { shown(pixel) } else { [0.0; 3] }).collect()
    }

    fn errors(&self) -> [Option<&compare::Pixels>; 2] {
        [&self.a, &self.b].map(|side| side.std_error.as_deref())
    }

    /// The z-scores; `None` where neither picture has standard errors.
    fn scores(&self) -> Option<ZScores> {
        let errors = self.errors();
        let known = errors.iter().any(Option::is_some);
        known.then(|| compare::z_scores(&self.a.rgb, &self.b.rgb, errors, &self.covered))
    }

    /// What the false-colour picture shows.
    fn map(
        &self,
        arguments: &Arguments,
        per_pixel: &[f64],
        scores: Option<&ZScores>,
    ) -> Result<Numbers> {
        Ok(match (arguments.map, scores) {
            (Map::Error, _) => Numbers {
                scale: match arguments.metric {
                    Metric::Flip => Scale::Linear { largest: 1.0 },
                    _ => Scale::logarithmic(per_pixel),
                },
                values: per_pixel.to_vec(),
                title: format!("{} OF A PIXEL", arguments.metric.name().to_uppercase()),
            },
            (Map::Signed, _) => {
                let values = compare::signed(&self.a.rgb, &self.b.rgb);
                let scale = Scale::diverging(&values);
                Numbers { values, scale, title: "A - B".to_owned() }
            }
            (Map::Z, Some(scores)) => Numbers {
                values: scores.per_pixel.clone(),
                scale: Scale::Diverging { largest: LARGEST_Z },
                title: "Z, A - B IN STANDARD ERRORS".to_owned(),
            },
            (Map::Z, None) => {
                return Err(Problem::new(
                    "--map z",
                    "neither picture has standard errors (channels std_error.R, std_error.G, std_error.B)",
                    "name pictures of several passes, or show --map signed",
                ));
            }
        })
    }
}

/// The numbers of a false-colour picture.
struct Numbers {
    values: Vec<f64>,
    scale: Scale,
    title: String,
}

impl Numbers {
    fn shown(&self, pair: &Pair) -> FalseColour<'_> {
        let width = pair.b.resolution[0] as usize;
        FalseColour { width, values: &self.values, scale: self.scale, title: &self.title }
    }
}

/// The metric's value, and how many pixels it is the mean of.
#[derive(Debug, Clone, Copy)]
struct Figure {
    value: f64,
    pixels: usize,
}
