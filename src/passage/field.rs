//! Numbers of a passage as fields over the state where it starts: the mean time, or the probability that one part of a
//! target is entered first (the committor, for two parts).
//!
//! With Q on the cells outside of the target, Qᵀ f = -g has what a process is expected to gather from each cell: with
//! a gain of one a unit of time the mean time, with the rates into a part the share that ends there. Another scheme Q'
//! adds δf with Qᵀ δf = -(g' + Q'ᵀ f), to first order of what both differ by. Grids and their differences are those of
//! the numbers (`timed.rs`); what they differ by at a state is taken as an error about that state, because a difference
//! that changes its sign vanishes somewhere.

use std::sync::Arc;

use super::PassageError;
use super::cells::{PassageCells, cells};
use super::exits::Exits;
use super::rim::{beside_border, mend, rim};
use super::solve::enclosed;
use super::start::{at_state, at_states_of};
use super::timed::{BORDER_ORDER, DAMPED, FEWER};
use crate::cancellation::Cancellation;
use crate::generator::{
    AbsorbingGenerator, Closure, Dissipation, GeneratorOptions, assemble_absorbing,
};
use crate::space::CellSpace;
use crate::space::nodes::{FEWER_NODES, NODES};
use crate::stationary::generator::{Absorbing, AbsorbingSolver, Expected, RateOptions};
use crate::system::{BoundQuantity, System};

/// States beside one along each axis, in cells, whose differences are an error there too.
const BESIDE: usize = 2;

/// Error at which solves stop to be iterated: nothing puts right what a field leaves.
pub(super) const TOLERANCE: f64 = 1e-10;

/// A field is asked for over all states.
#[derive(Debug, Clone)]
pub struct FieldTarget {
    /// Negative in the region at whose border a process ends.
    pub until: BoundQuantity,
    /// Parts of that region, negative inside each.
    pub exits: Vec<BoundQuantity>,
    /// The part whose probability is wanted; the mean time without one.
    pub part: Option<usize>,
}

/// A field at the centres of cells, with its errors.
#[derive(Debug, Clone, PartialEq)]
pub struct PassageField {
    /// One number a cell, the last axis fastest.
    pub values: Vec<f64>,
    /// Errors, none inside the target.
    pub errors: Vec<f64>,
}

/// Numbers by one grid, as those of a field at the states that are asked for: extrapolated to no dissipation, what half
/// of it changes, and what a border of lower order changes.
pub(super) struct OnGrid {
    pub(super) values: Vec<Option<f64>>,
    pub(super) halved: Vec<Option<f64>>,
    pub(super) border: Vec<Option<f64>>,
}

/// The same by the cells of a sweep and by the fewer ones of [`FEWER`], side by side.
///
/// # Errors
/// The first of those of the grids.
pub(super) fn on_three_grids<T: Send>(
    solve: impl Fn(f64) -> Result<T, PassageError> + Sync,
) -> Result<[T; 3], PassageError> {
    let [(more, _), (fewest, _)] = FEWER;
    let (finest, (coarse, coarsest)) = rayon::join(
        || solve(1.0),
        || rayon::join(|| solve(more), || solve(fewest)),
    );
    Ok([finest?, coarse?, coarsest?])
}

/// The errors of numbers by the finest grid: what dissipation, fewer cells and a border of lower order change.
pub(super) fn errors_of(finest: &OnGrid, others: [&OnGrid; 2]) -> Vec<f64> {
    let halved = finest.halved.iter().map(|change| DAMPED * size(*change));
    let mut errors: Vec<f64> = halved.collect();
    let mut border: Vec<f64> = finest.border.iter().map(|change| size(*change)).collect();
    for (other, (factor, times)) in others.into_iter().zip(FEWER) {
        let values = finest.values.iter().zip(&other.values);
        for (error, (own, other)) in errors.iter_mut().zip(values) {
            let change = own.zip(*other).map(|(own, other)| own - other);
            *error = error.max(times * size(change));
        }
        let scale = f64::powi(factor, BORDER_ORDER);
        for (error, change) in border.iter_mut().zip(&other.border) {
            *error = error.max(scale * size(*change));
        }
    }
    let both = errors.iter().zip(border);
    both.map(|(error, border)| error + border).collect()
}

