fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let h = wo + wi;
    return p.color * h.colour;
}
