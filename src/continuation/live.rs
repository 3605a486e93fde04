//! The checks of located values by solves: on finer cells, and between ends of Ω that let nothing out.

use super::doubt::{CheckedBy, Doubt, MOST_TIMES};
use super::grid::{Checked, CheckedIndicator, Checks, FinerZero, Seen, check, known, leak, solve};
use super::span::Span;
use super::{CellCheck, DensitySource, Session, SourceError, Want};
use crate::cancellation::Cancellation;
use crate::topology::Detector;

/// The session of a check, opened when it is first asked.
#[derive(Default)]
enum Opened {
    #[default]
    NotYet,
    Open(Box<dyn Session>),
    /// There is no such source.
    None,
    Failed(String),
}

/// The checks of a sweep.
pub(super) struct Live<'a> {
    /// `None` where no check is wanted.
    source: Option<&'a dyn DensitySource>,
    detector: &'a dyn Detector,
    cancellation: &'a Cancellation,
    /// What was seen before.
    known: Vec<CheckedIndicator>,
    span: Span,
    tolerance: f64,
    /// On cells refined once, twice, and so on.
    finer: [Opened; MOST_TIMES as usize],
    enclosed: Opened,
    seen: Vec<CheckedIndicator>,
    /// Work left for cells that are refined more than once, in solves of the sweep.
    effort: f64,
}

impl<'a> Live<'a> {
    pub(super) fn new(
        source: Option<&'a dyn DensitySource>,
        detector: &'a dyn Detector,
        (cancellation, known): (&'a Cancellation, Vec<CheckedIndicator>),
        (span, tolerance, effort): (Span, f64, f64),
    ) -> Self {
        Self {
            source,
            detector,
            cancellation,
            known,
            span,
            tolerance,
            finer: Default::default(),
            enclosed: Opened::default(),
            seen: Vec::new(),
            effort,
        }
    }

    /// What was seen; `None` where there was nothing to check with.
    pub(super) fn seen(self) -> Option<Vec<CheckedIndicator>> {
        let wanted = self.source.is_some() && !matches!(self.finer[0], Opened::None);
        wanted.then_some(self.seen)
    }

    fn open(&self, by: CheckedBy) -> Opened {
        let Some(source) = self.source else {
            return Opened::None;
        };
        // One session checks what is found in all of them.
        let want = Want::densities(&source.subject().observables);
        let found = match by {
            CheckedBy::FinerCells(times) => refined(source, &want, times),
            CheckedBy::ClosedEnds => Ok(source.enclosed(&want)),
        };
        match found {
            Ok(Some(source)) => Opened::Open(source.open(self.cancellation)),
            Ok(None) | Err(SourceError::Interrupted) => Opened::None,
            Err(SourceError::Method(error)) => Opened::Failed(error.to_string()),
        }
    }

    fn check(&mut self, by: CheckedBy) -> &mut Opened {
        match by {
            CheckedBy::FinerCells(times) => {
                let place = usize::from(times.clamp(1, MOST_TIMES)) - 1;
                &mut self.finer[place]
            }
            CheckedBy::ClosedEnds => &mut self.enclosed,
        }
    }

    /// The indicator at a value, by a solve unless it was seen there before; `None` where there is nothing to check
    /// with.
    fn evaluate(&mut self, by: CheckedBy, checked: &Checked<'_>, value: f64) -> Option<Seen> {
        self.source?;
        let before = known(&self.seen, by, checked, value);
        if before != Seen::Unknown {
            return Some(before);
        }
        let mut found = known(&self.known, by, checked, value);
        if found == Seen::Unknown {
            if matches!(self.check(by), Opened::NotYet) {
                *self.check(by) = self.open(by);
            }
            let detector = self.detector;
            found = match self.check(by) {
                Opened::NotYet | Opened::None => return None,
                Opened::Failed(reason) => Seen::Failed(reason.clone()),
                Opened::Open(session) => solve(session.as_mut(), detector, checked, value),
            };
        }
        self.seen.extend(found.record(by, checked, value));
        self.effort -= self.work(by);
        Some(found)
    }

    /// What a solve of a check costs beyond the first refinement, in solves of the sweep.
    fn work(&self, by: CheckedBy) -> f64 {
        let Some(subject) = self.source.map(DensitySource::subject) else {
            return 0.0;
        };
        match (by, subject.cell_check) {
            (CheckedBy::FinerCells(times @ 2..), CellCheck::OnFinerCells { ratio, .. }) => {
                work_of_factors(
                    ratio.powi(i32::from(times)),
                    subject.family.model().axes.len(),
                )
            }
            _ => 0.0,
        }
    }
}

/// The source whose cells are refined so many times.
pub(super) fn refined(
    source: &dyn DensitySource,
    want: &Want,
    times: u8,
) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
    let mut found = source.finer(want)?;
    for _ in 1..times {
        found = match found {
            Some(source) => source.finer(want)?,
            None => None,
        };
    }
    Ok(found)
}

/// What factors take of a value of a sweep, with detection and all that is written: a tenth, measured with 80 × 80 to
/// 100 × 100 cells.
pub(super) const FACTORS: f64 = 0.1;

/// What factors take with so many times as many cells an axis, in values of a sweep: a factorisation by nested
/// dissection takes n^(3(d - 1)) operations with n cells on each of d axes.
pub(super) fn work_of_factors(finer: f64, axes: usize) -> f64 {
    FACTORS * finer.powi(3 * (axes.max(2) as i32 - 1))
}

/// Solves that a value takes at least: one at the zero, and one that shows the change of sign.
const SOLVES: f64 = 2.0;

impl Checks for Live<'_> {
    fn on_finer_cells(
        &mut self,
        checked: &Checked<'_>,
        times: u8,
    ) -> Option<Result<FinerZero, Doubt>> {
        let (span, tolerance) = (self.span, self.tolerance);
        let by = CheckedBy::FinerCells(times);
        if SOLVES * self.work(by) > self.effort.max(0.0) {
            return None;
        }
        let mut evaluate = |value: f64| {
            let seen = self.evaluate(by, checked, value);
            seen.unwrap_or(Seen::Unknown)
        };
        check(&mut evaluate, checked, span, tolerance)
    }

    fn between_closed_ends(&mut self, checked: &Checked<'_>) -> Option<Result<f64, Doubt>> {
        let seen = self.evaluate(CheckedBy::ClosedEnds, checked, checked.root.value)?;
        leak(seen, checked)
    }
}
