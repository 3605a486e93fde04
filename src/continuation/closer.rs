//! Closer looks: where the cells of a sweep leave changes in doubt, the stretch around them is swept again on finer
//! cells, which say what comes and goes there.
//!
//! The stretch ends at values that the sweep has solved. What finer cells show takes the place of its rows where they
//! count at both ends what the sweep counts there, so that the rows around it still follow from each other, and where
//! they tell more of every change. Still finer cells are asked of what is not located, as often as
//! [`super::LocateOptions::effort`] allows; what they leave in doubt as well stays as the sweep has it.
//!
//! Order one is all that is claimed of finer cells. Where they are wide themselves ([`super::Finding::WideCells`]) two
//! grids may agree by chance: what they show is believed where a look before, on coarser cells, has shown the same, and
//! each row has moved by no more than order one allows. Else values are told, and that more cells are needed.

use super::doubt::MOST_TIMES;
use super::label::{Label, Located};
use super::live::{FACTORS, refined, work_of_factors};
use super::locate::has_wide_cells;
use super::look::{CloserLook, counted, with_rows};
use super::segment::Work;
use super::span::{Span, evenly_spaced};
use super::walk::Walk;
use super::{CellCheck, Doubt, Goal, Point, Want};
use crate::cancellation::Cancellation;
use crate::density::{EstimatedDensity, Observable};
use crate::topology::Signature;

/// What is looked at closer, and with what.
pub(super) struct Closer<'p, 'a> {
    work: &'a Work<'a>,
    span: Span,
    options: &'p Goal,
    /// Of the sweep, with densities; ascending.
    points: Vec<&'p Point>,
    /// Places of observables, and values, at which it is not known whether a pair of peak and saddle is there.
    unsure: Vec<(usize, f64)>,
    /// The last look at each observable and stretch, with the rows that it found.
    last: Vec<CloserLook>,
    cancellation: &'a Cancellation,
    /// Work left, in solves of the sweep.
    left: f64,
}

/// Values of a stretch at least.
const FEWEST: usize = 5;

/// Values that are solved within a stretch beyond its given ones, about.
const BEYOND: f64 = 10.0;

/// Work that is worth an answer whatever the sweep took, in cells that are solved: those of 200 values on 100 × 100
/// cells.
const WORTH: f64 = 2e6;

impl<'p, 'a> Closer<'p, 'a> {
    pub(super) fn new(
        (work, span): (&'a Work<'a>, Span),
        options: &'p Goal,
        walk: &'p Walk<'_>,
        cancellation: &'a Cancellation,
    ) -> Self {
        let points = &walk.points;
        let of_sweep = points.len() as f64;
        let cells = work.source().cells().map_or(f64::INFINITY, |n| n as f64);
        Self {
            work,
            span,
            options,
            points: points
                .iter()
                .filter(|one| !one.detections.is_empty())
                .collect(),
            unsure: walk.unsure.clone(),
            last: Vec::new(),
            cancellation,
            left: options.effort * of_sweep.max(WORTH / cells),
        }
    }

    /// The rows of a sweep with those in the place of others that finer cells tell better, and what these looks found.
    pub(super) fn labels(mut self, labels: Vec<Label>) -> (Vec<Label>, Vec<CloserLook>) {
        let is_wanted = self.options.grid_check && self.left > 0.0;
        let is_possible = matches!(
            self.work.source().subject().cell_check,
            CellCheck::OnFinerCells { .. }
        );
        if !is_wanted || !is_possible || self.points.len() < 2 {
            return (labels, Vec::new());
        }
        let mut looks = Vec::new();
        let labels = with_rows(labels, |rows| {
            for times in 1..=MOST_TIMES {
                let observables = self.work.source().subject().observables.iter();
                for (place, &observable) in observables.enumerate() {
                    for stretch in self.stretches(rows, (place, observable)) {
                        let found = self.look((place, observable), stretch, times, rows);
                        looks.extend(found.filter(|look| look.replace(rows)));
                    }
                }
            }
        });
        (labels, looks)
    }

