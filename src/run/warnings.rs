//! Findings gathered for people: each kind once, with the parameter values it concerns.

use super::{finding_in_words, format_number, format_with_error};
use crate::compare::{Comparison, Method};
use crate::continuation::map::RegimeMap;
use crate::continuation::{Finding, Point};
use crate::system::Family;

/// What rounding leaves of a value, as a share of the sweep.
const ROUNDING: f64 = 1e-9;
/// How exactly places of a map are told, as a share of the sides of its box.
const NEAR: f64 = 1e-3;
/// Digits after the first of values that are told.
const DIGITS: usize = 8;

/// Findings of one kind: the first is quoted, the others are counted.
struct Gathered<'a, P> {
    finding: &'a Finding,
    /// The first and the last place at which it is found.
    places: [P; 2],
    /// Number of places.
    count: usize,
}

/// Findings by their kinds, those of one place together in their order; several of a kind at one place count once.
fn gathered<'a, P: Copy + PartialEq>(
    all: impl Iterator<Item = (P, &'a Vec<Finding>)>,
) -> Vec<Gathered<'a, P>> {
    let mut kinds: Vec<Gathered<'_, P>> = Vec::new();
    for (place, finding) in all.flat_map(|(place, own)| own.iter().map(move |one| (place, one))) {
        let mut known = kinds.iter_mut();
        match known.find(|one| one.finding.kind() == finding.kind()) {
            Some(kind) if kind.places[1] == place => {}
            Some(kind) => {
                kind.places[1] = place;
                kind.count += 1;
            }
            None => kinds.push(Gathered {
                finding,
                places: [place; 2],
                count: 1,
            }),
        }
    }
    kinds
}

/// The warnings of the nodes of a map: each kind of finding once, in the numbers of its first node.
pub(crate) fn warnings_of_nodes(map: &RegimeMap) -> Vec<String> {
    let family = &map.subject.family;
    let nodes = map.nodes.iter();
    let kinds = gathered(nodes.map(|node| (node.values, &node.findings)));
    let sides = map.plane.sides();
    let sentence = |kind: &Gathered<'_, [f64; 2]>| {
        let place = [0, 1].map(|k| {
            let side = &sides[k];
            let value = format_with_error(kind.places[0][k], NEAR * side.length()).0;
            format!("{} = {value}", side.parameter)
        });
        let words = finding_in_words(family, kind.finding);
        let more = match kind.count - 1 {
            0 => String::new(),
            1 => " (and the like at 1 more node)".to_owned(),
            more => format!(" (and the like at {more} more nodes)"),
        };
        format!("{}: {words}{more}", place.join(", "))
    };
    let mut told: Vec<String> = kinds.iter().map(sentence).collect();
    let wide = map.nodes_with_wide_cells();
    if wide > 0 {
        let nodes = map.nodes.len();
        told.push(format!(
            "at {wide} of {nodes} nodes the cells are too wide to count by: signatures there may be wrong"
        ));
    }
    told
}

/// The warnings of all points: each kind of finding once, in the numbers of its first.
pub(crate) fn warnings_of_points(family: &Family, points: &[Point]) -> Vec<String> {
    let parameter = family.parameter();
    // Two surfaces at one value are one value.
    let kinds = gathered((points.iter()).map(|point| (point.value, &point.report.findings)));
    let sentence = |kind: &Gathered<'_, f64>| {
        let [first, last] = kind.places.map(|value| told(family, value));
        let words = finding_in_words(family, kind.finding);
        match kind.count {
            1 => format!("{parameter} = {first}: {words}"),
            2 => format!("{parameter} = {first}: {words} (and the like at {last})"),
            count => format!(
                "{parameter} = {first}: {words} (and the like at {} more values up to {last})",
                count - 1
            ),
        }
    };
    kinds.iter().map(sentence).collect()
}

/// A value of the parameter without what rounding leaves: `-0.075` for -0.07500000000000001.
fn told(family: &Family, value: f64) -> String {
    let (from, to) = family.range();
    if value.abs() < ROUNDING * (to - from) {
        return format_number(0.0);
    }
    let short = format!("{value:.*e}", DIGITS).parse().unwrap_or(value);
    format_number(short)
}

/// What methods say of themselves and of each other: each kind of finding once a method, at its first value.
pub(crate) fn warnings_of_comparison(family: &Family, comparison: &Comparison) -> Vec<String> {
    let mut seen: Vec<(Method, _)> = Vec::new();
    let mut warnings = Vec::new();
    for value in &comparison.values {
        let at = format!("{} = {}", family.parameter(), told(family, value.value));
        if let Some((rate, outside)) = value.leaves() {
            warnings.push(format!(
                "{at}: generator and Monte Carlo disagree, and mass leaves Ω (at a rate of {rate:.1e}; Monte Carlo is outside for {outside:.1e} of the time); the generator's density is that of what never left, Monte Carlo's of what is inside: wider ranges tell whether that is why"
            ));
        }
        for solved in &value.solved {
            for finding in &solved.report.findings {
                let kind = (solved.method, finding.kind());
                if !seen.contains(&kind) {
                    seen.push(kind);
                    let words = finding_in_words(family, finding);
                    warnings.push(format!("{} at {at}: {words}", solved.method.name()));
                }
            }
        }
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::SolveReport;
    use crate::system::test_families::coulomb;

    #[test]
    fn each_kind_is_told_once_whatever_its_numbers() {
        let family = coulomb();
        let edge = |axis, mass| Finding::EdgeMass {
            axis,
            mass,
            range: [-8.0, 8.0],
        };
        let off = |at| Finding::SurfaceOffFaces { axis: 1, at };
        let found = [
            (0.5, vec![edge(0, 0.125), off(-1.0), off(1.0)]),
            // Numbers of another length, sign and power are the same kind; another axis is not.
            (0.250_000_000_000_000_06, vec![edge(0, 1e7), off(-1e-7)]),
            (1.019e-17, vec![edge(1, 0.5)]),
        ];
        let points = found.map(|(value, findings)| Point {
            value,
            report: SolveReport {
                findings,
                ..SolveReport::solved("generator")
            },
            densities: Vec::new(),
            detections: Vec::new(),
            distance: None,
            seconds: 0.0,
        });
        let told = warnings_of_points(&family, &points);
        let starts = [
            "f_c = 0.5: 12.50 % of the mass lies in the outermost cells of x: ",
            "f_c = 0.5: no face of y falls on the switching surface at -1: ",
            "f_c = 0: 50.00 % of the mass lies in the outermost cells of y: ",
        ];
        assert_eq!(told.len(), starts.len(), "{told:?}");
        for (told, start) in told.iter().zip(starts) {
            assert!(told.starts_with(start), "{told}");
        }
        assert!(told[0].ends_with("(and the like at 0.25)"));
        assert!(told[1].ends_with("(and the like at 0.25)"));
        assert!(!told[2].contains("the like"));
    }
}
