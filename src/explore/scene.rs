//! What the page is told once: the model, its parameters, what is watched, what was located.

use serde::Serialize;

use crate::continuation::{self, Subject};
use crate::density::Observable;
use crate::formula::mathml::{Content, Element};
use crate::sweep_file::Sweep;
use crate::system::{Family, ParameterRange};

/// The part of a page's data that does not change along the sweep.
#[derive(Debug, Serialize)]
pub(super) struct Scene {
    pub(super) program: String,
    title: String,
    model: ShownModel,
    swept: Swept,
    parameters: Vec<Parameter>,
    axes: Vec<Axis>,
    /// Symbols of what moments are of: states that are no angles, quantities that are averaged, states at phases.
    moments: Vec<String>,
    /// Their names in columns.
    moment_names: Vec<String>,
    observables: Vec<Watched>,
    /// The complete sweep file.
    sweep_file: String,
    pub(super) labels: Vec<Label>,
}

#[derive(Debug, Serialize)]
struct ShownModel {
    name: String,
    title: String,
    equations: Vec<Equation>,
    source: String,
}

/// A line of the model's equations: as text, and typeset.
#[derive(Debug, Serialize)]
struct Equation {
    text: String,
    layout: serde_json::Value,
}

/// The path's coordinate.
#[derive(Debug, Serialize)]
struct Swept {
    name: String,
    symbol: String,
    from: f64,
    to: f64,
}

#[derive(Debug, Serialize)]
struct Parameter {
    name: String,
    symbol: String,
    meaning: String,
    allowed: &'static str,
    range: &'static str,
    /// `None` where the path moves it.
    value: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Axis {
    name: String,
    symbol: String,
    meaning: String,
}

/// A watched density.
#[derive(Debug, Serialize)]
struct Watched {
    name: String,
    /// The axes of the state that it keeps, in its order.
    axes: Vec<usize>,
    /// The phase in periods, of a density at a phase of a forcing, and the axes of the state that it is of.
    phase: Option<f64>,
    states: Vec<usize>,
    /// What it is, of a field of a passage over the state, which is no density.
    field: Option<String>,
}

/// A located bifurcation, an end or a failure.
#[derive(Debug, Serialize)]
pub(super) struct Label {
    label: String,
    kind: &'static str,
    value: f64,
    error: f64,
    lower: f64,
    upper: f64,
    /// Number among the observables.
    observable: Option<usize>,
    before: Option<String>,
    after: Option<String>,
    status: Option<&'static str>,
    change: String,
    method: &'static str,
}

impl Scene {
    /// What is said of a sweep, with the rows that were found on it.
    pub(super) fn new(sweep: &Sweep, labels: &[continuation::Label]) -> Self {
        let subject = sweep.problem.subject();
        let family = &subject.family;
        let (from, to) = family.ends();
        let watched = |observable: &Observable| {
            let axes = observable.axes();
            let at = family.at_phase(&axes);
            Watched {
                name: observable.name(family),
                phase: at.as_ref().map(|(_, phase)| *phase),
                states: at.map_or_else(|| axes.clone(), |(states, _)| states),
                axes,
                field: None,
            }
        };
        Self {
            program: concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION")).to_owned(),
            title: sweep.settings.title.clone(),
            model: model(family),
            swept: Swept {
                name: family.parameter().to_owned(),
                symbol: family.symbol().to_owned(),
                from,
                to,
            },
            parameters: parameters(family),
            axes: axes(family),
            moments: moments(family),
            moment_names: family.averages().map(str::to_owned).collect(),
            observables: subject.observables.iter().map(watched).collect(),
            sweep_file: sweep.to_toml(),
            labels: labels.iter().map(|row| Label::new(row, subject)).collect(),
        }
    }
}

impl Scene {
    /// The same with fields of passages over both axes of the state, after the densities.
    pub(super) fn with_fields<'f>(mut self, names: impl Iterator<Item = &'f str>) -> Self {
        let fields = names.map(|name| Watched {
            name: name.to_owned(),
            axes: vec![0, 1],
            phase: None,
            states: vec![0, 1],
            field: Some(name.replace('_', " ")),
        });
        self.observables.extend(fields);
        self
    }
}

fn model(family: &Family) -> ShownModel {
    let model = family.model();
    let equations = model.equations.iter().zip(model.typeset());
    let equations = equations.map(|(text, element)| Equation {
        text: text.clone(),
        layout: layout(element),
    });
    ShownModel {
        name: model.name.clone(),
        title: model.title.clone(),
        equations: equations.collect(),
        source: model.source.clone(),
    }
}

/// An element of MathML as a list: its name, its attributes, and its text or its elements. The page makes elements of
/// it, so that no text of a model is ever read as markup.
fn layout(element: &Element) -> serde_json::Value {
    let attributes = element.attributes.iter();
    let attributes = attributes.map(|&(name, value)| (name.to_owned(), value.into()));
    let attributes: serde_json::Map<String, serde_json::Value> = attributes.collect();
    let mut list = vec![element.tag.into(), attributes.into()];
    match &element.content {
        Content::Text(text) => list.push(text.as_str().into()),
        Content::Elements(inner) => list.extend(inner.iter().map(layout)),
    }
    list.into()
}

fn parameters(family: &Family) -> Vec<Parameter> {
    let value = |name: &str| {
        let mut fixed = family.fixed();
        fixed.find(|fixed| fixed.0 == name).map(|fixed| fixed.1)
    };
    let described = family.model().parameters.iter();
    let parameter = described.map(|parameter| Parameter {
        name: parameter.name.clone(),
        symbol: parameter.symbol.clone(),
        meaning: parameter.meaning.clone(),
        allowed: parameter.range.words(),
        range: match parameter.range {
            ParameterRange::Any => "any",
            ParameterRange::NonNegative => "non-negative",
            ParameterRange::Positive => "positive",
        },
        value: value(&parameter.name),
    });
    parameter.collect()
}

fn axes(family: &Family) -> Vec<Axis> {
    let axes = family.model().axes.iter();
    let axis = axes.map(|axis| Axis {
        name: axis.name.clone(),
        symbol: axis.symbol.clone(),
        meaning: axis.meaning.clone(),
    });
    // Observables number quantities on from the axes.
    let quantities = family.quantities().iter().map(|quantity| Axis {
        name: quantity.name().to_owned(),
        symbol: quantity.symbol().to_owned(),
        meaning: quantity.formula().unwrap_or_default().to_owned(),
    });
    axis.chain(quantities).collect()
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

impl Label {
    pub(super) fn new(row: &continuation::Label, subject: &Subject) -> Self {
        let number = |wanted: Observable| {
            let mut observables = subject.observables.iter();
            observables.position(|&observable| observable == wanted)
        };
        let located = row.bifurcation();
        let words = row.words(&subject.family);
        let (lower, upper) = row.bracket();
        Self {
            label: row.name().to_owned(),
            kind: match row {
                continuation::Label::Bifurcation(_) => "bifurcation",
                continuation::Label::Level(_) => "level",
                continuation::Label::End { .. } => "end",
                continuation::Label::Failure { .. } => "failure",
            },
            value: row.value(),
            error: row.error(),
            lower,
            upper,
            observable: located.and_then(|one| number(one.observable)),
            status: words.as_ref().map(|one| one.status.word()),
            method: words.as_ref().map_or("", |one| one.method),
            change: words
                .as_ref()
                .map_or_else(String::new, |one| one.change.clone()),
            before: words.as_ref().map(|one| one.before.clone()),
            after: words.map(|one| one.after),
        }
    }
}
