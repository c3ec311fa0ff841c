//! A file as an environment map: loaded as it is, with its bad texels replaced, in the other layout, with its tables.

use brdf_host::environment::{
    Environment, Form, Layout, Options, Purpose, importance, load, scale,
};

/// Texels beyond which a map is only loaded.
const SMALL: usize = 1 << 12;

/// Loads the bytes as a file of that ending, and holds what comes of it to what an [`Environment`] promises.
///
/// # Panics
/// A promise is broken.
pub fn check(extension: &str, bytes: &[u8]) {
    let path = crate::file(extension, bytes);
    let map = match load(&path, &Options::default()) {
        Ok(map) => map,
        Err(problem) => {
            crate::refused(&problem);
            match load(&path, &Options { replace_bad: true, ..Options::default() }) {
                Ok(map) => map,
                Err(problem) => return crate::refused(&problem),
            }
        }
    };
    held(&map);
    if map.texels.len() > SMALL {
        return;
    }
    let facts = map.facts();
    assert!(facts.min <= facts.max && facts.mean.is_finite(), "{facts:?}");
    assert!(scale(&map).is_normal(), "a scale of {}", scale(&map));
    let tables = importance(&map, Purpose::default());
    assert!(tables.densities.iter().all(|density| density.is_finite() && *density >= 0.0));
    let (layout, face, width) = match map.layout {
        Layout::LatLong => (Layout::Cube, Some(3), None),
        Layout::Cube => (Layout::LatLong, None, Some(6)),
    };
    let form = Form { layout: Some(layout), face, width };
    held(&map.in_form(form).unwrap_or_else(|problem| panic!("{problem}")));
}

/// Texels for all of its size, and every one of them radiance.
///
/// # Panics
/// They are not.
pub fn held(map: &Environment) {
    let Environment { width, height, texels, .. } = map;
    assert_eq!(texels.len() as u64, u64::from(*width) * u64::from(*height));
    let fine = |value: &f32| value.is_finite() && *value >= 0.0;
    let bad = texels.iter().find(|texel| !texel[..3].iter().all(fine));
    assert!(bad.is_none(), "{bad:?} is no radiance");
}
