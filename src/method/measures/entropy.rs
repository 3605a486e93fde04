//! The differential entropy of every joint density that is watched, S = -∫ p ln p: how far the state is spread, and how
//! uncertain it is. It depends on the units of the axes: in units a times as large it is less by ln a an axis.
//!
//! Cells know averages. The entropy of the density that is constant inside cells is too large by (1/2) ∫ v/p, v the
//! variance of p in a cell, to the order of their widths squared: a sixth of the squares of the steps of √p over the
//! faces, which are (h²/4) (p')²/p. That is taken off, and what it leaves is judged by the same from cells twice as
//! wide. Samples make entropies small and steps large: there the first is stated with all of the second.

use super::{DerivedMeasure, MeasureInput};
use crate::continuation::{Measure, MeasureKind};
use crate::density::{EstimatedDensity, NEGLIGIBLE, Observable, Variants};
use crate::system::Family;

pub(super) const ENTROPY: DerivedMeasure = DerivedMeasure {
    kind: MeasureKind {
        word: "entropy",
        follows: false,
        unit: "nat",
        meaning: "differential entropy of a joint density, axes in the units of the equations",
    },
    of: names,
    derive,
};

fn names(family: &Family, observables: &[Observable]) -> Vec<String> {
    let joint = observables.iter().filter(|one| one.axes().len() == 2);
    joint.map(|one| one.name(family)).collect()
}

fn derive(measure: &DerivedMeasure, solved: &MeasureInput<'_>) -> Vec<Measure> {
    let densities = solved.densities.iter();
    let beyond = solved.cells.map_or(0.0, |cells| cells.beyond);
    let found = densities.filter_map(|one| Some((one, entropy(one, beyond)?)));
    found
        .map(|(one, (value, error))| Measure {
            error: Some(error),
            ..measure
                .kind
                .measure(&one.observable.name(solved.family), value)
        })
        .collect()
}

/// The entropy of a joint density with its error; `None` for others. `beyond` is the share that lies beyond the ends.
fn entropy(estimated: &EstimatedDensity, beyond: f64) -> Option<(f64, f64)> {
    let density = &estimated.density;
    let [first, second] = density.axes.as_slice() else {
        return None;
    };
    let widths =
        |axis: &crate::space::Axis| (0..axis.count()).map(|cell| axis.width(cell)).collect();
    let cells = Cells {
        widths: [widths(first), widths(second)],
    };
    let (plain, below) = cells.plain(&density.values);
    let within = cells.within(&density.values);
    let (coarse, merged) = cells.merge(&density.values);
    Some(match &estimated.variants {
        Variants::Jackknife(replicates) => {
            let groups = replicates.len() as f64;
            let all: Vec<f64> = replicates.iter().map(|one| cells.plain(one).0).collect();
            let mean = all.iter().sum::<f64>() / groups;
            let squares: f64 = all.iter().map(|one| (one - mean).powi(2)).sum();
            let deviation = ((groups - 1.0) / groups * squares).sqrt();
            let bias = (groups - 1.0) * (mean - plain);
            (plain, deviation + bias.abs() + within)
        }
        variants => {
            let value = |values: &[f64]| cells.plain(values).0 - cells.within(values);
            let scheme = match variants {
                Variants::Scheme(second) => (value(second) - value(&density.values)).abs(),
                _ => 0.0,
            };
            let grid = (within - 0.25 * coarse.within(&merged)).abs();
            let value = plain - within;
            let of_ends = cells.of_ends((estimated, beyond), value);
            (value, scheme + grid + below + of_ends)
        }
    })
}

/// The cells of two axes.
struct Cells {
    widths: [Vec<f64>; 2],
}

impl Cells {
    /// What the ends of the ranges, and modes that are not there, may change: dS = -∫ (ln p + 1) dp of the changes that
    /// are known, and what lies beyond the ends, at densities that are no smaller than what the solver leaves.
    fn of_ends(&self, (estimated, beyond): (&EstimatedDensity, f64), value: f64) -> f64 {
        let (values, truncation) = (&estimated.density.values, &estimated.truncation);
        let slope = |value: f64| {
            if value > 0.0 { value.ln() + 1.0 } else { 0.0 }
        };
        let pairs = values.iter().zip(&truncation.change);
        let changes = self.all().zip(pairs);
        let known =
            changes.map(|(cell, (&value, change))| slope(value) * change * self.volume(cell));
        let highest = estimated.density.maximum();
        let farthest = slope(highest).abs().max(slope(NEGLIGIBLE * highest).abs());
        known.sum::<f64>().abs() + beyond * (value.abs() + farthest)
    }

    fn volume(&self, [row, column]: [usize; 2]) -> f64 {
        self.widths[0][row] * self.widths[1][column]
    }

    fn all(&self) -> impl Iterator<Item = [usize; 2]> {
        let [rows, columns] = [0, 1].map(|axis: usize| self.widths[axis].len());
        (0..rows).flat_map(move |row| (0..columns).map(move |column| [row, column]))
    }

    /// Entropy of the density that is constant inside cells, and the same of what is negative: its place is unknown.
    fn plain(&self, values: &[f64]) -> (f64, f64) {
        let (mut sum, mut below) = (0.0, 0.0);
        for (cell, &value) in self.all().zip(values) {
            if value != 0.0 {
                let part = value.abs() * value.abs().ln() * self.volume(cell);
                if value > 0.0 {
                    sum -= part;
                } else {
                    below += part.abs();
                }
            }
        }
        (sum, below)
    }

