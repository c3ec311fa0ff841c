//! OpenEXR: linear f32 RGBA, the standard error as a layer, and all that made the picture as attributes.

use std::path::Path;

use brdf_sdk::{Problem, Result};
use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, Text,
    WritableImage,
};

use super::{Picture, STD_ERROR, Staged, stage};

/// The attribute that holds the scene as TOML.
const SCENE: &str = "brdf.scene";

/// Stages the picture with `scene` (the scene as TOML) and further named facts in its header.
pub fn stage_exr(
    path: &Path,
    picture: &Picture,
    scene: &str,
    facts: &[(String, String)],
) -> Result<Staged> {
    let [width, height] = picture.resolution.map(|side| side as usize);
    let [red, green, blue] = planes(&picture.rgb);
    let mut list: Vec<(&str, Vec<f32>)> =
        vec![("R", red), ("G", green), ("B", blue), ("A", picture.coverage.clone())];
    if let Some(errors) = &picture.std_error {
        let [red, green, blue] = planes(errors);
        list.extend(STD_ERROR.into_iter().zip([red, green, blue]));
    }
    let channels = list.into_iter().map(|(name, samples)| {
        let name = Text::from_slice_unchecked(name.as_bytes());
        AnyChannel::new(name, FlatSamples::F32(samples))
    });
    let channels = AnyChannels::sort(channels.collect());
    let mut attributes = LayerAttributes::default();
    let texts = facts.iter().map(|(key, value)| (key.as_str(), value.as_str()));
    for (key, value) in texts.chain([(SCENE, scene)]) {
        let text = AttributeValue::Text(Text::from_slice_unchecked(value.as_bytes()));
        attributes.other.insert(Text::from_slice_unchecked(key.as_bytes()), text);
    }
    let layer = Layer::new((width, height), attributes, Encoding::SMALL_LOSSLESS, channels);
    let image = Image::from_layer(layer);
    stage(path, |file| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).map_err(|error| error.to_string())?;
        std::io::Write::write_all(file, bytes.get_ref()).map_err(|error| error.to_string())
    })
}

/// The three channels of a picture apart.
fn planes(pixels: &[[f32; 3]]) -> [Vec<f32>; 3] {
    std::array::from_fn(|channel| pixels.iter().map(|pixel| pixel[channel]).collect())
}

/// The scene in the header of a picture that this program wrote.
pub fn read_scene(path: &Path) -> Result<String> {
    read_fact(path, SCENE)?.ok_or_else(|| {
        Problem::new(
            path.display().to_string(),
            "its header holds no scene",
            "name a picture that `brdf render` wrote, or a scene.toml",
        )
    })
}

/// A text in the header of a picture that this program wrote.
pub fn read_fact(path: &Path, key: &str) -> Result<Option<String>> {
    let problem =
        |reason: String, cure: &str| Problem::new(path.display().to_string(), reason, cure);
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(|error| {
        problem(format!("its header cannot be read ({error})"), "name a whole OpenEXR file")
    })?;
    Ok(meta.headers.iter().find_map(|header| {
        let found = header.own_attributes.other.iter().find(|(name, _)| *name == key)?;
        match found.1 {
            // UTF-8, as it was written: the crate itself would take each byte for a character.
            AttributeValue::Text(text) => {
                Some(String::from_utf8_lossy(text.as_slice()).into_owned())
            }
            _ => None,
        }
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::registry::Registry;

    #[test]
    fn a_picture_is_known_by_its_scene_and_taken_for_no_material() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let (rgb, coverage) = (vec![[1.0; 3]], vec![1.0]);
        let picture = Picture { resolution: [1, 1], rgb, coverage, std_error: None };
        stage_exr(&path, &picture, "format = 1\n", &[]).unwrap().keep().unwrap();
        assert_eq!(read_scene(&path).unwrap(), "format = 1\n");
        let told = Registry::new(&[]).opener(&path).unwrap_err();
        assert!(told.reason.contains("a picture with its scene"), "{told}");
    }
}
