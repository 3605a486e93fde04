//! Power spectra, cross spectra and correlation functions in a steady state, each number with its error.

use std::f64::consts::PI;
use std::sync::Arc;

use super::breaks::summable;
use super::errors::{Estimate, Worked, combined, on_grids, smoothed};
use super::grid::Grid;
use super::motion::Motion;
use super::peak::{Lowest, Peak, Shape, steepest_rise};
use super::resolvent::Resolvent;
use super::transfer::Transfer;
use super::{SpectrumError, Steady};
use crate::cancellation::Cancellation;
use crate::generator::GeneratorOptions;
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::{AbsorbingWork, RateOptions, RateSolver};
use crate::system::System;

/// A function of the state whose fluctuations are looked at.
pub type StateFunction<'a> = &'a (dyn Fn(&[f64]) -> f64 + Sync);

/// What is asked of fluctuations.
#[derive(Clone, Copy)]
pub struct PowerQuestion<'a> {
    /// Functions of the state.
    pub observables: &'a [StateFunction<'a>],
    /// Pairs of them by their numbers; a power spectrum where both are the same.
    pub pairs: &'a [(usize, usize)],
    /// Angular frequencies, per unit time, ascending, none below zero.
    pub frequencies: &'a [f64],
    /// Distance and number of the lags at which correlations are wanted, from zero on.
    pub lags: (f64, usize),
}

/// A value with its error.
type Known = (f64, f64);

/// The spectrum of a pair of observables g and h.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Spectrum {
    /// Real part of ∫ C(τ) e^{-iωτ} dτ with C(τ) = E[g(t + τ) h(t)] less the means, over all τ of either sign, at each
    /// frequency: so that its integral over all ω of either sign is 2π times the covariance. In the units of g and h
    /// times that of time.
    pub real: Vec<Known>,
    /// The imaginary part; empty where both observables are the same.
    pub imaginary: Vec<Known>,
    /// C(τ) at each lag.
    pub correlation: Vec<Known>,
    /// Numbers of a power spectrum; `None` of a cross spectrum.
    pub features: Option<Features>,
}

impl Spectrum {
    /// The real part at the frequency of a number, which is left out from here on; `None` where there is none.
    pub(crate) fn taken_out(&mut self, number: usize) -> Option<Known> {
        if number < self.imaginary.len() {
            self.imaginary.remove(number);
        }
        (number < self.real.len()).then(|| self.real.remove(number))
    }
}

/// Numbers of a power spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Features {
    /// Frequency of the highest maximum above zero; `None` where there is none.
    pub peak: Option<Known>,
    /// Its full width at half of its height; `None` where the spectrum stays above that down to zero.
    pub width: Option<Known>,
    /// ∫₀^∞ C(τ) dτ / C(0).
    pub correlation_time: Option<Known>,
    /// S''(0)/S(0), in the square of time: above zero the spectrum rises from zero on.
    pub curvature: Option<Known>,
    /// The largest local maximum above zero of d ln S / d ln ω: above zero where the spectrum has a maximum at a
    /// frequency above zero. Where there is no power at zero and that slope falls from there on, its value there;
    /// `None` where there is no such maximum of the slope.
    pub rise: Option<Known>,
}

/// Spectra, and what they took.
#[derive(Debug, Clone, PartialEq)]
pub struct Power {
    /// One a pair.
    pub spectra: Vec<Spectrum>,
    /// Factorisations and passes.
    pub work: AbsorbingWork,
}

/// Numbers of a feature of a spectrum.
pub(super) const FEATURES: usize = 5;

/// The spectra of a system on the cells of a sweep. They do not depend on what was solved before.
///
/// # Errors
/// [`SpectrumError`].
pub fn power_spectra(
    system: &Arc<dyn System>,
    space: &CellSpace,
    question: &PowerQuestion<'_>,
    steady: Steady<'_>,
    settings: (&GeneratorOptions, &RateOptions),
    cancellation: &Cancellation,
) -> Result<Power, SpectrumError> {
    let solve = |grid: &Grid, motion: &Motion, coarser: Option<(&CellSpace, &OnGrid)>| {
        let begun = coarser.map_or(&[][..], |(_, known)| &known.places);
        on_grid(grid, (question, begun), motion, (settings.1, cancellation))
    };
    let ((finest, others), work) = on_grids(system, space, steady, settings.0, solve, |_| true)?;
    let others: Vec<Vec<Estimate>> = others.into_iter().map(|one| one.numbers).collect();
    let known = combined(&finest.numbers, &others);
    let mut rest = known.as_slice();
    let spectra = question.pairs.iter().map(|&(one, other)| {
        let mut take = |count: usize| {
            let (taken, left) = rest.split_at(count);
            rest = left;
            taken.to_vec()
        };
        let count = question.frequencies.len();
        let real = take(count);
        let (imaginary, features) = if one == other {
            (Vec::new(), Some(features(&take(FEATURES))))
        } else {
            (take(count), None)
        };
        let correlation = take(question.lags.1);
        Spectrum {
            real: smoothed(&real),
            imaginary: smoothed(&imaginary),
            correlation: smoothed(&correlation),
            features,
        }
    });
    Ok(Power {
        spectra: spectra.collect(),
        work,
    })
}

