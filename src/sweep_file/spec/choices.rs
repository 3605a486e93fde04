//! The parts of a specification that have defaults: method, observables, detection, location, figures.

use super::super::keys::SWITCH;
use crate::continuation::{LocateOptions, evenly_spaced};
use crate::density::Observable;
use crate::figure::Format;
use crate::generator::AdvectiveScheme;
use crate::method::{
    Correction, Estimator, GeneratorMethodOptions, MethodOptions, MonteCarloOptions, SgcmOptions,
    StepChoice,
};
use crate::sampling::Integrator;
use crate::stationary::Solver;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::reader::{Reader, Sited};
use crate::system::Model;
use crate::topology::DetectOptions;

use super::swept::Swept;

/// The settings of every method that the file has, chosen or not.
#[derive(Debug, Clone, PartialEq)]
pub struct EveryMethod {
    /// The generator's.
    pub generator: GeneratorMethodOptions,
    /// SGCM's.
    pub sgcm: SgcmOptions,
    /// Monte Carlo's.
    pub monte_carlo: MonteCarloOptions,
}

/// Reads `[method]`: the chosen one, and all; wrong values are reported and replaced by defaults. The settings of the method that
/// is not chosen are checked too, so that a file can hold both and `--set method.kind=…` switches.
pub(super) fn read_method(reader: &mut Reader) -> (MethodOptions, EveryMethod) {
    let every = EveryMethod {
        generator: read_generator(reader),
        sgcm: read_sgcm(reader),
        monte_carlo: read_monte_carlo(reader),
    };
    let all = every.clone();
    let kind = reader.text(&["method", "kind"]).map(|name| name.value);
    let chosen = match kind.as_deref() {
        Some("sgcm") => MethodOptions::Sgcm(all.sgcm),
        Some("monte-carlo") => MethodOptions::MonteCarlo(all.monte_carlo),
        Some("generator") => MethodOptions::Generator(all.generator),
        _ => match MethodOptions::default() {
            MethodOptions::Generator(_) => MethodOptions::Generator(all.generator),
            MethodOptions::Sgcm(_) => MethodOptions::Sgcm(all.sgcm),
            MethodOptions::MonteCarlo(_) => MethodOptions::MonteCarlo(all.monte_carlo),
        },
    };
    (chosen, every)
}

fn read_generator(reader: &Reader) -> GeneratorMethodOptions {
    let default = GeneratorMethodOptions::default();
    let scheme = reader.text(&["method", "scheme"]).and_then(|name| {
        AdvectiveScheme::ALL
            .into_iter()
            .find(|known| known.name() == name.value)
    });
    let number = |key| reader.number(&["method", key]).map(|number| number.value);
    GeneratorMethodOptions {
        scheme: scheme.unwrap_or(default.scheme),
        memory_limit: number("memory_limit").unwrap_or(default.memory_limit),
        solver_tolerance: number("solver_tolerance").unwrap_or(default.solver_tolerance),
        escape_limit: number("escape_limit").unwrap_or(default.escape_limit),
    }
}

fn read_sgcm(reader: &mut Reader) -> SgcmOptions {
    let default = SgcmOptions::default();
    let name = |reader: &Reader, key| reader.text(&["method", key]).map(|name| name.value);
    let integrator = read_integrator(reader);
    let solver = name(reader, "solver")
        .and_then(|name| Solver::ALL.into_iter().find(|known| known.name() == name));
    let correction = name(reader, "correction").and_then(|name| {
        Correction::ALL
            .into_iter()
            .find(|known| known.name() == name)
    });
    let number = |key| reader.number(&["method", key]).map(|number| number.value);
    let options = SgcmOptions {
        map_step: read_step(reader, "map_step").unwrap_or(default.map_step),
        time_step: read_step(reader, "time_step").unwrap_or(default.time_step),
        samples: integer(reader, "samples").unwrap_or(default.samples),
        seed: integer(reader, "seed").unwrap_or(default.seed),
        integrator: integrator.unwrap_or(default.integrator),
        replicates: integer(reader, "replicates").unwrap_or(default.replicates),
        correction: correction.unwrap_or(default.correction),
        solver: solver.unwrap_or(default.solver),
        solver_tolerance: number("solver_tolerance").unwrap_or(default.solver_tolerance),
        escape_limit: number("escape_limit").unwrap_or(default.escape_limit),
    };
    check_sgcm(reader, &options);
    options
}

