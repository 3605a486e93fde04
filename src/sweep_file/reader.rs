//! Checks a document against the keys and fills a [`Draft`] from it; gathers what is wrong.
//!
//! Kind and range of every value are checked once, here. A value that is wrong does not reach the draft, so that
//! whoever builds on the draft can go on and find more.

use super::diagnostic::{Diagnostic, Place};
use super::document::Document;
use super::draft::Draft;
use super::keys::{self, KEYS, Key, KeyDefault, Kind, models};
use super::names::{nearest_name, quotable};
use super::report::Report;
use super::value::{Entry, Plain, SpannedValue, Value};
use crate::figure::FigureWidth;

/// A document under examination and what was found so far.
#[derive(Debug)]
pub(super) struct Reader<'d> {
    document: &'d Document,
    errors: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
}

impl<'d> Reader<'d> {
    /// Checks every key, kind and range, and that required keys are there; what is right is in the draft.
    pub(super) fn new(document: &'d Document) -> (Self, Draft) {
        let mut draft = Draft::default();
        let mut errors: Vec<Diagnostic> = document.cut.iter().cloned().collect();
        check_table(&document.root, &mut Vec::new(), &mut draft, &mut errors);
        let mut reader = Self {
            document,
            errors,
            warnings: Vec::new(),
        };
        for key in KEYS {
            if matches!(key.default, KeyDefault::Required) && !key.path().contains('<') {
                let path: Vec<&str> = key.parts().collect();
                reader.require(&path);
            }
        }
        (reader, draft)
    }

    /// What is examined.
    pub(super) fn document(&self) -> &'d Document {
        self.document
    }

    /// Reports an error.
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.errors.push(diagnostic);
    }

    /// Reports what a user should know.
    pub(super) fn warn(&mut self, diagnostic: Diagnostic) {
        self.warnings.push(diagnostic);
    }

    /// Whether nothing was found wrong so far.
    pub(super) fn is_clean(&self) -> bool {
        self.errors.is_empty()
    }

    /// Everything found wrong.
    pub(super) fn into_report(self) -> Report {
        Report::new(self.document.sources.clone(), self.errors, 0)
    }

    /// What a user should know.
    pub(super) fn into_warnings(self) -> Report {
        Report::new(self.document.sources.clone(), self.warnings, 0)
    }

    /// Reports a key that is missing; it stands nowhere, so its nearest table is shown.
    pub(super) fn require(&mut self, path: &[&str]) {
        // What is missing may stand in the part that was cut off.
        if self.entry(path).is_some() || self.document.cut.is_some() {
            return;
        }
        let (Some(key), Some(name)) = (keys::find(path), path.last()) else {
            return;
        };
        let full = path.join(".");
        let mut tables = (1..path.len()).rev();
        let table = tables.find_map(|length| self.entry(&path[..length]));
        let place = match table {
            Some(entry) => &entry.key_place,
            None => &self.document.root.place,
        };
        let diagnostic = Diagnostic::new(format!("missing key `{full}`"))
            .at(place, format!("`{name}` is missing here"))
            .allowed(key.allowed())
            .remedy(format!("add `{full}`: {}", key.meaning()));
        self.report(diagnostic);
    }

    /// A key with its value, whatever it is.
    pub(super) fn entry(&self, path: &[&str]) -> Option<&'d Entry> {
        self.document.root.find(path)
    }

    /// Where the value of a key stands.
    pub(super) fn place(&self, path: &[&str]) -> Option<&'d Place> {
        self.entry(path).map(|entry| &entry.node.place)
    }

    /// Where the name of a key stands.
    pub(super) fn key_place(&self, path: &[&str]) -> Option<&'d Place> {
        self.entry(path).map(|entry| &entry.key_place)
    }

    /// The entries of a table.
    pub(super) fn entries(&self, path: &[&str]) -> &'d [Entry] {
        self.entry(path).map_or(&[], |entry| entry.node.entries())
    }

    /// The items of a list, with their places.
    pub(super) fn items(&self, path: &[&str]) -> &'d [SpannedValue] {
        self.entry(path).map_or(&[], |entry| entry.node.items())
    }
}