/// The field of a passage of a system at the centres of the cells of a sweep. Inside the target it is what the target
/// says: no time, and a probability of one or none.
///
/// # Errors
/// [`PassageError`].
pub fn field(
    system: &Arc<dyn System>,
    space: &CellSpace,
    target: &FieldTarget,
    (options, rates): (&GeneratorOptions, &RateOptions),
    cancellation: &Cancellation,
) -> Result<PassageField, PassageError> {
    let question = FieldQuestion {
        system,
        space,
        target,
        options,
        rates: RateOptions {
            tolerance: TOLERANCE,
            ..*rates
        },
        cancellation,
    };
    let solve = |factor: f64| question.on_grid(factor);
    let [finest, coarse, coarsest] = on_three_grids(solve)?;
    let errors = errors_of(&finest, [&coarse, &coarsest]);
    let errors = greatest_beside(space, &errors);
    Ok(question.whole(&finest.values, &errors))
}

/// What is expected of the way from each cell by a generator, and what others add to that, to first order.
///
/// # Errors
/// Those of the solves.
pub(super) fn with_changes(
    solver: &mut AbsorbingSolver<'_>,
    stage: &Absorbing<'_>,
    [own, others @ ..]: [&AbsorbingGenerator; 3],
    gain: impl Fn(&AbsorbingGenerator) -> Vec<f64>,
) -> Result<(Expected, [Vec<f64>; 2]), PassageError> {
    let expected = solver.expected(stage, &gain(own))?;
    let [halved, border] = others.map(|other| {
        let left = expected.left_by(&other.rates, &other.ends, &gain(other));
        Ok::<_, PassageError>(solver.expected(stage, &left)?.values())
    });
    Ok((expected, [halved?, border?]))
}

/// A field, or transitions between two parts of a target, with what it is solved with.
pub(super) struct FieldQuestion<'a> {
    pub(super) system: &'a Arc<dyn System>,
    /// The cells of the sweep.
    pub(super) space: &'a CellSpace,
    pub(super) target: &'a FieldTarget,
    pub(super) options: &'a GeneratorOptions,
    pub(super) rates: RateOptions,
    pub(super) cancellation: &'a Cancellation,
}

