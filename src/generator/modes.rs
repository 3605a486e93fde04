//! The rates along an axis of modes: a dense block for every place on the other axes.
//!
//! Tested with a polynomial f of degree below N, a drift b along the axis gives
//! d/dt Σ_k u_k f(s_k) = Σ_k u_k b(s_k) f'(s_k), Gauss's rule for the exact ∫ p b f' ds. With f the Lagrange
//! polynomials of the nodes that is the block; by the degree of the rule it is exact for every drift that is a
//! polynomial of degree 2 in s, and spectrally accurate for any smooth one. Walls need no condition: nothing is tested
//! beyond them.
//!
//! White noise behind a linear filter has D f'' more, at the nodes of Hermite polynomials, which are its
//! eigenfunctions: exact. A state without noise that relaxes linearly has the same polynomials without that term: the
//! moments along it then couple downwards only, so those up to the last are exact wherever nothing else depends on it.
//!
//! On an axis that closes on itself f is a trigonometric polynomial, and any noise adds D f''.

use super::GeneratorError;
use crate::space::{Axis, Series};
use crate::system::System;

/// Relative deviation of a filter's drift and noise from those of its normal density that is rounding.
const ROUNDING: f64 = 1e-9;

/// What tests the densities along an axis of modes.
#[derive(Debug, Clone)]
pub(super) struct ModeAxis {
    /// Derivatives of the Lagrange polynomials at the nodes, [`Axis::differentiation`].
    first: Vec<f64>,
    basis: Basis,
}

/// The functions that carry an axis of modes, with what they have beside first derivatives.
#[derive(Debug, Clone)]
enum Basis {
    /// Legendre polynomials: nothing.
    Bounded,
    /// Hermite polynomials: their second derivatives, mean and standard deviation of the normal density.
    Normal(Vec<f64>, f64, f64),
    /// Sines and cosines over the turn between two places: their second derivatives.
    Closed(Vec<f64>, (f64, f64)),
}

impl ModeAxis {
    /// `None` for an axis of cells.
    pub(super) fn new(axis: &Axis) -> Option<Self> {
        let series = axis.series()?;
        let first = axis.differentiation();
        let second = || square(&first, axis.count());
        let basis = match series {
            Series::Legendre => Basis::Bounded,
            Series::Hermite { mean, deviation } => Basis::Normal(second(), mean, deviation),
            Series::Fourier => Basis::Closed(second(), (axis.from(), axis.to())),
        };
        Some(Self { first, basis })
    }

    /// Whether the axis number `axis` of a system, with or without walls at both ends, can have these modes.
    pub(super) fn check(
        &self,
        system: &dyn System,
        axis: usize,
        is_walled: bool,
    ) -> Result<(), GeneratorError> {
        let (is_noisy, facts) = (system.is_noisy(axis), system.facts());
        match &self.basis {
            Basis::Bounded if is_noisy || !is_walled => Err(GeneratorError::Modes { axis }),
            Basis::Bounded => Ok(()),
            Basis::Closed(_, range) if facts.turns.get(&axis) == Some(range) => Ok(()),
            Basis::Closed(..) => Err(GeneratorError::Turn { axis }),
            // However wide the normal density is: more modes make up for it.
            Basis::Normal(..) if !is_noisy && facts.relaxation_rates.contains_key(&axis) => Ok(()),
            Basis::Normal(_, mean, deviation) => {
                let same = |&(m, d): &(f64, f64)| {
                    (m - mean).abs() <= ROUNDING * deviation
                        && (d / deviation - 1.0).abs() <= ROUNDING
                };
                let declared = facts.filtered_noise.get(&axis).is_some_and(same);
                declared
                    .then_some(())
                    .ok_or(GeneratorError::Filter { axis })
            }
        }
    }

