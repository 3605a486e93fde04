//! One cell's trajectories: where they end, by group, and the numerical diffusion they show.

use super::SamplingOptions;
use super::end_moments::EndMoments;
use super::integrator::Stepper;
use super::lookup::CellLookup;
use super::order::sort_by_cell;
use super::phase::PhaseStep;
use super::random::{NormalStream, OnLines, StreamKey};
use super::starts::{StartLattice, shift};
use crate::MAX_DIMENSION;
use crate::cancellation::{Cancellation, Cancelled};
use crate::space::{Axis, CellSpace};
use crate::system::{LANES, Lanes, System};

/// Number that stands for the sink among destinations: cells are numbered below it.
pub(super) const SINK: u32 = u32::MAX;

/// Blocks of this number and above key what is not a batch of trajectories.
const START_BLOCK: u64 = 1 << 32;

/// The end cells of one start cell's samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    /// Distinct end cells, ascending; [`SINK`] comes last.
    pub(super) destinations: Vec<u32>,
    /// Samples in each of them.
    pub(super) counts: Vec<u32>,
    /// Σ over the samples in each of them of where they started in their cell, a value an axis, from -½ to ½ of its
    /// width. Empty unless starts are kept.
    pub(super) starts: Vec<f32>,
    /// The same of the samples of each group.
    pub(super) groups: Vec<Shares>,
    /// Number of samples.
    pub(super) samples: usize,
    /// Moments of the end points of the samples that did not end in the sink; empty unless starts are kept.
    pub(super) ends: Vec<EndMoments>,
    /// Mean square displacement by spreading a sample evenly over its end cell, an axis; samples in the sink
    /// are left out.
    pub(super) spreading: [f64; MAX_DIMENSION],
}

/// Samples of a group by the end cells that they share.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Shares {
    /// Place among the column's end cells, ascending, and number of samples.
    pub(super) counts: Vec<(u32, u32)>,
    /// As those of the column, in the order of `counts`.
    pub(super) starts: Vec<f32>,
}

impl Column {
    /// Whether it is known where samples started.
    pub(super) fn keeps_starts(&self) -> bool {
        !self.starts.is_empty()
    }

    /// Forgets where samples started.
    #[cfg(test)]
    pub(super) fn forget_starts(&mut self) {
        self.starts.clear();
        self.groups
            .iter_mut()
            .for_each(|shares| shares.starts.clear());
        self.ends.clear();
    }
}

