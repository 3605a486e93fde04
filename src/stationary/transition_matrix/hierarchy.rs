//! Coarser and coarser copies of a chain: neighbouring cells are lumped, two an axis, and the transition
//! probabilities between lumps follow from the current masses inside them.
//!
//! States are numbered along a Morton curve, so that the members of a lump are consecutive on every level.

use std::ops::Range;

use rayon::prelude::*;

use super::chain::Chain;
use crate::space::CellSpace;

/// Chains up to this size are solved by elimination.
const COARSEST: usize = 64;

/// Lumps that one task handles.
const LUMPS_A_TASK: usize = 512;

/// Marks a transition inside a lump.
const INSIDE: u32 = u32::MAX;

/// The Morton curve through the cells of a space.
pub(super) struct Curve<'a> {
    space: &'a CellSpace,
    /// The axes whose positions are interleaved.
    lumped: Vec<usize>,
    /// The phase of a forcing, and the place of its first bit.
    phase: Option<(usize, usize)>,
}

impl<'a> Curve<'a> {
    /// Cells at different phases are lumped last, when all cells at one phase are a single lump: what goes round does
    /// not die out by smoothing, and is found exactly where it is kept apart down to the coarsest chain.
    pub(super) fn new(space: &'a CellSpace, phase: Option<usize>) -> Self {
        let lumped = (0..space.dimension()).filter(|&axis| phase != Some(axis));
        let lumped: Vec<usize> = lumped.collect();
        let bits = |&axis: &usize| space.axes()[axis].count().next_power_of_two().ilog2();
        let most = lumped.iter().map(bits).max().unwrap_or(0) as usize;
        Self {
            space,
            phase: phase.map(|axis| (axis, most * lumped.len())),
            lumped,
        }
    }

    /// Axes whose bits are interleaved: one level coarser is a shift by so many bits.
    pub(super) fn axes(&self) -> usize {
        self.lumped.len().max(1)
    }

    /// Number of cells of the space.
    pub(super) fn cells(&self) -> usize {
        self.space.n_cells()
    }

    /// The phase of each of some cells by its number; none without a forcing.
    pub(super) fn phases(&self, cells: impl Iterator<Item = usize>) -> Vec<usize> {
        let of = |axis| cells.map(|cell| self.space.position(cell, axis)).collect();
        self.phase.map_or_else(Vec::new, |(axis, _)| of(axis))
    }

    /// Place of a cell on the curve: the bits of its positions interleaved.
    pub(super) fn place(&self, cell: usize) -> u128 {
        let axes = self.lumped.len();
        let mut key = 0;
        for (index, &axis) in self.lumped.iter().enumerate() {
            let position = self.space.position(cell, axis) as u128;
            for bit in 0..u128::BITS as usize / axes {
                key |= (position >> bit & 1) << (bit * axes + axes - 1 - index);
            }
        }
        let phase = self.phase.map(|(axis, first)| {
            let position = self.space.position(cell, axis) as u128;
            position << first
        });
        key | phase.unwrap_or(0)
    }
}

/// One level of the hierarchy.
pub(super) struct Level {
    /// The chain; below the finest level its values follow from the masses of the level above.
    pub(super) chain: Chain,
    /// Current masses, Σ = 1.
    pub(super) mass: Vec<f64>,
    /// How the next level lumps this one; `None` on the coarsest.
    pub(super) lumping: Option<Lumping>,
}

/// How the states of a level are lumped.
pub(super) struct Lumping {
    /// `members[I]..members[I + 1]` are the states of lump I.
    pub(super) members: Vec<usize>,
    /// For each transition of the level, in order, the entry of the coarse chain it adds to, counted from the
    /// start of the coarse row; or `INSIDE`.
    entries: Vec<u32>,
}

/// The hierarchy of a chain whose states have ascending Morton keys.
pub(super) fn levels(chain: Chain, mut keys: Vec<u128>, axes: usize) -> Vec<Level> {
    let mut levels = Vec::new();
    let mut fine = chain;
    while fine.len() > COARSEST {
        keys.iter_mut().for_each(|key| *key >>= axes);
        let mut members: Vec<usize> = (0..keys.len())
            .filter(|&state| state == 0 || keys[state] != keys[state - 1])
            .collect();
        keys.dedup();
        members.push(fine.len());
        let (lumping, coarse) = Lumping::new(&fine, members);
        levels.push(Level {
            mass: vec![0.0; fine.len()],
            chain: fine,
            lumping: Some(lumping),
        });
        fine = coarse;
    }
    levels.push(Level {
        mass: vec![0.0; fine.len()],
        chain: fine,
        lumping: None,
    });
    levels
}

