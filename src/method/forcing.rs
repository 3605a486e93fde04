//! How states answer to a periodic forcing: the amplitude with which the mean of a state moves at the forcing's
//! frequency, 2 |⟨x⟩₁| with ⟨x⟩₁ the average of the mean times e^{-2πis} over the phase s; and its square over that
//! of the forcing, the spectral amplification of stochastic resonance (P. Jung and P. Hänggi, *Phys. Rev. A* 44,
//! 8032, 1991). The forcing's amplitude is that of the first harmonic of the drift, where it is the same everywhere
//! and on one axis only.
//!
//! Each method says with what error it knows the first of them.

use nalgebra::Complex;

use crate::continuation::Measure;
use crate::continuation::measure::{AMPLIFICATION, AMPLITUDE};
use crate::density::layout_axis;
use crate::method::lattice::for_all_nodes;
use crate::method::{MOST_PHASES, MethodError, Problem};
use crate::space::{Axis, CellSpace};
use crate::system::{Family, System};

/// Distance of a phase from a part of the period that is rounding, in parts.
const SAME_PHASE: f64 = 1e-9;

/// The problem on even cells over all that closes on itself: along the phase of a forcing so many at least, each for
/// the phase at its beginning, along an angle those that densities are laid out on. Other axes keep what they have.
///
/// # Errors
/// [`MethodError::Phases`].
pub(super) fn on_even_turns(
    problem: &Problem,
    fewest_phases: usize,
) -> Result<Problem, MethodError> {
    let space = problem.space();
    if !space.axes().iter().any(Axis::is_closed) {
        return Ok(problem.clone());
    }
    let phase = problem.family().model().phase_axis();
    let axes = space.axes().iter().enumerate();
    let axes = axes.map(|(index, axis)| match phase == Some(index) {
        true => {
            let parts = parts_of_period(problem, fewest_phases)?;
            Ok(Axis::turn(axis.from(), axis.to(), parts)?)
        }
        false => Ok(layout_axis(axis)),
    });
    let axes: Result<Vec<Axis>, MethodError> = axes.collect();
    problem.on(CellSpace::new(axes?)?)
}

/// Even parts of the period among which all phases are that are watched: a multiple of the fewest, and so many at
/// least.
///
/// # Errors
/// [`MethodError::Phases`].
fn parts_of_period(problem: &Problem, least: usize) -> Result<usize, MethodError> {
    let quantities = problem.family().quantities().iter();
    let phases: Vec<f64> = quantities
        .filter_map(|quantity| Some(quantity.phase()?.phase))
        .collect();
    let fits = |parts: &usize| {
        let off = |phase: &f64| {
            let place = phase * *parts as f64;
            (place - place.round()).abs()
        };
        phases.iter().all(|phase| off(phase) <= SAME_PHASE)
    };
    let fewest = (1..=MOST_PHASES).find(fits).ok_or(MethodError::Phases)?;
    Ok(least.next_multiple_of(fewest))
}

/// Difference between first harmonics of the drift, over the largest, that is rounding.
const ROUNDING: f64 = 1e-9;

/// A forced system on its cells.
pub(super) struct Forced<'a> {
    pub(super) system: &'a dyn System,
    pub(super) space: &'a CellSpace,
    /// The axis of the phase.
    pub(super) phase: usize,
}

