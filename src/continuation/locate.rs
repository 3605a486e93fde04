//! The rows of a sweep: every change of signature with its value, error, bracket and status.

use super::change::{Change, Found, changes};
use super::grid::{Checked, Checks, GridCheck, Leak, share_of_distance};
use super::jump::instead_of_zero;
use super::label::{self, BifurcationStatus, LabelledPoint, PointType};
use super::measure::NUMERICAL_DIFFUSION;
use super::reason::{
    MOST_NEGATIVE, change_by_modes, coarse, jump_inside_cells, leaks, negative_share, not_checked,
    said_of, torn,
};

use super::root::{Root, root};
use super::rows::{
    doubt_what_does_not_continue, in_order, inseparable, merge, say, without_flicker,
};
use super::{CellCheck, Goal, Point, PointStatus, Subject, persistence};
use crate::density::{EstimatedDensity, Kink, Observable};
use crate::topology::{Detector, Indicator};

/// All labelled points of a sweep, in ascending parameter. `points` must be ascending.
pub(super) fn label_points(
    points: &[Point],
    subject: &Subject,
    detector: &dyn Detector,
    options: &Goal,
    checks: &mut dyn Checks,
) -> Vec<LabelledPoint> {
    let observables = &subject.observables;
    let mut labels = label::end_points(points);
    labels.extend(label::failures(points));
    let solved: Vec<&Point> = points.iter().filter(|p| !p.detections.is_empty()).collect();
    let mut rows: Vec<LabelledPoint> = Vec::new();
    let changes = changes(&solved, detector);
    for gap in changes.chunk_by(|a, b| (a.observable, a.left) == (b.observable, b.left)) {
        let found = gap.iter().map(|change| {
            let row = match &change.found {
                Found::Crossing(_) => {
                    by_indicator(&solved, subject, change, detector, options, checks)
                }
                Found::Lost(at) | Found::Beyond(at) => {
                    by_bracket(&solved, observables, change, *at)
                }
                Found::Persistence => by_persistence(&solved, observables, change, options),
            };
            (row, change)
        });
        for row in in_order(found.collect()) {
            // Two indicators whose zeros cannot be told apart make one change.
            let same = rows.last_mut().filter(|last| inseparable(last, &row));
            match same {
                Some(last) => merge(last, &row),
                None => rows.push(row),
            }
        }
    }
    let mut rows = without_flicker(rows);
    doubt_what_does_not_continue(&mut rows, &solved, observables);
    for row in &mut rows {
        say(row);
    }
    labels.extend(rows);
    label::number(labels)
}

/// A row with all but value, error and status.
fn blank(observables: &[Observable], change: &Change) -> LabelledPoint {
    let crossing = change.crossing();
    let kind = crossing.map(|crossing| crossing.kind());
    let rises = crossing.is_some_and(|crossing| crossing.ends[1].value > crossing.ends[0].value);
    LabelledPoint {
        label: String::new(),
        kind: PointType::Bifurcation,
        value: 0.0,
        error: 0.0,
        lower: 0.0,
        upper: 0.0,
        observable: observables.get(change.observable).copied(),
        before: Some(change.before),
        after: Some(change.after),
        status: None,
        change: "",
        method: kind.map_or("persistence", |kind| kind.name()),
        parts: None,
        indicator: kind,
        rises,
        reason: None,
        place: crossing.map_or(Vec::new(), |crossing| crossing.ends[0].place.clone()),
        slope: None,
    }
}

/// An indicator was lost between two points: its zero lies there, or beyond.
fn by_bracket(
    points: &[&Point],
    observables: &[Observable],
    change: &Change,
    at: usize,
) -> LabelledPoint {
    let (lost, gap) = (
        (points[at].value, points[at + 1].value),
        (points[change.left].value, points[change.right].value),
    );
    let (lower, upper) = (lost.0.min(gap.0), lost.1.max(gap.1));
    LabelledPoint {
        value: 0.5 * (lower + upper),
        error: 0.5 * (upper - lower),
        lower,
        upper,
        status: Some(BifurcationStatus::Unresolved),
        reason: Some(match change.found {
            Found::Beyond(_) => {
                "too low to be counted, it is there up to the end of the sweep".to_owned()
            }
            _ => "there its slope can be followed no further: more cells may show it".to_owned(),
        }),
        ..blank(observables, change)
    }
}

