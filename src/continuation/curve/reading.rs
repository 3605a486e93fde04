//! The indicator at a place of the plane, and how it changes with both parameters.
//!
//! Where the solved point knows how its densities answer to parameters, the indicator's derivative is the indicator of
//! the density moved a little along dp/dθ, and of what the equations imply at its kinks: exact to the digits of dp/dθ.
//! Elsewhere two more solves beside the place give it by differences.

use super::{CurveWork, Plane, Task, companion};
use crate::continuation::doubt::Evidence;
use crate::continuation::measure::NUMERICAL_DIFFUSION;
use crate::continuation::{
    DensitySource, Doubt, ErrorParts, PointStatus, Sensitivity, Session, SourceError,
};
use crate::density::{Density, EstimatedDensity};
use crate::topology::{Detector, Indicator, IndicatorKind};

/// Largest change of a density, as a share of its maximum, by which an indicator is differentiated: the error is this
/// squared.
const SHARE: f64 = 1e-5;
/// Distance of the places beside, where derivatives come from differences; sides of the box have length one.
const BESIDE: f64 = 5e-3;
/// The same for sampled densities, whose differences are uncertain by the sampling error over this distance.
const BESIDE_SAMPLED: f64 = 0.05;

/// What is read at a place. Places and derivatives are those of the box with sides of length one.
#[derive(Debug, Clone)]
pub(super) struct Reading {
    /// The path's coordinate.
    pub(super) coordinate: f64,
    pub(super) at: [f64; 2],
    pub(super) indicator: Indicator,
    pub(super) gradient: [f64; 2],
    pub(super) solver_error: f64,
    /// Mass in the outermost cells, the largest over the axes.
    pub(super) edge_mass: f64,
    pub(super) status: PointStatus,
    /// What the solve says against the shape of the density: too few modes, or a kink inside cells.
    pub(super) blurs: Vec<Doubt>,
    /// Whether cells add diffusion of their own.
    pub(super) is_diffused: bool,
    pub(super) density: Density,
    /// Values of the indicator's companions, in their order, as far as they are known.
    pub(super) companions: Vec<Option<f64>>,
    /// Where the slope of the density jumps, if it has one axis.
    pub(super) kinks: Vec<f64>,
    /// The centre of symmetry of the density, where it has one.
    pub(super) centre: Option<Vec<f64>>,
    /// How far from the place the derivatives were read.
    pub(super) doubt: f64,
}

impl Reading {
    /// Length of the gradient.
    pub(super) fn steepness(&self) -> f64 {
        self.gradient[0].hypot(self.gradient[1])
    }

    /// The direction in which the indicator rises fastest.
    pub(super) fn uphill(&self) -> [f64; 2] {
        self.gradient.map(|part| part / self.steepness())
    }

    /// The direction of the curve through the place, one of the two.
    pub(super) fn tangent(&self) -> [f64; 2] {
        let [x, y] = self.uphill();
        [-y, x]
    }

    /// What speaks against the density that it was read from.
    pub(super) fn against(&self, depends_on_cells: bool) -> Vec<Doubt> {
        let negative = Doubt::of_negative(&self.density).filter(|_| depends_on_cells);
        let solve = Doubt::of_status(self.status, None).into_iter();
        solve
            .chain(negative)
            .chain(self.blurs.iter().cloned())
            .collect()
    }

    /// The doubts about a point of a curve that is read here, by what a check says against it, why none was made, and
    /// what speaks against the densities.
    pub(super) fn doubts(
        &self,
        task: &Task<'_>,
        (check, unchecked): (Option<Doubt>, Option<Doubt>),
        densities: Vec<Doubt>,
        parts: ErrorParts,
    ) -> Vec<Doubt> {
        let evidence = Evidence {
            check,
            densities,
            unchecked,
            cell_check: task.source.subject().cell_check,
            refined: 1,
            is_diffused: self.is_diffused,
            parts,
            width: 0.0,
            tolerance: task.options.tolerance,
            density: &self.density,
            is_noisy: self.indicator.sampling_error > 0.0,
            wider: None,
        };
        evidence.doubts()
    }

    /// How far uphill the curve is, by the gradient.
    pub(super) fn distance(&self) -> f64 {
        -self.indicator.value / self.steepness()
    }

