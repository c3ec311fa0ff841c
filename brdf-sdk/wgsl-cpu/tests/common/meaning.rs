//! What the programs of language.rs mean: one invocation at a time, statement by statement.

use super::language::{Call, Cond, Expr, Function, KNOBS, PRIVATES, Source, Stmt, Target};

impl Source {
    /// What it stores for an input; `None` where it takes too long.
    pub fn value(&self, input: u32) -> Option<u32> {
        let cells = PRIVATES.iter().map(|size| vec![0; *size]).collect();
        let mut machine = Machine { source: self, cells, steps: 20_000 };
        machine.cells[0][0] = 5;
        let last = self.functions.len() - 1;
        let mut sum = machine.run(last, &[input], &[])?.wrapping_mul(31);
        let factors = [7, 1, 3, 5, 11, 13, 17, 19, 23];
        for (word, factor) in machine.cells.iter().take(3).flatten().zip(factors) {
            sum = sum.wrapping_add(word.wrapping_mul(factor));
        }
        Some(sum)
    }
}

enum Next {
    On,
    Break,
    Continue,
    Return(u32),
}

/// Some words of a cell.
#[derive(Clone, Copy)]
struct Place {
    cell: usize,
    first: usize,
    size: usize,
}

struct Machine<'a> {
    source: &'a Source,
    cells: Vec<Vec<u32>>,
    steps: u32,
}

type Frame<'a> = (&'a Function, Vec<Place>);

/// `None` stands for a program that takes too long.
impl<'a> Machine<'a> {
    fn run(&mut self, function: usize, values: &[u32], pointers: &[Place]) -> Option<u32> {
        let function = &self.source.functions[function];
        let before = self.cells.len();
        let whole = |cell: usize, size: usize| Place { cell, first: 0, size };
        let mut places: Vec<Place> = Vec::new();
        for (cell, size) in PRIVATES.into_iter().enumerate() {
            places.push(whole(cell, size));
        }
        for value in values {
            places.push(whole(self.cells.len(), 1));
            self.cells.push(vec![*value]);
        }
        places.extend(pointers);
        places.resize(function.vars.len(), whole(usize::MAX, 0));
        let mut frame = (function, places);
        let next = self.block(&mut frame, &function.body)?;
        self.cells.truncate(before);
        let Next::Return(value) = next else { panic!("a function without its end") };
        Some(value)
    }

    fn declare(&mut self, frame: &mut Frame<'a>, var: usize, value: u32) {
        let size = frame.0.vars[var].size;
        frame.1[var] = Place { cell: self.cells.len(), first: 0, size };
        self.cells.push(vec![value; size]);
    }

    fn place(&mut self, frame: &Frame<'a>, target: &Target) -> Place {
        let place = frame.1[target.var];
        match target.index.as_deref() {
            None => place,
            Some(index) => {
                let index = match index {
                    Expr::Literal(value) => *value as usize % place.size,
                    index => (self.expr(frame, index) as usize).min(place.size - 1),
                };
                Place { first: place.first + index, size: 1, ..place }
            }
        }
    }

    fn word(&mut self, frame: &Frame<'a>, target: &Target) -> &mut u32 {
        let place = self.place(frame, target);
        &mut self.cells[place.cell][place.first]
    }

    fn expr(&mut self, frame: &Frame<'a>, expr: &Expr) -> u32 {
        match expr {
            Expr::Literal(value) => *value,
            Expr::Knob(index) => KNOBS[*index],
            Expr::Read(target) => *self.word(frame, target),
            Expr::Binary(op, a, b) => binary(op, self.expr(frame, a), self.expr(frame, b)),
            Expr::Select(a, b, cond) => {
                let (a, b) = (self.expr(frame, a), self.expr(frame, b));
                let cond = self.cond(frame, cond);
                if cond.unwrap_or(false) { b } else { a }
            }
        }
    }

    fn call(&mut self, frame: &Frame<'a>, call: &Call) -> Option<u32> {
        let values: Vec<u32> = call.values.iter().map(|value| self.expr(frame, value)).collect();
        let pointers: Vec<Place> =
            call.pointers.iter().map(|target| self.place(frame, target)).collect();
        self.run(call.function, &values, &pointers)
    }

