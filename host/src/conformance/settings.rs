//! The parameters and views that a BRDF is tried at.

use brdf_sdk::{Param, ParamType, ParamValue};

use crate::numerics::{exact_sin_cos, mixed};
use crate::plugin::Configured;

/// A BRDF at some values of its parameters, and what is looked at there.
#[derive(Debug, Clone)]
pub struct Setting {
    /// The BRDF.
    pub brdf: Configured,
    /// What the values are: `defaults` or `the values given`, `preset gold`, `masking=separable`, `all at their least`.
    pub name: String,
    /// Angles of `wo` from the normal and from the tangent [degrees].
    pub views: Vec<[f64; 2]>,
}

/// Angles from the normal at which sampling is looked at [degrees].
const ANGLES: [f64; 6] = [0.0, 30.0, 60.0, 80.0, 89.0, 89.9];
/// Fewer of them, for switches; presets have one of all angles each.
const TWO_ANGLES: [f64; 2] = [30.0, 80.0];
/// Azimuths of `wo` [degrees]: along the axes and between them.
const AZIMUTHS: [f64; 4] = [0.0, 37.0, 90.0, 217.0];
/// Corners of the parameters' ranges beside the two where all are at one end.
const CORNERS: usize = 2;
const CORNERS_DEEP: usize = 24;

/// How far numbers go in the corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reach {
    /// To the ends of their hard ranges.
    Range,
    /// To the ends of what their sliders offer: lobes that draws in f32 can resolve.
    Slider,
}

/// The settings of a BRDF: its values as they are, its presets, each of its switches, the corners of its
/// parameters' ranges; more of them and more views where it shall go `deep`.
pub fn settings(brdf: &Configured, reach: Reach, deep: bool) -> Vec<Setting> {
    let mut found: Vec<Setting> = Vec::new();
    let mut add = |brdf: Configured, name: String, views: Vec<[f64; 2]>| {
        if found.iter().all(|known| known.brdf.values != brdf.values) {
            found.push(Setting { brdf, name, views });
        }
    };
    let crossed = |angles: &[f64], azimuths: &[f64]| -> Vec<[f64; 2]> {
        let of = |angle: &f64| azimuths.iter().map(|a| [*angle, *a]).collect::<Vec<_>>();
        angles.iter().flat_map(of).collect()
    };
    // One azimuth for each angle, another one at the next.
    let cycled = |angles: &[f64], first: usize| -> Vec<[f64; 2]> {
        if deep {
            return crossed(&ANGLES, &AZIMUTHS);
        }
        let azimuths = (first..).map(|i| AZIMUTHS[i % AZIMUTHS.len()]);
        angles.iter().copied().zip(azimuths).map(|(angle, azimuth)| [angle, azimuth]).collect()
    };
    let azimuths = if deep { &AZIMUTHS[..] } else { &AZIMUTHS[..3] };
    let name = if brdf.changed().next().is_none() { "defaults" } else { "the values given" };
    add(brdf.clone(), name.to_owned(), crossed(&ANGLES, azimuths));
    for (end, name) in [(0, "all at their least"), (1, "all at their greatest")] {
        add(at_corner(brdf, reach, |_| end), name.to_owned(), cycled(&ANGLES, end));
    }
    for (index, (variant, name)) in switched(brdf).into_iter().enumerate() {
        add(variant, name, cycled(&TWO_ANGLES, index));
    }
    for corner in 0..if deep { CORNERS_DEEP } else { CORNERS } {
        let end = |position: usize| (mixed((corner << 8 | position) as u64) % 3) as usize;
        add(at_corner(brdf, reach, end), format!("corner {}", corner + 1), cycled(&ANGLES, corner));
    }
    for (index, preset) in brdf.plugin.manifest.presets.iter().enumerate() {
        let mut chosen = brdf.clone();
        chosen.set_preset(preset);
        add(
            chosen,
            format!("preset {}", preset.name),
            cycled(&[ANGLES[index % ANGLES.len()]], index),
        );
    }
    found
}

/// The BRDF with one of its switches and choices changed at a time.
pub fn switched(brdf: &Configured) -> Vec<(Configured, String)> {
    let named = |(param, other): (&Param, Configured)| {
        let option = other.values.get(&param.key).map(ToString::to_string);
        let name = format!("{}={}", param.key, option.unwrap_or_default());
        (other, name)
    };
    brdf.switched().map(named).collect()
}

/// The BRDF with each number and colour at its least (0), its greatest (1), or as it is (2).
fn at_corner(brdf: &Configured, reach: Reach, end: impl Fn(usize) -> usize) -> Configured {
    let mut corner = brdf.clone();
    for (position, param) in brdf.plugin.manifest.params.iter().enumerate() {
        let end = end(position);
        if end > 1 {
            continue;
        }
        let value = match &param.ty {
            ParamType::Float { range, slider, .. } => {
                ParamValue::Float(if reach == Reach::Range { range[end] } else { slider[end] })
            }
            ParamType::Int { range, slider, .. } => {
                ParamValue::Int(if reach == Reach::Range { range[end] } else { slider[end] })
            }
            ParamType::Color { range, .. } => ParamValue::Color([range[end]; 3]),
            _ => continue,
        };
        corner.values.set(&param.key, value);
    }
    corner
}

/// `--set` options for the values that are not the plugin's defaults. A data file is not among them: whoever judges one
/// names it in the BRDF's place.
pub fn options(brdf: &Configured) -> String {
    let set = brdf.changed().filter(|(_, value)| !matches!(value, ParamValue::File(_)));
    set.map(|(key, value)| format!(" --set {key}={value}")).collect()
}

/// The unit vector at an angle from the normal and one from the tangent [degrees].
pub fn direction([theta, phi]: [f64; 2]) -> [f32; 3] {
    let (sine, cosine) = theta.to_radians().sin_cos();
    let (sine_phi, cosine_phi) = exact_sin_cos(phi);
    [sine * cosine_phi, sine * sine_phi, cosine].map(|c| c as f32)
}
