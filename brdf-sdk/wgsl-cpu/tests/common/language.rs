//! A small language of integer programs, and its text in WGSL; meaning.rs says what it means.

use std::fmt::Write as _;

/// Sizes of the private variables: a u32, a vec3u, an array.
pub const PRIVATES: [usize; 3] = [1, 3, 5];
/// Words that are the same for all invocations.
pub const KNOBS: [u32; 4] = [0, 1, 3, 1000];

pub enum Expr {
    Literal(u32),
    /// A word that is the same for all invocations.
    Knob(usize),
    Read(Target),
    Binary(&'static str, Box<Expr>, Box<Expr>),
    Select(Box<Expr>, Box<Expr>, Box<Cond>),
}

pub enum Cond {
    Compare(&'static str, Expr, Expr),
    /// f(...) < e
    Called(Call, Expr),
    Not(Box<Cond>),
    Both(Box<Cond>, Box<Cond>),
    Either(Box<Cond>, Box<Cond>),
}

/// A variable or an element of it.
pub struct Target {
    pub var: usize,
    pub index: Option<Box<Expr>>,
}

pub struct Call {
    pub function: usize,
    pub values: Vec<Expr>,
    pub pointers: Vec<Target>,
}

pub struct Case {
    pub values: Vec<u32>,
    pub default: bool,
    pub body: Vec<Stmt>,
}

pub enum Stmt {
    Assign(Target, Expr),
    Update(Target, &'static str, Expr),
    Call(Option<Target>, Call),
    /// `var v = e`, or zeros without e.
    Declare(usize, Option<Expr>),
    If(Cond, Vec<Stmt>, Vec<Stmt>),
    Switch(Expr, Vec<Case>),
    For {
        counter: usize,
        bound: Expr,
        body: Vec<Stmt>,
    },
    While {
        counter: usize,
        cond: Cond,
        body: Vec<Stmt>,
    },
    Loop {
        counter: usize,
        body: Vec<Stmt>,
        continuing: Vec<Stmt>,
        break_if: Option<Cond>,
    },
    Break,
    Continue,
    Return(Expr),
    Block(Vec<Stmt>),
}

#[derive(Clone, Copy, PartialEq)]
pub enum Role {
    Private,
    Value,
    Pointer,
    Local,
}

#[derive(Clone, Copy)]
pub struct Var {
    pub role: Role,
    pub size: usize,
}

/// Its variables: first the private ones, then the values, then the pointers, then locals.
pub struct Function {
    pub vars: Vec<Var>,
    pub body: Vec<Stmt>,
}

/// The last function is the one that the entry point calls, with one value.
pub struct Source {
    pub functions: Vec<Function>,
}

fn type_of(size: usize) -> &'static str {
    match size {
        1 => "u32",
        3 => "vec3<u32>",
        _ => "array<u32, 5>",
    }
}

impl Function {
    fn name(&self, var: usize) -> String {
        match self.vars[var].role {
            Role::Private => format!("g{var}"),
            Role::Value => format!("x{var}"),
            Role::Pointer => format!("(*p{var})"),
            Role::Local => format!("v{var}"),
        }
    }

    fn target(&self, target: &Target) -> String {
        let name = self.name(target.var);
        match target.index.as_deref() {
            None => name,
            Some(Expr::Literal(value)) => {
                format!("{name}[{}]", *value as usize % self.vars[target.var].size)
            }
            Some(index) => format!("{name}[{}]", self.expr(index)),
        }
    }

    fn expr(&self, expr: &Expr) -> String {
        match expr {
            Expr::Literal(value) => format!("{value}u"),
            Expr::Knob(index) => format!("knobs[{index}]"),
            Expr::Read(target) => self.target(target),
            Expr::Binary(op @ ("min" | "max"), a, b) => {
                format!("{op}({}, {})", self.expr(a), self.expr(b))
            }
            Expr::Binary(op, a, b) => format!("({} {op} {})", self.expr(a), self.expr(b)),
            Expr::Select(a, b, cond) => {
                format!("select({}, {}, {})", self.expr(a), self.expr(b), self.cond(cond))
            }
        }
    }

    fn call(&self, call: &Call) -> String {
        let values = call.values.iter().map(|value| self.expr(value));
        let pointers = call.pointers.iter().map(|target| format!("&{}", self.target(target)));
        let arguments: Vec<String> = values.chain(pointers).collect();
        format!("f{}({})", call.function, arguments.join(", "))
    }

    fn cond(&self, cond: &Cond) -> String {
        match cond {
            Cond::Compare(op, a, b) => format!("({} {op} {})", self.expr(a), self.expr(b)),
            Cond::Called(call, limit) => format!("({} < {})", self.call(call), self.expr(limit)),
            Cond::Not(inner) => format!("!{}", self.cond(inner)),
            Cond::Both(a, b) => format!("({} && {})", self.cond(a), self.cond(b)),
            Cond::Either(a, b) => format!("({} || {})", self.cond(a), self.cond(b)),
        }
    }

