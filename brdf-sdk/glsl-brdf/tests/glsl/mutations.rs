//! Damaged files: each is translated or refused, and nothing panics or runs for ever.

use crate::common::{file, translated};

const CODE: &str = "#define SQR(x) ((x) * (x))\n#if defined(SQR) && 1 < 2\nconst float K[2] = float[2](1., 2.);\n#endif\nstruct S { vec3 a; float b[2]; };\n\
float f(inout float x, S s) { x += s.b[1]; for (int i = 0; i < 3; i++) { if (i == 1) continue; x *= SQR(2.0 + float(i)); } return x > .5 ? x : -x; }\n\
vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)\n{\n    /* of the half vector */ vec3 H = normalize(L + V);\n    S s; s.a = H; s.b[0] = pow(H.z, 5); mat3 m = mat3(L, V, N);\n\
    float y = L.z; // the light\n    do { y -= .1; } while (y > .5 && m[0][1] < 2.0);\n    switch (int(y)) { case 0: y = f(y, s); break; default: return H.zyx; }\n    m[1].xy = vec2(y, rough); return m * (H * tint) / (1e-3 + K[1]);\n}";

#[test]
fn damaged_files_are_translated_or_refused() {
    let whole = file("float rough 0 1 .5\ncolor tint 1 1 1\nbool on 0", CODE);
    assert!(translated(&whole).is_ok(), "{:?}", translated(&whole));
    let characters: Vec<char> = whole.chars().collect();
    let pieces = [
        "(",
        ")",
        "{",
        "}",
        ";",
        "?",
        ":",
        "[",
        "]",
        "#if 1\n",
        "*/",
        "/*",
        "++",
        "=",
        ".",
        "1e",
        "vec3",
        "::end shader\n",
        "ä",
        "\u{1}",
        "out ",
    ];
    let mut state = 1u32;
    let mut next = |below: usize| {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as usize % below
    };
    let mut told = 0;
    for _ in 0..4000 {
        let mut text = characters.clone();
        for _ in 0..=next(3) {
            let at = next(text.len());
            match next(4) {
                0 => {
                    text.remove(at);
                }
                1 => {
                    let piece: Vec<char> = pieces[next(pieces.len())].chars().collect();
                    text.splice(at..at, piece);
                }
                2 => {
                    let (length, to) = (next(40), next(text.len()));
                    let part: Vec<char> = text.iter().copied().skip(at).take(length).collect();
                    text.splice(to..to, part);
                }
                _ => text.truncate(at.max(20)),
            }
        }
        let text: String = text.into_iter().collect();
        told += usize::from(translated(&text).is_err());
    }
    assert!(told > 2000, "{told}");
}