    /// Sweeps a stretch on cells that are refined so many times, and a wider one where its ends are not what the sweep
    /// counts there.
    fn look(
        &mut self,
        of: (usize, Observable),
        mut stretch: [f64; 2],
        times: u8,
        rows: &[Located],
    ) -> Option<CloserLook> {
        for _ in 0..2 {
            let found = self.swept(of, stretch, times)?;
            if let Some(ends) = found.continues(&self.points, of.0, stretch) {
                let mut look = CloserLook {
                    observable: of.1,
                    stretch,
                    ends,
                    rows: found.rows,
                };
                let is_proven = !found.is_wide || self.converges(&look, rows);
                let is_same = |one: &CloserLook| one.is_at(&look);
                self.last.retain(|one| !is_same(one));
                self.last.push(look.clone());
                if found.is_sure && !found.is_wide {
                    let [lower, upper] = stretch;
                    let is_there =
                        |one: &(usize, f64)| one.0 == of.0 && (lower..=upper).contains(&one.1);
                    self.unsure.retain(|one| !is_there(one));
                }
                if !is_proven {
                    look.doubt();
                }
                // That nothing happens is no more than what two grids may agree on by chance.
                return (is_proven || !look.rows.is_empty()).then_some(look);
            }
            let wider = self.wider(stretch, self.span.step);
            if wider == stretch {
                break;
            }
            stretch = self.around_rows(rows, of.1, wider);
        }
        None
    }

    /// Whether a look shows what was seen there on coarser cells, and each of its rows is nearer to the row seen then
    /// than errors of order one allow: errors that fall by the ratio r of the cells leave d / (r - 1) after a distance
    /// d, of which the next grid takes the share (r - 1) / r.
    fn converges(&self, look: &CloserLook, rows: &[Located]) -> bool {
        let CellCheck::OnFinerCells { ratio } = self.work.source().subject().cell_check else {
            return false;
        };
        let of_sweep = || rows.iter().filter(|row| look.holds(row)).collect();
        let last = self.last.iter().find(|one| one.is_at(look));
        let before: Vec<&Located> = last.map_or_else(of_sweep, |one| one.rows.iter().collect());
        let mut pairs = before.iter().zip(&look.rows);
        before.len() == look.rows.len()
            && pairs.all(|(before, row)| {
                let is_same = before.change() == row.change()
                    && (before.before, before.after) == (row.before, row.after);
                is_same && (before.value - row.value).abs() <= before.error * (ratio - 1.0) / ratio
            })
    }

    /// What finer cells show in a stretch; `None` where there are none, or no work is left for them.
    fn swept(
        &mut self,
        (_, observable): (usize, Observable),
        stretch: [f64; 2],
        times: u8,
    ) -> Option<Found> {
        let steps = ((stretch[1] - stretch[0]) / self.span.step).ceil() as usize;
        let values = evenly_spaced((stretch[0], stretch[1]), FEWEST.max(steps + 1));
        let each = self.cost(times);
        if (values.len() as f64 + BEYOND) * each > self.left || self.cancellation.is_cancelled() {
            return None;
        }
        let want = Want {
            errors: true,
            ..Want::densities(&[observable])
        };
        let source = refined(self.work.source(), &want, times).ok()??;
        self.work.tell_of_closer_look(stretch);
        let span = Span::over(stretch, values.len());
        let mut nobody = ();
        let work = Work::new(
            (&*source, self.work.detector()),
            self.cancellation,
            (&mut nobody, values.len()),
            self.options.largest_distance,
            None,
        )
        .needing_all();
        let options = Goal {
            is_closer: true,
            ..self.options.clone()
        };
        let walk = Walk::along(&work, &values, (span, options)).ok()?;
        let is_whole = !work.has_ended() && !self.cancellation.is_cancelled();
        // How many were solved before one that has no steady state depends on the number of threads.
        let solved = if is_whole {
            walk.points.len() as f64
        } else {
            values.len() as f64 + BEYOND
        };
        self.left -= solved * each;
        if !is_whole {
            return None;
        }
        let (labels, ..) = walk.labels(self.cancellation, Vec::new());
        let rows = labels.into_iter().filter_map(|label| match label {
            Label::Bifurcation(row) => Some(*row),
            _ => None,
        });
        Some(Found {
            rows: rows.collect(),
            is_sure: walk.unsure.is_empty(),
            is_wide: walk.points.iter().any(has_wide_cells),
            points: walk.points,
        })
    }

    /// What a value costs on cells that are refined so many times, in values of the sweep.
    fn cost(&self, times: u8) -> f64 {
        let subject = self.work.source().subject();
        let CellCheck::OnFinerCells { ratio } = subject.cell_check else {
            return f64::INFINITY;
        };
        let axes = subject.family.model().axes.len();
        let finer = ratio.powi(i32::from(times));
        (1.0 - FACTORS) * finer.powi(axes as i32) + work_of_factors(finer, axes)
    }

