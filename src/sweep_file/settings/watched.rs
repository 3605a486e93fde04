//! The densities that are watched.

use super::AxisSettings;
use crate::density::Observable;
use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::draft::Draft;
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::system::Model;

/// Checks `detect.marginals` and `detect.joint`: marginals first, each in the order given.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    model: &Model,
    axes: Option<&[AxisSettings]>,
) -> Vec<Observable> {
    let dimension = model.axes.len();
    let has_modes = |axis: usize| {
        let settings = axes.and_then(|axes| axes.get(axis));
        settings.is_some_and(|axis| axis.modes_by(draft.method.kind).is_some())
    };
    let mut observables: Vec<Observable> = Vec::new();
    match &draft.marginals {
        Some(names) => {
            let items = reader.items(&["detect", "marginals"]);
            for (name, item) in names.iter().zip(items) {
                if let Some(axis) = axis_index(reader, model, name, &item.place) {
                    if has_modes(axis) {
                        refuse_modes(reader, name, &item.place);
                        continue;
                    }
                    let marginal = Observable::Marginal(axis);
                    watch(reader, &mut observables, marginal, &item.place);
                }
            }
        }
        None => {
            let cut = (0..dimension).filter(|&axis| !has_modes(axis));
            observables.extend(cut.map(Observable::Marginal));
        }
    }
    match &draft.joint {
        Some(pairs) => {
            let items = reader.items(&["detect", "joint"]);
            for ([one, other], item) in pairs.iter().zip(items) {
                let carried = |name: &&String| {
                    let index = model.axes.iter().position(|axis| axis.name == **name);
                    index.is_some_and(has_modes)
                };
                if let Some(name) = [one, other].into_iter().find(carried) {
                    refuse_modes(reader, name, &item.place);
                    continue;
                }
                let one = axis_index(reader, model, one, &item.place);
                let other = axis_index(reader, model, other, &item.place);
                if let (Some(one), Some(other)) = (one, other) {
                    let joint = Observable::Joint(one, other);
                    watch(reader, &mut observables, joint, &item.place);
                }
            }
        }
        None if dimension >= 2 => observables.push(Observable::Joint(0, 1)),
        None => {}
    }
    if observables.is_empty() && reader.is_clean() {
        let diagnostic = Diagnostic::new("nothing is watched")
            .remedy("name an axis in `detect.marginals` or a pair in `detect.joint`");
        reader.report(diagnostic);
    }
    observables
}

/// Reports that the density along an axis of modes is not watched.
fn refuse_modes(reader: &mut Reader<'_>, name: &str, at: &Place) {
    let title = format!("the density along axis `{name}`, which modes carry, is not watched");
    let remedy = format!("give `cells.{name}.count` in place of modes, or leave it out here");
    reader.report(
        Diagnostic::new(title)
            .at(at, "carried by modes")
            .remedy(remedy),
    );
}

fn axis_index(reader: &mut Reader<'_>, model: &Model, name: &str, at: &Place) -> Option<usize> {
    let index = model.axes.iter().position(|axis| axis.name == name);
    if index.is_none() {
        let title = format!("model `{}` has no axis `{}`", model.name, quotable(name));
        let names = model.axes.iter().map(|axis| axis.name.as_str());
        let diagnostic = Diagnostic::new(title).at(at, "unknown axis");
        reader.report(diagnostic.nearest(name, names));
    }
    index
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
