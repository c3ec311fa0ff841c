//! Random programs of the small language, from a tape of numbers: a shorter tape with smaller
//! numbers gives a simpler program, so that proptest finds small ones that fail.

use super::language::{
    Call, Case, Cond, Expr, Function, KNOBS, PRIVATES, Role, Source, Stmt, Target, Var,
};

/// Numbers that decide; zeros once it has ended.
pub struct Tape<'a> {
    numbers: std::slice::Iter<'a, u16>,
}

impl<'a> Tape<'a> {
    pub fn new(numbers: &'a [u16]) -> Self {
        Self { numbers: numbers.iter() }
    }

    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.numbers.next().copied().unwrap_or(0)) % count
    }

    /// True with a probability of `percent`, never at the end.
    pub fn chance(&mut self, percent: usize) -> bool {
        self.below(100) >= 100 - percent
    }
}

/// A number of parameters: values, and the sizes of what pointers point to.
type Signature = (usize, Vec<usize>);

struct Generator<'a, 't> {
    tape: &'a mut Tape<'t>,
    /// Of the functions that can be called.
    signatures: &'a [Signature],
    vars: Vec<Var>,
    /// Variables that are in scope, and whether they may be assigned to.
    scope: Vec<(usize, bool)>,
    loops: usize,
    /// Whether a `break` or `continue` would stand in a loop or a switch.
    breaks: bool,
    /// Inside `continuing`, which must not be left.
    held: bool,
    statements: usize,
}

/// A program of up to five functions.
pub fn program(tape: &mut Tape<'_>) -> Source {
    let mut signatures: Vec<Signature> = Vec::new();
    let mut functions = Vec::new();
    let helpers = tape.below(5);
    for index in 0..=helpers {
        let last = index == helpers;
        let values = if last { 1 } else { tape.below(3) };
        let pointers = if last { 0 } else { tape.below(4) };
        let sizes: Vec<usize> = (0..pointers).map(|_| PRIVATES[tape.below(3)]).collect();
        let of = |role, sizes: &[usize]| -> Vec<Var> {
            sizes.iter().map(|size| Var { role, size: *size }).collect()
        };
        let mut vars = of(Role::Private, &PRIVATES);
        vars.extend(of(Role::Value, &vec![1; values]));
        vars.extend(of(Role::Pointer, &sizes));
        let scope = (0..vars.len()).map(|var| (var, vars[var].role != Role::Value)).collect();
        let statements = if last { 30 } else { 14 };
        let (loops, breaks, held) = (0, false, false);
        let mut generator = Generator {
            tape: &mut *tape,
            signatures: &signatures,
            vars,
            scope,
            loops,
            breaks,
            held,
            statements,
        };
        let mut body: Vec<Stmt> = (0..2).map(|_| generator.declare()).collect();
        body.extend(generator.list(8));
        if !matches!(body.last(), Some(Stmt::Return(_))) {
            body.push(Stmt::Return(generator.expr(2)));
        }
        functions.push(Function { vars: generator.vars, body });
        signatures.push((values, sizes));
    }
    Source { functions }
}

impl Generator<'_, '_> {
    fn new_var(&mut self, size: usize) -> usize {
        self.vars.push(Var { role: Role::Local, size });
        self.vars.len() - 1
    }

    fn one_of(&mut self, wanted: impl Fn(Var, bool) -> bool) -> Option<usize> {
        let fits = |(var, free): &(usize, bool)| wanted(self.vars[*var], *free).then_some(*var);
        let all: Vec<usize> = self.scope.iter().rev().filter_map(fits).collect();
        if all.is_empty() { None } else { Some(all[self.tape.below(all.len())]) }
    }

    /// One word of a variable.
    fn target(&mut self, assigned: bool, depth: usize) -> Target {
        let var = self.one_of(|_, free| free || !assigned).unwrap_or(0);
        let index = (self.vars[var].size > 1).then(|| Box::new(self.index(depth)));
        Target { var, index }
    }

    fn index(&mut self, depth: usize) -> Expr {
        if depth == 0 || !self.tape.chance(60) {
            return Expr::Literal(self.tape.below(5) as u32);
        }
        let inner = self.varying(depth - 1);
        Expr::Binary("%", Box::new(inner), Box::new(Expr::Literal(2 + self.tape.below(6) as u32)))
    }

