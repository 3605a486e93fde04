//! The range of values over which a quantity is watched, where that is left to the program.
//!
//! The formula's least and largest value in Ω are the widest range. Where the mass does not reach them, as at the
//! corners of Ω for an amplitude, the range ends beyond the quantiles of rough densities at both ends of the sweep and
//! in its middle. Where it does, as at the energy of rest, the range ends exactly there: a bin of which a part holds no
//! value would look like a valley.

use std::ops::RangeInclusive;

use super::generator::rough_masses;
use crate::cancellation::{Cancellation, Cancelled};
use crate::density::{Detail, QuantityMoments};
use crate::numerics::sort_ascending;
use crate::space::{Axis, CellSpace};
use crate::system::{BoundQuantity, Family, LANES, Lanes, SystemError};

/// Mass that may lie beyond each end of the range.
const BEYOND: f64 = 1e-5;
/// What is added to a range at either end, as a share of it.
const MARGIN: f64 = 0.1;
/// A least or largest value this near to the range, as a share of it, is where the range ends.
const NEAR: f64 = 0.05;
/// Cells of an axis on which the rough density is solved, by the number of axes.
const ROUGH_CELLS: [usize; 4] = [200, 40, 12, 7];
/// Halvings of the step by which extremes are looked for.
const HALVINGS: usize = 60;
/// Lengths of ranges whose squares, and those of the densities on them, are numbers with all their digits.
const SCALES: RangeInclusive<f64> = 1e-100..=1e100;

/// Why there is no range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum BinsError {
    /// The formula has no value somewhere in Ω.
    #[error("`{quantity}` is {value} at {state}")]
    NotFinite {
        /// The quantity.
        quantity: String,
        /// Its value.
        value: f64,
        /// The state in words.
        state: String,
    },
    /// The formula has no mean square over Ω.
    #[error(
        "`{quantity}` has no mean: it, or its square, is no number or beyond the range of numbers next to {state}"
    )]
    NoMean {
        /// The quantity.
        quantity: String,
        /// The state in words.
        state: String,
    },
    /// The values that the formula takes are too small or too large for densities of them.
    #[error("`{quantity}` goes from {from:e} to {to:e}: too far from 1 to work with")]
    Scale {
        /// The quantity.
        quantity: String,
        /// Its least value.
        from: f64,
        /// Its largest.
        to: f64,
    },
    /// The formula has one value.
    #[error("`{quantity}` is {value} all over the cells: it has no density")]
    OneValue {
        /// The quantity.
        quantity: String,
        /// Its value.
        value: f64,
    },
    /// A parameter value that is not allowed.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The caller asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The values of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct QuantityRange {
    /// Where its bins begin and end by themselves.
    pub ends: (f64, f64),
    /// Its least and largest value in Ω.
    pub extremes: (f64, f64),
}

/// The values of each of the family's quantities, in their order, for cells of a space. Where no bins are open, rough
/// densities are not solved, and the ends are the extremes.
///
/// # Errors
/// [`BinsError`].
pub(crate) fn automatic_bins(
    family: &Family,
    space: &CellSpace,
    open: bool,
    cancellation: &Cancellation,
) -> Result<Vec<QuantityRange>, BinsError> {
    let most = ROUGH_CELLS[space.dimension().clamp(1, ROUGH_CELLS.len()) - 1];
    let rough = space.axes().iter().map(|axis| match axis.count() > most {
        true => axis.refined(most as f64 / axis.count() as f64),
        false => axis.clone(),
    });
    let rough = CellSpace::new(rough.collect()).unwrap_or_else(|_| space.clone());
    let (from, to) = family.ends();
    let mut ranges: Vec<Option<Range>> = vec![None; family.quantities().len()];
    for value in [from, 0.5 * (from + to), to] {
        cancellation.check()?;
        let masses = if open {
            rough_masses(family, &rough, value, cancellation)
        } else {
            None
        };
        cancellation.check()?;
        let values = family.values_at(value)?;
        for (quantity, range) in family.quantities().iter().zip(&mut ranges) {
            let bound = quantity.bind(&values)?;
            let look = Look {
                family,
                space: &rough,
                name: quantity.name(),
                quantity: &bound,
            };
            let found = look.range(masses.as_deref())?;
            *range = Some(range.map_or(found, |known| known.join(found)));
        }
    }
    let ends = ranges.iter().zip(family.quantities());
    ends.map(|(range, quantity)| {
        let range = range.unwrap_or_default();
        let (from, to) = range.ends();
        let quantity = quantity.name().to_owned();
        let value = from;
        match to - from {
            length if SCALES.contains(&length) => Ok(QuantityRange {
                ends: (from, to),
                extremes: range.extremes,
            }),
            length if length > 0.0 => Err(BinsError::Scale { quantity, from, to }),
            _ => Err(BinsError::OneValue { quantity, value }),
        }
    })
    .collect()
}

/// Refuses quantities that have no mean, at both ends of the sweep and in its middle.
///
/// # Errors
/// [`BinsError`].
pub(crate) fn check_averaged(family: &Family, space: &CellSpace) -> Result<(), BinsError> {
    let (from, to) = family.ends();
    for value in [from, 0.5 * (from + to), to] {
        let values = family.values_at(value)?;
        for quantity in &family.questions.averaged {
            let bound = quantity.bind(&values)?;
            let map = QuantityMoments::new(space, &bound, Detail::Fine, &[]);
            if let Some(state) = map.undefined() {
                return Err(BinsError::NoMean {
                    quantity: quantity.name().to_owned(),
                    state: in_words(family, &bound, state),
                });
            }
        }
    }
    Ok(())
}

