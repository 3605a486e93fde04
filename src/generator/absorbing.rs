//! The generator of a process that ends where it enters a region: Q on the cells outside of it.
//!
//! The region is the set where a level function is negative, its border any line through the cells. Rows are not just
//! dropped: stencils would read zeros where the density is not zero, and central fluxes would be wrong by factors.
//! A stencil that reaches past the border reads there the polynomial through the last cells outside of the region and
//! through zero at the place where the grid line crosses the border. So means of first passage are of fourth order for
//! a border of any shape.
//!
//! Along an axis without noise the density is not zero at a border that stands across the axis: where the drift leaves
//! through it the polynomial is through cells alone, and where the drift comes in nothing does. On a border that is
//! oblique or curved the density of a system with noise on another axis is zero but for single points.

mod border;
mod ending;
#[cfg(test)]
mod tests;

use super::assemble::{check, lines_by};
use super::columns::{AxisRates, LineRates};
use super::geometry::{AxisGeometry, strides};
use super::scheme::{Dissipation, REACH, Window};
use super::{GeneratorError, GeneratorOptions};
use crate::MAX_DIMENSION;
use crate::space::CellSpace;
use crate::system::{BoundQuantity, LANES, Lanes, System};
use border::{Closing, GridLine, RegionCells};
pub(crate) use border::{lagrange, lagrange_slopes};
pub(crate) use ending::{AbsorbingGenerator, BorderValue, Ending, RateChange};

/// How stencils go on past a border. What the two differ by is an error of the border.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Closure {
    /// By a polynomial through four cells.
    Fourth,
    /// By a polynomial through three cells.
    Third,
}

impl Closure {
    fn cells(self) -> usize {
        match self {
            Self::Fourth => 4,
            Self::Third => 3,
        }
    }
}

/// Assembles the generator of a process that ends where `level` becomes negative.
///
/// # Errors
/// As [`super::assemble`], and [`GeneratorError::NotFinite`] for a level that has no value at a node.
pub(crate) fn assemble_absorbing(
    system: &dyn System,
    space: &CellSpace,
    level: &BoundQuantity,
    options: &GeneratorOptions,
    (dissipation, closure): (Dissipation, Closure),
) -> Result<AbsorbingGenerator, GeneratorError> {
    let [lines] = lines(system, space, options, [dissipation])?;
    Ok(closed((system, space), level, &lines, &[closure.cells()])?.0)
}

/// The same with all of the dissipation and [`Closure::Fourth`], what [`Closure::Third`] changes of it, and with half
/// of the dissipation. The drift is sampled once for all.
///
/// # Errors
/// As [`assemble_absorbing`].
pub(crate) fn assemble_with_changes(
    system: &dyn System,
    space: &CellSpace,
    level: &BoundQuantity,
    options: &GeneratorOptions,
) -> Result<(AbsorbingGenerator, RateChange, AbsorbingGenerator), GeneratorError> {
    let both = [Closure::Fourth, Closure::Third].map(Closure::cells);
    let shares = [Dissipation::Full, Dissipation::Half];
    let [full, half] = lines(system, space, options, shares)?;
    let (full, half) = rayon::join(
        || closed((system, space), level, &full, &both),
        || closed((system, space), level, &half, &both[..1]),
    );
    let ((full, border), (half, _)) = (full?, half?);
    Ok((full, border, half))
}

/// What moves along the lines of the grid, with shares of the dissipation.
fn lines<const N: usize>(
    system: &dyn System,
    space: &CellSpace,
    options: &GeneratorOptions,
    shares: [Dissipation; N],
) -> Result<[LineRates; N], GeneratorError> {
    check(system, space)?;
    let axes = shares.map(|share| {
        let geometry = |axis| AxisGeometry::damped(system, axis, space, options, share);
        (0..space.dimension()).map(geometry).collect()
    });
    lines_by(axes, system, space)
}

/// The generator whose stencils go on past the border by the first number of cells, and what the second one changes.
fn closed(
    (system, space): (&dyn System, &CellSpace),
    level: &BoundQuantity,
    lines: &LineRates,
    cells: &[usize],
) -> Result<(AbsorbingGenerator, RateChange), GeneratorError> {
    let axes = &lines.axes;
    let border = RegionCells {
        system,
        space,
        level,
        axes,
        strides: &strides(axes),
        cells,
        levels: levels(space, level)?,
    };
    let weight = |cell: usize| f64::from(u8::from(border.keeps(cell)));
    let mut assembly = Assembly {
        weights: [0; 2].map(|_| (0..space.n_cells()).map(weight).collect()),
        whole: RateChange::new(space.n_cells(), STENCIL * axes.len() * space.n_cells()),
        change: RateChange::new(space.n_cells(), 0),
        on_border: Vec::new(),
        border,
    };
    for (axis, rates) in lines.rates.iter().enumerate() {
        match rates {
            AxisRates::Fluxes(fluxes) => assembly.cells_along(axis, fluxes),
            AxisRates::Blocks(blocks) => assembly.modes_along(axis, blocks),
        }
    }
    assembly.generator()
}