    /// Rates of a line, `from · count + to`, from drift and diffusion at the nodes.
    pub(super) fn rates(
        &self,
        axis: usize,
        nodes: &[f64],
        drift: &[f64],
        diffusion: &[f64],
        rates: &mut [f64],
    ) -> Result<(), GeneratorError> {
        block(&self.first, drift, rates);
        let (second, mean, deviation) = match &self.basis {
            Basis::Bounded => return Ok(()),
            Basis::Closed(second, _) => {
                let rows = second.chunks_exact(drift.len()).zip(diffusion);
                let added = rows.flat_map(|(row, noise)| row.iter().map(move |f| noise * f));
                rates
                    .iter_mut()
                    .zip(added)
                    .for_each(|(rate, more)| *rate += more);
                return Ok(());
            }
            Basis::Normal(second, mean, deviation) => (second, mean, deviation),
        };
        // An axis without noise has no diffusion: a state that relaxes at a rate of its own, or one of a filter's.
        let first = diffusion.first().copied().unwrap_or(0.0);
        let length = nodes[nodes.len() - 1] - nodes[0];
        let rate = if first > 0.0 {
            first / deviation.powi(2)
        } else {
            (drift[0] - drift[drift.len() - 1]) / length
        };
        // Other states may add what is the same all along the line.
        let added = drift[0] + rate * (nodes[0] - mean);
        let scale = rate.abs() * length + added.abs();
        let mut along = nodes.iter().zip(drift);
        let linear = along
            .all(|(node, drift)| (drift + rate * (node - mean) - added).abs() <= ROUNDING * scale);
        let mut noises = diffusion.iter();
        let constant = noises.all(|noise| (noise - first).abs() <= ROUNDING * first);
        if rate < -ROUNDING * scale / length || !linear || !constant {
            return Err(GeneratorError::Filter { axis });
        }
        for (rate, second) in rates.iter_mut().zip(second) {
            *rate += first * second;
        }
        Ok(())
    }
}

/// The square of a matrix.
fn square(matrix: &[f64], n: usize) -> Vec<f64> {
    let entry = |row: usize, column: usize| -> f64 {
        (0..n)
            .map(|k| matrix[row * n + k] * matrix[k * n + column])
            .sum()
    };
    (0..n * n).map(|at| entry(at / n, at % n)).collect()
}

