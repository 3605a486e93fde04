//! One cell's trajectories: where they end, by group, and the numerical diffusion they show.

use super::SamplingOptions;
use super::integrator::Stepper;
use super::phase::PhaseStep;
use super::random::{NormalStream, StreamKey};
use super::starts::StartLattice;
use crate::MAX_DIMENSION;
use crate::cancellation::{Cancellation, Cancelled};
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
    /// Σ over the samples of an end cell and group of where they started in their cell, a value an axis, from -½ to ½
    /// of its width; in the order of `groups`. Empty unless starts are kept.
    pub(super) starts: Vec<f32>,
    /// Moments of the end points of the samples that did not end in the sink; empty unless starts are kept.
    pub(super) ends: Vec<EndMoments>,
    /// Mean square displacement by spreading a sample evenly over its end cell, an axis; samples in the sink
    /// are left out.
    pub(super) spreading: [f64; MAX_DIMENSION],
}

/// Sums over samples of one axis of their end points, plain and times where they started: what is needed to know
/// moments one map step after any density that is linear in the cell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct EndMoments {
    /// Σ x and Σ x².
    pub(super) plain: [f64; 2],
    /// Σ x u_b and Σ x² u_b, u_b where the sample started along axis b.
    pub(super) by_start: [[f64; 2]; MAX_DIMENSION],
    /// Σ 1.
    pub(super) count: f64,
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
    phase: Option<PhaseStep>,
    /// First sample of each group, and the number of samples at the end.
    group_starts: Vec<usize>,
}

impl<'a> ColumnSampler<'a> {
    pub(super) fn new(
        system: &'a dyn System,
        space: &'a CellSpace,
        options: &'a SamplingOptions,
        phase: Option<PhaseStep>,
        cancellation: &Cancellation,
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
        let stepper = Stepper::new(system, options.integrator, time_step, cancellation);
        // Nothing is spread along the phase, which is the last axis.
        let spread = space.dimension() - usize::from(phase.is_some());
        Self {
            space,
            options,
            steps,
            stepper: stepper.within_a_turn(),
            lattice: StartLattice::new(largest, spread),
            phase,
            group_starts,
        }
    }

    /// Runs the trajectories of one cell. Depends on the cell's number and the options alone.
    pub(super) fn column(&self, cell: usize) -> Result<Column, Cancelled> {
        let dimension = self.space.dimension();
        let mut ends: Vec<End> = Vec::with_capacity(self.options.samples);
        let keeps = self.options.keep_starts;
        let mut starts: Vec<[f32; MAX_DIMENSION]> = Vec::new();
        let mut moments = vec![EndMoments::default(); if keeps { dimension } else { 0 }];
        let mut offsets = [[0.0; LANES]; MAX_DIMENSION];
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
            self.place_starts(cell, first, &groups, &mut states[..dimension], &mut offsets);
            let mut stream = NormalStream::new(self.key(cell, block as u64));
            self.stepper
                .advance(&mut states[..dimension], 0, self.steps, &mut stream)?;
            if let Some(phase) = &self.phase {
                let end = phase.end(self.space.position(cell, phase.axis));
                phase.put(&mut states[..dimension], self.space, end);
            }
            for (lane, &of_lane) in groups.iter().enumerate().take(count) {
                let end = self.find_end(lane, &states[..dimension], &mut spreading);
                ends.push((end, of_lane as u8, (first + lane) as u32));
                if keeps {
                    let start = offsets.map(|axis: Lanes| axis[lane] as f32);
                    starts.push(start);
                    if end != SINK {
                        add_moments(&mut moments, &states[..dimension], lane, &start);
                    }
                }
            }
        }
        let mut column = compress(ends, spreading, &starts, dimension);
        column.ends = moments;
        Ok(column)
    }

    fn key(&self, cell: usize, block: u64) -> StreamKey {
        StreamKey {
            seed: self.options.seed,
            cell: cell as u64,
            block,
        }
    }

    /// Starts of a batch. Lanes past the last sample start in group 0 and are not counted.
    fn place_starts(
        &self,
        cell: usize,
        first: usize,
        groups: &[usize],
        states: &mut [Lanes],
        offsets: &mut [Lanes; MAX_DIMENSION],
    ) {
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
                if self.phase.is_some_and(|phase| phase.axis == axis) {
                    lanes[lane] = edges.edges()[position];
                    continue;
                }
                let inside = self.lattice.coordinate(key, sample, axis);
                lanes[lane] = edges.edges()[position] + edges.width(position) * inside;
                offsets[axis][lane] = inside - 0.5;
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
        let phase = self.phase.map(|phase| phase.axis);
        let axes = self.space.axes().iter().enumerate();
        for (axis, edges) in axes.filter(|(axis, _)| phase != Some(*axis)) {
            let position = self.space.position(end, axis);
            let off = state[axis] - edges.centre(position);
            let width = edges.width(position);
            spreading[axis] += off * off + width * width / 12.0;
        }
        end as u32
    }
}

/// End cell, group and number of a sample.
type End = (u32, u8, u32);

fn add_moments(
    moments: &mut [EndMoments],
    states: &[Lanes],
    lane: usize,
    start: &[f32; MAX_DIMENSION],
) {
    for (moments, lanes) in moments.iter_mut().zip(states) {
        let x = lanes[lane];
        moments.plain[0] += x;
        moments.plain[1] += x * x;
        for (sums, &start) in moments.by_start.iter_mut().zip(start) {
            sums[0] += x * f64::from(start);
            sums[1] += x * x * f64::from(start);
        }
        moments.count += 1.0;
    }
}

fn compress(
    mut ends: Vec<End>,
    mut spreading: [f64; MAX_DIMENSION],
    starts: &[[f32; MAX_DIMENSION]],
    dimension: usize,
) -> Column {
    ends.sort_unstable();
    let mut destinations: Vec<(u32, u32)> = Vec::new();
    for (index, &(cell, ..)) in ends.iter().enumerate() {
        let end = index as u32 + 1;
        match destinations.last_mut() {
            Some(last) if last.0 == cell => last.1 = end,
            _ => destinations.push((cell, end)),
        }
    }
    let inside = ends.partition_point(|&(cell, ..)| cell != SINK);
    for sum in &mut spreading {
        *sum /= inside.max(1) as f64;
    }
    destinations.shrink_to_fit();
    let mut sums: Vec<f32> = Vec::new();
    if !starts.is_empty() {
        for run in ends.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let of_run = run.iter().map(|end| &starts[end.2 as usize]);
            sums.extend(
                (0..dimension).map(|axis| of_run.clone().map(|start| start[axis]).sum::<f32>()),
            );
        }
        sums.shrink_to_fit();
    }
    Column {
        destinations,
        groups: ends.into_iter().map(|(_, group, _)| group).collect(),
        starts: sums,
        ends: Vec::new(),
        spreading,
    }
}
