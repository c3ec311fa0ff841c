//! TOML read key by key, with the place of everything.
//!
//! A [`Table`] remembers which keys were asked for; [`Table::finish`] refuses the rest, so that no
//! misspelt key is silently ignored. Every manifest, scene and recipe is read through this, and
//! their messages have one form.

use std::cell::RefCell;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::problem::{Problem, Result};

/// A TOML text under the name that its messages give it.
#[derive(Debug, Clone, Copy)]
pub struct Document<'a> {
    /// The file's name as messages show it.
    pub file: &'a str,
    /// The whole text.
    pub source: &'a str,
}

impl<'a> Document<'a> {
    /// Parses the text and hands its root table to `read`; keys that `read` did not ask for are errors.
    pub fn read<T>(self, read: impl FnOnce(&Table<'_>) -> Result<T>) -> Result<T> {
        let root = DeTable::parse(self.source).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            let reason = error.message().replace('\n', ", ");
            let twice = reason.starts_with("duplicate key");
            self.problem(
                span,
                reason,
                if twice { "rename or remove one" } else { "write valid TOML" },
            )
        })?;
        let table = Table::new(self, String::new(), 0..0, root.get_ref());
        let value = read(&table)?;
        table.finish()?;
        Ok(value)
    }

    /// A problem at a byte range of this text.
    pub fn problem(
        &self,
        span: Range<usize>,
        reason: impl Into<String>,
        cure: impl Into<String>,
    ) -> Problem {
        Problem::at(self.file, self.source, span, reason, cure)
    }
}

/// One table of a [`Document`].
pub struct Table<'a> {
    document: Document<'a>,
    name: String,
    span: Range<usize>,
    table: &'a DeTable<'a>,
    asked: RefCell<Vec<String>>,
}

/// One value, with its place and the path of its key.
#[derive(Clone)]
pub struct Value<'a> {
    document: Document<'a>,
    path: String,
    value: &'a Spanned<DeValue<'a>>,
}

/// A key and its value, for tables whose keys are names that the author chose.
pub struct Entry<'a> {
    /// The key.
    pub key: String,
    /// Where the key stands.
    pub key_span: Range<usize>,
    /// Its value.
    pub value: Value<'a>,
}

impl<'a> Table<'a> {
    fn new(
        document: Document<'a>,
        name: String,
        span: Range<usize>,
        table: &'a DeTable<'a>,
    ) -> Self {
        Self { document, name, span, table, asked: RefCell::default() }
    }

    /// Where the table's header stands.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// The value of `key`, if it is there.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        self.asked.borrow_mut().push(key.to_owned());
        let value = self.table.get(key)?;
        Some(Value { document: self.document, path: self.path_of(key), value })
    }

    /// The value of `key`, or a problem that says what it would mean.
    pub fn require(&self, key: &str, meaning: &str) -> Result<Value<'a>> {
        self.get(key).ok_or_else(|| {
            let place =
                if self.name.is_empty() { String::new() } else { format!(" in [{}]", self.name) };
            self.document.problem(
                self.span(),
                format!("the key `{key}` is missing{place}"),
                format!("add it: {meaning}"),
            )
        })
    }

    /// Every key of the table in the order of the text; all count as asked for.
    pub fn entries(&self) -> Vec<Entry<'a>> {
        let mut entries: Vec<_> = self
            .table
            .iter()
            .map(|(key, value)| Entry {
                key: key.get_ref().to_string(),
                key_span: key.span(),
                value: Value { document: self.document, path: self.path_of(key.get_ref()), value },
            })
            .collect();
        entries.sort_by_key(|entry| entry.key_span.start);
        self.asked.borrow_mut().extend(entries.iter().map(|entry| entry.key.clone()));
        entries
    }

    /// Refuses keys that nobody asked for.
    pub fn finish(&self) -> Result<()> {
        let asked = self.asked.borrow();
        let mut unknown: Vec<_> = self
            .table
            .keys()
            .filter(|key| !asked.iter().any(|known| known == key.get_ref().as_ref()))
            .collect();
        unknown.sort_by_key(|key| key.span().start);
        let Some(key) = unknown.first() else { return Ok(()) };
        let place =
            if self.name.is_empty() { String::new() } else { format!(" in [{}]", self.name) };
        Err(self.document.problem(
            key.span(),
            format!("unknown key `{}`{place}", key.get_ref()),
            suggestion(key.get_ref(), asked.iter().map(String::as_str)),
        ))
    }

    /// A problem at a byte range of the table's text.
    pub fn problem(
        &self,
        span: Range<usize>,
        reason: impl Into<String>,
        cure: impl Into<String>,
    ) -> Problem {
        self.document.problem(span, reason, cure)
    }

    fn path_of(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }
}

