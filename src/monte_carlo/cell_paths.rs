//! Paths that start all over a cell and are followed for one map step, or until they enter a region: with a time step
//! and with half of it.
//!
//! Starts are those of a cell map, stratified in every axis and mirrored about the middle of the cell. Two paths begin
//! at each, and see increments of opposite signs: what a number has of first order in the noise, their mean has not.

use super::MonteCarloError;
use super::batch::{Limits, Purpose, key};
use super::halving::over_two_steps;
use super::walk::{Border, Chance, PassageTarget, Walk};
use crate::MAX_DIMENSION;
use crate::cancellation::Cancellation;
use crate::sampling::{Integrator, NormalStream, StartLattice, Stepper, shift};
use crate::space::CellSpace;
use crate::system::{BoundQuantity, LANES, Lanes, System};

/// Steps of the coarser paths for which normals are drawn at once.
const CHUNK: usize = 16;

/// How the paths of a cell are followed.
#[derive(Debug, Clone)]
pub(crate) struct CellRun {
    /// Time for which they are followed at most.
    pub(crate) map_step: f64,
    /// Step of the coarser path of each pair at most; the other has half of it.
    pub(crate) time_step: f64,
    pub(crate) integrator: Integrator,
    pub(crate) seed: u64,
    /// Groups of paths, independent of each other.
    pub(crate) groups: usize,
    /// Batches of 64 paths in each group.
    pub(crate) batches: usize,
}

impl CellRun {
    /// Steps of the coarser paths.
    pub(crate) fn steps(&self) -> usize {
        (self.map_step / self.time_step - 1e-9).ceil().max(1.0) as usize
    }
}

/// From where paths start.
#[derive(Debug, Clone, Copy)]
pub(crate) enum PathsFrom<'a> {
    /// All over a cell.
    Cell(usize),
    /// From one state.
    State(&'a [f64]),
}

/// A path at the end of a map step, or when it entered the region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PathEnd {
    /// When it entered the region; infinite where it has not.
    pub(crate) time: f64,
    /// Which part of the region it entered.
    pub(crate) exit: usize,
    /// Where it is after the map step, unless it has entered the region.
    pub(crate) state: [f64; MAX_DIMENSION],
}

/// A path with a time step and with half of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellPath {
    pub(crate) group: usize,
    /// Where it started in its cell, from -½ to ½ along each axis.
    pub(crate) start: [f64; MAX_DIMENSION],
    /// Whether it started in the region from which the passage is asked for.
    pub(crate) is_from_region: bool,
    /// Ends with the step, and with half of it.
    pub(crate) ends: [PathEnd; 2],
}

/// Paths of one cell after another.
pub(crate) struct CellPaths<'a> {
    system: &'a dyn System,
    space: &'a CellSpace,
    border: Border<'a>,
    region: Option<&'a BoundQuantity>,
    limits: Limits,
    lattice: StartLattice,
    run: CellRun,
    cancellation: &'a Cancellation,
}

impl<'a> CellPaths<'a> {
    /// Paths until they enter a target, some of which start in a region: all of them, where there is none.
    ///
    /// # Errors
    /// [`MonteCarloError`].
    pub(crate) fn new(
        system: &'a dyn System,
        space: &'a CellSpace,
        target: PassageTarget<'a>,
        region: Option<&'a BoundQuantity>,
        run: CellRun,
        cancellation: &'a Cancellation,
    ) -> Result<Self, MonteCarloError> {
        MonteCarloError::check(system, space)?;
        MonteCarloError::check_times([("time step", run.time_step), ("map step", run.map_step)])?;
        Ok(Self {
            system,
            space,
            border: Border::new(system, space, target),
            region,
            limits: Limits::new(space),
            // Two paths begin at each start.
            lattice: StartLattice::new(run.batches * LANES / 2, space.dimension()),
            run,
            cancellation,
        })
    }