fn read_integrator(reader: &Reader) -> Option<Integrator> {
    let name = reader.text(&["method", "integrator"])?.value;
    Integrator::ALL
        .into_iter()
        .find(|known| known.name() == name)
}

fn read_monte_carlo(reader: &Reader) -> MonteCarloOptions {
    let default = MonteCarloOptions::default();
    let estimator = reader.text(&["method", "estimator"]).and_then(|name| {
        Estimator::ALL
            .into_iter()
            .find(|known| known.name() == name.value)
    });
    let number = |key| reader.number(&["method", key]).map(|number| number.value);
    let step = |key, default| read_step(reader, key).unwrap_or(default);
    MonteCarloOptions {
        estimator: estimator.unwrap_or(default.estimator),
        time_step: step("time_step", default.time_step),
        burn_in: step("burn_in", default.burn_in),
        length: step("length", default.length),
        error: number("error").unwrap_or(default.error),
        trajectories: step("trajectories", default.trajectories),
        seed: integer(reader, "seed").unwrap_or(default.seed),
        integrator: read_integrator(reader).unwrap_or(default.integrator),
        escape_limit: number("escape_limit").unwrap_or(default.escape_limit),
    }
}

fn integer<T: TryFrom<i128>>(reader: &Reader, key: &str) -> Option<T> {
    reader
        .integer::<T>(&["method", key])
        .map(|integer| integer.value)
}

fn read_step(reader: &Reader, key: &str) -> Option<StepChoice> {
    let path = ["method", key];
    match (reader.number(&path), reader.text(&path)) {
        (Some(step), _) => Some(StepChoice::Fixed(step.value)),
        (None, Some(_)) => Some(StepChoice::Auto),
        (None, None) => None,
    }
}

/// Conditions between settings.
fn check_sgcm(reader: &mut Reader, options: &SgcmOptions) {
    if options.replicates > options.samples {
        let title = format!(
            "{} replicates cannot be made of {} samples a cell",
            options.replicates, options.samples
        );
        let diagnostic =
            Diagnostic::new(title).allowed("`method.replicates` at most `method.samples`");
        report_at(reader, diagnostic, &["replicates", "samples"]);
    }
    if let (StepChoice::Fixed(time_step), StepChoice::Fixed(map_step)) =
        (options.time_step, options.map_step)
        && time_step > map_step
    {
        let title = format!("time step {time_step} is longer than map step {map_step}");
        let diagnostic =
            Diagnostic::new(title).allowed("`method.time_step` at most `method.map_step`");
        report_at(reader, diagnostic, &["time_step", "map_step"]);
    }
}

/// Reports at the first of some keys of `[method]` that is given.
fn report_at(reader: &mut Reader, diagnostic: Diagnostic, keys: &[&str]) {
    let entry = keys.iter().find_map(|key| reader.entry(&["method", key]));
    let place = entry.map(|entry| entry.node.place.clone());
    reader.report(match place {
        Some(place) => diagnostic.at(&place, "given here"),
        None => diagnostic,
    });
}