/// Entries that the faces of a cell along an axis give.
const STENCIL: usize = 4 * REACH;

impl RateChange {
    fn new(cells: usize, entries: usize) -> Self {
        Self {
            rates: Vec::with_capacity(entries),
            ends: vec![0.0; cells],
            endings: Vec::new(),
        }
    }

    /// Adds a flux out of a cell through a face of a stretch.
    fn add(&mut self, stretch: &Stretch<'_>, source: usize, face: usize, flux: f64) {
        let (line, (from, to)) = (stretch.line, stretch.range);
        if face > from {
            self.rates.push((line.at(face - 1), source, -flux));
        } else {
            let cell = line.at(from.saturating_sub(1));
            let end = (from == 0).then_some((line.axis, false));
            self.finish(cell, end, source, -flux);
        }
        if face < to {
            self.rates.push((line.at(face), source, flux));
        } else {
            let end = (to == stretch.count).then_some((line.axis, true));
            let cell = line.at(to.min(stretch.count - 1));
            self.finish(cell, end, source, flux);
        }
    }

    /// Adds a part of the rate at which the process ends from a cell.
    fn finish(&mut self, cell: usize, end: Option<(usize, bool)>, source: usize, rate: f64) {
        self.ends[source] += rate;
        self.endings.push(Ending {
            cell,
            end,
            source,
            rate,
        });
    }
}

/// Cells `range.0..range.1` of a line of `count` that lie outside of the region.
struct Stretch<'a> {
    line: &'a GridLine,
    range: (usize, usize),
    count: usize,
}

/// The level function at the nodes of all cells.
pub(crate) fn levels(space: &CellSpace, level: &BoundQuantity) -> Result<Vec<f64>, GeneratorError> {
    let cells = space.n_cells();
    let dimension = space.dimension();
    let mut all = Vec::with_capacity(cells);
    let mut states = [[0.0; LANES]; MAX_DIMENSION];
    for first in (0..cells).step_by(LANES) {
        for lane in 0..LANES {
            let cell = (first + lane).min(cells - 1);
            for (axis, lanes) in states[..dimension].iter_mut().enumerate() {
                lanes[lane] = space.axes()[axis].nodes()[space.position(cell, axis)];
            }
        }
        let values: Lanes = level.values(&states[..dimension]);
        all.extend_from_slice(&values[..LANES.min(cells - first)]);
    }
    match all.iter().position(|value| value.is_nan()) {
        None => Ok(all),
        Some(cell) => Err(GeneratorError::NotFinite {
            axis: 0,
            state: space.centre(cell),
        }),
    }
}

/// The matrix in the making.
struct Assembly<'a> {
    border: RegionCells<'a>,
    /// The generator, and what going on past the border in the second way changes of it.
    whole: RateChange,
    change: RateChange,
    weights: [Vec<f64>; 2],
    on_border: Vec<BorderValue>,
}

