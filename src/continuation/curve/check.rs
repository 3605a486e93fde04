//! The error of a curve's points: their own, and what solves on finer cells and between closed ends of Ω show at
//! selected ones.
//!
//! As for the rows of a sweep, the finer value is the better one and is kept: the curve moves by what the checked
//! points show, interpolated along it, and the error of that is stated from the distance between coarse and fine.

use super::reading::NoReading;
use super::walked::{WalkPoint, Walked};
use super::{CurvePoint, CurveWork, Task};
use crate::continuation::grid::share_of_distance;
use crate::continuation::locate::QUIET;
use crate::continuation::{CheckedBy, DensitySource, Doubt, ErrorParts, SourceError, Want};
use crate::density::LEAK_ALLOWANCE;
use crate::numerics::{ends_of, sort_ascending};
use crate::topology::two_sided_limit;

/// A finer curve farther than this from the coarser one is not the same, in sides of the box.
const SAME: f64 = 0.05;
/// Checks on either side that the error of a point is taken from: where in its cell an indicator's place lies makes a
/// single one small by chance.
const NEIGHBOURS: usize = 2;
/// How far an indicator's place moves from one check to the next at most, in ranges of its axis: what finer cells
/// change is not the same everywhere.
const FARTHEST: f64 = 0.05;

/// What a check shows: how far uphill the curve is by it.
#[derive(Debug, Clone, PartialEq)]
enum Shift {
    Moved(f64),
    /// There is no such curve near.
    Nothing,
    /// It could not be asked, for this reason.
    Failed(String),
}

/// What the checks of one point show; `None` where none was made.
#[derive(Debug, Clone, PartialEq)]
struct Check {
    index: usize,
    finer: Option<Shift>,
    enclosed: Option<Shift>,
}

impl Check {
    /// What it says against the point.
    fn doubt(&self) -> Option<Doubt> {
        let failed = |by: CheckedBy, reason: &String| Some(Doubt::CheckFailed(by, reason.clone()));
        match (&self.finer, &self.enclosed) {
            (Some(Shift::Nothing), _) => Some(Doubt::NotOnFinerCells),
            (Some(Shift::Failed(reason)), _) => failed(CheckedBy::FinerCells(1), reason),
            (_, Some(Shift::Nothing)) => Some(Doubt::NotBetweenClosedEnds),
            (_, Some(Shift::Failed(reason))) => failed(CheckedBy::ClosedEnds, reason),
            _ => None,
        }
    }
}

