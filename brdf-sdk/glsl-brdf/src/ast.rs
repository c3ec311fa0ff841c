//! The tree of the code.
//!
//! Plain data, each part with its place in the file: what `parse` makes and `emit` writes. Types are names here
//! still, and nothing says yet whether the code means anything.

use std::ops::Range;

pub(crate) type Span = Range<usize>;

/// What the length of an array is called as a member.
pub(crate) const LENGTH: &str = "length()";

/// An expression with its place.
#[derive(Debug, Clone)]
pub(crate) struct Expr {
    pub(crate) kind: ExprKind,
    pub(crate) span: Span,
    /// How deep expressions nest in it.
    pub(crate) height: usize,
}

impl Expr {
    pub(crate) fn new(kind: ExprKind, span: Span) -> Self {
        let highest = |all: &[Expr]| all.iter().map(|one| one.height).max().unwrap_or(0);
        let height = match &kind {
            ExprKind::Number(_) | ExprKind::Bool(_) | ExprKind::Name(_) => 0,
            ExprKind::Call { arguments: all, .. } | ExprKind::Comma(all) | ExprKind::List(all) => {
                highest(all)
            }
            ExprKind::Member(of, _) | ExprKind::Unary(_, of) | ExprKind::Step { of, .. } => {
                of.height
            }
            ExprKind::Index(a, b) | ExprKind::Binary(_, a, b) | ExprKind::Assign(_, a, b) => {
                a.height.max(b.height)
            }
            ExprKind::Choice(a, b, c) => a.height.max(b.height).max(c.height),
        };
        Self { kind, span, height: height + 1 }
    }
}

#[derive(Debug, Clone)]
pub(crate) enum ExprKind {
    Number(String),
    Bool(bool),
    Name(String),
    /// A function's call, or a value made of a type's name.
    Call {
        callee: TypeName,
        arguments: Vec<Expr>,
    },
    Member(Box<Expr>, String),
    Index(Box<Expr>, Box<Expr>),
    Unary(&'static str, Box<Expr>),
    /// `++` or `--`; `before`: whether it stands before.
    Step {
        operator: &'static str,
        of: Box<Expr>,
        before: bool,
    },
    Binary(&'static str, Box<Expr>, Box<Expr>),
    Choice(Box<Expr>, Box<Expr>, Box<Expr>),
    Assign(&'static str, Box<Expr>, Box<Expr>),
    Comma(Vec<Expr>),
    /// Values in braces.
    List(Vec<Expr>),
}

/// A type as it is written: its name, and the lengths of arrays of it; a length may be left out.
#[derive(Debug, Clone)]
pub(crate) struct TypeName {
    pub(crate) name: String,
    pub(crate) lengths: Vec<Option<Expr>>,
    pub(crate) span: Span,
}

/// One name of a declaration.
#[derive(Debug, Clone)]
pub(crate) struct Declared {
    pub(crate) name: String,
    pub(crate) span: Span,
    pub(crate) lengths: Vec<Option<Expr>>,
    pub(crate) value: Option<Expr>,
}

/// A declaration of variables.
#[derive(Debug, Clone)]
pub(crate) struct Declaration {
    pub(crate) is_const: bool,
    pub(crate) ty: TypeName,
    pub(crate) names: Vec<Declared>,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) struct Stmt {
    pub(crate) kind: StmtKind,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) enum StmtKind {
    Declare(Declaration),
    Expr(Expr),
    If(Expr, Box<Stmt>, Option<Box<Stmt>>),
    For { first: Option<Box<Stmt>>, holds: Option<Expr>, step: Option<Expr>, body: Box<Stmt> },
    While(Expr, Box<Stmt>),
    DoWhile(Box<Stmt>, Expr),
    Switch(Expr, Vec<Case>),
    Return(Option<Expr>),
    Break,
    Continue,
    Block(Vec<Stmt>),
    Empty,
}

/// A part of a `switch`: its labels, `None` for `default`, and what it does.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) labels: Vec<Option<Expr>>,
    pub(crate) body: Vec<Stmt>,
    pub(crate) span: Span,
}

/// How an argument is handed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Passed {
    In,
    Out,
    InOut,
}

#[derive(Debug, Clone)]
pub(crate) struct Argument {
    pub(crate) passed: Passed,
    pub(crate) ty: TypeName,
    pub(crate) name: String,
}

#[derive(Debug, Clone)]
pub(crate) struct Function {
    pub(crate) result: TypeName,
    pub(crate) name: String,
    pub(crate) name_span: Span,
    pub(crate) arguments: Vec<Argument>,
    /// None where it is only announced.
    pub(crate) body: Option<Vec<Stmt>>,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) struct Struct {
    pub(crate) name: String,
    pub(crate) span: Span,
    pub(crate) members: Vec<(TypeName, Vec<Declared>)>,
}

#[derive(Debug, Clone)]
pub(crate) enum Item {
    Function(Function),
    Global(Declaration),
    Struct(Struct),
}
