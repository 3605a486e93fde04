//! The balances of every oscillator x' = y, y' = F + noise among the equations. In the steady state d/dt E[f] = 0: with
//! f = y²/2 the power that the noise puts in, E[σ²]/2 (Itô), leaves by -E[y F]; with f = x y, E[y²] = -E[x F]. Nothing
//! of that was asked of the solver: what is left over tells of errors that two discretisations may share.
//!
//! Both are relative: to E[σ²]/2 and to E[y²]. Walls across either axis exchange power of their own, and mass that
//! leaves Ω takes what it has along, which is part of the error.

use super::{Cells, DerivedMeasure, MeasureInput, Others};
use crate::continuation::{Finding, Measure, MeasureKind};
use crate::density::Observable;
use crate::density::{Roughness, excess_variances};
use crate::method::lattice::for_all_nodes;
use crate::numerics::jackknife;
use crate::system::{Family, LANES, Lanes, System};

pub(super) const BALANCE: DerivedMeasure = DerivedMeasure {
    kind: MeasureKind {
        word: "balance",
        follows: false,
        unit: "1",
        meaning: "what is left of a balance of an oscillator x' = y, relative: of y, power in less power out; of x, E[y²] + E[x y']",
    },
    of: names,
    derive,
};

/// Broken by less, a balance is not worth a word.
const WORTH_A_WORD: f64 = 1e-3;

/// Axes of displacement and velocity of an oscillator.
type Pair = [usize; 2];

/// Pairs of axes of which the one has the other as its drift, and no noise.
fn oscillators(system: &dyn System) -> Vec<Pair> {
    let dimension = system.dimension();
    if system.facts().autonomous().is_err() {
        return Vec::new();
    }
    // Fractions of multiples of irrational numbers fill a box evenly.
    const STEPS: [f64; 4] = [
        0.618_033_988_75,
        0.754_877_666_25,
        0.569_840_290_998,
        0.438_447_187_19,
    ];
    let states: Vec<Lanes> = STEPS[..dimension.min(STEPS.len())]
        .iter()
        .map(|step| std::array::from_fn(|lane| 2.0 * ((lane + 1) as f64 * step).fract() - 1.0))
        .collect();
    let mut drift = vec![[0.0; LANES]; dimension];
    system.drift(0.0, &states, &mut drift);
    let pairs = (0..dimension).flat_map(|x| (0..dimension).map(move |y| [x, y]));
    let is_one = |&[x, y]: &Pair| x != y && drift[x] == states[y] && !system.is_noisy(x);
    pairs.filter(is_one).collect()
}

fn names(family: &Family, _: &[Observable]) -> Vec<String> {
    let systems = family.along().unwrap_or_default();
    let pairs = systems
        .first()
        .map(|system| oscillators(system.as_ref()))
        .unwrap_or_default();
    let axes = pairs.into_iter().flatten();
    axes.map(|axis| family.axis(axis).to_owned()).collect()
}

fn derive(measure: &DerivedMeasure, solved: &MeasureInput<'_>) -> Vec<Measure> {
    let Some(cells) = solved.cells else {
        return Vec::new();
    };
    let found = balances(cells).into_iter();
    found
        .map(|one| Measure {
            error: one.error,
            ..measure
                .kind
                .measure(solved.family.axis(one.axis), one.value)
        })
        .collect()
}

/// Balances that are broken by more than their errors.
pub(in crate::method) fn broken(cells: &Cells<'_>) -> Vec<Finding> {
    let told = balances(cells).into_iter().filter_map(|one| {
        let error = one.error?;
        let is_broken = one.value.abs() > error.max(WORTH_A_WORD);
        is_broken.then_some(Finding::BalanceBroken {
            axis: one.axis,
            relative: one.value,
            error,
        })
    });
    told.collect()
}

/// What is left of a balance, relative.
struct Balance {
    /// The axis of the velocity for power, of the displacement for E[y²] + E[x F].
    axis: usize,
    value: f64,
    error: Option<f64>,
}

fn balances(cells: &Cells<'_>) -> Vec<Balance> {
    let pairs = oscillators(cells.system);
    let open = |pair: &&Pair| pair.iter().all(|&axis| cells.closed[axis] == [false; 2]);
    let found = pairs.iter().filter(open).flat_map(|&pair| {
        let [of_x, of_y] = terms(cells, pair);
        let [x, y] = pair;
        [(x, of_x), (y, of_y)].map(|(axis, terms)| terms.balance(cells, pair, axis))
    });
    found.filter(|one| one.value.is_finite()).collect()
}

