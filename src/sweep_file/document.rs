//! The sweep file, and what was set on top of it, as one tree whose keys and values know where they stand.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::diagnostic::{Diagnostic, Place, Sources};
use super::names::quotable;
use super::report::Report;
use super::syntax;
use super::text::{SweepText, Text, too_large};
use super::value::{Entry, SpannedValue, Value};
use crate::formula::language::canonical_name;

/// Most parts of a key that is set; no key has as many.
const MOST_PARTS: usize = 16;

/// A file with what was set on top of it.
#[derive(Debug, Clone)]
pub(super) struct Document {
    /// The texts; the file is number 0.
    pub(super) sources: Sources,
    /// The table at the top.
    pub(super) root: SpannedValue,
    /// That the text is too long and was cut; its beginning can still be examined.
    pub(super) cut: Option<Diagnostic>,
    /// What a person typed, where the text is not that.
    pub(super) typed: Option<SweepText>,
    /// What cannot be read at all.
    broken: Vec<Diagnostic>,
    /// What cannot be read beyond that.
    further: usize,
}

impl Document {
    /// Reads a text.
    pub(super) fn parse(name: &str, text: &Text) -> Self {
        let mut sources = Sources::default();
        let source = sources.add(name, &text.text);
        let (table, errors) = DeTable::parse_recoverable(&text.text);
        let (broken, further) = syntax::findings(&text.text, &errors, source, 0);
        let root = SpannedValue {
            value: Value::Table(convert_table(table.get_ref(), source, 0)),
            place: Place { source, span: 0..0 },
        };
        Self {
            sources,
            root,
            cut: text.is_cut.then(|| too_large(name)),
            typed: None,
            broken,
            further,
        }
    }

    /// Applies `key.path=value`, written like this where `name` says; the value is TOML, or a bare word.
    pub(super) fn set(&mut self, name: &str, argument: &str) {
        let source = self.sources.add(name, argument);
        match parse_setting(name, argument, source) {
            Ok((path, node)) => put(&mut self.root, &path, node),
            Err(mut diagnostics) => self.broken.append(&mut diagnostics),
        }
    }

    /// Takes a section out.
    pub(super) fn remove(&mut self, section: &str) {
        if let Value::Table(entries) = &mut self.root.value {
            entries.retain(|entry| entry.key != section);
        }
    }

    /// The file as it was typed, with what was set on top of it.
    pub(super) fn typed(&self) -> SweepText {
        let mut texts = self.sources.all();
        let (file, text) = texts.next().unwrap_or_default();
        let mut typed = self.typed.clone().unwrap_or_else(|| SweepText {
            file: file.to_owned(),
            text: text.to_owned(),
            set: Vec::new(),
        });
        typed.set.extend(texts.map(|(_, set)| set.to_owned()));
        typed
    }

    /// Everything that cannot be read; `None` where all can.
    pub(super) fn broken(&self) -> Option<Report> {
        let mut diagnostics = self.broken.clone();
        if diagnostics.is_empty() {
            return None;
        }
        diagnostics.extend(self.cut.clone());
        Some(Report::new(self.sources.clone(), diagnostics, self.further))
    }
}

/// Copies a parsed value; `offset` moves its spans (a value that is set stands behind its key).
fn convert(value: &DeValue<'_>, span: Range<usize>, source: usize, offset: usize) -> SpannedValue {
    let child =
        |node: &toml::Spanned<DeValue<'_>>| convert(node.get_ref(), node.span(), source, offset);
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
    let place = Place {
        source,
        span: span.start + offset..span.end + offset,
    };
    SpannedValue {
        value: converted,
        place,
    }
}

fn convert_table(table: &DeTable<'_>, source: usize, offset: usize) -> Vec<Entry> {
    let entries = table.iter().map(|(key, value)| Entry {
        key: key.get_ref().to_string(),
        key_place: Place {
            source,
            span: key.span().start + offset..key.span().end + offset,
        },
        node: convert(value.get_ref(), value.span(), source, offset),
    });
    let mut entries: Vec<Entry> = entries.collect();
    entries.sort_by_key(|entry| entry.key_place.span.start);
    entries
}

