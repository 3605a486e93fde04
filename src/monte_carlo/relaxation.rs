//! How long a system remembers: free trajectories are watched until they have been seen to settle, and the integrated
//! autocorrelation times of their second moments are measured.

use rayon::prelude::*;

use super::autocorrelation::{Correlation, correlation};
use super::batch::{Batch, Limits, Purpose, key, random_point};
use crate::cancellation::{Cancellation, Cancelled};
use crate::sampling::{Integrator, Stepper, pilot, stand_still};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Batches of trajectories; half start at the middle of Ω unless they stay there, half all over it.
const BATCHES: u64 = 4;
/// Means recorded of each trajectory in a window.
const RECORDS: usize = 512;
/// Looks at the state that make one mean, and steps between looks, in the first window.
const LOOKS: usize = 4;
/// A window is long enough at this many autocorrelation times: all windows before it, together at least as long, are
/// burn-in.
const LONG: f64 = 30.0;
/// Differences between numbers that are the same, relative to the largest of them.
const ROUNDING: f64 = 1e-12;
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

/// Series of one trajectory: means of x_i, and of x_i², an axis.
struct Watched {
    batch: Batch,
    /// `means[2·axis + power - 1][record]`, one value a lane.
    means: Vec<Vec<Lanes>>,
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
        .map(|n| start((space, phase), seed, (n, 2 * n >= BATCHES)))
        .collect();
    let mut stride = LOOKS;
    let watch = |watched: &mut Vec<Watched>, stride: usize| {
        let each = watched.par_iter_mut();
        each.try_for_each(|one| one.window(&stepper, &limits, stride))
    };
    let starts: Vec<Vec<Lanes>> = watched.iter().map(|one| one.batch.states.clone()).collect();
    watch(&mut watched, stride)?;
    for (number, starts) in (0..BATCHES).zip(starts) {
        let one = &mut watched[number as usize];
        if stand_still(&starts, &one.batch.states, space, phase) {
            *one = start((space, phase), seed, (number, true));
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

/// A batch of a number that starts at the middle of Ω, or all over it. Of a forced system all trajectories start at
/// phase zero.
fn start(
    (space, phase): (&CellSpace, Option<usize>),
    seed: u64,
    (number, is_all_over): (u64, bool),
) -> Watched {
    let dimension = space.dimension();
    let points: Vec<_> = (0..LANES as u64)
        .map(|lane| random_point(seed, number * LANES as u64 + lane, dimension))
        .collect();
    let of_axis = |(axis, edges): (usize, &crate::space::Axis)| {
        let mut lanes = [0.0; LANES];
        for (value, point) in lanes.iter_mut().zip(&points) {
            let share = if phase == Some(axis) {
                0.0
            } else if is_all_over {
                point[axis]
            } else {
                0.5
            };
            *value = edges.from() + share * (edges.to() - edges.from());
        }
        lanes
    };
    let states: Vec<Lanes> = space.axes().iter().enumerate().map(of_axis).collect();
    Watched {
        batch: Batch::new(states, key(seed, Purpose::Settle, number)),
        means: vec![Vec::new(); 2 * dimension],
    }
}

impl Watched {
    /// Records means over `LOOKS` looks, `stride` steps apart. What was recorded before is burn-in and forgotten.
    /// Means, not values: an oscillation that is faster than the records must not look slow.
    fn window(
        &mut self,
        stepper: &Stepper<'_>,
        limits: &Limits,
        stride: usize,
    ) -> Result<(), Cancelled> {
        self.means.iter_mut().for_each(Vec::clear);
        for _ in 0..RECORDS {
            let mut sums = vec![[0.0; LANES]; self.means.len()];
            for _ in 0..LOOKS {
                self.batch.advance(stepper, stride)?;
                for (axis, lanes) in self.batch.states.iter().enumerate() {
                    for lane in 0..LANES {
                        sums[2 * axis][lane] += lanes[lane] / LOOKS as f64;
                        sums[2 * axis + 1][lane] += lanes[lane] * lanes[lane] / LOOKS as f64;
                    }
                }
            }
            self.batch.retire(limits);
            for (means, sums) in self.means.iter_mut().zip(sums) {
                means.push(sums);
            }
        }
        Ok(())
    }
}

/// One realisation a trajectory that has not run away, of whatever is made of its means.
fn series(
    watched: &[Watched],
    value: &(dyn Fn(&Watched, usize, usize) -> f64 + Sync),
) -> Vec<Vec<f64>> {
    let lanes = watched
        .iter()
        .flat_map(|one| (0..LANES).map(move |lane| (one, lane)));
    let alive = lanes.filter(|(one, lane)| one.batch.alive[*lane]);
    alive
        .map(|(one, lane)| {
            (0..RECORDS)
                .map(|record| value(one, record, lane))
                .collect()
        })
        .collect()
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

/// Σ (x_i - m_i(t))²/s_i² of every trajectory, with the means m(t) of all of them at each record and the variances
/// about these. An axis along which all are alike, as the phase, has no part.
fn about_moving_mean(watched: &[Watched], dimension: usize) -> Vec<Vec<f64>> {
    let mut sums: Vec<Vec<f64>> = Vec::new();
    for axis in 0..dimension {
        let mut values = series(watched, &|one, record, lane| {
            one.means[2 * axis][record][lane]
        });
        let count = values.len() as f64;
        let (mut variance, mut largest) = (0.0, 0.0_f64);
        for record in 0..RECORDS {
            let mean = values.iter().map(|one| one[record]).sum::<f64>() / count;
            largest = largest.max(mean.abs());
            for one in &mut values {
                one[record] = (one[record] - mean).powi(2);
                variance += one[record] / (count * RECORDS as f64);
            }
        }
        sums.resize(values.len(), vec![0.0; RECORDS]);
        if variance.sqrt() > ROUNDING * largest {
            for (sum, value) in sums.iter_mut().flatten().zip(values.iter().flatten()) {
                *sum += value / variance;
            }
        }
    }
    sums
}

/// What the records of a window say of the axes, their squares and the energy.
struct Correlations {
    mean: Vec<f64>,
    variance: Vec<f64>,
    /// As in [`Relaxation`].
    averaging_time: Vec<f64>,
    /// Longest autocorrelation time, in records.
    longest: f64,
}

/// How a number of all trajectories is correlated in time. Trajectories of a forced system have one phase, and what
/// moves with it never dies out: there deviations from the mean of all of them at each time count.
fn of_series(mut series: Vec<Vec<f64>>, forced: bool) -> Correlation {
    if !forced || series.is_empty() {
        return correlation(&series);
    }
    let count = series.len() as f64;
    let means: Vec<f64> = (0..series[0].len())
        .map(|record| series.iter().map(|one| one[record]).sum::<f64>() / count)
        .collect();
    let whole = means.iter().sum::<f64>() / means.len() as f64;
    let largest = means
        .iter()
        .fold(0.0_f64, |most, mean| most.max(mean.abs()));
    let mut apart = 0.0_f64;
    for one in &mut series {
        for (value, mean) in one.iter_mut().zip(&means) {
            apart = apart.max((*value - mean).abs());
            *value += whole - mean;
        }
    }
    // What is left of a number that is the same for all, as the phase itself is, is rounding.
    if apart <= ROUNDING * largest {
        return Correlation {
            mean: whole,
            time: 0.5,
            long_run_variance: 0.0,
        };
    }
    correlation(&series)
}

fn correlations(watched: &[Watched], dimension: usize, forced: bool, spacing: f64) -> Correlations {
    let correlation = |series: Vec<Vec<f64>>| of_series(series, forced);
    let power = |place: usize| {
        move |one: &Watched, record: usize, lane: usize| one.means[place][record][lane]
    };
    let first: Vec<Correlation> = (0..dimension)
        .map(|axis| correlation(series(watched, &power(2 * axis))))
        .collect();
    let mean: Vec<f64> = first.iter().map(|found| found.mean).collect();
    let square = |axis: usize, one: &Watched, record: usize, lane: usize| {
        let of = |place: usize| one.means[place][record][lane];
        of(2 * axis + 1) - mean[axis] * (2.0 * of(2 * axis) - mean[axis])
    };
    let squares: Vec<Correlation> = (0..dimension)
        .map(|axis| {
            correlation(series(watched, &|one, record, lane| {
                square(axis, one, record, lane)
            }))
        })
        .collect();
    let variance: Vec<f64> = squares.iter().map(|found| found.mean).collect();
    let energy = correlation(series(watched, &|one, record, lane| {
        let part =
            |axis: usize| square(axis, one, record, lane) / variance[axis].max(f64::MIN_POSITIVE);
        (0..dimension).map(part).sum()
    }));
    let ratio = |found: &Correlation| {
        let relative = found.long_run_variance * spacing / (found.mean * found.mean);
        if relative.is_finite() { relative } else { 0.0 }
    };
    let averaged = || squares.iter().chain([&energy]);
    // The product of a deviation and the moving mean beats, and what beats looks forgotten long before it is.
    let about_mean = forced.then(|| correlation(about_moving_mean(watched, dimension)));
    let times = first.iter().chain(averaged()).chain(&about_mean);
    let times = times.map(|found| found.time);
    Correlations {
        averaging_time: averaged().map(ratio).collect(),
        longest: times.fold(0.5, f64::max),
        mean,
        variance,
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