impl Task<'_> {
    /// The points with their errors, and what checking them took.
    pub(super) fn judge(&self, walked: &Walked) -> (Vec<CurvePoint>, CurveWork) {
        let selected = self.selection(walked);
        let mut checks: Vec<Check> = selected
            .iter()
            .map(|&index| Check {
                index,
                finer: None,
                enclosed: None,
            })
            .collect();
        let mut work = CurveWork::default();
        if !checks.is_empty() {
            let want = Want::densities(&self.source.subject().observables);
            let finer = self.source.finer(&want);
            match finer {
                Ok(Some(source)) => {
                    let shown = self.ask(source.as_ref(), walked, &selected, &mut work);
                    let pairs = checks.iter_mut().zip(shown);
                    pairs.for_each(|(check, shown)| check.finer = shown);
                }
                Ok(None) => {}
                Err(SourceError::Interrupted) => {}
                Err(SourceError::Method(error)) => checks
                    .iter_mut()
                    .for_each(|check| check.finer = Some(Shift::Failed(error.to_string()))),
            }
            let leaks = walked
                .points
                .iter()
                .any(|node| node.reading.edge_mass > QUIET);
            if let Some(source) = self.source.enclosed(&want).filter(|_| leaks) {
                let shown = self.ask(source.as_ref(), walked, &selected, &mut work);
                let pairs = checks.iter_mut().zip(shown);
                pairs.for_each(|(check, shown)| check.enclosed = shown);
            }
        }
        checks.retain(|check| check.finer.is_some() || check.enclosed.is_some());
        let of_distance = share_of_distance(self.source.subject().cell_check, true);
        let nodes = walked.points.iter().enumerate();
        let points = nodes.map(|(index, node)| {
            let check = between(&checks, &walked.points, index, of_distance);
            self.checked_point(node, &check)
        });
        (points.collect(), work)
    }

    /// The points that are checked: both ends, every so many from the start on, and those at which the indicator's
    /// place has moved far since the last one; of a quantity all, because what its bins do depends on where in a bin
    /// the place lies, and a step passes several. The slope at a kink follows from the equations: no grid takes part.
    fn selection(&self, walked: &Walked) -> Vec<usize> {
        let every = self.options.check_every;
        if every == 0 || self.start.kind.traits().is_exact {
            return Vec::new();
        }
        let subject = self.source.subject();
        let observable = subject.observables.get(self.start.observable);
        let axes = observable.map(|one| one.axes()).unwrap_or_default();
        if axes
            .iter()
            .any(|&axis| subject.family.quantity(axis).is_some())
        {
            return (0..walked.points.len()).collect();
        }
        let last = walked.points.len() - 1;
        let mut chosen = vec![walked.start];
        let mut go = |indices: &mut dyn Iterator<Item = usize>| {
            let mut before = walked.start;
            for index in indices {
                let is_due = index.abs_diff(walked.start).is_multiple_of(every)
                    || place_moved(&walked.points[before], &walked.points[index]) > FARTHEST;
                if index == 0 || index == last || is_due {
                    chosen.push(index);
                    before = index;
                }
            }
        };
        go(&mut (walked.start + 1..=last));
        go(&mut (0..walked.start).rev());
        chosen.sort_unstable();
        chosen
    }

    /// What another source shows at the selected points, `None` where it was asked to stop.
    fn ask(
        &self,
        source: &dyn DensitySource,
        walked: &Walked,
        selected: &[usize],
        work: &mut CurveWork,
    ) -> Vec<Option<Shift>> {
        let mut reader = self.reader(source, self.start.kind);
        let mut shown = vec![None; selected.len()];
        // In the order in which the path was walked, neighbours follow each other.
        let mut order: Vec<usize> = (0..selected.len()).collect();
        let reading = |place: usize| &walked.points[selected[place]].reading;
        sort_ascending(&mut order, |&place| reading(place).coordinate);
        for place in order {
            let reading = reading(place);
            let value = reader.value(reading.coordinate, &reading.indicator.place);
            shown[place] = match value {
                Ok(value) => {
                    let moved = (reading.indicator.value - value) / reading.steepness();
                    let same = moved.abs() <= SAME;
                    Some(if same {
                        Shift::Moved(moved)
                    } else {
                        Shift::Nothing
                    })
                }
                Err(NoReading::Indicator | NoReading::Symmetry) => Some(Shift::Nothing),
                Err(NoReading::Density(reason)) => Some(Shift::Failed(reason)),
                Err(NoReading::Interrupted) => break,
            };
        }
        work.add(&reader.work);
        shown
    }

    fn checked_point(&self, node: &WalkPoint, check: &Interpolated) -> CurvePoint {
        let reading = &node.reading;
        let (indicator, steepness) = (&reading.indicator, reading.steepness());
        let sampling = if indicator.sampling_error > 0.0 {
            let doubt = 1.0 - self.detector.confidence();
            indicator.sampling_error * two_sided_limit(doubt, indicator.degrees_of_freedom)
        } else {
            0.0
        };
        let own = indicator.systematic_error / steepness;
        let parts = ErrorParts {
            solver: reading.solver_error * indicator.sensitivity / steepness + node.remainder,
            grid: check.grid.unwrap_or(own),
            sampling: sampling / steepness,
            leak: check.leak,
        };
        let error = parts.total();
        let uphill = reading.uphill();
        let mut foot = node.foot;
        match node.border {
            // It stays on the border.
            Some(side) => foot[1 - side] += check.shift / uphill[1 - side],
            None => (0..2).for_each(|k| foot[k] += check.shift * uphill[k]),
        }
        let sides = self.plane.sides();
        let depends_on_cells = !self.start.kind.traits().is_exact;
        let unchecked = if self.options.check_every == 0 {
            Doubt::GridCheckOff
        } else {
            Doubt::CheckMissing
        };
        let is_unchecked = check.grid.is_none() && depends_on_cells;
        let known = (check.doubt.clone(), is_unchecked.then_some(unchecked));
        let against = reading.against(depends_on_cells);
        CurvePoint {
            values: self.plane.values(foot),
            error,
            parts,
            to_edge: [0, 1].map(|k| error * uphill[k] * sides[k].length()),
            indicator: indicator.value,
            gradient: [0, 1].map(|k| reading.gradient[k] / sides[k].length()),
            place: indicator.place.clone(),
            arclength: node.arclength,
            tangent: [0, 1].map(|k| node.tangent[k] * sides[k].length()),
            checked: check.is_own,
            doubts: reading.doubts(self, known, against, parts),
        }
    }
}

