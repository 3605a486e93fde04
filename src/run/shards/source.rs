//! A source of densities that has been asked before: what shards have solved is given, what they have not is solved.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::cancellation::Cancellation;
use crate::continuation::{DensitySource, Point, Session, Solution, SourceError, Subject, Want};

/// A source whose solutions at some values are known.
pub struct GatheredSource {
    source: Box<dyn DensitySource>,
    known: Arc<HashMap<u64, Point>>,
    solves: Arc<AtomicUsize>,
}

impl GatheredSource {
    /// Joins a source with points that it has solved before.
    pub fn new(source: Box<dyn DensitySource>, points: Vec<Point>) -> Self {
        let known = points.into_iter();
        Self {
            source,
            known: Arc::new(known.map(|point| (point.value.to_bits(), point)).collect()),
            solves: Arc::default(),
        }
    }

    /// A count, kept up to date, of the values that were not known and had to be solved.
    pub fn solves(&self) -> Arc<AtomicUsize> {
        self.solves.clone()
    }
}

impl std::fmt::Debug for GatheredSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("GatheredSource")
            .field("method", &self.source.method())
            .field("known", &self.known.len())
            .finish_non_exhaustive()
    }
}

impl DensitySource for GatheredSource {
    fn method(&self) -> &'static str {
        self.source.method()
    }

    fn subject(&self) -> &Subject {
        self.source.subject()
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        Box::new(GatheredSession {
            session: self.source.open(cancellation),
            known: self.known.clone(),
            solves: self.solves.clone(),
            has_solved: false,
        })
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        self.source.finer(want)
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        self.source.enclosed(want)
    }
}

struct GatheredSession {
    session: Box<dyn Session>,
    known: Arc<HashMap<u64, Point>>,
    solves: Arc<AtomicUsize>,
    /// Whether the last value was solved here.
    has_solved: bool,
}

impl Session for GatheredSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        let known = self.known.get(&value.to_bits());
        self.has_solved = known.is_none();
        let Some(point) = known else {
            self.solves.fetch_add(1, Ordering::Relaxed);
            return self.session.solve(value);
        };
        Ok(Solution {
            report: point.report.clone(),
            densities: point.densities.clone(),
            sensitivity: None,
        })
    }

    fn memory(&self) -> Vec<u8> {
        match self.has_solved {
            true => self.session.memory(),
            false => Vec::new(),
        }
    }

    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        let solved = |(value, _): &&(f64, &[u8])| !self.known.contains_key(&value.to_bits());
        let left: Vec<(f64, &[u8])> = left.iter().filter(solved).copied().collect();
        match left.is_empty() {
            true => Ok(()),
            false => self.session.recall(&left),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::continuation::{CellCheck, SolveReport};
    use crate::system::examples::coulomb;

    struct Asked {
        subject: Subject,
        values: Arc<Mutex<Vec<f64>>>,
    }

    impl DensitySource for Asked {
        fn method(&self) -> &'static str {
            "test"
        }

        fn subject(&self) -> &Subject {
            &self.subject
        }

        fn open(&self, _: &Cancellation) -> Box<dyn Session> {
            let values = self.values.clone();
            Box::new(move |value: f64| {
                values.lock().unwrap().push(value);
                let mut report = SolveReport::solved("test");
                report.iterations = 7;
                Ok(Solution::without_density(report))
            })
        }
    }

    #[test]
    fn what_is_known_is_not_solved() {
        let values = Arc::default();
        let source = Asked {
            subject: Subject {
                family: coulomb(),
                observables: Vec::new(),
                measures: Vec::new(),
                cell_check: CellCheck::Needless,
            },
            values: Arc::clone(&values),
        };
        let point = Point {
            value: 0.5,
            report: SolveReport::solved("test"),
            densities: Vec::new(),
            detections: Vec::new(),
            distance: None,
            seconds: 1.0,
        };
        let gathered = GatheredSource::new(Box::new(source), vec![point]);
        let solves = gathered.solves();
        let mut session = gathered.open(&Cancellation::new());
        for (value, iterations) in [(0.5, 0), (0.25, 7), (0.5, 0)] {
            assert_eq!(session.solve(value).unwrap().report.iterations, iterations);
        }
        assert_eq!(*values.lock().unwrap(), [0.25]);
        assert_eq!(solves.load(Ordering::Relaxed), 1);
    }
}
