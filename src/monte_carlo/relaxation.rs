//! How long a system remembers: free trajectories are watched until they have been seen to settle, and the integrated
//! autocorrelation times of their second moments are measured.

use rayon::prelude::*;

use super::batch::Limits;
use super::watched::{LOOKS, RECORDS, Watched, correlations};
use crate::cancellation::{Cancellation, Cancelled};
use crate::sampling::{Integrator, Stepper, pilot, stand_still};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Batches of trajectories; half start at the middle of Ω unless they stay there, half all over it.
const BATCHES: u64 = 4;
/// A window is long enough at this many autocorrelation times: all windows before it, together at least as long, are
/// burn-in.
const LONG: f64 = 30.0;
/// Most steps of one trajectory in a window.
const MOST_STEPS: usize = 1 << 20;

/// What free trajectories show of a system once they have settled.
#[derive(Debug, Clone)]
pub struct Relaxation {
    /// Longest integrated autocorrelation time of the coordinates, their squares and Σ (x_i - m_i)²/s_i², which stands
    /// for the energy; in units of time.
    pub time: f64,
    /// Whether the trajectories were watched for thirty of these times; otherwise the time is a lower bound.
    pub resolved: bool,
    /// Mean of each axis.
    pub mean: Vec<f64>,
    /// Variance of each axis.
    pub variance: Vec<f64>,
    /// Time that one trajectory must be averaged over to know the variance of each axis to its own size: the relative
    /// standard error of the variance from a total time T is √(t/T). For the energy-like sum too, last.
    pub averaging_time: Vec<f64>,
    /// Fastest rate of the drift ω, from the pilot.
    pub frequency: f64,
    /// Root mean square width of the cells visited over root mean square speed, an axis: the time to cross a cell.
    pub crossing_time: Vec<f64>,
    /// Share of the trajectories that ran away.
    pub runaways: f64,
    /// What the steps are chosen from.
    pilot: crate::sampling::Pilot,
    /// States at the end, of trajectories that did not run away: `settled[i]` has d coordinates.
    pub(super) settled: Vec<Vec<f64>>,
}

impl Relaxation {
    /// A time step by the pilot's rule: dt ≤ 0.1/ω, and at most a share of the damping taken by the integrator.
    pub(crate) fn time_step(&self, integrator: Integrator, share: f64) -> f64 {
        self.pilot.time_step_within(integrator, share)
    }

    /// States at the end of the trajectories that did not run away, d values each: draws from the steady state.
    pub(crate) fn settled_states(&self) -> &[Vec<f64>] {
        &self.settled
    }

    /// Variance of (x_i - m_i)² relative to its mean's square, the largest of all axes: 2 for a normal density. The
    /// relative standard error of the variance of n independent states is the root of this over n.
    pub(crate) fn relative_square(&self) -> f64 {
        let of_axis = |axis: usize| {
            let off = |state: &Vec<f64>| (state[axis] - self.mean[axis]).powi(2);
            let count = self.settled.len() as f64;
            let mean = self.settled.iter().map(off).sum::<f64>() / count;
            let squares = self.settled.iter().map(|state| off(state).powi(2));
            squares.sum::<f64>() / count / (mean * mean) - 1.0
        };
        let ratios = (0..self.mean.len()).map(of_axis);
        ratios.filter(|ratio| ratio.is_finite()).fold(0.0, f64::max)
    }
}

/// Watches free trajectories until they have settled, in windows that double in length until one of them holds thirty
/// autocorrelation times. Keyed by `seed`; does not depend on the number of threads. What it finds is meant for systems
/// whose drift does not depend on time.
///
/// # Errors
/// [`Cancelled`].
pub fn relaxation(
    system: &dyn System,
    space: &CellSpace,
    seed: u64,
    cancellation: &Cancellation,
) -> Result<Relaxation, Cancelled> {
    let pilot = pilot(system, space, seed, cancellation)?;
    let step = pilot.automatic_time_step(Integrator::StochasticHeun);
    let stepper = Stepper::new(system, Integrator::StochasticHeun, step, cancellation);
    let stepper = stepper.within_a_turn();
    let phase = system.facts().phase;
    let limits = Limits::new(space);
    let mut watched: Vec<Watched> = (0..BATCHES)
        .map(|n| Watched::start((space, phase), seed, (n, 2 * n >= BATCHES)))
        .collect();
    let mut stride = LOOKS;
    let watch = |watched: &mut Vec<Watched>, stride: usize| {
        let each = watched.par_iter_mut();
        each.try_for_each(|one| one.window(&stepper, &limits, stride))
    };
    let starts: Vec<Vec<Lanes>> = watched.iter().map(|one| one.batch.states.clone()).collect();
    watch(&mut watched, stride)?;
    for (number, starts) in (0..BATCHES / 2).zip(starts) {
        let one = &mut watched[number as usize];
        if stand_still(&starts, &one.batch.states, space, phase) {
            *one = Watched::start((space, phase), seed, (number, true));
            one.window(&stepper, &limits, stride)?;
        }
    }
    loop {
        watch(&mut watched, stride)?;
        let found = judge(
            &watched,
            (pilot.clone(), phase.is_some()),
            step * (stride * LOOKS) as f64,
        );
        let steps = RECORDS * LOOKS * stride;
        if found.resolved || found.settled.is_empty() || 2 * steps > MOST_STEPS {
            return Ok(found);
        }
        stride *= 2;
    }
}

