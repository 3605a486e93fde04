//! What a time step does to the density, found by halving it: two paths of every trajectory, one with the step and one
//! with half of it, driven by the same Wiener process, so that their difference is that of the steps and hardly that of
//! chance.

use super::Relaxation;
use super::batch::{Purpose, key};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::in_parallel;
use crate::sampling::{Integrator, NormalStream, Stepper};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Batches of trajectories.
const BATCHES: u64 = 4;
/// Autocorrelation times before, and while, the paths are compared.
const SETTLE: f64 = 5.0;
const COMPARE: f64 = 10.0;
/// Most coarse steps of a trajectory.
const MOST_STEPS: f64 = 3e5;
/// Coarse steps between looks; also how many are made at once.
const LOOK: usize = 4;
/// Half the width of the region about a switching surface, in standard deviations of the axis.
const REGION: f64 = 0.1;
/// A path farther than this many standard deviations from the mean counts as being that far: one that runs away must
/// not turn sums into infinities.
const FARTHEST: f64 = 1e3;
/// Shortenings of an automatic step.
const MOST_ROUNDS: usize = 6;
/// Largest bias that is passed over when the sampling error is larger still, or not known.
pub(crate) const TOLERATED_BIAS: f64 = 0.02;

/// A number of the steady state that a time step may shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum BiasedQuantity {
    /// Variance of an axis.
    Variance(usize),
    /// Sum of the variances of all axes, each relative to its own: stands for the mean energy.
    Energy,
    /// Share of the time within a tenth of a standard deviation of a switching surface across this axis.
    SurfaceShare(usize),
}

/// Relative shift of a quantity by the time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StepBias {
    /// What is shifted.
    pub quantity: BiasedQuantity,
    /// (with this step - with infinitely short ones)/(with half the step), extrapolated from the difference of the two
    /// steps by the integrator's weak order.
    pub relative: f64,
    /// Standard error of it from the trajectories of the comparison.
    pub standard_error: f64,
}

impl StepBias {
    /// Magnitude that is certain: less two standard errors, at least 0.
    pub(crate) fn certain(&self) -> f64 {
        (self.relative.abs() - 2.0 * self.standard_error).max(0.0)
    }

    /// The one of two that is more certain to be large; of two that may be nothing, the one that shows more clearly.
    pub(crate) fn worse(self, other: Self) -> Self {
        let clear = |bias: &Self| bias.relative.abs() / bias.standard_error.max(f64::MIN_POSITIVE);
        let by_size = self.certain().total_cmp(&other.certain());
        match by_size.then(clear(&self).total_cmp(&clear(&other))) {
            std::cmp::Ordering::Less => other,
            _ => self,
        }
    }
}

/// The bias of a time step, that of the quantity for which it is most certain to be large. Keyed by `seed`; does not
/// depend on the number of threads. `None` where nothing settled in the relaxation.
///
/// # Errors
/// [`Cancelled`].
pub(crate) fn step_bias(
    system: &dyn System,
    space: &CellSpace,
    relaxation: &Relaxation,
    (integrator, time_step): (Integrator, f64),
    seed: u64,
    cancellation: &Cancellation,
) -> Result<Option<StepBias>, Cancelled> {
    if relaxation.settled.is_empty() || !(time_step > 0.0 && time_step.is_finite()) {
        return Ok(None);
    }
    let steps = (integrator, time_step);
    let comparison = Comparison::new(system, space, relaxation, steps, cancellation);
    let batches = in_parallel(BATCHES as usize, |batch| {
        comparison.batch(seed, batch as u64)
    })?;
    let lanes = batches.concat();
    let additive = (system.noises().iter()).all(|noise| noise.additive().is_some());
    // A path that is put back at a wall is so to first order at best.
    let additive = additive && system.facts().reflecting.is_empty();
    // d(h) - d(h/2) = (1 - 2^-order) × bias of h.
    let extrapolation = match order(integrator, additive) {
        1 => 2.0,
        _ => 4.0 / 3.0,
    };
    let quantities = comparison.quantities.iter().enumerate();
    let biases = quantities.map(|(index, &quantity)| {
        let pairs = || lanes.iter().map(|sums| sums[index]);
        let count = lanes.len() as f64;
        let fine = pairs().map(|[_, fine]| fine).sum::<f64>() / count;
        let shift = pairs().map(|[coarse, fine]| coarse - fine).sum::<f64>() / count;
        let squares = pairs().map(|[coarse, fine]| (coarse - fine - shift).powi(2));
        let error = (squares.sum::<f64>() / (count * (count - 1.0))).sqrt();
        StepBias {
            quantity,
            relative: extrapolation * shift / fine,
            standard_error: extrapolation * error / fine,
        }
    });
    let finite = biases.filter(|bias| bias.relative.is_finite());
    Ok(finite.reduce(StepBias::worse))
}