impl FieldQuestion<'_> {
    /// A grid of `factor` times the sweep's cells an axis, and the generators on it of processes that end at the border
    /// of the target: as the scheme has it, by half of the dissipation, and by a border of lower order.
    ///
    /// # Errors
    /// Those of cells and of the assembly; [`PassageError::Never`] where nothing ends.
    pub(super) fn generators(
        &self,
        factor: f64,
    ) -> Result<(PassageCells, [AbsorbingGenerator; 3]), PassageError> {
        let until = &self.target.until;
        let regions = (until, self.target.exits.as_slice());
        let found = cells(self.system.as_ref(), self.space, regions, factor)?;
        let enclosed = enclosed(self.system, &found);
        let assemble = |dissipation, closure| {
            let scheme = (dissipation, closure);
            assemble_absorbing(&enclosed, &found.space, until, self.options, scheme)
        };
        let full = assemble(Dissipation::Full, Closure::Fourth)?;
        if full.ends.iter().all(|&rate| rate == 0.0) {
            return Err(PassageError::Never);
        }
        let half = assemble(Dissipation::Half, Closure::Fourth)?;
        let third = assemble(Dissipation::Full, Closure::Third)?;
        Ok((found, [full, half, third]))
    }

    /// The field by a grid of `factor` times the sweep's cells an axis.
    fn on_grid(&self, factor: f64) -> Result<OnGrid, PassageError> {
        let until = &self.target.until;
        let (PassageCells { space, .. }, generators) = self.generators(factor)?;
        let [full, half, third] = &generators;
        let exits = Exits::new(&self.target.exits, &space);
        let gain = |generator: &AbsorbingGenerator| match self.target.part {
            Some(part) => exits.rates(&generator.endings).swap_remove(part),
            None => generator.weights[0].clone(),
        };
        let kept = full.kept.iter().filter(|&&kept| kept).count() as f64;
        let even: Vec<f64> = full
            .kept
            .iter()
            .map(|&is| f64::from(u8::from(is)) / kept)
            .collect();
        let matrix = full.matrix();
        let mut solver = AbsorbingSolver::new(&space, self.rates, self.cancellation);
        let (stage, _) = solver.stage(&matrix, &full.ends, &even)?;
        let (expected, [mut halved, mut border]) =
            with_changes(&mut solver, &stage, [full, half, third], gain)?;
        if self.target.part.is_none() {
            // Another way to end sums at an oblique border.
            let [one, other] = &full.weights;
            let change: Vec<f64> = one
                .iter()
                .zip(other)
                .map(|(one, other)| other - one)
                .collect();
            let change = solver.expected(&stage, &change)?.values();
            let pairs = border.iter_mut().zip(change);
            pairs.for_each(|(border, change)| *border = border.abs() + change.abs());
        }
        let pairs = expected.values().into_iter().zip(&halved);
        let mut values: Vec<f64> = pairs.map(|(value, change)| value + 2.0 * change).collect();
        let rim = rim(self.system.as_ref(), (&space, &full.kept), until);
        mend(&mut values, &rim, |state| self.inside(state));
        mend(&mut halved, &rim, |_| 0.0);
        mend(&mut border, &rim, |_| 0.0);
        let at = |field: &[f64], on_border: &dyn Fn(&[f64]) -> f64| {
            self.at_centres((&space, &full.kept), field, Some(on_border))
        };
        Ok(OnGrid {
            values: at(&values, &|state| self.inside(state)),
            halved: at(&halved, &|_| 0.0),
            border: at(&border, &|_| 0.0),
        })
    }

    /// A field that is known at the kept nodes of a grid, at the centres of the sweep's cells, by what it is on the
    /// border of the target if that is known.
    pub(super) fn at_centres(
        &self,
        (space, kept): (&CellSpace, &[bool]),
        field: &[f64],
        on_border: Option<impl Fn(&[f64]) -> f64>,
    ) -> Vec<Option<f64>> {
        let (system, until) = (self.system.as_ref(), &self.target.until);
        let axes = self.space.axes().iter();
        let places: Vec<Vec<f64>> = axes.map(|axis| axis.centres()).collect();
        let cells = (space, kept);
        let inner = |state: &[f64]| at_state(cells, state, FEWER_NODES, field);
        let near = |state: &[f64]| {
            let of_border = on_border
                .as_ref()
                .and_then(|value| beside_border(system, (space, until), state, inner, value));
            of_border.or_else(|| at_state(cells, state, NODES, field))
        };
        let is_inside = |_: usize, state: &[f64]| until.at(state) < 0.0;
        at_states_of(&places, cells, is_inside, field, near)
    }

    /// The field with what it is inside the target, within the values that it can have.
    fn whole(&self, values: &[Option<f64>], errors: &[f64]) -> PassageField {
        let most = if self.target.part.is_some() {
            1.0
        } else {
            f64::INFINITY
        };
        let of_cell = |(cell, (value, error)): (usize, (&Option<f64>, &f64))| {
            let state = self.space.centre(cell);
            match value {
                // No value that it can have is farther away than the ends of their range.
                Some(value) => {
                    let value = value.clamp(0.0, most);
                    (value, error.min(value.max(most - value)))
                }
                None if self.target.until.at(&state) < 0.0 => (self.inside(&state), 0.0),
                // No node of the grid is near.
                None => (f64::NAN, f64::NAN),
            }
        };
        let both = values.iter().zip(errors).enumerate().map(of_cell);
        let (values, errors) = both.unzip();
        PassageField { values, errors }
    }

    fn inside(&self, state: &[f64]) -> f64 {
        let Some(part) = self.target.part else {
            return 0.0;
        };
        let levels = self.target.exits.iter().map(|exit| exit.at(state));
        let least = levels
            .enumerate()
            .min_by(|one, other| one.1.total_cmp(&other.1));
        f64::from(u8::from(least.is_some_and(|(found, _)| found == part)))
    }
}

pub(super) fn size(change: Option<f64>) -> f64 {
    change.map_or(0.0, f64::abs)
}

/// The greatest of the numbers of a cell and those beside it along every axis.
pub(super) fn greatest_beside(space: &CellSpace, numbers: &[f64]) -> Vec<f64> {
    let mut all = numbers.to_vec();
    let shape = space.shape();
    for (axis, &count) in shape.iter().enumerate() {
        let stride: usize = shape[axis + 1..].iter().product();
        let before = all.clone();
        for (cell, greatest) in all.iter_mut().enumerate() {
            let at = cell / stride % count;
            let others = at.saturating_sub(BESIDE)..=(at + BESIDE).min(count - 1);
            let others = others.map(|other| before[cell + other * stride - at * stride]);
            *greatest = others.fold(*greatest, f64::max);
        }
    }
    all
}