/// Puts a value at a path, making tables on the way; what stood there is replaced.
fn put(node: &mut SpannedValue, path: &[(String, Place)], value: SpannedValue) {
    let Some(((key, key_place), rest)) = path.split_first() else {
        *node = value;
        return;
    };
    if !matches!(node.value, Value::Table(_)) {
        node.value = Value::Table(Vec::new());
        node.place = key_place.clone();
    }
    let Value::Table(entries) = &mut node.value else {
        return;
    };
    let known = entries.iter().position(|entry| entry.key == *key);
    // A name that the file spells in another way is the same name.
    let known = known.or_else(|| {
        let is_same = |entry: &Entry| canonical_name(&entry.key) == canonical_name(key);
        entries.iter().position(is_same)
    });
    let index = known.unwrap_or(entries.len());
    if known.is_none() {
        entries.push(Entry {
            key: key.clone(),
            key_place: key_place.clone(),
            node: SpannedValue {
                value: Value::Table(Vec::new()),
                place: key_place.clone(),
            },
        });
    }
    if rest.is_empty() {
        entries[index].key_place = key_place.clone();
    }
    put(&mut entries[index].node, rest, value);
}

/// The keys of a path, each with its place.
type KeyPath = Vec<(String, Place)>;

/// Splits `key.path=value`.
fn parse_setting(
    name: &str,
    argument: &str,
    source: usize,
) -> Result<(KeyPath, SpannedValue), Vec<Diagnostic>> {
    let whole = Place {
        source,
        span: 0..argument.len(),
    };
    let broken = |label: &str| {
        let shown = quotable(argument);
        let diagnostic = Diagnostic::new(format!("`{name} {shown}` does not parse"))
            .at(&whole, label)
            .allowed("KEY=VALUE with a key of the sweep file, such as `sweep.points=301`");
        vec![diagnostic]
    };
    let (keys, text) = argument
        .split_once('=')
        .ok_or_else(|| broken("no `=` here"))?;
    let path = parse_path(keys, source).map_err(broken)?;
    if text.trim().is_empty() {
        return Err(broken("no value behind `=`"));
    }
    let offset = argument.len() - text.trim_start().len();
    let text = text.trim();
    let (value, errors) = DeValue::parse_recoverable(text);
    if errors.is_empty() {
        let node = convert(value.get_ref(), value.span(), source, offset);
        return Ok((path, node));
    }
    // A word without TOML's punctuation saves the user a second layer of quotes.
    if text.contains(['[', ']', '{', '}', '"', '\'', ',', '=', '#']) {
        return Err(syntax::findings(text, &errors, source, offset).0);
    }
    let place = Place {
        source,
        span: offset..offset + text.len(),
    };
    let value = Value::Text(text.to_owned());
    Ok((path, SpannedValue { value, place }))
}

/// Splits `key.path`, or says what is wrong with it.
fn parse_path(keys: &str, source: usize) -> Result<KeyPath, &'static str> {
    let mut path = Vec::new();
    let mut start = 0;
    for key in keys.split('.') {
        let span = start..start + key.len();
        start += key.len() + 1;
        if key.trim().is_empty() {
            return Err("an empty key");
        }
        if path.len() == MOST_PARTS {
            return Err("no key has as many parts");
        }
        path.push((key.trim().to_owned(), Place { source, span }));
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str, settings: &[&str]) -> Document {
        let mut document = Document::parse("a.toml", &Text::beginning(text));
        for setting in settings {
            document.set("--set", setting);
        }
        document
    }

    #[test]
    fn places_are_those_of_the_text() {
        let text = "[cells]\nx = { from = -1, to = 0x10 }\n";
        let document = parse(text, &[]);
        let to = document.root.find(&["cells", "x", "to"]).unwrap();
        assert_eq!(to.node.value, Value::Integer(16));
        assert_eq!(&text[to.node.place.span.clone()], "0x10");
        assert_eq!(&text[to.key_place.span.clone()], "to");
        assert!(document.broken().is_none());
    }

    #[test]
    fn what_is_set_replaces_and_adds() {
        let text = "[sweep]\npoints = 3\n";
        let settings = [
            "sweep.points=7",
            "method.map_step=auto",
            "sweep.from = -1.5",
        ];
        let document = parse(text, &settings);
        let value = |path: &[&str]| document.root.find(path).unwrap().node.clone();
        assert_eq!(value(&["sweep", "points"]).value, Value::Integer(7));
        assert_eq!(
            value(&["method", "map_step"]).value,
            Value::Text("auto".to_owned())
        );
        let from = value(&["sweep", "from"]);
        assert_eq!(from.value, Value::Float(-1.5));
        assert_eq!(&settings[2][from.place.span], "-1.5");
    }

    #[test]
    fn broken_settings_and_syntax_are_all_reported() {
        let many_parts = format!("a{}=1", ".a".repeat(100_000));
        let settings = ["points", ".a=1", "a=[1", "a=", &many_parts];
        let report = parse("title = \n", &settings).broken().unwrap();
        assert_eq!(report.diagnostics().len(), 6);
        let text = report.to_string();
        assert!(
            text.contains("a.toml:1") && text.contains("--set:1"),
            "{text}"
        );
        assert!(text.len() < 5000, "{text}");
    }
}
