//! One cell's trajectories: where they end, by group, and the numerical diffusion they show.

use super::SamplingOptions;
use super::integrator::Stepper;
use super::random::{NormalStream, StreamKey};
use super::starts::StartLattice;
use crate::MAX_DIMENSION;
use crate::space::CellSpace;
use crate::system::{LANES, Lanes, System};

/// Number that stands for the sink among destinations: cells are numbered below it.
pub(super) const SINK: u32 = u32::MAX;

/// Blocks of this number and above key what is not a batch of trajectories.
const START_BLOCK: u64 = 1 << 32;

/// The end cells of one start cell's samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    /// Distinct end cells, ascending, with the end of their stretch in `groups`; [`SINK`] comes last.
    pub(super) destinations: Vec<(u32, u32)>,
    /// Group of every sample, ordered by end cell and group.
    pub(super) groups: Vec<u8>,
    /// Mean square displacement by spreading a sample evenly over its end cell, an axis; samples in the sink
    /// are left out.
    pub(super) spreading: [f64; MAX_DIMENSION],
}

impl Column {
    /// Each destination with its samples' groups, ascending.
    pub(super) fn entries(&self) -> impl Iterator<Item = (u32, &[u8])> {
        let starts = std::iter::once(0).chain(self.destinations.iter().map(|entry| entry.1));
        let stretch = |(&(cell, end), start): (&(u32, u32), u32)| {
            (cell, &self.groups[start as usize..end as usize])
        };
        self.destinations.iter().zip(starts).map(stretch)
    }
}

/// Samples one column after another.
pub(super) struct ColumnSampler<'a> {
    space: &'a CellSpace,
    options: &'a SamplingOptions,
    steps: usize,
    stepper: Stepper<'a>,
    lattice: StartLattice,
    /// First sample of each group, and the number of samples at the end.
    group_starts: Vec<usize>,
}

impl<'a> ColumnSampler<'a> {
    pub(super) fn new(
        system: &'a dyn System,
        space: &'a CellSpace,
        options: &'a SamplingOptions,
    ) -> Self {
        let steps = options.steps();
        let time_step = options.map_step / steps as f64;
        let groups = options.groups;
        // Groups end at even samples where they can, so that mirror images stay together.
        let start = |group: usize| match group {
            0 => 0,
            _ if group == groups => options.samples,
            _ if options.samples < 2 * groups => group * options.samples / groups,
            _ => (group * options.samples / groups) & !1,
        };
        let group_starts: Vec<usize> = (0..=groups).map(start).collect();
        let sizes = group_starts.windows(2).map(|pair| pair[1] - pair[0]);
        let largest = sizes.max().unwrap_or(1);
        Self {
            space,
            options,
            steps,
            stepper: Stepper::new(system, options.integrator, time_step),
            lattice: StartLattice::new(largest, space.dimension()),
            group_starts,
        }
    }

    /// Runs the trajectories of one cell. Depends on the cell's number and the options alone.
    pub(super) fn column(&self, cell: usize) -> Column {
        let dimension = self.space.dimension();
        let mut ends: Vec<(u32, u8)> = Vec::with_capacity(self.options.samples);
        let mut spreading = [0.0; MAX_DIMENSION];
        let mut states = [[0.0; LANES]; MAX_DIMENSION];
        let mut group = 0;
        for block in 0..self.options.samples.div_ceil(LANES) {
            let first = block * LANES;
            let count = LANES.min(self.options.samples - first);
            let mut groups = [0; LANES];
            for (lane, of_lane) in groups.iter_mut().enumerate().take(count) {
                while first + lane >= self.group_starts[group + 1] {
                    group += 1;
                }
                *of_lane = group;
            }
            self.place_starts(cell, first, &groups, &mut states[..dimension]);
            let mut stream = NormalStream::new(self.key(cell, block as u64));
            self.stepper
                .advance(&mut states[..dimension], 0, self.steps, &mut stream);
            for (lane, &of_lane) in groups.iter().enumerate().take(count) {
                let end = self.find_end(lane, &states[..dimension], &mut spreading);
                ends.push((end, of_lane as u8));
            }
        }
        compress(ends, spreading)
    }

    fn key(&self, cell: usize, block: u64) -> StreamKey {
        StreamKey {
            seed: self.options.seed,
            cell: cell as u64,
            block,
        }
    }

    /// Starts of a batch. Lanes past the last sample start in group 0 and are not counted.
    fn place_starts(&self, cell: usize, first: usize, groups: &[usize], states: &mut [Lanes]) {
        let (mut group, mut key) = (usize::MAX, 0);
        for (lane, &of_lane) in groups.iter().enumerate() {
            if of_lane != group {
                group = of_lane;
                key = self.key(cell, START_BLOCK + group as u64).word();
            }
            let sample = (first + lane) - self.group_starts[group];
            for (axis, lanes) in states.iter_mut().enumerate() {
                let edges = &self.space.axes()[axis];
                let position = self.space.position(cell, axis);
                let inside = self.lattice.coordinate(key, sample, axis);
                lanes[lane] = edges.edges()[position] + edges.width(position) * inside;
            }
        }
    }

    /// End cell of one lane; adds to `spreading` the mean square distance of a point spread over that cell.
    fn find_end(&self, lane: usize, states: &[Lanes], spreading: &mut [f64]) -> u32 {
        let mut state = [0.0; MAX_DIMENSION];
        for (value, lanes) in state.iter_mut().zip(states) {
            *value = lanes[lane];
        }
        let state = &state[..states.len()];
        let Some(end) = self.space.find(state) else {
            return SINK;
        };
        for (axis, edges) in self.space.axes().iter().enumerate() {
            let position = self.space.position(end, axis);
            let off = state[axis] - edges.centre(position);
            let width = edges.width(position);
            spreading[axis] += off * off + width * width / 12.0;
        }
        end as u32
    }
}

fn compress(mut ends: Vec<(u32, u8)>, mut spreading: [f64; MAX_DIMENSION]) -> Column {
    ends.sort_unstable();
    let mut destinations: Vec<(u32, u32)> = Vec::new();
    for (index, &(cell, _)) in ends.iter().enumerate() {
        let end = index as u32 + 1;
        match destinations.last_mut() {
            Some(last) if last.0 == cell => last.1 = end,
            _ => destinations.push((cell, end)),
        }
    }
    let inside = ends.partition_point(|&(cell, _)| cell != SINK);
    for sum in &mut spreading {
        *sum /= inside.max(1) as f64;
    }
    destinations.shrink_to_fit();
    Column {
        destinations,
        groups: ends.into_iter().map(|(_, group)| group).collect(),
        spreading,
    }
}
