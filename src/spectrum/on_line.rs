//! Slow modes and spectra on one axis, from the chain that its motion is (`generator::chain`).
//!
//! Nothing oscillates there: eigenvalues are real, correlations are sums of decays with weights above zero, and cross
//! spectra are real.

use nalgebra::DMatrix;

use super::power::{FEATURES, features, features_of};
use super::slow::UNKNOWN;
use super::transfer::Transfer;
use super::{PowerQuestion, SlowMode, SlowModes, Spectrum};
use crate::generator::{Chain, Mesh, Reduced};
use crate::space::Axis;
use crate::stationary::generator::AbsorbingWork;

/// Vectors of each of two starts from which modes are read, and more for each that is wanted.
const VECTORS: usize = 16;
const VECTORS_A_MODE: usize = 3;

/// Vectors an observable of a model of spectra.
const OF_SPECTRA: usize = 32;

/// Share of the vectors that tell by how much fewer would change a number.
const FEWER: f64 = 0.8;

/// The slowest modes of a line, with the first one's left vector on the cells of an axis.
pub(crate) fn slow_modes_on_line(line: &Mesh, wanted: usize, axis: &Axis) -> SlowModes {
    let wanted_at_all = wanted.max(1);
    let vectors = VECTORS + VECTORS_A_MODE * wanted_at_all;
    // A function that has a part of every mode.
    let uneven = |place: usize, count: usize| {
        let share = place as f64 / count as f64;
        share + 0.3 * (share * 17.0).sin() + 0.2 * (place as f64 * 0.754_877_666).fract()
    };
    let (mut all, mut fewer, mut left) = (Vec::new(), Vec::new(), Vec::new());
    for (number, grid) in line.grids().iter().enumerate() {
        let chain = &grid.chain;
        let count = chain.masses.len();
        let smooth: Vec<f64> = (0..count).map(|place| uneven(place, count)).collect();
        // States that are hardly ever visited have modes of their own.
        let pairs = smooth.iter().zip(&chain.masses);
        let rough = pairs.map(|(value, mass)| match *mass > 0.0 {
            true => value / mass.sqrt(),
            false => 0.0,
        });
        let starts = [smooth.clone(), rough.collect()];
        let krylov = chain.krylov(&starts.map(|start| centred(chain, start)), vectors);
        let Reduced { rates, functions } = krylov.reduced(1.0, number == 0);
        if number == 0 {
            fewer = krylov.reduced(FEWER, false).rates;
            left = functions.into_iter().next().unwrap_or_default();
        }
        all.push(rates);
    }
    let rate = |of: &[f64], mode: usize| of.get(mode).copied().unwrap_or(f64::INFINITY);
    let modes = (0..wanted_at_all).map(|mode| {
        let own = rate(&all[0], mode);
        let (value, error) = line.extrapolated([own, rate(&all[1], mode), rate(&all[2], mode)]);
        SlowMode {
            decay: (value, error + (own - rate(&fewer, mode)).abs()),
            frequency: (0.0, 0.0),
        }
    });
    let is_known = |mode: &SlowMode| mode.decay.1 <= UNKNOWN * mode.decay.0;
    let modes: Vec<SlowMode> = modes.take_while(is_known).collect();
    let discriminant = match modes.as_slice() {
        [first, second, ..] => {
            let half = 0.5 * (second.decay.0 - first.decay.0);
            let error = 0.5 * (second.decay.1 + first.decay.1);
            Some((half * half, 2.0 * half.abs() * error + error * error))
        }
        _ => None,
    };
    let on_cells = axis.nodes().iter().map(|&node| line.at(&left, node));
    SlowModes {
        left: match modes.is_empty() {
            true => Vec::new(),
            false => on_cells.collect(),
        },
        modes,
        discriminant,
        work: AbsorbingWork::default(),
    }
}

