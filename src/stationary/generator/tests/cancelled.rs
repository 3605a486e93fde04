//! Solves that are asked to stop.

use std::thread;
use std::time::Duration;

use super::{generators, space};
use crate::cancellation::{Cancellation, Cancelled};
use crate::stationary::generator::{RateError, RateMethod, RateOptions, RateSolver};

const STOPPED: RateError = RateError::Cancelled(Cancelled);

#[test]
fn a_factorisation_ends_in_its_middle() {
    // Several 1e11 operations, seconds on any machine; the last front alone has a tenth of them.
    let shape = [44, 44, 20];
    let (matrix, escape) = generators::dahl(shape, 0.5);
    let options = RateOptions {
        method: Some(RateMethod::Lu),
        ..RateOptions::default()
    };
    let cancellation = Cancellation::new();
    let mut solver = RateSolver::new(space(&shape), options).cancelled_by(&cancellation);
    let found = thread::scope(|scope| {
        let solve = scope.spawn(|| solver.solve(&matrix, &escape, None));
        thread::sleep(Duration::from_millis(300));
        cancellation.cancel();
        solve.join().unwrap()
    });
    assert_eq!(found.unwrap_err(), STOPPED);
}

#[test]
fn neither_iterations_nor_sensitivities_begin_once_cancelled() {
    let (matrix, escape) = generators::oscillator(30, 0.01);
    let cancellation = Cancellation::new();
    let mut solver =
        RateSolver::new(space(&[30, 30]), RateOptions::default()).cancelled_by(&cancellation);
    let steady = solver.solve(&matrix, &escape, None).unwrap();
    let (other, _) = generators::oscillator(30, 0.011);
    cancellation.cancel();
    let again = solver.solve(&matrix, &escape, Some(&steady.mass));
    assert_eq!(again.unwrap_err(), STOPPED);
    let sensitivity = solver.sensitivity(&other, &steady.mass);
    assert_eq!(sensitivity.unwrap_err(), STOPPED);
}
