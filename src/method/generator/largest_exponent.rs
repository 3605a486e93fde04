//! The largest Lyapunov exponent along the stationary density, at the values of a sweep.
//!
//! On one axis it is the mean of a function of the state, and so it is where deviations along an axis never leave it.
//! Where the derivatives of drift and noise are the same everywhere it is that of a linear equation. Else the angle of
//! small deviations is an axis of harmonics ([`crate::system`], `tangent`): the density of state and angle is solved
//! for as any other, and the exponent is the mean rate of stretching. The last harmonics are made to decay as fast as
//! advection feeds them, or their end would throw back what it should let pass. The error adds up what more harmonics
//! change, twice, since errors fall by a power of their number and at least halve from one number to the next; and what
//! the cells do: the difference to fewer of them, twice what half of the dissipation changes, and the rate at which
//! mass leaves them.

use std::sync::Arc;

use super::source::Known;
use super::still_noise::where_noise_dies;
use super::{GeneratorCost, GeneratorMethodOptions, GeneratorSource};
use crate::cancellation::Cancellation;
use crate::continuation::measure::{DIVERGENCE, EXPONENT};
use crate::continuation::{Finding, Measure, MeasureKind, SolveReport};
use crate::density::Roughness;
use crate::exponent::{Exponent, largest};
use crate::generator::{
    Dissipation, Generator, GeneratorOptions, add_shared_noise, add_spectral_viscosity, assemble,
    assemble_damped, at_nodes, unknown_moments,
};
use crate::method::MethodError;
use crate::method::watched::planes;
use crate::space::{Axis, CellSpace};
use crate::stationary::generator::{RateOptions, RateSolver};
use crate::system::{ExponentMethod, HALF_TURN, Lanes, System, Tangent};

/// Harmonics of the angle that are tried one after the other.
const HARMONICS: [usize; 8] = [3, 4, 6, 8, 12, 16, 22, 30];

/// Harmonics with which the mean rate of turning is worked out.
const FEW: usize = 2;

/// Numbers of harmonics after which a change that neither is small nor falls by this factor is given up.
const ENOUGH: usize = 3;
const FALL: f64 = 0.7;

/// Share of the change before it that the last one counts for at least: two numbers may agree by chance.
const CHANCE: f64 = 0.1;

/// Change by more harmonics, relative to the mean size of the rate of stretching, at which no more are tried.
const CHANGE: f64 = 5e-4;

/// Cells of an axis on which harmonics are tried; the exponent is worked out on so many times as many, if there are so
/// many: it is a mean, for which fewer cells do than for the place of a peak.
const COARSE: usize = 32;
const FINER: f64 = 1.5;

/// Error, relative to the mean size of the rate of stretching, from which an exponent is not told: harmonics and cells
/// that resolve nothing give any number.
const UNKNOWN: f64 = 0.1;

/// Operations of a factorisation on all cells beyond which no more harmonics are tried: some tens of seconds.
const MOST_OPERATIONS: f64 = 1e12;

/// Harmonics that most oscillators do with, of which the cost is told.
const USUAL: usize = 8;

/// Relative error at which solves stop to be iterated.
const TOLERANCE: f64 = 1e-9;

/// Relative error of the difference between schemes.
const ROUGH: f64 = 1e-2;