/// The spectra of functions of the coordinate on a line; `None` where they have no values there.
pub(crate) fn power_spectra_on_line(
    line: &Mesh,
    question: &PowerQuestion<'_>,
) -> Option<Vec<Spectrum>> {
    let loads: Vec<Vec<f64>> = question
        .observables
        .iter()
        .map(|observable| line.load(|_| true, |place| observable(&[place])))
        .collect();
    if !loads.iter().flatten().all(|value| value.is_finite()) {
        return None;
    }
    let mut models = Vec::new();
    for (number, grid) in line.grids().iter().enumerate() {
        let chain = &grid.chain;
        let own: Vec<Vec<f64>> = loads
            .iter()
            .map(|load| fluctuation(chain, grid.restricted(load)))
            .collect();
        let starts: Vec<Vec<f64>> = own.iter().map(|load| over_masses(chain, load)).collect();
        let krylov = chain.krylov(&starts, OF_SPECTRA);
        models.push(model(&krylov.reduced(1.0, true), &own)?);
        if number == 0 {
            models.push(model(&krylov.reduced(FEWER, true), &own)?);
        }
    }
    let spectra = question.pairs.iter().map(|&pair| {
        let numbers: Vec<Vec<f64>> = models
            .iter()
            .map(|model| numbers(model, pair, question))
            .collect();
        let known: Vec<(f64, f64)> = (0..numbers[0].len())
            .map(|number| {
                let [own, fewer, thinned, shorter] =
                    [0, 1, 2, 3].map(|model| numbers[model][number]);
                let (value, error) = line.extrapolated([own, thinned, shorter]);
                (value, error + (own - fewer).abs())
            })
            .collect();
        let count = question.frequencies.len();
        let is_power = pair.0 == pair.1;
        let after = count + if is_power { FEATURES } else { 0 };
        Spectrum {
            real: known[..count].to_vec(),
            imaginary: match is_power {
                true => Vec::new(),
                false => vec![(0.0, 0.0); count],
            },
            features: is_power.then(|| features(&known[count..after])),
            correlation: known[after..].to_vec(),
        }
    });
    Some(spectra.collect())
}

/// Without its mean.
fn centred(chain: &Chain, mut values: Vec<f64>) -> Vec<f64> {
    let mean = Chain::over(&chain.masses, &values) / chain.masses.iter().sum::<f64>();
    values.iter_mut().for_each(|value| *value -= mean);
    values
}

/// The load of a function less its mean.
fn fluctuation(chain: &Chain, mut load: Vec<f64>) -> Vec<f64> {
    let mean = load.iter().sum::<f64>() / chain.masses.iter().sum::<f64>();
    let pairs = load.iter_mut().zip(&chain.masses);
    pairs.for_each(|(value, mass)| *value -= mean * mass);
    load
}

fn over_masses(chain: &Chain, load: &[f64]) -> Vec<f64> {
    let pairs = load.iter().zip(&chain.masses);
    pairs
        .map(|(value, mass)| if *mass > 0.0 { value / mass } else { 0.0 })
        .collect()
}

/// How observables, given by their loads, fluctuate by modes.
fn model(modes: &Reduced, loads: &[Vec<f64>]) -> Option<Transfer> {
    let size = modes.rates.len();
    let rows = DMatrix::from_fn(loads.len(), size, |observable, mode| {
        Chain::over(&loads[observable], &modes.functions[mode])
    });
    let rates = DMatrix::from_fn(size, size, |row, column| match row == column {
        true => -modes.rates[row],
        false => 0.0,
    });
    (size > 0)
        .then(|| Transfer::new(&rates, &rows, &rows.transpose()))
        .flatten()
}

/// Powers, features of those and correlations, one after the other.
fn numbers(
    model: &Transfer,
    (one, other): (usize, usize),
    question: &PowerQuestion<'_>,
) -> Vec<f64> {
    let frequencies = question.frequencies.iter();
    let (step, count) = question.lags;
    let mut all: Vec<f64> = frequencies
        .map(|&at| model.cross(at, (one, other)).re)
        .collect();
    if one == other {
        let slowest = model
            .poles()
            .map(|pole| pole.norm())
            .fold(f64::INFINITY, f64::min);
        let highest = question.frequencies.last().copied().unwrap_or(0.0);
        let covariance = model.covariance(one, one);
        let upto = highest.max(slowest);
        all.extend(features_of(model, (one, covariance), upto));
    }
    all.extend(model.correlations((one, other), step, count).0);
    all
}
