//! The sweep file and the `--set` arguments as one tree whose keys and values know where they stand.

use std::ops::Range;
use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::diagnostic::{Diagnostic, Place, Report, Sources};

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
    Array(Vec<Node>),
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
pub(super) struct Node {
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
    pub(super) node: Node,
}

impl Node {
    /// The entries of a table; none for anything else.
    pub(super) fn entries(&self) -> &[Entry] {
        match &self.value {
            Value::Table(entries) => entries,
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

    /// Copies a parsed value; `offset` moves its spans (a `--set` value stands behind its key).
    fn convert(value: &DeValue<'_>, span: Range<usize>, source: usize, offset: usize) -> Self {
        let child = |node: &toml::Spanned<DeValue<'_>>| {
            Self::convert(node.get_ref(), node.span(), source, offset)
        };
        let converted = match value {
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix())
                .map_or(
                    Value::Other("an integer too large to be read"),
                    Value::Integer,
                ),
            DeValue::Float(float) => float
                .as_str()
                .parse()
                .map_or(Value::Other("a number that cannot be read"), Value::Float),
            DeValue::Boolean(_) => Value::Other("a boolean"),
            DeValue::Datetime(_) => Value::Other("a date"),
            DeValue::Array(items) => Value::Array(items.iter().map(child).collect()),
            DeValue::Table(table) => Value::Table(convert_table(table, source, offset)),
        };
        Self {
            value: converted,
            place: Place {
                source,
                span: span.start + offset..span.end + offset,
            },
        }
    }

    /// Puts a value at a path, making tables on the way; what stood there is replaced.
    fn put(&mut self, path: &[(String, Place)], node: Node) {
        let Some(((key, key_place), rest)) = path.split_first() else {
            *self = node;
            return;
        };
        if !matches!(self.value, Value::Table(_)) {
            self.value = Value::Table(Vec::new());
            self.place = key_place.clone();
        }
        let Value::Table(entries) = &mut self.value else {
            return;
        };
        let known = entries.iter().position(|entry| entry.key == *key);
        let index = known.unwrap_or(entries.len());
        if known.is_none() {
            entries.push(Entry {
                key: key.clone(),
                key_place: key_place.clone(),
                node: Node {
                    value: Value::Table(Vec::new()),
                    place: key_place.clone(),
                },
            });
        }
        if rest.is_empty() {
            entries[index].key_place = key_place.clone();
        }
        entries[index].node.put(rest, node);
    }
}

fn convert_table(table: &DeTable<'_>, source: usize, offset: usize) -> Vec<Entry> {
    let entries = table.iter().map(|(key, value)| Entry {
        key: key.get_ref().to_string(),
        key_place: Place {
            source,
            span: key.span().start + offset..key.span().end + offset,
        },
        node: Node::convert(value.get_ref(), value.span(), source, offset),
    });
    let mut entries: Vec<Entry> = entries.collect();
    entries.sort_by_key(|entry| entry.key_place.span.start);
    entries
}

/// A file with its overrides applied.
#[derive(Debug, Clone)]
pub(super) struct Document {
    /// The texts.
    pub(super) sources: Sources,
    /// The table at the top.
    pub(super) root: Node,
}

impl Document {
    /// Reads a file and applies `KEY=VALUE` arguments in their order.
    ///
    /// # Errors
    /// A report of everything that cannot be read.
    pub(super) fn read(file: &Path, overrides: &[String]) -> Result<Self, Report> {
        let name = file.display().to_string();
        let bytes = std::fs::read(file).map_err(|error| {
            let finding = Diagnostic::new(format!("cannot read the sweep file `{name}`: {error}"));
            finding.remedy("check the path; `sweeps/` holds examples")
        })?;
        let text = String::from_utf8(bytes)
            .map_err(|_| Diagnostic::new(format!("the sweep file `{name}` is not UTF-8 text")))?;
        Self::parse(&name, &text, overrides)
    }

    /// As [`Document::read`], of a text.
    pub(super) fn parse(name: &str, text: &str, overrides: &[String]) -> Result<Self, Report> {
        let mut sources = Sources::default();
        let source = sources.add(name, text);
        let (table, errors) = DeTable::parse_recoverable(text);
        let mut diagnostics: Vec<Diagnostic> = errors
            .iter()
            .map(|error| syntax_error(error.message(), error.span(), source, 0))
            .collect();
        let mut root = Node {
            value: Value::Table(convert_table(table.get_ref(), source, 0)),
            place: Place { source, span: 0..0 },
        };
        for argument in overrides {
            let source = sources.add("--set", argument);
            match parse_override(argument, source) {
                Ok((path, node)) => root.put(&path, node),
                Err(diagnostic) => diagnostics.push(*diagnostic),
            }
        }
        if diagnostics.is_empty() {
            return Ok(Self { sources, root });
        }
        Err(Report {
            sources,
            diagnostics,
        })
    }
}