/// A state in words, as far as a quantity depends on it.
fn in_words(family: &Family, quantity: &BoundQuantity, state: &[f64]) -> String {
    let state = state.iter().enumerate();
    let words = state
        .filter(|(axis, _)| quantity.states()[*axis])
        .map(|(axis, value)| {
            // As many digits as tell where it is.
            let rounded: f64 = format!("{value:.4e}").parse().unwrap_or(*value);
            format!("{} = {rounded}", family.axis(axis))
        });
    words.collect::<Vec<_>>().join(", ")
}

/// Where values lie, and where most of the mass does.
#[derive(Debug, Clone, Copy, Default)]
struct Range {
    extremes: (f64, f64),
    quantiles: (f64, f64),
}

impl Range {
    fn join(self, other: Self) -> Self {
        let join = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        Self {
            extremes: join(self.extremes, other.extremes),
            quantiles: join(self.quantiles, other.quantiles),
        }
    }

    fn ends(self) -> (f64, f64) {
        let (low, high) = self.quantiles;
        let length = high - low;
        // Round ends, to a hundredth of the range.
        let unit = 10_f64.powf(length.log10().floor() - 1.0);
        let end = |at: f64, extreme: f64, sign: f64| {
            let beyond = at + sign * MARGIN * length;
            let reaches = sign * (extreme - beyond) <= NEAR * length;
            match reaches || !unit.is_normal() {
                // What is rounding beside the range is none of it.
                true if extreme.abs() <= 1e-12 * length => 0.0,
                true => extreme,
                false => sign * (sign * beyond / unit).ceil() * unit,
            }
        };
        let (least, most) = self.extremes;
        (end(low, least, -1.0), end(high, most, 1.0))
    }
}

/// A quantity on rough cells.
struct Look<'a> {
    family: &'a Family,
    space: &'a CellSpace,
    name: &'a str,
    quantity: &'a BoundQuantity,
}

impl Look<'_> {
    fn range(&self, masses: Option<&[f64]>) -> Result<Range, BinsError> {
        let lattice = self.lattice();
        let values = self.values(&lattice);
        if let Some(wrong) = values.iter().position(|value| !value.is_finite()) {
            return Err(BinsError::NotFinite {
                quantity: self.name.to_owned(),
                value: values[wrong],
                state: in_words(self.family, self.quantity, &lattice[wrong]),
            });
        }
        let best = |sign: f64| {
            let numbers = 0..values.len();
            let better = |a: &usize, b: &usize| (sign * values[*a]).total_cmp(&(sign * values[*b]));
            let start = numbers.max_by(better).unwrap_or(0);
            self.climb(&lattice[start], values[start], sign)
        };
        let extremes = (best(-1.0), best(1.0));
        Ok(Range {
            extremes,
            quantiles: masses.map_or(extremes, |masses| self.quantiles(masses)),
        })
    }

    /// Edges and centres of the cells along the axes that the quantity needs, ends of the others.
    fn lattice(&self) -> Vec<Vec<f64>> {
        let along = |(axis, cells): (usize, &Axis)| match self.quantity.states()[axis] {
            true => [cells.edges().to_vec(), cells.centres()].concat(),
            false => vec![cells.from()],
        };
        let mut states = vec![Vec::new()];
        for places in self.space.axes().iter().enumerate().map(along) {
            let longer = states.iter().flat_map(|state: &Vec<f64>| {
                places
                    .iter()
                    .map(move |&place| [state.as_slice(), &[place]].concat())
            });
            states = longer.collect();
        }
        states
    }

    fn values(&self, states: &[Vec<f64>]) -> Vec<f64> {
        let batches = states.chunks(LANES).flat_map(|batch| {
            let axes = 0..self.space.dimension();
            let lanes = |axis: usize| {
                let mut lanes = [batch[0][axis]; LANES];
                lanes
                    .iter_mut()
                    .zip(batch)
                    .for_each(|(lane, state)| *lane = state[axis]);
                lanes
            };
            let states: Vec<Lanes> = axes.map(lanes).collect();
            self.quantity.values(&states).into_iter().take(batch.len())
        });
        batches.collect()
    }

    /// The extreme value near a state, by steps along the axes.
    fn climb(&self, start: &[f64], value: f64, sign: f64) -> f64 {
        let (mut state, mut best) = (start.to_vec(), value);
        let axes = self.space.axes();
        let mut steps: Vec<f64> = axes.iter().map(|a| (a.to() - a.from()) / 64.0).collect();
        for _ in 0..HALVINGS {
            for (axis, cells) in axes.iter().enumerate() {
                for step in [steps[axis], -steps[axis]] {
                    let kept = state[axis];
                    state[axis] = (kept + step).clamp(cells.from(), cells.to());
                    let found = self.quantity.at(&state);
                    if sign * found > sign * best && found.is_finite() {
                        best = found;
                    } else {
                        state[axis] = kept;
                    }
                }
                steps[axis] *= 0.5;
            }
        }
        best
    }

    /// Values beyond which little mass lies.
    fn quantiles(&self, masses: &[f64]) -> (f64, f64) {
        let centres: Vec<Vec<f64>> = (0..masses.len())
            .map(|cell| self.space.place(cell))
            .collect();
        let mut pairs: Vec<(f64, f64)> = self
            .values(&centres)
            .into_iter()
            .zip(masses.iter().copied())
            .collect();
        sort_ascending(&mut pairs, |one| one.0);
        let quantile = |ordered: Vec<(f64, f64)>| {
            let mut beyond = 0.0;
            let reached = ordered.iter().find(|(_, mass)| {
                beyond += mass;
                beyond > BEYOND
            });
            reached.map_or(0.0, |(value, _)| *value)
        };
        let falling = pairs.iter().rev().copied().collect();
        (quantile(pairs), quantile(falling))
    }
}
