//! `pbif check`: the resolved sweep and what it will cost. Runs nothing.

mod equations;

use std::io;
use std::path::Path;

use crate::continuation::evenly_spaced;
use crate::exponent::of_family;
use crate::method::{
    Cost, GeneratorCost, MethodOptions, MonteCarloCost, SgcmCost, StepChoice,
    cost_of_largest_exponent, wants_face,
};
use crate::run::fixed_point_in_words;
use crate::stationary::generator::RateError;
use crate::sweep_file::{MethodKind, Sweep, bytes_in_words, machine_memory};
use crate::system::ExponentMethod;

/// Points beyond which a sweep is said to be long.
const MANY_POINTS: usize = 1000;

/// What `pbif check` prints: the resolved file, then the cost as comments, so that the whole is a sweep file.
///
/// # Errors
/// None in practice: writing to memory does not fail.
pub(super) fn text(file: &Path, spec: &Sweep) -> io::Result<String> {
    let mut text = format!("# {}: no errors. Complete, it reads\n\n", file.display());
    text += &spec.to_toml();
    for line in equations::lines(spec) {
        text += &format!("{line}\n");
    }
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
    let axes = spec.problem.space().axes().iter();
    let shape: Vec<String> = axes
        .map(|axis| {
            if axis.is_modes() {
                format!("{} modes", axis.count())
            } else {
                axis.count().to_string()
            }
        })
        .collect();
    let cells = spec.problem.space().n_cells();
    let mut lines = vec![format!("cells: {} = {cells}", shape.join(" x "))];
    lines.extend(spec.settings.chosen.iter().cloned());
    lines.push(points(spec));
    lines.extend(exponent(spec));
    lines.extend(match costs_of_a_point(spec) {
        Ok(Cost::Generator(cost)) => generator_costs(spec, &cost),
        Ok(Cost::Sgcm(cost)) => sgcm_costs(spec, &cost),
        Ok(Cost::MonteCarlo(cost)) => monte_carlo_costs(spec, &cost),
        Err(error) => vec![unknowns(spec), error.to_string()],
    });
    if spec.settings.map.is_none() {
        let kept = bytes_in_words(spec.kept_bytes());
        lines.push(format!("kept: {kept}, the densities of all points"));
    }
    lines
}

fn costs_of_a_point(spec: &Sweep) -> Result<Cost, RateError> {
    spec.settings.method.chosen().cost(spec.problem.space())
}

fn unknowns(spec: &Sweep) -> String {
    let scheme = spec.settings.method.generator.scheme.name();
    format!(
        "unknowns: {}, scheme {scheme}",
        spec.problem.space().n_cells()
    )
}

fn generator_costs(spec: &Sweep, cost: &GeneratorCost) -> Vec<String> {
    let sessions = spec.sessions();
    let (method, locate) = (&spec.settings.method.generator, &spec.settings.locate);
    let checks = method.bytes_of_checks(spec.problem.space(), locate.grid_check);
    let all = sessions as f64 * cost.bytes + checks;
    vec![
        unknowns(spec),
        format!(
            "memory: {}, {} of it for factors ({}){}; up to {} while located rows are checked",
            bytes_in_words(sessions as f64 * cost.bytes),
            bytes_in_words(sessions as f64 * cost.factors.factor_bytes as f64),
            cost.factors.method.name(),
            match sessions {
                1 => String::new(),
                sessions => format!("; {sessions} parts of the sweep are solved side by side"),
            },
            bytes_in_words(all)
        ),
        format!(
            "time: a factorisation takes {:.1e} operations, about {:.2} s on two cores; most points reuse a neighbour's",
            cost.factors.operations,
            cost.factorisation_seconds()
        ),
    ]
}