/// The pattern of some rows of a coarse chain.
struct Pattern {
    /// Entries of each row.
    lengths: Vec<usize>,
    columns: Vec<u32>,
    /// Of every entry of the fine rows, which entry of its coarse row it goes to.
    entries: Vec<u32>,
}

impl Pattern {
    fn of(fine: &Chain, members: &[usize], lump_of: &[u32], rows: Range<usize>) -> Self {
        let (mut lengths, mut columns, mut entries) = (Vec::new(), Vec::new(), Vec::new());
        let mut found = vec![(INSIDE, 0u32); members.len() - 1];
        for lump in rows {
            let before = columns.len();
            let range = fine.starts[members[lump]]..fine.starts[members[lump + 1]];
            for &from in &fine.columns[range] {
                let source = lump_of[from as usize];
                let (row, entry) = &mut found[source as usize];
                if source as usize == lump {
                    entries.push(INSIDE);
                    continue;
                }
                if *row != lump as u32 {
                    (*row, *entry) = (lump as u32, (columns.len() - before) as u32);
                    columns.push(source);
                }
                entries.push(*entry);
            }
            lengths.push(columns.len() - before);
        }
        Self {
            lengths,
            columns,
            entries,
        }
    }
}

impl Lumping {
    /// Finds the pattern of the coarse chain; its values are left at zero.
    fn new(fine: &Chain, members: Vec<usize>) -> (Self, Chain) {
        let lumps = members.len() - 1;
        let mut lump_of = vec![0u32; fine.len()];
        for lump in 0..lumps {
            lump_of[members[lump]..members[lump + 1]].fill(lump as u32);
        }
        let tasks: Vec<usize> = (0..lumps).step_by(LUMPS_A_TASK).collect();
        let parts: Vec<Pattern> = tasks
            .par_iter()
            .map(|&first| {
                let last = (first + LUMPS_A_TASK).min(lumps);
                Pattern::of(fine, &members, &lump_of, first..last)
            })
            .collect();
        let mut coarse = Chain {
            starts: vec![0],
            escape: vec![0.0; lumps],
            leaving: vec![0.0; lumps],
            ..Chain::default()
        };
        let mut entries = Vec::with_capacity(fine.columns.len());
        let mut end = 0;
        for part in parts {
            for length in part.lengths {
                end += length;
                coarse.starts.push(end);
            }
            coarse.columns.extend(part.columns);
            entries.extend(part.entries);
        }
        coarse.values = vec![0.0; end];
        (Self { members, entries }, coarse)
    }

    /// Sets the coarse chain and its masses from the masses of the fine one: the exact lumped chain where the
    /// masses inside lumps have steady proportions. One pass over the fine transitions.
    pub(super) fn project(&self, fine: &Chain, mass: &[f64], coarse: &mut Level) {
        let lumps = coarse.chain.len();
        for lump in 0..lumps {
            let states = self.members[lump]..self.members[lump + 1];
            let total: f64 = mass[states.clone()].iter().sum();
            let escaping: f64 = states.map(|state| fine.escape[state] * mass[state]).sum();
            coarse.mass[lump] = total;
            coarse.chain.escape[lump] = escaping / total;
        }
        let chain = &mut coarse.chain;
        let totals = &coarse.mass;
        let mut tasks = Vec::new();
        let mut rest = chain.values.as_mut_slice();
        for first in (0..lumps).step_by(LUMPS_A_TASK) {
            let last = (first + LUMPS_A_TASK).min(lumps);
            let (values, others) = rest.split_at_mut(chain.starts[last] - chain.starts[first]);
            tasks.push((first, last, values));
            rest = others;
        }
        tasks.into_par_iter().for_each(|(first, last, values)| {
            values.fill(0.0);
            let offset = chain.starts[first];
            for lump in first..last {
                let row = &mut values[chain.starts[lump] - offset..chain.starts[lump + 1] - offset];
                let range = fine.starts[self.members[lump]]..fine.starts[self.members[lump + 1]];
                let sources = fine.columns[range.clone()].iter();
                let flows = sources.zip(&fine.values[range.clone()]);
                for ((&from, value), &entry) in flows.zip(&self.entries[range]) {
                    if entry != INSIDE {
                        row[entry as usize] += value * mass[from as usize];
                    }
                }
                let columns = &chain.columns[chain.starts[lump]..chain.starts[lump + 1]];
                for (value, &source) in row.iter_mut().zip(columns) {
                    *value /= totals[source as usize];
                }
            }
        });
        chain.leaving.copy_from_slice(&chain.escape);
        for (value, &source) in chain.values.iter().zip(&chain.columns) {
            chain.leaving[source as usize] += value;
        }
    }
}
