//! The rows of a sweep: every change of signature with its value, error, bracket and status.

use super::at_rest::beside_fixed_point;
use super::bands::{band, without_zero};
use super::change::{Change, changes};
use super::d_bifurcations::d_bifurcations;
use super::doubt::{Doubt, Evidence, WiderRange};
use super::follow::{Course, Crossing};
use super::grid::{Checked, Checks, share_of_distance};
use super::jump::instead_of_zero;
use super::label::{self, Label, Located, Zero};
use super::levels::crossings;
use super::measure::NUMERICAL_DIFFUSION;
use super::refined::{Cells, Refined, on_finer_cells};
use super::root::{Root, root};
use super::rows::{doubt_what_does_not_continue, in_order, inseparable, merge, without_flicker};
use super::solved_point::is_coarse;
use super::{CellCheck, Finding, Goal, Point, Subject};
use crate::topology::{Detector, Indicator};

/// All labelled points of a sweep, in ascending parameter. `points` must be ascending.
pub(super) fn label_points(
    points: &[Point],
    subject: &Subject,
    detector: &dyn Detector,
    options: &Goal,
    checks: &mut dyn Checks,
) -> Vec<Label> {
    let observables = &subject.observables;
    let solved: Vec<&Point> = points.iter().filter(|p| !p.detections.is_empty()).collect();
    let mut rows: Vec<Located> = Vec::new();
    let changes = changes(&solved, detector);
    for gap in changes.chunk_by(|a, b| (a.observable, a.left) == (b.observable, b.left)) {
        let found = gap.iter().map(|change| {
            let row = match &change.course {
                Some(Course::Crossing(crossing)) => {
                    let zero = (change, &**crossing);
                    by_indicator(&solved, subject, zero, detector, options, checks)
                }
                _ => without_zero(&solved, observables, change, detector),
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
    let rows = rows.into_iter();
    let rows = rows.map(|row| Label::Bifurcation(Box::new(row)));
    let confidence = detector.confidence();
    let levels = crossings(points, (subject, confidence), options.tolerance);
    // Where the exponent of a fixed point passes zero is known better from itself, and asked for with it.
    let is_of_point = subject.family.questions.fixed_point.is_some();
    let levels = levels
        .into_iter()
        .filter(|row| !(is_of_point && row.is_d_bifurcation()));
    let levels = levels.chain(d_bifurcations(points, &subject.family, options.tolerance));
    let levels = levels.map(|row| Label::Level(Box::new(row)));
    let others = label::end_points(points).chain(label::failures(points));
    label::number(others.chain(rows).chain(levels).collect())
}

pub(super) fn by_indicator(
    points: &[&Point],
    subject: &Subject,
    (change, crossing): (&Change, &Crossing),
    detector: &dyn Detector,
    options: &Goal,
    checks: &mut dyn Checks,
) -> Located {
    let mut zero: Root = root(points, crossing, detector.confidence());
    let (a, b) = (points[crossing.left], points[crossing.left + 1]);
    let density = &a.densities[change.observable];
    // What follows from the equations: no grid takes part.
    let depends_on_cells = !crossing.ends.iter().all(Indicator::is_free_of_cells);
    // A jump inside of cells makes them count what they like: those that move with it must count what the sweep does.
    let is_followed = follows_a_jump(subject.cell_check, [a, b]);
    let checked = Checked {
        observable: change.observable,
        kind: crossing.kind(),
        place: &crossing.ends[0].place,
        root: zero,
        counts: is_followed.then(|| change.counts()),
    };
    let on_finer = depends_on_cells.then(|| {
        let is_forced = subject.family.model().phase_axis().is_some();
        // Where cells are wide, or hide peaks, and on those that follow them in a closer look, errors may fall by any
        // order: those of a zero on 54 x 60 and finer cells were -3.8e-1, -1.0e-2, 6.3e-3 and 4.0e-3. Along
        // what a forcing carries to and fro cells are always wide; there, schemes say how far off it is.
        let has_wide = [a, b].into_iter().any(has_wide_cells);
        // Cells are those of all densities of a point.
        let mut shown = [a, b].into_iter().flat_map(|point| &point.densities);
        let is_wide = has_wide || shown.any(is_coarse);
        let is_order_known = is_forced || !(options.is_closer || is_wide || is_followed);
        let share = share_of_distance(subject.cell_check, is_order_known);
        let cells = Cells {
            density,
            check: subject.cell_check,
            share,
            is_forced,
            is_wide: is_wide && !is_forced,
            is_followed,
        };
        on_finer_cells(&mut zero, &checked, cells, options, checks)
    });
    let on_finer = on_finer.flatten();
    let leaks = depends_on_cells && edge_mass(a).max(edge_mass(b)) > QUIET;
    let leak = leaks
        .then(|| checks.between_closed_ends(&checked))
        .flatten();
    if let Some(Ok(distance)) = leak {
        zero.error.leak = distance;
    }
    let unchecked = if options.grid_check {
        Doubt::CheckMissing
    } else {
        Doubt::GridCheckOff
    };
    let is_unchecked = on_finer.is_none() && depends_on_cells;
    let (refined, is_settled) = match on_finer {
        Some(Ok(Refined { times, is_settled })) => (times, is_settled),
        _ => (0, false),
    };
    let mut densities = Vec::from_iter(instead_of_zero(points, crossing, detector));
    densities.extend(against(
        [a, b],
        (subject, change.observable),
        depends_on_cells,
        refined > 1 && change.is_single(),
    ));
    let evidence = Evidence {
        check: on_finer
            .and_then(Result::err)
            .or_else(|| leak.and_then(Result::err)),
        densities,
        unchecked: is_unchecked.then_some(unchecked),
        cell_check: subject.cell_check,
        refined,
        is_diffused: a.report.all(&NUMERICAL_DIFFUSION).next().is_some(),
        parts: zero.error,
        width: b.value - a.value,
        tolerance: options.tolerance,
        density: &density.density,
        is_noisy: density.is_noisy(),
        wider: WiderRange::of(a, subject),
    };
    let own = (
        subject.observables[change.observable],
        density.density.axes.as_slice(),
    );
    let at_rest = depends_on_cells
        .then(|| beside_fixed_point(points, &subject.family, own, checked.place, zero.value));
    let at_rest = at_rest.flatten();
    if let Some(Doubt::AtRest(Some(exact))) = at_rest {
        zero.error.grid = zero.error.grid.max((exact - zero.value).abs());
    }
    let error = zero.error.total();
    Located {
        value: zero.value,
        error,
        lower: a.value.min(zero.value - error),
        upper: b.value.max(zero.value + error),
        zero: Some(Zero {
            indicator: crossing.kind(),
            place: checked.place.to_vec(),
            slope: zero.slope,
            parts: zero.error,
            is_settled,
        }),
        doubts: at_rest.into_iter().chain(evidence.doubts()).collect(),
        ..band(&subject.observables, change, (0.0, 0.0, 0.0), None)
    }
}

pub(super) fn has_wide_cells(point: &Point) -> bool {
    point.report.findings.iter().any(Finding::is_of_wide_cells)
}

/// Whether the drift jumps inside of the cells of one of two points, and finer cells move with it.
fn follows_a_jump(check: CellCheck, pair: [&Point; 2]) -> bool {
    let CellCheck::OnFinerCells { follows, .. } = check else {
        return false;
    };
    let mut findings = pair.iter().flat_map(|point| &point.report.findings);
    findings
        .any(|one| matches!(one, Finding::JumpInsideCells { axis, .. } if follows == Some(*axis)))
}

/// What speaks against the densities on either side of a zero. What holds of one that leaks away, or has not converged,
/// is not what holds of the steady state. A jump of the drift inside of cells speaks no more against a zero that two
/// grids have which move with it.
fn against(
    pair: [&Point; 2],
    (subject, observable): (&Subject, usize),
    depends_on_cells: bool,
    is_followed: bool,
) -> Vec<Doubt> {
    let ends = pair.iter().find_map(|point| {
        let status = point.report.status;
        Doubt::of_status(status, WiderRange::of(point, subject))
    });
    let negative = |point: &&Point| Doubt::of_negative(&point.densities[observable].density);
    let share = |doubt: &Doubt| match doubt {
        Doubt::NegativeDensity(share) => *share,
        _ => 0.0,
    };
    let torn = pair
        .iter()
        .filter(|_| depends_on_cells)
        .filter_map(negative);
    let torn = torn.max_by(|a, b| share(a).total_cmp(&share(b)));
    let findings = pair.iter().flat_map(|point| &point.report.findings);
    let blurs: Vec<Doubt> = findings.filter_map(Doubt::of_finding).collect();
    let (jumps, modes): (Vec<Doubt>, Vec<Doubt>) = blurs
        .into_iter()
        .partition(|doubt| matches!(doubt, Doubt::JumpInsideCells(..)));
    let is_followed = |axis: usize| match subject.cell_check {
        CellCheck::OnFinerCells { follows, .. } => is_followed && follows == Some(axis),
        _ => false,
    };
    let is_open =
        |doubt: &Doubt| !matches!(doubt, Doubt::JumpInsideCells(axis, _) if is_followed(*axis));
    let jumps = jumps
        .into_iter()
        .filter(|jump| depends_on_cells && is_open(jump));
    ends.into_iter()
        .chain(torn)
        .chain(modes)
        .chain(jumps)
        .collect()
}

/// Mass in the outermost cells below which what leaves Ω matters nowhere.
pub(super) const QUIET: f64 = 1e-11;

/// The largest mass in the outermost cells of an axis.
fn edge_mass(point: &Point) -> f64 {
    point.report.edge_mass().unwrap_or(0.0)
}
