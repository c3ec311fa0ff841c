//! Control flow: lanes that part and meet again, against the same program in Rust.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test expects by unwrapping")]

mod common;

use common::{How, lower, run_with, ways, words};
use wgsl_cpu::Precision;

const LANES: u32 = 1000;

/// Runs `text` over [`LANES`] invocations in every way, and compares with `expected` of each index.
fn check(text: &str, expected: impl Fn(u32) -> u32) {
    let program = lower(text).unwrap();
    let input: Vec<u32> = (0..LANES).collect();
    for how in ways(Precision::F32).into_iter().chain(ways(Precision::F64)) {
        let output = run_with(&program, &input, LANES as usize, LANES.div_ceil(64), how).unwrap();
        for (index, word) in words(&output).into_iter().enumerate() {
            assert_eq!(word, expected(index as u32), "invocation {index}, {how:?}");
        }
    }
}

/// A kernel around `fn f(x: u32) -> u32`.
fn kernel(functions: &str) -> String {
    format!(
        "@group(0) @binding(0) var<storage, read> input: array<u32>;
         @group(0) @binding(1) var<storage, read_write> output: array<u32>;
         {functions}
         @compute @workgroup_size(64)
         fn main(@builtin(global_invocation_id) id: vec3u) {{
             if id.x >= arrayLength(&output) {{ return; }}
             output[id.x] = f(input[id.x]);
         }}"
    )
}

#[test]
fn early_returns_and_nested_branches() {
    let text = kernel(
        "fn g(x: u32, p: ptr<function, u32>) -> u32 {
             if x % 3u == 0u {
                 if x % 2u == 0u { *p += 1u; return 7u; }
                 *p += 10u;
             } else if x % 5u == 1u {
                 return x + *p;
             }
             *p += 100u;
             if x > 500u { return *p * 2u; }
             return *p;
         }
         fn f(x: u32) -> u32 {
             var n = x;
             let a = g(x, &n);
             let b = g(a, &n);
             return a * 31u + b * 7u + n;
         }",
    );
    fn g(x: u32, p: &mut u32) -> u32 {
        if x.is_multiple_of(3) {
            if x.is_multiple_of(2) {
                *p += 1;
                return 7;
            }
            *p += 10;
        } else if x % 5 == 1 {
            return x.wrapping_add(*p);
        }
        *p += 100;
        if x > 500 {
            return p.wrapping_mul(2);
        }
        *p
    }
    check(&text, |x| {
        let mut n = x;
        let a = g(x, &mut n);
        let b = g(a, &mut n);
        a.wrapping_mul(31).wrapping_add(b.wrapping_mul(7)).wrapping_add(n)
    });
}

#[test]
fn loops_left_and_continued_by_different_lanes() {
    let text = kernel(
        "struct Both { a: u32, v: vec2u }
         fn find(s: ptr<function, Both>, n: ptr<function, u32>, limit: u32, budget: ptr<function, u32>) -> u32 {
             for (var i = 0u; i < limit; i++) {
                 if *budget == 0u { break; }
                 *budget -= 1u;
                 *n += 1u;
                 if ((*s).a * (i + 3u)) % 7u == 5u { (*s).v.y += i; return i * 10u; }
                 if i % 3u == 1u { continue; }
                 let t = (*s).a;
                 (*s).a = (*s).v.x;
                 (*s).v.x = t + i;
             }
             return 999u;
         }
         fn f(id: u32) -> u32 {
             var s = Both(id, vec2u(id * 3u, 1u));
             var n = 0u;
             var budget = 50u;
             var acc = 0u;
             var fa = 0u;
             var fb = 1u;
             var j = 0u;
             loop {
                 if j > id % 11u { break; }
                 acc += find(&s, &n, (id + j) % 13u, &budget);
                 if acc > 5000u {
                     if n % 2u == 0u { return acc ^ 0xffffu; } else { acc -= 100u; }
                 }
                 while fa < acc {
                     let t = fa + fb;
                     fa = fb;
                     fb = t;
                     if t > 4000u { break; }
                 }
                 j += 1u;
                 if acc > 9000u { break; }
             }
             return acc * 31u + s.a + s.v.x * 7u + s.v.y * 1009u + n * 65537u + fa + budget * 3u;
         }",
    );
    fn find(a: &mut u32, v: &mut [u32; 2], n: &mut u32, limit: u32, budget: &mut u32) -> u32 {
        for i in 0..limit {
            if *budget == 0 {
                break;
            }
            *budget -= 1;
            *n += 1;
            if a.wrapping_mul(i + 3) % 7 == 5 {
                v[1] += i;
                return i * 10;
            }
            if i % 3 == 1 {
                continue;
            }
            let t = *a;
            *a = v[0];
            v[0] = t.wrapping_add(i);
        }
        999
    }
    check(&text, |id| {
        let (mut a, mut v, mut n, mut budget) = (id, [id * 3, 1], 0, 50);
        let (mut acc, mut fa, mut fb, mut j) = (0u32, 0u32, 1u32, 0u32);
        loop {
            if j > id % 11 {
                break;
            }
            acc += find(&mut a, &mut v, &mut n, (id + j) % 13, &mut budget);
            if acc > 5000 {
                if n % 2 == 0 {
                    return acc ^ 0xffff;
                }
                acc -= 100;
            }
            while fa < acc {
                (fa, fb) = (fb, fa + fb);
                if fb > 4000 {
                    break;
                }
            }
            j += 1;
            if acc > 9000 {
                break;
            }
        }
        acc.wrapping_mul(31)
            .wrapping_add(a)
            .wrapping_add(v[0].wrapping_mul(7))
            .wrapping_add(v[1].wrapping_mul(1009))
            .wrapping_add(n.wrapping_mul(65537))
            .wrapping_add(fa)
            .wrapping_add(budget * 3)
    });
}