/// Weak order of an integrator.
fn order(integrator: Integrator, additive: bool) -> u32 {
    match integrator {
        Integrator::EulerMaruyama => 1,
        _ if additive => 2,
        _ => 1,
    }
}

/// A time step whose bias is not certain to be above `wanted` (relative, of variances and shares), with that bias: the
/// pilot's rule, shortened until halving agrees.
///
/// # Errors
/// [`Cancelled`].
pub(crate) fn automatic_step(
    system: &dyn System,
    space: &CellSpace,
    relaxation: &Relaxation,
    (integrator, wanted): (Integrator, f64),
    seed: u64,
    cancellation: &Cancellation,
) -> Result<(f64, Option<StepBias>), Cancelled> {
    let mut time_step = relaxation.time_step(integrator, 0.5 * wanted);
    let bias_of = |step: f64| {
        let step = (integrator, step);
        step_bias(system, space, relaxation, step, seed, cancellation)
    };
    let mut bias = bias_of(time_step)?;
    for _ in 0..MOST_ROUNDS {
        let Some(certain) = bias
            .map(|bias| bias.certain())
            .filter(|&bias| bias > wanted)
        else {
            break;
        };
        let power = f64::from(order(integrator, true));
        time_step *= (0.7 * wanted / certain).powf(1.0 / power).clamp(0.2, 0.8);
        bias = bias_of(time_step)?;
    }
    Ok((time_step, bias))
}

/// Normals of steps from those of steps half as long: ΔW over a step is the sum over its two halves.
pub(super) fn over_two_steps(normals: &[Lanes], channels: usize) -> Vec<Lanes> {
    let mut sums = vec![[0.0; LANES]; normals.len() / 2];
    for (step, rows) in normals.chunks(2 * channels.max(1)).enumerate() {
        for channel in 0..channels {
            let sum = &mut sums[step * channels + channel];
            for (lane, sum) in sum.iter_mut().enumerate() {
                let both = rows[channel][lane] + rows[channels + channel][lane];
                *sum = both * std::f64::consts::FRAC_1_SQRT_2;
            }
        }
    }
    sums
}

/// Both paths and what is compared.
struct Comparison<'a> {
    coarse: Stepper<'a>,
    fine: Stepper<'a>,
    channels: usize,
    relaxation: &'a Relaxation,
    quantities: Vec<BiasedQuantity>,
    /// Switching surface of each quantity that is a share.
    surfaces: Vec<f64>,
    settle: usize,
    looks: usize,
    cancellation: &'a Cancellation,
}