/// The reason of a band that persistence gives.
const NO_INDICATOR: &str = "no slope or curvature tells of it: the band is from where it is seen to where it is not, and more cells \
     or samples narrow it";

fn by_persistence(
    points: &[&Point],
    observables: &[Observable],
    change: &Change,
    options: &Goal,
) -> LabelledPoint {
    let band = persistence::band(points, change.observable, change.left);
    // Counting follows what the cells show, and nothing says how far that is from the truth, but for noise.
    let is_noisy = points[change.left].densities[change.observable].is_noisy();
    let located = is_noisy && band.upper - band.lower <= options.tolerance * (1.0 + 1e-9);
    // Signatures that were not seen whole say nothing of where in between.
    let upper = match change.right == change.left + 1 {
        true => band.upper,
        false => band.upper.max(points[change.right].value),
    };
    LabelledPoint {
        value: band.value,
        error: (band.value - band.lower).max(upper - band.value),
        lower: band.lower,
        upper,
        status: Some(match (band.resolved_by_cells, located) {
            (false, _) => BifurcationStatus::Unconfirmed,
            (true, true) => BifurcationStatus::Located,
            (true, false) => BifurcationStatus::Unresolved,
        }),
        reason: (!located).then(|| NO_INDICATOR.to_owned()),
        ..blank(observables, change)
    }
}

fn by_indicator(
    points: &[&Point],
    subject: &Subject,
    change: &Change,
    detector: &dyn Detector,
    options: &Goal,
    checks: &mut dyn Checks,
) -> LabelledPoint {
    let mut row = blank(&subject.observables, change);
    let Some(crossing) = change.crossing() else {
        return row;
    };
    let mut found: Root = root(points, crossing, detector.confidence());
    let (a, b) = (points[crossing.left], points[crossing.left + 1]);
    let bracket = (a.value, b.value);
    // What follows from the equations: no grid takes part.
    let depends_on_cells = !crossing.ends.iter().all(Indicator::is_free_of_cells);
    let checked = Checked {
        observable: change.observable,
        kind: crossing.kind(),
        place: &crossing.ends[0].place,
        root: found,
    };
    let mut failed = None;
    let on_finer = depends_on_cells
        .then(|| checks.on_finer_cells(&checked))
        .flatten();
    match &on_finer {
        Some(GridCheck::Confirmed(value)) => {
            let density = &a.densities[change.observable];
            let chance = by_chance(density, checked.place);
            let share = share_of_distance(subject.cell_check) * chance;
            let grid = share * (value - found.value).abs();
            // Where a bend lies in its cell is chance: two grids may agree, and both be off by what a scheme makes of
            // it.
            found.error.grid = match chance > 1.0 && density.density.axes.len() > 1 {
                // No scheme takes part in closed forms that another source gives on cells. What the generator finds by
                // quadrature does not come here: its indicators follow from a profile, which no cells change.
                _ if density.is_by_quadrature() => grid,
                true => grid
                    .max(found.error.grid)
                    .max(LEAST_CLAIM * options.tolerance),
                false => grid.max(LEAST_CLAIM * options.tolerance),
            };
            found.value = *value;
        }
        Some(GridCheck::Failed(reason)) => failed = Some(format!("on finer cells: {reason}")),
        _ => {}
    }
    if depends_on_cells && edge_mass(a).max(edge_mass(b)) > QUIET {
        match checks.between_closed_ends(&checked) {
            Some(Leak::Moves(distance)) => found.error.leak = distance,
            Some(Leak::Failed(reason)) => {
                failed.get_or_insert(format!("with closed ends: {reason}"));
            }
            None => {}
        }
    }
    let error = found.error.total();
    let narrow = bracket.1 - bracket.0 <= options.tolerance * (1.0 + 1e-9);
    row.value = found.value;
    row.error = error;
    row.lower = bracket.0.min(found.value - error);
    row.upper = bracket.1.max(found.value + error);
    row.parts = Some(found.error);
    row.slope = Some(found.slope);
    // The diffusion that the cells of a sampled map add moves values; without a finer grid nobody knows by how much.
    let diffused = a.report.all(&NUMERICAL_DIFFUSION).next().is_some();
    // What holds of a density that leaks away, or has not converged, is not what holds of the steady state.
    let unsound = [a, b]
        .into_iter()
        .find(|one| one.report.status != PointStatus::Solved);
    let wiggles = [a, b].map(|one| negative_share(&one.densities[change.observable].density));
    let wiggles = wiggles[0].max(wiggles[1]);
    let is_torn = depends_on_cells && wiggles > MOST_NEGATIVE;
    let lacks_check = on_finer.is_none() && depends_on_cells && is_checkable(subject);
    let few_modes = [a, b].into_iter().find_map(change_by_modes);
    let mut by_cells = [a, b].into_iter().filter(|_| depends_on_cells);
    let blurred = by_cells.find_map(|point| jump_inside_cells(point, subject));
    let jump = instead_of_zero(points, crossing, detector);
    row.status = Some(match on_finer {
        Some(GridCheck::Unconfirmed) => BifurcationStatus::Unconfirmed,
        _ if failed.is_some() => BifurcationStatus::Unchecked,
        _ if unsound.is_some()
            || is_torn
            || few_modes.is_some()
            || blurred.is_some()
            || jump.is_some()
            || !narrow
            || error > options.tolerance =>
        {
            BifurcationStatus::Unresolved
        }
        None if diffused && depends_on_cells => BifurcationStatus::Unconfirmed,
        None if lacks_check => BifurcationStatus::Unchecked,
        _ => BifurcationStatus::Located,
    });
    row.reason = failed
        .or(jump)
        .or_else(|| unsound.map(|point| said_of(point, subject)))
        .or_else(|| is_torn.then(|| torn(wiggles)))
        .or(few_modes)
        .or(blurred)
        .or_else(|| leaks(&found, error, options, subject, [a, b]))
        .or_else(|| coarse(&found, error, options, &a.densities[change.observable]))
        .or_else(|| lacks_check.then(|| not_checked(options)));
    row
}

