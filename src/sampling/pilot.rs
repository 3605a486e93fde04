//! A first look at a system with a few free trajectories: where its mass is, how wide it spreads, how fast it
//! moves. From it come the cells to start from and steps that suit the system.

use super::Integrator;
use super::integrator::{Position, Stepper, positions};
use super::jacobian::{LocalRates, local_rates};
use super::random::{NormalStream, StreamKey, mix, unit};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::in_parallel;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

mod record;
use record::Record;

/// Batches of trajectories; the first two start at the centre of Ω unless they stay there, the others all over it.
const BATCHES: u64 = 4;
/// States recorded of each trajectory.
const RECORDS: usize = 256;
/// Most steps of a trajectory before, and again while, states are recorded.
const MOST_STEPS: usize = 100_000;
/// Number among the cells that keys the pilot's streams apart from those of the cells.
const PILOT_CELL: u64 = u64::MAX;
/// Points at which local rates are looked at before any trajectory runs.
const SCOUTS: u64 = 256;

/// Share of the range of an axis within which a trajectory that has been followed for long has not moved.
const REST: f64 = 1e-6;

/// Share of the damping that the integrator's own anti-damping may take.
const DAMPING_SHARE: f64 = 0.01;
/// Largest step in units of the fastest time scale 1/ω.
const ANGLE: f64 = 0.1;
/// Largest increase of the noise power by the cells, relative and in units of the spread of each axis.
const NOISE_SHARE: f64 = 0.05;
/// Largest relative error of the density, from one end of its spread to the other, that sampled drifts may make along
/// one axis.
const DRIFT_NOISE: f64 = 0.03;
/// Longest map step for that, as a share of the time that the noise takes to cross the spread.
const CROSSING_SHARE: f64 = 0.25;
/// Part of the range of an axis that is crossed.
const PART: f64 = 0.2;
/// How much slower than a drift that holds a state changes the noise takes to cross its spread, as a share: a half of
/// the rate of an Ornstein-Uhlenbeck process, and less where the spread is guessed from the range.
const SLOWER: f64 = 0.25;
const SLOWER_THAN_SPREAD: f64 = 0.5;
/// Most steps in one automatic map step.
const MOST_MAP_STEPS: f64 = 1e5;

/// What a few hundred free trajectories show, after they have settled. Means are over visits to Ω.
#[derive(Debug, Clone, PartialEq)]
pub struct Pilot {
    /// Cells that were visited, ascending; where no trajectory stays in Ω, the cell of Ω's centre.
    pub cells: Vec<usize>,
    /// Steps that each trajectory took.
    pub(crate) steps: usize,
    /// Whether the trajectories took as many steps as they need to settle.
    pub(crate) may_settle: bool,
    /// Recorded states beyond the range of each axis.
    pub(crate) outside: Vec<usize>,
    /// Share of the recorded states that lie in Ω; without any, what follows is of Ω as a whole.
    pub share_inside: f64,
    /// Standard deviation, one value an axis.
    pub standard_deviation: Vec<f64>,
    /// Mean square width of the cells visited, one value an axis.
    pub mean_square_width: Vec<f64>,
    /// Mean noise intensity Σ b²/2, one value an axis.
    pub noise_intensity: Vec<f64>,
    /// Fastest rate ω: 99 % of the visited states have no eigenvalue of the drift's Jacobian of larger magnitude. At
    /// least half of the rate at which noise crosses the spread along an axis, which matters for drifts that do not
    /// change.
    pub frequency: f64,
    /// Mean damping γ of the oscillation's energy (-2 Re λ of oscillating pairs λ; for x'' + κx' + ω²x = 0 it is
    /// κ); zero where nothing oscillates. Negative values mean that energy is fed in. Damping of other
    /// directions, such as Dahl's z, does not count: it would hide how little holds the oscillation back.
    pub damping: f64,
    /// What takes the place of ω for an integrator that moves positions apart (coordinates without noise that a
    /// velocity moves): the largest of ω/2, of the rates at which everything else changes where they stand, and of
    /// what noises say, per unit of time. `None` without positions.
    pub split_frequency: Option<f64>,
    /// The axis that is the phase of a forcing, along which cells spread nothing.
    pub(crate) phase: Option<usize>,
}