/// Walks a table; `path` holds the names above it.
fn check_table<'n>(
    node: &'n SpannedValue,
    path: &mut Vec<&'n str>,
    draft: &mut Draft,
    found: &mut Vec<Diagnostic>,
) {
    for entry in node.entries() {
        path.push(&entry.key);
        let is_table = matches!(entry.node.value, Value::Table(_));
        // A key may stand for a value or for a table: then the value decides.
        let opens = is_table && !below(path).is_empty();
        if let Some(nameless) = nameless_passage(entry, path) {
            found.push(nameless);
            path.pop();
            // One name helps all keys.
            return;
        }
        if let Some(key) = keys::find(path).filter(|_| !opens) {
            match value_of(key, path, &entry.node) {
                Ok(plain) => (key.field.set)(draft, &key.name_in(path), &plain),
                Err(wrong) => found.push(*wrong),
            }
        } else if !KEYS.iter().any(|key| key.starts_with(path)) {
            found.push(unknown_key(entry, path));
        } else if is_table {
            check_table(&entry.node, path, draft, found);
        } else {
            // Of an axis the number of cells is enough (see `respell.rs`).
            let number = match path.as_slice() {
                ["cells", _] => ", or a whole number of cells",
                _ => "",
            };
            let title = format!("`{}` must be a table{number}", path.join("."));
            let diagnostic = Diagnostic::new(title)
                .at(
                    &entry.node.place,
                    format!("this is {}", entry.node.value.kind()),
                )
                .allowed(format!(
                    "a table with the keys {}{number}",
                    below(path).join(", ")
                ))
                .remedy(format!(
                    "write [{}] on a line of its own, and below it a line `{} = ...` for each",
                    path.join("."),
                    below(path)
                        .first()
                        .map_or("<key>", |name| name.trim_matches('`'))
                ));
            found.push(diagnostic);
        }
        path.pop();
    }
}

/// What is said of a noise that is given as a table.
const NOISE_KINDS: &str = "an axis has its amplitude alone, as in `x = \"sqrt(2 D)\"`; what kind all noises are is said \
                           once, by `kind = \"ornstein-uhlenbeck\"` in [system.noise] (docs/coloured-noise.md)";

/// What is wrong with `[passage]` where keys of a passage stand right in it, before any name.
fn nameless_passage(entry: &Entry, path: &[&str]) -> Option<Diagnostic> {
    let keys = below(&["passage", "<passage>"]);
    let is_key = |name: &str| keys.iter().any(|key| key.trim_matches('`') == name);
    let holds_keys = entry.node.entries().iter().any(|one| is_key(&one.key));
    if path.len() != 2 || path[0] != "passage" || !is_key(&entry.key) || holds_keys {
        return None;
    }
    let title = format!(
        "`{}` stands in [passage] itself, and not in a passage",
        entry.key
    );
    let found = Diagnostic::new(title)
        .at(&entry.key_place, "a passage has a name")
        .allowed(format!("a table for each passage with the keys {}", keys.join(", ")))
        .remedy(
            "write [passage.out] in place of [passage]; `out` is any name, after which columns such as `out_mean` are called",
        );
    Some(found)
}

/// Names that may follow a path, each once, in backquotes.
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

/// Names that are tried at the top or beside the system for what is said in another way, and how it is said.
const SAID_ELSEWHERE: [(&[&str], &str); 3] = [
    (
        &["angle", "angles", "periodic", "wrap"],
        "an angle is an axis with the bound \"periodic\", as in `[system.bounds]` with `theta = \"periodic\"` (docs/angles.md)",
    ),
    (
        &["forcing", "force", "drive", "driving"],
        "a force that depends on time is written into the equations with `t`, as in `f cos(omega t)` (docs/forcing.md)",
    ),
    (
        &["definition", "definitions", "functions"],
        "names for parts of formulas stand in `[system.define]`, as in `r = \"x^2 + y^2\"` (docs/formulas.md)",
    ),
];

