//! Systems with one axis: the steady state by quadrature, which has all its digits in every cell.

use std::sync::Arc;

use super::GeneratorSource;
use super::jumps::Kinked;
use super::line_moments::put_on_line;
use super::source::METHOD;
use crate::continuation::{Finding, Sensitivity, Solution, SourceError};
use crate::density::{EstimatedDensity, EstimatedMoments, Moments, NEGLIGIBLE, Observable};
use crate::generator::{AxisEnd, End, OneAxis, Reach, exponent_at, one_axis, profile};
use crate::method::MethodError;
use crate::method::report::Reporter;
use crate::method::structure::closed_ends;
use crate::space::{Axis, CellSpace};
use crate::system::{Family, System, SystemError, absorbs};

/// Largest relative error of a cell that the quadrature may have; where noise nearly vanishes, or the drift jumps
/// inside a cell, the generator serves better.
const LARGEST_ERROR: f64 = 1e-6;

/// Step of differences, relative to the number that is varied (to `LEAST` where that is smaller). Their error is step⁴
/// p⁽⁵⁾/30, and rounding over the step.
const STEP: f64 = 2e-3;
const LEAST: f64 = 1e-2;

/// The only axis of a space, where it is a line.
fn line(space: &CellSpace) -> Option<&Axis> {
    match space.axes() {
        [axis] => Some(axis).filter(|axis| !axis.is_closed()),
        _ => None,
    }
}

/// The natural end of the axis that takes all mass, if there is one.
pub(super) fn absorbed(source: &GeneratorSource, system: &dyn System) -> Option<Finding> {
    let axis = line(source.problem.space())?;
    End::ALL.into_iter().find_map(|end| {
        let exponent = exponent_at(system, axis, end).filter(|exponent| absorbs(*exponent))?;
        let at = end.of(axis);
        Some(Finding::Absorbed {
            axis: 0,
            at,
            exponent,
        })
    })
}

/// The report of a value at which there is no stationary density.
pub(super) fn without_density(source: &GeneratorSource, why: Finding) -> Solution<'static> {
    let mut reporter = Reporter::new(METHOD, &source.problem);
    reporter.no_steady_state(why);
    Solution::without_density(reporter.report)
}

/// Masses by quadrature; `None` where the system has more axes, or pushes mass out of the range.
pub(super) fn masses(source: &GeneratorSource, system: &dyn System) -> Option<OneAxis> {
    let axis = line(source.problem.space())?;
    between_ends(system, axis, source.closed_ends.first().copied()?)
}

/// The same between ends of which some may be closed.
fn between_ends(system: &dyn System, axis: &Axis, [low, high]: [bool; 2]) -> Option<OneAxis> {
    let pushes_in = |at: f64, sign: f64| sign * system.drift_at(0.0, &[at])[0] > 0.0;
    let is_natural = |end: End| exponent_at(system, axis, end).is_some();
    let low = low || pushes_in(axis.from(), 1.0) || is_natural(End::Lower);
    let high = high || pushes_in(axis.to(), -1.0) || is_natural(End::Upper);
    if !(low && high) {
        return None;
    }
    one_axis(system, axis).filter(|found| found.error < LARGEST_ERROR)
}

/// How far the only axis of a system reaches, of which the steady state is known.
pub(super) fn reach<'a>(
    source: &'a GeneratorSource,
    system: &'a dyn System,
    found: &OneAxis,
) -> Option<Reach<'a>> {
    let axis = line(source.problem.space())?;
    let closed = source.closed_ends.first().copied()?;
    let end = |end: usize| match (found.ends[end], closed[end]) {
        (Some(exponent), _) => AxisEnd::Natural(exponent),
        (None, true) => AxisEnd::Wall,
        (None, false) => AxisEnd::Open,
    };
    Some(Reach {
        system,
        axis,
        ends: [end(0), end(1)],
        mean: found.moments.0,
    })
}

/// What the equations say of densities of a family with one axis: those that come back from a store know it as they did
/// when they were solved.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OneAxisFamily {
    /// Whether the ends of the axis are closed all along the sweep.
    closed: [bool; 2],
}

impl OneAxisFamily {
    /// `None` for a family with more axes.
    pub(crate) fn new(family: &Family, space: &CellSpace) -> Option<Self> {
        line(space)?;
        let systems = family.along().ok()?;
        let closed = closed_ends(&systems, space);
        Some(Self {
            closed: closed.first().copied()?,
        })
    }

    /// Gives a density over the axis, solved by the generator for a system of the family, what it is known by: the
    /// extrema of the equations where quadrature gives it, the solver's limit elsewhere.
    pub(crate) fn restore(self, density: &mut EstimatedDensity, system: &dyn System) {
        let [axis] = density.density.axes.as_slice() else {
            return;
        };
        match between_ends(system, axis, self.closed) {
            Some(found) => know(density, system, &found),
            None => density.negligible = NEGLIGIBLE,
        }
    }
}