    /// Where the curve is, by the gradient.
    pub(super) fn foot(&self) -> [f64; 2] {
        let (uphill, distance) = (self.uphill(), self.distance());
        [0, 1].map(|k| self.at[k] + distance * uphill[k])
    }
}

/// Why nothing was read.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum NoReading {
    /// There is no density, for this reason.
    Density(String),
    /// The density has no such indicator.
    Indicator,
    /// The density has no centre of symmetry, at which the indicator would be.
    Symmetry,
    /// The source was asked to stop.
    Interrupted,
}

/// A session with what is to be read in it.
pub(super) struct Reader<'a> {
    pub(super) session: Box<dyn Session>,
    pub(super) plane: &'a Plane,
    pub(super) detector: &'a dyn Detector,
    pub(super) observable: usize,
    pub(super) kind: IndicatorKind,
    pub(super) work: CurveWork,
}

impl<'a> Task<'a> {
    /// Reads an indicator in a new session of a source, which may be that of a check.
    pub(super) fn reader(&self, source: &dyn DensitySource, kind: IndicatorKind) -> Reader<'a> {
        Reader {
            session: source.open(self.cancellation),
            plane: self.plane,
            detector: self.detector,
            observable: self.start.observable,
            kind,
            work: CurveWork::default(),
        }
    }
}

impl Reader<'_> {
    /// Reads at a place, the indicator nearest to `near`, with its derivatives.
    pub(super) fn read(&mut self, at: [f64; 2], near: &[f64]) -> Result<Reading, NoReading> {
        let coordinate = self.plane.lay(at);
        let mut reading = self.solve(coordinate, at, near, true)?;
        if reading.gradient.iter().any(|part| part.is_nan()) {
            let is_sampled = reading.indicator.sampling_error > 0.0;
            reading.doubt = if is_sampled { BESIDE_SAMPLED } else { BESIDE };
            reading.gradient = self.differences(&reading)?;
        }
        Ok(reading)
    }

    /// Reads at a coordinate of what is laid already, without derivatives.
    pub(super) fn value(&mut self, coordinate: f64, near: &[f64]) -> Result<f64, NoReading> {
        let reading = self.solve(coordinate, [f64::NAN; 2], near, false)?;
        Ok(reading.indicator.value)
    }

    /// Solves and reads; the derivatives are NaN where the source knows none, or none are wanted.
    fn solve(
        &mut self,
        coordinate: f64,
        at: [f64; 2],
        near: &[f64],
        with_gradient: bool,
    ) -> Result<Reading, NoReading> {
        let mut solution = self.session.solve(coordinate).map_err(missing)?;
        let report = &solution.report;
        self.work.count(report);
        if !report.status.is_resolved() {
            return Err(NoReading::Density(report.status.word().to_owned()));
        }
        // Derivatives are those of what cells show, and so must values be.
        if let Some(density) = solution.densities.get_mut(self.observable) {
            density.structure.profile = None;
        }
        let density = solution.densities.get(self.observable);
        let density = density.ok_or_else(|| NoReading::Density("no density".to_owned()))?;
        let indicator = self.detector.indicator(density, self.kind, near);
        let has_centre = density.structure.centre.is_some() || !self.kind.traits().is_at_centre;
        let indicator = indicator.ok_or(if has_centre {
            NoReading::Indicator
        } else {
            NoReading::Symmetry
        })?;
        let mut gradient = [f64::NAN; 2];
        if let Some(sensitivity) = solution.sensitivity.as_mut().filter(|_| with_gradient) {
            for (part, side) in gradient.iter_mut().zip(self.plane.sides()) {
                let watched = (self.observable, density);
                let asked = sensitivity.as_mut();
                let along = along(self.detector, watched, &indicator, asked, &side.parameter);
                *part = match along {
                    Ok(along) => along.map_or(f64::NAN, |along| along * side.length()),
                    Err(SourceError::Interrupted) => return Err(NoReading::Interrupted),
                    // At an end of a parameter's range; differences go inward.
                    Err(SourceError::Method(_)) => break,
                };
            }
        }
        let kinks = density.structure.kinks.iter();
        let kinks = kinks.filter(|kink| !kink.is_bend() && density.density.axes.len() == 1);
        Ok(Reading {
            coordinate,
            at,
            gradient,
            solver_error: report.solver_error,
            edge_mass: report.edge_mass().unwrap_or(0.0),
            status: report.status,
            blurs: report
                .findings
                .iter()
                .filter_map(Doubt::of_finding)
                .collect(),
            is_diffused: report.all(&NUMERICAL_DIFFUSION).next().is_some(),
            companions: companion::values(self.detector, density, self.kind, &indicator.place),
            kinks: kinks.map(|kink| kink.at).collect(),
            centre: density.structure.centre.clone(),
            density: density.density.clone(),
            indicator,
            doubt: 0.0,
        })
    }

    /// Derivatives by two places beside, on the side of the middle of the box.
    fn differences(&mut self, reading: &Reading) -> Result<[f64; 2], NoReading> {
        let mut gradient = [0.0; 2];
        for (k, part) in gradient.iter_mut().enumerate() {
            let toward_the_middle = if reading.at[k] < 0.5 { 1.0 } else { -1.0 };
            let step = toward_the_middle * reading.doubt;
            let mut at = reading.at;
            at[k] += step;
            let coordinate = self.plane.lay(at);
            let value = self.value(coordinate, &reading.indicator.place)?;
            *part = (value - reading.indicator.value) / step;
        }
        Ok(gradient)
    }
}

