//! Solutions on finer cells that closer looks share: what is solved for one density serves the others.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{DensitySource, Session, Solution, SolveReport, SourceError, Subject, Want};
use crate::cancellation::Cancellation;
use crate::density::EstimatedDensity;

/// Numbers in all densities that are remembered, at most: 256 MiB.
const MOST_NUMBERS: usize = 1 << 25;

/// A report and the densities of all observables.
type Solved = (SolveReport, Vec<EstimatedDensity>);

/// Solutions by the bits of their values.
#[derive(Default)]
pub(super) struct Remembered {
    solved: HashMap<u64, Solved>,
    numbers: usize,
}

impl Remembered {
    fn keep(&mut self, value: f64, solved: Solved) {
        let numbers: usize = solved.1.iter().map(numbers).sum();
        if self.numbers + numbers <= MOST_NUMBERS {
            self.numbers += numbers;
            self.solved.insert(value.to_bits(), solved);
        }
    }
}

/// Numbers that a density takes: values, errors and values by the second scheme.
fn numbers(density: &EstimatedDensity) -> usize {
    3 * density.density.values.len()
}

/// A source of one of the densities that another one gives, which solves no value again that is remembered.
pub(super) struct RememberingSource<S> {
    source: S,
    subject: Subject,
    /// Of the density among those of the source.
    place: usize,
    remembered: Arc<Mutex<Remembered>>,
}

impl<S: DensitySource> RememberingSource<S> {
    pub(super) fn new(source: S, place: usize, remembered: &Arc<Mutex<Remembered>>) -> Self {
        let mut subject = source.subject().clone();
        subject.observables = subject
            .observables
            .get(place)
            .copied()
            .into_iter()
            .collect();
        let remembered = remembered.clone();
        Self {
            source,
            subject,
            place,
            remembered,
        }
    }
}

impl<S: DensitySource> DensitySource for RememberingSource<S> {
    fn method(&self) -> &'static str {
        self.source.method()
    }

    fn subject(&self) -> &Subject {
        &self.subject
    }

    fn open(&self, cancellation: &Cancellation) -> Box<dyn Session> {
        Box::new(RememberingSession {
            session: self.source.open(cancellation),
            place: self.place,
            remembered: self.remembered.clone(),
        })
    }

    fn segments(&self, values: usize) -> usize {
        self.source.segments(values)
    }

    fn cells(&self) -> Option<usize> {
        self.source.cells()
    }

    fn finer(&self, want: &Want) -> Result<Option<Box<dyn DensitySource>>, SourceError> {
        self.source.finer(want)
    }

    fn enclosed(&self, want: &Want) -> Option<Box<dyn DensitySource>> {
        self.source.enclosed(want)
    }
}

struct RememberingSession {
    session: Box<dyn Session>,
    place: usize,
    remembered: Arc<Mutex<Remembered>>,
}

impl RememberingSession {
    /// The solution of one density.
    fn own(&self, (report, densities): &Solved) -> Solution<'static> {
        Solution {
            report: report.clone(),
            densities: densities.get(self.place).cloned().into_iter().collect(),
            sensitivity: None,
        }
    }
}

/// A poisoned lock holds solutions as whole as any other.
fn lock(remembered: &Mutex<Remembered>) -> MutexGuard<'_, Remembered> {
    remembered.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Session for RememberingSession {
    fn solve(&mut self, value: f64) -> Result<Solution<'_>, SourceError> {
        if let Some(solved) = lock(&self.remembered).solved.get(&value.to_bits()) {
            return Ok(self.own(solved));
        }
        let solution = self.session.solve(value)?.detached();
        let solved = (solution.report, solution.densities);
        let own = self.own(&solved);
        lock(&self.remembered).keep(value, solved);
        Ok(own)
    }

    fn seconds(&self) -> Option<f64> {
        self.session.seconds()
    }

    fn memory(&self) -> Vec<u8> {
        self.session.memory()
    }

    fn recall(&mut self, left: &[(f64, &[u8])]) -> Result<(), SourceError> {
        self.session.recall(left)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::continuation::CellCheck;
    use crate::density::{Density, Observable};
    use crate::space::Axis;
    use crate::system::test_families::bistable;

    /// Two densities, the second one higher; counts what is solved.
    struct Pair(Subject, Arc<AtomicUsize>);

    impl DensitySource for Pair {
        fn method(&self) -> &'static str {
            "exact"
        }

        fn subject(&self) -> &Subject {
            &self.0
        }

        fn open(&self, _: &Cancellation) -> Box<dyn Session> {
            let (observables, solved) = (self.0.observables.clone(), self.1.clone());
            Box::new(move |value: f64| {
                solved.fetch_add(1, Ordering::Relaxed);
                let mut solution = Solution::without_density(SolveReport::solved("exact"));
                let density = |(place, observable): (usize, &Observable)| {
                    let axes = vec![Axis::uniform(0.0, 1.0, 2).ok()?];
                    let values = vec![value + place as f64; 2];
                    Some(EstimatedDensity::new(*observable, Density { axes, values }))
                };
                solution.densities = observables.iter().enumerate().filter_map(density).collect();
                Ok(solution)
            })
        }
    }

    #[test]
    fn what_is_solved_for_one_density_serves_the_other() {
        let subject = Subject {
            family: bistable(0.0, 1.0),
            observables: vec![Observable::Marginal(0), Observable::Marginal(1)],
            measures: Vec::new(),
            cell_check: CellCheck::Needless,
        };
        let (remembered, solved) = (Arc::default(), Arc::new(AtomicUsize::new(0)));
        let values = |place: usize| {
            let pair = Pair(subject.clone(), solved.clone());
            let source = RememberingSource::new(pair, place, &remembered);
            assert_eq!(source.subject().observables, [subject.observables[place]]);
            let mut session = source.open(&Cancellation::new());
            [0.25, 0.5].map(|value| session.solve(value).unwrap().densities[0].density.values[0])
        };
        assert_eq!(values(0), [0.25, 0.5]);
        assert_eq!(values(1), [1.25, 1.5]);
        assert_eq!(solved.load(Ordering::Relaxed), 2);
    }
}
