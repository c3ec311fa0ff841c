// @TITLE@.
//
// estimate returns one unbiased estimate of the outgoing radiance; the host averages. It may call
//   brdf_cos(wo, wi), brdf_pdf(wo, wi), brdf_sample(wo, u)      local directions
//   env_radiance(dir), env_light(dir), env_sample(u)            world directions; .radiance and .pdf
//   to_world(hit, local), to_local(hit, world)
//   next_1d(s), next_2d(s), next_3d(s), next_2d_bits(s)         numbers in [0, 1), or the u of env_sample
// brdf_sample returns .wi, .weight = f cos / pdf and .pdf; hit has .pixel, .wo and .world_from_local,
// whose columns are tangent, bitangent and normal. The prelude of BRDFs is in scope too.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let pick = next_1d(s);
    let u = next_3d(s);
    var wi = direction_below_pole(u.x, TWO_PI * u.y);
    if pick < q.share {
        wi = brdf_sample(hit.wo, u).wi;
    }
    let value = brdf_cos(hit.wo, wi);
    if all(value == vec3f(0.0)) {
        return vec3f(0.0);
    }
    let density = q.share * brdf_pdf(hit.wo, wi) + (1.0 - q.share) * INV_TWO_PI;
    return value * env_radiance(to_world(hit, wi)) / density;
}
