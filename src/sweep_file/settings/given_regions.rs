//! Regions as passages give them: by a name of `[regions]`, or as an inequality of their own.

use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::draft::Draft;
use crate::sweep_file::formula_place::inside;
use crate::sweep_file::reader::Reader;
use crate::system::{Model, Region, RegionError, RegionFault, regions};

/// An inequality as it was given.
pub(super) struct Given {
    pub(super) name: String,
    pub(super) text: String,
    pub(super) place: Place,
    /// Whether it is made of others, which say what is wrong with them.
    pub(super) is_joined: bool,
}

/// Whether a region is found in a density, as `peak 2 of x` and `inside ring of xy` are.
pub(super) fn is_basin(text: &str) -> bool {
    let words: Vec<&str> = text.split_whitespace().collect();
    matches!(
        words[..],
        ["peak", _, "of", _] | ["inside" | "outside", "ring", "of", _]
    )
}

/// The number of a region that a passage names, or gives as an inequality.
pub(super) fn region(
    reader: &Reader<'_>,
    given: &mut Vec<Given>,
    passage: &str,
    (word, name): (&str, String),
    text: &str,
) -> usize {
    region_at(reader, given, &["passage", passage, word], name, text)
}

/// The same of the key at a path.
pub(super) fn region_at(
    reader: &Reader<'_>,
    given: &mut Vec<Given>,
    path: &[&str],
    name: String,
    text: &str,
) -> usize {
    if let Some(known) = given.iter().position(|one| one.name == text.trim()) {
        return known;
    }
    let place = reader.place(path);
    let whole = &reader.document().root.place;
    given.push(Given {
        name,
        text: text.to_owned(),
        place: place.unwrap_or(whole).clone(),
        is_joined: false,
    });
    given.len() - 1
}

/// The regions with names.
pub(super) fn named(reader: &Reader<'_>, draft: &Draft) -> Vec<Given> {
    let mut given = Vec::new();
    for entry in reader.entries(&["regions"]) {
        if let Some((name, text)) = draft.regions.iter().find(|(name, _)| *name == entry.key) {
            given.push(Given {
                name: name.clone(),
                text: text.clone(),
                place: entry.node.place.clone(),
                is_joined: false,
            });
        }
    }
    given
}

/// What inequalities are, of which the first `named` can be called by their names; `None` where something is wrong with
/// one, which is reported.
pub(super) fn read_all(
    reader: &mut Reader<'_>,
    model: &Model,
    given: &[Given],
    named: usize,
) -> Option<Vec<Region>> {
    let texts: Vec<(&str, &str)> = given
        .iter()
        .map(|one| (one.name.as_str(), one.text.as_str()))
        .collect();
    let errors = match regions(model, &texts) {
        Ok(read) => return Some(read),
        Err(errors) => errors,
    };
    let (own, joined): (Vec<_>, Vec<_>) = errors
        .into_iter()
        .partition(|error| !given[error.index].is_joined);
    for error in if own.is_empty() { joined } else { own } {
        let one = (&given[error.index], &given[..named]);
        let diagnostic = diagnostic(reader, one, &error);
        reader.report(diagnostic);
    }
    None
}

/// The number of the region that is either of two.
pub(super) fn either(
    reader: &Reader<'_>,
    given: &mut Vec<Given>,
    passage: &str,
    [one, other]: [usize; 2],
) -> usize {
    let name = format!("{passage}_from_or_to");
    if let Some(known) = given
        .iter()
        .position(|one| one.is_joined && one.name == name)
    {
        return known;
    }
    let text = format!("({}) or ({})", given[one].text, given[other].text);
    let both = region(reader, given, passage, ("from", name), &text);
    given[both].is_joined = true;
    both
}

/// Reports what is wrong with a passage.
pub(super) fn refuse(reader: &mut Reader<'_>, passage: &str, title: String, remedy: &str) {
    let diagnostic = Diagnostic::new(title).remedy(remedy);
    let place = reader.key_place(&["passage", passage]);
    reader.report(diagnostic.at(place, "this passage"));
}

/// What is wrong with an inequality, at its place; `named` are those that others can call by their names.
fn diagnostic(
    reader: &Reader<'_>,
    (one, named): (&Given, &[Given]),
    error: &RegionError,
) -> Diagnostic {
    let diagnostic = Diagnostic::new(format!("region `{}`: {}", one.name, error.fault));
    let diagnostic = match &error.span {
        Some(span) => {
            let sources = &reader.document().sources;
            diagnostic.at(&inside(sources, &one.place, span), "here")
        }
        None => diagnostic.at(&one.place, "this region"),
    };
    let diagnostic = diagnostic.advice(error.fault.allowed(), error.fault.remedy());
    match &error.fault {
        RegionFault::NoInequality { text } => {
            let names = named.iter().map(|one| one.name.as_str());
            diagnostic.nearest(text, names.filter(|name| *name != one.name))
        }
        _ => diagnostic,
    }
}
