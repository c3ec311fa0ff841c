//! Random programs against their meaning, one invocation at a time.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test expects by unwrapping")]

mod common;

use common::generate::{Tape, program};
use common::{How, lower, parse, run_with, words};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestCaseError, TestError, TestRng, TestRunner};
use wgsl_cpu::{Program, VectorSet};

/// Several batches, the last one not full.
const LANES: u32 = 300;
const CASES: u32 = 2500;

fn runner() -> TestRunner {
    let config = ProptestConfig {
        cases: CASES,
        failure_persistence: None,
        max_shrink_iters: 4000,
        max_global_rejects: CASES,
        ..ProptestConfig::default()
    };
    let rng = TestRng::deterministic_rng(RngAlgorithm::ChaCha);
    TestRunner::new_with_rng(config, rng)
}

/// Whether naga takes a text at all: it evaluates constants, and some are errors.
fn is_valid(text: &str) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(text).map_err(|e| e.emit_to_string(text))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    validator.validate(&module).map(|_| ()).map_err(|e| e.emit_to_string(text))
}

fn check_program(numbers: &[u16]) -> Result<(), TestCaseError> {
    let source = program(&mut Tape::new(numbers));
    let text = source.text();
    if let Err(reason) = is_valid(&text) {
        return Err(TestCaseError::fail(reason));
    }
    let input: Vec<u32> = (0..LANES).map(|lane| lane * lane % 401).collect();
    let wanted: Option<Vec<u32>> = input.iter().map(|input| source.value(*input)).collect();
    let Some(wanted) = wanted else {
        return Err(TestCaseError::reject("too many steps"));
    };
    let (module, info) = parse(&text);
    for (program, lanes) in
        [(Program::new(&module, &info), 128), (Program::for_errors(&module, &info), 64)]
    {
        let program =
            program.map_err(|refusal| TestCaseError::fail(refusal.to_string() + &text))?;
        let set = Some(VectorSet::best());
        let how = How { set, lanes: Some(lanes), fuel: 1 << 32, ..How::default() };
        let storage = run_with(&program, &input, input.len(), LANES.div_ceil(64), how).unwrap();
        for (index, (got, wanted)) in words(&storage).iter().zip(&wanted).enumerate() {
            prop_assert_eq!(got, wanted, "invocation {} of\n{}", index, text);
        }
    }
    Ok(())
}