impl<'a> Value<'a> {
    /// Where the value stands.
    pub fn span(&self) -> Range<usize> {
        self.value.span()
    }

    /// A problem with this value.
    pub fn problem(&self, reason: impl Into<String>, cure: impl Into<String>) -> Problem {
        self.document.problem(self.span(), reason, cure)
    }

    /// A text.
    pub fn string(&self) -> Result<String> {
        match self.value.get_ref() {
            DeValue::String(text) => Ok(text.to_string()),
            _ => Err(self.wrong_type("a text in quotes")),
        }
    }

    /// `true` or `false`.
    pub fn boolean(&self) -> Result<bool> {
        match self.value.get_ref() {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(self.wrong_type("true or false")),
        }
    }

    /// A whole number.
    pub fn integer(&self) -> Result<i64> {
        match self.value.get_ref() {
            DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
                .map_err(|_| {
                    self.problem("this number does not fit 64 bits", "write a smaller one")
                }),
            _ => Err(self.wrong_type("a whole number")),
        }
    }

    /// A finite number, with or without a decimal point.
    pub fn number(&self) -> Result<f64> {
        let number = match self.value.get_ref() {
            DeValue::Float(number) => number.as_str().parse::<f64>().ok(),
            DeValue::Integer(_) => Some(self.integer()? as f64),
            _ => return Err(self.wrong_type("a number")),
        };
        number
            .filter(|number| number.is_finite())
            .ok_or_else(|| self.problem("this is no finite number", "write a finite number"))
    }

    /// Exactly `N` finite numbers.
    pub fn numbers<const N: usize>(&self) -> Result<[f64; N]> {
        let items = self.items().map_err(|_| self.wrong_type(&format!("a list of {N} numbers")))?;
        if items.len() != N {
            return Err(self.problem(
                format!("`{}` has {} entries", self.path, items.len()),
                format!("write a list of {N} numbers"),
            ));
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(&items) {
            *number = item.number()?;
        }
        Ok(numbers)
    }

    /// The entries of a list.
    pub fn items(&self) -> Result<Vec<Value<'a>>> {
        match self.value.get_ref() {
            DeValue::Array(items) => Ok(items
                .iter()
                .map(|value| Value { document: self.document, path: self.path.clone(), value })
                .collect()),
            _ => Err(self.wrong_type("a list in brackets")),
        }
    }

    /// A list of texts.
    pub fn strings(&self) -> Result<Vec<String>> {
        self.items()?.iter().map(Value::string).collect()
    }

    /// A table.
    pub fn table(&self) -> Result<Table<'a>> {
        match self.value.get_ref() {
            DeValue::Table(table) => {
                Ok(Table::new(self.document, self.path.clone(), self.value.span(), table))
            }
            _ => Err(self.wrong_type("a table")),
        }
    }

    fn wrong_type(&self, wanted: &str) -> Problem {
        let found = match self.value.get_ref() {
            DeValue::String(_) => "a text",
            DeValue::Integer(_) => "a whole number",
            DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        };
        self.problem(format!("`{}` is {found}", self.path), format!("write {wanted}"))
    }
}

/// The cure for a misspelt name: the closest known one, or all of them.
pub fn suggestion<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let mut known: Vec<_> = known.collect();
    known.sort_unstable();
    known.dedup();
    let closest = known
        .iter()
        .map(|candidate| (strsim::damerau_levenshtein(name, candidate), candidate))
        .min()
        .filter(|(distance, candidate)| *distance <= 2.max(candidate.len() / 3));
    match closest {
        Some((_, candidate)) => format!("did you mean `{candidate}`?"),
        None if known.is_empty() => "remove it".to_owned(),
        None => format!("known are: {}", known.join(", ")),
    }
}