    fn block(&self, block: &[Stmt]) -> String {
        let lines: Vec<String> = block.iter().map(|stmt| self.stmt(stmt)).collect();
        format!("{{\n{}\n}}", lines.join("\n"))
    }

    fn stmt(&self, stmt: &Stmt) -> String {
        match stmt {
            Stmt::Assign(target, value) => {
                format!("{} = {};", self.target(target), self.expr(value))
            }
            Stmt::Update(target, op, value) => {
                format!("{} {op}= {};", self.target(target), self.expr(value))
            }
            Stmt::Call(None, call) => format!("_ = {};", self.call(call)),
            Stmt::Call(Some(target), call) => {
                format!("{} = {};", self.target(target), self.call(call))
            }
            Stmt::Declare(var, Some(value)) => format!("var v{var} = {};", self.expr(value)),
            Stmt::Declare(var, None) => format!("var v{var}: {};", type_of(self.vars[*var].size)),
            Stmt::If(cond, accept, reject) if reject.is_empty() => {
                format!("if {} {}", self.cond(cond), self.block(accept))
            }
            Stmt::If(cond, accept, reject) => {
                let (accept, reject) = (self.block(accept), self.block(reject));
                format!("if {} {accept} else {reject}", self.cond(cond))
            }
            Stmt::Switch(selector, cases) => {
                let mut text = format!("switch {} {{", self.expr(selector));
                for case in cases {
                    let values: Vec<String> = case.values.iter().map(|v| format!("{v}u")).collect();
                    let label = match (values.is_empty(), case.default) {
                        (true, _) => "default".to_owned(),
                        (false, false) => format!("case {}", values.join(", ")),
                        (false, true) => format!("case {}, default", values.join(", ")),
                    };
                    let _ = write!(text, "\n{label}: {}", self.block(&case.body));
                }
                text + "\n}"
            }
            Stmt::For { counter: n, bound, body } => format!(
                "for (var v{n} = 0u; v{n} < min({}, 5u); v{n}++) {}",
                self.expr(bound),
                self.block(body)
            ),
            Stmt::While { counter: n, cond, body } => format!(
                "var v{n} = 0u;\nwhile v{n} < 6u && {} {{\nv{n} += 1u;\n{}",
                self.cond(cond),
                &self.block(body)[2..]
            ),
            Stmt::Loop { counter: n, body, continuing, break_if } => {
                let (body, continuing) = (self.block(body), self.block(continuing));
                let inner = |text: &str| text[2..text.len() - 2].to_owned();
                let stop = break_if.as_ref().map(|cond| format!("break if {};", self.cond(cond)));
                format!(
                    "var v{n} = 0u;\nloop {{\nif v{n} >= 4u {{ break; }}\nv{n}++;\n{}\n\
                     continuing {{\n{}\n{}\n}}\n}}",
                    inner(&body),
                    inner(&continuing),
                    stop.unwrap_or_default()
                )
            }
            Stmt::Break => "break;".to_owned(),
            Stmt::Continue => "continue;".to_owned(),
            Stmt::Return(value) => format!("return {};", self.expr(value)),
            Stmt::Block(block) => self.block(block),
        }
    }

    fn header(&self, index: usize) -> String {
        let parameter = |(index, var): (usize, &Var)| match var.role {
            Role::Value => Some(format!("x{index}: u32")),
            Role::Pointer => Some(format!("p{index}: ptr<function, {}>", type_of(var.size))),
            _ => None,
        };
        let all: Vec<String> = self.vars.iter().enumerate().filter_map(parameter).collect();
        format!("fn f{index}({}) -> u32", all.join(", "))
    }
}

impl Source {
    /// The program in WGSL: `input` and `output` at bindings 0 and 1, knobs at 2.
    pub fn text(&self) -> String {
        let mut text = String::from(
            "@group(0) @binding(0) var<storage, read> input: array<u32>;
@group(0) @binding(1) var<storage, read_write> output: array<u32>;
@group(0) @binding(2) var<storage, read> knobs: array<u32>;
var<private> g0: u32 = 5u;
var<private> g1: vec3<u32>;
var<private> g2: array<u32, 5>;
",
        );
        for (index, function) in self.functions.iter().enumerate() {
            let _ = writeln!(text, "{} {}", function.header(index), function.block(&function.body));
        }
        let last = self.functions.len() - 1;
        let _ = write!(
            text,
            "@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {{
if id.x >= arrayLength(&output) {{ return; }}
let r = f{last}(input[id.x]);
output[id.x] = r * 31u + g0 * 7u + g1.x + g1.y * 3u + g1.z * 5u
    + g2[0] * 11u + g2[1] * 13u + g2[2] * 17u + g2[3] * 19u + g2[4] * 23u;
}}
"
        );
        text
    }
}
