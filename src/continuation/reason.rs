//! Why a value is not located, in sentences that say what helps.

use super::change::Crossing;
use super::root::Root;
use super::{Finding, Goal, Point, PointStatus, Subject};
use crate::density::{Density, EstimatedDensity};
use crate::space::Axis;
use crate::topology::Indicator;

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

/// Standard deviations from the mean that hold all but what does not matter of a density whose tails fall as the normal one's.
const TAILS: f64 = 7.5;

/// The axis along which most of the mass leaves, and the range that would hold it.
fn wider(point: &Point, subject: &Subject) -> Option<String> {
    let masses = &point.report.edge_mass;
    let axis = (0..masses.len()).max_by(|&a, &b| masses[a].total_cmp(&masses[b]))?;
    let name = &subject.family.model().axes.get(axis)?.name;
    let Some(moments) = point.moments.get(axis) else {
        return Some(name.clone());
    };
    let reach = TAILS * moments.standard_deviation;
    let ends = [moments.mean - reach, moments.mean + reach];
    Some(format!("{name} (about {:.2} to {:.2})", ends[0], ends[1]))
}

/// Share of a density's mass that may be negative where its shape is to be believed. What is negative must be positive elsewhere, so
/// that wiggles of this size hold as much mass as a small peak does.
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

/// Times as steep as beside a bracket that an indicator must be inside it to have jumped. A smooth one is as steep, within a few times.
const JUMP: f64 = 30.0;

/// The sentence for an indicator that jumps to the other side of zero in place of passing it, because what it is read from changes there.
pub(super) fn jump(points: &[&Point], crossing: &Crossing) -> Option<String> {
    let (left, right) = (crossing.left, crossing.left + 1);
    let slope = |a: (usize, &Indicator), b: (usize, &Indicator)| {
        ((b.1.value - a.1.value) / (points[b.0].value - points[a.0].value)).abs()
    };
    let [below, above] = [(left, &crossing.ends[0]), (right, &crossing.ends[1])];
    let inside = slope(below, above);
    let beyond = |end: (usize, &Indicator), index: Option<usize>| {
        let index = index.filter(|&index| index < points.len())?;
        let same = |one: &&Indicator| one.kind == end.1.kind && one.value * end.1.value > 0.0;
        let others = &points[index]
            .detections
            .get(crossing.observable)?
            .indicators;
        let apart = |one: &Indicator| distance(&one.place, &end.1.place);
        let mut others: Vec<&Indicator> = others.iter().filter(same).collect();
        others.sort_by(|a, b| apart(a).total_cmp(&apart(b)));
        Some(slope((index, others.first()?), end))
    };
    let outside = [
        beyond(below, left.checked_sub(1)),
        beyond(above, Some(right + 1)),
    ];
    let mut outside = outside.into_iter().flatten().peekable();
    let jumps = outside.peek().is_some() && outside.all(|slope| inside > JUMP * slope);
    jumps.then(|| {
        "the slope or curvature that tells of it jumps there in place of passing zero: a wider range or more cells may show why".to_owned()
    })
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}

/// Cells from an end of Ω up to which the end takes part in what is read there.
const NEAR_AN_END: usize = 8;
/// Share of the largest density below which there is next to none.
const NEXT_TO_NONE: f64 = 1e-12;

/// The sentence for a value that is read beside an end of Ω where there is next to no density: what comes and goes there the end may have made.
pub(super) fn beside_an_end(density: &Density, place: &[f64]) -> Option<String> {
    let mut index = 0;
    let mut cells = usize::MAX;
    for (axis, &at) in density.axes.iter().zip(place) {
        let cell = axis.find(at)?;
        index = index * axis.count() + cell;
        cells = cells.min(cell).min(axis.count() - 1 - cell);
    }
    let value = density.values.get(index)?.abs();
    (cells < NEAR_AN_END && value < NEXT_TO_NONE * density.maximum()).then(|| {
        format!(
            "{cells} cells from an end of Ω, where there is next to no density: a wider range is needed"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::{NEAR_AN_END, beside_an_end};
    use crate::density::Density;
    use crate::space::Axis;

    #[test]
    fn only_what_is_low_and_beside_an_end_is_doubted() {
        let axis = Axis::uniform(-8.0, 8.0, 80).unwrap();
        let values = axis.centres().iter().map(|x| (-x * x).exp()).collect();
        let density = Density {
            axes: vec![axis],
            values,
        };
        assert!(beside_an_end(&density, &[7.5]).is_some());
        assert!(beside_an_end(&density, &[-7.9]).is_some());
        // Low, but far from the ends; and near an end, but not low.
        assert_eq!(beside_an_end(&density, &[5.9]), None);
        let axis = Axis::uniform(0.0, 1.0, 4 * NEAR_AN_END).unwrap();
        let values = vec![1.0; axis.count()];
        let even = Density {
            axes: vec![axis],
            values,
        };
        assert_eq!(beside_an_end(&even, &[0.01]), None);
    }
}