    /// What variation inside cells takes off.
    fn within(&self, values: &[f64]) -> f64 {
        let columns = self.widths[1].len();
        let at = |[row, column]: [usize; 2]| values[row * columns + column].max(0.0).sqrt();
        let steps = self.all().flat_map(|cell| {
            let next = [[cell[0] + 1, cell[1]], [cell[0], cell[1] + 1]];
            let inside = |next: &[usize; 2]| {
                next[0] < self.widths[0].len() && next[1] < self.widths[1].len()
            };
            let step = move |next: [usize; 2]| {
                let volume = 0.5 * (self.volume(cell) + self.volume(next));
                (at(next) - at(cell)).powi(2) * volume
            };
            next.into_iter()
                .filter(inside)
                .map(step)
                .collect::<Vec<f64>>()
        });
        steps.sum::<f64>() / 6.0
    }

    /// Cells twice as wide, and their averages.
    fn merge(&self, values: &[f64]) -> (Self, Vec<f64>) {
        let wide = |widths: &Vec<f64>| widths.chunks(2).map(|pair| pair.iter().sum()).collect();
        let merged = Self {
            widths: self.widths.each_ref().map(wide),
        };
        let columns = merged.widths[1].len();
        let mut averages = vec![0.0; merged.widths[0].len() * columns];
        for (cell, value) in self.all().zip(values) {
            let into = [cell[0] / 2, cell[1] / 2];
            averages[into[0] * columns + into[1]] +=
                value * self.volume(cell) / merged.volume(into);
        }
        (merged, averages)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancellation::Cancellation;
    use crate::continuation::DensitySource;
    use crate::method::{
        GeneratorMethodOptions, GeneratorSource, MonteCarloOptions, MonteCarloSource, Problem,
    };
    use crate::space::{Axis, CellSpace};
    use crate::system::{Path, registry};

    const KAPPA: f64 = 0.5;
    const SIGMA2: f64 = 0.5;

    /// x'' + κ x' + α x = ξ on so many cells an axis.
    fn linear(cells: usize) -> Problem {
        let fixed = [
            ("kappa", KAPPA),
            ("mu", 0.0),
            ("f_c", 0.0),
            ("sigma2", SIGMA2),
        ];
        let path = Path::parameter("alpha", 0.5, 2.0);
        let family = Family::new(registry::find("coulomb").unwrap(), &fixed, path).unwrap();
        let axis = |reach: f64| Axis::uniform(-reach, reach, cells).unwrap();
        let space = CellSpace::new(vec![axis(6.0), axis(5.0)]).unwrap();
        let observables = vec![Observable::Marginal(0), Observable::Joint(0, 1)];
        let problem = Problem::new(family, space, observables).unwrap();
        problem.measuring(&[ENTROPY])
    }

    /// 1 + ln 2π + (1/2) ln det Σ.
    fn exact(alpha: f64) -> f64 {
        let variance = SIGMA2 / (2.0 * KAPPA);
        1.0 + (2.0 * std::f64::consts::PI).ln() + 0.5 * (variance * variance / alpha).ln()
    }

    fn found(source: &dyn DensitySource, alpha: f64) -> Measure {
        let mut session = source.open(&Cancellation::new());
        let solution = session.solve(alpha).unwrap();
        let measures = solution.report.measures.iter();
        let found: Vec<&Measure> = measures.filter(|one| ENTROPY.kind.has(one)).collect();
        assert_eq!(found.len(), 1);
        found[0].clone()
    }

    #[test]
    fn a_gaussian_has_its_exact_entropy_within_the_stated_error_on_every_grid() {
        for alpha in [0.5, 1.0, 2.0] {
            let mut before = f64::INFINITY;
            for cells in [28, 48, 80] {
                let options = GeneratorMethodOptions::default();
                let source = GeneratorSource::new(&linear(cells), &options).unwrap();
                let one = found(&source, alpha);
                assert_eq!(
                    (one.name.as_str(), one.unit.as_str()),
                    ("entropy_xy", "nat")
                );
                let (error, off) = (one.error.unwrap(), one.value - exact(alpha));
                assert!(off.abs() <= error, "{alpha} {cells}: {off:e} {error:e}");
                // An error of the order of the cells' widths squared would fall to less than a half as well.
                assert!(
                    error < 0.4 * before,
                    "{alpha} {cells}: {error:e} {before:e}"
                );
                before = error;
            }
            assert!(before < 2e-3, "{before:e}");
        }
    }

    #[test]
    fn samples_give_the_same_within_their_error() {
        let never = Cancellation::new();
        let options = MonteCarloOptions {
            seed: 5,
            ..MonteCarloOptions::default()
        };
        let source = MonteCarloSource::new(&linear(30), &options, &never).unwrap();
        let one = found(&source, 1.0);
        let (error, off) = (one.error.unwrap(), one.value - exact(1.0));
        assert!(off.abs() <= 2.0 * error && error < 0.2, "{off:e} {error:e}");
    }

    #[test]
    fn what_is_not_asked_for_is_not_derived() {
        let problem = linear(20).measuring(&[]);
        let options = GeneratorMethodOptions::default();
        let source = GeneratorSource::new(&problem, &options).unwrap();
        let mut session = source.open(&Cancellation::new());
        let solution = session.solve(1.0).unwrap();
        assert_eq!(solution.report.measure("entropy_xy"), None);
    }
}
