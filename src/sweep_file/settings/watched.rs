//! The densities that are watched: of axes, of quantities, and of pairs of them; and the quantities that are averaged.

use std::sync::Arc;

use super::AxisSettings;
use super::equations::model_in_words;
use super::modes_of::ModesOf;
use super::moments::{at_zero, moment, of_one_moment, spread_over_period};
use super::quantities::{GivenQuantity, read_all, split};
use crate::density::Observable;
use crate::formula::language::check_name;
use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::draft::Draft;
use crate::sweep_file::names::{nearest_name, quotable};
use crate::sweep_file::reader::Reader;
use crate::system::{Model, Quantity};

/// What is watched.
#[derive(Debug, Default)]
pub(super) struct Watched {
    /// Marginals first, each in the order given.
    pub(super) observables: Vec<Observable>,
    /// Numbered on from the axes.
    pub(super) quantities: Vec<Arc<Quantity>>,
    pub(super) averaged: Vec<Arc<Quantity>>,
}

/// Checks `detect.marginals`, `detect.joint` and `[watch]`.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    model: &Model,
    axes: Option<&[AxisSettings]>,
) -> Watched {
    let dimension = model.axes.len();
    let has_modes = |axis: usize| {
        let settings = axes.and_then(|axes| axes.get(axis));
        settings.is_some_and(|axis| !axis.is_cut(draft.method.kind))
    };
    // What closes on itself is looked at, but for the phase of a forcing, in which nothing has a shape.
    let is_turn = |axis: usize| {
        let settings = axes.and_then(|axes| axes.get(axis));
        settings.is_some_and(|axis| axis.series == ModesOf::Turn)
    };
    let is_angle = |axis: usize| is_turn(axis) && model.phase_axis() != Some(axis);
    let is_shown =
        |axis: usize| !has_modes(axis) && model.phase_axis() != Some(axis) || is_angle(axis);
    let whole = reader.document().root.place.clone();
    let mut observables: Vec<Observable> = Vec::new();
    let mut given: Vec<GivenQuantity> = Vec::new();
    match &draft.marginals {
        Some(texts) => {
            let items = reader.items(&["detect", "marginals"]);
            let each = texts.iter().zip(items);
            let each = each.flat_map(|(text, item)| {
                let spread = spread_over_period(text);
                spread.into_iter().map(move |text| (text, item))
            });
            for (text, item) in each {
                let text = text.as_str();
                if let Some(axis) = coordinate(reader, model, &mut given, text, &item.place) {
                    let marginal = Observable::Marginal(axis);
                    watch(reader, &mut observables, marginal, &item.place);
                }
            }
        }
        None => {
            let cut: Vec<usize> = (0..dimension).filter(|&axis| is_shown(axis)).collect();
            observables.extend(cut.iter().copied().map(Observable::Marginal));
            let at_zero = cut
                .iter()
                .filter_map(|&axis| at_zero(model, &mut given, axis, &whole));
            observables.extend(at_zero.map(Observable::Marginal));
        }
    }
    match &draft.joint {
        Some(pairs) => {
            let items = reader.items(&["detect", "joint"]);
            for ([one, other], item) in pairs.iter().zip(items) {
                let place = |index: usize| item.items().get(index).unwrap_or(item).place.clone();
                let one = coordinate(reader, model, &mut given, one, &place(0));
                let other = coordinate(reader, model, &mut given, other, &place(1));
                if let (Some(one), Some(other)) = (one, other) {
                    let Some((one, other)) =
                        of_one_moment(reader, model, &mut given, (one, other), &item.place)
                    else {
                        continue;
                    };
                    let joint = Observable::Joint(one, other);
                    watch(reader, &mut observables, joint, &item.place);
                }
            }
        }
        None if dimension >= 2 && is_shown(0) && is_shown(1) => {
            observables.push(Observable::Joint(0, 1));
            let at_zero = [0, 1].map(|axis| at_zero(model, &mut given, axis, &whole));
            if let [Some(one), Some(other)] = at_zero {
                observables.push(Observable::Joint(one, other));
            }
        }
        None => {}
    }
    if observables.is_empty() && reader.is_clean() {
        let diagnostic = Diagnostic::new("nothing is watched")
            .remedy("name an axis in `detect.marginals` or a pair in `detect.joint`");
        reader.report(diagnostic);
    }
    let quantities = read_all(reader, model, &given);
    let averaged: Vec<GivenQuantity> = reader
        .entries(&["watch"])
        .iter()
        .filter_map(|entry| {
            let known = draft.averaged.iter().find(|(name, _)| *name == entry.key);
            known.map(|(name, text)| GivenQuantity {
                at_phase: None,
                name: name.clone(),
                formula: Some((text.clone(), 0)),
                name_place: entry.key_place.clone(),
                place: entry.node.place.clone(),
            })
        })
        .collect();
    let averaged = read_all(reader, model, &averaged);
    Watched {
        observables,
        quantities,
        averaged,
    }
}