/// Share of the tolerance below which no error is claimed where a scheme takes part: two grids may agree that well by
/// chance.
const LEAST_CLAIM: f64 = 1e-2;

/// Cells on either side of a place that what is read there depends on.
const REACH: usize = 4;

/// By how much a distance to finer cells may be too small by chance there.
const CHANCE: f64 = 10.0;

/// One, or more beside a kink that lies inside a cell, as where in its cell differs from grid to grid, and with it the
/// error; and beside a bend that a scheme has followed, whose order is not known there.
fn by_chance(estimated: &EstimatedDensity, place: &[f64]) -> f64 {
    let is_cut = |kink: &Kink| {
        let Some((axis, place)) = estimated
            .density
            .axes
            .get(kink.axis)
            .zip(place.get(kink.axis))
        else {
            return false;
        };
        let cells = axis.find(kink.at).zip(axis.find(*place));
        let is_blurred = kink.is_bend() && !estimated.is_by_quadrature();
        let is_near = cells.is_some_and(|(a, b)| a.abs_diff(b) <= REACH);
        is_near && (is_blurred || !axis.has_face_at(kink.at))
    };
    let mut kinks = estimated.structure.kinks.iter();
    if kinks.any(is_cut) { CHANCE } else { 1.0 }
}

/// Whether finer cells could tell what the cells do to a value.
fn is_checkable(subject: &Subject) -> bool {
    matches!(subject.cell_check, CellCheck::OnFinerCells { .. })
}

/// Mass in the outermost cells below which what leaves Ω matters nowhere.
pub(super) const QUIET: f64 = 1e-11;

/// The largest mass in the outermost cells of an axis.
fn edge_mass(point: &Point) -> f64 {
    point.report.edge_mass().unwrap_or(0.0)
}