/// One entry `from · count + to` a pair of nodes: the rate from the one into the other.
fn block(differentiation: &[f64], drift: &[f64], rates: &mut [f64]) {
    let count = drift.len();
    for (from, &drift) in drift.iter().enumerate() {
        let row = from * count..(from + 1) * count;
        let slopes = &differentiation[row.clone()];
        for (rate, slope) in rates[row].iter_mut().zip(slopes) {
            *rate = drift * slope;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::banded_tests::null_vector;
    use crate::generator::{GeneratorError, GeneratorOptions, assemble, unknown_moments};
    use crate::space::{Axis, CellSpace};
    use crate::system::test_families::built_in;

    /// P_0 … P_{count - 1} at s.
    fn legendre(count: usize, s: f64) -> Vec<f64> {
        let mut values = vec![1.0, s];
        for n in 2..count {
            let n = n as f64;
            let next = ((2.0 * n - 1.0) * s * values[values.len() - 1]
                - (n - 1.0) * values[values.len() - 2])
                / n;
            values.push(next);
        }
        values.truncate(count);
        values
    }

    /// Moments Σ_k u_k P_n(s_k).
    fn moments(axis: &Axis, unknowns: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; axis.count()];
        for (u, &s) in unknowns.iter().zip(axis.nodes()) {
            for (sum, value) in sums.iter_mut().zip(legendre(axis.count(), s)) {
                *sum += u * value;
            }
        }
        sums
    }

    #[test]
    fn rates_of_the_moments_are_the_exact_products() {
        // s' = c - s: P_m' = Σ (2k + 1) P_k over k = m - 1, m - 3, …, and s P_m' = m P_m + Σ (2k + 1) P_k over k = m -
        // 2, m - 4, …
        let c = 0.3;
        for count in [2, 5, 9, 96] {
            // Derivatives of the polynomials grow as the square of their number, and as many are summed.
            let rounding = f64::EPSILON * (count as f64).powi(3).max(5e3);
            let axis = Axis::modes(-1.0, 1.0, count).unwrap();
            let drift: Vec<f64> = axis.nodes().iter().map(|s| c - s).collect();
            let mut rates = vec![0.0; count * count];
            block(&axis.differentiation(), &drift, &mut rates);
            let unknowns: Vec<f64> = (0..count).map(|k| 1.0 + (1.7 * k as f64).sin()).collect();
            let mut change = vec![0.0; count];
            for (from, u) in unknowns.iter().enumerate() {
                for (to, slot) in change.iter_mut().enumerate() {
                    *slot += rates[from * count + to] * u;
                }
            }
            let (a, found) = (moments(&axis, &unknowns), moments(&axis, &change));
            for (m, found) in found.into_iter().enumerate() {
                // Σ (2k + 1) a_k over k = top, top - 2, …
                let sum = |top: Option<usize>| -> f64 {
                    let terms = top.into_iter().flat_map(|top| (0..=top).rev().step_by(2));
                    terms.map(|k| (2 * k + 1) as f64 * a[k]).sum()
                };
                let (odd, even) = (sum(m.checked_sub(1)), sum(m.checked_sub(2)));
                let exact = c * odd - (m as f64 * a[m] + even);
                assert!(
                    (found - exact).abs() < rounding * (1.0 + exact.abs()),
                    "{count} {m}: {found} {exact}"
                );
            }
        }
    }

    const VALUES: [(&str, f64); 6] = [
        ("alpha", 0.5),
        ("kappa", 0.1),
        ("mu", 1.0),
        ("lambda", 0.2),
        ("f_c", 0.1),
        ("sigma2", 0.2),
    ];

    /// Unknowns of Dahl's oscillator.
    fn dahl(cells: usize, modes: usize, sigma2: f64) -> (CellSpace, Vec<f64>) {
        let mut values = VALUES;
        values[5].1 = sigma2;
        let system = built_in("dahl", &values);
        let x = Axis::uniform(-2.4, 2.4, cells).unwrap();
        let y = Axis::uniform(-3.2, 3.2, cells).unwrap();
        let space = CellSpace::new(vec![x, y, Axis::modes(-0.5, 0.5, modes).unwrap()]).unwrap();
        let generator = assemble(&*system, &space, &GeneratorOptions::default()).unwrap();
        let centre = space.find(&[1e-9, 1e-9, 1e-9]).unwrap();
        let unknowns = null_vector(&generator.matrix, centre);
        (space, unknowns)
    }

    /// Mean of a function of velocity and friction state.
    fn mean(space: &CellSpace, unknowns: &[f64], function: impl Fn(f64, f64) -> f64) -> f64 {
        let node = |cell, axis: usize| space.axes()[axis].nodes()[space.position(cell, axis)];
        let cells = unknowns.iter().enumerate();
        cells
            .map(|(cell, u)| u * function(node(cell, 1), node(cell, 2)))
            .sum()
    }

    #[test]
    fn balances_of_the_friction_state_and_of_the_energy_hold() {
        let (space, unknowns) = dahl(26, 4, 0.08);
        // d/dt z²/2 = yz - (λ/f_c)|y| z² is tested by the series itself: but for what leaves Ω it holds.
        let fed = mean(&space, &unknowns, |y, z| y * z);
        let lost = mean(&space, &unknowns, |y, z| 2.0 * y.abs() * z * z);
        assert!((fed - lost).abs() < 1e-4 * lost, "{fed} {lost}");
        // Noise feeds σ²/2; damping and friction take κ y² + λ y z. The cells of x and y decide how well that holds.
        let taken = mean(&space, &unknowns, |y, z| 0.1 * y * y + 0.2 * y * z);
        assert!((taken - 0.04).abs() < 2e-3, "{taken}");
    }

    #[test]
    fn a_few_modes_have_the_digits_of_many() {
        let [three, five, eight] = [3, 5, 8].map(|modes| {
            let (space, unknowns) = dahl(14, modes, 0.2);
            let moments = unknown_moments(&space, &unknowns);
            moments
                .into_iter()
                .map(|moment| moment.1)
                .collect::<Vec<f64>>()
        });
        let off = |few: &[f64]| {
            let pairs = few.iter().zip(&eight);
            pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
        };
        assert!(
            off(&five) < 5e-3 && off(&five) < 0.2 * off(&three),
            "{:e} {:e}",
            off(&three),
            off(&five)
        );
    }

    #[test]
    fn modes_are_for_bounded_states_without_noise() {
        let system = built_in("dahl", &VALUES);
        let refused = |axes: [Axis; 3]| {
            let space = CellSpace::new(axes.to_vec()).unwrap();
            assemble(&*system, &space, &GeneratorOptions::default()).err()
        };
        let cells = || Axis::uniform(-2.0, 2.0, 6).unwrap();
        let modes = |half: f64| Axis::modes(-half, half, 4).unwrap();
        let at = |axis| Some(GeneratorError::Modes { axis });
        assert_eq!(refused([cells(), cells(), modes(0.4)]), at(2));
        assert_eq!(refused([modes(2.0), cells(), modes(0.5)]), at(0));
        assert_eq!(refused([cells(), cells(), modes(0.5)]), None);
    }
}