impl Forced<'_> {
    /// Amplitude and spectral amplification of all states of a family that are no angles, from the amplitude of the
    /// mean along each axis with its error.
    pub(super) fn measures(
        &self,
        family: &Family,
        amplitude: impl Fn(usize) -> (f64, f64),
    ) -> Vec<Measure> {
        let forcing = self
            .forcing_amplitude()
            .filter(|amplitude| *amplitude > 0.0);
        let mut found = Vec::new();
        for (axis, name) in family.states_on_lines() {
            let (amplitude, error) = amplitude(axis);
            found.push(Measure {
                error: Some(error),
                ..AMPLITUDE.measure(name, amplitude)
            });
            found.extend(forcing.map(|forcing| Measure {
                error: Some((2.0 * amplitude + error) * error / forcing.powi(2)),
                ..AMPLIFICATION.measure(name, (amplitude / forcing).powi(2))
            }));
        }
        found
    }

    /// Amplitude with which the mean along an axis moves at a multiple k of the forcing's frequency, from the masses of
    /// all cells: 2 |Σ u x e^{-2πiks}|.
    pub(super) fn amplitude(&self, axis: usize, k: usize, masses: &[f64]) -> f64 {
        2.0 * self.harmonic(axis, k, masses).norm()
    }

    /// Σ u x e^{-2πiks} over all nodes.
    fn harmonic(&self, axis: usize, k: usize, unknowns: &[f64]) -> Complex<f64> {
        let nodes = self.space.axes()[axis].nodes();
        let waves = self.waves(k);
        let cells = unknowns.iter().enumerate();
        let terms = cells.map(|(cell, u)| {
            let position = |axis| self.space.position(cell, axis);
            waves[position(self.phase)] * (nodes[position(axis)] * u)
        });
        terms.sum()
    }

    /// x cos 2πs and x sin 2πs at all nodes: the means of both are halves of the parts of the first amplitude.
    pub(super) fn quadratures(&self, axis: usize) -> [Vec<f64>; 2] {
        let nodes = self.space.axes()[axis].nodes();
        let waves = self.waves(1);
        let of = |part: fn(&Complex<f64>) -> f64| {
            let cells = 0..self.space.n_cells();
            let values = cells.map(|cell| {
                let position = |axis| self.space.position(cell, axis);
                nodes[position(axis)] * part(&waves[position(self.phase)])
            });
            values.collect()
        };
        [of(|wave| wave.re), of(|wave| wave.im)]
    }

    /// e^{-2πiks} at the nodes of the phase.
    fn waves(&self, k: usize) -> Vec<Complex<f64>> {
        let nodes = self.space.axes()[self.phase].nodes().iter();
        let turned = nodes.map(|s| Complex::from_polar(1.0, -std::f64::consts::TAU * k as f64 * s));
        turned.collect()
    }

    /// Amplitude of the forcing, where it is added to the drift of one axis alone, the same everywhere.
    fn forcing_amplitude(&self) -> Option<f64> {
        let mut amplitudes = (0..self.space.dimension())
            .filter(|&axis| axis != self.phase)
            .map(|axis| self.forcing_of(axis))
            .collect::<Option<Vec<f64>>>()?;
        amplitudes.retain(|amplitude| *amplitude > 0.0);
        match amplitudes[..] {
            [amplitude] => Some(amplitude),
            _ => None,
        }
    }

    /// Amplitude of the first harmonic of the drift of an axis; `None` where it is not the same everywhere.
    fn forcing_of(&self, axis: usize) -> Option<f64> {
        let (waves, count) = (self.waves(1), self.space.axes()[self.phase].count());
        let stride: usize = self.space.shape()[self.phase + 1..].iter().product();
        let cells = self.space.n_cells();
        let mut harmonics = vec![Complex::new(0.0, 0.0); cells / count];
        let mut all = vec![[0.0; crate::system::LANES]; self.space.dimension()];
        let mut fastest = 0.0_f64;
        for_all_nodes(self.space, |first, states| {
            self.system.drift(0.0, states, &mut all);
            let drifts = all[axis].iter().enumerate().take(cells - first);
            for (lane, drift) in drifts {
                let cell = first + lane;
                let place = cell / (stride * count) * stride + cell % stride;
                harmonics[place] += waves[cell / stride % count] * *drift * (2.0 / count as f64);
                fastest = fastest.max(drift.abs());
            }
        });
        let one = harmonics[0];
        let mut all = harmonics.iter();
        let is_same = all.all(|other| (other - one).norm() <= ROUNDING * fastest);
        let is_nothing = one.norm() <= ROUNDING * fastest;
        is_same.then(|| if is_nothing { 0.0 } else { one.norm() })
    }
}
