//! Findings gathered for people: each kind once, with the parameter values it concerns.

use super::{finding_in_words, format_number};
use crate::compare::{Comparison, Method};
use crate::continuation::{Finding, Point};
use crate::system::Family;

/// What rounding leaves of a value, as a share of the sweep.
const ROUNDING: f64 = 1e-9;
/// Digits after the first of values that are told.
const DIGITS: usize = 8;

/// Findings of one kind: the first is quoted, the others are counted.
struct Gathered<'a> {
    finding: &'a Finding,
    /// First and last parameter value.
    values: (f64, f64),
    /// Number of parameter values.
    count: usize,
}

/// The warnings of all points: each kind of finding once, in the numbers of its first.
pub(crate) fn warnings_of_points(family: &Family, points: &[Point]) -> Vec<String> {
    let mut kinds: Vec<Gathered<'_>> = Vec::new();
    for point in points {
        for finding in &point.report.findings {
            let known = kinds
                .iter_mut()
                .find(|one| one.finding.kind() == finding.kind());
            match known {
                // Two surfaces at one value are one value.
                Some(kind) if kind.values.1 == point.value => {}
                Some(kind) => {
                    kind.values.1 = point.value;
                    kind.count += 1;
                }
                None => kinds.push(Gathered {
                    finding,
                    values: (point.value, point.value),
                    count: 1,
                }),
            }
        }
    }
    kinds.iter().map(|kind| kind.sentence(family)).collect()
}

impl Gathered<'_> {
    fn sentence(&self, family: &Family) -> String {
        let (first, last) = (told(family, self.values.0), told(family, self.values.1));
        let words = finding_in_words(family, self.finding);
        let parameter = family.parameter();
        match self.count {
            1 => format!("{parameter} = {first}: {words}"),
            2 => format!("{parameter} = {first}: {words} (and the like at {last})"),
            count => format!(
                "{parameter} = {first}: {words} (and the like at {} more values up to {last})",
                count - 1
            ),
        }
    }
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