/// One number a cell each: what should average to zero, and what it is compared with.
#[derive(Default)]
struct Terms {
    left: Vec<f64>,
    scale: Vec<f64>,
    /// The largest magnitude of f over Ω.
    carried: f64,
}

fn terms(cells: &Cells<'_>, [x, y]: Pair) -> [Terms; 2] {
    let (system, count) = (cells.system, cells.space.n_cells());
    let mut found = [Terms::default(), Terms::default()];
    let mut drift = vec![[0.0; LANES]; cells.space.dimension()];
    for_all_nodes(cells.space, |first, states| {
        system.drift(0.0, states, &mut drift);
        let mut power = [0.0; LANES];
        for noise in system.noises_on(y) {
            for (power, amplitude) in power.iter_mut().zip(noise.amplitudes(0.0, states)) {
                *power += 0.5 * amplitude * amplitude;
            }
        }
        for lane in 0..LANES.min(count - first) {
            let (at, speed, force) = (states[x][lane], states[y][lane], drift[y][lane]);
            let [of_x, of_y] = &mut found;
            of_x.add(speed * speed + at * force, speed * speed, at * speed);
            of_y.add(
                power[lane] + speed * force,
                power[lane],
                0.5 * speed * speed,
            );
        }
    });
    found
}

impl Terms {
    fn add(&mut self, left: f64, scale: f64, carried: f64) {
        self.left.push(left);
        self.scale.push(scale);
        self.carried = self.carried.max(carried.abs());
    }

    fn balance(&self, cells: &Cells<'_>, pair: Pair, axis: usize) -> Balance {
        let sum = |weights: &[f64], of: &[f64]| -> f64 {
            weights
                .iter()
                .zip(of)
                .map(|(weight, value)| weight * value)
                .sum()
        };
        let relative = |weights: &[f64]| sum(weights, &self.left) / sum(weights, &self.scale);
        let (value, scale) = (relative(cells.weights), sum(cells.weights, &self.scale));
        let leaks = 2.0 * cells.escape_rate * self.carried / scale;
        let error = match cells.others {
            Others::None => None,
            Others::Second(second) => {
                let differences: Vec<f64> = second
                    .iter()
                    .zip(cells.weights)
                    .map(|(b, a)| b - a)
                    .collect();
                // Forces bend or jump there, whatever the density does.
                let surfaces = cells.system.facts().switching_surfaces.iter();
                let planes: Vec<(usize, f64)> = surfaces.map(|one| (one.axis, one.at)).collect();
                let roughness = Roughness {
                    space: cells.space,
                    weights: cells.weights,
                    differences: &differences,
                    planes: &planes,
                };
                Some((relative(second) - value).abs() + roughness.of(&self.left) / scale)
            }
            Others::Replicates([] | [_]) => None,
            Others::Replicates(all) => {
                let values: Vec<f64> = all.iter().map(|one| relative(one)).collect();
                Some(jackknife(values.iter().copied()) + widened(cells, pair))
            }
        };
        Balance {
            axis,
            value,
            error: error.map(|error| error + leaks),
        }
    }
}