fn sgcm_costs(spec: &Sweep, cost: &SgcmCost) -> Vec<String> {
    let steps = match cost.steps {
        Some(steps) => format!(
            "time steps: {steps} a trajectory, at most {:.3e} a point",
            steps * cost.trajectories
        ),
        None => "time steps: chosen when the sweep runs (a step is \"auto\")".to_owned(),
    };
    let passages = spec.problem.family().questions.passages.len();
    let [least, most] = SgcmCost::PASSAGE_PATHS;
    let passages = (passages > 0).then(|| {
        format!("passages: {passages} a point, {least} to {most} pairs of paths a cell each")
    });
    let mut costs = vec![
        format!(
            "memory: {} to {} (every cell reaches 2^d others; every sample ends in a cell of its own)",
            bytes_in_words(cost.least_bytes),
            bytes_in_words(cost.most_bytes)
        ),
        format!(
            "trajectories: at most {:.3e} a point ({} a cell)",
            cost.trajectories, spec.settings.method.sgcm.samples
        ),
        steps,
    ];
    costs.extend(passages);
    costs
}

fn monte_carlo_costs(spec: &Sweep, cost: &MonteCarloCost) -> Vec<String> {
    let steps = match (cost.steps, cost.seconds()) {
        (Some(steps), Some(seconds)) => {
            format!("time steps: {steps:.3e} a point, about {seconds:.1} s on two cores")
        }
        _ => format!(
            "time steps: chosen when the sweep runs, for a relative error of {} of the variances; they grow with 1/error²",
            spec.settings.method.monte_carlo.error
        ),
    };
    let mut costs = vec![format!("memory: {}", bytes_in_words(cost.bytes)), steps];
    let passages = spec.problem.family().questions.passages.len();
    if passages > 0 {
        let options = &spec.settings.method.monte_carlo;
        let seconds = match options.longest_passage {
            StepChoice::Auto => format!(", at most {:.0} s", MonteCarloCost::PASSAGE_SECONDS),
            StepChoice::Fixed(_) => String::new(),
        };
        let paths = options.passages;
        costs.push(format!(
            "passages: {passages} a point, {paths} paths{seconds} each"
        ));
        let asked = spec.problem.family().questions.passages.iter();
        let transitions = asked.filter(|one| one.transitions.is_some()).count();
        if transitions > 0 {
            costs.push(format!(
                "transitions: of {transitions} passages a point, until {paths} are counted{seconds} each"
            ));
        }
    }
    let visits = spec.problem.family().questions.visits.len();
    if visits > 0 {
        let paths = spec.settings.method.monte_carlo.passages;
        costs.push(format!(
            "visits: of {visits} regions a point, until {paths} are counted each"
        ));
    }
    costs
}

/// How many points, and where the first lie.
fn points(spec: &Sweep) -> String {
    if let Some(map) = &spec.settings.map {
        let (columns, rows) = (spec.settings.points, map.points);
        let curves = if map.curves {
            ", and those of the curves"
        } else {
            ""
        };
        return format!(
            "points: {columns} x {rows} = {} of the coarse grid of the map, more where signatures differ{curves}",
            columns * rows
        );
    }
    let values = evenly_spaced(spec.problem.family().ends(), spec.settings.points);
    let curves = match &spec.settings.curve {
        Some(curve) => format!(
            "; then the curves of rows in the plane of {} and {}",
            spec.problem.family().parameter(),
            curve.parameter
        ),
        None => String::new(),
    };
    let first: Vec<String> = values.iter().take(3).map(f64::to_string).collect();
    format!(
        "points: {} ({} = {}, ...), and a few more for each change that is located{curves}",
        spec.settings.points,
        spec.problem.family().parameter(),
        first.join(", ")
    )
}

/// What is worked out of a fixed point, with the exponents at both ends.
fn exponent(spec: &Sweep) -> Option<String> {
    let family = spec.problem.family();
    match family.questions.largest_exponent {
        Some(ExponentMethod::Modes) => return Some(along_density(spec)),
        Some(ExponentMethod::Trajectories) => {
            return Some(format!(
                "{ALONG}; {:.0e} steps of trajectories at each",
                family.questions.exponent_steps
            ));
        }
        None => {}
    }
    let state = fixed_point_in_words(family)?;
    let (from, to) = family.ends();
    let at = |value: f64| match of_family(family, value) {
        Some(Ok(found)) => format!("{:.4e}", found.value),
        _ => "unknown".to_owned(),
    };
    Some(format!(
        "exponent: the largest Lyapunov exponent of the fixed point {state} at every value ({} at {from}, {} at {to}), and its zeros \
         as rows `DB`; where it is negative no density is looked for",
        at(from),
        at(to)
    ))
}

