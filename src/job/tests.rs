//! A sweep file's jobs by a method of one's own: a closed form in the place of a solver.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::*;
use crate::continuation::measure::{DEVIATION, MEAN};
use crate::continuation::{
    DensitySource, Session, Solution, SolveReport, SourceError, Subject, SweepResult,
};
use crate::density::{Density, EstimatedDensity, moments};
use crate::method::Problem;
use crate::run::StoredRun;
use crate::sweep_file::SweepFile;

/// p ∝ exp((2/σ²)(a x²/2 - x⁴/4)) with σ² = 1/4, at every a.
struct Exact {
    problem: Problem,
    solves: Arc<AtomicUsize>,
}

impl DensitySource for Exact {
    fn method(&self) -> &'static str {
        "exact"
    }

    fn subject(&self) -> &Subject {
        self.problem.subject()
    }

    fn open(&self, _: &Cancellation) -> Box<dyn Session> {
        Box::new(Self {
            problem: self.problem.clone(),
            solves: self.solves.clone(),
        })
    }
}

impl Session for Exact {
    fn solve(&mut self, a: f64) -> Result<Solution<'_>, SourceError> {
        self.solves.fetch_add(1, Ordering::Relaxed);
        let space = self.problem.space();
        let axis = &space.axes()[0];
        let weight = |x: f64| (8.0 * (a * x * x / 2.0 - x.powi(4) / 4.0)).exp();
        let cells = 0..axis.count();
        let masses: Vec<f64> = cells
            .map(|cell| weight(axis.centre(cell)) * axis.width(cell))
            .collect();
        let total: f64 = masses.iter().sum();
        let mass: Vec<f64> = masses.iter().map(|mass| mass / total).collect();
        let values = mass.iter().enumerate();
        let values: Vec<f64> = values.map(|(cell, mass)| mass / axis.width(cell)).collect();
        let mut report = SolveReport::solved("exact");
        for moments in moments(space, &mass).unwrap() {
            report.add(&MEAN, "x", moments.mean);
            report.add(&DEVIATION, "x", moments.standard_deviation);
        }
        Ok(Solution {
            report,
            densities: vec![EstimatedDensity::new(
                self.problem.observables()[0],
                Density {
                    axes: vec![axis.clone()],
                    values,
                },
            )],
            sensitivity: None,
        })
    }
}

/// The sweep of the bistable system by the closed form, with a count of its solves.
fn exact() -> (Sweep, Arc<AtomicUsize>) {
    let text = include_str!("../../sweeps/bistable.toml");
    let mut file = SweepFile::parse("bistable.toml", text);
    file.set("sweep.points", "9").set("figures.at", "[]");
    file.set("figures.formats", "[\"svg\"]");
    let never = Cancellation::new();
    let sweep = file.validate().unwrap().prepare(&never).unwrap();
    let solves = Arc::new(AtomicUsize::new(0));
    let count = solves.clone();
    let sweep = sweep.by_method("exact", move |problem, _| {
        let (problem, solves) = (problem.clone(), count.clone());
        Ok(Box::new(Exact { problem, solves }))
    });
    (sweep, solves)
}

fn done(sweep: &Sweep, home: &Path) -> SweepResult {
    let mut job = SweepJob::new(sweep);
    let start = job.start(home).unwrap();
    let never = Cancellation::new();
    let done = carry_out(&mut job, home, start, &never, &|_| ()).unwrap();
    done.unwrap().found
}

#[test]
fn a_sweep_that_panics_goes_on_to_the_same_bytes() {
    let room = tempfile::tempdir().unwrap();
    let (whole, cut) = (room.path().join("whole"), room.path().join("cut"));
    let (sweep, _) = exact();
    done(&sweep, &whole);
    let (never, mut job) = (Cancellation::new(), SweepJob::new(&sweep));
    #[allow(clippy::panic)]
    let observer = |step: &Progress<'_>| {
        if matches!(step, Progress::Done { done: 4, .. }) {
            panic!("on purpose");
        }
    };
    let carried = std::panic::AssertUnwindSafe(|| {
        let _ = carry_out(&mut job, &cut, Start::Anew, &never, &observer);
    });
    assert!(std::panic::catch_unwind(carried).is_err());
    assert_eq!(SweepJob::new(&sweep).start(&cut).unwrap(), Start::GoOn);
    done(&sweep, &cut);
    for file in ["bifurcations.csv", "features.csv", "checks.csv"] {
        let [one, other] = [&whole, &cut].map(|home| std::fs::read(home.join(file)).ok());
        assert!(one == other, "{file}");
    }
}

#[test]
fn a_method_of_ones_own_sweeps_is_interrupted_and_goes_on_to_the_same_bytes() {
    let room = tempfile::tempdir().unwrap();
    let (whole, cut) = (room.path().join("whole"), room.path().join("cut"));
    let (sweep, solves) = exact();
    let found = done(&sweep, &whole);
    let births: Vec<_> = (found.bifurcations().filter(|row| row.label == "PB1")).collect();
    assert!(births.len() == 1 && births[0].value.abs() < 0.3);
    let all = solves.swap(0, Ordering::Relaxed);
    // Interrupted after some points, it leaves their tables and a journal.
    let stop = Cancellation::new();
    let observer = |step: &Progress<'_>| {
        if matches!(step, Progress::Done { done: 4, .. }) {
            stop.cancel();
        }
    };
    let mut job = SweepJob::new(&sweep);
    let half = carry_out(&mut job, &cut, Start::Anew, &stop, &observer);
    assert_eq!(half.unwrap().unwrap().outcome, Outcome::Interrupted);
    assert_eq!(SweepJob::new(&sweep).start(&cut).unwrap(), Start::GoOn);
    done(&sweep, &cut);
    assert_eq!(solves.load(Ordering::Relaxed), all);
    for file in ["bifurcations.csv", "features.csv", "checks.csv"] {
        let [one, other] = [&whole, &cut].map(|home| std::fs::read(home.join(file)).ok());
        assert!(one == other, "{file}");
    }
    // It is complete, and read back with the method's name.
    assert_eq!(SweepJob::new(&sweep).start(&cut).unwrap(), Start::Complete);
    let stored = StoredRun::open(&cut).unwrap().detect(&sweep).unwrap();
    assert_eq!(stored.labels.len(), found.labels.len());
    assert!(
        (stored.points.iter()).all(|point| point.report.method == "exact"),
        "methods"
    );
}

#[test]
fn every_value_of_a_sweep_is_told_once_also_where_an_earlier_process_solved_it() {
    let room = tempfile::tempdir().unwrap();
    let (sweep, _) = exact();
    let (stop, told) = (Cancellation::new(), std::sync::Mutex::new(Vec::new()));
    let observer = |step: &Progress<'_>| match step {
        Progress::Solved(point) => {
            assert_eq!(point.detections.len(), point.densities.len());
            told.lock().unwrap().push(point.value);
        }
        Progress::Done { done: 4, .. } => stop.cancel(),
        _ => (),
    };
    let carried = |start, cancellation: &Cancellation| {
        let mut job = SweepJob::new(&sweep);
        let done = carry_out(&mut job, room.path(), start, cancellation, &observer);
        let points = done.unwrap().unwrap().found.points;
        let mut values = std::mem::take(&mut *told.lock().unwrap());
        values.sort_by(f64::total_cmp);
        let found: Vec<f64> = points.iter().map(|point| point.value).collect();
        assert_eq!(values, found);
        found.len()
    };
    let first = carried(Start::Anew, &stop);
    let all = carried(Start::GoOn, &Cancellation::new());
    assert!(4 <= first && first < all, "{first} of {all}");
}
