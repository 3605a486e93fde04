//! A model with coloured noise made of one with white noise: axes, parameters, equations, and the systems that it
//! makes.

use std::sync::Arc;

use super::filtered::Filtered;
use super::{ColouredNoiseError, NOISE_AXIS, NOISE_RATE_AXIS, NoiseKind};
use crate::MAX_DIMENSION;
use crate::system::typed::statement::Statement;
use crate::system::{AxisDescription, Model, System};

impl Model {
    /// The same model with coloured noise in place of white: each of its noises goes through a filter of this kind at
    /// the same intensity. The states of the filter are axes (`noise`, of unit variance), and its parameters (`tau`)
    /// those of the model. As its memory goes to 0 it becomes the white noise, in Stratonovich's reading: of a model in
    /// Rust the drift is taken to be that of this reading.
    ///
    /// ```
    /// use pbif::system::{Model, NoiseKind, registry};
    ///
    /// let white = registry::find("bistable").unwrap();
    /// let model = Model::with_coloured_noise(&white, NoiseKind::OrnsteinUhlenbeck).unwrap();
    /// let system = model.system_with(&[("a", -0.1), ("sigma2", 0.2), ("tau", 0.4)]).unwrap();
    /// // x' = a x - x³ + σ η/√(2τ), η' = -η/τ.
    /// let drift = system.drift_at(0.0, &[1.0, 2.0]);
    /// assert!((drift[0] - (-1.1 + 0.2_f64.sqrt() / 0.8_f64.sqrt() * 2.0)).abs() < 1e-14);
    /// assert!((drift[1] + 5.0).abs() < 1e-14);
    /// ```
    ///
    /// # Errors
    /// [`ColouredNoiseError`].
    pub fn with_coloured_noise(
        model: &Arc<Self>,
        kind: NoiseKind,
    ) -> Result<Arc<Self>, ColouredNoiseError> {
        if let Some(typed) = model.typed() {
            let coloured = typed.source().clone().with_coloured_noise(kind).build();
            return coloured.map_err(|error| ColouredNoiseError::Equations(error.to_string()));
        }
        // Any values will do: how many noises there are does not depend on them.
        let values = model
            .parameters
            .iter()
            .map(|one| one.default.unwrap_or(1.0));
        let noises = model.bound(&values.collect::<Vec<_>>()).noises().len();
        coloured(model, kind, noises).map(Arc::new)
    }
}

/// A model with coloured noise in place of each of `noises` white noises, with one set of parameters for all their
/// filters.
pub(in crate::system) fn coloured(
    model: &Arc<Model>,
    kind: NoiseKind,
    noises: usize,
) -> Result<Model, ColouredNoiseError> {
    let (axes, each) = (model.axes.len(), kind.filter_states());
    if axes + noises * each > MAX_DIMENSION {
        return Err(ColouredNoiseError::Axes { axes, noises, each });
    }
    let filters = filter_axes(kind, noises);
    check_names(model, kind, &filters)?;
    let mut parameters = model.parameters.clone();
    let own = parameters.len();
    let places: Vec<usize> = (kind.parameters().into_iter())
        .map(|wanted| {
            let known = parameters.iter().position(|one| one.name == wanted.name);
            match known {
                Some(place) => parameters[place].range = wanted.range,
                None => parameters.push(wanted),
            }
            known.unwrap_or(parameters.len() - 1)
        })
        .collect();
    let white = Arc::clone(model);
    let bind = move |values: &[f64]| -> Arc<dyn System> {
        let system = white.bound(&values[..own]);
        let of_filter: Vec<f64> = places.iter().map(|&place| values[place]).collect();
        match kind.filter(&of_filter) {
            Some(filter) => Arc::new(Filtered::new(system, filter)),
            None => system,
        }
    };
    let described = model.axes.iter().cloned();
    let coloured = Model::new(&model.name, &model.title, bind)
        .with_statements(statements(model, kind, noises))
        .with_axes(described.chain(filters).collect::<Vec<_>>())
        .with_parameters(parameters)
        .with_source(&model.source)
        // What is said of built-in models beside their equations holds for white noise.
        .with_notes(model.typed().map_or(Vec::new(), |_| model.notes.clone()))
        .with_definitions(model.definitions().to_vec())
        .with_noise_kind(kind);
    Ok(match model.formulas() {
        Some(typed) => coloured.with_typed(typed.clone()),
        None => coloured,
    })
}

/// The axes of the filters, noise by noise.
fn filter_axes(kind: NoiseKind, noises: usize) -> Vec<AxisDescription> {
    const STATES: [(&str, &str, &str); 2] = [
        (NOISE_AXIS, "η", "coloured noise, of unit variance"),
        (
            NOISE_RATE_AXIS,
            "ν",
            "rate of the noise over its frequency, of unit variance",
        ),
    ];
    let states = &STATES[..kind.filter_states()];
    let numbers = 1..=noises;
    let axes = numbers.flat_map(|number| {
        states.iter().map(move |(name, symbol, meaning)| {
            let (name, symbol) = match noises {
                1 => ((*name).to_owned(), (*symbol).to_owned()),
                _ => (format!("{name}_{number}"), format!("{symbol}_{{{number}}}")),
            };
            AxisDescription::new(name, symbol, *meaning).carried_by_modes()
        })
    });
    axes.collect()
}

/// Axes and definitions must have other names than the noise, and than the parameters of its filter.
fn check_names(
    model: &Model,
    kind: NoiseKind,
    filters: &[AxisDescription],
) -> Result<(), ColouredNoiseError> {
    let axes = model.axes.iter().map(|axis| axis.name.as_str());
    let defined = model.definitions().iter().map(|(name, _)| name.as_str());
    let taken: Vec<&str> = axes.chain(defined).collect();
    let parameters = model.parameters.iter().map(|one| one.name.as_str());
    let needed = filters.iter().map(|axis| axis.name.as_str());
    let clash = needed
        .filter(|name| taken.contains(name) || parameters.clone().any(|one| one == *name))
        .map(str::to_owned)
        .next();
    let mut of_filter = kind.parameters().into_iter().map(|one| one.name);
    let clash = clash.or_else(|| of_filter.find(|name| taken.contains(&name.as_str())));
    match clash {
        Some(name) => Err(ColouredNoiseError::Taken { name }),
        None => Ok(()),
    }
}

/// The model's equations, and where its noises come from in place of what says that they are white.
fn statements(model: &Model, kind: NoiseKind, noises: usize) -> Vec<Statement> {
    let lines = model.equations.iter().cloned();
    let own = lines.zip(model.typeset().iter().cloned());
    let kept = own.filter(|(line, _)| !line.starts_with("E[ξ"));
    kept.chain(kind.statements(noises)).collect()
}
