fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let x = lobe(wo); return vec3f(x * gloss);
}

fn lobe(w: vec3f) -> f32 {
    return w.z;
}
