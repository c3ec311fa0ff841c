// a line that ends in a carriage returnvar<private> seen: f32;

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    return vec3f(INV_PI);
}
