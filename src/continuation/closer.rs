//! Closer looks: where the cells of a sweep leave changes in doubt, the stretch around them is swept again on finer
//! cells, which say what comes and goes there.
//!
//! The stretch ends at values that the sweep has solved. What finer cells show takes the place of its rows where they
//! count at both ends what the sweep counts there, so that the rows around it still follow from each other, and where
//! they tell more of every change. Still finer cells are asked of what is not located, as often as
//! [`super::LocateOptions::effort`] allows; what they leave in doubt as well stays as the sweep has it.
//!
//! Order one is all that is claimed of finer cells. Where they are wide themselves ([`super::Finding::WideCells`]) two
//! grids may agree by chance: a row is believed where three grids or more came nearer and nearer to it, or where a look
//! before, on coarser cells, has shown it too, no farther than order one allows. Else its value is told, and that more
//! cells are needed. All that looks solve counts as work, the checks of their rows too.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use super::bands::widen;
use super::counting::{CountingSource, Solves};
use super::found::StretchFindings;
use super::in_doubt::{InDoubt, Watched};
use super::label::{Label, Located};
use super::live::{FACTORS, refined, work_of_factors};
use super::locate::has_wide_cells;
use super::look::{CloserLook, counted, with_rows};
use super::remembered::{Remembered, RememberingSource};
use super::segment::Work;
use super::solved_point::may_be_miscounted;
use super::span::{Span, evenly_spaced};
use super::walk::Walk;
use super::{CellCheck, Goal, Point, Want};
use crate::cancellation::Cancellation;
use crate::density::Observable;
use crate::topology::Signature;

/// What is looked at closer, and with what.
pub(super) struct Closer<'p, 'a> {
    work: &'a Work<'a>,
    span: Span,
    options: &'p Goal,
    in_doubt: InDoubt<'p>,
    /// The last look at each observable and stretch, with the rows that it found.
    last: Vec<CloserLook>,
    /// What looks whose rows took the place of others count at the values that they solved, the newest last.
    seen: Vec<(Observable, f64, Signature)>,
    /// What looks count at the ends of their stretches.
    at_ends: Vec<(Observable, [f64; 2], [Signature; 2])>,
    cancellation: &'a Cancellation,
    /// Work left, in values of the sweep.
    left: f64,
    /// What the looks solve.
    solves: Arc<Solves>,
    /// The solutions of looks, by how often their cells are refined.
    remembered: [Arc<Mutex<Remembered>>; MOST_LOOKS as usize],
}

/// Values of a stretch at least.
const FEWEST: usize = 5;

/// Values that are solved within a stretch beyond its given ones, about.
const BEYOND: f64 = 10.0;

