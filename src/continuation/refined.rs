//! A zero on finer and finer cells, and the error that is stated of it.

use super::doubt::{Doubt, MOST_TIMES};
use super::grid::{Checked, Checks, share_of_distance};
use super::kinks::Kinks;
use super::root::Root;
use super::{CellCheck, ErrorParts, Goal};
use crate::density::EstimatedDensity;

/// How many times as much as two grids differ by the schemes may differ on the coarser one, of which the finer cells
/// mend most: what two grids agree on better than that they may agree on by chance, too. Of 124 located rows of random
/// systems on which two grids decided 28 do, and the six that were off by more than half of what was stated are among
/// these (docs/location.md).
const CHANCE: f64 = 30.0;

/// What is stated at least where no third grid tells, as a share of what the schemes differ by on the finer cells. Most
/// of that is the error of the second scheme, whose order is lower.
const UNTOLD: f64 = 0.5;

/// Share of the tolerance below which no error is claimed where a scheme takes part: two grids may agree that well by
/// chance.
const LEAST_CLAIM: f64 = 1e-2;

/// The cells that a zero was found on.
pub(super) struct Cells<'a> {
    pub(super) density: &'a EstimatedDensity,
    pub(super) check: CellCheck,
    /// What is claimed of the distance to finer cells.
    pub(super) share: f64,
    pub(super) is_forced: bool,
    /// Whether they are so wide, or hide so much, that errors may fall by any order, and two grids agree by chance.
    pub(super) is_wide: bool,
    /// Whether finer ones move with what lies inside of these: where in a cell that is here is chance.
    pub(super) is_followed: bool,
}

/// What finer cells have said of a zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Refined {
    /// How often they were refined.
    pub(super) times: u8,
    /// See [`Zero::is_settled`].
    pub(super) is_settled: bool,
}

/// Moves a zero to where finer cells have it, and finer ones again where their error exceeds the tolerance, or where
/// two grids alone may agree by chance; returns what they say of it, or against it.
pub(super) fn on_finer_cells(
    zero: &mut Root,
    checked: &Checked<'_>,
    cells: Cells<'_>,
    options: &Goal,
    checks: &mut dyn Checks,
) -> Option<Result<Refined, Doubt>> {
    let Cells { density, share, .. } = cells;
    let kinks = Kinks::near(density, checked.place);
    let (mut own, mut expected) = (zero.error.grid, 0.0);
    let mut found = None;
    let mut distances = Vec::new();
    // What is stated at least as long as two grids alone agree.
    let mut untold = None;
    for times in 1..=MOST_TIMES {
        let again = Checked {
            root: *zero,
            ..*checked
        };
        match checks.on_finer_cells(&again, times) {
            Some(Ok(finer)) => {
                let distance = (finer.value - zero.value).abs();
                distances.push(distance);
                // What a forcing carries to and fro is off by no more than the schemes differ on the finer cells, of
                // which the value is.
                let least = if cells.is_forced {
                    finer.error
                } else {
                    own.max(finer.error)
                };
                // Where cells are wide it may be off by as much as that.
                let is_off = cells.is_wide || checked.kind.traits().keeps_error;
                let by_schemes = if is_off { finer.error } else { 0.0 };
                // Nor is their order known where they agree so much better than schemes on the coarser cells do; those
                // of what a forcing carries are always wide.
                let schemes = if cells.is_forced { finer.error } else { own };
                let is_chance = times == 1 && schemes > CHANCE * distance;
                let share = match is_chance {
                    true => share_of_distance(cells.check, false).max(share),
                    false => share,
                };
                let claimed = kinks.share(times, share, cells.check) * distance;
                let grid = claimed.max(expected).max(by_schemes);
                let blur = kinks.by_schemes(times, [own, finer.error]);
                zero.error.grid = at_least(grid, (blur, least), kinks, density, options);
                zero.value = finer.value;
                own = finer.error;
                expected = kinks.share(2, share, cells.check) * distance / kinks.fall(cells.check);
                let is_settled = are_settled(&distances, cells.check);
                found = Some(Ok(Refined { times, is_settled }));
                // What schemes differ by less than the tolerance is not worth a third grid.
                let is_worth = is_chance && schemes > options.tolerance;
                untold = is_worth.then_some(UNTOLD * finer.error);
            }
            // What cannot be solved on so many cells says nothing against fewer.
            Some(Err(Doubt::CheckFailed(..))) if times > 1 => break,
            Some(Err(doubt)) => return Some(Err(doubt)),
            None => break,
        }
        let ErrorParts { grid, .. } = zero.error;
        let is_known = zero.error.total() <= options.tolerance || grid < 0.5 * zero.error.total();
        let is_by_chance = times == 1 && (cells.is_wide && options.is_closer || cells.is_followed);
        if is_known && untold.is_none() && !is_by_chance {
            break;
        }
    }
    if let Some(least) = untold {
        zero.error.grid = zero.error.grid.max(least);
    }
    found
}

/// Whether distances between values on finer and finer cells fall as order one has it, or faster. Two grids tell
/// nothing of that.
fn are_settled(distances: &[f64], check: CellCheck) -> bool {
    let CellCheck::OnFinerCells { ratio, .. } = check else {
        return false;
    };
    let mut pairs = distances.windows(2);
    distances.len() > 1 && pairs.all(|pair| pair[1] * ratio <= pair[0])
}

/// The error that cells are said to make, of the distance to finer ones. Two grids may agree by chance: where a bend
/// lies in its cell is chance, and both may be off by what a scheme makes of it; how level lines of a formula run
/// through cells is chance too.
fn at_least(
    distance: f64,
    (blur, both): (f64, f64),
    kinks: Kinks,
    density: &EstimatedDensity,
    options: &Goal,
) -> f64 {
    let is_blurred = kinks != Kinks::None && density.density.axes.len() > 1;
    if is_blurred && density.is_by_quadrature() {
        // No scheme takes part in closed forms that another source gives on cells. What the generator finds by
        // quadrature does not come here: its indicators follow from a profile, which no cells change.
        return distance;
    }
    let least = distance.max(LEAST_CLAIM * options.tolerance);
    match density.structure.is_spread {
        true => least.max(both),
        false if is_blurred => least.max(blur),
        false => least,
    }
}