impl Assembly<'_> {
    /// Adds what moves along an axis of cells.
    fn cells_along(&mut self, axis: usize, fluxes: &[Window]) {
        let (count, stride) = self.shape(axis);
        for (number, fluxes) in fluxes.chunks(count + 1).enumerate() {
            let line = GridLine {
                axis,
                number,
                first: number / stride * stride * count + number % stride,
                stride,
            };
            let mut from = 0;
            while from < count {
                if !self.border.keeps(line.at(from)) {
                    from += 1;
                    continue;
                }
                let inside = (from..count).find(|&at| !self.border.keeps(line.at(at)));
                let to = inside.unwrap_or(count);
                let stretch = Stretch {
                    line: &line,
                    range: (from, to),
                    count,
                };
                self.stretch(&stretch, fluxes);
                from = to;
            }
        }
    }

    /// Cells along an axis, and their distance in cell numbers.
    fn shape(&self, axis: usize) -> (usize, usize) {
        (self.border.axes[axis].count(), self.border.strides[axis])
    }

    /// Adds the fluxes of a stretch of cells.
    fn stretch(&mut self, stretch: &Stretch<'_>, fluxes: &[Window]) {
        let (line, (from, to)) = (stretch.line, stretch.range);
        let lower = (from > 0).then(|| self.border.beyond(line, (from, to), false));
        let upper = (to < stretch.count).then(|| self.border.beyond(line, (from, to), true));
        let first = [&lower, &upper]
            .into_iter()
            .flatten()
            .filter_map(|end| end.ways.first());
        for (position, changes) in first.flat_map(|end| &end.weights) {
            for (weights, change) in self.weights.iter_mut().zip(changes) {
                weights[line.at(*position)] += change;
            }
        }
        self.value_on_border(stretch, fluxes, (&lower, false));
        self.value_on_border(stretch, fluxes, (&upper, true));
        for (face, window) in fluxes.iter().enumerate().take(to + 1).skip(from) {
            for (k, &weight) in window.iter().enumerate() {
                if weight == 0.0 {
                    continue;
                }
                // A stencil has weights on cells of the line alone.
                let position = face + k - REACH;
                let (end, cells) = if position < from {
                    (&lower, from - position - 1)
                } else if position >= to {
                    (&upper, position - to)
                } else {
                    self.whole.add(stretch, line.at(position), face, weight);
                    continue;
                };
                let ways = end.as_ref().map_or(&[][..], |end| &end.ways);
                for (way, beyond) in ways.iter().enumerate() {
                    for &(source, share) in &beyond.read[cells] {
                        let (source, flux) = (line.at(source), weight * share);
                        if way == 0 {
                            self.whole.add(stretch, source, face, flux);
                        }
                        if ways.len() > 1 {
                            let flux = if way == 0 { -flux } else { flux };
                            self.change.add(stretch, source, face, flux);
                        }
                    }
                }
            }
        }
    }

    /// Adds what a density on the border at an end of a stretch does, in the first way.
    fn value_on_border(
        &mut self,
        stretch: &Stretch<'_>,
        fluxes: &[Window],
        (end, is_upper): (&Option<Closing>, bool),
    ) {
        let (line, (from, to)) = (stretch.line, stretch.range);
        let known = end.as_ref().and_then(|end| Some((end, end.ways.first()?)));
        let Some((end, beyond)) = known else { return };
        let (state, volume) = self.border.on_border(line, end.crossing);
        let mut rates = Vec::new();
        for (face, window) in fluxes.iter().enumerate().take(to + 1).skip(from) {
            let place = |far: usize| match is_upper {
                true => Some(to + far),
                false => from.checked_sub(far + 1),
            };
            // The window of a face begins so many cells below it.
            let weight = |far: usize| window.get((place(far)? + REACH).checked_sub(face)?);
            let reads = beyond.on_border.iter().enumerate();
            let terms = reads.filter_map(|(far, share)| Some(share * weight(far)?));
            let flux = volume * terms.sum::<f64>();
            if flux == 0.0 {
                continue;
            }
            if face > from {
                rates.push((line.at(face - 1), -flux));
            }
            if face < to {
                rates.push((line.at(face), flux));
            }
        }
        let sum = beyond.sum.map(|weight| weight * volume);
        self.on_border.push(BorderValue { state, rates, sum });
    }

    /// Adds the rates between modes where their places are kept.
    fn modes_along(&mut self, axis: usize, blocks: &[f64]) {
        let (count, stride) = self.shape(axis);
        for (line, rates) in blocks.chunks(count * count).enumerate() {
            let first = line / stride * stride * count + line % stride;
            if !self.border.keeps(first) {
                continue;
            }
            for (from, rates) in rates.chunks(count).enumerate() {
                let source = first + from * stride;
                let others = rates.iter().enumerate().filter(|(to, _)| *to != from);
                for (to, &rate) in others {
                    self.whole.rates.push((first + to * stride, source, rate));
                    self.whole.rates.push((source, source, -rate));
                }
            }
        }
    }

    /// The generator, with the cells inside the region on their own, and what the second way changes.
    fn generator(self) -> Result<(AbsorbingGenerator, RateChange), GeneratorError> {
        let mut whole = self.whole;
        let cells = whole.ends.len();
        let kept: Vec<bool> = (0..cells).map(|cell| self.border.keeps(cell)).collect();
        if !whole.rates.iter().all(|(_, _, rate)| rate.is_finite()) {
            return Err(GeneratorError::Overflow { axis: 0 });
        }
        let on_diagonal = whole.rates.iter().filter(|(row, column, _)| row == column);
        let diagonal = on_diagonal.fold(0.0f64, |most, (_, _, rate)| most.max(rate.abs()));
        let diagonal = if diagonal > 0.0 { diagonal } else { 1.0 };
        let inside = (0..cells).filter(|&cell| !kept[cell]);
        whole
            .rates
            .extend(inside.map(|cell| (cell, cell, -diagonal)));
        let generator = AbsorbingGenerator {
            rates: whole.rates,
            kept,
            ends: whole.ends,
            endings: whole.endings,
            weights: self.weights,
            on_border: self.on_border,
        };
        Ok((generator, self.change))
    }
}