/// Most cells an axis of a grid on which the rate of change is looked at.
const ROUGH_CELLS: f64 = 32.0;

/// The rate at which states change in the steady state: the largest, over the axes, of the root mean square of the
/// drift over the standard deviation. It is worked out on fewer cells, to a few per cent.
///
/// # Errors
/// [`SpectrumError`].
pub(crate) fn rate_of_change(
    system: &Arc<dyn System>,
    space: &CellSpace,
    settings: (&GeneratorOptions, &RateOptions),
    cancellation: &Cancellation,
) -> Result<f64, SpectrumError> {
    let cells = space.axes().iter().filter(|axis| !axis.is_modes());
    let most = cells.map(Axis::count).max();
    let factor = ROUGH_CELLS / most.unwrap_or(1) as f64;
    let grid = Grid::new(system, space, (factor.min(1.0), None), settings.0)?;
    let mut solver = RateSolver::new(grid.space.clone(), *settings.1).cancelled_by(cancellation);
    let masses = solver
        .solve(&grid.full, &vec![0.0; grid.space.n_cells()], None)?
        .mass;
    let closed = vec![[true; 2]; grid.space.dimension()];
    let steady = Steady {
        masses: &masses,
        closed: &closed,
        phase: None,
    };
    let motion = Motion::new(&grid, system.as_ref(), steady).ok_or(SpectrumError::Still)?;
    Ok(motion.rate)
}

/// Relative error from which a number of a spectrum is not told.
const UNKNOWN: f64 = 0.2;

pub(super) fn features(known: &[Known]) -> Features {
    let told = |(value, error): Known, size: f64| {
        let is_known = error <= UNKNOWN * value.abs().max(size);
        is_known.then_some((value, error))
    };
    let correlation_time = told(known[2], 0.0);
    Features {
        peak: told(known[0], 0.0),
        width: told(known[1], 0.0),
        correlation_time,
        // These two may be near zero: their sizes are those of a Lorentzian of the same correlation time, and one.
        curvature: correlation_time.and_then(|(time, _)| told(known[3], 2.0 * time * time)),
        rise: told(known[4], 1.0),
    }
}

/// What a grid gives.
struct OnGrid {
    /// All numbers that are asked for, one after the other.
    numbers: Vec<Estimate>,
    /// Frequencies at which the model has shifts, and how many solves each has.
    places: Vec<(f64, usize)>,
}

