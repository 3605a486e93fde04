//! Small deviations from the paths of a system: how they stretch, and the angle in which they point as one axis more.
//!
//! A small deviation v from a path X obeys dv = A v dt + Σ B_k v dW_k in Itô's sense, A and B_k the derivatives of the
//! Itô drift and of the noise that moves X as well, at X. A noise is on one axis a: B_k v = e_a (∇b_k·v). With s = (cos
//! φ, sin φ) and n = (-sin φ, cos φ) the angle of v obeys
//!
//! ```text
//! dφ = [n·A s - Σ s_a n_a (∇b_k·s)²] dt + Σ n_a (∇b_k·s) dW_k
//! d ln|v| = {s·A s + ½ Σ (n_a² - s_a²) (∇b_k·s)²} dt + Σ s_a (∇b_k·s) dW_k
//! ```
//!
//! The mean of the braces over the stationary density of X and φ is the largest Lyapunov exponent (Furstenberg and
//! Khasminskii). Exponents do not depend on the units of the axes: deviations are taken in units in which they are of
//! one size, so that the angle turns evenly.
//!
//! Source: L. Arnold, *Random Dynamical Systems*, Springer 1998, section 6.2.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use super::linear::Linearised;
use super::{Facts, LANES, Lanes, Noise, System};
use crate::formula::tape::Tape;

/// One turn of the angle: deviations v and -v are the same.
pub(crate) const HALF_TURN: (f64, f64) = (-FRAC_PI_2, FRAC_PI_2);

/// Why there is no equation of small deviations.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(crate) enum TangentFault {
    /// Modes give exponents along densities on one axis and on two.
    #[error(
        "the system has {axes} axes; modes give exponents along a density on one axis and on two"
    )]
    Axes {
        /// Axes of the system.
        axes: usize,
    },
    /// Drift or noise has a jump or a kink somewhere, or may have one.
    #[error(
        "drift or noise is not smooth everywhere, so that small deviations obey no linear equation where it is not"
    )]
    Rough,
    /// An angle beside another axis, which modes do not allow.
    #[error("modes give exponents along a density of systems without angles beside other axes")]
    Turns,
    /// A forcing.
    #[error("exponents along a density are worked out of systems without forcing")]
    Forced,
    /// Walls that reflect, which trajectories do not allow.
    #[error("trajectories give exponents of systems without reflecting walls")]
    Walls,
    /// The equations are not known as formulas, or their noise is coloured.
    #[error("exponents along a density are worked out of formulas with white noise")]
    NoFormulas,
    /// The derivatives need more room than formulas have.
    #[error("the derivatives of drift and noise are too large formulas")]
    TooLarge,
}

/// A system with the angle of small deviations from its paths as its last axis.
pub(crate) struct Tangent {
    system: Arc<dyn System>,
    slopes: Arc<DriftDerivatives>,
    /// Those of the system; then, for each whose amplitude depends on the state, what it does to the angle, as a noise
    /// of its own: what both do together is not said here ([`Tangent::shared`]).
    noises: Vec<Noise>,
    /// Axes of the noises with state-dependent amplitudes, with their numbers.
    shared: Vec<(usize, usize)>,
    facts: Facts,
}

/// Derivatives at a state.
struct DriftDerivatives {
    tape: Tape,
    axes: usize,
    /// The axis of each noise.
    noise_axes: Vec<usize>,
    /// `ratios[i · axes + j]`: the unit of deviations on axis j over that on axis i.
    ratios: Vec<f64>,
}

/// Derivatives of a batch: of the drift `a[i · axes + j]`, and of noise k `b[k · axes + j]`.
struct Batch {
    a: Vec<Lanes>,
    b: Vec<Lanes>,
}

impl DriftDerivatives {
    fn run(&self, states: &[Lanes]) -> Batch {
        let mut all = vec![[0.0; LANES]; self.axes * (self.axes + self.noise_axes.len())];
        self.tape.run(f64::NAN, &states[..self.axes], &mut all);
        let rows = (0..self.axes).chain(self.noise_axes.iter().copied());
        for (slopes, row) in all.chunks_exact_mut(self.axes).zip(rows) {
            let ratios = &self.ratios[row * self.axes..][..self.axes];
            for (slope, ratio) in slopes.iter_mut().zip(ratios) {
                slope.iter_mut().for_each(|value| *value *= ratio);
            }
        }
        let b = all.split_off(self.axes * self.axes);
        Batch { a: all, b }
    }

    /// ∇b_k·s and the factors s_a and n_a of a lane.
    fn pull(
        &self,
        batch: &Batch,
        noise: usize,
        lane: usize,
        (sine, cosine): (f64, f64),
    ) -> [f64; 3] {
        let along = batch.b[2 * noise][lane] * cosine + batch.b[2 * noise + 1][lane] * sine;
        match self.noise_axes[noise] {
            0 => [along, cosine, -sine],
            _ => [along, sine, cosine],
        }
    }
}

