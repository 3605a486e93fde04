//! Local time scales of the drift from its Jacobian, and of a noise whose amplitude depends on what it drives.

use nalgebra::{Complex, DMatrix, DVector, Schur};

use super::integrator::Position;
use crate::space::CellSpace;
use crate::system::System;

/// Share of a cell's width that a coordinate is moved by for a difference quotient.
const SHARE: f64 = 1e-3;

/// A kick of a noise with amplitude b changes b itself by b'√dt of its size. Counted as a rate so many times b'², it
/// stays below a sixth at a tenth of the time scale: walls at which the noise vanishes are then not jumped over.
const KICKS: f64 = 4.0;

/// What the eigenvalues λ of the drift's Jacobian at a state say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalRates {
    /// Largest |λ|, or four times the square of a noise amplitude's derivative along the axis that it drives, where
    /// that is larger.
    pub(super) fastest: f64,
    /// Damping -2 Re λ of the energy of the fastest oscillating pair; `None` where nothing oscillates.
    pub(super) damping: Option<f64>,
    /// The largest of half of |λ|, of |λ| where positions stand, and of what noises say: what limits the step of an
    /// integrator that moves positions apart. As `fastest` where there are no positions.
    pub(super) split: f64,
}

/// Length of a step that moves positions apart over that of Heun's, where nothing but the motion of positions limits
/// it.
const LONGER: f64 = 2.0;

/// Rates at a state in Ω; `None` next to a switching surface, outside Ω, and where the drift is not finite.
pub(super) fn local_rates(
    system: &dyn System,
    space: &CellSpace,
    state: &[f64],
    positions: &[Position],
) -> Option<LocalRates> {
    let cell = space.find(state)?;
    let width = |axis: usize| space.axes()[axis].width(space.position(cell, axis));
    rates_of_lengths(system, &width, state, positions)
}

/// Rates at a state, from differences over a thousandth of a length of each axis; `None` next to a switching surface,
/// and where the drift is not finite.
pub(super) fn rates_of_lengths(
    system: &dyn System,
    width: &dyn Fn(usize) -> f64,
    state: &[f64],
    positions: &[Position],
) -> Option<LocalRates> {
    let dimension = state.len();
    for surface in &system.facts().switching_surfaces {
        if (state[surface.axis] - surface.at).abs() <= 2.0 * SHARE * width(surface.axis) {
            return None;
        }
    }
    let mut jacobian = DMatrix::zeros(dimension, dimension);
    for axis in 0..dimension {
        let step = SHARE * width(axis);
        let at = |by: f64| {
            let mut state = state.to_vec();
            state[axis] += by;
            system.drift_at(0.0, &state)
        };
        let (up, down) = (at(step), at(-step));
        for row in 0..dimension {
            jacobian[(row, axis)] = (up[row] - down[row]) / (2.0 * step);
        }
    }
    if !jacobian.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let is_position = |axis: &usize| positions.iter().any(|one| one.axis == *axis);
    let rest: Vec<usize> = (0..dimension).filter(|axis| !is_position(axis)).collect();
    let of_rest = jacobian.select_rows(&rest).select_columns(&rest);
    let of = |matrix| Some(Schur::try_new(matrix, 1e-12, 1000)?.complex_eigenvalues());
    let largest = |of: &DVector<Complex<f64>>| of.iter().map(|one| one.norm()).fold(0.0, f64::max);
    let kicks = noise_rate(system, state, width);
    let eigenvalues = of(jacobian)?;
    let fastest = largest(&eigenvalues).max(kicks);
    let split = match positions.is_empty() {
        true => fastest,
        false => (largest(&eigenvalues) / LONGER)
            .max(largest(&of(of_rest)?))
            .max(kicks),
    };
    let oscillating = eigenvalues.iter().filter(|value| value.im > 0.0);
    let pair = oscillating.max_by(|a, b| a.im.total_cmp(&b.im));
    Some(LocalRates {
        fastest,
        damping: pair.map(|value| -2.0 * value.re),
        split,
    })
}

/// Largest 4 b'² over the noises.
fn noise_rate(system: &dyn System, state: &[f64], width: &dyn Fn(usize) -> f64) -> f64 {
    let rates = system.noises().iter().map(|noise| {
        if noise.additive().is_some() {
            return 0.0;
        }
        let step = SHARE * width(noise.axis);
        let at = |by: f64| {
            let mut state = state.to_vec();
            state[noise.axis] += by;
            noise.at(0.0, &state)
        };
        let slope = (at(step) - at(-step)) / (2.0 * step);
        KICKS * slope * slope
    });
    rates.filter(|rate| rate.is_finite()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::integrator::positions;
    use crate::space::Axis;
    use crate::system::test_families::built_in;
    use crate::system::{Interpretation, TypedModel};

    #[test]
    fn rates_of_a_duffing_oscillator_are_those_of_its_linearisation() {
        let values = [
            ("alpha", 2.0),
            ("mu", 0.5),
            ("kappa", 0.1),
            ("f_c", 0.3),
            ("sigma2", 0.1),
        ];
        let system = built_in("coulomb", &values);
        let axis = Axis::uniform(-2.0, 2.0, 40).unwrap();
        let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
        // ω² = α + 3μx² = 3.5 at x = 1; the damping of the energy is κ.
        let rates = local_rates(&*system, &space, &[1.0, 0.5], &positions(&*system)).unwrap();
        assert!((rates.fastest - f64::sqrt(3.5)).abs() < 1e-6, "{rates:?}");
        assert!((rates.damping.unwrap() - 0.1).abs() < 1e-8, "{rates:?}");
        // Half of it where the displacement moves apart, since the damping alone is slower than that.
        assert!(
            (rates.split - 0.5 * rates.fastest).abs() < 1e-9,
            "{rates:?}"
        );
        assert_eq!(local_rates(&*system, &space, &[1.0, 1e-5], &[]), None);
        assert_eq!(local_rates(&*system, &space, &[3.0, 1.0], &[]), None);
    }

    #[test]
    fn a_noise_that_depends_on_what_it_drives_has_a_rate() {
        let model = TypedModel::new("genetic", "Two alleles", ["x"])
            .with_equation("x", "0.5 - x")
            .with_noise("x", ["2 x (1 - x)"])
            .with_interpretation(Interpretation::Ito)
            .build()
            .unwrap();
        let system = model.system_with(&[]).unwrap();
        let space = CellSpace::new(vec![Axis::uniform(0.0, 1.0, 50).unwrap()]).unwrap();
        // b' = 2 (1 - 2x): 1.6 at 0.1, and nothing in the middle, where only the drift is left.
        for (x, fastest) in [(0.1, 4.0 * 1.6 * 1.6), (0.5, 1.0)] {
            let rates = local_rates(&*system, &space, &[x], &[]).unwrap();
            assert!((rates.fastest - fastest).abs() < 1e-6, "{rates:?}");
        }
    }

    #[test]
    fn nothing_oscillates_in_one_dimension() {
        let values = [("a", 1.0), ("sigma2", 0.1)];
        let system = built_in("bistable", &values);
        let space = CellSpace::new(vec![Axis::uniform(-2.0, 2.0, 40).unwrap()]).unwrap();
        let rates = local_rates(&*system, &space, &[1.0], &[]).unwrap();
        assert!((rates.fastest - 2.0).abs() < 1e-6, "{rates:?}");
        assert_eq!(rates.damping, None);
    }
}
