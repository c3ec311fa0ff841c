// Image slice: theta_h and theta_d, bilinear between the middles of pixels.

fn pixel(row: u32, column: u32) -> vec3f {
    let first = 3u * (column + slice_size(1u) * row);
    return vec3f(slice_at(first), slice_at(first + 1u), slice_at(first + 2u));
}

fn eval(p: Params, wo: vec3f, wi: vec3f) -> vec3f {
    let m = wo + wi;
    let d = wi - wo;
    let length_of_m = length(m);
    let theta_h = angle_of_half(0.5 * dot(m.xy, m.xy) / (length_of_m * (length_of_m + m.z))) * (2.0 * INV_PI);
    let theta_d = angle_of_half(0.25 * dot(d, d) / (2.0 + length_of_m)) * (2.0 * INV_PI);
    let rows = slice_size(0u);
    let columns = slice_size(1u);
    let along = select(theta_h, sqrt(theta_h), SQUARE);
    let x = clamp(along * f32(columns) - 0.5, 0.0, f32(columns) - 1.0);
    let y = clamp(theta_d * f32(rows) - 0.5, 0.0, f32(rows) - 1.0);
    let column = u32(x);
    let row = u32(y);
    let right = min(column + 1u, columns - 1u);
    let above = min(row + 1u, rows - 1u);
    let low = mix(pixel(row, column), pixel(row, right), x - f32(column));
    let high = mix(pixel(above, column), pixel(above, right), x - f32(column));
    return p.scale * mix(low, high, y - f32(row));
}