impl<'a> Comparison<'a> {
    fn new(
        system: &'a dyn System,
        space: &CellSpace,
        relaxation: &'a Relaxation,
        (integrator, time_step): (Integrator, f64),
        cancellation: &'a Cancellation,
    ) -> Self {
        let mut quantities: Vec<BiasedQuantity> = (0..system.dimension())
            .map(BiasedQuantity::Variance)
            .collect();
        quantities.push(BiasedQuantity::Energy);
        let mut surfaces = vec![0.0; quantities.len()];
        for surface in &system.facts().switching_surfaces {
            if space.axes()[surface.axis].find(surface.at).is_some() {
                quantities.push(BiasedQuantity::SurfaceShare(surface.axis));
                surfaces.push(surface.at);
            }
        }
        let steps = relaxation.time / time_step;
        let least = MOST_STEPS.min((SETTLE + COMPARE) * steps);
        let part =
            |share: f64| ((share / (SETTLE + COMPARE) * least / LOOK as f64) as usize).max(8);
        Self {
            coarse: Stepper::new(system, integrator, time_step, cancellation).within_a_turn(),
            fine: Stepper::new(system, integrator, 0.5 * time_step, cancellation).within_a_turn(),
            channels: system.noises().len(),
            relaxation,
            quantities,
            surfaces,
            settle: part(SETTLE),
            looks: part(COMPARE),
            cancellation,
        }
    }

    /// Averages over time of every quantity, coarse and fine, a trajectory.
    fn batch(&self, seed: u64, number: u64) -> Result<Vec<Vec<[f64; 2]>>, Cancelled> {
        let settled = &self.relaxation.settled;
        let dimension = self.relaxation.mean.len();
        let mut coarse = vec![[0.0; LANES]; dimension];
        for lane in 0..LANES {
            let state = &settled[(number as usize * LANES + lane) % settled.len()];
            for (lanes, value) in coarse.iter_mut().zip(state) {
                lanes[lane] = *value;
            }
        }
        let mut fine = coarse.clone();
        let mut stream = NormalStream::new(key(seed, Purpose::Halving, number));
        let mut averages = vec![vec![[0.0; 2]; self.quantities.len()]; LANES];
        for look in 0..self.settle + self.looks {
            self.cancellation.check()?;
            self.advance(&mut coarse, &mut fine, look * LOOK, &mut stream);
            if look >= self.settle {
                let seen = [self.coarse.seen(&coarse), self.fine.seen(&fine)];
                for (lane, averages) in averages.iter_mut().enumerate() {
                    for (path, states) in seen.iter().enumerate() {
                        self.add(states, lane, averages, path);
                    }
                }
            }
        }
        Ok(averages)
    }

    fn advance(
        &self,
        coarse: &mut [Lanes],
        fine: &mut [Lanes],
        first: usize,
        stream: &mut NormalStream,
    ) {
        let channels = self.channels;
        let mut normals = vec![[0.0; LANES]; 2 * LOOK * channels];
        stream.fill(&mut normals);
        let sums = over_two_steps(&normals, channels);
        self.fine.advance_with(fine, 2 * first, 2 * LOOK, &normals);
        self.coarse.advance_with(coarse, first, LOOK, &sums);
    }

    /// Adds one look at one trajectory to its averages.
    fn add(&self, states: &[Lanes], lane: usize, averages: &mut [[f64; 2]], path: usize) {
        let Relaxation { mean, variance, .. } = self.relaxation;
        let square = |axis: usize| {
            let far = FARTHEST * FARTHEST * variance[axis];
            let square = (states[axis][lane] - mean[axis]).powi(2);
            // Also for what is not a number.
            if square <= far { square } else { far }
        };
        let share = 1.0 / self.looks as f64;
        for (index, quantity) in self.quantities.iter().enumerate() {
            let value = match *quantity {
                BiasedQuantity::Variance(axis) => square(axis),
                BiasedQuantity::Energy => (0..mean.len())
                    .map(|axis| square(axis) / variance[axis].max(f64::MIN_POSITIVE))
                    .sum(),
                BiasedQuantity::SurfaceShare(axis) => {
                    let off = (states[axis][lane] - self.surfaces[index]).abs();
                    f64::from(u8::from(off <= REGION * variance[axis].sqrt()))
                }
            };
            averages[index][path] += share * value;
        }
    }
}

#[cfg(test)]
mod tests;