    /// Stretches around the rows of an observable that finer cells may tell better, and around values at which they may
    /// tell whether a pair is there, apart from each other.
    fn stretches(&self, rows: &[Located], of: (usize, Observable)) -> Vec<[f64; 2]> {
        let in_doubt = rows
            .iter()
            .filter(|row| row.observable == of.1 && is_of_cells(row));
        let unsure = self.unsure.iter().filter(|one| one.0 == of.0);
        let in_doubt = in_doubt.map(hull).chain(unsure.map(|one| [one.1; 2]));
        let mut in_doubt: Vec<[f64; 2]> = in_doubt.collect();
        in_doubt.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut found: Vec<[f64; 2]> = Vec::new();
        for [lower, upper] in in_doubt {
            let margin = (0.25 * (upper - lower)).max(0.5 * self.span.step);
            let around = self.wider([lower, upper], margin);
            let mut around = self.around_rows(rows, of.1, around);
            while let Some(last) = found.pop_if(|last| last[1] >= around[0]) {
                around = [last[0].min(around[0]), last[1].max(around[1])];
            }
            found.push(around);
        }
        found
    }

    /// The solved values that lie outside of a stretch by a margin, or the ends of the sweep.
    fn wider(&self, [lower, upper]: [f64; 2], margin: f64) -> [f64; 2] {
        let values = || self.points.iter().map(|point| point.value);
        let ends = [
            self.points[0].value,
            self.points[self.points.len() - 1].value,
        ];
        let below = values().rfind(|value| *value <= lower - margin);
        let above = values().find(|value| *value >= upper + margin);
        [below.unwrap_or(ends[0]), above.unwrap_or(ends[1])]
    }

    /// A stretch with all of the rows that lie in a part of it.
    fn around_rows(
        &self,
        rows: &[Located],
        observable: Observable,
        mut stretch: [f64; 2],
    ) -> [f64; 2] {
        for _ in 0..rows.len() {
            let cut = rows
                .iter()
                .filter(|row| row.observable == observable)
                .find(|row| {
                    let [lower, upper] = hull(row);
                    let is_inside = stretch[0] < lower && upper < stretch[1];
                    let is_at_end = stretch == self.wider([lower, upper], 0.0);
                    let is_outside = upper < stretch[0] || stretch[1] < lower;
                    !is_inside && !is_outside && !is_at_end
                });
            let Some(cut) = cut else { break };
            let [lower, upper] = hull(cut);
            let wider = self.wider([lower.min(stretch[0]), upper.max(stretch[1])], 0.0);
            if wider == stretch {
                break;
            }
            stretch = wider;
        }
        stretch
    }
}

/// What finer cells show of one observable in a stretch.
struct Found {
    rows: Vec<Located>,
    points: Vec<Point>,
    /// Whether finer cells tell at all of their values whether a pair is there.
    is_sure: bool,
    /// Whether they are wide themselves.
    is_wide: bool,
}

impl Found {
    /// What is counted at the ends of the stretch, if that is what the sweep counts there, all in between is seen
    /// whole, and its errors are smaller than the sweep's. Where errors are larger, what is not counted may be there
    /// all the same.
    fn continues(
        &self,
        points: &[&Point],
        place: usize,
        [lower, upper]: [f64; 2],
    ) -> Option<[Signature; 2]> {
        let is_whole = |point: &Point| {
            let mut densities = point.densities.iter();
            point.report.status.is_resolved()
                && point.detections.iter().all(|one| one.is_seen)
                && densities.all(|one| Doubt::of_negative(&one.density).is_none())
        };
        let within = points
            .iter()
            .filter(|point| (lower..=upper).contains(&point.value));
        let before = within.filter_map(|point| point.densities.get(place));
        let own = self
            .points
            .iter()
            .filter_map(|point| point.densities.first());
        let is_surer = largest_error(own) <= largest_error(before);
        let counted = [lower, upper].map(|value| {
            let own = counted(self.points.iter(), value, 0);
            own.filter(|own| counted(points.iter().copied(), value, place) == Some(*own))
        });
        let [below, above] = counted;
        let ends = [below?, above?];
        (is_surer && self.points.iter().all(is_whole)).then_some(ends)
    }
}

/// The largest error of densities, as a share of their mass.
fn largest_error<'d>(densities: impl Iterator<Item = &'d EstimatedDensity>) -> f64 {
    let error = |one: &EstimatedDensity| {
        let volumes = one.density.volumes();
        let errors = one.standard_error.iter().zip(&volumes);
        errors.map(|(error, volume)| error * volume).sum()
    };
    densities.map(error).fold(0.0, f64::max)
}

/// Where a row may lie.
fn hull(row: &Located) -> [f64; 2] {
    [
        row.lower.min(row.value - row.error),
        row.upper.max(row.value + row.error),
    ]
}

/// Whether finer cells may tell more of a row.
fn is_of_cells(row: &Located) -> bool {
    row.reason().is_some_and(Doubt::is_of_cells)
}
