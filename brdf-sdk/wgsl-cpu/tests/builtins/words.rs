//! Integers, booleans, conversions and packing, against Rust's own integers.

use super::{Case, LANES, exact, f, word};

fn bytes(word: u32) -> [u32; 4] {
    word.to_le_bytes().map(u32::from)
}

fn signed_bytes(word: u32) -> [u32; 4] {
    word.to_le_bytes().map(|byte| byte as i8 as u32)
}

fn packed(x: &[u32], bits: u32, by: impl Fn(u32) -> u32) -> Vec<u32> {
    let mask = u32::MAX >> (32 - bits);
    vec![(0..).zip(x).map(|(i, x)| (by(*x) & mask) << (i * bits)).sum()]
}

fn normalised(x: u32, least: f64, top: f64) -> u32 {
    (0.5 + top * f64::from(f(x)).clamp(least, 1.0)).floor() as i32 as u32
}

fn bits(x: u32, offset: u32, count: u32) -> (u32, u32, u32) {
    let offset = offset.min(32);
    let count = count.min(32 - offset);
    let mask = ((1u64 << count) - 1) as u32;
    ((u64::from(x) >> offset) as u32 & mask, (u64::from(mask) << offset) as u32, count)
}

fn half(word: u32) -> f64 {
    half::f16::from_bits(word as u16).to_f64()
}

fn flag(x: bool) -> Vec<u32> {
    vec![u32::from(x)]
}

const COMPARISONS: &str =
    "u32(a < b); u32(a <= b); u32(a > b); u32(a >= b); u32(a == b); u32(a != b)";

fn compared<T: PartialOrd + Copy>(a: T, b: T) -> Vec<u32> {
    [a < b, a <= b, a > b, a >= b, a == b, a != b].map(u32::from).to_vec()
}

const OF_BITS: &str = "countTrailingZeros(a); countLeadingZeros(a); countOneBits(a); reverseBits(a); firstTrailingBit(a); firstLeadingBit(a)";

/// The leading bit is that of `led`.
fn of_bits(a: u32, led: u32) -> Vec<u32> {
    let first = if a == 0 { !0 } else { a.trailing_zeros() };
    let last = if led == 0 { !0 } else { 31 - led.leading_zeros() };
    vec![a.trailing_zeros(), a.leading_zeros(), a.count_ones(), a.reverse_bits(), first, last]
}