impl Pilot {
    /// A time step for an integrator: dt ≤ 0.1/ω, and where the oscillation is damped by γ > 0, the damping that
    /// the integrator takes away, ω⁴dt³/4 for Heun and ω²dt for Euler-Maruyama, at most 1 % of γ. Splitting takes
    /// nothing away, and has another ω ([`Pilot::split_frequency`]).
    pub fn automatic_time_step(&self, integrator: Integrator) -> f64 {
        self.time_step_within(integrator, DAMPING_SHARE)
    }

    /// The same with another share of the damping than 1 %: about the relative error of the variances that the step
    /// leaves.
    pub(crate) fn time_step_within(&self, integrator: Integrator, share: f64) -> f64 {
        match self.split_frequency.filter(|_| integrator.splits()) {
            Some(split) => time_step((split, split), 0.0, share, integrator),
            None => {
                let frequency = self.frequency;
                time_step((frequency, frequency), self.damping, share, integrator)
            }
        }
    }

    /// The smallest map step Δt for which the numerical diffusion h²/(12Δt) stays below 5 % of the noise, each
    /// axis in units of its variance:
    /// Σ_a h_a²/(12Δt)/var_a ≤ 0.05 Σ_a D_a/var_a with D_a the mean b²/2.
    ///
    /// In these units it is the relative increase of the noise power. For a damped oscillator a relative increase
    /// ε of the variance of both axes moves the density by a total variation of 0.37 ε. At least one time step, at
    /// most 1e5.
    ///
    /// And not so short that samples cannot tell the drift: over a map step n samples a cell give it to √(2D/(n Δt)),
    /// and what that makes of log p adds up along an axis to √(2 h s/(D m Δt)), s the standard deviation and m the
    /// samples of all cells across, on four standard deviations of the other axes. That is kept below 3 %, unless it
    /// takes longer than a quarter of s²/D.
    pub fn automatic_map_step(&self, time_step: f64, samples: usize) -> f64 {
        let (mut cells, mut noise) = (0.0, 0.0);
        for axis in self.spread_axes() {
            let deviation = self.standard_deviation[axis];
            let square = self.mean_square_width[axis];
            // A spread below a cell is not resolved: the cell's own variance stands in.
            let variance = (deviation * deviation).max(square / 12.0);
            cells += square / 12.0 / variance;
            noise += self.noise_intensity[axis] / variance;
        }
        let longest = MOST_MAP_STEPS * time_step;
        let wanted = (cells / (NOISE_SHARE * noise)).max(self.map_step_for_samples(samples));
        if wanted.is_finite() {
            wanted.clamp(time_step, longest)
        } else {
            longest
        }
    }
}

impl Pilot {
    /// All axes but the phase of a forcing.
    fn spread_axes(&self) -> impl Iterator<Item = usize> {
        (0..self.standard_deviation.len()).filter(|&axis| self.phase != Some(axis))
    }

    /// The shortest map step in which the samples tell the drift along every noisy axis.
    fn map_step_for_samples(&self, samples: usize) -> f64 {
        let cells_of = |axis: usize| {
            let width = self.mean_square_width[axis].sqrt();
            (4.0 * self.standard_deviation[axis] / width).max(1.0)
        };
        let all: f64 = self.spread_axes().map(cells_of).product();
        let step = |axis: usize| {
            let (spread, noise) = (self.standard_deviation[axis], self.noise_intensity[axis]);
            let width = self.mean_square_width[axis].sqrt();
            let across = samples as f64 * all / cells_of(axis);
            let wanted = 2.0 * width * spread / (noise * across * DRIFT_NOISE * DRIFT_NOISE);
            wanted.min(CROSSING_SHARE * spread * spread / noise)
        };
        let noisy = |axis: &usize| self.noise_intensity[*axis] > 0.0;
        let axes = self.spread_axes().filter(noisy);
        axes.map(step).fold(0.0, f64::max)
    }
}

