//! Numbers of a passage with their errors: of sampling, of the time step, of cells, and of the density at the start.

use rayon::prelude::*;

use super::layout::Layout;
use super::map::PassageMap;
use super::numbers::Functions;
use super::operator::{Counted, Operator, StartVector};
use super::survival::Times;
use crate::cancellation::Cancellation;
use crate::continuation::PassageFault;
use crate::method::MethodError;
use crate::numerics::{in_parallel, jackknife};
use crate::passage::WithError;
use crate::space::CellSpace;

/// Residual from which on a solution is none.
const LARGEST_RESIDUAL: f64 = 1e-3;

/// Paths that are thought to end where none does, for the binomial error of a probability.
const HALF_A_PATH: f64 = 0.5;

/// Share of a mean time that its error may have.
const LARGEST_ERROR: f64 = 1.0;

/// Numbers, and what the time step does to each.
pub(super) struct WithStep {
    numbers: Vec<WithError>,
    /// Of the mean time: what the whole step changes, and the error of sampling.
    step: (f64, f64),
}

impl WithStep {
    /// Whether the time step changes the mean time by more than sampling may.
    pub(super) fn is_biased(&self) -> bool {
        self.step.0.abs() > self.step.1
    }

    /// The numbers, where the mean time is known to its own size.
    pub(super) fn numbers(self) -> Result<Vec<WithError>, PassageFault> {
        let is_known = |&(value, error): &WithError| error <= LARGEST_ERROR * value;
        match self.numbers.first().is_some_and(is_known) {
            true => Ok(self.numbers),
            false => Err(PassageFault::Rounding),
        }
    }
}

/// The numbers of a map. Starts have weights in each cell, and others without one group of the density's samples each.
pub(super) fn with_errors(
    space: &CellSpace,
    map: &PassageMap,
    times: &Times,
    (weights, others): (&[Vec<f64>], &[Vec<Vec<f64>>]),
    cancellation: &Cancellation,
) -> Result<Result<WithStep, PassageFault>, MethodError> {
    let asked = (map.asked.map_step, map.asked.exits);
    let (cells, pairs) = (Layout::new(space, map, 1), Layout::new(space, map, 2));
    let all = Operator::new(map, Counted::All, &cells, weights);
    let functions = Functions::new(&all, asked, cancellation)?;
    if functions.residual.is_nan() || functions.residual > LARGEST_RESIDUAL {
        return Ok(Err(PassageFault::Rounding));
    }
    let (values, doubts) = functions.numbers(&all, &all.start, times);
    if values.iter().any(|value| !value.is_finite()) || values[2] <= 0.0 {
        return Ok(Err(PassageFault::Rounding));
    }
    let groups = (0..map.groups).map(|group| (Counted::Without(group), &cells));
    let variants = groups.chain([(Counted::Coarse, &cells), (Counted::All, &pairs)]);
    let variants: Vec<(Counted, &Layout)> = variants.collect();
    let numbers = in_parallel(variants.len(), |number| {
        let (counted, layout) = variants[number];
        let operator = Operator::new(map, counted, layout, weights);
        let functions = Functions::new(&operator, asked, cancellation)?;
        Ok::<_, MethodError>(functions.numbers(&operator, &operator.start, times).0)
    })?;
    let (without, both) = numbers.split_at(map.groups);
    let starts: Vec<Vec<f64>> = (others.par_iter())
        .map(|weights| {
            let start = StartVector::new(map, Counted::All, &cells, weights);
            functions.numbers(&all, &start, times).0
        })
        .collect();
    let known = |other: f64, value: f64| match other.is_finite() {
        true => other - value,
        false => value,
    };
    // Where no path ends, or all do, groups do not differ: a probability is known to a part of a path at best.
    let probabilities = 3..3 + map.asked.exits + times.count();
    let least = HALF_A_PATH.sqrt() / map.start_paths() as f64;
    let one = |(number, (&value, &doubt)): (usize, (&f64, &f64))| {
        let sampling = jackknife(without.iter().map(|numbers| numbers[number]));
        let sampling = match (sampling.is_finite(), probabilities.contains(&number)) {
            (false, _) => value,
            (true, true) => sampling.max(least),
            (true, false) => sampling,
        };
        let [step, of_cells] = [0, 1].map(|place| known(both[place][number], value));
        let density = match starts.is_empty() {
            true => 0.0,
            false => jackknife(starts.iter().map(|numbers| numbers[number])),
        };
        let parts = [sampling, step, of_cells, density, doubt];
        let error = parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        ((value, error), (step, sampling))
    };
    let numbers = values.iter().zip(&doubts).enumerate().map(one);
    let (numbers, steps): (Vec<WithError>, Vec<(f64, f64)>) = numbers.unzip();
    let step = steps.first().copied().unwrap_or((0.0, 0.0));
    Ok(Ok(WithStep { numbers, step }))
}