    /// Not a constant.
    fn varying(&mut self, depth: usize) -> Expr {
        if depth == 0 || !self.tape.chance(50) {
            if self.tape.chance(25) {
                return Expr::Knob(self.tape.below(KNOBS.len()));
            }
            return Expr::Read(self.target(false, depth.min(1)));
        }
        let left = Box::new(self.varying(depth - 1));
        match self.tape.below(10) {
            0..3 => Expr::Binary("+", left, Box::new(self.expr(depth - 1))),
            3 => Expr::Binary("-", left, Box::new(self.expr(depth - 1))),
            4 => Expr::Binary("*", left, Box::new(self.expr(depth - 1))),
            5 => {
                let op = ["^", "|", "&", "min", "max"][self.tape.below(5)];
                Expr::Binary(op, left, Box::new(self.expr(depth - 1)))
            }
            6 => {
                let op = ["%", "/"][self.tape.below(2)];
                let by = if self.tape.chance(30) {
                    self.varying(depth - 1)
                } else {
                    Expr::Literal(1 + self.tape.below(9) as u32)
                };
                Expr::Binary(op, left, Box::new(by))
            }
            7 => {
                let op = [">>", "<<"][self.tape.below(2)];
                let by = if self.tape.chance(30) {
                    self.varying(depth - 1)
                } else {
                    Expr::Literal(self.tape.below(32) as u32)
                };
                Expr::Binary(op, left, Box::new(by))
            }
            _ => {
                let other = Box::new(self.expr(depth - 1));
                Expr::Select(left, other, Box::new(self.compare(depth - 1)))
            }
        }
    }

    fn expr(&mut self, depth: usize) -> Expr {
        if self.tape.chance(70) {
            return self.varying(depth);
        }
        Expr::Literal([0, 1, 2, 3, 5, 7, 40, 1000, u32::MAX][self.tape.below(9)])
    }

    fn compare(&mut self, depth: usize) -> Cond {
        if self.tape.chance(25) {
            // The same for all lanes.
            let knob = Expr::Knob(self.tape.below(KNOBS.len()));
            let other = match self.one_of(|var, free| !free && var.role == Role::Local) {
                Some(var) if self.tape.chance(60) => Expr::Read(Target { var, index: None }),
                _ => Expr::Literal(self.tape.below(4) as u32),
            };
            return Cond::Compare(["<", "==", "!=", ">="][self.tape.below(4)], knob, other);
        }
        let left = self.varying(depth);
        let right = Expr::Literal(self.tape.below(3) as u32);
        match self.tape.below(5) {
            0 => {
                let count = Expr::Literal(2 + self.tape.below(4) as u32);
                Cond::Compare("==", Expr::Binary("%", Box::new(left), Box::new(count)), right)
            }
            1 => {
                let bit = Expr::Literal(1 << self.tape.below(8));
                Cond::Compare("!=", Expr::Binary("&", Box::new(left), Box::new(bit)), right)
            }
            2 => Cond::Compare(">=", left, right),
            _ => Cond::Compare("<", left, self.expr(depth)),
        }
    }

    fn cond(&mut self, depth: usize) -> Cond {
        if depth == 0 || !self.tape.chance(30) {
            return self.compare(depth.min(1));
        }
        match self.tape.below(4) {
            0 => Cond::Not(Box::new(self.cond(depth - 1))),
            1 => Cond::Both(Box::new(self.cond(depth - 1)), Box::new(self.cond(depth - 1))),
            2 => Cond::Either(Box::new(self.cond(depth - 1)), Box::new(self.cond(depth - 1))),
            _ => match self.call() {
                Some(call) => Cond::Called(call, self.expr(1)),
                None => self.compare(1),
            },
        }
    }

    fn call(&mut self) -> Option<Call> {
        if self.signatures.is_empty() {
            return None;
        }
        let function = self.tape.below(self.signatures.len());
        let (values, sizes) = self.signatures[function].clone();
        let values = (0..values).map(|_| self.expr(2)).collect();
        let mut pointers: Vec<Target> = Vec::new();
        for size in sizes {
            // No two names of one variable.
            let used: Vec<usize> = pointers.iter().map(|target| target.var).collect();
            let of_size = |var: &(usize, bool)| {
                let Var { role, size: own } = self.vars[var.0];
                let free = var.1 && !used.contains(&var.0);
                free && own == size && matches!(role, Role::Local | Role::Pointer)
            };
            let all: Vec<usize> =
                self.scope.iter().rev().filter(|var| of_size(var)).map(|var| var.0).collect();
            if all.is_empty() {
                return None;
            }
            pointers.push(Target { var: all[self.tape.below(all.len())], index: None });
        }
        Some(Call { function, values, pointers })
    }

    fn declare(&mut self) -> Stmt {
        let size = [1, 1, 1, 3, 5][self.tape.below(5)];
        let value = (size == 1 && self.tape.chance(80)).then(|| self.expr(2));
        let var = self.new_var(size);
        self.scope.push((var, true));
        Stmt::Declare(var, value)
    }

