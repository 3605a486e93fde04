//! The density as a time average: a fixed number of long trajectories, counted into cells every few steps.

use std::ops::Range;

use super::batch::{Batch, Histogram, Limits, Purpose, key, random_point};
use super::estimate::{BLOCKS, Estimate, Tally};
use super::phases::Phases;
use super::turning::Turning;
use super::{MonteCarloError, Relaxation};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::in_parallel;
use crate::sampling::{CellLookup, Integrator, Stepper, WholeTurn};
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Largest time between looks, in units of 1/ω: what moves faster than this is missed, what moves slower is seen twice.
const LOOK_ANGLE: f64 = 0.5;
/// Looks between two searches for trajectories that ran away.
const LOOKS_A_CHECK: usize = 64;

/// A run of long trajectories.
#[derive(Debug, Clone, PartialEq)]
pub struct ErgodicRun {
    /// Step of the integrator.
    pub time_step: f64,
    /// The integrator.
    pub integrator: Integrator,
    /// Seed of the random streams.
    pub seed: u64,
    /// Trajectories, rounded up to a multiple of [`LANES`].
    pub trajectories: usize,
    /// Time before states are counted.
    pub burn_in: f64,
    /// Time during which the states of one trajectory are counted.
    pub length: f64,
    /// Steps between two looks at a trajectory.
    pub stride: usize,
}

impl ErgodicRun {
    /// Steps between looks: the time that crossing a cell takes on its narrowest axis (root mean square width over root
    /// mean square speed), but at most 0.5/ω. Denser looks see the same visit again and tell next to nothing. Even,
    /// because normals come in pairs.
    pub(crate) fn stride(relaxation: &Relaxation, time_step: f64) -> usize {
        let crossing = relaxation.crossing_time.iter().copied();
        let crossing = crossing.filter(|time| time.is_finite() && *time > 0.0);
        let longest = LOOK_ANGLE / relaxation.frequency.max(f64::MIN_POSITIVE);
        let time = crossing.fold(longest, f64::min);
        // A stride of a million steps is beyond any use, and whatever is not finite ends there.
        let pairs = (0.5 * time / time_step).round().clamp(1.0, 5e5);
        2 * pairs as usize
    }

    fn batches(&self) -> usize {
        self.trajectories.div_ceil(LANES).max(1)
    }

    pub(super) fn check(
        &self,
        system: &dyn System,
        space: &CellSpace,
    ) -> Result<(), MonteCarloError> {
        MonteCarloError::check_times([
            ("time step", self.time_step),
            ("burn-in", self.burn_in),
            ("length", self.length),
        ])?;
        if self.stride == 0 {
            return Err(MonteCarloError::Stride);
        }
        MonteCarloError::check(system, space)
    }
}

/// Batches that one task runs one after another, and blocks of time each is cut into.
fn tasks(batches: usize) -> (Vec<Range<usize>>, usize) {
    let tasks = batches.min(BLOCKS);
    let bounds = |task: usize| task * batches / tasks..(task + 1) * batches / tasks;
    ((0..tasks).map(bounds).collect(), BLOCKS.div_ceil(tasks))
}

/// Estimates the steady-state density on the cells of a space, conditioned on Ω.
///
/// Trajectories start from `starts` (any states, d values each; settled ones of a [`Relaxation`] need the least
/// burn-in), drawn with replacement; without any, all over Ω. They keep running when they leave Ω; those that run away
/// (not finite, or beyond a hundred times the half range) are counted and never restarted. Results are the same bits
/// for any number of threads: the work is cut by the number of a trajectory.
///
/// # Errors
/// [`MonteCarloError`].
pub fn ergodic(
    system: &dyn System,
    space: &CellSpace,
    starts: &[Vec<f64>],
    run: &ErgodicRun,
    cancellation: &Cancellation,
) -> Result<Estimate, MonteCarloError> {
    run.check(system, space)?;
    if starts.iter().any(|state| state.len() != space.dimension()) {
        return Err(MonteCarloError::Start);
    }
    let lookup = CellLookup::new(space);
    let worker = Worker {
        stepper: Stepper::new(system, run.integrator, run.time_step, cancellation),
        lookup: &lookup,
        limits: Limits::new(space),
        starts: Starts::among(starts, space),
        purpose: Purpose::Ergodic,
        turns: WholeTurn::of(system),
        phases: Phases::of(system, space, run.time_step * run.stride as f64)?,
        run,
    };
    worker.all(space)
}

/// Where trajectories start.
pub(super) enum Starts<'a> {
    /// States drawn with replacement.
    Among(&'a [Vec<f64>]),
    /// Uniform in a box, one range an axis.
    Box(Vec<(f64, f64)>),
}

impl Starts<'_> {
    /// Among these states; without any, all over Ω.
    pub(super) fn among<'s>(states: &'s [Vec<f64>], space: &CellSpace) -> Starts<'s> {
        if states.is_empty() {
            Starts::Box(whole(space))
        } else {
            Starts::Among(states)
        }
    }

    /// The states in which the trajectories of a batch start.
    pub(super) fn batch(&self, seed: u64, number: usize, dimension: usize) -> Vec<Lanes> {
        let mut states = vec![[0.0; LANES]; dimension];
        for lane in 0..LANES {
            let trajectory = (number * LANES + lane) as u64;
            // Offset, so that no start is shared with the trajectories that measured the relaxation.
            let point = random_point(seed, (1 << 40) + trajectory, dimension);
            for (axis, lanes) in states.iter_mut().enumerate() {
                lanes[lane] = match self {
                    Starts::Among(states) => {
                        states[(point[0] * states.len() as f64) as usize][axis]
                    }
                    Starts::Box(ranges) => {
                        let (from, to) = ranges[axis];
                        from + point[axis] * (to - from)
                    }
                };
            }
        }
        states
    }
}