fn unknown_key(entry: &Entry, path: &[&str]) -> Diagnostic {
    let parent = &path[..path.len() - 1];
    let names = below(parent);
    let plain: Vec<&str> = names.iter().map(|name| name.trim_matches('`')).collect();
    let title = format!("unknown key `{}`", quotable(&path.join(".")));
    let diagnostic = Diagnostic::new(title).at(&entry.key_place, "not a key of a sweep file");
    let of_the_system = matches!(parent, [] | ["system" | "cells" | "sweep", ..]);
    let mut elsewhere = SAID_ELSEWHERE.iter().filter(|_| of_the_system);
    if let Some((_, remedy)) = elsewhere.find(|one| one.0.contains(&entry.key.as_str())) {
        return diagnostic.allowed(names.join(", ")).remedy(*remedy);
    }
    // The very name of a table says more than likeness does.
    if let Some(table) = table_by_name(&entry.key) {
        return diagnostic.remedy(format!("did you mean `{table}`?"));
    }
    let diagnostic = diagnostic.nearest(&entry.key, plain.iter().copied());
    if nearest_name(&entry.key, plain).is_some() {
        return diagnostic;
    }
    // Perhaps the right key in the wrong table: of the same axis, if it is one of an axis.
    let place = parent.len().saturating_sub(1);
    let mut here = KEYS.iter().filter(|key| key.starts_with(parent));
    let holder = here.find_map(|key| key.parts().nth(place).filter(|part| part.starts_with('<')));
    let named = || {
        KEYS.iter()
            .filter(|key| key.parts().last() == Some(&entry.key))
    };
    let of_same = |key: &&Key| holder.is_some_and(|holder| key.parts().any(|part| part == holder));
    let elsewhere = named().find(of_same).or_else(|| named().next());
    let remedy = elsewhere.map(|key| {
        let path = match (holder, parent.last()) {
            (Some(holder), Some(name)) => key.path().replace(holder, name),
            _ => key.path().to_owned(),
        };
        format!("did you mean `{path}`?")
    });
    diagnostic.advice(None, remedy)
}

/// The path of a table inside another that has a name.
fn table_by_name(name: &str) -> Option<String> {
    let prefix = |key: &Key| {
        let at = key.parts().position(|part| part == name)?;
        let is_table = key.parts().nth(at + 1).is_some();
        is_table.then(|| key.parts().take(at + 1).collect::<Vec<_>>().join("."))
    };
    KEYS.iter().find_map(prefix)
}

