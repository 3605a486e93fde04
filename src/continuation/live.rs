//! The checks of located values by solves: on finer cells, and between ends of Ω that let nothing out.

use super::grid::{
    Checked, CheckedBy, CheckedIndicator, Checks, GridCheck, Leak, Seen, check, known, leak, solve,
};
use super::span::Span;
use super::{DensitySource, KeptCheck, Observer, Session, SourceError, Want};
use crate::cancellation::Cancellation;
use crate::topology::Detector;

/// A check: its source, and what is known of its session.
#[derive(Default)]
struct Check {
    session: Opened,
    /// What solves that are not repeated have left for it.
    left: Vec<(f64, Vec<u8>)>,
}

/// A session that is opened when it is first asked.
#[derive(Default)]
enum Opened {
    #[default]
    NotYet,
    Open(Box<dyn Session>),
    /// There is no such source.
    None,
    Failed(String),
}

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// The checks of a sweep.
pub(super) struct Live<'a> {
    /// `None` where no check is wanted.
    source: Option<&'a dyn DensitySource>,
    detector: &'a dyn Detector,
    cancellation: &'a Cancellation,
    observer: &'a mut dyn Observer,
    span: Span,
    tolerance: f64,
    finer: Check,
    enclosed: Check,
    /// What was seen before this sweep went on; `None` before it was asked for.
    kept: Option<Vec<KeptCheck>>,
    seen: Vec<CheckedIndicator>,
    /// Why nothing more can be seen.
    failure: Option<Failure>,
}

impl<'a> Live<'a> {
    pub(super) fn new(
        source: Option<&'a dyn DensitySource>,
        detector: &'a dyn Detector,
        (cancellation, observer): (&'a Cancellation, &'a mut dyn Observer),
        (span, tolerance): (Span, f64),
    ) -> Self {
        Self {
            source,
            detector,
            cancellation,
            observer,
            span,
            tolerance,
            finer: Check::default(),
            enclosed: Check::default(),
            kept: None,
            seen: Vec::new(),
            failure: None,
        }
    }

    /// What was seen; `None` where there was nothing to check with.
    ///
    /// # Errors
    /// Why the checks could not go on.
    pub(super) fn seen(self) -> Result<Option<Vec<CheckedIndicator>>, Failure> {
        if let Some(failure) = self.failure {
            return Err(failure);
        }
        let wanted = self.source.is_some() && !matches!(self.finer.session, Opened::None);
        Ok(wanted.then_some(self.seen))
    }

    fn open(&self, by: CheckedBy) -> Opened {
        let Some(source) = self.source else {
            return Opened::None;
        };
        // One session checks what is found in all of them.
        let want = Want::densities(&source.subject().observables);
        let found = match by {
            CheckedBy::FinerCells => source.finer(&want),
            CheckedBy::ClosedEnds => Ok(source.enclosed(&want)),
        };
        match found {
            Ok(Some(source)) => Opened::Open(source.open(self.cancellation)),
            Ok(None) | Err(SourceError::Interrupted) => Opened::None,
            Err(SourceError::Method(error)) => Opened::Failed(error.to_string()),
        }
    }

    fn check(&mut self, by: CheckedBy) -> &mut Check {
        match by {
            CheckedBy::FinerCells => &mut self.finer,
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
        if let Some(seen) = self.kept(by, checked, value) {
            return Some(seen);
        }
        if self.failure.is_some() {
            return Some(Seen::Unknown);
        }
        if matches!(self.check(by).session, Opened::NotYet) {
            self.check(by).session = self.open(by);
        }
        let detector = self.detector;
        let Check { session, left } = self.check(by);
        let (found, left) = match session {
            Opened::NotYet | Opened::None => return None,
            Opened::Failed(reason) => (Seen::Failed(reason.clone()), None),
            Opened::Open(session) => {
                if let Err(error) = recall(session.as_mut(), std::mem::take(left)) {
                    if let SourceError::Method(error) = error {
                        self.failure = Some(error);
                    }
                    return Some(Seen::Unknown);
                }
                let seen = solve(session.as_mut(), detector, checked, value);
                (seen, Some(session.memory()))
            }
        };
        if let Some(seen) = found.record(by, checked, value) {
            let check = KeptCheck { seen, left };
            self.failure = self.observer.checked(&check).err();
            self.seen.push(check.seen);
        }
        Some(found)
    }

    /// What was seen of it before this sweep went on, which is then seen again.
    fn kept(&mut self, by: CheckedBy, checked: &Checked<'_>, value: f64) -> Option<Seen> {
        let observer = &mut self.observer;
        let kept = self.kept.get_or_insert_with(|| observer.kept_checks());
        let seen = |one: &KeptCheck| known(std::slice::from_ref(&one.seen), by, checked, value);
        let place = kept.iter().position(|one| seen(one) != Seen::Unknown)?;
        let check = kept.remove(place);
        let found = seen(&check);
        if let Some(left) = check.left {
            self.check(by).left.push((value, left));
        }
        self.seen.push(check.seen);
        Some(found)
    }
}

/// Brings a session to where an earlier one was.
fn recall(session: &mut dyn Session, left: Vec<(f64, Vec<u8>)>) -> Result<(), SourceError> {
    if left.is_empty() {
        return Ok(());
    }
    let left: Vec<(f64, &[u8])> = left.iter().map(|(at, bytes)| (*at, &bytes[..])).collect();
    session.recall(&left)
}

impl Checks for Live<'_> {
    fn on_finer_cells(&mut self, checked: &Checked<'_>) -> Option<GridCheck> {
        let (span, tolerance) = (self.span, self.tolerance);
        let mut evaluate = |value: f64| {
            let seen = self.evaluate(CheckedBy::FinerCells, checked, value);
            seen.unwrap_or(Seen::Unknown)
        };
        check(&mut evaluate, checked, span, tolerance)
    }

    fn between_closed_ends(&mut self, checked: &Checked<'_>) -> Option<Leak> {
        let seen = self.evaluate(CheckedBy::ClosedEnds, checked, checked.root.value)?;
        leak(seen, checked)
    }
}