/// Reads the window: `spacing` is the time of one record.
fn judge(
    watched: &[Watched],
    (pilot, forced): (crate::sampling::Pilot, bool),
    spacing: f64,
) -> Relaxation {
    let dimension = pilot.standard_deviation.len();
    let found = correlations(watched, dimension, forced, spacing);
    let alive: usize = watched.iter().map(|one| one.batch.n_alive()).sum();
    // Of what has run away, only how long it was watched is known.
    let longest = match alive {
        0 => RECORDS as f64,
        _ => found.longest,
    };
    let speed = |axis: usize| pilot.frequency * found.variance[axis].sqrt();
    Relaxation {
        time: longest * spacing,
        resolved: RECORDS as f64 >= LONG * longest,
        averaging_time: found.averaging_time,
        frequency: pilot.frequency,
        crossing_time: (0..dimension)
            .map(|axis| pilot.mean_square_width[axis].sqrt() / speed(axis))
            .collect(),
        runaways: 1.0 - alive as f64 / (watched.len() * LANES) as f64,
        settled: settled_states(watched),
        mean: found.mean,
        variance: found.variance,
        pilot,
    }
}

fn settled_states(watched: &[Watched]) -> Vec<Vec<f64>> {
    let lanes = watched
        .iter()
        .flat_map(|one| (0..LANES).map(move |lane| (&one.batch, lane)));
    lanes
        .filter(|(batch, lane)| batch.alive[*lane])
        .map(|(batch, lane)| batch.states.iter().map(|lanes| lanes[lane]).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::test_families::built_in;

    fn square_space(half: f64) -> CellSpace {
        let axis = Axis::uniform(-half, half, 40).unwrap();
        CellSpace::new(vec![axis.clone(), axis]).unwrap()
    }

    /// x'' + κx' + x = ξ is Gaussian, so cov(x², x'²) = 2C², C(t) = v e^{-κt/2}(cos ωt + κ/(2ω) sin ωt), v = σ²/(2κ);
    /// the long-run variance of x² is 2∫2C² dt.
    #[test]
    fn a_linear_oscillator_relaxes_as_theory_says() {
        let kappa = 0.05;
        let values = [
            ("kappa", kappa),
            ("mu", 0.0),
            ("f_c", 0.0),
            ("sigma2", 0.01),
        ];
        let system = built_in("coulomb", &values);
        let never = Cancellation::new();
        let found = relaxation(&*system, &square_space(2.0), 1, &never).unwrap();
        assert!(found.resolved && found.runaways == 0.0);
        let words = format!(
            "{} {:?} {:?}",
            found.time, found.variance, found.averaging_time
        );
        let omega = (1.0 - kappa * kappa / 4.0_f64).sqrt();
        let correlation = |t: f64| {
            (-kappa * t / 2.0).exp()
                * ((omega * t).cos() + kappa / (2.0 * omega) * (omega * t).sin())
        };
        let step = 1e-3;
        let squares: f64 = (0..400_000)
            .map(|n| correlation((f64::from(n) + 0.5) * step).powi(2) * step)
            .sum();
        let variance = 0.01 / (2.0 * kappa);
        // 256 trajectories over at least 30 τ: relative error of a time √(2·10τ/(256·30τ)) = 5 %; of a variance
        // √(2·40/(256·30·20)) = 2 %.
        for axis in 0..2 {
            assert!(
                (found.variance[axis] / variance - 1.0).abs() < 0.08,
                "{words}"
            );
        }
        let exact = 4.0 * squares;
        assert!(
            (found.averaging_time[0] / exact - 1.0).abs() < 0.2,
            "{exact} {words}"
        );
        // The energy forgets at the rate κ.
        assert!((found.time * kappa - 1.0).abs() < 0.2, "{words}");
    }

    #[test]
    fn what_runs_away_is_told() {
        let values = [("kappa", -0.5), ("mu", 0.0), ("f_c", 0.0), ("sigma2", 0.01)];
        let system = built_in("coulomb", &values);
        let never = Cancellation::new();
        let found = relaxation(&*system, &square_space(2.0), 1, &never).unwrap();
        assert_eq!(found.runaways, 1.0);
    }
}