/// The value of a key, or what is wrong with its kind or range; of a list, with its first wrong item.
fn value_of(key: &Key, path: &[&str], node: &SpannedValue) -> Result<Plain, Box<Diagnostic>> {
    if let Some(plain) = node.plain().filter(|plain| key.kind.holds(plain)) {
        return Ok(plain);
    }
    let (kind, blamed) = match (key.kind, &node.value) {
        (Kind::List(kind), Value::Array(items)) => {
            let is_wrong =
                |item: &&SpannedValue| item.plain().is_none_or(|plain| !kind.holds(&plain));
            (*kind, items.iter().find(is_wrong).unwrap_or(node))
        }
        (Kind::Bounds, Value::Array(items)) => {
            let is_end = |item: &SpannedValue| item.plain().and_then(|one| keys::end_of(&one));
            let other = match &items[..] {
                [one, other] if is_end(other).is_some() => Some(one),
                [one, other] if is_end(one).is_some() => Some(other),
                _ => None,
            };
            (key.kind, other.unwrap_or(node))
        }
        (kind, _) => (kind, node),
    };
    let shown = match &blamed.value {
        Value::Text(text) => format!("`{}`", quotable(text)),
        Value::Integer(value) => format!("`{value}`"),
        Value::Float(value) if value.is_infinite() => "as large as that".to_owned(),
        Value::Float(value) => format!("`{value:?}`"),
        other => other.kind().to_owned(),
    };
    let title = format!("`{}` cannot be {shown}", quotable(&path.join(".")));
    let diagnostic = Diagnostic::new(title)
        .at(&blamed.place, format!("this is {}", blamed.value.kind()))
        .allowed(key.allowed());
    if let Some(number) = quoted_number(kind, blamed) {
        // TOML has no numbers that begin with the point.
        let unsigned = number.trim_start_matches(['-', '+']);
        let sign = if number.starts_with('-') { "-" } else { "" };
        let words = match unsigned.starts_with('.') {
            true => format!("write a digit before the point: `{sign}0{unsigned}`"),
            false => format!("write the number without quotes: `{number}`"),
        };
        return Err(Box::new(diagnostic.remedy(words)));
    }
    Err(Box::new(
        match (kind, &blamed.value, suggestion(kind, blamed)) {
            (Kind::Formulas, Value::Table(_) | Value::Array(_), _) => {
                diagnostic.remedy(NOISE_KINDS)
            }
            (_, _, Some(words)) => diagnostic.remedy(format!("did you mean `{words}`?")),
            (Kind::Printable, Value::Text(_), _) => diagnostic.remedy(
                "a backslash between `\"` begins a code: write `\\\\`, or put the text between `'`",
            ),
            _ => diagnostic,
        },
    ))
}

/// A number between quotation marks that the key would take without them.
fn quoted_number(kind: Kind, node: &SpannedValue) -> Option<&str> {
    let Value::Text(text) = &node.value else {
        return None;
    };
    let text = text.trim();
    let integer = text.parse().map(Plain::Integer);
    let number = || text.parse().map(Plain::Number);
    let plain = integer.or_else(|_| number()).ok()?;
    let is_finite = plain.number().is_some_and(f64::is_finite);
    (is_finite && kind.holds(&plain)).then_some(text)
}

/// What was perhaps meant by a value that is not of a kind.
fn suggestion(kind: Kind, node: &SpannedValue) -> Option<String> {
    let is_switch = matches!(kind, Kind::Choice(names) if names().contains(&"off"));
    if is_switch && matches!(node.value, Value::Other("a boolean")) {
        return Some("\"on\"` or `\"off\"".to_owned());
    }
    let plain = node.plain()?;
    match kind {
        Kind::Choice(names) if is_switch => {
            let text = plain.text()?;
            match text.to_lowercase().as_str() {
                "true" | "yes" => Some("on".to_owned()),
                "false" | "no" | "none" => Some("off".to_owned()),
                text => nearest_name(text, names()).map(str::to_owned),
            }
        }
        Kind::Choice(names) => match plain.items() {
            // A range as a list, where it is two keys.
            Some([from, to]) if names() == ["auto"] => {
                let (from, to) = (from.number()?, to.number()?);
                Some(format!("from = {from:?}, to = {to:?}"))
            }
            _ => nearest_name(plain.text()?, names()).map(str::to_owned),
        },
        Kind::Model => nearest_name(plain.text()?, models()).map(str::to_owned),
        Kind::Bounds => keys::nearest_bound(plain.text()?).map(str::to_owned),
        Kind::Width => {
            let text = plain.text()?;
            let number = text.strip_suffix("mm").map(str::trim);
            match number.filter(|number| number.parse::<f64>().is_ok()) {
                Some(number) => Some(number.to_owned()),
                None => {
                    let names = FigureWidth::NAMED.into_iter().filter_map(FigureWidth::name);
                    nearest_name(text, names).map(str::to_owned)
                }
            }
        }
        Kind::Step | Kind::Count(..) => plain.text().map(|_| "\"auto\"".to_owned()),
        Kind::List(kind) if kind.holds(&plain) => Some(format!("[{}]", plain.to_toml())),
        _ => None,
    }
}
