//! The choices of a plot, which the command line and the window share: the view, its directions, what is drawn of f.

use clap::ValueEnum;

use super::{Angles, Channel, Quantity};

/// What is plotted.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Hash, ValueEnum, serde::Serialize, serde::Deserialize,
)]
pub enum View {
    /// f against wo in the plane of wi, around the normal
    Polar,
    /// f against wo's angle in any plane
    ThetaV,
    /// f against the half vector's angle, at a fixed difference
    ThetaH,
    /// f against the difference angle, at a fixed half vector
    ThetaD,
    /// The directional albedo against wo's angle, with a band of two standard errors
    Albedo,
    /// f as colours over theta_h and theta_d
    Slice,
    /// f over all directions of wo, as a surface
    Lobe,
}

/// What is plotted of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Channels {
    /// Its luminance
    #[default]
    Luminance,
    /// Its red
    Red,
    /// Its green
    Green,
    /// Its blue
    Blue,
    /// Three curves
    Rgb,
}

/// The choices of all views; each view looks at its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// What is plotted of a colour.
    pub channels: Channels,
    /// How many factors of ten are shown, where values are by their logarithm.
    pub decades: Option<f64>,
    /// Whether f is multiplied by the cosine of `wi`.
    pub cosine: bool,
    /// The fixed direction.
    pub wi: Angles,
    /// The azimuth of positive angles of `wo` in theta-v [degrees].
    pub phi_v: f64,
    /// The azimuth of `wo` in albedo [degrees].
    pub albedo_azimuth: f64,
    /// From the normal to the half vector, in theta-d [degrees].
    pub theta_h: f64,
    /// From the half vector to `wi`, in theta-h [degrees].
    pub theta_d: f64,
    /// Azimuth of `wi` about the half vector, in theta-h, theta-d and slice [degrees].
    pub phi_d: f64,
    /// Whether columns of a slice are even in the square root of theta_h.
    pub square: bool,
    /// Whether a slice shows colours without their brightness.
    pub chroma: bool,
    /// Exposure of a slice [stops].
    pub exposure: f64,
    /// Pixels of a slice along each angle.
    pub size: usize,
    /// Azimuth and height that a lobe is seen from [degrees].
    pub eye: [f64; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            channels: Channels::default(),
            decades: None,
            cosine: false,
            wi: Angles { theta: 45.0, phi: 0.0 },
            phi_v: 180.0,
            albedo_azimuth: 0.0,
            theta_h: 0.0,
            theta_d: 0.0,
            phi_d: 90.0,
            square: true,
            chroma: false,
            exposure: 0.0,
            size: 256,
            eye: [60.0, 20.0],
        }
    }
}

impl Settings {
    /// The numbers of a colour that are plotted.
    pub fn quantities(&self) -> Vec<Quantity> {
        let channels: &[Channel] = match self.channels {
            Channels::Luminance => &[Channel::Luminance],
            Channels::Red => &[Channel::Red],
            Channels::Green => &[Channel::Green],
            Channels::Blue => &[Channel::Blue],
            Channels::Rgb => &[Channel::Red, Channel::Green, Channel::Blue],
        };
        let quantity = |channel: &Channel| Quantity { channel: *channel, cosine: self.cosine };
        channels.iter().map(quantity).collect()
    }

    /// Whether a BRDF has three curves.
    pub fn rgb(&self) -> bool {
        self.channels == Channels::Rgb
    }

    /// What the values are of.
    pub fn channel_words(&self) -> &'static str {
        match self.channels {
            Channels::Luminance => "luminance of ",
            Channels::Red => "red of ",
            Channels::Green => "green of ",
            Channels::Blue => "blue of ",
            Channels::Rgb => "",
        }
    }

    /// What is plotted, with its unit.
    pub fn words(&self) -> String {
        let factor = if self.cosine { "f cos theta_i" } else { "f" };
        format!("{}{factor} [1/sr]", self.channel_words())
    }
}
