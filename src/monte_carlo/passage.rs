//! Paths that are followed until they enter a region: when they do, with a time step and with half of it.
//!
//! Both paths of a pair see the same Wiener process and end by the same random number, so that what they differ by is
//! what the step does.

use super::MonteCarloError;
use super::batch::{Batch, Limits, Purpose, key};
use super::ergodic::Starts;
use super::estimate::BLOCKS;
use super::exit_times::{Block, ExitTimes};
use super::halving::over_two_steps;
use super::walk::{Border, Chance, PassageTarget, Walk};
use crate::cancellation::{Cancellation, Cancelled};
use crate::numerics::in_parallel;
use crate::sampling::{Integrator, NormalStream, Stepper};
use crate::space::CellSpace;
use crate::system::{BoundQuantity, LANES, System};

/// Steps of the coarser paths between two looks at which paths have ended and others start.
const CHUNK: usize = 16;

/// Looks at settled trajectories in search of states to start from, at most.
const MOST_LOOKS: usize = 256;

/// How paths are followed.
#[derive(Debug, Clone, PartialEq)]
pub struct PassageRun {
    /// Step of the coarser path of each pair; the other has half of it, and its times are the result.
    pub time_step: f64,
    /// The integrator.
    pub integrator: Integrator,
    /// Seed of the random streams.
    pub seed: u64,
    /// Pairs of paths, rounded up to a multiple of 32.
    pub paths: usize,
    /// Time at which a path that still goes on is given up.
    pub longest: f64,
}

/// Where paths start.
#[derive(Debug, Clone)]
pub enum PassageStart<'a> {
    /// All at one state.
    State(&'a [f64]),
    /// As the steady state is spread.
    Steady(SteadyStart<'a>),
}

/// A start that is spread as the steady state is, drawn from free trajectories.
#[derive(Debug, Clone)]
pub struct SteadyStart<'a> {
    /// The region, by its level; everywhere without one.
    pub region: Option<&'a BoundQuantity>,
    /// States in which the trajectories start; all over Ω without any.
    pub states: &'a [Vec<f64>],
    /// Step of the integrator.
    pub time_step: f64,
    /// Time before states are drawn.
    pub burn_in: f64,
    /// Time between two looks at a trajectory: long enough to forget the last one.
    pub spacing: f64,
}

/// Follows paths from a start until they enter the target. Results are the same bits for any number of threads.
///
/// # Errors
/// [`MonteCarloError`]; [`MonteCarloError::NoStart`] where no path starts outside of the region.
pub fn first_passages<'a>(
    system: &dyn System,
    space: &CellSpace,
    until: impl Into<PassageTarget<'a>>,
    start: &PassageStart<'_>,
    run: &PassageRun,
    cancellation: &Cancellation,
) -> Result<ExitTimes, MonteCarloError> {
    MonteCarloError::check(system, space)?;
    MonteCarloError::check_times([("time step", run.time_step), ("longest time", run.longest)])?;
    let target = until.into();
    let parts = target.exits.len();
    let (limits, border) = (Limits::new(space), Border::new(system, space, target));
    let paths = Paths {
        space,
        system,
        border,
        parts,
        limits,
        start,
        run,
        cancellation,
    };
    paths.all()
}

/// What all blocks of paths share.
struct Paths<'a> {
    space: &'a CellSpace,
    system: &'a dyn System,
    border: Border<'a>,
    /// Parts of the target.
    parts: usize,
    limits: Limits,
    start: &'a PassageStart<'a>,
    run: &'a PassageRun,
    cancellation: &'a Cancellation,
}