/// Ω as a box.
pub(super) fn whole(space: &CellSpace) -> Vec<(f64, f64)> {
    let axes = space.axes().iter();
    axes.map(|axis| (axis.from(), axis.to())).collect()
}
pub(super) struct Worker<'a> {
    pub(super) stepper: Stepper<'a>,
    pub(super) lookup: &'a CellLookup,
    pub(super) limits: Limits,
    pub(super) starts: Starts<'a>,
    pub(super) purpose: Purpose,
    pub(super) turns: Vec<WholeTurn>,
    pub(super) phases: Option<Phases>,
    pub(super) run: &'a ErgodicRun,
}

impl Worker<'_> {
    /// Runs everything and merges the tasks in order.
    pub(super) fn all(&self, space: &CellSpace) -> Result<Estimate, MonteCarloError> {
        let (tasks, blocks) = tasks(self.run.batches());
        let task = |number: usize| self.task(tasks[number].clone(), blocks);
        let tallies = in_parallel(tasks.len(), task)?;
        let axes: Vec<usize> = self.turns.iter().map(|turn| turn.axis).collect();
        let window = (self.window() * self.run.stride) as f64 * self.run.time_step;
        Ok(Estimate::new(
            space,
            tallies,
            self.phases.as_ref(),
            (&axes, window),
        ))
    }

    fn task(&self, batches: Range<usize>, blocks: usize) -> Result<Tally, MonteCarloError> {
        let dimension = self.limits.dimension();
        let turns = self.turns.len();
        let mut tally = Tally::new(vec![
            Histogram::new(
                self.lookup,
                dimension,
                self.parts(),
                turns
            );
            blocks
        ]);
        for number in batches {
            self.batch(number, &mut tally)?;
        }
        Ok(tally)
    }

    /// Looks of a window over which an angle's advance is taken: half the burn-in, in whole periods of a forcing.
    fn window(&self) -> usize {
        let spacing = self.run.time_step * self.run.stride as f64;
        let looks = (0.5 * self.run.burn_in / spacing).ceil() as usize;
        looks.max(1).next_multiple_of(self.parts())
    }

    /// Looks of a period; 1 without a forcing.
    fn parts(&self) -> usize {
        self.phases.as_ref().map_or(1, |phases| phases.parts)
    }

    fn batch(&self, number: usize, tally: &mut Tally) -> Result<(), Cancelled> {
        let run = self.run;
        let key = key(run.seed, self.purpose, number as u64);
        let mut starts = self.starts.batch(run.seed, number, self.limits.dimension());
        if let Some(phases) = &self.phases {
            phases.set(&mut starts, 0);
        }
        let mut batch = Batch::new(starts, key);
        let mut turning = Turning::new(&self.turns, self.window());
        let stretch = run.stride * LOOKS_A_CHECK;
        let mut burn_in = (run.burn_in / run.time_step).ceil() as usize;
        burn_in += burn_in % 2;
        if self.phases.is_some() {
            burn_in = burn_in.next_multiple_of(run.stride * self.parts());
        }
        tally.trajectories += LANES as u64;
        while burn_in > 0 && batch.n_alive() > 0 {
            let steps = stretch.min(burn_in);
            self.advance(&mut batch, steps, tally)?;
            turning.count(&mut batch);
            batch.retire(&self.limits);
            burn_in -= steps;
        }
        turning.begin(&batch);
        let blocks = tally.blocks.len();
        let mut looks = (run.length / (run.time_step * run.stride as f64)).ceil() as usize;
        if let Some(phases) = &self.phases {
            phases.set(&mut batch.states, 0);
            looks = looks.next_multiple_of(phases.parts * blocks);
        }
        let mut done = 0;
        for block in 0..blocks {
            let mut left = (block + 1) * looks / blocks - block * looks / blocks;
            while left > 0 && batch.n_alive() > 0 {
                let count = LOOKS_A_CHECK.min(left);
                let gone = LANES - batch.n_alive();
                for _ in 0..count {
                    self.advance(&mut batch, run.stride, tally)?;
                    done += 1;
                    self.look(&mut batch, &mut turning, done, &mut tally.blocks[block]);
                }
                tally.blocks[block].exclude(gone, count);
                batch.retire(&self.limits);
                left -= count;
            }
        }
        tally.runaways += (LANES - batch.n_alive()) as u64;
        Ok(())
    }

    /// Counts a look, the one of this number, at every trajectory of a batch.
    fn look(
        &self,
        batch: &mut Batch,
        turning: &mut Turning<'_>,
        number: usize,
        block: &mut Histogram,
    ) {
        turning.count(batch);
        turning.look(batch, &mut block.advances);
        let mut seen = self.stepper.seen(&batch.states);
        if let Some(phases) = &self.phases {
            phases.set_to_cell(seen.to_mut(), number);
        }
        block.look(self.lookup, &seen, number % self.parts());
        if let Some(phases) = &self.phases {
            phases.set(&mut batch.states, number);
        }
    }

    fn advance(&self, batch: &mut Batch, steps: usize, tally: &mut Tally) -> Result<(), Cancelled> {
        batch.advance(&self.stepper, steps)?;
        let alive = batch.n_alive() as f64;
        tally.steps += (steps * LANES) as u64;
        tally.lived += alive * steps as f64 * self.run.time_step;
        Ok(())
    }
}
