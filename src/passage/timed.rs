//! The numbers of a passage with their errors, from several grids.

use std::sync::{Arc, OnceLock};

use super::laid_out::on_cells;
use super::memory::PassageMemory;
use super::moments::Numbers;
use super::solve::Question;
use super::{KnownDensity, Passage, PassageError, probability};
use crate::cancellation::Cancellation;
use crate::generator::GeneratorOptions;
use crate::space::CellSpace;
use crate::stationary::generator::{AbsorbingWork, RateOptions};
use crate::system::System;

/// Grids by which errors are made: cells an axis over those of the sweep, and how often what they differ by is taken.
/// At a convergence order of three the true error is 0.73 and 0.28 times those differences, at four 0.46 and 0.15
/// times. Where a border passes between nodes moves errors about, so that one difference alone may vanish by chance.
pub(super) const FEWER: [(f64, f64); 2] = [(0.75, 1.4), (0.6, 0.6)];

/// Share of the difference by dissipation that stays as an error once it is extrapolated away.
pub(super) const DAMPED: f64 = 0.25;

/// Order at which what a border of lower order changes vanishes with finer cells. Where a border is oblique it changes
/// its sign from cell to cell, so that on one grid alone its sum may be small by chance.
pub(super) const BORDER_ORDER: i32 = 3;

/// A number with its error.
pub type WithError = (f64, f64);

/// What is known of a passage.
#[derive(Debug, Clone, PartialEq)]
pub struct Timed {
    /// Mean time.
    pub mean: WithError,
    /// Standard deviation of the time.
    pub deviation: WithError,
    /// Rate at which processes end that have lasted long.
    pub rate: WithError,
    /// Shares of the processes that end by entering each part of the target that was asked for.
    pub shares: Vec<WithError>,
    /// Probabilities that the process still goes on at the times that were asked for.
    pub survival: Vec<WithError>,
    /// The quantiles that were asked for.
    pub quantiles: Vec<WithError>,
    /// What it took.
    pub work: AbsorbingWork,
}

/// The numbers of a passage of a system on the cells of a sweep; `density` is its steady state there, where a start is
/// weighted by that. They do not depend on what was solved before.
///
/// # Errors
/// [`PassageError`].
pub fn timed(
    system: &Arc<dyn System>,
    space: &CellSpace,
    passage: &Passage,
    density: Option<KnownDensity<'_>>,
    settings: (&GeneratorOptions, &RateOptions),
    cancellation: &Cancellation,
) -> Result<Timed, PassageError> {
    let memory = PassageMemory::default();
    timed_from(
        (system, space),
        passage,
        density,
        settings,
        &memory,
        cancellation,
    )
}

/// The same numbers, with what the same passage has left at another value of a parameter, which makes them sooner.
///
/// # Errors
/// [`PassageError`].
pub(crate) fn timed_from(
    (system, space): (&Arc<dyn System>, &CellSpace),
    passage: &Passage,
    density: Option<KnownDensity<'_>>,
    settings: (&GeneratorOptions, &RateOptions),
    memory: &PassageMemory,
    cancellation: &Cancellation,
) -> Result<Timed, PassageError> {
    let laid = on_cells((system.as_ref(), space), passage, density)?;
    let planes = density.map_or(&[][..], |density| density.planes);
    let (space, density) = match &laid {
        Some((cells, of_density)) => {
            let density = of_density.as_ref().map(|laid| laid.density(planes));
            (cells, density)
        }
        None => (space, density),
    };
    let question = Question {
        system,
        space,
        passage,
        density,
        options: settings.0,
        rates: settings.1,
        cancellation,
        masses: OnceLock::new(),
    };
    // The density of the rate on the fewest cells is where the others look for theirs.
    let [more, fewest] = FEWER;
    let [of_finest, of_coarse, of_coarsest] = &memory.grids;
    let coarsest = question.solve(fewest.0, None, of_coarsest)?;
    let begun = Some(&coarsest.lasting);
    let (finest, coarse) = rayon::join(
        || question.solve(1.0, begun, of_finest),
        || question.solve(more.0, begun, of_coarse),
    );
    let (finest, coarse) = (finest?, coarse?);
    let mut work = finest.work;
    let finest = finest.both;
    let values = without_dissipation(&finest);
    let mut errors: Vec<f64> = pairs(&finest[0].values, &finest[1].values)
        .map(|(full, half)| DAMPED * (full - half).abs())
        .collect();
    let mut border = finest[0].border.clone();
    for (solved, (factor, times)) in [(coarse, more), (coarsest, fewest)] {
        let others = without_dissipation(&solved.both);
        for (error, (value, other)) in errors.iter_mut().zip(pairs(&values, &others)) {
            *error = error.max(times * (value - other).abs());
        }
        let size = f64::powi(factor, BORDER_ORDER);
        for (error, other) in border.iter_mut().zip(&solved.both[0].border) {
            *error = error.max(size * other);
        }
        work.add(solved.work);
    }
    for (error, border) in errors.iter_mut().zip(border) {
        *error += border;
    }
    let reduced = pairs(&finest[0].errors, &finest[1].errors);
    let all = pairs(&values, &errors).zip(reduced);
    let mut all = all.map(|((value, error), (full, half))| (value, error + full.max(half)));
    let mut next = || all.next().unwrap_or((f64::NAN, f64::NAN));
    let [mean, deviation, rate] = [next(), next(), next()];
    if !(mean.0 > mean.1 && deviation.0 > 0.0 && rate.0 > 0.0) {
        return Err(PassageError::Rounding);
    }
    let exits = all.by_ref().take(passage.exits.len());
    let shares = exits.map(probability).collect();
    let times = all.by_ref().take(passage.times.len());
    let survival = times.map(probability).collect();
    Ok(Timed {
        mean,
        deviation,
        rate,
        shares,
        survival,
        quantiles: all.collect(),
        work,
    })
}

fn pairs<'v>(one: &'v [f64], other: &'v [f64]) -> impl Iterator<Item = (f64, f64)> + 'v {
    one.iter().copied().zip(other.iter().copied())
}

fn without_dissipation([full, half]: &[Numbers; 2]) -> Vec<f64> {
    let both = pairs(&full.values, &half.values);
    both.map(|(full, half)| 2.0 * half - full).collect()
}