/// The number of an axis, or of a quantity, numbered on from the axes.
fn coordinate(
    reader: &mut Reader<'_>,
    model: &Model,
    given: &mut Vec<GivenQuantity>,
    text: &str,
    at: &Place,
) -> Option<usize> {
    let dimension = model.axes.len();
    let number = |given: &[GivenQuantity], name: &str| {
        let known = given.iter().position(|one| one.name == name);
        known.map(|number| dimension + number)
    };
    let new = |name: &str, formula: Option<(String, usize)>| GivenQuantity {
        at_phase: None,
        name: name.to_owned(),
        formula,
        name_place: at.clone(),
        place: at.clone(),
    };
    if let Some((axis, when)) = text.split_once('@') {
        return moment(reader, model, given, (axis, when), at);
    }
    if let Some((name, formula, offset)) = split(text) {
        if let Some(known) = number(given, name) {
            let first = given[known - dimension].formula.as_ref();
            if first.is_some_and(|(first, _)| first == formula) {
                return Some(known);
            }
            let title = format!("`{}` has two formulas", quotable(name));
            let diagnostic = Diagnostic::new(title).at(at, "the second one");
            reader.report(diagnostic.remedy("define it once; elsewhere its name will do"));
            return None;
        }
        given.push(new(name, Some((formula.to_owned(), offset))));
        return number(given, name);
    }
    let name = text.trim();
    if let Some(axis) = model.axes.iter().position(|axis| axis.name == name) {
        return Some(axis);
    }
    if let Some(known) = number(given, name) {
        return Some(known);
    }
    if model.definitions().iter().any(|(known, _)| known == name) {
        given.push(new(name, None));
        return number(given, name);
    }
    unknown(reader, model, given, text, at);
    None
}

/// Reports a text that is neither a name nor a quantity.
fn unknown(
    reader: &mut Reader<'_>,
    model: &Model,
    given: &[GivenQuantity],
    text: &str,
    at: &Place,
) {
    if text.contains(|c: char| "+-*/^()".contains(c) || c == ' ') {
        let title = format!("a formula needs a name: `{}`", quotable(text));
        let diagnostic = Diagnostic::new(title).at(at, "no name");
        let remedy = format!("write `name = {}`", quotable(text.trim()));
        reader.report(
            diagnostic
                .allowed("names of axes, and quantities as `name = formula`")
                .remedy(remedy),
        );
        return;
    }
    let title = format!("{} has no axis `{}`", model_in_words(model), quotable(text));
    let axes = model.axes.iter().map(|axis| axis.name.as_str());
    let defined = model.definitions().iter().map(|(name, _)| name.as_str());
    let names = axes
        .chain(given.iter().map(|one| one.name.as_str()))
        .chain(defined);
    let diagnostic = Diagnostic::new(title).at(at, "unknown axis");
    let names: Vec<&str> = names.collect();
    let diagnostic = match nearest_name(text, names.iter().copied()) {
        None if check_name(text) => {
            diagnostic.remedy(format!("a quantity needs its formula: `{text} = …`"))
        }
        _ => diagnostic,
    };
    reader.report(diagnostic.nearest(text, names));
}

/// Adds an observable that is new and sound.
fn watch(reader: &mut Reader<'_>, known: &mut Vec<Observable>, new: Observable, at: &Place) {
    let same = |other: &Observable| match (*other, new) {
        (Observable::Joint(a, b), Observable::Joint(c, d)) => (a, b) == (c, d) || (a, b) == (d, c),
        (one, other) => one == other,
    };
    let wrong = match new {
        Observable::Joint(one, other) if one == other => Some("a pair of one axis with itself"),
        _ if known.iter().any(same) => Some("listed twice"),
        _ => None,
    };
    match wrong {
        None => known.push(new),
        Some(label) => {
            let diagnostic = Diagnostic::new("what is watched must be different densities");
            reader.report(diagnostic.at(at, label));
        }
    }
}