#[test]
fn switches_inside_loops() {
    let text = kernel(
        "fn f(x: u32) -> u32 {
             var s = x;
             var r = 0u;
             for (var i = 0u; i < 12u; i++) {
                 switch (s + i) % 6u {
                     case 0u: { r += 1u; }
                     case 1u, 2u: {
                         if x % 4u == 0u { break; }
                         r += 10u;
                         if x % 7u == 3u { continue; }
                         r += 100u;
                     }
                     case 3u: { s += 5u; if r > 900u { return r; } }
                     default: { if i == 9u && x % 2u == 0u { r = r * 3u; break; } s = s * 3u + 1u; }
                 }
                 r += i;
             }
             return r * 13u + s;
         }",
    );
    check(&text, |x| {
        let (mut s, mut r) = (x, 0u32);
        for i in 0..12u32 {
            match s.wrapping_add(i) % 6 {
                0 => r += 1,
                1 | 2 => {
                    if x % 4 != 0 {
                        r += 10;
                        if x % 7 == 3 {
                            continue;
                        }
                        r += 100;
                    }
                }
                3 => {
                    s = s.wrapping_add(5);
                    if r > 900 {
                        return r;
                    }
                }
                _ => {
                    if i == 9 && x % 2 == 0 {
                        r = r.wrapping_mul(3);
                    } else {
                        s = s.wrapping_mul(3).wrapping_add(1);
                    }
                }
            }
            r += i;
        }
        r.wrapping_mul(13).wrapping_add(s)
    });
}

/// The mask with which they leave is the inner switch's own register of living lanes.
#[test]
fn all_lanes_of_a_switch_leave_several_frames() {
    let text = kernel(
        "fn f(x: u32) -> u32 {
             var r = 0u;
             for (var i = 0u; i < 3u + x % 2u; i++) {
                 switch i % 2u {
                     case 0u: {
                         switch arrayLength(&input) % 4u {
                             case 0u: { continue; }
                             default: { if x == 2u { break; } }
                         }
                         if x == 3u { break; }
                         r += 10u;
                     }
                     default: { if x == 4u { break; } r += 1u; }
                 }
                 r += 100u;
             }
             switch arrayLength(&input) % 4u {
                 case 0u: { return r; }
                 default: { if x == 2u { break; } }
             }
             return 7u;
         }",
    );
    let rounds = |x: u32| if x == 4 { 100 } else { 101 };
    check(&text, |x| rounds(x) * (1 + x % 2));
}

