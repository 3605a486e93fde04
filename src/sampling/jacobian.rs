//! Local time scales of the drift from its Jacobian, and of a noise whose amplitude depends on what it drives.

use nalgebra::{Complex, DMatrix, DVector, Schur};

use super::integrator::Position;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

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
fn rates_of_lengths(
    system: &dyn System,
    width: &dyn Fn(usize) -> f64,
    state: &[f64],
    positions: &[Position],
) -> Option<LocalRates> {
    let lanes = |value: f64| [value; LANES];
    let states: Vec<Lanes> = state.iter().copied().map(lanes).collect();
    let lengths: Vec<Lanes> = (0..state.len()).map(|axis| lanes(width(axis))).collect();
    let around = Around::new(system, &states, &lengths);
    around.rates(0, positions)
}

/// What differences over a thousandth of a length of each axis say of the states of a batch.
pub(super) struct Around {
    /// `slopes[axis][row]`: derivatives of the drift along `row` by the coordinate along `axis`.
    slopes: Vec<Vec<Lanes>>,
    /// Largest 4 b'² over the noises.
    kicks: Lanes,
    /// Whether a state is next to a switching surface.
    beside_surface: [bool; LANES],
}

impl Around {
    /// Of states with a length along each axis, `[axis][lane]` both.
    pub(super) fn new(system: &dyn System, states: &[Lanes], lengths: &[Lanes]) -> Self {
        let mut beside_surface = [false; LANES];
        for surface in &system.facts().switching_surfaces {
            let (at, length) = (&states[surface.axis], &lengths[surface.axis]);
            for (lane, beside) in beside_surface.iter_mut().enumerate() {
                *beside |= (at[lane] - surface.at).abs() <= 2.0 * SHARE * length[lane];
            }
        }
        let mut states = states.to_vec();
        let slopes = (0..states.len()).map(|axis| {
            let mut drift = [
                vec![[0.0; LANES]; states.len()],
                vec![[0.0; LANES]; states.len()],
            ];
            moved(&mut states, axis, &lengths[axis], |side, states| {
                system.drift(0.0, states, &mut drift[side]);
            });
            let [up, down] = drift;
            let rows = up.into_iter().zip(down);
            rows.map(|(up, down)| slope(&up, &down, &lengths[axis]))
                .collect()
        });
        let slopes = slopes.collect();
        let mut kicks = [0.0_f64; LANES];
        for noise in system
            .noises()
            .iter()
            .filter(|noise| noise.additive().is_none())
        {
            let mut amplitudes = [[0.0; LANES]; 2];
            moved(
                &mut states,
                noise.axis,
                &lengths[noise.axis],
                |side, states| {
                    amplitudes[side] = noise.amplitudes(0.0, states);
                },
            );
            let [up, down] = &amplitudes;
            for (kicks, slope) in kicks.iter_mut().zip(slope(up, down, &lengths[noise.axis])) {
                let rate = KICKS * slope * slope;
                if rate.is_finite() {
                    *kicks = kicks.max(rate);
                }
            }
        }
        Self {
            slopes,
            kicks,
            beside_surface,
        }
    }

    /// Rates of one of the states; `None` next to a switching surface, and where the drift is not finite.
    pub(super) fn rates(&self, lane: usize, positions: &[Position]) -> Option<LocalRates> {
        let dimension = self.slopes.len();
        let entry = |row: usize, axis: usize| self.slopes[axis][row][lane];
        let jacobian = DMatrix::from_fn(dimension, dimension, entry);
        if self.beside_surface[lane] || !jacobian.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let is_position = |axis: &usize| positions.iter().any(|one| one.axis == *axis);
        let rest: Vec<usize> = (0..dimension).filter(|axis| !is_position(axis)).collect();
        let of_rest = jacobian.select_rows(&rest).select_columns(&rest);
        let of = |matrix| Some(Schur::try_new(matrix, 1e-12, 1000)?.complex_eigenvalues());
        let largest =
            |of: &DVector<Complex<f64>>| of.iter().map(|one| one.norm()).fold(0.0, f64::max);
        let kicks = self.kicks[lane];
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
}

/// Looks at the states moved up along an axis by a share of a length, then at them moved down.
fn moved(
    states: &mut [Lanes],
    axis: usize,
    lengths: &Lanes,
    mut look: impl FnMut(usize, &[Lanes]),
) {
    let own = states[axis];
    for (side, sign) in [1.0, -1.0].into_iter().enumerate() {
        for (lane, moved) in states[axis].iter_mut().enumerate() {
            *moved = own[lane] + sign * (SHARE * lengths[lane]);
        }
        look(side, states);
    }
    states[axis] = own;
}

/// Slopes from values at states that were moved up and down.
fn slope(up: &Lanes, down: &Lanes, lengths: &Lanes) -> Lanes {
    std::array::from_fn(|lane| (up[lane] - down[lane]) / (2.0 * (SHARE * lengths[lane])))
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