fn hold<S: Strategy>(strategy: &S, test: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    match runner().run(strategy, test) {
        Ok(()) => {}
        Err(TestError::Fail(reason, _)) => panic!("{reason}"),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn programs_mean_what_they_say_one_invocation_at_a_time() {
    hold(&vec(any::<u16>(), 30..700), |numbers| check_program(&numbers));
}

/// The scalar kinds, by their names in WGSL.
const KINDS: [&str; 4] = ["u32", "i32", "f32", "bool"];
/// Words of an invocation's input.
const WORDS: usize = 4;

type Value = Box<dyn Fn(&[u32]) -> Vec<u32>>;

/// An expression: its text, and its components as words (booleans as 0 and 1) for an input.
struct Tree {
    text: String,
    value: Value,
}

fn float(word: u32) -> f32 {
    f32::from_bits(word)
}

impl Tree {
    fn new(text: String, value: impl Fn(&[u32]) -> Vec<u32> + 'static) -> Self {
        Self { text, value: Box::new(value) }
    }

    fn map(self, text: &str, f: impl Fn(u32) -> u32 + 'static) -> Self {
        let value = self.value;
        let all = move |input: &[u32]| value(input).into_iter().map(&f).collect();
        Self::new(text.replace('$', &self.text), all)
    }

    fn zip(self, other: Self, text: &str, f: impl Fn(u32, u32) -> u32 + 'static) -> Self {
        let (a, b) = (self.value, other.value);
        let all = move |input: &[u32]| {
            let (a, b) = (a(input), b(input));
            let count = a.len().max(b.len());
            (0..count).map(|i| f(a[i % a.len()], b[i % b.len()])).collect()
        };
        Self::new(text.replace('$', &self.text).replace('#', &other.text), all)
    }
}

fn type_name(kind: &str, width: usize) -> String {
    if width == 1 { kind.to_owned() } else { format!("vec{width}<{kind}>") }
}

/// Not a constant: naga would evaluate it, and refuse some.
fn leaf(tape: &mut Tape<'_>, kind: &'static str) -> Tree {
    let at = tape.below(WORDS);
    let word = Tree::new(format!("word{at}"), move |input| vec![input[at]]);
    match kind {
        "u32" => word,
        "i32" => word.map("i32($)", |x| x),
        // Multiples of 1/8, so that much is exact and some is equal.
        "f32" => word.map("(f32(i32($)) * 0.125)", |x| (x as i32 as f32 * 0.125).to_bits()),
        _ => word.map("($ % 3u == 1u)", |x| u32::from(x % 3 == 1)),
    }
}

fn tree(tape: &mut Tape<'_>, kind: &'static str, width: usize, depth: usize) -> Tree {
    let ty = type_name(kind, width);
    if depth == 0 {
        return leaf(tape, kind).map(&format!("{ty}($)"), |x| x).widened(width);
    }
    let depth = depth - 1;
    match tape.below(9) {
        0 => leaf(tape, kind).map(&format!("{ty}($)"), |x| x).widened(width),
        1 if width > 1 => {
            // Composed, of scalars or of shorter vectors.
            let first = if width > 2 && tape.chance(50) { 2 } else { 1 };
            let rest = width - first;
            let (a, b) = (tree(tape, kind, first, depth), tree(tape, kind, rest, depth));
            let text = format!("{ty}({}, {})", a.text, b.text);
            let (a, b) = (a.value, b.value);
            Tree::new(text, move |input| [a(input), b(input)].concat())
        }
        2 => {
            let from = 2 + tape.below(3);
            let inner = tree(tape, kind, from, depth);
            let picks: Vec<usize> = (0..width).map(|_| tape.below(from)).collect();
            let names: String = picks.iter().map(|pick| ["x", "y", "z", "w"][*pick]).collect();
            let value = inner.value;
            Tree::new(format!("{}.{names}", inner.text), move |input| {
                let value = value(input);
                picks.iter().map(|pick| value[*pick]).collect()
            })
        }
        3 if width == 1 => {
            let from = 2 + tape.below(3);
            let inner = tree(tape, kind, from, depth);
            let index_kind = KINDS[tape.below(2)];
            let index = tree(tape, index_kind, 1, depth.min(1));
            let text = format!("{}[{}]", inner.text, index.text);
            let (value, index) = (inner.value, index.value);
            Tree::new(text, move |input| {
                let value = value(input);
                vec![value[(index(input)[0] as usize).min(value.len() - 1)]]
            })
        }
        4 => {
            let wide = tape.chance(50);
            let mask = tree(tape, "bool", if wide { width } else { 1 }, depth);
            let (a, b) = (tree(tape, kind, width, depth), tree(tape, kind, width, depth));
            let text = format!("select({}, {}, {})", a.text, b.text, mask.text);
            let (a, b, mask) = (a.value, b.value, mask.value);
            Tree::new(text, move |input| {
                let (a, b, mask) = (a(input), b(input), mask(input));
                let pick = |i: usize| if mask[i % mask.len()] == 1 { b[i] } else { a[i] };
                (0..a.len()).map(pick).collect()
            })
        }
        5 => {
            let from = KINDS[tape.below(4)];
            let inner = tree(tape, from, width, depth);
            inner.map(&format!("{ty}($)"), move |x| converted(from, kind, x))
        }
        _ => operation(tape, kind, width, depth),
    }
}

impl Tree {
    fn widened(self, width: usize) -> Self {
        let value = self.value;
        Self::new(self.text, move |input| value(input).repeat(width))
    }
}

/// Conversion by value; Rust's `as` truncates, clamps, and takes NaN to 0.
fn converted(from: &str, to: &str, x: u32) -> u32 {
    match (from, to) {
        ("f32", "u32") => float(x) as u32,
        ("f32", "i32") => (float(x) as i32) as u32,
        ("f32", "bool") => u32::from(float(x) != 0.0),
        ("i32", "f32") => (x as i32 as f32).to_bits(),
        ("u32" | "bool", "f32") => (x as f32).to_bits(),
        (_, "bool") => u32::from(x != 0),
        _ => x,
    }
}

fn operation(tape: &mut Tape<'_>, kind: &'static str, width: usize, depth: usize) -> Tree {
    let of = |tape: &mut Tape<'_>, kind| tree(tape, kind, width, depth);
    match kind {
        "bool" => match tape.below(6) {
            0 => of(tape, kind).map("(!$)", |x| 1 - x),
            1 => of(tape, kind).zip(of(tape, kind), "($ & #)", |a, b| a & b),
            2 => of(tape, kind).zip(of(tape, kind), "($ | #)", |a, b| a | b),
            3 if width == 1 => {
                let (text, all) = [("all($)", true), ("any($)", false)][tape.below(2)];
                let from = 2 + tape.below(3);
                let inner = tree(tape, "bool", from, depth);
                let value = inner.value;
                Tree::new(text.replace('$', &inner.text), move |input| {
                    let value = value(input);
                    let ones = value.iter().filter(|x| **x == 1).count();
                    vec![u32::from(if all { ones == value.len() } else { ones > 0 })]
                })
            }
            _ => {
                let of_kind = KINDS[tape.below(3)];
                let (a, b) = (of(tape, of_kind), of(tape, of_kind));
                let op = ["<", "<=", ">", ">=", "==", "!="][tape.below(6)];
                a.zip(b, &format!("($ {op} #)"), move |a, b| u32::from(compared(of_kind, op, a, b)))
            }
        },
        "f32" => match tape.below(7) {
            0 => of(tape, kind).map("(-$)", |x| (-float(x)).to_bits()),
            1 => of(tape, kind).map("abs($)", |x| float(x).abs().to_bits()),
            2 => of(tape, kind).map("floor($)", |x| float(x).floor().to_bits()),
            choice => {
                // One of the two may be a scalar.
                let scalar = tape.chance(30);
                let (a, b) =
                    (of(tape, kind), tree(tape, kind, if scalar { 1 } else { width }, depth));
                let (op, f): (_, fn(f32, f32) -> f32) = [
                    ("+", (|a, b| a + b) as fn(f32, f32) -> f32),
                    ("-", |a, b| a - b),
                    ("*", |a, b| a * b),
                    ("/", |a, b| a / b),
                ][choice % 4];
                let text = format!("($ {op} #)");
                a.zip(b, &text, move |a, b| f(float(a), float(b)).to_bits())
            }
        },
        _ => integer(tape, kind, width, depth),
    }
}

fn compared(kind: &str, op: &str, a: u32, b: u32) -> bool {
    let order = match kind {
        "f32" => float(a).partial_cmp(&float(b)),
        "i32" => Some((a as i32).cmp(&(b as i32))),
        _ => Some(a.cmp(&b)),
    };
    match op {
        "<" => order.is_some_and(|order| order.is_lt()),
        "<=" => order.is_some_and(|order| order.is_le()),
        ">" => order.is_some_and(|order| order.is_gt()),
        ">=" => order.is_some_and(|order| order.is_ge()),
        "==" => order.is_some_and(|order| order.is_eq()),
        _ => order.is_none_or(|order| order.is_ne()),
    }
}

fn integer(tape: &mut Tape<'_>, kind: &'static str, width: usize, depth: usize) -> Tree {
    let signed = kind == "i32";
    let of = |tape: &mut Tape<'_>, kind| tree(tape, kind, width, depth);
    match tape.below(12) {
        0 => of(tape, kind).map("(~$)", |x| !x),
        1 if signed => of(tape, kind).map("(-$)", |x| x.wrapping_neg()),
        2 if signed => of(tape, kind).map("abs($)", |x| (x as i32).wrapping_abs() as u32),
        3 => of(tape, kind).map("countOneBits($)", u32::count_ones),
        4 if width == 1 => {
            let size = 2 + tape.below(3);
            let (a, b) = (tree(tape, kind, size, depth), tree(tape, kind, size, depth));
            let text = format!("dot({}, {})", a.text, b.text);
            let (a, b) = (a.value, b.value);
            Tree::new(text, move |input| {
                let (a, b) = (a(input), b(input));
                let product = |i: usize| a[i].wrapping_mul(b[i]);
                vec![(0..size).map(product).fold(0, u32::wrapping_add)]
            })
        }
        5 | 6 => {
            let op = ["<<", ">>"][tape.below(2)];
            let (a, by) = (of(tape, kind), of(tape, "u32"));
            a.zip(by, &format!("($ {op} #)"), move |a, b| match op {
                ">>" if signed => ((a as i32) >> (b & 31)) as u32,
                _ => common::meaning::binary(op, a, b),
            })
        }
        choice => {
            let op = ["+", "-", "*", "/", "%", "&", "|", "^", "min", "max"][tape.below(10)];
            let scalar = choice == 7 && matches!(op, "+" | "-" | "*" | "/" | "%");
            let (a, b) = (of(tape, kind), tree(tape, kind, if scalar { 1 } else { width }, depth));
            let call = op.len() == 3;
            let text = if call { format!("{op}($, #)") } else { format!("($ {op} #)") };
            a.zip(b, &text, move |a, b| match (op, a as i32, b as i32) {
                ("/", x, y) if signed => (if y == 0 { x } else { x.wrapping_div(y) }) as u32,
                ("%", x, y) if signed => (if y == 0 { 0 } else { x.wrapping_rem(y) }) as u32,
                ("min", x, y) if signed => x.min(y) as u32,
                ("max", x, y) if signed => x.max(y) as u32,
                _ => common::meaning::binary(op, a, b),
            })
        }
    }
}

/// Inputs of all lanes: small and large words, of which some repeat.
fn tree_input() -> Vec<u32> {
    let word = |index: usize| {
        let mixed = (index as u32).wrapping_mul(2_654_435_761) ^ (index as u32 >> 3);
        match index % 5 {
            0 => mixed >> 28,
            1 => (mixed >> 20) % 200,
            2 => (mixed >> 26).wrapping_neg(),
            3 => [0, 1, u32::MAX, i32::MIN as u32, i32::MAX as u32][mixed as usize % 5],
            _ => mixed,
        }
    };
    (0..LANES as usize * WORDS).map(word).collect()
}

fn check_tree(numbers: &[u16], input: &[u32]) -> Result<(), TestCaseError> {
    let mut tape = Tape::new(numbers);
    let (kind, width) = (KINDS[tape.below(4)], 1 + tape.below(4));
    let depth = 2 + tape.below(5);
    let tree = tree(&mut tape, kind, width, depth);
    let mut text = String::from(
        "@group(0) @binding(0) var<storage, read> input: array<u32>;
@group(0) @binding(1) var<storage, read_write> output: array<u32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
if id.x * 4u >= arrayLength(&input) { return; }\n",
    );
    for word in 0..WORDS {
        text += &format!("let word{word} = input[id.x * 4u + {word}u];\n");
    }
    text += &format!("let value = {};\n", tree.text);
    for index in 0..width {
        let part = if width == 1 { "value".to_owned() } else { format!("value[{index}]") };
        let part = match kind {
            "bool" => format!("u32({part})"),
            _ => format!("bitcast<u32>({part})"),
        };
        text += &format!("output[id.x * {width}u + {index}u] = {part};\n");
    }
    text.push('}');
    is_valid(&text).map_err(TestCaseError::fail)?;
    let program = lower(&text).unwrap();
    let groups = LANES.div_ceil(64);
    let output = run_with(&program, input, LANES as usize * width, groups, How::default()).unwrap();
    for (lane, got) in words(&output).chunks(width).enumerate() {
        let wanted = (tree.value)(&input[lane * WORDS..][..WORDS]);
        let same = |(got, wanted): (&u32, &u32)| {
            got == wanted || kind == "f32" && float(*got).is_nan() && float(*wanted).is_nan()
        };
        let all = got.iter().zip(&wanted).all(same);
        prop_assert!(all, "invocation {lane}: {got:x?}, not {wanted:x?} in\n{text}");
    }
    Ok(())
}

#[test]
fn expressions_mean_what_they_say_component_by_component() {
    let input = tree_input();
    hold(&vec(any::<u16>(), 10..300), |numbers| check_tree(&numbers, &input));
}
