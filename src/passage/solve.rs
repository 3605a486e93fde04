//! The numbers of a passage on one grid, by the scheme and with half of its dissipation.

use std::sync::Arc;

use super::cells::{PassageCells, cells};
use super::density_start::DensityStart;
use super::exits::{Exits, rate_change as entry_change};
use super::lasting::Lasting;
use super::memory::GridMemory;
use super::rate::slowest;
use super::spread::add_density;
use super::start::add_state;
use super::survival::{Survival, models};
use super::{KnownDensity, Passage, PassageError, Start, dot};
use crate::cancellation::Cancellation;
use crate::generator::{AbsorbingGenerator, GeneratorOptions, RateChange, assemble_with_changes};
use crate::space::CellSpace;
use crate::space::nodes::{FEWER_NODES, NODES};
use crate::stationary::generator::{AbsorbingSolver, AbsorbingWork, Expected, RateOptions};
use crate::system::{Enclosed, System};

/// A rate stands where turning its density once toward that of the grid changes it by less than this share of what half
/// of the dissipation does.
const UNSETTLED: f64 = 0.02;

/// Numbers of a passage: mean, standard deviation, the rate of the quasi-stationary density, the shares of exits; then
/// the probabilities at times and the quantiles that are asked for.
pub(super) struct Numbers {
    pub(super) values: Vec<f64>,
    /// Errors beside those of the cells: of the start, and of the models behind the last numbers.
    pub(super) errors: Vec<f64>,
    /// What a border of lower order changes of mean, standard deviation, rate and shares.
    pub(super) border: Vec<f64>,
    /// What of the mean's relative error comes from the density of the start, and from the border.
    pub(super) stretch: f64,
}

/// What one grid gives.
pub(super) struct Solved {
    /// With all and with half of the dissipation.
    pub(super) both: [Numbers; 2],
    pub(super) lasting: Lasting,
    pub(super) work: AbsorbingWork,
}

/// What a passage is solved with.
pub(super) struct Question<'a> {
    pub(super) system: &'a Arc<dyn System>,
    /// The cells of the sweep.
    pub(super) space: &'a CellSpace,
    pub(super) passage: &'a Passage,
    pub(super) density: Option<KnownDensity<'a>>,
    pub(super) options: &'a GeneratorOptions,
    pub(super) rates: &'a RateOptions,
    pub(super) cancellation: &'a Cancellation,
}

impl Question<'_> {
    /// The numbers with all and with half of the dissipation on `factor` times the sweep's cells an axis, and the
    /// density of the rate there, which is looked for from that of another grid on.
    pub(super) fn solve(
        &self,
        factor: f64,
        other: Option<&Lasting>,
        memory: &GridMemory,
    ) -> Result<Solved, PassageError> {
        let until = &self.passage.until;
        let found = cells(self.system.as_ref(), self.space, until, factor)?;
        let enclosed = enclosed(self.system, &found);
        let space = found.space;
        let (system, options) = (&enclosed, self.options);
        let (full, border, half) = assemble_with_changes(system, &space, until, options)?;
        let spread = self.density.map(|density| density.unknowns);
        let weights =
            |nodes, spread: Option<&[f64]>| self.weights(&space, &full.kept, nodes, spread);
        let start = weights(NODES, spread)?;
        // The other grids are there for differences, and state no errors of their starts.
        let judged = self.density.filter(|_| factor == 1.0);
        let coarse = match factor == 1.0 {
            true => weights(FEWER_NODES, spread)?,
            false => start.clone(),
        };
        let mut solver = AbsorbingSolver::new(&space, *self.rates, self.cancellation)
            .rough()
            .free()
            .with_memory(memory.take());
        let cells = (&space, full.kept.as_slice());
        let of_density = match judged {
            Some(density) => DensityStart::new(self.passage, density, self.space, cells)?,
            None => None,
        };
        let starts = [start.as_slice(), &coarse];
        let begun = other.map(|other| other.on(&space, &full.kept));
        let exits = Exits::new(&self.passage.exits, &space);
        let (mut both, lasting) = moments(
            &mut solver,
            ([&full, &half], &border, &exits),
            starts,
            of_density.as_ref(),
            begun.as_deref(),
        )?;
        let mut work = solver.work;
        memory.put(solver.into_memory());
        let groups = self.passage.groups_of_times(&both[0]);
        if !groups.is_empty() {
            let settings = (self.rates, self.cancellation);
            let second = match judged.and_then(|density| density.second()) {
                Some(second) => weights(NODES, Some(&second))?,
                None => start.clone(),
            };
            let starts = [start.as_slice(), &second];
            let mut known: [Vec<Survival>; 2] = [Vec::new(), Vec::new()];
            for &times in &groups {
                let (models, more) = models(&space, [&full, &half], starts, times, settings)?;
                work.add(more);
                for (known, model) in known.iter_mut().zip(models) {
                    known.push(model);
                }
            }
            for (numbers, models) in both.iter_mut().zip(&known) {
                self.passage.add(numbers, &groups, models);
            }
        }
        Ok(Solved {
            both,
            lasting: Lasting::new(space, lasting),
            work,
        })
    }

    /// The weights of the cells at the start, Σ = 1, by polynomials through so many nodes an axis; of a steady state
    /// with these unknowns.
    fn weights(
        &self,
        space: &CellSpace,
        kept: &[bool],
        nodes: usize,
        spread: Option<&[f64]>,
    ) -> Result<Vec<f64>, PassageError> {
        let mut weights = vec![0.0; space.n_cells()];
        let mass = match &self.passage.start {
            Start::State(state) => {
                let found = self.passage.until.at(state) >= 0.0
                    && space.find(state).is_some()
                    && add_state(space, kept, (state, 1.0), nodes, &mut weights);
                if found { 1.0 } else { 0.0 }
            }
            Start::Density(_) => {
                let spread = (self.space, spread.ok_or(PassageError::NoDensity)?);
                let levels = self.passage.start_levels(self.space)?;
                let region = |state: &[f64]| self.passage.start_level(state);
                let region = (region, levels.as_slice());
                add_density((space, kept), spread, region, nodes, &mut weights)
            }
        };
        if !(mass > f64::MIN_POSITIVE && mass.is_finite()) {
            return Err(PassageError::Start);
        }
        let total = sum(&weights);
        weights.iter_mut().for_each(|weight| *weight /= total);
        Ok(weights)
    }
}

