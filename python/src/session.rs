//! A session: values solved one after the other, each from what was solved before.

use std::sync::{Arc, Mutex, TryLockError};

use pbif::cancellation::Cancellation;
use pbif::continuation::{DensitySource as _, Point, SourceError};
use pbif::sweep_file::Sweep;
use pbif::topology::Detector as _;
use pyo3::prelude::*;

use crate::drift::Failure;
use crate::error;
use crate::found::Found;
use crate::watch::watched;

/// A session that is open, and what ends its work.
type Open = (Box<dyn pbif::continuation::Session>, Cancellation);

/// Solves values of the parameter and remembers what it solved.
#[pyclass(frozen, module = "pbif._pbif")]
pub(crate) struct Session {
    sweep: Arc<Sweep>,
    open: Mutex<Option<Open>>,
    /// What a drift in Python has raised.
    failure: Option<Arc<Failure>>,
}

impl Session {
    pub(crate) fn new(sweep: &Arc<Sweep>, failure: Option<Arc<Failure>>) -> Self {
        Self {
            sweep: Arc::clone(sweep),
            open: Mutex::default(),
            failure,
        }
    }

    /// The value with what is found there.
    fn point(
        &self,
        open: &mut Option<Open>,
        given: (f64, Cancellation),
    ) -> Result<Point, SourceError> {
        let (value, cancellation) = given;
        let clock = std::time::Instant::now();
        let (session, _) = match open {
            Some(open) => open,
            closed => {
                let source = self.sweep.source(&cancellation)?;
                closed.insert((source.open(&cancellation), cancellation))
            }
        };
        let solution = session.solve(value)?.detached();
        let detector = self.sweep.detector();
        let densities = solution.densities.iter();
        Ok(Point {
            value,
            detections: densities.map(|one| detector.detect(one)).collect(),
            report: solution.report,
            densities: solution.densities,
            distance: None,
            seconds: clock.elapsed().as_secs_f64(),
        })
    }
}

#[pymethods]
impl Session {
    /// Solves a value. What was interrupted leaves the session closed: the next solve begins anew.
    fn solve(&self, py: Python<'_>, value: f64) -> PyResult<Found> {
        // Whoever waits for a lock must not hold the interpreter that the holder waits for.
        let mut open = match self.open.try_lock() {
            Ok(open) => open,
            Err(TryLockError::Poisoned(open)) => open.into_inner(),
            Err(TryLockError::WouldBlock) => {
                let words = "the session is at work in another thread: give each thread its own";
                return Err(error::other(py, words));
            }
        };
        let cancellation = open
            .as_ref()
            .map_or_else(Cancellation::new, |open| open.1.clone());
        let state = &mut *open;
        let (point, raised) = watched(py, &cancellation, None, self.failure.as_deref(), |_| {
            self.point(state, (value, cancellation.clone()))
        });
        if let Some(raised) = raised {
            *open = None;
            return Err(raised);
        }
        let point = point.map_err(|error| error::other(py, error))?;
        Ok(Found::of_point(&self.sweep, point))
    }

    /// Lets go of what it remembers.
    fn close(&self) {
        if let Ok(mut open) = self.open.try_lock() {
            *open = None;
        }
    }
}