/// Adds exponent and divergence to a report; `known` are the unknowns of the steady state, and by how much those of
/// another discretisation differ, and those of a third scheme, where there is one.
///
/// # Errors
/// [`MethodError::Cancelled`].
pub(super) fn add_largest_exponent(
    report: &mut SolveReport,
    source: &GeneratorSource,
    (system, value): (&Arc<dyn System>, f64),
    (known, third): (Option<Known<'_>>, Option<&[f64]>),
    cancellation: &Cancellation,
) -> Result<(), MethodError> {
    let (subject, space) = (source.problem.subject(), source.problem.space());
    let family = &subject.family;
    let by = ExponentMethod::Modes;
    let is_asked = family.questions.largest_exponent == Some(by);
    let Some((unknowns, changes)) = known.filter(|_| is_asked) else {
        return Ok(());
    };
    if subject.measures.is_empty() {
        return Ok(());
    }
    let moments = unknown_moments(space, unknowns).into_iter();
    let scales: Vec<f64> = moments.map(|(_, variance)| variance.sqrt()).collect();
    let Ok(tangent) = family.tangent(value, system, (&scales, by)) else {
        report.findings.push(Finding::NoExponent);
        return Ok(());
    };
    let axes = space.dimension();
    let still = where_noise_dies(system.as_ref(), space);
    let planes = planes(&source.kinked);
    let density = KnownMasses {
        space,
        unknowns,
        changes: [Some(changes), third].into_iter().flatten().collect(),
        unresolved: &still,
        planes: &planes,
    };
    let by_axis: Vec<Exponent> = (0..axes)
        .map(|axis| density.mean(&|states| tangent.diagonal(states)[axis]))
        .collect();
    let divergence = by_axis
        .iter()
        .fold(Exponent::default(), |sum, one| Exponent {
            value: sum.value + one.value,
            error: sum.error + one.error,
        });
    match exponent(source, tangent, &by_axis, cancellation) {
        Ok(Some(found)) => {
            let put = |kind: MeasureKind, one: Exponent| Measure {
                error: Some(one.error),
                ..kind.measure("", one.value)
            };
            report.put(put(EXPONENT, found));
            report.put(put(DIVERGENCE, divergence));
        }
        Err(MethodError::Cancelled(cancelled)) => return Err(cancelled.into()),
        Ok(None) | Err(_) => report.findings.push(Finding::NoExponent),
    }
    Ok(())
}

/// The exponent of a system, of which the mean growth rates along the axes are known.
fn exponent(
    source: &GeneratorSource,
    tangent: Tangent,
    by_axis: &[Exponent],
    cancellation: &Cancellation,
) -> Result<Option<Exponent>, MethodError> {
    if let Some(Ok(exact)) = tangent.linear().map(|linear| largest(&linear)) {
        return Ok(Some(exact));
    }
    if by_axis.len() == 1 || tangent.is_triangular() {
        let largest = by_axis.iter().max_by(|a, b| a.value.total_cmp(&b.value));
        return Ok(largest.copied());
    }
    let angles = Angles {
        tangent,
        options: &source.options,
        cancellation,
    };
    angles.exponent(source.problem.space())
}

/// A steady state, and what is known of its errors.
struct KnownMasses<'a> {
    space: &'a CellSpace,
    unknowns: &'a [f64],
    /// By how much the unknowns of other discretisations differ.
    changes: Vec<&'a [f64]>,
    /// Cells in which neither the density nor a function is resolved.
    unresolved: &'a [usize],
    /// Axes with coordinates of planes on which the derivative of the density jumps.
    planes: &'a [(usize, f64)],
}

impl KnownMasses<'_> {
    /// Mean of a function. Its error adds up, as that of other means, what other discretisations change, and what their
    /// differences would do were they independent from layer to layer of the cells, twice: sums over nodes have no
    /// other discretisation; besides what cells add that resolve nothing.
    fn mean(&self, function: &dyn Fn(&[Lanes]) -> Lanes) -> Exponent {
        let values = at_nodes(self.space, function);
        let sum =
            |weights: &[f64]| -> f64 { weights.iter().zip(&values).map(|(w, q)| w * q).sum() };
        let total: f64 = self.unknowns.iter().sum();
        let value = sum(self.unknowns) / total;
        let aside: Vec<f64> = values.iter().map(|one| one - value).collect();
        let part = |&cell: &usize| (self.unknowns[cell] * aside[cell]).abs();
        let unresolved: f64 = self.unresolved.iter().map(part).sum();
        let by_differences = self.changes.iter().map(|&differences| {
            let pairs = differences.iter().zip(&aside);
            let change: f64 = pairs.map(|(w, q)| w * q).sum();
            let roughness = Roughness {
                space: self.space,
                weights: self.unknowns,
                differences,
                planes: self.planes,
            };
            change.abs() + roughness.of(&aside)
        });
        let largest = values.iter().fold(0.0, |most: f64, q| most.max(q.abs()));
        Exponent {
            value,
            error: 2.0 * by_differences.sum::<f64>() / total + unresolved / total + 1e-12 * largest,
        }
    }
}

