//! Processes on their way from one region to another: transition paths, in the words of E and Vanden-Eijnden (J. Stat.
//! Phys. 123, 503 (2006)).
//!
//! Outside of both regions, f is the steady state of those that were in the first one last: Q f = 0, with f the steady
//! state on the border of the first region and zero on that of the second. Stencils that reach past a border read the
//! polynomial through cells and through that value, which gives a source s and the generator of a process that ends at
//! either border: Q f = -s. With q the probability to come to the second region next, f q is the density of those on
//! their way, and what enters the second region per unit of time, Σ e f, is how often a transition happens. Grids and
//! their differences are those of other numbers of passages (`timed.rs`).

use std::sync::Arc;

use super::exits::Exits;
use super::field::{
    FieldQuestion, FieldTarget, OnGrid, PassageField, TOLERANCE, greatest_beside, on_three_grids,
    with_changes,
};
use super::on_way::{Changed, FROM, OnWay, OnWayNumbers, TO};
use super::source::{change_of_duration, source};
use super::steady::{Steady, mass_in};
use super::timed::WithError;
use super::{KnownDensity, PassageError, dot};
use crate::cancellation::Cancellation;
use crate::generator::{AbsorbingGenerator, GeneratorOptions, levels};
use crate::space::CellSpace;
use crate::stationary::generator::{Absorbing, AbsorbingSolver, Expected, RateOptions};
use crate::system::{BoundQuantity, System};

/// What is known of processes on their way from one region to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Reactive {
    /// Transitions per unit of time.
    pub flux: WithError,
    /// The same for each unit of time that the first region was the last one of the two.
    pub rate: WithError,
    /// Mean time from the last moment in the first region to the first one in the second.
    pub duration: WithError,
    /// Density of being on the way, which sums to the flux times the duration.
    pub density: PassageField,
    /// Components of the current along each axis; what crosses any border between the two regions is the flux.
    pub current: Vec<PassageField>,
}

/// Processes on their way from the first part of a target to the second, of a system whose steady state on the cells of
/// a sweep is `density`.
///
/// # Errors
/// [`PassageError`].
pub fn reactive(
    (system, space): (&Arc<dyn System>, &CellSpace),
    target: &FieldTarget,
    density: KnownDensity<'_>,
    (options, rates): (&GeneratorOptions, &RateOptions),
    cancellation: &Cancellation,
) -> Result<Reactive, PassageError> {
    let [from, to] = &target.exits[..] else {
        return Err(PassageError::Nowhere);
    };
    are_apart(space, [from, to])?;
    let question = Transitions {
        asked: FieldQuestion {
            system,
            space,
            target,
            options,
            rates: RateOptions {
                tolerance: TOLERANCE,
                ..*rates
            },
            cancellation,
        },
        steady: Steady::new(space, density.unknowns),
        changes: (density.sizes_of_changes()).map(|changes| Steady::bound(space, &changes)),
        masses: mass_in(space, &density, from)?,
    };
    let [finest, coarse, coarsest] = on_three_grids(|factor| question.on_grid(factor))?;
    let others = [&coarse, &coarsest];
    let numbers = others.map(|other| &other.numbers.on_grid);
    let numbers = finest.numbers.with_errors(numbers, |errors| errors);
    let [flux, rate, duration] = [0, 1, 2].map(|place| numbers[place]);
    let beside = |errors: Vec<f64>| greatest_beside(space, &errors);
    let field = |place: usize| {
        let others = others.map(|other| &other.fields[place].on_grid);
        finest.fields[place].with_errors(others, beside)
    };
    let mut fields = (0..finest.fields.len()).map(|place| {
        let is_density = place == 0;
        let least = if is_density { 0.0 } else { f64::NEG_INFINITY };
        question.whole(field(place), least)
    });
    let density = fields.next().ok_or(PassageError::Start)?;
    let current = fields.collect();
    Ok(Reactive {
        flux,
        rate,
        duration,
        density,
        current,
    })
}