    /// Follows all paths that start outside of the region, and tells of each; gives how many have run away.
    ///
    /// # Errors
    /// [`MonteCarloError::Cancelled`].
    pub(crate) fn follow(
        &self,
        from: PathsFrom<'_>,
        mut tell: impl FnMut(&CellPath),
    ) -> Result<usize, MonteCarloError> {
        let run = &self.run;
        let steps = run.steps();
        let time_step = run.map_step / steps as f64;
        let mut walks = [time_step, 0.5 * time_step].map(|step| {
            let stepper = Stepper::new(self.system, run.integrator, step, self.cancellation);
            Walk::new(&self.border, stepper, step)
        });
        let mut runaways = 0;
        for batch in 0..run.groups * run.batches {
            self.cancellation.check()?;
            let (states, starts) = self.starts(from, batch);
            let levels = self.border.until.values(&states);
            let inside = self.region.map(|region| region.values(&states));
            let is_path = levels.map(|level| level >= 0.0);
            if is_path.iter().all(|is_path| !is_path) {
                continue;
            }
            for lane in 0..LANES {
                let state = states.iter().map(|lanes| lanes[lane]);
                let state: Vec<f64> = state.collect();
                for walk in &mut walks {
                    walk.start(lane, &state);
                    walk.going[lane] = is_path[lane];
                }
            }
            self.walk(from, batch, steps, &mut walks);
            for lane in (0..LANES).filter(|&lane| is_path[lane]) {
                let end = |walk: &Walk<'_>| PathEnd {
                    time: walk.times[lane],
                    exit: walk.exits[lane],
                    state: walk.state(lane),
                };
                let path = CellPath {
                    group: batch / run.batches,
                    start: starts.map(|axis| axis[lane]),
                    is_from_region: inside.is_none_or(|levels| levels[lane] < 0.0),
                    ends: [end(&walks[0]), end(&walks[1])],
                };
                let dimension = self.space.dimension();
                let is_near = |end: &PathEnd| {
                    end.time.is_finite() || self.limits.hold(&end.state[..dimension])
                };
                match path.ends.iter().all(is_near) {
                    true => tell(&path),
                    false => runaways += 1,
                }
            }
        }
        Ok(runaways)
    }

    /// Number of a batch: cells and batches have numbers of their own, and so has a state, behind all cells.
    fn number(&self, from: PathsFrom<'_>, batch: usize) -> u64 {
        let cell = match from {
            PathsFrom::Cell(cell) => cell,
            PathsFrom::State(_) => self.space.n_cells(),
        };
        (cell * self.run.groups * self.run.batches + batch) as u64
    }

    /// Lets a batch of paths go on for the map step. Paths beside each other see opposite increments.
    fn walk(&self, from: PathsFrom<'_>, batch: usize, steps: usize, walks: &mut [Walk<'_>; 2]) {
        let (seed, number) = (self.run.seed, self.number(from, batch));
        let channels = self.system.noises().len();
        let mut stream = NormalStream::new(key(seed, Purpose::Map, number));
        let mut normals = vec![[0.0; LANES]; 2 * CHUNK * channels];
        let chance = |lane| Chance::new(seed, Purpose::MapChance, number * LANES as u64 + lane);
        let chances = std::array::from_fn(|lane| chance(lane as u64));
        walks.iter_mut().for_each(Walk::look);
        let row = |step: usize| step * channels..(step + 1) * channels;
        for first in (0..steps).step_by(CHUNK) {
            stream.fill(&mut normals);
            for lanes in &mut normals {
                for pair in lanes.chunks_exact_mut(2) {
                    pair[1] = -pair[0];
                }
            }
            let sums = over_two_steps(&normals, channels);
            for step in 0..CHUNK.min(steps - first) {
                walks[0].step(&sums[row(step)], &chances);
                walks[1].step(&normals[row(2 * step)], &chances);
                walks[1].step(&normals[row(2 * step + 1)], &chances);
            }
        }
    }

    /// States in which a batch starts, and where they are in the cell.
    fn starts(&self, from: PathsFrom<'_>, batch: usize) -> (Vec<Lanes>, [Lanes; MAX_DIMENSION]) {
        let mut offsets = [[0.0; LANES]; MAX_DIMENSION];
        let cell = match from {
            PathsFrom::Cell(cell) => cell,
            PathsFrom::State(state) => {
                return (state.iter().map(|&x| [x; LANES]).collect(), offsets);
            }
        };
        let (group, of_group) = (batch / self.run.batches, batch % self.run.batches);
        let number = (cell * self.run.groups + group) as u64;
        let of_group_shift = shift(key(self.run.seed, Purpose::MapStart, number).word());
        let mut states = vec![[0.0; LANES]; self.space.dimension()];
        for (axis, lanes) in states.iter_mut().enumerate() {
            let edges = &self.space.axes()[axis];
            let position = self.space.position(cell, axis);
            let (low, width) = (edges.edges()[position], edges.width(position));
            for (lane, x) in lanes.iter_mut().enumerate() {
                let sample = (of_group * LANES + lane) / 2;
                let within = self.lattice.coordinate(&of_group_shift, sample, axis);
                *x = low + width * within;
                offsets[axis][lane] = within - 0.5;
            }
        }
        (states, offsets)
    }
}