fn syntax_error(
    message: &str,
    span: Option<Range<usize>>,
    source: usize,
    offset: usize,
) -> Diagnostic {
    let span = span.unwrap_or(0..0);
    let place = Place {
        source,
        span: span.start + offset..span.end + offset,
    };
    Diagnostic::new(format!("not valid TOML: {message}")).at(&place, message)
}

/// The keys of a path, each with its place.
type KeyPath = Vec<(String, Place)>;

/// Splits `key.path=value`; the value is TOML, or a bare word.
fn parse_override(argument: &str, source: usize) -> Result<(KeyPath, Node), Box<Diagnostic>> {
    let whole = Place {
        source,
        span: 0..argument.len(),
    };
    let broken = |label: &str| {
        let diagnostic = Diagnostic::new(format!("`--set {argument}` does not parse"))
            .at(&whole, label)
            .allowed("KEY=VALUE with a key of the sweep file, such as `sweep.points=301`");
        Box::new(diagnostic)
    };
    let (keys, text) = argument
        .split_once('=')
        .ok_or_else(|| broken("no `=` here"))?;
    let mut path = Vec::new();
    let mut start = 0;
    for key in keys.split('.') {
        let span = start..start + key.len();
        start += key.len() + 1;
        if key.trim().is_empty() {
            return Err(broken("an empty key"));
        }
        path.push((key.trim().to_owned(), Place { source, span }));
    }
    if text.trim().is_empty() {
        return Err(broken("no value behind `=`"));
    }
    let offset = argument.len() - text.trim_start().len();
    let text = text.trim();
    match DeValue::parse(text) {
        Ok(value) => Ok((
            path,
            Node::convert(value.get_ref(), value.span(), source, offset),
        )),
        // A word without TOML's punctuation saves the user a second layer of quotes.
        Err(_) if !text.contains(['[', ']', '{', '}', '"', '\'', ',', '=', '#']) => {
            let place = Place {
                source,
                span: offset..offset + text.len(),
            };
            let value = Value::Text(text.to_owned());
            Ok((path, Node { value, place }))
        }
        Err(error) => {
            let diagnostic = syntax_error(error.message(), error.span(), source, offset);
            Err(Box::new(diagnostic))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, overrides: &[&str]) -> Result<Document, Report> {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        Document::parse("a.toml", text, &overrides)
    }

    #[test]
    fn places_are_those_of_the_text() {
        let text = "[cells]\nx = { from = -1, to = 0x10 }\n";
        let document = parse(text, &[]).unwrap();
        let to = document.root.find(&["cells", "x", "to"]).unwrap();
        assert_eq!(to.node.value, Value::Integer(16));
        assert_eq!(&text[to.node.place.span.clone()], "0x10");
        assert_eq!(&text[to.key_place.span.clone()], "to");
    }

    #[test]
    fn overrides_replace_and_add() {
        let text = "[sweep]\npoints = 3\n";
        let overrides = [
            "sweep.points=7",
            "method.map_step=auto",
            "sweep.from = -1.5",
        ];
        let document = parse(text, &overrides).unwrap();
        let value = |path: &[&str]| document.root.find(path).unwrap().node.clone();
        assert_eq!(value(&["sweep", "points"]).value, Value::Integer(7));
        assert_eq!(
            value(&["method", "map_step"]).value,
            Value::Text("auto".to_owned())
        );
        let from = value(&["sweep", "from"]);
        assert_eq!(from.value, Value::Float(-1.5));
        assert_eq!(&overrides[2][from.place.span], "-1.5");
    }

    #[test]
    fn broken_overrides_and_syntax_are_all_reported() {
        let overrides = ["points", ".a=1", "a=[1", "a="];
        let report = parse("title = \n", &overrides).unwrap_err();
        assert_eq!(report.diagnostics.len(), 5);
        let text = report.render(false);
        assert!(
            text.contains("a.toml:1") && text.contains("--set:1"),
            "{text}"
        );
    }
}