/// Nothing, if both regions have cells, and none in common.
pub(crate) fn are_apart(
    space: &CellSpace,
    [from, to]: [&BoundQuantity; 2],
) -> Result<(), PassageError> {
    let [from, to] = [levels(space, from)?, levels(space, to)?];
    let is_in = |level: &f64| *level < 0.0;
    if !to.iter().any(is_in) {
        return Err(PassageError::Nowhere);
    }
    if !from.iter().any(is_in) {
        return Err(PassageError::Start);
    }
    let mut pairs = from.iter().zip(&to);
    match pairs.any(|(from, to)| is_in(from) && is_in(to)) {
        true => Err(PassageError::Overlap),
        false => Ok(()),
    }
}

/// What one grid gives: flux, rate and duration; the density, and the current along each axis.
struct GridTransitions {
    numbers: OnWayNumbers,
    fields: Vec<OnWayNumbers>,
}

/// Transitions with what they are solved with.
struct Transitions<'a> {
    asked: FieldQuestion<'a>,
    steady: Steady<'a>,
    changes: Option<Steady<'a>>,
    /// The mass in the first region, and its error.
    masses: WithError,
}

impl Transitions<'_> {
    fn on_grid(&self, factor: f64) -> Result<GridTransitions, PassageError> {
        let (found, generators) = self.asked.generators(factor)?;
        let [full, half, third] = &generators;
        let exits = Exits::new(&self.asked.target.exits, &found.space);
        let system = self.asked.system.as_ref();
        let source = |generator: &AbsorbingGenerator, steady: &Steady<'_>| {
            source((system, &exits), (&found, generator), steady)
        };
        let start = source(full, &self.steady);
        let is_left = start.iter().any(|&rate| rate > 0.0) && start.iter().sum::<f64>() > 0.0;
        if !is_left {
            return Err(PassageError::Never);
        }
        let matrix = full.matrix();
        let space = &found.space;
        let mut solver = AbsorbingSolver::new(space, self.asked.rates, self.asked.cancellation);
        let (stage, own) = solver.stage(&matrix, &full.ends, &start)?;
        let by_other = |other: &AbsorbingGenerator| {
            let mut left = source(other, &self.steady);
            for &(row, column, rate) in &other.rates {
                left[row] += rate * own[column];
            }
            left
        };
        let steady_changes = self.changes.as_ref().filter(|_| factor == 1.0);
        let steady = match steady_changes {
            Some(changes) => solver.times(&stage, &source(full, changes))?,
            None => vec![0.0; own.len()],
        };
        let last = Changed {
            halved: solver.times(&stage, &by_other(half))?,
            border: solver.times(&stage, &by_other(third))?,
            own,
            steady,
        };
        let gain = |generator: &AbsorbingGenerator| exits.rates(&generator.endings).swap_remove(TO);
        let (next, changes) = with_changes(&mut solver, &stage, [full, half, third], gain)?;
        let entering = [full, half, third].map(gain);
        let numbers = self.flux((&stage, &start), &entering, &last, &next);
        let to_come = next.values();
        let on_way = OnWay::new(&self.asked, &found, full, (last, next, changes));
        let mut numbers = self.numbers(numbers, &on_way, full, &exits);
        if let Some(changes) = steady_changes {
            // Transitions that begin at a place on the border, and the time that they are on their way.
            let weights = full.weights[0].iter().zip(&on_way.next.own);
            let weights: Vec<f64> = weights.map(|(weight, next)| weight * next).collect();
            let lasting = solver.expected(&stage, &weights)?.values();
            let value = |place: usize| numbers.on_grid.values[place].unwrap_or(f64::NAN);
            let flux_and_duration = (value(0), value(2));
            numbers.changes[2] = change_of_duration(
                (system, &exits),
                (&found, full),
                changes,
                [&to_come, &lasting],
                flux_and_duration,
            );
        }
        Ok(GridTransitions {
            numbers,
            fields: on_way.fields(&self.asked),
        })
    }

    /// Transitions per unit of time. What solves of either side leave is in it to second order.
    fn flux(
        &self,
        (stage, start): (&Absorbing<'_>, &[f64]),
        [own, half, third]: &[Vec<f64>; 3],
        last: &Changed<Vec<f64>>,
        next: &Expected,
    ) -> Changed<f64> {
        let left = next.over(start) + stage.of_balance(&stage.balance(&last.own), next, &last.own);
        let plain = dot(own, &last.own);
        let by = |entering: &[f64], change: &[f64]| {
            dot(entering, change) + dot(entering, &last.own) - plain
        };
        Changed {
            own: plain + left,
            halved: by(half, &last.halved),
            border: by(third, &last.border),
            steady: dot(own, &last.steady),
        }
    }

    /// Flux, rate and duration.
    fn numbers(
        &self,
        flux: Changed<f64>,
        on_way: &OnWay<'_>,
        full: &AbsorbingGenerator,
        exits: &Exits<'_>,
    ) -> OnWayNumbers {
        let [weights, others] = &full.weights;
        let dimension = self.asked.space.dimension();
        // Those that were in the first region last, outside of it: they are not zero on its border.
        let on_border = |way: usize, steady: &Steady<'_>| -> f64 {
            let borders = full
                .on_border
                .iter()
                .map(|one| (&one.state[..dimension], one.sum[way]));
            let own = borders.filter(|(state, _)| exits.part_at(state) == Some(FROM));
            own.map(|(state, weight)| weight * steady.at(state)).sum()
        };
        let last = &on_way.last;
        let outside = dot(weights, &last.own) + on_border(0, &self.steady);
        let second = dot(others, &last.own) + on_border(1, &self.steady);
        let of_steady = self
            .changes
            .as_ref()
            .map_or(0.0, |changes| on_border(0, changes));
        let mass = Changed {
            own: self.masses.0 + outside,
            halved: dot(weights, &last.halved),
            border: dot(weights, &last.border).abs() + (second - outside).abs(),
            steady: (dot(weights, &last.steady) + of_steady).abs() + self.masses.1,
        };
        let sum = |of: &[f64]| dot(weights, of);
        let density = &on_way.on_way;
        let way = Changed {
            own: sum(&density.own),
            halved: sum(&density.halved),
            border: sum(&density.border).abs()
                + (dot(others, &density.own) - sum(&density.own)).abs(),
            steady: sum(&density.steady),
        };
        let numbers = |flux: f64, mass: f64, way: f64| [flux, flux / mass, way / flux];
        // The density on the way and what it is of have lost what dissipation does already.
        let (flux_own, mass_own) = (flux.own + 2.0 * flux.halved, mass.own + 2.0 * mass.halved);
        let own = numbers(flux_own, mass_own, way.own);
        let change = |flux: f64, mass: f64, way_change: f64| {
            let rate = (flux - own[1] * mass) / mass_own;
            [flux, rate, (way_change - own[2] * flux) / flux_own]
        };
        // Of changes whose signs are not known, or count for nothing.
        let bound = |flux: f64, mass: f64, way: f64| {
            let [flux, mass, way] = [flux, mass, way].map(f64::abs);
            let [_, rate, duration] = own.map(f64::abs);
            let rate = (flux + rate * mass) / mass_own;
            [flux, rate, (way + duration * flux) / flux_own.abs()]
        };
        let known = |all: [f64; 3]| all.map(Some).to_vec();
        let on_grid = OnGrid {
            values: known(own),
            halved: known(change(flux.halved, mass.halved, way.halved)),
            border: known(bound(flux.border, mass.border, way.border)),
        };
        let steady = bound(flux.steady, mass.steady, way.steady);
        OnWayNumbers::new(on_grid, steady.to_vec())
    }

    /// A field with what it is inside the regions, where nothing is on its way.
    fn whole(&self, both: Vec<WithError>, least: f64) -> PassageField {
        let one = |(cell, (value, error)): (usize, WithError)| {
            let state = self.asked.space.centre(cell);
            match value.is_nan() {
                true if self.asked.target.until.at(&state) < 0.0 => (0.0, 0.0),
                true => (f64::NAN, f64::NAN),
                false => (value.max(least), error),
            }
        };
        let (values, errors) = both.into_iter().enumerate().map(one).unzip();
        PassageField { values, errors }
    }
}