/// How often cells are refined at most: work that is allowed ends the looks before.
const MOST_LOOKS: u8 = 8;

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
        let of_sweep = walk.points.len() as f64;
        let observables = &work.source().subject().observables;
        let cells = work.source().cells().map_or(f64::INFINITY, |n| n as f64);
        Self {
            work,
            span,
            options,
            in_doubt: InDoubt::of(walk, observables, span.step),
            last: Vec::new(),
            seen: Vec::new(),
            at_ends: Vec::new(),
            cancellation,
            left: options.effort * of_sweep.max(WORTH / cells),
            solves: Arc::default(),
            remembered: Default::default(),
        }
    }

    /// The rows of a sweep with those in the place of others that finer cells tell better, and what these looks found.
    pub(super) fn labels(mut self, labels: Vec<Label>) -> (Vec<Label>, Vec<CloserLook>) {
        let is_wanted = self.options.grid_check && self.left > 0.0;
        let is_possible = matches!(
            self.work.source().subject().cell_check,
            CellCheck::OnFinerCells { .. }
        );
        if !is_wanted || !is_possible || self.in_doubt.points().len() < 2 {
            return (labels, Vec::new());
        }
        let mut looks = Vec::new();
        let labels = with_rows(labels, |rows| {
            for times in 1..=MOST_LOOKS {
                let observables = self.work.source().subject().observables.iter();
                for (place, &observable) in observables.enumerate() {
                    for stretch in self.in_doubt.stretches(rows, (place, observable), times) {
                        let of = (place, observable);
                        let Some((look, found)) = self.look(of, stretch, times, rows) else {
                            continue;
                        };
                        let is_taken = look.replace(rows);
                        self.in_doubt
                            .settle((place, look.stretch), &found, is_taken);
                        if is_taken {
                            self.seen.extend(found.seen(observable));
                        }
                        if is_taken {
                            looks.push(look);
                        } else {
                            let settled = found.settled(observable).into_iter();
                            let points = self.in_doubt.points();
                            let is_so =
                                |part: &CloserLook| part.shows_nothing(rows, (place, points));
                            looks.extend(settled.filter(is_so));
                        }
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
        of: Watched,
        mut stretch: [f64; 2],
        times: u8,
        rows: &[Located],
    ) -> Option<(CloserLook, StretchFindings)> {
        for _ in 0..2 {
            let found = self.swept(of, stretch, times)?;
            let ends = self.ends(&found, of, stretch);
            let is_better = found.is_better(self.in_doubt.points(), of.0, stretch);
            if let Some(ends) = ends.filter(|_| is_better) {
                let look = self.believed(&found, (of, stretch, ends), rows)?;
                return Some((look, found));
            }
            stretch = self.in_doubt.next_wider(stretch, rows, of.1)?;
        }
        None
    }

    /// What is believed of what finer cells show of a stretch, between ends at which they are right.
    fn believed(
        &mut self,
        found: &StretchFindings,
        (of, stretch, ends): (Watched, [f64; 2], [Signature; 2]),
        rows: &[Located],
    ) -> Option<CloserLook> {
        let mut look = CloserLook {
            observable: of.1,
            stretch,
            ends,
            rows: found.rows.clone(),
        };
        let before = self.before(&look, rows);
        let is_proven = |row: &Located| !found.is_wide || self.is_proven(row, &before);
        let proven: Vec<bool> = look.rows.iter().map(is_proven).collect();
        self.last.retain(|one| !one.is_at(&look));
        self.last.push(look.clone());
        self.widen(stretch, &mut look.rows, &before);
        look.doubt(&proven);
        // That nothing happens is no more than what two grids may agree on by chance.
        let is_chance = look.rows.is_empty() && found.is_wide && !before.is_empty();
        (!is_chance).then_some(look)
    }

    /// What the sweep counts at the ends of a stretch, if finer cells count the same, or what an earlier look whose
    /// rows are kept has counted there. At its own end the sweep is not believed against two finer grids that count the
    /// same; where its cells are wide there, or show what may be an error, not against one whose cells are not.
    fn ends(
        &mut self,
        found: &StretchFindings,
        (place, observable): Watched,
        stretch: [f64; 2],
    ) -> Option<[Signature; 2]> {
        let [below, above] = stretch.map(|value| found.counted(value));
        let own = [below?, above?];
        let points = self.in_doubt.points();
        let [below, above] = stretch.map(|value| counted(points.iter().copied(), value, place));
        let of_sweep = [below?, above?];
        let is_known = self.at_ends.contains(&(observable, stretch, own));
        self.at_ends.push((observable, stretch, own));
        let detector = self.work.detector();
        let is_free = |end: usize| {
            let own = if end == 0 {
                points.first()
            } else {
                points.last()
            };
            let is_unsure =
                |one: &Point| has_wide_cells(one) || may_be_miscounted(one, place, detector);
            let own = own.filter(|one| one.value == stretch[end]);
            own.is_some_and(|one| is_known || is_unsure(one) && !found.is_wide)
        };
        let small = 1e-6 * self.span.step;
        let is_seen = |end: usize| {
            let mut seen = self.seen.iter().rev();
            let last =
                seen.find(|one| one.0 == observable && (one.1 - stretch[end]).abs() <= small);
            last.is_some_and(|one| one.2 == own[end])
        };
        let is_right = |end: usize| own[end] == of_sweep[end] || is_seen(end) || is_free(end);
        (is_right(0) && is_right(1)).then_some(of_sweep)
    }

    /// What was seen on coarser cells in the stretch of a look: by the last look there, or else by the sweep.
    fn before(&self, look: &CloserLook, rows: &[Located]) -> Vec<Located> {
        let last = self.last.iter().find(|one| one.is_at(look));
        let of_sweep = || rows.iter().filter(|row| look.holds(row)).cloned().collect();
        last.map_or_else(of_sweep, |one| one.rows.clone())
    }

    /// Whether a row on wide cells is no chance: finer and finer cells came nearer and nearer to it, or one like it was
    /// seen before, and it is nearer to that than errors of order one allow. Errors that fall by the ratio r of the
    /// cells leave d / (r - 1) after a distance d, of which the next grid takes the share (r - 1) / r.
    fn is_proven(&self, row: &Located, before: &[Located]) -> bool {
        let CellCheck::OnFinerCells { ratio, .. } = self.work.source().subject().cell_check else {
            return false;
        };
        let is_like = |one: &Located| {
            let is_same =
                one.change() == row.change() && (one.before, one.after) == (row.before, row.after);
            is_same && (one.value - row.value).abs() <= one.error * (ratio - 1.0) / ratio
        };
        row.zero.as_ref().is_some_and(|zero| zero.is_settled) || before.iter().any(is_like)
    }

    /// Widens bands that are read off counts and lost indicators by those on the cells before.
    fn widen(&self, stretch: [f64; 2], rows: &mut [Located], before: &[Located]) {
        let CellCheck::OnFinerCells { ratio, .. } = self.work.source().subject().cell_check else {
            return;
        };
        for row in rows.iter_mut().filter(|row| row.zero.is_none()) {
            let mut before = before.iter();
            let like = before.find(|one| (one.before, one.after) == (row.before, row.after));
            if let Some(coarse) = like {
                widen(row, coarse.hull(), ratio, stretch);
            }
        }
    }

    /// What finer cells show in a stretch; `None` where there are none, or no work is left for them.
    fn swept(
        &mut self,
        (place, _): Watched,
        stretch: [f64; 2],
        times: u8,
    ) -> Option<StretchFindings> {
        let steps = ((stretch[1] - stretch[0]) / self.span.step).ceil() as usize;
        let values = evenly_spaced((stretch[0], stretch[1]), FEWEST.max(steps + 1));
        let planned = values.len() as f64 + BEYOND;
        if planned * self.cost(times) > self.left || self.cancellation.is_cancelled() {
            return None;
        }
        let want = Want {
            errors: true,
            ..Want::densities(&self.work.source().subject().observables)
        };
        let source = refined(self.work.source(), &want, times).ok()??;
        let source = CountingSource::new(source, times, &self.solves);
        let remembered = &self.remembered[usize::from(times - 1)];
        let source = RememberingSource::new(source, place, remembered);
        self.work.tell_of_closer_look(stretch);
        let span = Span::over(stretch, values.len());
        let mut nobody = ();
        let work = Work::new(
            (&source, self.work.detector()),
            self.cancellation,
            (&mut nobody, values.len()),
            self.options.largest_distance,
            None,
        )
        .needing_all();
        let options = Goal {
            is_closer: true,
            effort: self.effort_of_checks(planned, times),
            ..self.options.clone()
        };
        let most = self.left / self.cost(times) - values.len() as f64;
        let walk = Walk::along(&work, (&values, most as usize), (span, options)).ok()?;
        let is_whole = !work.has_ended() && !self.cancellation.is_cancelled();
        if !is_whole {
            // How many were solved before one that has no steady state depends on the number of threads.
            self.counted(times);
            self.left -= planned * self.cost(times);
            return None;
        }
        let (labels, ..) = walk.labels(self.cancellation, Vec::new());
        self.left -= self.counted(times);
        let rows = labels.into_iter().filter_map(|label| match label {
            Label::Bifurcation(row) => Some(*row),
            _ => None,
        });
        Some(StretchFindings {
            rows: rows.collect(),
            unsure: walk.unsure.iter().map(|one| one.1).collect(),
            is_wide: walk.points.iter().any(has_wide_cells),
            points: walk.points,
        })
    }

    /// Work for checks on cells that are refined more than once, for each of so many values of a look, in values of it
    /// of which factors take as much as of one of the sweep: what its values leave of all work.
    fn effort_of_checks(&self, planned: f64, times: u8) -> f64 {
        let left = self.left - planned * self.cost(times);
        let share = FACTORS / self.cost_of_factors(times);
        (left.max(0.0) * share / planned).min(self.options.effort)
    }

    /// What a look with cells that are refined so many times has solved, in values of the sweep. Checks of rows, on
    /// still finer cells, take no more than their factors do.
    fn counted(&self, times: u8) -> f64 {
        let all = (0..).zip(self.solves.iter());
        let solved = all.map(|(at, solved)| (at, solved.swap(0, Ordering::Relaxed)));
        let solved = solved.filter(|one| one.1 > 0);
        solved
            .map(|(at, number)| {
                let each = if at > times {
                    self.cost_of_factors(at)
                } else {
                    self.cost(at)
                };
                number as f64 * each
            })
            .sum()
    }

    /// What a value costs on cells that are refined so many times, in values of the sweep.
    fn cost(&self, times: u8) -> f64 {
        let of_cells = self.finer(times).powi(self.axes() as i32);
        (1.0 - FACTORS) * of_cells + self.cost_of_factors(times)
    }

    /// What factors take of it.
    fn cost_of_factors(&self, times: u8) -> f64 {
        work_of_factors(self.finer(times), self.axes())
    }

    /// How many times as many cells an axis has that is refined so many times; no end of them where it cannot be.
    fn finer(&self, times: u8) -> f64 {
        match self.work.source().subject().cell_check {
            CellCheck::OnFinerCells { ratio, .. } => ratio.powi(i32::from(times)),
            _ => f64::INFINITY,
        }
    }

    fn axes(&self) -> usize {
        self.work.source().subject().family.model().axes.len()
    }
}