/// Gives a density over the only axis what quadrature tells of it: its extrema, and that none of it is negligible.
fn know(density: &mut EstimatedDensity, system: &dyn System, found: &OneAxis) {
    let Some(axis) = density.density.axes.first() else {
        return;
    };
    let centre = density.structure.centre.as_ref();
    let centre = centre.and_then(|centre| centre.first().copied());
    density.structure.profile = profile(system, axis, found, centre).map(Arc::new);
    density.negligible = 0.0;
}

/// The solution at a value.
pub(super) fn solution<'session>(
    source: &'session GeneratorSource,
    value: f64,
    system: &dyn System,
    found: &OneAxis,
) -> Result<Solution<'session>, MethodError> {
    let masses = &found.masses;
    let mut reporter = Reporter::new(METHOD, &source.problem);
    reporter.report.residual = 0.0;
    reporter.report.solver_error = found.error;
    let mut closed = source.closed_ends.clone();
    for (closed, end) in closed.iter_mut().flatten().zip(found.ends) {
        *closed |= end.is_some();
    }
    reporter.edge_mass(masses, &closed);
    let difference: Vec<f64> = masses.iter().map(|mass| mass * found.error).collect();
    let (problem, maps) = (&source.problem, source.maps(value)?);
    let mut densities = maps.exact(problem, masses, &difference)?;
    let open = source.open_at(value)?;
    for one in &mut densities {
        let kinked = &source.kinked;
        one.structure = maps.structure(&*open, problem, masses, one.observable, kinked);
        one.truncation.share = reporter.missing().beyond;
        // Of quantities sub-cells leave more than the quadrature does.
        if one.observable == Observable::Marginal(0) {
            know(one, system, found);
        }
    }
    let deviation = found.moments.1.max(0.0).sqrt();
    // All cells off by no more than this share: so are both relative to the deviation.
    let error = found.error * deviation;
    let mut moments = vec![EstimatedMoments {
        moments: Moments {
            mean: found.moments.0,
            standard_deviation: deviation,
        },
        errors: Some(Moments {
            mean: error,
            standard_deviation: error,
        }),
    }];
    let second: Vec<f64> = masses.iter().zip(&difference).map(|(m, d)| m + d).collect();
    moments.extend(maps.exact_moments(problem.space(), masses, &[&second], &source.kinked)?);
    let averaged = maps.averaged.iter().map(|map| &map.quantity);
    if let Some(reach) = reach(source, system, found) {
        put_on_line(&mut reporter, &reach, averaged, &mut moments)?;
    }
    reporter.moments(&moments);
    Ok(Solution {
        sensitivity: Some(Box::new(QuadratureSensitivity { source, value })),
        ..reporter.solution(densities, None)
    })
}

/// How densities by quadrature answer to parameters: by differences, which the quadrature's digits allow.
struct QuadratureSensitivity<'session> {
    source: &'session GeneratorSource,
    value: f64,
}

impl Sensitivity for QuadratureSensitivity<'_> {
    fn to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let varied = self.source.varied(self.value, name)?;
        Ok(self.of(|value| varied.at(value), varied.value)?)
    }

    fn jumps_to_parameter(&mut self, name: &str) -> Result<Vec<Vec<f64>>, SourceError> {
        let varied = self.source.varied(self.value, name)?;
        // On one axis a kink is a point, and no mass is spread over it.
        let masses = vec![1.0; self.source.problem.space().n_cells()];
        let kinked = Kinked {
            source: self.source,
            coordinate: self.value,
            masses: &masses,
        };
        Ok(kinked.changes(|value| varied.at(value), varied.value, || Ok(Vec::new()))?)
    }

    fn along_path(&mut self) -> Result<Vec<Vec<f64>>, SourceError> {
        let family = self.source.problem.family();
        Ok(self.of(|value| family.at(value), self.value)?)
    }
}

impl QuadratureSensitivity<'_> {
    /// Of systems that depend on one number, at its value.
    fn of(
        &self,
        system_at: impl Fn(f64) -> Result<Arc<dyn System>, SystemError>,
        value: f64,
    ) -> Result<Vec<Vec<f64>>, MethodError> {
        let step = STEP * value.abs().max(LEAST);
        let problem = &self.source.problem;
        let mut sum = vec![0.0; problem.space().n_cells()];
        for (steps, weight) in [(2.0, -1.0), (1.0, 8.0), (-1.0, -8.0), (-2.0, 1.0)] {
            let system = system_at(value + steps * step)?;
            let found = masses(self.source, system.as_ref()).ok_or(MethodError::NoSensitivity)?;
            for (slot, mass) in sum.iter_mut().zip(found.masses) {
                *slot += weight / (12.0 * step) * mass;
            }
        }
        self.source.maps(self.value)?.changes(problem, &sum)
    }
}
