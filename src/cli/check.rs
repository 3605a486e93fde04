//! `pbif check`: the resolved sweep and what it will cost. Runs nothing.

use std::io;
use std::path::Path;

use crate::method::{
    GeneratorMethodOptions, MethodOptions, MonteCarloOptions, SgcmOptions, StepChoice,
};

use crate::continuation::evenly_spaced;
use crate::method::cost;
use crate::stationary::generator::Estimate;
use crate::sweep_file::{MethodKind, Sweep};

/// Points beyond which a sweep is said to be long.
const MANY_POINTS: usize = 1000;

/// What `pbif check` prints: the resolved file, then the cost as comments, so that the whole is a sweep file.
///
/// # Errors
/// None in practice: writing to memory does not fail.
pub(super) fn text(file: &Path, spec: &Sweep) -> io::Result<String> {
    let mut text = format!("# {}: no errors. Complete, it reads\n\n", file.display());
    text += &spec.to_toml();
    text += "\n# Cost\n";
    for line in costs(spec) {
        text += &format!("# {line}\n");
    }
    let notes = notes(spec);
    if !notes.is_empty() {
        text += "\n# Notes\n";
    }
    for note in notes {
        text += &format!("# - {note}\n");
    }
    Ok(text)
}

fn costs(spec: &Sweep) -> Vec<String> {
    let shape: Vec<String> = spec
        .problem
        .space()
        .shape()
        .iter()
        .map(usize::to_string)
        .collect();
    let cells = spec.problem.space().n_cells();
    let mut lines = vec![
        format!("cells: {} = {cells}", shape.join(" x ")),
        points(spec),
    ];
    match spec.settings.method.chosen() {
        MethodOptions::Generator(options) => lines.extend(generator_costs(spec, &options)),
        MethodOptions::Sgcm(options) => lines.extend(sgcm_costs(spec, &options)),
        MethodOptions::MonteCarlo(options) => lines.extend(monte_carlo_costs(spec, &options)),
    }
    lines
}

/// Seconds of a factorisation on two ordinary cores: large fronts run at 5e10 operations a second, small ones are
/// bound by memory, 4e8 bytes of factors a second. Measured (`docs/accuracy.md`), good to a factor of two.
fn factorisation_seconds(factors: &Estimate) -> f64 {
    factors.operations / 5e10 + factors.factor_bytes as f64 / 4e8
}

fn generator_costs(spec: &Sweep, options: &GeneratorMethodOptions) -> Vec<String> {
    let unknowns = format!(
        "unknowns: {}, scheme {}",
        spec.problem.space().n_cells(),
        options.scheme.name()
    );
    match cost::factorisation(spec.problem.space(), options) {
        Ok(factors) => vec![
            unknowns,
            format!(
                "memory: {}, {} of it for factors ({})",
                cost::bytes_in_words(cost::generator_bytes(
                    spec.problem.space(),
                    options,
                    &factors
                )),
                cost::bytes_in_words(factors.factor_bytes as f64),
                factors.method.name()
            ),
            format!(
                "time: a factorisation takes {:.1e} operations, about {:.2} s on two cores; most points reuse a neighbour's",
                factors.operations,
                factorisation_seconds(&factors)
            ),
        ],
        Err(error) => vec![unknowns, error.to_string()],
    }
}

fn sgcm_costs(spec: &Sweep, options: &SgcmOptions) -> Vec<String> {
    let cells = spec.problem.space().n_cells();
    let trajectories = cells as f64 * options.samples as f64;
    let most = cost::estimated_bytes(cells as f64, spec.problem.space().dimension(), options);
    let least = cost::least_bytes(
        cells as f64,
        spec.problem.space().dimension(),
        &spec.settings.method.chosen(),
    );
    let steps = match (options.map_step, options.time_step) {
        (StepChoice::Fixed(map_step), StepChoice::Fixed(time_step)) => {
            let steps = (map_step / time_step).ceil();
            format!(
                "time steps: {steps} a trajectory, at most {:.3e} a point",
                steps * trajectories
            )
        }
        _ => "time steps: chosen when the sweep runs (a step is \"auto\")".to_owned(),
    };
    vec![
        format!(
            "memory: {} to {} (every cell reaches 2^d others; every sample ends in a cell of its own)",
            cost::bytes_in_words(least),
            cost::bytes_in_words(most)
        ),
        format!(
            "trajectories: at most {trajectories:.3e} a point ({} a cell)",
            options.samples
        ),
        steps,
    ]
}

