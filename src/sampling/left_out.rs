//! What a cell map without one group of its samples does otherwise, to first order: how much more mass it sends to
//! each cell, and what the map makes of a small change of masses.
//!
//! With masses p, slopes s and the sums n_ij and T_ija over the samples from cell j to cell i, one each and where
//! they started along axis a, the map sends p_j (n_ij + Σ_a T_ija s_ja) / W_j, W_j being the sum over i. Slopes
//! times masses, p_j s_ja, are linear in the masses but where slopes are shortened; there their ratio is taken to
//! stay. So the change of what is sent has the coefficients that [`Sent`] holds for each cell. Groups are worked on
//! four at a time: numbers of samples are then read once for all of them.

use multiversion::multiversion;

use super::column::{Column, SINK};
use super::slopes::{are_shortened, slope_of_masses, strides};
use super::transition::SampledTransitions;
use crate::MAX_DIMENSION;
use crate::space::CellSpace;

/// Groups that are worked on at once.
pub(crate) const GROUPS_AT_ONCE: usize = 4;

/// A number of each of the groups that are worked on at once.
pub(crate) type OfGroups = [f64; GROUPS_AT_ONCE];

/// The cell map beside a steady state.
pub(crate) struct Linearised<'a> {
    transitions: &'a SampledTransitions,
    columns: Vec<Weighed>,
    /// Masses of the sampled cells.
    mass: Vec<f64>,
    slopes: &'a [[f64; MAX_DIMENSION]],
    /// What changes slopes, an axis of every cell; empty where slopes are not corrected.
    of_slopes: Vec<[(u32, f64); 2]>,
}

/// Sums over all samples of a cell.
struct Weighed {
    /// Σ of the weights.
    total: f64,
    /// Σ of the starts, an axis.
    starts: [f64; MAX_DIMENSION],
}

/// What a cell sends to each other: so much for each sample that ended there, and for where it started along each
/// axis.
struct Sent {
    plain: OfGroups,
    tilted: [OfGroups; MAX_DIMENSION],
}

impl SampledTransitions {
    /// The map beside the masses of all cells, with the slopes of the sampled cells where these follow the masses.
    pub(crate) fn linearised<'a>(
        &'a self,
        space: &CellSpace,
        mass: &[f64],
        slopes: &'a [[f64; MAX_DIMENSION]],
        is_corrected: bool,
    ) -> Linearised<'a> {
        let is_corrected = is_corrected && self.keeps_starts();
        let weighed = |(column, slope): (&Column, &[f64; MAX_DIMENSION])| {
            self.weighed(&column.counts, &column.starts, slope)
        };
        let mut linearised = Linearised {
            transitions: self,
            columns: self.columns.iter().zip(slopes).map(weighed).collect(),
            mass: self.cells.iter().map(|&cell| mass[cell]).collect(),
            slopes,
            of_slopes: Vec::new(),
        };
        if is_corrected {
            linearised.of_slopes = linearised.slopes_of_masses(space);
        }
        linearised
    }

    fn weighed(&self, counts: &[u32], starts: &[f32], slope: &[f64; MAX_DIMENSION]) -> Weighed {
        let mut sums = [0.0; MAX_DIMENSION];
        for of_end in starts.chunks_exact(self.dimension) {
            for (sum, &start) in sums.iter_mut().zip(of_end) {
                *sum += f64::from(start);
            }
        }
        let count: f64 = counts.iter().map(|&count| f64::from(count)).sum();
        let tilted: f64 = sums.iter().zip(slope).map(|(sum, slope)| sum * slope).sum();
        Weighed {
            total: count + tilted,
            starts: sums,
        }
    }
}

