//! How many modes an axis needs: as many as change nothing more in what is watched.
//!
//! The answer converges exponentially in the number of modes, whatever the cells along the other axes; so the number is
//! found on coarse cells, at both ends and in the middle of a sweep, and holds for all of it: a number that changed
//! from point to point would make densities jump.

use super::GeneratorMethodOptions;
use super::source::GeneratorSource;
use crate::cancellation::Cancellation;
use crate::generator::cell_masses;
use crate::method::{MethodError, Problem};
use crate::space::{Axis, CellSpace};

/// Numbers of modes that are tried, in this order.
const TRIED: [usize; 10] = [3, 4, 5, 6, 8, 10, 12, 16, 20, 24];

/// Numbers of harmonics that are tried beyond these: an angle that is held fast by little noise needs many.
const MORE_HARMONICS: [usize; 4] = [30, 38, 48, 60];

/// Nodes of all axes together up to which numbers are tried for more than one axis beside cells, along which each cell
/// has a block of them, and without: a solve takes their cube.
const MOST_NODES: usize = 150;
const MOST_NODES_ALONE: usize = 576;

/// Iterations of a solve on coarse cells, which takes some tens where there is a steady state.
const MOST_ITERATIONS: usize = 100;

/// Change of a watched density, relative to its largest value, that more modes may still make.
const CHANGE: f64 = 1e-4;

/// The same where nothing but harmonics of one angle is solved for, which costs next to nothing, and of several.
const CHANGE_ALONE: f64 = 1e-10;
const CHANGE_OF_SEVERAL: f64 = 1e-6;

/// Change up to which it may be the cells' doing that it no longer falls, and the share of the change before it that it
/// has then; and change up to which the largest number that is tried will do.
const FLOOR: f64 = 1e-3;
const STALLED: f64 = 0.7;

/// Cells of the other axes on which modes are counted, for one such axis and for more.
const COARSE: [usize; 2] = [128, 32];

/// The numbers of modes that are needed, and the change of what is watched that more would make.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ModesFound {
    /// Number of modes of the axes asked for.
    pub count: usize,
    /// Largest change of a watched density, relative to its largest value, when the next number was tried.
    pub change: f64,
    /// Whether that is little; otherwise more modes than were tried are needed.
    pub is_enough: bool,
}

/// Cells of the other axes on which numbers of modes that are given are judged.
const COARSER: [usize; 2] = [64, 20];

/// Change that more modes than are given may make without being told: then peaks may still come and go by it.
const MUCH: f64 = 1e-2;

/// By how much more modes along all axes that have modes would change what is watched, relative to the largest value of
/// each density, where that is much: the largest change at both ends and in the middle of the path. `None` where it is
/// little, cannot be afforded, or not be solved.
///
/// # Errors
/// [`MethodError::Cancelled`].
pub(crate) fn change_by_more_modes(
    problem: &Problem,
    options: &GeneratorMethodOptions,
    cancellation: &Cancellation,
) -> Result<Option<f64>, MethodError> {
    let axes = problem.space().axes().iter().filter(|axis| axis.is_modes());
    let counts: Vec<usize> = axes.map(Axis::count).collect();
    let more = |count: usize| (count + count.div_ceil(4)).max(count + 2);
    let nodes: usize = counts.iter().map(|&count| more(count)).product();
    if counts.is_empty() || nodes > MOST_NODES {
        return Ok(None);
    }
    let mut trials = Trials::giving_up_after(1);
    let mut solve = |count: &dyn Fn(usize) -> usize| {
        let modes = |_: usize, axis: &Axis| count(axis.mode_number());
        let source = GeneratorSource::new(&coarse(problem, COARSER, &modes)?, options)?;
        trials.densities(&source, cancellation)
    };
    let both = solve(&|count| count).and_then(|as_given| Ok((as_given, solve(&more)?)));
    match both {
        Ok((as_given, with_more)) => Ok(Some(change(&as_given, &with_more))
            .filter(|&change| change > MUCH && change.is_finite())),
        Err(MethodError::Cancelled(cancelled)) => Err(cancelled.into()),
        Err(_) => Ok(None),
    }
}

