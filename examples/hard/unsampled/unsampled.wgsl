// A Blinn-Phong lobe with no sampling of its own: integrators that draw from the BRDF draw from the cosine.

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let sine2 = dot(m.xy, m.xy) / dot(m, m);
    return vec3f(0.8 * (p.n + 8.0) * 0.125 * INV_PI * exp(0.5 * p.n * log1p(-min(sine2, 0.9999))));
}