/// Steps a second by Heun's integrator with looks, on two ordinary cores. Measured (`docs/monte-carlo.md`), good to a factor of
/// two.
const STEPS_A_SECOND: f64 = 3e8;

fn monte_carlo_costs(spec: &Sweep, options: &MonteCarloOptions) -> Vec<String> {
    let memory = cost::monte_carlo_bytes(spec.problem.space().n_cells() as f64);
    let steps = match cost::monte_carlo_steps(options) {
        Some(steps) => format!(
            "time steps: {steps:.3e} a point, about {:.1} s on two cores",
            steps / STEPS_A_SECOND
        ),
        None => format!(
            "time steps: chosen when the sweep runs, for a relative error of {} of the variances; they grow with 1/error²",
            options.error
        ),
    };
    vec![format!("memory: {}", cost::bytes_in_words(memory)), steps]
}

/// How many points, and where the first lie.
fn points(spec: &Sweep) -> String {
    let values = evenly_spaced(spec.problem.family().ends(), spec.settings.points);
    let first: Vec<String> = values.iter().take(3).map(f64::to_string).collect();
    format!(
        "points: {} ({} = {}, ...), and a few more for each change that is located",
        spec.settings.points,
        spec.problem.family().parameter(),
        first.join(", ")
    )
}

/// What a user should know before the run.
fn notes(spec: &Sweep) -> Vec<String> {
    let mut notes = misplaced_faces(spec);
    if spec.settings.points > MANY_POINTS {
        notes.push(format!(
            "{} points is a long sweep; changes are located between points, so fewer will do",
            spec.settings.points
        ));
    }
    let most = match spec.settings.method.chosen() {
        MethodOptions::Generator(options) => {
            let space = spec.problem.space();
            cost::factorisation(space, &options).map_or(0.0, |factors| {
                cost::generator_bytes(space, &options, &factors)
            })
        }
        MethodOptions::Sgcm(options) => {
            let cells = spec.problem.space().n_cells() as f64;
            cost::estimated_bytes(cells, spec.problem.space().dimension(), &options)
        }
        MethodOptions::MonteCarlo(_) => {
            cost::monte_carlo_bytes(spec.problem.space().n_cells() as f64)
        }
    };
    if let Some(memory) = cost::machine_memory().filter(|&memory| most > memory) {
        let memory = cost::bytes_in_words(memory);
        let remedy = match spec.settings.method.kind {
            MethodKind::Sgcm => "; a shorter map step spreads less",
            MethodKind::Generator | MethodKind::MonteCarlo => "; fewer cells take less",
        };
        notes.push(format!(
            "this machine has {memory} of memory, which may not be enough{remedy}"
        ));
    }
    notes
}

/// Surfaces and centres of symmetry that lie inside a cell.
fn misplaced_faces(spec: &Sweep) -> Vec<String> {
    let family = spec.problem.family();
    // A path's ends are allowed; without a system there would be nothing to say.
    let Ok(system) = family.at(family.ends().0) else {
        return Vec::new();
    };
    let mut wanted: Vec<(usize, f64, &str)> = Vec::new();
    for surface in system.switching_surfaces() {
        wanted.push((surface.axis, surface.at, "the switching surface"));
    }
    if let Some(symmetry) = system.symmetry() {
        let axes = symmetry.reflected.iter().zip(&symmetry.centre).enumerate();
        for (axis, (&reflected, &centre)) in axes {
            let known = wanted
                .iter()
                .any(|&(other, at, _)| other == axis && at == centre);
            if reflected && !known {
                wanted.push((axis, centre, "the centre of symmetry"));
            }
        }
    }
    let mut notes = Vec::new();
    for (index, at, what) in wanted {
        let Some(axis) = spec.problem.space().axes().get(index) else {
            continue;
        };
        if axis.is_inside_cell(at) {
            let (name, count) = (family.axis(index), axis.count());
            notes.push(format!(
                "{what} {name} = {at} lies inside a cell: give a range with {at} in its middle and an even \
                 `cells.{name}.count` (now {count}), or grade the axis toward it",
            ));
        }
    }
    notes
}
