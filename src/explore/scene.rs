//! What the page is told once: the model, its parameters, what is watched, what was located.

use serde_json::{Map, Value, json};

use crate::continuation::{Label, Subject};
use crate::density::Observable;
use crate::formula::mathml::{Content, Element};
use crate::sweep_file::Sweep;
use crate::system::{Family, ParameterRange};

/// The part of a page's data that does not change along the sweep, with the rows that were found on it; `fields` are
/// those of passages over both axes of the state, which stand after the densities.
pub(super) fn scene(sweep: &Sweep, labels: &[Label], fields: &[&str]) -> Value {
    let subject = sweep.problem.subject();
    let family = &subject.family;
    let (from, to) = family.ends();
    let densities = subject.observables.iter().map(|one| watched(family, one));
    let fields = fields.iter().map(|name| {
        json!({
            "name": name,
            "axes": [0, 1],
            "phase": null,
            "states": [0, 1],
            "field": name.replace('_', " "),
        })
    });
    let labels = labels.iter().map(|row| label(row, subject));
    json!({
        "program": concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")),
        "title": sweep.settings.title,
        "model": model(family),
        // The path's coordinate.
        "swept": { "name": family.parameter(), "symbol": family.symbol(), "from": from, "to": to },
        "parameters": parameters(family),
        "axes": axes(family),
        // Symbols of what moments are of: states that are no angles, quantities that are averaged, states at phases.
        "moments": moments(family),
        // Their names in columns.
        "moment_names": family.averages().collect::<Vec<_>>(),
        "observables": densities.chain(fields).collect::<Vec<_>>(),
        "sweep_file": sweep.to_toml(),
        "labels": labels.collect::<Vec<_>>(),
    })
}

/// A watched density with the axes that it keeps, in its order; of one at a phase of a forcing, the phase in periods,
/// and the axes of the state that it is of.
fn watched(family: &Family, observable: &Observable) -> Value {
    let axes = observable.axes();
    let at = family.at_phase(&axes);
    json!({
        "name": observable.name(family),
        "axes": axes,
        "phase": at.as_ref().map(|(_, phase)| *phase),
        "states": at.map_or(axes, |(states, _)| states),
        "field": null,
    })
}

fn model(family: &Family) -> Value {
    let model = family.model();
    let equations = model.equations.iter().zip(model.typeset());
    let equations =
        equations.map(|(text, element)| json!({ "text": text, "layout": layout(element) }));
    json!({
        "name": model.name,
        "title": model.title,
        "equations": equations.collect::<Vec<_>>(),
        "source": model.source,
    })
}

/// An element of MathML as a list: its name, its attributes, and its text or its elements. The page makes elements of
/// it, so that no text of a model is ever read as markup.
fn layout(element: &Element) -> Value {
    let attributes = element.attributes.iter();
    let attributes = attributes.map(|&(name, value)| (name.to_owned(), value.into()));
    let attributes: Map<String, Value> = attributes.collect();
    let mut list = vec![element.tag.into(), attributes.into()];
    match &element.content {
        Content::Text(text) => list.push(text.as_str().into()),
        Content::Elements(inner) => list.extend(inner.iter().map(layout)),
    }
    list.into()
}

fn parameters(family: &Family) -> Vec<Value> {
    // `None` where the path moves it.
    let value = |name: &str| {
        let mut fixed = family.fixed();
        fixed.find(|fixed| fixed.0 == name).map(|fixed| fixed.1)
    };
    let described = family.model().parameters.iter();
    let parameter = described.map(|parameter| {
        json!({
            "name": parameter.name,
            "symbol": parameter.symbol,
            "meaning": parameter.meaning,
            "allowed": parameter.range.words(),
            "range": match parameter.range {
                ParameterRange::Any => "any",
                ParameterRange::NonNegative => "non-negative",
                ParameterRange::Positive => "positive",
            },
            "value": value(&parameter.name),
        })
    });
    parameter.collect()
}

fn axes(family: &Family) -> Vec<Value> {
    let axis = |name: &str, symbol: &str, meaning: &str| json!({ "name": name, "symbol": symbol, "meaning": meaning });
    let axes = family.model().axes.iter();
    let axes = axes.map(|one| axis(&one.name, &one.symbol, &one.meaning));
    // Observables number quantities on from the axes.
    let quantities = family.quantities().iter();
    let quantities =
        quantities.map(|one| axis(one.name(), one.symbol(), one.formula().unwrap_or_default()));
    axes.chain(quantities).collect()
}

fn moments(family: &Family) -> Vec<String> {
    let axes = &family.model().axes;
    let lines = family.states_on_lines();
    let lines = lines.map(|(axis, _)| axes[axis].symbol.as_str());
    let averaged = family.questions.averaged.iter().map(|one| one.symbol());
    let quantities = family.quantities().iter();
    let at_phases = quantities.filter(|one| one.phase().is_some_and(|at| !axes[at.axis].is_angle));
    let at_phases = at_phases.map(|one| one.symbol());
    let all = lines.chain(averaged).chain(at_phases);
    all.map(str::to_owned).collect()
}

/// A located bifurcation, an end or a failure.
pub(super) fn label(row: &Label, subject: &Subject) -> Value {
    let number = |wanted: Observable| {
        let mut observables = subject.observables.iter();
        observables.position(|&observable| observable == wanted)
    };
    let words = row.words(&subject.family);
    let words = words.as_ref();
    let (lower, upper) = row.bracket();
    json!({
        "label": row.name(),
        "kind": match row {
            Label::Bifurcation(_) => "bifurcation",
            Label::Level(_) => "level",
            Label::End { .. } => "end",
            Label::Failure { .. } => "failure",
        },
        "value": row.value(),
        "error": row.error(),
        "lower": lower,
        "upper": upper,
        "observable": row.bifurcation().and_then(|one| number(one.observable)),
        "before": words.map(|one| &one.before),
        "after": words.map(|one| &one.after),
        "status": words.map(|one| one.status.word()),
        "change": words.map_or("", |one| &one.change),
        "method": words.map_or("", |one| one.method),
    })
}
