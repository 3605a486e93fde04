//! One spelling for what a file may say in two ways. A name of its own equations: `α` is `alpha` in formulas, and so it
//! is in the rest of the file. The cells of an axis: a number, `x = 60`, is their count.
//!
//! Axes are spelled as in `system.equations`, parameters as in `system.parameters`. Names of built-in models are left
//! as they are.

use super::document::Document;
use super::value::{Entry, SpannedValue, Value};
use crate::formula::language::{canonical_name, check_name};

/// The document with the names of its equations and the counts of cells spelled alike everywhere.
pub(super) fn respell(document: &Document) -> Document {
    let mut document = document.clone();
    for_node(&mut document.root, &["cells"], &mut spell_counts);
    let names = |path: &[&str]| -> Vec<String> {
        let entries = document.root.find(path).map(|entry| entry.node.entries());
        let entries = entries.unwrap_or_default().iter();
        entries.map(|entry| entry.key.clone()).collect()
    };
    let axes = names(&["system", "equations"]);
    let parameters = names(&["system", "parameters"]);
    if axes.is_empty() {
        return document;
    }
    let root = &mut document.root;
    for table in [&["system", "noise"][..], &["system", "bounds"], &["cells"]] {
        for_node(root, table, &mut |node| respell_keys(node, &axes));
    }
    for key in ["marginals", "joint"] {
        for_node(root, &["detect", key], &mut |node| {
            respell_texts(node, &axes);
        });
    }
    for table in ["sweep", "map", "curve"] {
        for_node(root, &[table, "parameter"], &mut |node| {
            respell_texts(node, &parameters);
        });
    }
    document
}

fn for_node(node: &mut SpannedValue, path: &[&str], change: &mut dyn FnMut(&mut SpannedValue)) {
    let Some((first, rest)) = path.split_first() else {
        return change(node);
    };
    if let Value::Table(entries) = &mut node.value {
        for entry in entries.iter_mut().filter(|entry| entry.key == *first) {
            for_node(&mut entry.node, rest, change);
        }
    }
}

/// Makes a table of a whole number of cells; how accurate all cells are is another number.
fn spell_counts(cells: &mut SpannedValue) {
    let Value::Table(entries) = &mut cells.value else {
        return;
    };
    let axes = entries.iter_mut().filter(|entry| entry.key != "accuracy");
    for axis in axes.filter(|axis| matches!(axis.node.value, Value::Integer(_))) {
        let place = axis.node.place.clone();
        let count = Entry {
            key: "count".to_owned(),
            key_place: place.clone(),
            node: axis.node.clone(),
        };
        axis.node = SpannedValue {
            value: Value::Table(vec![count]),
            place,
        };
    }
}

/// The name among `known` that is the same in another spelling.
fn same_name<'n>(name: &str, known: &'n [String]) -> Option<&'n String> {
    if known.iter().any(|known| known == name) || !check_name(name) {
        return None;
    }
    let canonical = canonical_name(name);
    known
        .iter()
        .find(|known| canonical_name(known) == canonical)
}

fn respell_keys(node: &mut SpannedValue, known: &[String]) {
    if let Value::Table(entries) = &mut node.value {
        for entry in entries {
            if let Some(name) = same_name(&entry.key, known) {
                entry.key.clone_from(name);
            }
        }
    }
}

fn respell_texts(node: &mut SpannedValue, known: &[String]) {
    match &mut node.value {
        Value::Text(text) => {
            if let Some(name) = same_name(text, known) {
                text.clone_from(name);
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| respell_texts(item, known)),
        _ => {}
    }
}
