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

/// log(1 - x) for x in [0, 1). Below one half by 2 artanh(s) = log((1 + s) / (1 - s)) with s = x / (2 - x),
/// whose series needs no 1 - x; the first term left out is below 2e-8 of the result.
fn log_one_minus(x: f32) -> f32 {
    if x > 0.5 {
        return log(1.0 - x);
    }
    let s = x / (2.0 - x);
    let q = s * s;
    let tail = 1.0 / 7.0 + q * (1.0 / 9.0 + q * (1.0 / 11.0 + q / 13.0));
    return -2.0 * s * (1.0 + q * (1.0 / 3.0 + q * (0.2 + q * tail)));
}

/// 1 - exp(-y) for y >= 0; below one half by the series y - y^2/2 + y^3/6 - ..., nested.
fn one_minus_exp(y: f32) -> f32 {
    if y > 0.5 {
        return 1.0 - exp(-y);
    }
    let tail = 1.0 - y / 5.0 * (1.0 - y / 6.0 * (1.0 - y / 7.0 * (1.0 - y / 8.0)));
    return y * (1.0 - y / 2.0 * (1.0 - y / 3.0 * (1.0 - y / 4.0 * tail)));
}