pub fn words() -> Vec<Case> {
    vec![
        word("ee", COMPARISONS, |x| compared(f(x[0]), f(x[1]))),
        word("ii", COMPARISONS, |x| compared(x[0] as i32, x[1] as i32)),
        word("uu", COMPARISONS, |x| compared(x[0], x[1])),
        word(
            "uu",
            "a + b; a - b; a * b; a & b; a | b; a ^ b; ~a; a << b; a >> b; a / b; a % b; min(a, b); max(a, b)",
            |x| {
                let (a, b) = (x[0], x[1]);
                let (sum, rest, product) =
                    (a.wrapping_add(b), a.wrapping_sub(b), a.wrapping_mul(b));
                let (left, right) = (a << (b % 32), a >> (b % 32));
                let (quotient, remainder) =
                    (a.checked_div(b).unwrap_or(a), a.checked_rem(b).unwrap_or(0));
                vec![
                    sum,
                    rest,
                    product,
                    a & b,
                    a | b,
                    a ^ b,
                    !a,
                    left,
                    right,
                    quotient,
                    remainder,
                    a.min(b),
                    a.max(b),
                ]
            },
        ),
        word(
            "iiu",
            "a + b; a - b; a * b; -a; abs(a); sign(a); a << c; a >> c; a / b; a % b; min(a, b); max(a, b)",
            |x| {
                let (a, b, c) = (x[0] as i32, x[1] as i32, x[2] % 32);
                let (sum, rest, product) =
                    (a.wrapping_add(b), a.wrapping_sub(b), a.wrapping_mul(b));
                let quotient = if b == 0 { a } else { a.wrapping_div(b) };
                let remainder = if b == 0 { 0 } else { a.wrapping_rem(b) };
                [
                    sum,
                    rest,
                    product,
                    a.wrapping_neg(),
                    a.wrapping_abs(),
                    a.signum(),
                    a << c,
                    a >> c,
                    quotient,
                    remainder,
                    a.min(b),
                    a.max(b),
                ]
                .map(|x| x as u32)
                .to_vec()
            },
        ),
        word("uuu", "abs(a); clamp(a, b, c)", |x| vec![x[0], x[0].max(x[1]).min(x[2])]),
        word(
            "iii",
            "clamp(a, b, c); dot(vec2i(a, b), vec2i(b, c)); dot(vec3u(u32(a)), vec3u(u32(b)))",
            |x| {
                let (a, b, c) = (x[0] as i32, x[1] as i32, x[2] as i32);
                let clamped = a.max(b).min(c);
                let both = a.wrapping_mul(b).wrapping_add(b.wrapping_mul(c));
                vec![clamped as u32, both as u32, a.wrapping_mul(b).wrapping_mul(3) as u32]
            },
        ),
        word(
            "uu",
            "u32(a > 5u && b > 5u); u32(a > 5u || b > 5u); u32(!(a > 5u)); u32((a > 5u) == (b > 5u)); u32((a > 5u) != (b > 5u)); u32((a > 5u) & (b > 5u)); u32((a > 5u) | (b > 5u))",
            |x| {
                let (a, b) = (x[0] > 5, x[1] > 5);
                [a && b, a || b, !a, a == b, a != b, a & b, a | b].map(u32::from).to_vec()
            },
        ),
        word(
            "uuu",
            "u32(all(vec3u(a, b, c) > vec3u(7u))); u32(any(vec3u(a, b, c) > vec3u(7u))); u32(all(a > 7u)); u32(any(a > 7u))",
            |x| {
                let big = |x: &u32| *x > 7;
                [x.iter().all(big), x.iter().any(big), big(&x[0]), big(&x[0])]
                    .map(u32::from)
                    .to_vec()
            },
        ),
        word("e", "u32(a); i32(a); u32(bool(a)); bitcast<i32>(a)", |x| {
            let a = f(x[0]);
            vec![a as u32, a as i32 as u32, u32::from(a != 0.0), x[0]]
        }),
        word(
            "iu",
            "u32(a); i32(b); u32(bool(a)); u32(bool(b)); i32(a > 3); bitcast<u32>(a); bitcast<i32>(b)",
            |x| {
                let (a, b) = (x[0], x[1]);
                vec![a, b, u32::from(a != 0), u32::from(b != 0), u32::from(a as i32 > 3), a, b]
            },
        ),
        word("u", OF_BITS, |x| of_bits(x[0], x[0])),
        // The first bit that is no copy of the sign.
        word("i", OF_BITS, |x| of_bits(x[0], if (x[0] as i32) < 0 { !x[0] } else { x[0] })),
        word("uuu", "extractBits(a, b, c)", |x| vec![bits(x[0], x[1], x[2]).0]),
        word("iuu", "extractBits(a, b, c)", |x| {
            let (field, _, count) = bits(x[0], x[1], x[2]);
            let up = 32 - count;
            vec![if count == 0 { 0 } else { ((field << up) as i32 >> up) as u32 }]
        }),
        word("uuuu", "insertBits(a, b, c, d)", |x| {
            let (_, mask, _) = bits(x[0], x[2], x[3]);
            vec![x[0] & !mask | (u64::from(x[1]) << x[2].min(32)) as u32 & mask]
        }),
        word("kkkk", "pack4x8snorm(vec4f(a, b, c, d))", |x| {
            packed(x, 8, |x| normalised(x, -1.0, 127.0))
        }),
        word("kkkk", "pack4x8unorm(vec4f(a, b, c, d))", |x| {
            packed(x, 8, |x| normalised(x, 0.0, 255.0))
        }),
        word("kk", "pack2x16snorm(vec2f(a, b))", |x| {
            packed(x, 16, |x| normalised(x, -1.0, 32767.0))
        }),
        word("kk", "pack2x16unorm(vec2f(a, b))", |x| {
            packed(x, 16, |x| normalised(x, 0.0, 65535.0))
        }),
        word("mm", "pack2x16float(vec2f(a, b))", |x| {
            packed(x, 16, |x| u32::from(half::f16::from_f32(f(x)).to_bits()))
        }),
        word("iiii", "pack4xI8(vec4i(a, b, c, d))", |x| packed(x, 8, |x| x)),
        word("uuuu", "pack4xU8(vec4u(a, b, c, d))", |x| packed(x, 8, |x| x)),
        word("iiii", "pack4xI8Clamp(vec4i(a, b, c, d))", |x| {
            packed(x, 8, |x| (x as i32).clamp(-128, 127) as u32)
        }),
        word("uuuu", "pack4xU8Clamp(vec4u(a, b, c, d))", |x| packed(x, 8, |x| x.min(255))),
        word("u", "let v = unpack4xI8(a) => v.x; v.y; v.z; v.w", |x| signed_bytes(x[0]).to_vec()),
        word("u", "let v = unpack4xU8(a) => v.x; v.y; v.z; v.w", |x| bytes(x[0]).to_vec()),
        word("uu", "dot4U8Packed(a, b)", |x| {
            vec![bytes(x[0]).iter().zip(bytes(x[1])).map(|(a, b)| a * b).sum()]
        }),
        word("uu", "dot4I8Packed(a, b)", |x| {
            let products = signed_bytes(x[0]).into_iter().zip(signed_bytes(x[1]));
            vec![products.fold(0, |sum, (a, b)| sum.wrapping_add(a.wrapping_mul(b)))]
        }),
        exact("u", "let v = unpack4x8snorm(a) => v.x; v.y; v.z; v.w", |x| {
            signed_bytes(x[0] as u32).map(|b| (f64::from(b as i32) / 127.0).max(-1.0)).to_vec()
        }),
        exact("u", "let v = unpack4x8unorm(a) => v.x; v.y; v.z; v.w", |x| {
            bytes(x[0] as u32).map(|b| f64::from(b) / 255.0).to_vec()
        }),
        exact("u", "let v = unpack2x16snorm(a) => v.x; v.y", |x| {
            let word = x[0] as u32;
            [word, word >> 16].map(|h| (f64::from(h as i16) / 32767.0).max(-1.0)).to_vec()
        }),
        exact("u", "let v = unpack2x16unorm(a) => v.x; v.y", |x| {
            let word = x[0] as u32;
            [word, word >> 16].map(|h| f64::from(h as u16) / 65535.0).to_vec()
        }),
        exact("u", "let v = unpack2x16float(a) => v.x; v.y", |x| {
            let word = x[0] as u32;
            vec![half(word), half(word >> 16)]
        }),
        word("uu", "arrayLength(&input); select(a, b, a > b)", |x| {
            vec![(LANES * 2) as u32, x[usize::from(x[0] > x[1])]]
        }),
        word(
            "uuu",
            "let v = vec3u(a, b, c) => v[a]; v.zyx.x; select(v, v.yyy, v > v.yxx).z",
            |x| {
                let last = if x[2] > x[0] { x[1] } else { x[2] };
                vec![x[(x[0] as usize).min(2)], x[2], last]
            },
        ),
        word("eu", "u32(a < 1.0 && b < 9u)", |x| flag(f(x[0]) < 1.0 && x[1] < 9)),
    ]
}
