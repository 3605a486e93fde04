//! The cells on which a passage is solved: those of the sweep's range that are outside of the target, as many an axis
//! as the sweep has. Where fewer are asked for, axes of modes go without their last ones.
//!
//! Where a border stands across an axis without noise, as a barrier of an oscillator's displacement does, half of it
//! lets out and half of it is never reached from inside. The density there goes as the cube root of the distance
//! (T as the square root of the velocity), and cells of even width converge slowly, whatever the scheme. The axis ends
//! at such a border, and its cells are graded as the cube of the distance from it.

use std::iter;

use super::PassageError;
use super::pocket::has_pocket;
use crate::generator::levels;
use crate::numerics::{bisected, narrowed, sort_descending};
use crate::space::{Axis, CellSpace, Grading};
use crate::system::{BoundQuantity, System};

/// Cells inside the target, or beyond what is kept, that stencils may read.
const MARGIN: usize = 4;

/// Narrowest cells beside the place at which a barrier of an oscillator begins to let out, over those of even width.
const BESIDE_BARRIER: f64 = 0.15;

/// Fewest cells of an axis that is cut.
const FEWEST: usize = 16;

/// By which share cells may be wider or narrower than asked for so that faces lie where they should.
const WIDTHS: f64 = 0.15;

/// What it counts, in cells beside a face, that cells are twice as many.
const NEARER: f64 = 1e-3;

/// The cells of a passage.
pub(super) struct PassageCells {
    /// The cells.
    pub(super) space: CellSpace,
    /// Per axis, whether its lower and its upper end are borders of the target.
    pub(super) borders: Vec<[bool; 2]>,
}

/// Finds the cells of a passage that ends where `level` is negative, `factor` times as many an axis as the space has.
/// With any other factor than one, axes of modes are without their last ones. `parts` are the levels of parts of that
/// region that are told apart, if there are any.
///
/// # Errors
/// [`PassageError::Nowhere`], [`PassageError::Everywhere`] and [`PassageError::Between`]; errors of the level, and
/// of the cells.
pub(super) fn cells(
    system: &dyn System,
    space: &CellSpace,
    (level, parts): (&BoundQuantity, &[BoundQuantity]),
    factor: f64,
) -> Result<PassageCells, PassageError> {
    let levels = levels(space, level)?;
    let kept: Vec<usize> = (0..space.n_cells())
        .filter(|&cell| levels[cell] >= 0.0)
        .collect();
    if kept.is_empty() {
        return Err(PassageError::Everywhere);
    }
    if kept.len() == space.n_cells() {
        return Err(PassageError::Nowhere);
    }
    let mut axes: Vec<Axis> = Vec::new();
    let mut borders = Vec::new();
    for (index, axis) in space.axes().iter().enumerate() {
        let positions = kept.iter().map(|&cell| space.position(cell, index));
        let (low, high) = positions.fold((axis.count(), 0), |(low, high), at| {
            (low.min(at), high.max(at))
        });
        if axis.is_modes() {
            axes.push(match factor {
                1.0 => axis.clone(),
                _ => axis.with_modes(axis.fewer_modes())?,
            });
            borders.push([false; 2]);
            continue;
        }
        let count = ((axis.count() as f64 * factor) as usize).max(FEWEST) / 2 * 2;
        let flat = |last, is_upper| flat(space, level, &kept, index, last, is_upper);
        let ends = [
            (low > 0).then(|| flat(low, false)).flatten(),
            (high + 1 < axis.count())
                .then(|| flat(high, true))
                .flatten(),
        ];
        let trimmed = [
            axis.edges()[low.saturating_sub(MARGIN)],
            axis.edges()[(high + 1 + MARGIN).min(axis.count())],
        ];
        let range = [0, 1].map(|end| ends[end].unwrap_or(trimmed[end]));
        let marked = ends.map(|end| end.is_some());
        let whole = [low <= MARGIN, high + 1 + MARGIN >= axis.count()];
        let kinks: Vec<f64> = system.facts().surfaces_on(index).collect();
        let is_noisy = system.is_noisy(index);
        borders.push(if is_noisy { [false; 2] } else { marked });
        axes.push(match (is_noisy, axis.is_uniform()) {
            (false, _) if marked != [false; 2] => {
                Axis::toward_ends(range[0], range[1], count, marked)?
            }
            (_, true) => with_faces(range, count, (marked, whole), &kinks)?,
            (_, false) if factor == 1.0 => axis.clone(),
            (_, false) => axis.refined(factor),
        });
    }
    grade_beside_barriers(system, &mut axes, &borders)?;
    let space = CellSpace::new(axes)?;
    for region in iter::once(level).chain(parts) {
        if has_pocket(&space, region)? {
            return Err(PassageError::Between);
        }
    }
    Ok(PassageCells { space, borders })
}

