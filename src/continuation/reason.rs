//! Why a value is not located, in sentences that say what helps.

use super::measure::{DEVIATION, EDGE_MASS, MEAN};
use super::root::Root;
use super::{Finding, Goal, Point, PointStatus, Subject};
use crate::density::{Density, EstimatedDensity};
use crate::space::Axis;

/// The sentence for a value that finer cells could have checked, and have not.
pub(super) fn not_checked(options: &Goal) -> String {
    let why = match options.grid_check {
        false => "locate.grid_check is \"off\"",
        true => "the sweep ended before, or holds no checks",
    };
    format!("not checked on finer cells ({why}): its error lacks what the cells do to it")
}

/// The sentence for a value that cells, solver or sampling make uncertain.
pub(super) fn coarse(
    found: &Root,
    error: f64,
    options: &Goal,
    density: &EstimatedDensity,
) -> Option<String> {
    let parts = found.error;
    let sentence = match parts.sampling >= parts.grid.max(parts.solver) {
        true => format!(
            "samples move it by {:.1e}: more of them are needed",
            parts.sampling
        ),
        false if density.is_noisy() && parts.grid >= parts.solver => format!(
            "fits of other degrees move it by {:.1e}: more samples are needed",
            parts.grid
        ),
        false if parts.grid >= parts.solver => format!(
            "finer cells move it by {:.1e}: more cells are needed{}",
            parts.grid,
            how_many(parts.grid / options.tolerance, &density.density)
        ),
        false => format!(
            "errors of the solver and its bracket come to {:.1e}",
            parts.solver
        ),
    };
    (error > options.tolerance).then_some(sentence)
}

/// Times as many cells beyond which their number is not told: the order at which errors fall is not known that far.
const FARTHEST_GUESS: f64 = 4.0;

/// How many cells bring an error to half of what is wanted, at the order of two by which it falls at least.
fn how_many(excess: f64, density: &Density) -> String {
    let times = (2.0 * excess).sqrt();
    let cells = density.axes.iter().map(Axis::count).max().unwrap_or(0) as f64;
    match times > 1.0 && times <= FARTHEST_GUESS {
        true => format!(", about {:.0} an axis", (0.1 * cells * times).ceil() * 10.0),
        false => String::new(),
    }
}

/// What is wrong with a point, in words that say what helps.
pub(super) fn said_of(point: &Point, subject: &Subject) -> String {
    let word = point.report.status.word();
    match (point.report.status, wider(point, subject)) {
        (PointStatus::Escaping, Some(range)) => {
            format!("{word}: a wider range of {range} is needed")
        }
        _ => word.to_owned(),
    }
}

/// The sentence for a value that what leaves Ω makes uncertain.
pub(super) fn leaks(
    found: &Root,
    error: f64,
    options: &Goal,
    subject: &Subject,
    points: [&Point; 2],
) -> Option<String> {
    if error <= options.tolerance || found.error.leak < 0.5 * error {
        return None;
    }
    Some(format!(
        "what leaves Ω moves it by {:.1e}: a wider range of {} is needed",
        found.error.leak,
        wider(points[0], subject)?
    ))
}

/// Standard deviations from the mean that hold all but what does not matter of a density whose tails fall as the normal
/// one's.
const TAILS: f64 = 7.5;

/// The axis along which most of the mass leaves, and the range that would hold it.
fn wider(point: &Point, subject: &Subject) -> Option<String> {
    let report = &point.report;
    report.edge_mass()?;
    let names = || subject.family.model().axes.iter().map(|axis| &axis.name);
    let masses = names().filter_map(|name| Some((name, report.of(&EDGE_MASS, name)?)));
    let largest = masses
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(name, _)| name);
    // A table that is read back does not tell of which axis.
    let name = largest.or_else(|| names().next())?;
    let moments = (report.of(&MEAN, name), report.of(&DEVIATION, name));
    let (Some(mean), Some(deviation)) = moments else {
        return Some(name.clone());
    };
    let reach = TAILS * deviation;
    let ends = [mean - reach, mean + reach];
    Some(format!("{name} (about {:.2} to {:.2})", ends[0], ends[1]))
}

/// Share of a density's mass that may be negative where its shape is to be believed. What is negative must be positive
/// elsewhere, so that wiggles of this size hold as much mass as a small peak does.
pub(super) const MOST_NEGATIVE: f64 = 0.02;

/// Negative mass of a density, as a share of the whole.
pub(super) fn negative_share(density: &Density) -> f64 {
    let masses = density.masses();
    let negative: f64 = masses.iter().map(|mass| (-mass).max(0.0)).sum();
    negative / masses.iter().sum::<f64>().abs().max(f64::MIN_POSITIVE)
}

/// The sentence for a value read off a density that is not resolved.
pub(super) fn torn(wiggles: f64) -> String {
    format!(
        "{:.0} % of the density there is negative: wiggles that the cells do not resolve",
        100.0 * wiggles
    )
}

/// The sentence for a value read off densities whose kink lies inside cells: their shape follows where in its cell the
/// jump of the drift is, and as that moves along a sweep peaks come and go.
pub(super) fn jump_inside_cells(point: &Point, subject: &Subject) -> Option<String> {
    let mut findings = point.report.findings.iter();
    findings.find_map(|finding| match *finding {
        Finding::JumpInsideCells { axis, at } => {
            let axis = subject.family.axis(axis);
            Some(format!(
                "the drift jumps at {axis} = {at:.4}, inside cells: a face there, or as {axis} the distance from it, \
                 would show the kink"
            ))
        }
        _ => None,
    })
}

/// The sentence for a value read off densities that too few modes carry.
pub(super) fn change_by_modes(point: &Point) -> Option<String> {
    let mut findings = point.report.findings.iter();
    findings.find_map(|finding| match finding {
        Finding::FewModes { change } => Some(format!(
            "more modes change the densities by {change:.1e}: more of them are needed"
        )),
        _ => None,
    })
}