/// Samples one column after another.
pub(super) struct ColumnSampler<'a> {
    space: &'a CellSpace,
    options: &'a SamplingOptions,
    steps: usize,
    stepper: Stepper<'a>,
    lattice: StartLattice,
    lookup: CellLookup,
    phase: Option<PhaseStep>,
    /// Middle of each cell and a twelfth of the square of its width, along each axis on which mass is spread.
    spread: Vec<Vec<(f64, f64)>>,
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
        let spread_of = |axis: &Axis| -> Vec<(f64, f64)> {
            let cells = 0..axis.count();
            cells
                .map(|cell| {
                    (
                        axis.centre(cell),
                        axis.width(cell) * axis.width(cell) / 12.0,
                    )
                })
                .collect()
        };
        Self {
            space,
            options,
            steps,
            spread: space.axes()[..spread].iter().map(spread_of).collect(),
            stepper: stepper.within_a_turn(),
            lattice: StartLattice::new(largest, spread),
            lookup: CellLookup::new(space),
            phase,
            group_starts,
        }
    }

    /// Runs the trajectories of one cell. Depends on the cell's number and the options alone.
    pub(super) fn column(&self, cell: usize) -> Result<Column, Cancelled> {
        let dimension = self.space.dimension();
        let samples = self.options.samples;
        let mut ends: Vec<u64> = Vec::with_capacity(samples);
        let (mut found, mut positions) = ([0; LANES], [[0; LANES]; MAX_DIMENSION]);
        let keeps = self.options.keep_starts;
        let mut starts: Vec<[f32; MAX_DIMENSION]> =
            Vec::with_capacity(if keeps { samples } else { 0 });
        let mut moments = vec![EndMoments::default(); if keeps { dimension } else { 0 }];
        let mut offsets = [[0.0; LANES]; MAX_DIMENSION];
        let mut spreading = [0.0; MAX_DIMENSION];
        let mut states = OnLines([[0.0; LANES]; MAX_DIMENSION]);
        let states = &mut states.0[..dimension];
        let mut stream = NormalStream::new(self.key(cell, 0));
        for block in 0..samples.div_ceil(LANES) {
            let first = block * LANES;
            let count = LANES.min(samples - first);
            self.place_starts(cell, (first, count), states, &mut offsets);
            stream.restart(self.key(cell, block as u64));
            self.stepper.enter(states);
            self.stepper.advance(states, 0, self.steps, &mut stream)?;
            let mut seen = self.stepper.seen(states);
            if let Some(phase) = &self.phase {
                let end = phase.end(self.space.position(cell, phase.axis));
                phase.put(seen.to_mut(), self.space, end);
            }
            self.lookup
                .find_positions(&seen, &mut found, &mut positions);
            let sink = self.lookup.n_cells();
            let inside = (0..count).filter(|&lane| found[lane] != sink);
            for lane in inside.clone() {
                for (axis, cells) in self.spread.iter().enumerate() {
                    let (centre, own) = cells[positions[axis][lane]];
                    let off = seen[axis][lane] - centre;
                    spreading[axis] += off * off + own;
                }
            }
            let numbered = found[..count].iter().zip(first as u64..);
            ends.extend(numbered.map(|(&cell, sample)| (cell as u64) << 32 | sample));
            if keeps {
                let start = |lane: usize| std::array::from_fn(|axis| offsets[axis][lane] as f32);
                starts.extend((0..count).map(start));
                let of_block = &starts[first..];
                let are_all_inside = inside.clone().count() == count;
                for (moments, (axis, lanes)) in moments
                    .iter_mut()
                    .zip(self.space.axes().iter().zip(seen.iter()))
                {
                    if are_all_inside {
                        moments.add(axis, &lanes[..count], of_block);
                        continue;
                    }
                    for lane in inside.clone() {
                        moments.add(axis, &[lanes[lane]], &of_block[lane..=lane]);
                    }
                }
            }
        }
        let mut column = self.compress(ends, spreading, &starts);
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

    /// Starts of a batch. Lanes past the last sample start in the middle and are not counted.
    fn place_starts(
        &self,
        cell: usize,
        (first, count): (usize, usize),
        states: &mut [Lanes],
        offsets: &mut [Lanes; MAX_DIMENSION],
    ) {
        let begun = self.group_starts.partition_point(|&start| start <= first);
        let (mut group, mut lane) = (begun - 1, 0);
        while lane < count {
            let until = self.group_starts[group + 1].min(first + count) - first;
            let of_group = shift(self.key(cell, START_BLOCK + group as u64).word());
            let sample = first + lane - self.group_starts[group];
            let spread = offsets.iter_mut().take(self.spread.len());
            for (axis, lanes) in spread.enumerate() {
                let lanes = &mut lanes[lane..until];
                self.lattice.place(&of_group, sample, axis, lanes);
            }
            (group, lane) = (group + 1, until);
        }
        for lanes in offsets.iter_mut() {
            lanes[count..].fill(0.5);
        }
        for (axis, lanes) in states.iter_mut().enumerate() {
            let edges = &self.space.axes()[axis];
            let position = self.space.position(cell, axis);
            let (from, width) = (edges.edges()[position], edges.width(position));
            if axis >= self.spread.len() {
                lanes.fill(from);
                continue;
            }
            for (x, offset) in lanes.iter_mut().zip(&mut offsets[axis]) {
                *x = from + width * *offset;
                *offset -= 0.5;
            }
        }
    }

    /// The column of samples that are numbered by end cell and sample.
    fn compress(
        &self,
        mut ends: Vec<u64>,
        mut spreading: [f64; MAX_DIMENSION],
        starts: &[[f32; MAX_DIMENSION]],
    ) -> Column {
        let sink = self.lookup.n_cells();
        sort_by_cell(&mut ends, &mut Vec::new(), sink);
        let cell_of = |end: &u64| (end >> 32) as u32;
        let sample_of = |end: &u64| (end & u64::from(u32::MAX)) as usize;
        let inside = ends.partition_point(|end| cell_of(end) != sink as u32);
        for sum in &mut spreading {
            *sum /= inside.max(1) as f64;
        }
        let (mut destinations, mut counts, mut all_starts) = (Vec::new(), Vec::new(), Vec::new());
        let mut groups = vec![Shares::default(); self.group_starts.len() - 1];
        for of_cell in ends.chunk_by(|a, b| cell_of(a) == cell_of(b)) {
            let place = destinations.len() as u32;
            let cell = cell_of(&of_cell[0]);
            destinations.push(if cell == sink as u32 { SINK } else { cell });
            counts.push(of_cell.len() as u32);
            let (mut rest, mut sums) = (of_cell, [0.0; MAX_DIMENSION]);
            // In this order samples of a cell are ordered by their groups too.
            for (group, shares) in groups.iter_mut().enumerate() {
                if rest.is_empty() {
                    break;
                }
                let until = self.group_starts[group + 1];
                let count = rest.partition_point(|end| sample_of(end) < until);
                let (here, others) = rest.split_at(count);
                rest = others;
                if !here.is_empty() {
                    let started = here.iter().filter_map(|end| starts.get(sample_of(end)));
                    self.add_share(shares, (place, count as u32), started, &mut sums);
                }
            }
            if !starts.is_empty() {
                all_starts.extend(&sums[..self.space.dimension()]);
            }
        }
        for shares in &mut groups {
            shares.counts.shrink_to_fit();
            shares.starts.shrink_to_fit();
        }
        Column {
            destinations,
            counts,
            starts: all_starts,
            groups,
            samples: ends.len(),
            ends: Vec::new(),
            spreading,
        }
    }

    /// Adds samples of one group that ended in one cell, and where they started to `sums`.
    fn add_share<'b>(
        &self,
        shares: &mut Shares,
        count: (u32, u32),
        started: impl Iterator<Item = &'b [f32; MAX_DIMENSION]>,
        sums: &mut [f32; MAX_DIMENSION],
    ) {
        shares.counts.push(count);
        let (mut own, mut is_kept) = ([0.0; MAX_DIMENSION], false);
        for start in started {
            is_kept = true;
            for (own, start) in own.iter_mut().zip(start) {
                *own += start;
            }
        }
        if is_kept {
            shares.starts.extend(&own[..self.space.dimension()]);
            for (sum, own) in sums.iter_mut().zip(own) {
                *sum += own;
            }
        }
    }
}