/// Even cells with a face on each border, and some beyond it, so that what cells do changes evenly with their number;
/// and with faces on planes at which the drift is not smooth, which come first. Where all of them cannot be on faces,
/// the width is the one near what was asked for at which they are nearest to them. An end is either a border
/// (`marked`), an end of the sweep's cells (`whole`), or anywhere beyond what is kept.
fn with_faces(
    [from, to]: [f64; 2],
    count: usize,
    (marked, whole): ([bool; 2], [bool; 2]),
    kinks: &[f64],
) -> Result<Axis, PassageError> {
    let beyond = marked.map(|marked| if marked { MARGIN } else { 0 });
    let width = (to - from) / (count - beyond[0] - beyond[1]) as f64;
    let inside = kinks.iter().filter(|&&at| from < at && at < to);
    // Places that want faces, with how much: the first one gets one for certain.
    let mut places: Vec<(f64, f64)> = inside.map(|&at| (at, 100.0)).collect();
    let ends = [(from, marked[0], whole[0]), (to, marked[1], whole[1])];
    let of_end = |&(at, marked, whole): &(f64, bool, bool)| match (marked, whole) {
        (true, _) => Some((at, 10.0)),
        (false, true) => Some((at, 1.0)),
        (false, false) => None,
    };
    places.extend(ends.iter().filter_map(of_end));
    sort_descending(&mut places, |one| one.1);
    let Some((&(first, _), others)) = places.split_first() else {
        return Ok(Axis::uniform(from, to, count)?);
    };
    let off = |at: f64, width: f64| ((at - first) / width - ((at - first) / width).round()).abs();
    let cost = |width: f64| -> f64 { others.iter().map(|&(at, much)| much * off(at, width)).sum() };
    let width = match others.first() {
        None => width,
        Some(&(second, _)) => {
            let length = (second - first).abs();
            let cells = (length / width).round().max(1.0);
            let most = (1.0 + WIDTHS) * cells;
            let mut best = (f64::INFINITY, width);
            let mut steps = ((1.0 - WIDTHS) * cells).floor().max(1.0);
            while steps <= most.ceil() {
                let tried = length / steps;
                // Of several that do, the one nearest to what was asked for.
                let found = cost(tried) + NEARER * (steps - cells).abs() / cells;
                if found < best.0 {
                    best = (found, tried);
                }
                steps += 1.0;
            }
            best.1
        }
    };
    // Ends that are on no face move by less than one cell: inward from an end of the sweep's cells.
    let steps = |at: f64, is_upper: bool, whole: bool| {
        let steps = (at - first) / width;
        match ((steps - steps.round()).abs() < 1e-6, whole == is_upper) {
            (true, _) => steps.round(),
            (false, true) => steps.floor(),
            (false, false) => steps.ceil(),
        }
    };
    let low = steps(from, false, !marked[0] && whole[0]) - beyond[0] as f64;
    let high = steps(to, true, !marked[1] && whole[1]) + beyond[1] as f64;
    let at = |steps: f64, end: f64| match first + steps * width {
        at if (at - end).abs() < 1e-6 * width => end,
        at => at,
    };
    let cells = (high - low).max(1.0) as usize;
    Ok(Axis::uniform(at(low, from), at(high, to), cells)?)
}