/// State and angle of a system at one value.
pub(super) struct Angles<'a> {
    pub(super) tangent: Tangent,
    pub(super) options: &'a GeneratorMethodOptions,
    pub(super) cancellation: &'a Cancellation,
}

/// A mean rate of stretching on some cells.
struct Stretching {
    mean: f64,
    /// Mean of its size.
    size: f64,
    /// What half of the dissipation changes, where that was asked for.
    by_scheme: f64,
    /// Rate at which mass leaves the cells: the exponent is that of the paths which stay.
    escape: f64,
}

impl Angles<'_> {
    /// The exponent with its error; `None` where cells and harmonics do not resolve state and angle.
    pub(super) fn exponent(&self, space: &CellSpace) -> Result<Option<Exponent>, MethodError> {
        let [coarse, fine] = cells(space);
        let turning = self.turning(&coarse)?;
        let of_angle = self.harmonics(&coarse, &fine, turning)?;
        let Some((harmonics, on_coarse, by_harmonics)) = of_angle else {
            return Ok(None);
        };
        let Some(found) = self.solve(&fine, (harmonics, turning), true)? else {
            return Ok(None);
        };
        let by_cells = (found.mean - on_coarse).abs() + 2.0 * found.by_scheme.abs();
        let error = 2.0 * by_harmonics + by_cells + found.escape;
        // What is not a number is not small.
        let is_known = error <= UNKNOWN * found.size;
        let value = found.mean;
        Ok(is_known.then_some(Exponent { value, error }))
    }

    /// How many harmonics do, the rate of stretching with them on coarse cells, and what more of them change there.
    fn harmonics(
        &self,
        coarse: &[Axis],
        fine: &[Axis],
        turning: f64,
    ) -> Result<Option<(usize, f64, f64)>, MethodError> {
        let mut tried: Vec<(usize, f64)> = Vec::new();
        let mut changes: Vec<f64> = Vec::new();
        let mut by_harmonics = None;
        for harmonics in HARMONICS {
            if by_harmonics.is_some() && !self.is_affordable(fine, harmonics)? {
                break;
            }
            let Some(now) = self.solve(coarse, (harmonics, turning), false)? else {
                return Ok(None);
            };
            if let Some((_, fewer)) = tried.last() {
                changes.push((now.mean - fewer).abs());
            }
            if let [.., earlier, last] = changes[..] {
                let change = last.max(CHANCE * earlier);
                by_harmonics = Some(change);
                if change <= CHANGE * now.size {
                    break;
                }
                let is_enough = tried.len() >= ENOUGH;
                // What is not a number does not fall.
                let is_falling = last <= FALL * earlier || last <= UNKNOWN * now.size;
                if is_enough && !is_falling {
                    return Ok(None);
                }
            }
            tried.push((harmonics, now.mean));
        }
        let last = tried.last().zip(by_harmonics);
        Ok(last.map(|(&(harmonics, mean), change)| (harmonics, mean, change)))
    }

    /// Whether a factorisation with so many harmonics takes little enough.
    fn is_affordable(&self, cells: &[Axis], harmonics: usize) -> Result<bool, MethodError> {
        let space = with_angle(cells, harmonics)?;
        let cost = self.options.cost(&space);
        Ok(cost.is_ok_and(|cost| cost.factors.operations <= MOST_OPERATIONS))
    }

    /// Mean over the states of the fastest rate at which deviations turn there, in 1/t. The density of the states does
    /// not depend on harmonics.
    fn turning(&self, cells: &[Axis]) -> Result<f64, MethodError> {
        let space = with_angle(cells, FEW)?;
        let generator = self.assemble(&space, 0.0, Dissipation::Full)?;
        let mut solver = self.solver(&space);
        let steady = solver.solve(&generator.matrix, &generator.escape, None)?;
        let rates = at_nodes(&space, &|states| self.tangent.turning(states));
        let angles = 2 * FEW + 1;
        let states = rates.chunks(angles).zip(steady.mass.chunks(angles));
        Ok(states
            .map(|(rates, mass)| {
                let fastest = rates
                    .iter()
                    .fold(0.0, |most: f64, rate| most.max(rate.abs()));
                fastest * mass.iter().sum::<f64>()
            })
            .sum())
    }

    fn solver(&self, space: &CellSpace) -> RateSolver {
        let rates = RateOptions {
            tolerance: TOLERANCE,
            memory_limit_bytes: (self.options.memory_limit * 1e9) as u64,
            ..RateOptions::default()
        };
        RateSolver::new(space.clone(), rates).cancelled_by(self.cancellation)
    }

    fn solve(
        &self,
        cells: &[Axis],
        (harmonics, turning): (usize, f64),
        is_judged: bool,
    ) -> Result<Option<Stretching>, MethodError> {
        let space = with_angle(cells, harmonics)?;
        let decay = harmonics as f64 * turning;
        let generator = self.assemble(&space, decay, Dissipation::Full)?;
        let mut solver = self.solver(&space);
        let steady = solver.solve(&generator.matrix, &generator.escape, None)?;
        if !steady.info.converged {
            return Ok(None);
        }
        let values = at_nodes(&space, &|states| self.tangent.stretching(states));
        let sum = |of: &dyn Fn(f64) -> f64, weights: &[f64]| -> f64 {
            weights.iter().zip(&values).map(|(w, &q)| w * of(q)).sum()
        };
        let mean = sum(&|q| q, &steady.mass);
        let by_scheme = if is_judged {
            let half = self.assemble(&space, decay, Dissipation::Half)?;
            let change = solver.sensitivity_within(&half.matrix, &steady.mass, None, ROUGH)?;
            sum(&|q| q - mean, &change)
        } else {
            0.0
        };
        Ok(Some(Stretching {
            mean,
            size: sum(&f64::abs, &steady.mass),
            by_scheme,
            escape: steady.info.escape_rate.abs(),
        }))
    }

    fn assemble(
        &self,
        space: &CellSpace,
        decay: f64,
        dissipation: Dissipation,
    ) -> Result<Generator, MethodError> {
        let (tangent, scheme) = (&self.tangent, self.options.scheme);
        let options = &GeneratorOptions { scheme };
        let assembled = match dissipation {
            Dissipation::Full => assemble(tangent, space, options),
            Dissipation::Half => assemble_damped(tangent, space, options, dissipation),
        };
        let mut generator = assembled.map_err(|error| MethodError::Generator {
            words: error.to_string(),
            error,
        })?;
        for (axis, product) in tangent.shared() {
            add_shared_noise(&mut generator, space, axis, &product);
        }
        add_spectral_viscosity(&mut generator, space, decay);
        Ok(generator)
    }
}

