//! The options of plots. Each says something of some views; with another one it is refused, and not passed over.

use brdf_sdk::{Problem, Result};
use clap::{ArgAction, ValueEnum};

use crate::plot::{Angles, Channels, Settings, View};

#[derive(Debug, clap::Args)]
pub(super) struct Options {
    /// What is plotted of a colour [default: luminance]
    #[arg(long, value_enum)]
    channel: Option<Channels>,
    /// Values by their logarithm
    #[arg(long)]
    log: bool,
    /// Factors of ten below the largest value that --log shows [default: 4]
    #[arg(long, value_name = "N", requires = "log", allow_hyphen_values = true)]
    decades: Option<f64>,
    /// Multiply f by the cosine of wi
    #[arg(long)]
    cosine: bool,
    /// wi from the normal, in polar, theta-v and lobe [degrees; default: 45]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    theta_i: Option<f64>,
    /// wi's azimuth from the tangent, -360 to 360, in polar, theta-v and lobe [degrees; default: 0]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    phi_i: Option<f64>,
    /// wo's azimuth, in theta-v [degrees; default: opposite to wi] and albedo [default: 0]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    phi_v: Option<f64>,
    /// From the normal to the half vector, in theta-d [degrees; default: 0]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    theta_h: Option<f64>,
    /// From the half vector to wi, in theta-h [degrees; default: 0]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    theta_d: Option<f64>,
    /// wi's azimuth about the half vector, in theta-h, theta-d and slice [degrees; default: 90]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    phi_d: Option<f64>,
    /// Columns of a slice even in the square root of theta_h [default: true]
    #[arg(long, value_name = "BOOL", action = ArgAction::Set)]
    square: Option<bool>,
    /// Colours of a slice without their brightness: each over its largest channel
    #[arg(long)]
    chroma: bool,
    /// Exposure of a slice [stops; default: 0]
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    exposure: Option<f64>,
    /// Pixels of a slice along each angle [default: 256]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    size: Option<f64>,
    /// Where a lobe is seen from: azimuth from wi's [degrees; default: 60]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    turn: Option<f64>,
    /// Where a lobe is seen from: above the surface [degrees; default: 20]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    elevation: Option<f64>,
}

/// Pixels of a slice at the most.
const MOST_PIXELS: f64 = 2048.0;
/// Decades that a logarithmic axis spans at the most, but for what rounding to powers of ten adds.
const MOST_DECADES: f64 = 10.0;

impl Options {
    /// Refuses options that say nothing of a view, and angles that cannot be.
    pub(super) fn check(&self, view: View) -> Result<()> {
        use View::{Albedo, Lobe, Polar, Slice, ThetaD, ThetaH, ThetaV};
        let given: [(&str, bool, &[View]); 15] = [
            ("--channel", self.channel.is_some(), &[Polar, ThetaV, ThetaH, ThetaD, Albedo, Lobe]),
            ("--log", self.log, &[Polar, ThetaV, ThetaH, ThetaD, Albedo, Lobe]),
            ("--cosine", self.cosine, &[Polar, ThetaV, ThetaH, ThetaD, Lobe]),
            ("--theta-i", self.theta_i.is_some(), &[Polar, ThetaV, Lobe]),
            ("--phi-i", self.phi_i.is_some(), &[Polar, ThetaV, Lobe]),
            ("--phi-v", self.phi_v.is_some(), &[ThetaV, Albedo]),
            ("--theta-h", self.theta_h.is_some(), &[ThetaD]),
            ("--theta-d", self.theta_d.is_some(), &[ThetaH]),
            ("--phi-d", self.phi_d.is_some(), &[ThetaH, ThetaD, Slice]),
            ("--square", self.square.is_some(), &[Slice]),
            ("--chroma", self.chroma, &[Slice]),
            ("--exposure", self.exposure.is_some(), &[Slice]),
            ("--size", self.size.is_some(), &[Slice]),
            ("--turn", self.turn.is_some(), &[Lobe]),
            ("--elevation", self.elevation.is_some(), &[Lobe]),
        ];
        let useless = given.iter().find(|(_, given, views)| *given && !views.contains(&view));
        if let Some((option, _, views)) = useless {
            let name = |view: &View| view.to_possible_value().map(|v| v.get_name().to_owned());
            let views: Vec<String> = views.iter().filter_map(name).collect();
            let own = name(&view).unwrap_or_default();
            return Err(Problem::new(
                *option,
                format!("the view {own} has no such thing"),
                format!("leave it out, or take one of the views {}", views.join(", ")),
            ));
        }
        if self.channel == Some(Channels::Rgb) && view == Lobe {
            return Err(Problem::new(
                "--channel rgb",
                "three surfaces of one BRDF would hide each other",
                "name one channel",
            ));
        }
        let quarter = "it goes from the normal to the horizon";
        let turn = "it is an angle of one turn";
        let whole = "it is a whole number";
        let ranges = [
            ("--theta-i", self.theta_i, [0.0, 89.9], "wi must lie above the horizon"),
            ("--theta-h", self.theta_h, [0.0, 90.0], quarter),
            ("--theta-d", self.theta_d, [0.0, 90.0], quarter),
            ("--elevation", self.elevation, [0.0, 90.0], "the surface is seen from above"),
            ("--phi-i", self.phi_i, [-360.0, 360.0], turn),
            ("--phi-v", self.phi_v, [-360.0, 360.0], turn),
            ("--phi-d", self.phi_d, [-360.0, 360.0], turn),
            ("--turn", self.turn, [-360.0, 360.0], turn),
            ("--exposure", self.exposure, [-60.0, 60.0], "nothing would be seen"),
            (
                "--size",
                self.size,
                [1.0, MOST_PIXELS],
                "a slice has that many pixels along each angle",
            ),
            ("--decades", self.decades, [1.0, MOST_DECADES], "an axis has room for some only"),
            ("--size", self.size.map(f64::fract), [0.0, 0.0], whole),
            ("--decades", self.decades.map(f64::fract), [0.0, 0.0], whole),
        ];
        for (option, value, [low, high], reason) in ranges {
            if let Some(value) = value.filter(|value| !(low..=high).contains(value)) {
                let cure = match reason == whole {
                    true => "leave out what is behind the point".to_owned(),
                    false => format!("give a number from {low} to {high}"),
                };
                return Err(Problem::new(format!("{option} {value}"), reason, cure));
            }
        }
        Ok(())
    }

    /// The choices, with the defaults of what was not said.
    pub(super) fn settings(&self) -> Settings {
        let usual = Settings::default();
        let wi = Angles {
            theta: self.theta_i.unwrap_or(usual.wi.theta),
            phi: self.phi_i.unwrap_or(usual.wi.phi),
        };
        let [turn, elevation] = usual.eye;
        Settings {
            channels: self.channel.unwrap_or_default(),
            decades: self.log.then(|| self.decades.unwrap_or(4.0)),
            cosine: self.cosine,
            wi,
            phi_v: self.phi_v.unwrap_or(wi.phi + 180.0),
            albedo_azimuth: self.phi_v.unwrap_or(usual.albedo_azimuth),
            theta_h: self.theta_h.unwrap_or(usual.theta_h),
            theta_d: self.theta_d.unwrap_or(usual.theta_d),
            phi_d: self.phi_d.unwrap_or(usual.phi_d),
            square: self.square.unwrap_or(usual.square),
            chroma: self.chroma,
            exposure: self.exposure.unwrap_or(usual.exposure),
            size: self.size.map_or(usual.size, |size| size as usize),
            eye: [wi.phi + self.turn.unwrap_or(turn), self.elevation.unwrap_or(elevation)],
        }
    }
}
