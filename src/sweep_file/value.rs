//! Values: as they stand in a document, with their places, and plain, as keys take and give them.

use super::diagnostic::Place;

/// A value of TOML.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    /// A string.
    Text(String),
    /// An integer; wider than TOML's, so that too large ones can be named.
    Integer(i128),
    /// A float, possibly not finite.
    Float(f64),
    /// An array.
    Array(Vec<SpannedValue>),
    /// A table.
    Table(Vec<Entry>),
    /// Booleans, dates, and numbers too large for a number: nothing in a sweep file is one.
    Other(&'static str),
}

impl Value {
    /// What kind of value it is, in words.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Text(_) => "a string",
            Self::Integer(_) => "an integer",
            Self::Float(_) => "a number",
            Self::Array(_) => "a list",
            Self::Table(_) => "a table",
            Self::Other(kind) => kind,
        }
    }
}

/// A value and its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SpannedValue {
    /// The value.
    pub(super) value: Value,
    /// Where it stands.
    pub(super) place: Place,
}

/// A key of a table with its value.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Entry {
    /// The key.
    pub(super) key: String,
    /// Where the key stands.
    pub(super) key_place: Place,
    /// The value.
    pub(super) node: SpannedValue,
}

impl SpannedValue {
    /// The entries of a table; none for anything else.
    pub(super) fn entries(&self) -> &[Entry] {
        match &self.value {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    /// The items of a list; none for anything else.
    pub(super) fn items(&self) -> &[Self] {
        match &self.value {
            Value::Array(items) => items,
            _ => &[],
        }
    }

    /// The node at a path of keys, with the place of its last key.
    pub(super) fn find(&self, path: &[&str]) -> Option<&Entry> {
        let (first, rest) = path.split_first()?;
        let entry = self.entries().iter().find(|entry| entry.key == *first)?;
        if rest.is_empty() {
            Some(entry)
        } else {
            entry.node.find(rest)
        }
    }

    /// The value without its place; `None` for tables and what no key takes.
    pub(super) fn plain(&self) -> Option<Plain> {
        Some(match &self.value {
            Value::Text(text) => Plain::Text(text.clone()),
            Value::Integer(integer) => Plain::Integer(*integer),
            Value::Float(number) => Plain::Number(*number),
            Value::Array(items) => {
                Plain::List(items.iter().map(Self::plain).collect::<Option<_>>()?)
            }
            Value::Table(_) | Value::Other(_) => return None,
        })
    }
}

/// A value as a key takes and gives it.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Plain {
    /// A string.
    Text(String),
    /// An integer.
    Integer(i128),
    /// A number.
    Number(f64),
    /// A list.
    List(Vec<Self>),
}

impl Plain {
    /// The number, of integers too; `None` for anything that is none or not finite.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(integer) => Some(*integer as f64),
            Self::Number(number) => number.is_finite().then_some(*number),
            Self::Text(_) | Self::List(_) => None,
        }
    }

    /// The string, if it is one.
    pub(super) fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The items, if it is a list.
    pub(super) fn items(&self) -> Option<&[Self]> {
        match self {
            Self::List(items) => Some(items),
            _ => None,
        }
    }

    /// As TOML; numbers have the digits that give the same bits again.
    pub(super) fn to_toml(&self) -> String {
        match self {
            Self::Text(text) => toml::Value::String(text.clone()).to_string(),
            Self::Integer(integer) => integer.to_string(),
            Self::Number(number) => format!("{number:?}"),
            Self::List(items) => {
                let items: Vec<String> = items.iter().map(Self::to_toml).collect();
                format!("[{}]", items.join(", "))
            }
        }
    }
}