/// Derivatives of drift and noises at a batch of states.
pub(crate) struct StateSlopes<'a> {
    slopes: &'a DriftDerivatives,
    batch: Batch,
}

impl StateSlopes<'_> {
    /// A v: the rate at which deviations change by the drift, one row an axis.
    pub(crate) fn of_drift(&self, deviations: &[Lanes]) -> Vec<Lanes> {
        let rows = self.batch.a.chunks_exact(self.slopes.axes);
        rows.map(|row| product(row, deviations)).collect()
    }

    /// ∇b_k·v: by how much the amplitude of a noise differs beside its path.
    pub(crate) fn of_noise(&self, number: usize, deviations: &[Lanes]) -> Lanes {
        let axes = self.slopes.axes;
        product(&self.batch.b[number * axes..][..axes], deviations)
    }

    /// The sum of the growth rates along all axes, [`Tangent::diagonal`].
    pub(crate) fn divergence(&self) -> Lanes {
        let axes = self.slopes.axes;
        let mut sum = [0.0; LANES];
        for own in self.batch.a.iter().step_by(axes + 1) {
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        for (number, axis) in self.slopes.noise_axes.iter().enumerate() {
            let own = &self.batch.b[number * axes + axis];
            sum.iter_mut()
                .zip(own)
                .for_each(|(sum, own)| *sum -= 0.5 * own * own);
        }
        sum
    }
}

/// The scalar product of each lane.
fn product(row: &[Lanes], column: &[Lanes]) -> Lanes {
    let mut sum = [0.0; LANES];
    for (one, other) in row.iter().zip(column) {
        for lane in 0..LANES {
            sum[lane] += one[lane] * other[lane];
        }
    }
    sum
}

impl Tangent {
    /// Of a tape that gives the derivatives of the drift by rows, then those of each noise, of which the axes are
    /// given.
    pub(super) fn new(
        system: Arc<dyn System>,
        tape: Tape,
        noise_axes: &[usize],
        scales: &[f64],
    ) -> Self {
        let axes = system.dimension();
        let ratios = (0..axes * axes).map(|at| scales[at % axes] / scales[at / axes]);
        let slopes = Arc::new(DriftDerivatives {
            axes,
            noise_axes: noise_axes.to_vec(),
            ratios: ratios.collect(),
            tape,
        });
        let depends = |&(number, _): &(usize, usize)| {
            let own = (0..axes).map(|by| slopes.tape.constant((axes + number) * axes + by));
            own.into_iter().any(|slope| slope != Some(0.0))
        };
        let all = noise_axes.iter().copied().enumerate();
        let shared: Vec<(usize, usize)> = all.filter(depends).collect();
        let mut noises = system.noises().to_vec();
        for &(number, _) in shared.iter().filter(|_| axes == 2) {
            let slopes = Arc::clone(&slopes);
            noises.push(Noise::of_state(axes, move |_, states, lanes| {
                let batch = slopes.run(states);
                for (lane, out) in lanes.iter_mut().enumerate() {
                    let angle = states[2][lane].sin_cos();
                    let [along, _, across] = slopes.pull(&batch, number, lane, angle);
                    *out = across * along;
                }
            }));
        }
        let mut facts = Facts {
            symmetry: None,
            switching_surfaces: Vec::new(),
            ..system.facts().clone()
        };
        if axes == 2 {
            facts.turns.insert(axes, HALF_TURN);
        }
        Self {
            system,
            slopes,
            noises,
            shared,
            facts,
        }
    }

    /// The linear equation, where it is the same at every state.
    pub(crate) fn linear(&self) -> Option<Linearised> {
        let axes = self.slopes.axes;
        let row = |row: usize| -> Option<Vec<f64>> {
            let own = (0..axes).map(|by| self.slopes.tape.constant(row * axes + by));
            own.collect()
        };
        let drift: Option<Vec<Vec<f64>>> = (0..axes).map(row).collect();
        let noises = self.slopes.noise_axes.iter().enumerate();
        let noises: Option<Vec<Vec<Vec<f64>>>> = noises
            .map(|(number, &axis)| {
                let mut rows = vec![vec![0.0; axes]; axes];
                rows[axis] = row(axes + number)?;
                Some(rows)
            })
            .collect();
        Some(Linearised {
            drift: drift?,
            noises: noises?,
        })
    }