fn missing(error: SourceError) -> NoReading {
    match error {
        SourceError::Interrupted => NoReading::Interrupted,
        SourceError::Method(error) => NoReading::Density(error.to_string()),
    }
}

/// Derivative of the indicator of a watched density by a parameter; `None` where the source cannot tell.
fn along(
    detector: &dyn Detector,
    (observable, density): (usize, &EstimatedDensity),
    indicator: &Indicator,
    sensitivity: &mut dyn Sensitivity,
    parameter: &str,
) -> Result<Option<f64>, SourceError> {
    if indicator.kind.traits().is_exact {
        let jumps = sensitivity.jumps_to_parameter(parameter)?;
        let jumps = jumps.get(observable);
        return Ok(jumps.and_then(|jumps| by_jumps(detector, density, indicator, jumps)));
    }
    let changes = sensitivity.to_parameter(parameter)?;
    let change = changes.get(observable).map_or(&[][..], Vec::as_slice);
    let (kind, place) = (indicator.kind, &indicator.place);
    Ok(derivative(detector, density, kind, place, change))
}

/// Derivative of an indicator when its density changes at this rate.
fn derivative(
    detector: &dyn Detector,
    estimated: &EstimatedDensity,
    kind: IndicatorKind,
    place: &[f64],
    rate: &[f64],
) -> Option<f64> {
    let values = &estimated.density.values;
    let fastest = rate.iter().fold(0.0_f64, |max, rate| max.max(rate.abs()));
    if rate.len() != values.len() || !fastest.is_finite() {
        return None;
    }
    if fastest == 0.0 {
        return Some(0.0);
    }
    let step = SHARE * estimated.density.maximum() / fastest;
    let moved = |step: f64| {
        let mut moved = estimated.clone();
        let pairs = moved.density.values.iter_mut().zip(rate);
        pairs.for_each(|(value, rate)| *value += step * rate);
        let indicator = detector.indicator(&moved, kind, place)?;
        Some(indicator.value)
    };
    Some((moved(step)? - moved(-step)?) / (2.0 * step))
}

/// Derivative of an indicator that follows from the jumps at kinks, when these change at the given rates, one after the
/// other.
fn by_jumps(
    detector: &dyn Detector,
    estimated: &EstimatedDensity,
    indicator: &Indicator,
    rates: &[f64],
) -> Option<f64> {
    let kinks = &estimated.structure.kinks;
    let count: usize = kinks.iter().map(|kink| kink.jump.len()).sum();
    if count != rates.len() || rates.iter().any(|rate| !rate.is_finite()) {
        return None;
    }
    let mut moved = estimated.clone();
    let jumps = moved.structure.kinks.iter_mut();
    let jumps = jumps.flat_map(|kink| &mut kink.jump);
    // It is linear in them.
    jumps.zip(rates).for_each(|(jump, rate)| *jump += rate);
    let there = detector.indicator(&moved, indicator.kind, &indicator.place)?;
    Some(there.value - indicator.value)
}