/// Narrows even cells along a noisy axis toward the place at which the drift through a barrier changes its sign: for
/// an oscillator, a velocity of zero. From there on outward the process ends, inward it does not.
fn grade_beside_barriers(
    system: &dyn System,
    axes: &mut [Axis],
    borders: &[[bool; 2]],
) -> Result<(), PassageError> {
    let middle: Vec<f64> = axes
        .iter()
        .map(|axis| 0.5 * (axis.from() + axis.to()))
        .collect();
    for barrier in 0..axes.len() {
        let ends = [axes[barrier].from(), axes[barrier].to()];
        let marked = ends
            .into_iter()
            .zip(borders[barrier])
            .filter(|(_, marked)| *marked);
        for at in marked.map(|(at, _)| at).collect::<Vec<f64>>() {
            for (index, axis) in axes.iter_mut().enumerate() {
                if index == barrier || !system.is_noisy(index) || !axis.is_uniform() {
                    continue;
                }
                let mut state = middle.clone();
                state[barrier] = at;
                let mut drift = |x: f64| {
                    state[index] = x;
                    system.drift_at(0.0, &state)[barrier]
                };
                if let Some(at) = only_zero(&mut drift, axis.nodes()) {
                    let width = (axis.to() - axis.from()) / axis.count() as f64;
                    let grading = Grading {
                        at: vec![at],
                        smallest: BESIDE_BARRIER * width,
                    };
                    *axis = Axis::graded(axis.from(), axis.to(), axis.count(), &grading)?;
                }
            }
        }
    }
    Ok(())
}

/// Where a function changes its sign, if it does so once between the first and the last of some places.
fn only_zero(function: &mut impl FnMut(f64) -> f64, places: &[f64]) -> Option<f64> {
    let mut brackets = places
        .windows(2)
        .filter(|pair| (function(pair[0]) < 0.0) != (function(pair[1]) < 0.0));
    let (pair, more) = (brackets.next()?, brackets.next());
    if more.is_some() {
        return None;
    }
    let below = function(pair[0]) < 0.0;
    let is_first = |middle: f64| (function(middle) < 0.0) == below;
    // A place that is zero but for rounding is zero.
    let at = bisected((pair[0], pair[1]), 100, is_first);
    Some(if at.abs() <= 1e-12 * (pair[1] - pair[0]) {
        0.0
    } else {
        at
    })
}

/// The coordinate of a border that stands across an axis beyond a cell, and bounds all that is kept.
fn flat(
    space: &CellSpace,
    level: &BoundQuantity,
    kept: &[usize],
    index: usize,
    last: usize,
    is_upper: bool,
) -> Option<f64> {
    let axis = &space.axes()[index];
    let nodes = axis.nodes();
    let (inner, outer) = (
        nodes[last],
        if is_upper {
            nodes[last + 1]
        } else {
            nodes[last - 1]
        },
    );
    let at_end = kept
        .iter()
        .filter(|&&cell| space.position(cell, index) == last);
    let crossing = |cell: usize| {
        let mut state: Vec<f64> = space
            .axes()
            .iter()
            .enumerate()
            .map(|(other, axis)| axis.nodes()[space.position(cell, other)])
            .collect();
        let is_outside = |middle: f64| {
            state[index] = middle;
            level.at(&state) >= 0.0
        };
        narrowed((inner, outer), 200, is_outside).0
    };
    let first = crossing(
        *kept
            .iter()
            .find(|&&cell| space.position(cell, index) == last)?,
    );
    let same = |x: f64| (x - first).abs() <= 1e-9 * (outer - inner).abs();
    // All lines cross there: as many cells are kept beside the border as there are lines.
    let lines = space.n_cells() / axis.count();
    let at_end: Vec<usize> = at_end.copied().collect();
    let every = (at_end.len() / 8).max(1);
    (at_end.len() == lines
        && at_end
            .iter()
            .step_by(every)
            .all(|&cell| same(crossing(cell))))
    .then_some(first)
}