    fn cond(&mut self, frame: &Frame<'a>, cond: &Cond) -> Option<bool> {
        Some(match cond {
            Cond::Compare(op, a, b) => {
                let (a, b) = (self.expr(frame, a), self.expr(frame, b));
                match *op {
                    "==" => a == b,
                    "!=" => a != b,
                    "<" => a < b,
                    _ => a >= b,
                }
            }
            Cond::Called(call, limit) => {
                let value = self.call(frame, call)?;
                value < self.expr(frame, limit)
            }
            Cond::Not(inner) => !self.cond(frame, inner)?,
            Cond::Both(a, b) => self.cond(frame, a)? && self.cond(frame, b)?,
            Cond::Either(a, b) => self.cond(frame, a)? || self.cond(frame, b)?,
        })
    }

    fn block(&mut self, frame: &mut Frame<'a>, block: &'a [Stmt]) -> Option<Next> {
        for stmt in block {
            match self.stmt(frame, stmt)? {
                Next::On => {}
                next => return Some(next),
            }
        }
        Some(Next::On)
    }

    fn stmt(&mut self, frame: &mut Frame<'a>, stmt: &'a Stmt) -> Option<Next> {
        self.steps = self.steps.checked_sub(1)?;
        match stmt {
            Stmt::Assign(target, value) => {
                let value = self.expr(frame, value);
                *self.word(frame, target) = value;
            }
            Stmt::Update(target, op, value) => {
                let value = self.expr(frame, value);
                let word = self.word(frame, target);
                *word = binary(op, *word, value);
            }
            Stmt::Call(target, call) => {
                let place = target.as_ref().map(|target| self.place(frame, target));
                let value = self.call(frame, call)?;
                if let Some(place) = place {
                    self.cells[place.cell][place.first] = value;
                }
            }
            Stmt::Declare(var, value) => {
                let value = value.as_ref().map_or(0, |value| self.expr(frame, value));
                self.declare(frame, *var, value);
            }
            Stmt::If(cond, accept, reject) => {
                let side = if self.cond(frame, cond)? { accept } else { reject };
                return self.block(frame, side);
            }
            Stmt::Switch(selector, cases) => {
                let selector = self.expr(frame, selector);
                let named = cases.iter().find(|case| case.values.contains(&selector));
                let case = named.or_else(|| cases.iter().find(|case| case.default))?;
                return Some(match self.block(frame, &case.body)? {
                    Next::Break => Next::On,
                    next => next,
                });
            }
            Stmt::For { counter, bound, body } => {
                self.declare(frame, *counter, 0);
                let counter = frame.1[*counter];
                while self.cells[counter.cell][0] < self.expr(frame, bound).min(5) {
                    match self.block(frame, body)? {
                        Next::Break => break,
                        Next::Return(value) => return Some(Next::Return(value)),
                        Next::On | Next::Continue => {}
                    }
                    self.cells[counter.cell][0] += 1;
                }
            }
            Stmt::While { counter, cond, body } => {
                self.declare(frame, *counter, 0);
                let counter = frame.1[*counter];
                while self.cells[counter.cell][0] < 6 && self.cond(frame, cond)? {
                    self.cells[counter.cell][0] += 1;
                    match self.block(frame, body)? {
                        Next::Break => break,
                        Next::Return(value) => return Some(Next::Return(value)),
                        Next::On | Next::Continue => {}
                    }
                }
            }
            Stmt::Loop { counter, body, continuing, break_if } => {
                self.declare(frame, *counter, 0);
                let counter = frame.1[*counter];
                while self.cells[counter.cell][0] < 4 {
                    self.cells[counter.cell][0] += 1;
                    match self.block(frame, body)? {
                        Next::Break => break,
                        Next::Return(value) => return Some(Next::Return(value)),
                        Next::On | Next::Continue => {}
                    }
                    self.block(frame, continuing)?;
                    if let Some(cond) = break_if
                        && self.cond(frame, cond)?
                    {
                        break;
                    }
                }
            }
            Stmt::Break => return Some(Next::Break),
            Stmt::Continue => return Some(Next::Continue),
            Stmt::Return(value) => return Some(Next::Return(self.expr(frame, value))),
            Stmt::Block(block) => return self.block(frame, block),
        }
        Some(Next::On)
    }
}

/// WGSL's operators on u32.
pub fn binary(op: &str, a: u32, b: u32) -> u32 {
    match op {
        "+" => a.wrapping_add(b),
        "-" => a.wrapping_sub(b),
        "*" => a.wrapping_mul(b),
        "/" => a.checked_div(b).unwrap_or(a),
        "%" => a.checked_rem(b).unwrap_or(0),
        "&" => a & b,
        "|" => a | b,
        "^" => a ^ b,
        "<<" => a << (b & 31),
        ">>" => a >> (b & 31),
        "min" => a.min(b),
        "max" => a.max(b),
        other => panic!("{other}"),
    }
}