/// The largest step with dt ≤ 0.1/`fastest` and an anti-damping at `typical` below a share of `damping`.
fn time_step(
    (fastest, typical): (f64, f64),
    damping: f64,
    share: f64,
    integrator: Integrator,
) -> f64 {
    let mut step = ANGLE / fastest.max(f64::MIN_POSITIVE);
    if damping > 0.0 && typical > 0.0 {
        let spare = share * damping;
        step = step.min(match integrator {
            Integrator::EulerMaruyama => spare / typical.powi(2),
            _ => (4.0 * spare / typical.powi(4)).cbrt(),
        });
    }
    if step.is_finite() { step } else { 1.0 }
}

/// Value below which the given share of the numbers lies; 0 for none.
fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let index = (share * values.len().saturating_sub(1) as f64).round() as usize;
    values.get(index).copied().unwrap_or(0.0)
}

/// Fastest rate (at a quantile) and mean damping of some local rates.
fn summary(rates: &[LocalRates], share: f64) -> (f64, f64) {
    let fastest = quantile(rates.iter().map(|rate| rate.fastest).collect(), share);
    let dampings = rates.iter().filter_map(|rate| rate.damping);
    let (sum, count) = dampings.fold((0.0, 0_usize), |(sum, n), value| (sum + value, n + 1));
    (fastest, sum / count.max(1) as f64)
}

/// Runs a few hundred trajectories, lets them settle, and records where they go. Keyed by `seed`; the result
/// does not depend on the number of threads.
///
/// # Errors
/// [`Cancelled`].
pub fn pilot(
    system: &dyn System,
    space: &CellSpace,
    seed: u64,
    cancellation: &Cancellation,
) -> Result<Pilot, Cancelled> {
    let scouts = (0..SCOUTS).map(|scout| place(space, seed, scout, true));
    let positions = positions(system);
    let scouted: Vec<LocalRates> = scouts
        .filter_map(|state| local_rates(system, space, &state, &positions))
        .collect();
    let crossing = rate_across(system, space, seed);
    let (fastest, damping) = summary(&scouted, 1.0);
    let (typical, _) = summary(&scouted, 0.5);
    let [fastest, typical] = [fastest, typical].map(|rate| rate.max(crossing));
    let step = time_step(
        (fastest, typical),
        damping,
        DAMPING_SHARE,
        Integrator::StochasticHeun,
    );
    // Energy settles in a few times 1/γ; without damping to go by, in some tens of periods.
    let periods = 300.0 / typical.max(f64::MIN_POSITIVE);
    let settling = if damping > 0.0 {
        periods.max(10.0 / damping)
    } else {
        3.0 * periods
    };
    let wanted = (settling / step) as usize;
    let steps = wanted.clamp(RECORDS, MOST_STEPS);
    let stepper = Stepper::new(system, Integrator::StochasticHeun, step, cancellation);
    let run = |batch| trajectories(&stepper, system, space, seed, batch as u64, steps);
    let records = in_parallel(BATCHES as usize, run)?;
    let mut record = Record::new(system, space);
    for of_batch in &records {
        record.join(of_batch);
    }
    if record.inside == 0 {
        let outside = record.outside.clone();
        let seen = nothing_stays(system, space, seed, (scouted, 2 * steps));
        return Ok(Pilot { outside, ..seen });
    }
    Ok(Pilot {
        may_settle: wanted <= MOST_STEPS,
        ..record.finish(2 * steps)
    })
}