/// What one grid gives, and what it took; `begun` are the frequencies at which another grid has shifts, and its solves
/// there.
fn on_grid(
    grid: &Grid,
    (question, begun): (&PowerQuestion<'_>, &[(f64, usize)]),
    motion: &Motion,
    solver: (&RateOptions, &Cancellation),
) -> Worked<OnGrid> {
    let cells = grid.space.n_cells();
    let values = question.observables.iter().map(|observable| {
        let at = |cell| observable(&grid.space.place(cell));
        (0..cells).map(at).collect()
    });
    let mut values: Vec<Vec<f64>> = values.collect();
    // Spectra are those of values that make sums integrals; at no lag the covariance is that of the values themselves.
    let mut of_spectra: Vec<usize> = (0..values.len()).collect();
    let mut jumps = vec![false; values.len()];
    for (number, observable) in question.observables.iter().enumerate() {
        if let Some(found) = summable(&grid.space, &grid.still, *observable, &values[number]) {
            of_spectra[number] = values.len();
            jumps[number] = found.jumps;
            values.push(found.values);
        }
    }
    let resolvent = Resolvent::new(grid, &values, (question.frequencies, begun), motion, solver)?;
    let resolvent = resolvent.ok_or(SpectrumError::Still)?;
    let [full, half, fewer] = &resolvent.transfers;
    let mut all = Vec::new();
    for &pair in question.pairs {
        let pairs = [pair, (of_spectra[pair.0], of_spectra[pair.1])];
        let numbers =
            [full, half, fewer].map(|transfer| numbers(transfer, pairs, question, motion));
        let shown = (numbers[0].as_slice(), highest(question, motion));
        let ends = of_ends(&resolvent, pairs, question, shown);
        for (number, &value) in numbers[0].iter().enumerate() {
            all.push(Estimate {
                value,
                change: numbers[1][number] - value,
                error: (numbers[2][number] - value).abs() + ends[number],
                // States that pass a jump slowly are seen by few cells.
                is_of_first_order: jumps[pair.0] || jumps[pair.1],
            });
        }
    }
    let found = OnGrid {
        numbers: all,
        places: resolvent.places,
    };
    Ok((found, resolvent.work))
}

/// The numbers from which [`Features`] are told, of a power spectrum up to a frequency and the variance.
pub(super) fn features_of(
    transfer: &Transfer,
    (one, variance): (usize, f64),
    highest: f64,
) -> [f64; FEATURES] {
    let shape = Shape::new(transfer, one, highest);
    let peak = Peak::of(&shape);
    let [at_zero, _, bend] = transfer.power_and_slopes(0.0, one);
    [
        peak.map_or(f64::NAN, |peak| peak.frequency),
        peak.and_then(|peak| peak.width).unwrap_or(f64::NAN),
        0.5 * at_zero / variance,
        bend / at_zero,
        steepest_rise(&shape).unwrap_or(f64::NAN),
    ]
}

/// The frequency up to which the shape of a spectrum is looked at.
fn highest(question: &PowerQuestion<'_>, motion: &Motion) -> f64 {
    let last = question.frequencies.last().copied().unwrap_or(0.0);
    last.max(motion.rate)
}

/// The numbers of a pair by one model: of its observables, and of what stands for them in spectra.
fn numbers(
    transfer: &Transfer,
    [pair, (one, other)]: [(usize, usize); 2],
    question: &PowerQuestion<'_>,
    motion: &Motion,
) -> Vec<f64> {
    let frequencies = question.frequencies.iter();
    let (step, count) = question.lags;
    let mut all: Vec<f64>;
    if one == other {
        all = frequencies.map(|&at| transfer.power(at, one)).collect();
        let variance = transfer.covariance(pair.0, pair.0);
        let upto = highest(question, motion);
        all.extend(features_of(transfer, (one, variance), upto));
    } else {
        let cross = frequencies.map(|&at| transfer.cross(at, (one, other)));
        let cross: Vec<_> = cross.collect();
        all = cross.iter().map(|value| value.re).collect();
        all.extend(cross.iter().map(|value| value.im));
    }
    all.extend(transfer.correlations(pair, step, count).0);
    all
}

/// What the ends of the range do to each of the numbers, at most.
fn of_ends(
    resolvent: &Resolvent,
    [pair, (one, other)]: [(usize, usize); 2],
    question: &PowerQuestion<'_>,
    (numbers, highest): (&[f64], f64),
) -> Vec<f64> {
    let at = |frequency: f64| {
        let there = resolvent.of_ends(frequency, (one, other));
        if one == other {
            2.0 * there
        } else {
            there + resolvent.of_ends(frequency, (other, one))
        }
    };
    let frequencies = question.frequencies.iter();
    let along: Vec<f64> = frequencies.map(|&frequency| at(frequency)).collect();
    let mut all = along.clone();
    if one == other {
        let [peak, width, time, curvature, rise] =
            [0, 1, 2, 3, 4].map(|place| numbers[along.len() + place]);
        let transfer = &resolvent.transfers[0];
        let power = |frequency: f64| transfer.power(frequency, one);
        let share = |frequency: f64| at(frequency) / power(frequency).abs();
        let shift = if peak.is_nan() { 0.0 } else { share(peak) };
        let extent = if width.is_nan() { peak } else { width };
        let still = share(0.0);
        all.extend([
            shift * extent,
            2.0 * shift * extent,
            still * time.abs(),
            2.0 * still * curvature.abs(),
            match Shape::new(transfer, one, highest).rise_from_zero() {
                // What little power there is at zero may hide that the rise begins a little above it.
                Some((limit, lowest)) if limit == rise => {
                    let Lowest {
                        frequency,
                        steepness,
                    } = lowest;
                    (limit - steepness).abs() + 2.0 * share(frequency)
                }
                _ => 2.0 * shift.max(still),
            },
        ]);
    } else {
        all.extend_from_slice(&along);
    }
    // A correlation is the integral of the spectrum over all frequencies over 2π.
    let intervals = question.frequencies.windows(2).zip(along.windows(2));
    let integral: f64 = intervals
        .map(|(at, off)| 0.5 * (at[1] - at[0]) * (off[0] + off[1]))
        .sum();
    let (_, left_out) = resolvent.transfers[0].correlations(pair, 0.0, 0);
    all.resize(numbers.len(), integral / PI + left_out);
    all
}
