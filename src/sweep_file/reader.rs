//! Checks a document against the table of keys, and hands out typed values with their places.
//!
//! Kind and range of every value are checked once, here; a getter returns `None` for a value that was found
//! wrong, so that whoever builds on it can go on and find more.

use super::diagnostic::{Diagnostic, Place, Report, nearest_name};
use super::document::{Document, Entry, Node, Value};
use super::keys::{self, KEYS, Key, KeyDefault, Kind};

/// A value and its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sited<T> {
    /// The value.
    pub(super) value: T,
    /// Where it stands.
    pub(super) place: Place,
}

/// A document under examination and what was found wrong so far.
#[derive(Debug)]
pub(super) struct Reader {
    document: Document,
    diagnostics: Vec<Diagnostic>,
}

impl Reader {
    /// Checks every key, kind and range, and that required keys are there.
    pub(super) fn new(document: Document) -> Self {
        let mut diagnostics = Vec::new();
        check_table(&document.root, &mut Vec::new(), &mut diagnostics);
        let mut reader = Self {
            document,
            diagnostics,
        };
        for key in KEYS {
            if matches!(key.default, KeyDefault::Required) && !key.path.contains('<') {
                let path: Vec<&str> = key.parts().collect();
                reader.require(&path);
            }
        }
        reader
    }

    /// Reports a finding.
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Whether nothing was found wrong so far.
    pub(super) fn is_clean(&self) -> bool {
        self.diagnostics.is_empty()
    }

    /// Everything found wrong.
    pub(super) fn into_report(self) -> Report {
        Report {
            sources: self.document.sources,
            diagnostics: self.diagnostics,
        }
    }

    /// Reports a key that is missing; it stands nowhere, so its nearest table is shown.
    pub(super) fn require(&mut self, path: &[&str]) {
        if self.document.root.find(path).is_some() {
            return;
        }
        let (Some(key), Some(name)) = (keys::find(path), path.last()) else {
            return;
        };
        let full = path.join(".");
        let tables = (1..path.len()).rev();
        let place = tables
            .filter_map(|length| self.entry(&path[..length]))
            .map(|entry| entry.key_place.clone())
            .next();
        let place = place.unwrap_or_else(|| self.document.root.place.clone());
        let diagnostic = Diagnostic::new(format!("missing key `{full}`"))
            .at(&place, format!("`{name}` is missing here"))
            .allowed(key.kind.words())
            .remedy(format!("add `{full}`: {}", key.meaning));
        self.report(diagnostic);
    }

    /// A key with its value, whatever it is.
    pub(super) fn entry(&self, path: &[&str]) -> Option<&Entry> {
        self.document.root.find(path)
    }

    /// The names in a table, with the places of the keys.
    pub(super) fn names(&self, path: &[&str]) -> Vec<Sited<String>> {
        let entries = self
            .entry(path)
            .map_or(&[][..], |entry| entry.node.entries());
        let name = |entry: &Entry| Sited {
            value: entry.key.clone(),
            place: entry.key_place.clone(),
        };
        entries.iter().map(name).collect()
    }

    /// A node whose kind and range are right.
    fn valid(&self, path: &[&str]) -> Option<&Node> {
        let node = &self.entry(path)?.node;
        let key = keys::find(path)?;
        check_value(key, path, node).is_none().then_some(node)
    }

    fn sited<T>(&self, path: &[&str], convert: fn(&Node) -> Option<T>) -> Option<Sited<T>> {
        let node = self.valid(path)?;
        Some(Sited {
            value: convert(node)?,
            place: node.place.clone(),
        })
    }

    /// A string.
    pub(super) fn text(&self, path: &[&str]) -> Option<Sited<String>> {
        self.sited(path, as_text)
    }

    /// A finite number.
    pub(super) fn number(&self, path: &[&str]) -> Option<Sited<f64>> {
        self.sited(path, as_number)
    }

    /// An integer that fits a size.
    pub(super) fn integer<T: TryFrom<i128>>(&self, path: &[&str]) -> Option<Sited<T>> {
        self.sited(path, |node| match node.value {
            Value::Integer(integer) => T::try_from(integer).ok(),
            _ => None,
        })
    }

    /// A list of numbers, each with its place.
    pub(super) fn numbers(&self, path: &[&str]) -> Option<Vec<Sited<f64>>> {
        self.list(path, as_number)
    }

    /// A list of strings, each with its place.
    pub(super) fn texts(&self, path: &[&str]) -> Option<Vec<Sited<String>>> {
        self.list(path, as_text)
    }

    /// A list of pairs of strings, each pair with its place.
    pub(super) fn pairs(&self, path: &[&str]) -> Option<Vec<Sited<[String; 2]>>> {
        self.list(path, as_pair)
    }

    fn list<T>(&self, path: &[&str], convert: fn(&Node) -> Option<T>) -> Option<Vec<Sited<T>>> {
        let Value::Array(items) = &self.valid(path)?.value else {
            return None;
        };
        let item = |node: &Node| {
            Some(Sited {
                value: convert(node)?,
                place: node.place.clone(),
            })
        };
        items.iter().map(item).collect()
    }
}

fn as_text(node: &Node) -> Option<String> {
    match &node.value {
        Value::Text(text) => Some(text.clone()),
        _ => None,
    }
}

fn as_number(node: &Node) -> Option<f64> {
    match node.value {
        Value::Float(number) if number.is_finite() => Some(number),
        Value::Integer(integer) => Some(integer as f64),
        _ => None,
    }
}

