//! What a file asks of fluctuations in the steady state.

use std::sync::Arc;

use crate::sweep_file::diagnostic::{Diagnostic, Place};
use crate::sweep_file::draft::{Draft, MethodKind, SpectrumDraft};
use crate::sweep_file::names::{list, quotable};
use crate::sweep_file::reader::Reader;
use crate::system::{Band, Family, Fluctuating, SpectrumQuestion};

/// How many frequencies there are where the file does not say.
const POINTS: usize = 241;

/// Checks `[spectrum]`: everything that fluctuates has a name, and frequencies ascend.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    family: &Family,
) -> Option<SpectrumQuestion> {
    let asked = &draft.spectrum;
    let Some(texts) = &asked.of else {
        if *asked != SpectrumDraft::default() {
            let found =
                Diagnostic::new("frequencies are given, and nothing whose spectrum is wanted");
            let remedy = "add `of = [\"x\"]` to `[spectrum]`, with the names of axes or quantities";
            refuse(reader, &[], found.remedy(remedy));
        }
        return None;
    };
    if draft.method.kind != MethodKind::Generator {
        let name = draft.method.kind.name();
        let title = format!("spectra are worked out by `generator`, not by `{name}`");
        let remedy = "set `method.kind = \"generator\"`, or leave `[spectrum]` out";
        refuse(reader, &["of"], Diagnostic::new(title).remedy(remedy));
    }
    if let (Some(from), Some(to)) = (asked.from, asked.to)
        && from >= to
    {
        let title = format!("the lowest frequency, {from}, is not below the highest, {to}");
        let remedy = "exchange them, or leave `spectrum.from` out for frequencies from 0 on";
        refuse(reader, &["from"], Diagnostic::new(title).remedy(remedy));
    }
    let (mut observables, mut pairs) = (Vec::new(), Vec::new());
    let places: Vec<Place> = reader
        .items(&["spectrum", "of"])
        .iter()
        .map(|item| item.place.clone())
        .collect();
    for (text, place) in texts.iter().zip(&places) {
        let names: Vec<&str> = text.split(',').map(str::trim).collect();
        if names.len() > 2 {
            let title = format!("`{}` names {} observables", quotable(text), names.len());
            let remedy =
                "name one for its power spectrum, or two, `\"x, v\"`, for their cross spectrum";
            reader.report(Diagnostic::new(title).at(place, "these").remedy(remedy));
            continue;
        }
        let numbers: Vec<usize> = names
            .iter()
            .filter_map(|name| number_of(reader, family, &mut observables, name, place))
            .collect();
        match numbers[..] {
            [one] if names.len() == 1 => put(&mut pairs, (one, one)),
            [one, other] => put(&mut pairs, (one, other)),
            _ => {}
        }
    }
    if texts.is_empty() {
        let found = Diagnostic::new("the list of what fluctuates is empty");
        refuse(
            reader,
            &["of"],
            found.remedy("name an axis or a quantity, or leave `[spectrum]` out"),
        );
    }
    Some(SpectrumQuestion {
        observables,
        pairs,
        band: Band {
            from: asked.from,
            to: asked.to,
            points: asked.points.unwrap_or(POINTS),
        },
        sides: asked.sides.unwrap_or_default(),
        lag: asked.lag,
    })
    .filter(|_| !texts.is_empty())
}

/// Adds a pair that is not there yet.
fn put(pairs: &mut Vec<(usize, usize)>, pair: (usize, usize)) {
    if !pairs.contains(&pair) {
        pairs.push(pair);
    }
}

/// The number of an observable among those that are known so far.
fn number_of(
    reader: &mut Reader<'_>,
    family: &Family,
    observables: &mut Vec<Fluctuating>,
    name: &str,
    place: &Place,
) -> Option<usize> {
    let known = observables.iter().position(|one| one.name() == name);
    if known.is_some() {
        return known;
    }
    let axes = &family.model().axes;
    let axis = axes.iter().position(|axis| axis.name == name);
    let mut quantities = family.quantities().iter().chain(&family.questions.averaged);
    let quantity = quantities.find(|one| one.name() == name && one.phase().is_none());
    let found = axis
        .map(|axis| Fluctuating::Axis(axis, name.to_owned()))
        .or_else(|| quantity.map(|one| Fluctuating::Quantity(Arc::clone(one))));
    let Some(found) = found else {
        let names = axes.iter().map(|axis| axis.name.as_str());
        let names: Vec<&str> = names
            .chain(family.questions.averaged.iter().map(|one| one.name()))
            .collect();
        let title = format!(
            "`{}` is no axis and no quantity that is watched",
            quotable(name)
        );
        let remedy = format!(
            "take one of {}, or give a formula a name in `[watch]`, such as `energy = \"v^2/2\"`",
            list(&names)
        );
        let found = Diagnostic::new(title)
            .at(place, "whose spectrum?")
            .nearest(name, names);
        reader.report(found.remedy(remedy));
        return None;
    };
    if let Some(angle) = torn(family, &found) {
        let title = format!(
            "`{}` jumps where the turn of `{angle}` ends",
            quotable(name)
        );
        let remedy =
            format!("take a formula that does not, such as `c = \"cos({angle})\"` in `[watch]`");
        let found = Diagnostic::new(title).at(place, "a jump is no fluctuation");
        reader.report(found.remedy(remedy));
        return None;
    }
    observables.push(found);
    Some(observables.len() - 1)
}

/// States of the other axes at which both ends of a turn are looked at.
const LOOKED_AT: [f64; 3] = [-0.83, 0.31, 1.27];

/// Relative difference between both ends of a turn that is rounding.
const ROUNDING: f64 = 1e-9;

/// The angle at the end of whose turn something jumps, if it does.
fn torn<'a>(family: &'a Family, fluctuating: &Fluctuating) -> Option<&'a str> {
    let (from, _) = family.ends();
    let system = family.at(from).ok()?;
    let turns = &system.facts().turns;
    let jumps = |axis: usize| match fluctuating {
        Fluctuating::Axis(own, _) => *own == axis,
        Fluctuating::Quantity(quantity) => {
            let bound = family
                .values_at(from)
                .ok()
                .and_then(|at| quantity.bind(&at).ok());
            let (Some(bound), Some(&(low, high))) = (bound, turns.get(&axis)) else {
                return false;
            };
            LOOKED_AT.iter().any(|&others| {
                let mut state = vec![others; system.dimension()];
                let [one, other] = [low, high].map(|end| {
                    state[axis] = end;
                    bound.at(&state)
                });
                (one - other).abs() > ROUNDING * one.abs().max(1.0)
            })
        }
    };
    let mut angles = family.angles();
    angles.find(|(axis, _)| jumps(*axis)).map(|(_, name)| name)
}

/// An error at a key of `[spectrum]`, or at the table.
fn refuse(reader: &mut Reader<'_>, key: &[&str], diagnostic: Diagnostic) {
    let path = [&["spectrum"], key].concat();
    let place = reader.place(&path).or_else(|| reader.place(&["spectrum"]));
    reader.report(diagnostic.at(place, "here"));
}

/// What a complete file says.
pub(super) fn draft(family: &Family) -> SpectrumDraft {
    let Some(question) = &family.questions.spectrum else {
        return SpectrumDraft::default();
    };
    let names = question.pairs.iter().map(|&pair| question.name(pair));
    SpectrumDraft {
        of: Some(names.collect()),
        from: question.band.from,
        to: question.band.to,
        points: Some(question.band.points),
        sides: Some(question.sides),
        lag: question.lag,
    }
}