    /// Statements up to a jump, in a scope of their own.
    fn list(&mut self, most: usize) -> Vec<Stmt> {
        let scope = self.scope.len();
        let count = 1 + self.tape.below(most);
        let mut list = Vec::new();
        for _ in 0..count {
            if self.statements == 0 {
                break;
            }
            self.statements -= 1;
            let stmt = self.stmt();
            let jumps = matches!(stmt, Stmt::Break | Stmt::Continue | Stmt::Return(_));
            list.push(stmt);
            if jumps {
                break;
            }
        }
        self.scope.truncate(scope);
        list
    }

    /// The body of something that can be left by `break`.
    fn body(&mut self, counter: Option<usize>) -> Vec<Stmt> {
        let breaks = std::mem::replace(&mut self.breaks, true);
        self.loops += usize::from(counter.is_some());
        let scope = self.scope.len();
        self.scope.extend(counter.map(|counter| (counter, false)));
        let list = self.list(6);
        self.scope.truncate(scope);
        self.loops -= usize::from(counter.is_some());
        self.breaks = breaks;
        list
    }

    fn stmt(&mut self) -> Stmt {
        match self.tape.below(26) {
            0..4 => Stmt::Assign(self.target(true, 2), self.expr(3)),
            4..8 => {
                let op = ["+", "-", "*", "^"][self.tape.below(4)];
                Stmt::Update(self.target(true, 2), op, self.expr(2))
            }
            8..11 => match self.call() {
                Some(call) => {
                    let target = self.tape.chance(80).then(|| self.target(true, 1));
                    Stmt::Call(target, call)
                }
                None => Stmt::Assign(self.target(true, 2), self.expr(3)),
            },
            11 => self.declare(),
            12..16 => {
                let cond = self.cond(2);
                let accept = self.list(4);
                let reject = if self.tape.chance(50) { self.list(4) } else { Vec::new() };
                Stmt::If(cond, accept, reject)
            }
            16 => self.switch(),
            17..20 if self.loops < 3 => self.a_loop(),
            20 if self.tape.chance(50) => {
                // Two words change places.
                let (a, b) = (self.target(true, 0), self.target(true, 0));
                let again = |target: &Target| {
                    let index = target.index.as_deref().map(|index| match index {
                        Expr::Literal(value) => Box::new(Expr::Literal(*value)),
                        _ => unreachable!("an index of no depth is a literal"),
                    });
                    Target { var: target.var, index }
                };
                let var = self.new_var(1);
                let kept = Target { var, index: None };
                Stmt::Block(vec![
                    Stmt::Declare(var, Some(Expr::Read(again(&a)))),
                    Stmt::Assign(a, Expr::Read(again(&b))),
                    Stmt::Assign(b, Expr::Read(kept)),
                ])
            }
            20 => Stmt::Block(self.list(3)),
            21 if self.breaks && !self.held => Stmt::Break,
            22 if self.loops > 0 && !self.held => Stmt::Continue,
            23 if !self.held => Stmt::Return(self.expr(2)),
            24 if self.loops > 0 && !self.held => {
                let cond = self.cond(1);
                let jump = match self.tape.below(3) {
                    0 => Stmt::Break,
                    1 => Stmt::Continue,
                    _ => Stmt::Return(self.expr(1)),
                };
                Stmt::If(cond, vec![jump], Vec::new())
            }
            _ => Stmt::Update(self.target(true, 1), "+", self.expr(2)),
        }
    }

    fn switch(&mut self) -> Stmt {
        let count = 2 + self.tape.below(4);
        let selector = self.varying(2);
        let by = Box::new(Expr::Literal(count as u32 + 1));
        let selector = Expr::Binary("%", Box::new(selector), by);
        let default = self.tape.below(count);
        let mut next = 0;
        let mut cases = Vec::new();
        for index in 0..count {
            let values = next..next + self.tape.below(3) as u32 + u32::from(index != default);
            next = values.end;
            let body = if self.held { self.list(3) } else { self.body(None) };
            cases.push(Case { values: values.collect(), default: index == default, body });
        }
        Stmt::Switch(selector, cases)
    }

    fn a_loop(&mut self) -> Stmt {
        let counter = self.new_var(1);
        match self.tape.below(3) {
            0 => {
                let bound = self.expr(2);
                Stmt::For { counter, bound, body: self.body(Some(counter)) }
            }
            1 => {
                let cond = self.cond(1);
                Stmt::While { counter, cond, body: self.body(Some(counter)) }
            }
            _ => {
                let body = self.body(Some(counter));
                let held = std::mem::replace(&mut self.held, true);
                let loops = std::mem::replace(&mut self.loops, 3);
                let continuing = if self.tape.chance(60) { self.list(2) } else { Vec::new() };
                self.loops = loops;
                self.held = held;
                let break_if = self.tape.chance(50).then(|| self.cond(1));
                Stmt::Loop { counter, body, continuing, break_if }
            }
        }
    }
}