fn as_pair(node: &Node) -> Option<[String; 2]> {
    match &node.value {
        Value::Array(items) => match items.as_slice() {
            [one, other] => Some([as_text(one)?, as_text(other)?]),
            _ => None,
        },
        _ => None,
    }
}

/// Walks a table; `path` holds the names above it.
fn check_table<'n>(node: &'n Node, path: &mut Vec<&'n str>, found: &mut Vec<Diagnostic>) {
    for entry in node.entries() {
        path.push(&entry.key);
        let opens = matches!(entry.node.value, Value::Table(_)) && !below(path).is_empty();
        if let Some(key) = keys::find(path).filter(|_| !opens) {
            found.extend(check_value(key, path, &entry.node));
        } else if !KEYS.iter().any(|key| key.starts_with(path)) {
            found.push(unknown_key(entry, path));
        } else if matches!(entry.node.value, Value::Table(_)) {
            check_table(&entry.node, path, found);
        } else {
            let title = format!("`{}` must be a table", path.join("."));
            let diagnostic = Diagnostic::new(title)
                .at(
                    &entry.node.place,
                    format!("this is {}", entry.node.value.kind()),
                )
                .allowed(format!("a table with the keys {}", below(path).join(", ")));
            found.push(diagnostic);
        }
        path.pop();
    }
}

/// Names that may follow a path, each once, in backquotes where they are not stand-ins.
fn below(path: &[&str]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for key in KEYS.iter().filter(|key| key.starts_with(path)) {
        if let Some(part) = key.parts().nth(path.len()) {
            let name = format!("`{part}`");
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

fn unknown_key(entry: &Entry, path: &[&str]) -> Diagnostic {
    let parent = &path[..path.len() - 1];
    let names = below(parent);
    let plain: Vec<&str> = names.iter().map(|name| name.trim_matches('`')).collect();
    let diagnostic = Diagnostic::new(format!("unknown key `{}`", path.join(".")))
        .at(&entry.key_place, "not a key of a sweep file")
        .nearest(&entry.key, plain.iter().copied());
    if nearest_name(&entry.key, plain).is_some() {
        return diagnostic;
    }
    // Perhaps the right key in the wrong table.
    let elsewhere = KEYS
        .iter()
        .find(|key| key.parts().last() == Some(&entry.key));
    match elsewhere {
        Some(key) => diagnostic.remedy(format!("did you mean `{}`?", key.path)),
        None => diagnostic,
    }
}

/// What is wrong with kind or range of one value; `None` if nothing is.
fn check_value(key: &Key, path: &[&str], node: &Node) -> Option<Diagnostic> {
    let items = match &node.value {
        Value::Array(items) => items.as_slice(),
        _ => &[],
    };
    let is_list = matches!(node.value, Value::Array(_));
    match key.kind {
        Kind::Numbers | Kind::Texts | Kind::Pairs | Kind::Choices(_) if !is_list => {
            Some(wrong(key, path, node))
        }
        Kind::Numbers => each(key, path, items, |item| as_number(item).is_some()),
        Kind::Texts => each(key, path, items, |item| as_text(item).is_some()),
        Kind::Pairs => each(key, path, items, |item| as_pair(item).is_some()),
        Kind::Choices(names) => each(key, path, items, |item| {
            as_text(item).is_some_and(|text| names().contains(&text.as_str()))
        }),
        kind if holds(kind, node) => None,
        _ => Some(wrong(key, path, node)),
    }
}

fn each(
    key: &Key,
    path: &[&str],
    items: &[Node],
    holds: impl Fn(&Node) -> bool,
) -> Option<Diagnostic> {
    let item = items.iter().find(|item| !holds(item))?;
    Some(wrong(key, path, item))
}

/// Whether a single value is of a kind.
fn holds(kind: Kind, node: &Node) -> bool {
    let number = as_number(node);
    let text = as_text(node);
    match kind {
        Kind::Text => text.is_some(),
        Kind::Number(condition) => number.is_some_and(condition.holds),
        Kind::Integer(least, most) => {
            matches!(node.value, Value::Integer(value) if (least..=most).contains(&value))
        }
        Kind::Step => number.is_some_and(|value| value > 0.0) || text.as_deref() == Some("auto"),
        Kind::Choice(names) => text.is_some_and(|text| names().contains(&text.as_str())),
        Kind::Numbers | Kind::Texts | Kind::Pairs | Kind::Choices(_) => false,
    }
}

fn wrong(key: &Key, path: &[&str], node: &Node) -> Diagnostic {
    let shown = match &node.value {
        Value::Text(text) => format!("`{text}`"),
        Value::Integer(value) => format!("`{value}`"),
        Value::Float(value) => format!("`{value}`"),
        other => other.kind().to_owned(),
    };
    let diagnostic = Diagnostic::new(format!("`{}` cannot be {shown}", path.join(".")))
        .at(&node.place, format!("this is {}", node.value.kind()))
        .allowed(key.kind.words());
    match (key.kind, &node.value) {
        (Kind::Choice(names) | Kind::Choices(names), Value::Text(text)) => {
            let allowed = key.kind.words();
            diagnostic.nearest(text, names()).allowed(allowed)
        }
        (Kind::Step, Value::Text(_)) => diagnostic.remedy("did you mean `\"auto\"`?"),
        _ => diagnostic,
    }
}
