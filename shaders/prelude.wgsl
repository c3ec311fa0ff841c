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

/// log(1 + x) for x > -1, without the digits that 1 + x loses. Near 0 by 2 artanh(z) = log((1 + z) / (1 - z)) with
/// z = x / (2 + x), whose series needs no 1 + x; the first term left out is below 2e-8 of the result.
fn log1p(x: f32) -> f32 {
    if x < -0.5 || x > 1.0 {
        return log(1.0 + x);
    }
    let z = x / (2.0 + x);
    let q = z * z;
    let tail = 1.0 / 7.0 + q * (1.0 / 9.0 + q * (1.0 / 11.0 + q / 13.0));
    return 2.0 * z * (1.0 + q * (1.0 / 3.0 + q * (0.2 + q * tail)));
}

/// exp(x) - 1, without the digits that the difference loses; near 0 by the series x + x^2/2 + x^3/6 + ..., nested.
fn expm1(x: f32) -> f32 {
    if abs(x) > 0.5 {
        return exp(x) - 1.0;
    }
    let tail = 1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0 * (1.0 + x / 8.0)));
    return x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * tail)));
}
