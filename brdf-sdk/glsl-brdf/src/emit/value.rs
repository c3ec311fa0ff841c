//! Written expressions: text with its type, and what is known of it.
//!
//! Brackets are set here, by how closely operators bind, and numbers get their digits. A value is looked up nowhere
//! and checked by nobody here.

use super::writer::unmarked;
use crate::types::{BOOL, Scalar, Ty};

/// How close the operators of a text bind; what binds less closely than its place asks for gets brackets.
pub(super) mod bind {
    pub(in crate::emit) const SINGLE: u8 = 20;
    pub(in crate::emit) const UNARY: u8 = 15;
    pub(in crate::emit) const TIMES: u8 = 12;
    pub(in crate::emit) const PLUS: u8 = 11;
    pub(in crate::emit) const COMPARE: u8 = 9;
    pub(in crate::emit) const BITS: u8 = 8;
    pub(in crate::emit) const LOGIC: u8 = 5;
}

/// A written expression.
#[derive(Debug, Clone)]
pub(crate) struct Value {
    pub(super) text: String,
    pub(super) ty: Ty,
    pub(super) bind: u8,
    /// Its value, where it is one number that is known, in all components.
    pub(super) number: Option<f64>,
    /// Whether it is a whole number as it is written, which takes the type that its place asks for.
    pub(super) is_literal: bool,
    /// Whether WGSL takes it for a constant.
    pub(super) is_constant: bool,
    /// Whether it changes something when it is evaluated.
    pub(super) acts: bool,
}

impl Value {
    /// What a call or a name gives.
    pub(super) fn single(text: impl Into<String>, ty: Ty) -> Self {
        Self {
            text: text.into(),
            ty,
            bind: bind::SINGLE,
            number: None,
            is_literal: false,
            is_constant: false,
            acts: false,
        }
    }

    /// A call of a function without effects.
    pub(super) fn call(name: &str, arguments: &[&Value], ty: Ty) -> Self {
        // WGSL takes `f(a < b, c > (d))` for a list of templates.
        let texts: Vec<String> =
            arguments.iter().map(|value| value.within(bind::COMPARE + 1)).collect();
        Self {
            acts: arguments.iter().any(|value| value.acts),
            ..Self::single(format!("{name}({})", texts.join(", ")), ty)
        }
    }

    pub(super) fn bool(text: String) -> Self {
        Self { is_constant: true, ..Self::single(text, BOOL) }
    }

    /// Its text for a place that binds so closely.
    pub(super) fn within(&self, closeness: u8) -> String {
        if self.bind < closeness { format!("({})", self.text) } else { self.text.clone() }
    }

    /// Its text without marks.
    pub(super) fn plain(&self) -> String {
        unmarked(&self.text)
    }

    /// Whether its text may stand twice: a name, a member, a number.
    pub(super) fn is_simple(&self) -> bool {
        let plain = self.plain();
        !plain.is_empty()
            && plain.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.')
    }

    /// Marks where it comes from.
    pub(super) fn at(mut self, place: usize) -> Self {
        self.text = super::writer::mark(place) + &self.text;
        self
    }

    /// The same as another type that GLSL makes of it; `None` where it does not.
    pub(super) fn converted(&self, to: &Ty) -> Option<Value> {
        if self.ty == *to {
            return Some(self.clone());
        }
        if !to.takes(&self.ty) {
            return None;
        }
        let (scalar, _) = to.vector()?;
        let mut value = self.clone();
        value.ty = to.clone();
        value.is_literal = false;
        match scalar {
            Scalar::Float if self.is_literal => value.text.push_str(".0"),
            Scalar::Uint if self.is_literal && self.bind == bind::SINGLE => value.text.push('u'),
            Scalar::Uint if self.is_literal => {
                value.text = format!("u32({}i)", self.text);
                value.bind = bind::SINGLE;
            }
            _ => {
                value.text = format!("{}({})", to.wgsl(), self.text);
                value.bind = bind::SINGLE;
            }
        }
        Some(value)
    }
}

/// A number as WGSL writes an f32.
pub(super) fn f32_text(number: f64) -> String {
    format!("{:?}", number as f32)
}
