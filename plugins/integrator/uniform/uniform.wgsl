// Uniform sampling of the hemisphere, or of the whole sphere.

fn estimate(q: Settings, hit: Hit, s: ptr<function, Sampler>) -> vec3f {
    let u = next_2d(s);
    var one_minus_z = u.x;
    var inverse_pdf = TWO_PI;
    if DOMAIN == DOMAIN_SPHERE {
        one_minus_z = 2.0 * u.x;
        inverse_pdf = 2.0 * TWO_PI;
    }
    let wi = direction_below_pole(one_minus_z, TWO_PI * u.y);
    return brdf_cos(hit.wo, wi) * env_radiance(to_world(hit, wi)) * inverse_pdf;
}