/// What the widths of cells do to averages of squares, relative.
fn widened(cells: &Cells<'_>, pair: Pair) -> f64 {
    let all = excess_variances(cells.space, cells.weights).unwrap_or_default();
    let moments = crate::density::moments(cells.space, cells.weights).unwrap_or_default();
    let of = |axis: &usize| {
        let (excess, own) = (all.get(*axis)?, moments.get(*axis)?);
        Some(excess / own.standard_deviation.powi(2))
    };
    pair.iter().filter_map(of).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cancellation::Cancellation;
    use crate::continuation::{DensitySource, SolveReport};
    use crate::density::Observable;
    use crate::method::{
        GeneratorMethodOptions, GeneratorSource, MonteCarloOptions, MonteCarloSource, Problem,
    };
    use crate::space::{Axis, CellSpace, Grading};
    use crate::system::{Path, registry};

    /// Coulomb's oscillator on so many cells an axis, friction swept.
    fn problem(cells: usize, stiffness: [f64; 2], friction: f64) -> Problem {
        let fixed = [
            ("kappa", 0.5),
            ("alpha", stiffness[0]),
            ("mu", stiffness[1]),
            ("sigma2", 0.5),
        ];
        let path = Path::parameter("f_c", friction, friction + 0.1);
        let family = Family::new(registry::find("coulomb").unwrap(), &fixed, path).unwrap();
        let grading = Grading {
            at: vec![0.0],
            smallest: 0.05,
        };
        let axes = vec![
            Axis::uniform(-4.5, 4.5, cells).unwrap(),
            Axis::graded(-4.5, 4.5, cells, &grading).unwrap(),
        ];
        let space = CellSpace::new(axes).unwrap();
        let problem = Problem::new(family, space, vec![Observable::Joint(0, 1)]).unwrap();
        problem.measuring(&[BALANCE])
    }

    fn solved(source: &dyn DensitySource, at: f64) -> SolveReport {
        source.open(&Cancellation::new()).solve(at).unwrap().report
    }

    /// Both balances with their errors.
    fn found(report: &SolveReport) -> [(f64, f64); 2] {
        ["balance_x", "balance_y"].map(|name| {
            let one = report.measures.iter().find(|one| one.name == name).unwrap();
            (one.value, one.error.unwrap())
        })
    }

    #[test]
    fn what_is_right_balances_within_its_error() {
        for (stiffness, friction) in [([1.0, 0.0], 0.0), ([-0.5, 1.0], 0.0), ([1.0, 0.0], 0.2)] {
            for cells in [40, 80] {
                let options = GeneratorMethodOptions::default();
                let problem = problem(cells, stiffness, friction);
                let report = solved(&GeneratorSource::new(&problem, &options).unwrap(), friction);
                // What no scheme shows, of graded cells and the kink, is not worth a word.
                for (value, error) in found(&report) {
                    let most = error.max(0.5 * WORTH_A_WORD);
                    assert!(
                        value.abs() <= most && error < 0.02,
                        "{stiffness:?} {friction} {cells}: {value:e} {error:e}"
                    );
                }
                let is_broken = |one: &Finding| matches!(one, Finding::BalanceBroken { .. });
                assert!(!report.findings.iter().any(is_broken));
            }
        }
    }

    #[test]
    fn samples_balance_within_their_error() {
        let options = MonteCarloOptions {
            seed: 3,
            ..MonteCarloOptions::default()
        };
        let source = MonteCarloSource::new(
            &problem(40, [1.0, 0.0], 0.2),
            &options,
            &Cancellation::new(),
        );
        for (value, error) in found(&solved(&source.unwrap(), 0.2)) {
            assert!(
                value.abs() <= 3.0 * error && error < 0.1,
                "{value:e} {error:e}"
            );
        }
    }

    #[test]
    fn a_density_that_is_too_wide_takes_out_more_power_than_comes_in() {
        let problem = problem(60, [1.0, 0.0], 0.0);
        let system = problem.family().at(0.0).unwrap();
        let space = problem.space();
        // The variances are 1/2; this y has a tenth more.
        let weight = |cell: usize| {
            let at: Vec<f64> = (0..2)
                .map(|k| space.axes()[k].nodes()[space.position(cell, k)])
                .collect();
            space.volume(cell) * (-at[0] * at[0] - at[1] * at[1] / 1.1).exp()
        };
        let weights: Vec<f64> = (0..space.n_cells()).map(weight).collect();
        let total: f64 = weights.iter().sum();
        let weights: Vec<f64> = weights.iter().map(|one| one / total).collect();
        let cells = Cells {
            system: system.as_ref(),
            space,
            weights: &weights,
            others: Others::Second(&weights),
            closed: &[[false; 2]; 2],
            escape_rate: 0.0,
            beyond: 0.0,
        };
        let told = broken(&cells);
        let [
            Finding::BalanceBroken {
                axis: 0,
                relative: of_x,
                ..
            },
            Finding::BalanceBroken {
                axis: 1,
                relative: of_y,
                ..
            },
        ] = told[..]
        else {
            panic!("{told:?}");
        };
        assert!((of_y + 0.1).abs() < 2e-3, "{of_y}");
        // E[y²] + E[x y'] = 0.55 - 0.5.
        assert!((of_x - 0.05 / 0.55).abs() < 2e-3, "{of_x}");
    }

    #[test]
    fn only_what_has_a_velocity_is_an_oscillator() {
        let pairs = |name: &str, values: &[(&str, f64)]| {
            let system = registry::find(name).unwrap().system_with(values).unwrap();
            oscillators(system.as_ref())
        };
        let coulomb = [("kappa", 0.1), ("f_c", 0.1), ("sigma2", 0.1)];
        assert_eq!(pairs("coulomb", &coulomb), [[0, 1]]);
        let dahl = [
            ("kappa", 0.1),
            ("lambda", 0.1),
            ("f_c", 0.1),
            ("sigma2", 0.1),
        ];
        assert_eq!(pairs("dahl", &dahl), [[0, 1]]);
        assert!(pairs("bistable", &[("a", 0.1), ("sigma2", 0.1)]).is_empty());
    }
}