impl Paths<'_> {
    fn all(&self) -> Result<ExitTimes, MonteCarloError> {
        let blocks = in_parallel(BLOCKS, |number| self.block(number))?;
        Ok(ExitTimes::new(blocks, self.run.longest, self.parts))
    }

    fn block(&self, number: usize) -> Result<Block, MonteCarloError> {
        let run = self.run;
        let count = run.paths.div_ceil(BLOCKS).max(1);
        let starts = self.starts(number, count)?;
        let channels = self.system.noises().len();
        let mut stream = NormalStream::new(key(run.seed, Purpose::Passage, number as u64));
        let mut normals = vec![[0.0; LANES]; 2 * CHUNK * channels];
        let mut walks = [run.time_step, 0.5 * run.time_step].map(|step| {
            let stepper = Stepper::new(self.system, run.integrator, step, self.cancellation);
            Walk::new(&self.border, stepper, step)
        });
        let mut block = Block::new(count);
        let mut next = 0;
        let mut paths: [Option<usize>; LANES] = [None; LANES];
        let mut chances = [Chance::default(); LANES];
        loop {
            self.cancellation.check()?;
            for lane in 0..LANES {
                if walks.iter().any(|walk| walk.going[lane]) {
                    continue;
                }
                if let Some(path) = paths[lane].take() {
                    block.times[path] = [walks[0].times[lane], walks[1].times[lane]];
                    block.exits[path] = [walks[0].exits[lane], walks[1].exits[lane]];
                }
                if next < count {
                    paths[lane] = Some(next);
                    let path = (number * count + next) as u64;
                    chances[lane] = Chance::new(run.seed, Purpose::Chance, path);
                    let state = &starts[next % starts.len()];
                    walks.iter_mut().for_each(|walk| walk.start(lane, state));
                    next += 1;
                }
            }
            if paths.iter().all(Option::is_none) {
                return Ok(block);
            }
            for walk in &mut walks {
                walk.look();
            }
            stream.fill(&mut normals);
            let sums = over_two_steps(&normals, channels);
            let row = |step: usize| step * channels..(step + 1) * channels;
            for step in 0..CHUNK {
                walks[0].step(&sums[row(step)], &chances);
                walks[1].step(&normals[row(2 * step)], &chances);
                walks[1].step(&normals[row(2 * step + 1)], &chances);
            }
            block.steps += (3 * CHUNK * LANES) as u64;
            for walk in &mut walks {
                block.runaways += walk.give_up(run.longest, &self.limits);
            }
        }
    }

    /// States in which the paths of a block start.
    fn starts(&self, block: usize, count: usize) -> Result<Vec<Vec<f64>>, MonteCarloError> {
        let found = match self.start {
            PassageStart::State(state) if state.len() != self.space.dimension() => {
                return Err(MonteCarloError::Start);
            }
            PassageStart::State(state) if self.border.until.at(state) >= 0.0 => {
                vec![state.to_vec()]
            }
            PassageStart::State(_) => Vec::new(),
            PassageStart::Steady(steady) => self.draw(steady, block, count)?,
        };
        if found.is_empty() {
            return Err(MonteCarloError::NoStart);
        }
        Ok(found)
    }

    /// States of settled trajectories, in the region and outside of the target.
    fn draw(
        &self,
        steady: &SteadyStart<'_>,
        block: usize,
        count: usize,
    ) -> Result<Vec<Vec<f64>>, Cancelled> {
        let run = self.run;
        let starts = Starts::among(steady.states, self.space);
        let stepper = Stepper::new(
            self.system,
            run.integrator,
            steady.time_step,
            self.cancellation,
        );
        let states = starts.batch(run.seed, block, self.space.dimension());
        let number = block as u64;
        let mut batch = Batch::new(states, key(run.seed, Purpose::PassageStart, number));
        // Even, because normals come in pairs.
        let steps = |time: f64| 2 * (0.5 * time / steady.time_step).ceil().max(1.0) as usize;
        batch.advance(&stepper, steps(steady.burn_in))?;
        let mut found = Vec::new();
        for _ in 0..MOST_LOOKS {
            batch.retire(&self.limits);
            if found.len() >= count || batch.n_alive() == 0 {
                break;
            }
            let until = self.border.until.values(&batch.states);
            let inside = steady.region.map(|region| region.values(&batch.states));
            for lane in 0..LANES {
                let is_inside = inside.is_none_or(|levels| levels[lane] < 0.0);
                if batch.alive[lane] && is_inside && until[lane] >= 0.0 {
                    found.push(batch.states.iter().map(|lanes| lanes[lane]).collect());
                }
            }
            batch.advance(&stepper, steps(steady.spacing))?;
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use crate::system::{TypedModel, regions};

    /// Mean time of Brownian motion from the middle of (-1, 1) until it is out, which is 1.
    fn mean(is_bridged: bool) -> (ExitTimes, crate::monte_carlo::ExitNumber) {
        mean_until("abs(x) > 1", is_bridged)
    }

    fn mean_until(region: &str, is_bridged: bool) -> (ExitTimes, crate::monte_carlo::ExitNumber) {
        let model = TypedModel::new("free", "Free", vec!["x"]).with_equation("x", "0 x");
        let model = model.with_noise("x", ["1"]).build().unwrap();
        let region = regions(&model, &[("out", region)]).unwrap().remove(0);
        let until = region.level().bind(&model.values(&[]).unwrap()).unwrap();
        let space = CellSpace::new(vec![Axis::uniform(-2.0, 2.0, 10).unwrap()]).unwrap();
        let system = model.system_with(&[]).unwrap();
        let (run, start) = (run(), PassageStart::State(&[0.0]));
        let mut paths = Paths {
            space: &space,
            system: &*system,
            border: Border::new(&*system, &space, (&until).into()),
            parts: 0,
            limits: Limits::new(&space),
            start: &start,
            run: &run,
            cancellation: &Cancellation::new(),
        };
        if !is_bridged {
            paths.border.noisy.clear();
        }
        let times = paths.all().unwrap();
        let number = times.numbers(&[], &[])[0];
        (times, number)
    }

    fn run() -> PassageRun {
        PassageRun {
            time_step: 0.02,
            integrator: Integrator::StochasticHeun,
            seed: 5,
            paths: 16_384,
            longest: 50.0,
        }
    }

    #[test]
    fn a_strip_that_single_steps_pass_through_ends_paths() {
        // The mean time out of (-1, 0.5) from 0 is 1 · 0.5, however thin the strip at 0.5 is.
        for width in [0.1, 0.01, 1e-4] {
            let region = format!("0.5 < x < {} or x < -1", 0.5 + width);
            let (_, found) = mean_until(&region, true);
            assert!(
                (found.value - 0.5).abs() < 3.0 * found.error() && found.error() < 0.01,
                "{width}: {found:?}"
            );
        }
    }

    #[test]
    fn without_bridges_the_border_is_met_too_late_and_the_half_step_shows_it() {
        let (_, bridged) = mean(true);
        assert!((bridged.value - 1.0).abs() < 4.0 * bridged.error() && bridged.error() < 0.01);
        assert!(!bridged.is_biased(), "{bridged:?}");
        // Steps of 0.01 see borders at 1 + 0.5826 √0.01 (M. Broadie, P. Glasserman and S. Kou, Mathematical Finance 7,
        // 1997), those of 0.02 at 1 + 0.5826 √0.02.
        let (_, late) = mean(false);
        assert!(
            (late.value - 1.0).abs() > 10.0 * bridged.error(),
            "{late:?}"
        );
        let at = |step: f64| (1.0 + 0.5826 * step.sqrt()).powi(2);
        assert!(
            (late.value - at(0.01)).abs() < 0.01 + 4.0 * late.sampling,
            "{late:?}"
        );
        assert!((late.step.0 - at(0.02) + at(0.01)).abs() < 0.01, "{late:?}");
        assert!(late.is_biased());
    }

    #[test]
    fn times_are_the_same_for_any_number_of_threads() {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| mean(true).0)
        };
        assert_eq!(with(1), with(3));
    }
}
