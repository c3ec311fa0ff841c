// @TITLE@.
//
// eval returns f_r [1/sr] without the cosine, in linear Rec. 709. Directions are unit vectors in the
// local frame (x tangent, y bitangent, z normal) that point away from the surface: wo to the viewer,
// wi to the light; both lie above the horizon. p holds the parameters of plugin.toml, inside their
// ranges. From the host come PI, TWO_PI, INV_PI, INV_TWO_PI, INV_FOUR_PI, pow5(x), log1p(x), expm1(x),
// precise_atan2(y, x), angle_of_half(s), direction_below_pole(one_minus_z, phi), cosine_sample(u) and
// cosine_pdf(wi); docs/conventions.md says what they mean.
//
// To sample the BRDF well, add both of these; until then the host draws from the cosine:
//   fn sample(p: Params, wo: vec3f, u: vec3f) -> vec3f    a direction wi; u in [0, 1)^3
//   fn pdf(p: Params, wo: vec3f, wi: vec3f) -> f32        its density per solid angle [1/sr]
// `brdf conform` on this folder says whether pdf is the density of sample, whether light is gained, whether
// f32 is enough, and more; after each change it is worth a look.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let h = normalize(wo + wi);
    let lobe = (p.n + 2.0) / (8.0 * PI) * pow(h.z, p.n);
    return (1.0 - p.gloss) * p.color * INV_PI + vec3f(p.gloss * lobe);
}