/// Finds how many modes the axes `open` need (all alike) for what is watched along the path of a problem. The axes of
/// `problem` are as wanted but for the number of modes of these.
///
/// # Errors
/// [`MethodError`].
pub(crate) fn automatic_modes(
    problem: &Problem,
    open: &[usize],
    options: &GeneratorMethodOptions,
    cancellation: &Cancellation,
) -> Result<ModesFound, MethodError> {
    let mut before: Option<Vec<Option<Densities>>> = None;
    let mut trials = Trials::giving_up_after(2);
    let mut found = ModesFound {
        count: TRIED[0],
        change: f64::INFINITY,
        is_enough: false,
    };
    let nodes = |count: usize| open.iter().map(|_| count).product::<usize>();
    let axes = problem.space().axes();
    let (wanted, most) = match (axes.iter().all(Axis::is_closed), open.len()) {
        (true, 1) => (CHANGE_ALONE, usize::MAX),
        (true, _) => (CHANGE_OF_SEVERAL, MOST_NODES_ALONE),
        (false, 1) => (CHANGE, usize::MAX),
        (false, _) => (CHANGE, MOST_NODES),
    };
    let affordable = |&count: &usize| nodes(count) <= most;
    let closes = matches!(open, [axis] if axes[*axis].is_closed());
    let more = MORE_HARMONICS.into_iter().filter(|_| closes);
    for count in TRIED.into_iter().chain(more).filter(affordable) {
        let modes = |index: usize, axis: &Axis| match open.contains(&index) {
            true => count,
            false => axis.mode_number(),
        };
        let source = GeneratorSource::new(&coarse(problem, COARSE, &modes)?, options)?;
        let now = trials.densities(&source, cancellation)?;
        if let Some(before) = before {
            let earlier = std::mem::replace(&mut found.change, change(&before, &now));
            // Where more modes stop telling, what is left is the coarse cells' doing.
            let is_floor = found.change <= FLOOR && found.change > STALLED * earlier;
            if found.change <= wanted || (is_floor && wanted == CHANGE) {
                found.is_enough = true;
                return Ok(found);
            }
        }
        found.count = count;
        before = Some(now);
    }
    // A state whose law has a bend converges slowly in the number of modes, and so do harmonics where noise dies.
    let enough = if wanted == CHANGE { FLOOR } else { CHANGE };
    found.is_enough = found.change <= enough;
    Ok(found)
}

/// Values of all watched densities.
type Densities = Vec<Vec<f64>>;

/// The problem on coarse cells (of one axis, of each of several), with so many modes along each axis that has modes.
fn coarse(
    problem: &Problem,
    cells: [usize; 2],
    modes: &dyn Fn(usize, &Axis) -> usize,
) -> Result<Problem, MethodError> {
    let axes = problem.space().axes().iter().enumerate();
    let cut = axes.clone().filter(|(_, axis)| !axis.is_modes()).count();
    let cells = cells[usize::from(cut > 1)];
    let axes: Result<Vec<Axis>, _> = axes
        .map(|(index, axis)| match axis.is_modes() {
            true => axis.with_modes(modes(index, axis)),
            false => Axis::uniform(axis.from(), axis.to(), axis.count().min(cells)),
        })
        .collect();
    problem.on(CellSpace::new(axes?)?)
}

/// Solves at both ends and in the middle of the path. A value without a steady state takes the most iterations: after
/// some numbers of modes in turn without one it is given up.
struct Trials {
    failed: [usize; 3],
    most: usize,
}

impl Trials {
    fn giving_up_after(most: usize) -> Self {
        let failed = [0; 3];
        Self { failed, most }
    }

    /// The watched densities at each value.
    fn densities(
        &mut self,
        source: &GeneratorSource,
        cancellation: &Cancellation,
    ) -> Result<Vec<Option<Densities>>, MethodError> {
        let (from, to) = source.problem.family().ends();
        let values = [from, 0.5 * (from + to), to].into_iter();
        let mut found = Vec::new();
        for (value, failed) in values.zip(&mut self.failed) {
            let solved = match *failed < self.most {
                true => densities(source, value, cancellation)?,
                false => None,
            };
            *failed = if solved.is_some() { 0 } else { *failed + 1 };
            found.push(solved);
        }
        Ok(found)
    }
}

/// The watched densities at a value; `None` where there is no steady state on these cells.
fn densities(
    source: &GeneratorSource,
    value: f64,
    cancellation: &Cancellation,
) -> Result<Option<Densities>, MethodError> {
    let (problem, system) = (&source.problem, source.problem.family().at(value)?);
    let generator = source.assemble(system.as_ref(), source.options.scheme)?;
    let mut solver = source.solver_within(MOST_ITERATIONS, cancellation);
    let steady = solver.solve(&generator.matrix, &generator.escape, None)?;
    if !steady.info.converged {
        return Ok(None);
    }
    let masses = cell_masses(system.as_ref(), problem.space(), &steady.mass);
    source.maps(value)?.changes(problem, &masses).map(Some)
}

/// Largest change between two tries, relative to the largest value of each density.
fn change(before: &[Option<Densities>], now: &[Option<Densities>]) -> f64 {
    let pairs = before
        .iter()
        .zip(now)
        .filter_map(|(a, b)| Some((a.as_ref()?, b.as_ref()?)));
    let pairs = pairs.flat_map(|(a, b)| a.iter().zip(b));
    let changes = pairs.map(|(a, b)| {
        let largest = b.iter().copied().fold(0.0, f64::max);
        let moved = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        moved.fold(0.0, f64::max) / largest
    });
    // Without any steady state to look at nothing is known.
    changes
        .fold(None, |most: Option<f64>, one| {
            Some(most.map_or(one, |most| most.max(one)))
        })
        .unwrap_or(f64::INFINITY)
}