/// What the checks show of a point.
#[derive(Debug, Clone, PartialEq, Default)]
struct Interpolated {
    /// How far uphill the better curve is.
    shift: f64,
    /// Error of the cells; `None` where no finer cells tell.
    grid: Option<f64>,
    leak: f64,
    /// Whether the point itself was checked.
    is_own: bool,
    /// The doubt where a check shows no curve, or failed.
    doubt: Option<Doubt>,
}

/// Between the nearest checked points on either side.
fn between(checks: &[Check], nodes: &[WalkPoint], index: usize, of_distance: f64) -> Interpolated {
    let after = checks.partition_point(|check| check.index < index);
    let above = checks.get(after);
    let below = match above {
        Some(check) if check.index == index => Some(check),
        _ => after.checked_sub(1).and_then(|place| checks.get(place)),
    };
    let (Some(below), Some(above)) = (below.or(above), above.or(below)) else {
        return Interpolated::default();
    };
    let arclength = |check: &Check| nodes[check.index].arclength;
    let (from, to) = (arclength(below), arclength(above));
    let share = match to > from {
        true => (nodes[index].arclength - from) / (to - from),
        false => 0.0,
    };
    let nearest = if share <= 0.5 { below } else { above };
    let moved = |shown: &Option<Shift>| match shown {
        Some(Shift::Moved(moved)) => Some(*moved),
        _ => None,
    };
    let (a, b) = (moved(&below.finer), moved(&above.finer));
    let pair = a.or(b).zip(b.or(a));
    let around = checks[after.saturating_sub(NEIGHBOURS)..]
        .iter()
        .take(2 * NEIGHBOURS);
    let around: Vec<f64> = around.filter_map(|check| moved(&check.finer)).collect();
    let largest = around
        .iter()
        .fold(0.0_f64, |max, moved| max.max(moved.abs()));
    let leaks = [below, above].map(|check| moved(&check.enclosed).map_or(0.0, f64::abs));
    Interpolated {
        shift: pair.map_or(0.0, |(a, b)| (1.0 - share) * a + share * b),
        grid: pair.map(|_| of_distance * largest + spread(&around)),
        leak: LEAK_ALLOWANCE * leaks[0].max(leaks[1]),
        is_own: below.index == index,
        doubt: nearest.doubt(),
    }
}

/// How far the indicator's place moves between two points, in ranges of the axis along which it is more.
fn place_moved(one: &WalkPoint, other: &WalkPoint) -> f64 {
    let axes = one.reading.density.axes.iter();
    let places = one.reading.indicator.place.iter();
    let pairs = axes.zip(places.zip(&other.reading.indicator.place));
    let shares =
        pairs.map(|(axis, (from, to))| axis.apart(*from, *to).abs() / (axis.to() - axis.from()));
    shares.fold(0.0, f64::max)
}

/// How far apart the numbers of a list are.
fn spread(list: &[f64]) -> f64 {
    let (low, high) = ends_of(list.iter().copied());
    (high - low).max(0.0)
}
