//! Types, and how WGSL writes them.
//!
//! Scalars, vectors, matrices, arrays and structs, and which of them take one another's values. Layouts in memory
//! are of no concern.

/// What a number or a truth value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Scalar {
    Bool,
    Int,
    Uint,
    Float,
}

/// A type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Ty {
    Void,
    /// One to four components of a kind; one is no vector.
    Vector(Scalar, usize),
    /// Columns and rows.
    Matrix(usize, usize),
    Array(Box<Ty>, usize),
    /// A struct of the code's own, by its place among them.
    Struct(usize, String),
}

pub(crate) const FLOAT: Ty = Ty::Vector(Scalar::Float, 1);
pub(crate) const BOOL: Ty = Ty::Vector(Scalar::Bool, 1);
pub(crate) const INT: Ty = Ty::Vector(Scalar::Int, 1);
pub(crate) const VEC3: Ty = Ty::Vector(Scalar::Float, 3);

impl Scalar {
    pub(crate) fn wgsl(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::Int => "i32",
            Self::Uint => "u32",
            Self::Float => "f32",
        }
    }

    fn letter(self) -> &'static str {
        match self {
            Self::Bool => "<bool>",
            Self::Int => "i",
            Self::Uint => "u",
            Self::Float => "f",
        }
    }
}

impl Ty {
    pub(crate) fn wgsl(&self) -> String {
        match self {
            Self::Void => String::new(),
            Self::Vector(scalar, 1) => scalar.wgsl().to_owned(),
            Self::Vector(scalar, n) => format!("vec{n}{}", scalar.letter()),
            Self::Matrix(c, r) => format!("mat{c}x{r}f"),
            Self::Array(of, n) => format!("array<{}, {n}>", of.wgsl()),
            Self::Struct(_, name) => name.clone(),
        }
    }

    /// As GLSL writes it, for messages.
    pub(crate) fn glsl(&self) -> String {
        match self {
            Self::Void => "void".to_owned(),
            Self::Vector(scalar, n) => {
                let (single, prefix) = match scalar {
                    Scalar::Bool => ("bool", "b"),
                    Scalar::Int => ("int", "i"),
                    Scalar::Uint => ("uint", "u"),
                    Scalar::Float => ("float", ""),
                };
                if *n == 1 { single.to_owned() } else { format!("{prefix}vec{n}") }
            }
            Self::Matrix(c, r) if c == r => format!("mat{c}"),
            Self::Matrix(c, r) => format!("mat{c}x{r}"),
            Self::Array(of, n) => format!("{}[{n}]", of.glsl()),
            Self::Struct(_, name) => name.clone(),
        }
    }

    /// A word for names of functions: what `Ty::wgsl` writes, without brackets.
    pub(crate) fn word(&self) -> String {
        self.glsl().replace(['[', ']'], "_").trim_end_matches('_').to_owned()
    }

    pub(crate) fn is_float(&self) -> bool {
        matches!(self, Self::Vector(Scalar::Float, _))
    }

    /// Kind and components of a number or vector.
    pub(crate) fn vector(&self) -> Option<(Scalar, usize)> {
        match self {
            Self::Vector(scalar, n) => Some((*scalar, *n)),
            _ => None,
        }
    }

    /// Whether WGSL's `select` chooses between two of them.
    pub(crate) fn is_selectable(&self) -> bool {
        matches!(self, Self::Vector(..))
    }

    /// Whether GLSL makes one of the other without being asked.
    pub(crate) fn takes(&self, other: &Ty) -> bool {
        match (self, other) {
            (Self::Vector(to, n), Self::Vector(from, m)) => {
                n == m
                    && (to == from || (*to != Scalar::Bool && *from != Scalar::Bool && from < to))
            }
            _ => self == other,
        }
    }
}

/// A type of GLSL's own by its name.
pub(crate) fn named(name: &str) -> Option<Ty> {
    let single = |scalar| Some(Ty::Vector(scalar, 1));
    match name {
        "void" => return Some(Ty::Void),
        "float" => return single(Scalar::Float),
        "int" => return single(Scalar::Int),
        "uint" => return single(Scalar::Uint),
        "bool" => return single(Scalar::Bool),
        _ => {}
    }
    let size = |text: &str| text.parse().ok().filter(|n| (2..=4).contains(n));
    for (prefix, scalar) in [
        ("vec", Scalar::Float),
        ("ivec", Scalar::Int),
        ("uvec", Scalar::Uint),
        ("bvec", Scalar::Bool),
    ] {
        if let Some(n) = name.strip_prefix(prefix).and_then(size) {
            return Some(Ty::Vector(scalar, n));
        }
    }
    let rest = name.strip_prefix("mat")?;
    match rest.split_once('x') {
        Some((c, r)) => Some(Ty::Matrix(size(c)?, size(r)?)),
        None => size(rest).map(|n| Ty::Matrix(n, n)),
    }
}

/// Whether a word is a type of GLSL's own.
pub(crate) fn is_type_name(name: &str) -> bool {
    name != "void" && named(name).is_some()
}