#[test]
fn arrays_indexed_by_lane_and_uniform_control() {
    let text = kernel(
        "const TABLE = array<u32, 7>(3u, 1u, 4u, 1u, 5u, 9u, 2u);
         struct Item { key: u32, at: vec3f }
         var<private> calls: u32 = 5u;
         fn push(list: ptr<function, array<Item, 6>>, i: u32, key: u32) {
             calls += 1u;
             (*list)[i].key = key;
             (*list)[i].at[key % 3u] = f32(key);
         }
         fn f(x: u32) -> u32 {
             var list: array<Item, 6>;
             var m = mat2x3f(1.0, 2.0, 3.0, 4.0, 5.0, 6.0);
             // Uniform: every lane goes round as often.
             for (var i = 0u; i < 4u; i++) { push(&list, (x + i * 5u) % 9u, TABLE[(x + i) % 7u]); }
             let limit = arrayLength(&input);
             var uniform_sum = 0u;
             for (var i = 0u; i < limit % 7u; i++) {
                 if i == 3u { continue; }
                 if limit == 12345u { return 1u; }
                 uniform_sum += i;
             }
             m[x % 2u][(x / 2u) % 3u] += 10.0;
             var sum = 0u;
             for (var i = 0u; i < 6u; i++) {
                 sum = sum * 7u + list[i].key + u32(list[i].at.x + 2.0 * list[i].at.y + 3.0 * list[i].at.z);
             }
             let v = m * vec2f(1.0, 100.0);
             return sum + calls * 1000u + uniform_sum + u32(v.x + v.y + v.z) + TABLE[(x * 3u) % 11u];
         }",
    );
    let table = [3u32, 1, 4, 1, 5, 9, 2];
    check(&text, |x| {
        let mut keys = [0u32; 6];
        let mut at = [[0f32; 3]; 6];
        for i in 0..4 {
            let slot = (((x + i * 5) % 9) as usize).min(5);
            let key = table[((x + i) % 7) as usize];
            keys[slot] = key;
            at[slot][(key % 3) as usize] = key as f32;
        }
        let mut uniform_sum = 0;
        for i in 0..LANES % 7 {
            if i != 3 {
                uniform_sum += i;
            }
        }
        let mut m = [[1f32, 2.0, 3.0], [4.0, 5.0, 6.0]];
        m[(x % 2) as usize][((x / 2) % 3) as usize] += 10.0;
        let mut sum = 0u32;
        for i in 0..6 {
            let [a, b, c] = at[i];
            sum = sum
                .wrapping_mul(7)
                .wrapping_add(keys[i])
                .wrapping_add((a + 2.0 * b + 3.0 * c) as u32);
        }
        let v: f32 = (0..3).map(|i| m[0][i] + 100.0 * m[1][i]).sum();
        sum.wrapping_add(9 * 1000)
            .wrapping_add(uniform_sum)
            .wrapping_add(v as u32)
            .wrapping_add(table[((x * 3 % 11) as usize).min(6)])
    });
}

#[test]
fn an_endless_loop_uses_up_its_budget() {
    let text = kernel(
        "fn f(x: u32) -> u32 { var n = x; loop { n += 1u; if n == x { break; } } return n; }",
    );
    let program = lower(&text).unwrap();
    let how = How { fuel: 1_000_000, ..How::default() };
    let failure = run_with(&program, &[1, 2, 3], 3, 1, how).unwrap_err();
    let wgsl_cpu::Failure::Stopped(stopped) = failure else { panic!("{failure:?}") };
    let range = stopped.span.to_range().unwrap();
    assert!(text[range].starts_with("loop"), "{stopped:?}");
}

/// What a switch carries is written where its cases end; what was computed before is not shared
/// with what follows.
#[test]
fn the_same_choice_again_behind_a_switch() {
    let text = kernel(
        "fn f(x: u32) -> u32 {
             let s = x % 4u;
             var r = x + 1000u;
             switch s {
                 case 1u: { r = 5u; }
                 case 2u: { if x > 30u { break; } r = 7u; }
                 default: { r = 9u; }
             }
             if s == 1u { r = 5u; }
             return r;
         }",
    );
    check(&text, |x| match x % 4 {
        1 => 5,
        2 if x > 30 => x + 1000,
        2 => 7,
        _ => 9,
    });
}

/// A `let` of the body is read in `continuing`, when its variable has moved on.
#[test]
fn values_of_the_body_live_on_in_continuing() {
    let text = kernel(
        "fn first(n: u32, p: ptr<function, u32>) -> u32 { *p += 1u; return n; }
         fn f(x: u32) -> u32 {
             var n = 0u;
             var acc = 0u;
             loop {
                 let old = n;
                 let got = first(n, &n);
                 if n > 3u + x % 2u { break; }
                 if n == 2u { continue; }
                 continuing { acc = acc * 10u + old + got; }
             }
             var done = false;
             var rounds = 0u;
             loop {
                 rounds += 1u;
                 continuing { let q = done; done = rounds > 3u + x % 3u; break if q; }
             }
             return acc * 100u + rounds;
         }",
    );
    check(&text, |x| {
        let (mut n, mut acc) = (0, 0u32);
        loop {
            let old = n;
            n += 1;
            if n > 3 + x % 2 {
                break;
            }
            acc = acc * 10 + 2 * old;
        }
        acc * 100 + 5 + x % 3
    });
}

/// Where the last lanes have left, a uniform value may be what a skipped part left behind: nothing
/// that depends on it may run.
#[test]
fn continuing_is_passed_over_with_the_last_lane() {
    let text = kernel(
        "fn f(x: u32) -> u32 {
             var j = 0u;
             var acc = 0u;
             loop {
                 if j >= x % 3u { break; }
                 var k: u32;
                 if arrayLength(&input) % 2u == 0u { k = 4u; } else { k = 6u; }
                 let k2 = k * 2u;
                 continuing { j += 1u; for (var i = 4u; i != k2; i += 1u) { acc += i; } }
             }
             return acc;
         }",
    );
    // 4 + 5 + 6 + 7 each time round.
    check(&text, |x| x % 3 * 22);
}