/// Mean, standard deviation and rate by a generator, and by another one to first order of what they differ by; what a
/// border of lower order changes of the first adds what it does to the errors. The start is given by many nodes and by
/// fewer, and may be spread as a density that has errors of its own. The density of the rate is given too; it is looked
/// for from `begun` on.
fn moments(
    solver: &mut AbsorbingSolver<'_>,
    ([one, other], border, exits): ([&AbsorbingGenerator; 2], &RateChange, &Exits),
    [start, coarse]: [&[f64]; 2],
    spread_start: Option<&DensityStart<'_>>,
    begun: Option<&[f64]>,
) -> Result<([Numbers; 2], Vec<f64>), PassageError> {
    if one.ends.iter().all(|&rate| rate == 0.0) {
        return Err(PassageError::Never);
    }
    let matrix = one.matrix();
    let (stage, first) = solver.stage(&matrix, &one.ends, start)?;
    // A density from another grid is turned once toward this grid's by the pass that the second moment takes.
    let begun = begun.filter(|begun| dot(begun, begun) > 0.0);
    let (second, turned) = match begun {
        Some(begun) => {
            let [second, turned] = solver.times_of_both(&stage, [&first, begun])?;
            (second, Some((begun, turned)))
        }
        None => (solver.times(&stage, &first)?, None),
    };
    let [weights, others] = &one.weights;
    let expected = solver.expected(&stage, weights)?;
    let again = solver.expected(&stage, &expected.values())?;
    // What the solves of either side leave is in both to first order, and in what both give together to second.
    let left_of = |source: &[f64], expected: &Expected, times: &[f64], balance: &[f64]| {
        expected.over(source) + stage.of_balance(balance, expected, times)
    };
    let [of_first, of_second] = [&first, &second].map(|times| stage.balance(times));
    let mean = dot(weights, &first) + left_of(start, &expected, &first, &of_first);
    let square = 2.0
        * (dot(weights, &second)
            + left_of(&first, &expected, &second, &of_second)
            + left_of(start, &again, &first, &of_first));
    let scaled = again.values();
    let scaled: Vec<f64> = scaled.iter().map(|value| value / mean.powi(2)).collect();
    let left = solver.expected(&stage, &scaled)?;
    let quotient = |vector: &[f64]| {
        let of_vector = stage.of_balance(&stage.balance(vector), &left, vector);
        -of_vector / left.over(vector)
    };
    let by_other = |pairs: [(&Expected, &[f64]); 1]| -> f64 {
        let [through] = Expected::through(pairs, &other.rates, &other.ends);
        through
    };
    let rate_change = |vector: &[f64]| {
        let change =
            by_other([(&left, vector)]) - stage.of_balance(&stage.balance(vector), &left, vector);
        -change / left.over(vector)
    };
    // That does where it changes much less of the quotient than dissipation does.
    let turned = turned.map(|(begun, vector)| (quotient(begun), vector));
    let stands = turned.as_ref().is_some_and(|(before, vector)| {
        let unsettled = (quotient(vector) - before).abs();
        unsettled <= UNSETTLED * rate_change(vector).abs()
    });
    let (found, lasting) = match turned {
        Some((_, vector)) if stands => (0.0, vector),
        turned => {
            let from = turned.map_or_else(|| second.clone(), |(_, vector)| vector);
            slowest(&from, |vector| solver.times(&stage, vector))?
        }
    };
    let (overlap, of_lasting) = (left.over(&lasting), stage.balance(&lasting));
    let rate = match quotient(&lasting) {
        quotient if quotient > 0.0 && quotient.is_finite() => quotient,
        _ => found,
    };
    let parts = exits.rates(&one.endings);
    let entering = parts.iter().map(|rates| solver.expected(&stage, rates));
    let entering: Vec<Expected> = entering.collect::<Result<_, _>>()?;
    let into = parts.iter().zip(&entering);
    let shares: Vec<f64> = into
        .map(|(rates, share)| dot(rates, &first) + left_of(start, share, &first, &of_first))
        .collect();
    let others_parts = exits.rates(&other.endings);
    let pairs = parts.iter().zip(&others_parts).zip(&entering);
    let share_changes = pairs.map(|((own, others), share)| {
        entry_change(own, others, &first) + by_other([(share, first.as_slice())])
            - stage.of_balance(&of_first, share, &first)
    });
    let share_changes: Vec<f64> = share_changes.collect();
    // Of mean, mean square and rate, from what is w·Q' z by another generator.
    let pairs = [
        (&expected, first.as_slice()),
        (&expected, &second),
        (&again, &first),
    ];
    let changes = |[of_mean, of_second, of_again]: [f64; 3], of_rate: f64| {
        [of_mean, 2.0 * (of_second + of_again), -of_rate / overlap]
    };
    let by_half = {
        let [mean, second_one, again_one] = Expected::through(pairs, &other.rates, &other.ends);
        let moments = [
            mean - stage.of_balance(&of_first, &expected, &first),
            second_one - stage.of_balance(&of_second, &expected, &second),
            again_one - stage.of_balance(&of_first, &again, &first),
        ];
        let of_rate = by_other([(&left, lasting.as_slice())]);
        changes(
            moments,
            of_rate - stage.of_balance(&of_lasting, &left, &lasting),
        )
    };
    let of_border = {
        let moments = Expected::through(pairs, &border.rates, &border.ends);
        let lasting = [(&left, lasting.as_slice())];
        let [of_rate] = Expected::through(lasting, &border.rates, &border.ends);
        changes(moments, of_rate)
    };
    let border_parts = exits.rates(&border.endings);
    let border_shares = border_parts.iter().zip(&entering).map(|(rates, share)| {
        let pair = [(share, first.as_slice())];
        let [through] = Expected::through(pair, &border.rates, &border.ends);
        dot(rates, &first) + through
    });
    let spread = (square - mean * mean).max(f64::MIN_POSITIVE).sqrt();
    let [of_mean, of_square, of_rate] = of_border;
    let of_deviation = (0.5 * of_square - mean * of_mean) / spread;
    let mut border = [of_mean, of_deviation, of_rate].map(f64::abs).to_vec();
    border.extend(border_shares.map(f64::abs));
    // What fewer nodes change of the start, and another way to end sums at an oblique border.
    let of_start = expected.difference(start, coarse).abs();
    let of_sums = (dot(others, &first) - mean).abs();
    let squares: Vec<f64> = (again.beside().iter())
        .zip(expected.beside())
        .map(|(again, expected)| (again - mean * expected) / spread)
        .collect();
    let of_density = spread_start.map_or([0.0; 2], |start| {
        [start.error(expected.beside()), start.error(&squares)]
    });
    let mut errors = vec![
        of_start + of_sums + of_density[0],
        of_start + of_sums + of_density[1],
        0.0,
    ];
    errors.extend(entering.iter().map(|share| {
        let of_density = spread_start.map_or(0.0, |start| start.error(share.beside()));
        share.difference(start, coarse).abs() + of_density
    }));
    let numbers = |mean: f64, square: f64, rate: f64, shares: &[f64]| {
        let deviation = (square - mean * mean).max(0.0).sqrt();
        let values = [&[mean, deviation, rate], shares].concat();
        let is_finite = values.iter().all(|value| value.is_finite());
        is_finite.then(|| Numbers {
            values,
            errors: errors.clone(),
            border: border.clone(),
            stretch: (of_density[0] + border[0]) / mean,
        })
    };
    let [mean_change, square_change, rate_change] = by_half;
    let full = numbers(mean, square, rate, &shares);
    let half_shares: Vec<f64> = shares
        .iter()
        .zip(share_changes)
        .map(|(share, change)| share + change)
        .collect();
    let half = numbers(
        mean + mean_change,
        square + square_change,
        rate + rate_change,
        &half_shares,
    );
    match (full, half) {
        (Some(full), Some(half)) => Ok(([full, half], lasting)),
        _ => Err(PassageError::Rounding),
    }
}

fn sum(values: &[f64]) -> f64 {
    values.iter().sum()
}

/// The system between walls at the ends of the cells that are no borders of the target: what would leave the range
/// there comes back sooner or later, and waits on.
pub(super) fn enclosed(system: &Arc<dyn System>, cells: &PassageCells) -> Enclosed {
    let ends = cells.space.axes().iter().zip(&cells.borders);
    let ranges: Vec<(f64, f64)> = ends
        .map(|(axis, &[lower, upper])| {
            let from = if lower {
                f64::NEG_INFINITY
            } else {
                axis.from()
            };
            let to = if upper { f64::INFINITY } else { axis.to() };
            (from, to)
        })
        .collect();
    Enclosed::new(Arc::clone(system), &ranges)
}