/// What is worked out along the density.
const ALONG: &str = "exponent: the largest Lyapunov exponent along the stationary density at every value, and its zeros as rows `DB`";

/// What is worked out along the density, and what that takes.
fn along_density(spec: &Sweep) -> String {
    let words = ALONG;
    let MethodOptions::Generator(options) = spec.settings.method.chosen() else {
        return words.to_owned();
    };
    match cost_of_largest_exponent(spec.problem.space(), &options) {
        Some(cost) => format!(
            "{words}; most values take about {:.0} s more on two cores for it, and {} of memory",
            2.0 * cost.factorisation_seconds(),
            bytes_in_words(spec.sessions() as f64 * cost.bytes)
        ),
        None => words.to_owned(),
    }
}

/// What a user should know before the run.
fn notes(spec: &Sweep) -> Vec<String> {
    let mut notes = misplaced_faces(spec);
    notes.extend(equations::notes(spec));
    if spec.settings.points > MANY_POINTS && spec.settings.map.is_none() {
        notes.push(format!(
            "{} points is a long sweep; changes are located between points, so fewer will do",
            spec.settings.points
        ));
    }
    let at_work = costs_of_a_point(spec).map_or(0.0, |cost| cost.most_bytes());
    let most = spec.sessions() as f64 * at_work + spec.kept_bytes();
    if let Some(memory) = machine_memory().filter(|&memory| most > memory) {
        let memory = bytes_in_words(memory);
        let remedy = match spec.settings.method.kind {
            MethodKind::Sgcm => "; a shorter map step spreads less",
            MethodKind::Generator | MethodKind::MonteCarlo => "; fewer cells or points take less",
        };
        notes.push(format!(
            "this machine has {memory} of memory, which may not be enough{remedy}"
        ));
    }
    notes
}

/// Where a face belongs.
#[derive(Clone, Copy, PartialEq)]
enum FaceOn {
    Surface,
    Centre,
}

/// Surfaces and centres of symmetry that lie inside a cell.
fn misplaced_faces(spec: &Sweep) -> Vec<String> {
    let family = spec.problem.family();
    // A path's ends are allowed; without a system there would be nothing to say.
    let Ok(system) = family.at(family.ends().0) else {
        return Vec::new();
    };
    let mut wanted: Vec<(usize, f64, FaceOn)> = Vec::new();
    let systems = family.along().unwrap_or_default();
    for &surface in &system.facts().switching_surfaces {
        if wants_face(&systems, surface, spec.problem.space()) {
            wanted.push((surface.axis, surface.at, FaceOn::Surface));
        }
    }
    if let Some(symmetry) = &system.facts().symmetry {
        let axes = symmetry.reflected.iter().zip(&symmetry.centre).enumerate();
        for (axis, (&reflected, &centre)) in axes {
            let known = wanted
                .iter()
                .any(|&(other, at, _)| other == axis && at == centre);
            if reflected && !known {
                wanted.push((axis, centre, FaceOn::Centre));
            }
        }
    }
    let mut notes = Vec::new();
    for (index, at, what) in wanted {
        let Some(axis) = spec.problem.space().axes().get(index) else {
            continue;
        };
        if !axis.is_modes() && axis.is_inside_cell(at) {
            let (name, count) = (family.axis(index), axis.count());
            // Faces lie on surfaces that stay where they are.
            let remedy = if what == FaceOn::Surface && !axis.is_closed() {
                "faces do not follow it along the sweep, and what happens at it is told in a band; write the equations \
                 in the distance from it, so that it stays"
                    .to_owned()
            } else {
                format!(
                    "give a range with {at} in its middle and an even `cells.{name}.count` (now {count}), or grade the \
                     axis toward it"
                )
            };
            let what = match what {
                FaceOn::Surface => "the switching surface",
                FaceOn::Centre => "the centre of symmetry",
            };
            notes.push(format!("{what} {name} = {at} lies inside a cell: {remedy}"));
        }
    }
    notes
}