    /// The derivatives at a batch of states, whose last axis may be the angle.
    pub(crate) fn slopes(&self, states: &[Lanes]) -> StateSlopes<'_> {
        StateSlopes {
            batch: self.slopes.run(states),
            slopes: &self.slopes,
        }
    }

    /// Whether deviations along one of two axes never leave it: both exponents are then those of the diagonal.
    pub(crate) fn is_triangular(&self) -> bool {
        let axes = self.slopes.axes;
        let is_zero = |entry: usize| self.slopes.tape.constant(entry) == Some(0.0);
        let never = |row: usize, by: usize| {
            let noises = self.slopes.noise_axes.iter().enumerate();
            let mut own = noises.filter(|(_, axis)| **axis == row);
            is_zero(row * axes + by) && own.all(|(number, _)| is_zero((axes + number) * axes + by))
        };
        axes == 2 && (never(0, 1) || never(1, 0))
    }

    /// Growth rates A_ii - ½ Σ B_k,ii² along each axis of a batch.
    pub(crate) fn diagonal(&self, states: &[Lanes]) -> Vec<Lanes> {
        let (batch, axes) = (self.slopes.run(states), self.slopes.axes);
        let mut rates: Vec<Lanes> = (0..axes).map(|i| batch.a[i * (axes + 1)]).collect();
        for (number, &axis) in self.slopes.noise_axes.iter().enumerate() {
            let own = &batch.b[number * axes + axis];
            let rates = rates[axis].iter_mut().zip(own);
            rates.for_each(|(rate, slope)| *rate -= 0.5 * slope * slope);
        }
        rates
    }

    /// How fast deviations in the direction of the last axis of a batch stretch, in 1/t.
    pub(crate) fn stretching(&self, states: &[Lanes]) -> Lanes {
        let by_drift = |[xx, xy, yx, yy]: [f64; 4], (sine, cosine): (f64, f64)| {
            xx * cosine * cosine + (xy + yx) * sine * cosine + yy * sine * sine
        };
        let by_noise =
            |[pull, along, across]: [f64; 3]| 0.5 * (across * across - along * along) * pull * pull;
        self.rates(states, by_drift, by_noise)
    }

    /// How fast deviations in the direction of the last axis of a batch turn, in 1/t.
    pub(crate) fn turning(&self, states: &[Lanes]) -> Lanes {
        let by_drift = |[xx, xy, yx, yy]: [f64; 4], (sine, cosine): (f64, f64)| {
            yx * cosine * cosine - xy * sine * sine + (yy - xx) * sine * cosine
        };
        let by_noise = |[pull, along, across]: [f64; 3]| -(along * across * pull * pull);
        self.rates(states, by_drift, by_noise)
    }

    /// A rate of deviations in the direction of the last axis of a batch: what the derivatives of the drift make of it,
    /// by rows, with the sine and cosine of the angle, and what each noise adds ([`DriftDerivatives::pull`]).
    fn rates(
        &self,
        states: &[Lanes],
        by_drift: impl Fn([f64; 4], (f64, f64)) -> f64,
        by_noise: impl Fn([f64; 3]) -> f64,
    ) -> Lanes {
        let batch = self.slopes.run(states);
        std::array::from_fn(|lane| {
            let angle = states[2][lane].sin_cos();
            let slopes = [0, 1, 2, 3].map(|entry| batch.a[entry][lane]);
            let noises = self.shared.iter();
            let pulls = noises.map(|&(number, _)| self.slopes.pull(&batch, number, lane, angle));
            pulls
                .map(&by_noise)
                .fold(by_drift(slopes, angle), |rate, part| rate + part)
        })
    }

    /// The noises that move a state and the angle at once: the axis, and the product of both amplitudes.
    pub(crate) fn shared(&self) -> impl Iterator<Item = (usize, impl Fn(&[Lanes]) -> Lanes)> {
        let own = self.system.noises().len();
        self.shared
            .iter()
            .enumerate()
            .map(move |(place, &(number, axis))| {
                let pair = [number, own + place].map(|one| self.noises[one].clone());
                let product = move |states: &[Lanes]| {
                    let [mut both, other] = pair.each_ref().map(|one| one.amplitudes(0.0, states));
                    both.iter_mut()
                        .zip(other)
                        .for_each(|(one, other)| *one *= other);
                    both
                };
                (axis, product)
            })
    }
}

impl System for Tangent {
    fn dimension(&self) -> usize {
        self.slopes.axes + 1
    }

    fn drift(&self, time: f64, states: &[Lanes], drift: &mut [Lanes]) {
        let axes = self.slopes.axes;
        self.system.drift(time, &states[..axes], &mut drift[..axes]);
        drift[axes] = self.turning(states);
    }

    fn noises(&self) -> &[Noise] {
        &self.noises
    }

    fn facts(&self) -> &Facts {
        &self.facts
    }
}