/// Few cells, on which harmonics are tried, and those on which the exponent is worked out.
fn cells(space: &CellSpace) -> [Vec<Axis>; 2] {
    let axes = space.axes();
    let most = axes.iter().map(Axis::count).max().unwrap_or(COARSE) as f64;
    let fine = most.min(FINER * COARSE as f64);
    [fine / FINER, fine].map(|most| {
        let fewer = |axis: &Axis| axis.refined((most / axis.count() as f64).min(1.0));
        axes.iter().map(fewer).collect()
    })
}

/// What the exponent takes at every value on these cells, with the harmonics that most oscillators do with; `None`
/// where it is no more than a mean.
pub(crate) fn cost_of_largest_exponent(
    space: &CellSpace,
    options: &GeneratorMethodOptions,
) -> Option<GeneratorCost> {
    let [_, fine] = cells(space);
    let space = with_angle(&fine, USUAL).ok()?;
    options.cost(&space).ok().filter(|_| fine.len() == 2)
}

/// Cells with so many harmonics of the angle.
fn with_angle(cells: &[Axis], harmonics: usize) -> Result<CellSpace, MethodError> {
    let mut axes = cells.to_vec();
    axes.push(Axis::fourier(HALF_TURN.0, HALF_TURN.1, harmonics)?);
    Ok(CellSpace::new(axes)?)
}