/// The rate at which noise takes a state across a fair part of the range of an axis, the largest of all. It is slower
/// than a drift that holds the state in Ω changes along the axis, and matters where the drift does not change at all,
/// as that of dry friction alone.
fn rate_across(system: &dyn System, space: &CellSpace, seed: u64) -> f64 {
    let mut largest: f64 = 0.0;
    for scout in 0..SCOUTS {
        let state = place(space, seed, scout, true);
        let mut intensity = vec![0.0; space.dimension()];
        for noise in system.noises() {
            intensity[noise.axis] += 0.5 * noise.at(0.0, &state).powi(2);
        }
        for (axis, noise) in space.axes().iter().zip(intensity) {
            let part = PART * (axis.to() - axis.from());
            let rate = SLOWER * noise / (part * part);
            largest = largest.max(if rate.is_finite() { rate } else { 0.0 });
        }
    }
    largest
}

/// What is left to say where no trajectory stays in Ω: means over Ω itself.
fn nothing_stays(
    system: &dyn System,
    space: &CellSpace,
    seed: u64,
    (rates, steps): (Vec<LocalRates>, usize),
) -> Pilot {
    let mut record = Record::new(system, space);
    for scout in 0..SCOUTS {
        record.visit(system, space, &place(space, seed, scout, true));
    }
    record.rates = rates;
    let centre = place(space, seed, 0, false);
    Pilot {
        cells: space.find(&centre).into_iter().collect(),
        share_inside: 0.0,
        ..record.finish(steps)
    }
}

/// Centre of Ω, or a point of it that is uniform over points.
fn place(space: &CellSpace, seed: u64, point: u64, spread: bool) -> Vec<f64> {
    let key = StreamKey {
        seed,
        cell: PILOT_CELL,
        block: u64::MAX - point,
    };
    let word = key.word();
    let coordinate = |(axis, edges): (usize, &crate::space::Axis)| {
        let share = if spread {
            unit(mix(word.wrapping_add(axis as u64)))
        } else {
            0.5
        };
        edges.from() + share * (edges.to() - edges.from())
    };
    space.axes().iter().enumerate().map(coordinate).collect()
}

/// Whether there is an axis, other than the phase of a forcing, along which no trajectory of a batch has moved: they
/// started at a state of rest, or on a plane that nothing leaves, and say nothing of a density that lies elsewhere.
pub(crate) fn stand_still(
    starts: &[Lanes],
    states: &[Lanes],
    space: &CellSpace,
    phase: Option<usize>,
) -> bool {
    let mut axes = space.axes().iter().enumerate();
    axes.any(|(axis, cells)| {
        let far = REST * (cells.to() - cells.from());
        let mut lanes = starts[axis].iter().zip(&states[axis]);
        Some(axis) != phase && lanes.all(|(start, state)| (state - start).abs() <= far)
    })
}

/// One batch: settles for `steps` steps and is recorded during as many again.
fn trajectories(
    stepper: &Stepper<'_>,
    system: &dyn System,
    space: &CellSpace,
    seed: u64,
    batch: u64,
    steps: usize,
) -> Result<Record, Cancelled> {
    let settled = |spread: bool| {
        let mut starts: Vec<Lanes> = vec![[0.0; LANES]; space.dimension()];
        for lane in 0..LANES {
            let point = SCOUTS + batch * LANES as u64 + lane as u64;
            let start = place(space, seed, point, spread);
            for (lanes, value) in starts.iter_mut().zip(start) {
                lanes[lane] = value;
            }
        }
        let mut stream = NormalStream::new(StreamKey {
            seed,
            cell: PILOT_CELL,
            block: batch,
        });
        let mut states = starts.clone();
        stepper.advance(&mut states, 0, steps, &mut stream)?;
        Ok::<_, Cancelled>((starts, states, stream))
    };
    let is_all_over = 2 * batch >= BATCHES;
    let (starts, mut states, mut stream) = settled(is_all_over)?;
    if !is_all_over && stand_still(&starts, &states, space, system.facts().phase) {
        (_, states, stream) = settled(true)?;
    }
    let mut record = Record::new(system, space);
    let mut done = steps;
    for visit in 1..=RECORDS {
        let until = steps + visit * steps / RECORDS;
        stepper.advance(&mut states, done, until - done, &mut stream)?;
        done = until;
        record.batch(system, space, &states, visit % 16 == 0);
    }
    Ok(record)
}

#[cfg(test)]
mod tests;