impl Linearised<'_> {
    /// Masses that the change is of.
    pub(crate) fn mass(&self) -> &[f64] {
        &self.mass
    }

    fn slopes_of_masses(&self, space: &CellSpace) -> Vec<[(u32, f64); 2]> {
        let (cells, dimension) = (&self.transitions.cells, self.transitions.dimension);
        let mut places = vec![SINK; space.n_cells()];
        for (place, &cell) in cells.iter().enumerate() {
            places[cell] = place as u32;
        }
        let strides = strides(space);
        let mut all = Vec::with_capacity(cells.len() * dimension);
        for (j, &cell) in cells.iter().enumerate() {
            let stays = self.mass[j] <= 0.0 || are_shortened(&self.slopes[j]);
            for (axis, &stride) in strides.iter().enumerate() {
                let of_axis = match stays || self.transitions.phase == Some(axis) {
                    true => [(SINK, 0.0); 2],
                    false => slope_of_masses(space, cell, axis, stride)
                        .map(|(cell, weight)| (places[cell], weight)),
                };
                all.push(of_axis);
            }
        }
        all
    }

    /// What the map makes of changes of the masses of the sampled cells.
    pub(crate) fn apply(&self, change: &[OfGroups]) -> Vec<OfGroups> {
        self.send(|j| {
            let (column, slope) = (&self.columns[j], &self.slopes[j]);
            let dimension = self.transitions.dimension;
            let mut more = [[0.0; GROUPS_AT_ONCE]; MAX_DIMENSION];
            let mut plain = change[j];
            let of_slopes = self.of_slopes.chunks_exact(dimension).nth(j);
            for (axis, [above, below]) in of_slopes.into_iter().flatten().enumerate() {
                if above.0 == SINK && below.0 == SINK {
                    continue;
                }
                let of = |cell: u32| change.get(cell as usize).unwrap_or(&[0.0; GROUPS_AT_ONCE]);
                let (upper, lower) = (of(above.0), of(below.0));
                for group in 0..GROUPS_AT_ONCE {
                    let tilt = above.1 * upper[group] + below.1 * lower[group];
                    let own = tilt - slope[axis] * change[j][group];
                    more[axis][group] = own;
                    plain[group] -= own * column.starts[axis] / column.total;
                }
            }
            let scale = 1.0 / column.total;
            let plain = plain.map(|value| value * scale);
            let mut tilted = [[0.0; GROUPS_AT_ONCE]; MAX_DIMENSION];
            for axis in 0..dimension {
                for group in 0..GROUPS_AT_ONCE {
                    tilted[axis][group] = slope[axis] * plain[group] + more[axis][group] * scale;
                }
            }
            Sent { plain, tilted }
        })
    }

    /// By how much more the map without each of some groups sends to the sampled cells than the map of all samples.
    /// Groups beyond the last one change nothing.
    pub(crate) fn without(&self, first: usize) -> Vec<OfGroups> {
        let all = &self.transitions.columns;
        let groups = first..self.transitions.groups.min(first + GROUPS_AT_ONCE);
        // p_j (P_ij W^g - w^g_ij) / (W - W^g), with the weights w^g of a group: first for all, then for its own
        // samples.
        let of_group = |j: usize, number: usize| {
            let (column, group) = (&all[j], &all[j].groups[groups.start + number]);
            let (mut counts, mut tilted) = (0.0, 0.0);
            for (share, &(_, count)) in group.counts.iter().enumerate() {
                counts += f64::from(count);
                tilted += self.tilt(column, &group.starts, share, j);
            }
            let weight = counts + tilted;
            (weight, self.mass[j] / (self.columns[j].total - weight))
        };
        let mut sent = self.send(|j| {
            let mut plain = [0.0; GROUPS_AT_ONCE];
            for (number, plain) in plain.iter_mut().enumerate().take(groups.len()) {
                let (weight, scale) = of_group(j, number);
                *plain = scale * weight / self.columns[j].total;
            }
            let tilted = self.slopes[j].map(|slope| plain.map(|value| slope * value));
            Sent { plain, tilted }
        });
        for (j, column) in all.iter().enumerate() {
            for (number, group) in column.groups[groups.clone()].iter().enumerate() {
                let (_, scale) = of_group(j, number);
                for (share, &(place, count)) in group.counts.iter().enumerate() {
                    let end = column.destinations[place as usize];
                    if end != SINK {
                        let weight = f64::from(count) + self.tilt(column, &group.starts, share, j);
                        sent[end as usize][number] -= scale * weight;
                    }
                }
            }
        }
        sent
    }

    /// Σ over axes of slope times start, of a share of the samples of cell j.
    fn tilt(&self, column: &Column, starts: &[f32], share: usize, j: usize) -> f64 {
        if !column.keeps_starts() {
            return 0.0;
        }
        let dimension = self.transitions.dimension;
        let starts = &starts[share * dimension..(share + 1) * dimension];
        let terms = starts.iter().zip(&self.slopes[j]);
        terms.map(|(&start, slope)| f64::from(start) * slope).sum()
    }

    /// What arrives where each cell sends so much.
    fn send(&self, of_cell: impl Fn(usize) -> Sent) -> Vec<OfGroups> {
        let dimension = self.transitions.dimension;
        let mut arriving = vec![[0.0; GROUPS_AT_ONCE]; self.mass.len()];
        for (j, column) in self.transitions.columns.iter().enumerate() {
            if self.mass[j] > 0.0 {
                scatter(column, dimension, &of_cell(j), &mut arriving);
            }
        }
        arriving
    }
}

/// Adds what a cell sends. The sink, which comes last among the ends, is left out.
#[multiversion(targets = "simd")]
fn scatter(column: &Column, dimension: usize, sent: &Sent, arriving: &mut [OfGroups]) {
    let ends = column.destinations.iter().zip(&column.counts);
    if !column.keeps_starts() {
        for (&end, &count) in ends {
            if let Some(here) = arriving.get_mut(end as usize) {
                for (slot, plain) in here.iter_mut().zip(&sent.plain) {
                    *slot += f64::from(count) * plain;
                }
            }
        }
        return;
    }
    for ((&end, &count), starts) in ends.zip(column.starts.chunks_exact(dimension)) {
        let Some(here) = arriving.get_mut(end as usize) else {
            continue;
        };
        let mut sum = sent.plain.map(|plain| f64::from(count) * plain);
        for (&start, tilted) in starts.iter().zip(&sent.tilted) {
            for group in 0..GROUPS_AT_ONCE {
                sum[group] += f64::from(start) * tilted[group];
            }
        }
        for group in 0..GROUPS_AT_ONCE {
            here[group] += sum[group];
        }
    }
}