/// Reads `detect.marginals` and `detect.joint`: marginals first, each in the order given.
pub(super) fn read_observables(reader: &mut Reader, model: &Model) -> Vec<Observable> {
    let dimension = model.axes.len();
    let mut observables: Vec<Observable> = Vec::new();
    match reader.texts(&["detect", "marginals"]) {
        Some(names) => {
            for name in names {
                if let Some(axis) = axis_index(reader, model, &name.value, &name) {
                    watch(reader, &mut observables, Observable::Marginal(axis), &name);
                }
            }
        }
        None => observables.extend((0..dimension).map(Observable::Marginal)),
    }
    match reader.pairs(&["detect", "joint"]) {
        Some(pairs) => {
            for pair in pairs {
                let one = axis_index(reader, model, &pair.value[0], &pair);
                let other = axis_index(reader, model, &pair.value[1], &pair);
                if let (Some(one), Some(other)) = (one, other) {
                    watch(
                        reader,
                        &mut observables,
                        Observable::Joint(one, other),
                        &pair,
                    );
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

fn axis_index<T>(reader: &mut Reader, model: &Model, name: &str, at: &Sited<T>) -> Option<usize> {
    let index = model.axes.iter().position(|axis| axis.name == name);
    if index.is_none() {
        let title = format!("model `{}` has no axis `{name}`", model.name);
        let names = model.axes.iter().map(|axis| axis.name.as_str());
        let diagnostic = Diagnostic::new(title).at(&at.place, "unknown axis");
        reader.report(diagnostic.nearest(name, names));
    }
    index
}

/// Adds an observable that is new and sound.
fn watch<T>(reader: &mut Reader, known: &mut Vec<Observable>, new: Observable, at: &Sited<T>) {
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
            reader.report(diagnostic.at(&at.place, label));
        }
    }
}

/// Reads the settings of `[detect]`.
pub(super) fn read_detect(reader: &Reader) -> DetectOptions {
    let default = DetectOptions::default();
    let number = |key| reader.number(&["detect", key]).map(|number| number.value);
    DetectOptions {
        confidence: number("confidence").unwrap_or(default.confidence),
        floor: number("floor").unwrap_or(default.floor),
    }
}

/// Reads `[locate]`.
pub(super) fn read_locate(reader: &Reader) -> LocateOptions {
    let default = LocateOptions::default();
    let number = |key| reader.number(&["locate", key]).map(|number| number.value);
    let check = reader.text(&["locate", "grid_check"]);
    LocateOptions {
        tolerance: number("tolerance").unwrap_or(default.tolerance),
        largest_distance: number("largest_distance").unwrap_or(default.largest_distance),
        grid_check: check.map_or(default.grid_check, |word| word.value == SWITCH[0]),
    }
}

/// Reads `figures.at`; left out, it is both ends and two of the sweep's values between.
pub(super) fn read_figures_at(reader: &mut Reader, swept: Option<&Swept>) -> Vec<f64> {
    let Some(swept) = swept else {
        return Vec::new();
    };
    let Some(values) = reader.numbers(&["figures", "at"]) else {
        let values = evenly_spaced(swept.family.ends(), swept.points);
        let steps = values.len() - 1;
        let mut chosen = vec![0, (steps + 1) / 3, (2 * steps + 1) / 3, steps];
        chosen.dedup();
        return chosen.into_iter().map(|index| values[index]).collect();
    };
    let (low, high) = swept.family.range();
    for value in &values {
        if !(low..=high).contains(&value.value) {
            let title = format!("`figures.at` has {}, outside the sweep", value.value);
            let diagnostic = Diagnostic::new(title)
                .at(
                    &value.place,
                    format!("`{}` never takes this value", swept.family.parameter()),
                )
                .allowed(format!("numbers from {low} to {high}"));
            reader.report(diagnostic);
        }
    }
    values.into_iter().map(|value| value.value).collect()
}

/// Reads `figures.formats`, each format once.
pub(super) fn read_formats(reader: &Reader) -> Vec<Format> {
    let Some(names) = reader.texts(&["figures", "formats"]) else {
        return Format::ALL.to_vec();
    };
    let listed = |format: &Format| names.iter().any(|name| name.value == format.name());
    Format::ALL.into_iter().filter(listed).collect()
}
