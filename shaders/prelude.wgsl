// Constants and helpers that every plugin may use; all that is in a BRDF's scope beside its parameters.

const PI: f32 = 3.14159265358979;
const TWO_PI: f32 = 6.28318530717959;
const INV_PI: f32 = 0.318309886183791;
const INV_TWO_PI: f32 = 0.159154943091895;
const INV_FOUR_PI: f32 = 0.0795774715459477;

/// x^5, as in Schlick's Fresnel approximation; `pow` is inexact and undefined for x < 0.
fn pow5(x: f32) -> f32 {
    let x2 = x * x;
    return x2 * x2 * x;
}

/// A unit vector from its height `z` and the azimuth `phi` in radians; 1 - z is given, and exact near the pole.
fn direction_below_pole(one_minus_z: f32, phi: f32) -> vec3f {
    let r = sqrt(max(one_minus_z * (2.0 - one_minus_z), 0.0));
    return vec3f(r * cos(phi), r * sin(phi), 1.0 - one_minus_z);
}
