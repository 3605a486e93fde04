//! A draft as TOML, by the table of keys: what each getter gives, in the order of the table. What belongs to one axis
//! stands on one line.

use super::draft::Draft;
use super::keys::{KEYS, Key, is_stand_in};

/// A key with its value, or with what is below it.
struct Entry {
    key: String,
    value: Value,
}

enum Value {
    /// TOML.
    Plain(String),
    /// A table; whether it stands on one line.
    Table(Vec<Entry>, bool),
}

/// Everything the draft has, as a sweep file.
pub(super) fn to_toml(draft: &Draft) -> String {
    let mut root = Vec::new();
    for key in KEYS {
        for name in names(key, draft) {
            if let Some(plain) = (key.field.get)(draft, &name) {
                let mut names = name.split('.');
                let path: Vec<(&str, bool)> = key
                    .parts()
                    .map(|part| match is_stand_in(part) {
                        true => (names.next().unwrap_or_default(), true),
                        false => (part, false),
                    })
                    .collect();
                put(&mut root, &path, plain.to_toml());
            }
        }
    }
    let mut text = String::new();
    write(&mut text, "", &root);
    text
}

/// What `<…>` in a key's path stands for, several joined by points; one empty name where there is none.
fn names(key: &Key, draft: &Draft) -> Vec<String> {
    fn of<'d>(names: impl Iterator<Item = &'d String>) -> Vec<String> {
        names.cloned().collect()
    }
    match key.parts().find(|part| is_stand_in(part)) {
        None => vec![String::new()],
        Some("<quantity>") => of(draft.bins.iter().map(|bins| &bins.name)),
        Some("<formula>") => of(draft.averaged.iter().map(|(name, _)| name)),
        Some("<visits>") => of(draft.visits.iter().map(|(name, _)| name)),
        Some("<region>") => of(draft.regions.iter().map(|(name, _)| name)),
        Some("<measure>") => of(draft.levels.iter().map(|(name, _)| name)),
        Some("<axis>") => of(draft.axes.iter().map(|axis| &axis.name)),
        Some("<name>") => of(draft.equations.define.iter().map(|(name, _)| name)),
        Some("<passage>") if key.parts().any(|part| part == "<axis>") => {
            let starts = draft.passages.iter().flat_map(|one| {
                let axes = one.start.iter();
                axes.map(move |(axis, _)| format!("{}.{axis}", one.name))
            });
            starts.collect()
        }
        Some("<passage>") => of(draft.passages.iter().map(|one| &one.name)),
        Some(_) => of(draft.parameters.iter().map(|(name, _)| name)),
    }
}

/// Puts a value at a path of keys, of each of which is known whether it is a name of the model: its table stands on one
/// line, with all that is below.
fn put(entries: &mut Vec<Entry>, path: &[(&str, bool)], toml: String) {
    let Some(((key, is_name), rest)) = path.split_first() else {
        return;
    };
    let known = entries.iter().position(|entry| entry.key == *key);
    let index = known.unwrap_or(entries.len());
    if known.is_none() {
        entries.push(Entry {
            key: (*key).to_owned(),
            value: Value::Table(Vec::new(), *is_name),
        });
    }
    match (&mut entries[index].value, rest) {
        (value, []) => *value = Value::Plain(toml),
        (Value::Table(below, _), rest) => put(below, rest, toml),
        (Value::Plain(_), _) => {}
    }
}

/// Writes a table: its values first, then the tables in it. `path` is its own.
fn write(text: &mut String, path: &str, entries: &[Entry]) {
    for entry in entries {
        match &entry.value {
            Value::Plain(toml) => *text += &format!("{} = {toml}\n", quote(&entry.key)),
            Value::Table(below, true) => {
                *text += &format!("{} = {}\n", quote(&entry.key), inline(below));
            }
            Value::Table(_, false) => {}
        }
    }
    for entry in entries {
        if let Value::Table(below, false) = &entry.value {
            let path = match path {
                "" => entry.key.clone(),
                path => format!("{path}.{}", entry.key),
            };
            *text += &format!("\n[{path}]\n");
            write(text, &path, below);
        }
    }
}

/// A key as TOML has it: in quotes where it has letters beyond ASCII.
fn quote(key: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    if !key.is_empty() && key.chars().all(is_bare) {
        key.to_owned()
    } else {
        toml::Value::String(key.to_owned()).to_string()
    }
}

fn inline(entries: &[Entry]) -> String {
    let each = entries.iter().map(|entry| match &entry.value {
        Value::Plain(toml) => format!("{} = {toml}", entry.key),
        Value::Table(below, _) => format!("{} = {}", entry.key, inline(below)),
    });
    format!("{{ {} }}", each.collect::<Vec<_>>().join(", "))
}
