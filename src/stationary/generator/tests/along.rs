//! Two iterations by the same passes, and factors that are made ahead.

use super::{distance, generators, space};
use crate::stationary::generator::balance::add_product;
use crate::stationary::generator::{Along, RateOptions, RateSolver};

#[test]
fn an_answer_along_with_a_solve_changes_nothing_but_the_work() {
    let (here, escape) = generators::oscillator(60, 0.01);
    let (next, next_escape) = generators::oscillator(60, 0.0101);
    let (other, _) = generators::oscillator(60, 0.02);
    let solvers = [(); 2].map(|()| RateSolver::new(space(&[60, 60]), RateOptions::default()));
    let [mut apart, mut together] = solvers;
    let guess = apart.solve(&here, &escape, None).unwrap().mass;
    together.solve(&here, &escape, None).unwrap();

    let alone = apart.solve(&next, &next_escape, Some(&guess)).unwrap();
    let asked = apart
        .sensitivity_within(&other, &alone.mass, None, 1e-2)
        .unwrap();
    let mut change = vec![0.0; guess.len()];
    add_product(&other, &guess, &mut change);
    let along = Along {
        change: &change,
        expected: None,
        tolerance: 1e-2,
    };
    let solved = together.solve_along(&next, &next_escape, Some(&guess), Some(&along));
    let (steady, answer) = solved.unwrap();
    let bits = |mass: &[f64]| mass.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&steady.mass), bits(&alone.mass));
    assert_eq!(steady.info, alone.info);
    let size: f64 = asked.iter().map(|value| value.abs()).sum();
    // Each is known to two digits, and the guess is off by less than that.
    let off = distance(&answer.unwrap(), &asked) / size;
    assert!(off < 2e-2, "{off:e}");
    let passes = |solver: &RateSolver| solver.memory().excess;
    let (of_both, of_each) = (passes(&together), passes(&apart));
    assert!(of_both < of_each, "{of_both} {of_each}");
}

#[test]
fn there_is_no_answer_without_a_guess() {
    let (matrix, escape) = generators::oscillator(30, 0.01);
    let along = Along {
        change: &[0.0; 900],
        expected: None,
        tolerance: 1e-2,
    };
    let mut solver = RateSolver::new(space(&[30, 30]), RateOptions::default());
    let (_, answer) = solver
        .solve_along(&matrix, &escape, None, Some(&along))
        .unwrap();
    assert_eq!(answer, None);
}

#[test]
fn factors_made_ahead_serve_more_values() {
    let run = |ahead: f64| {
        let mut solver = RateSolver::new(space(&[40, 40]), RateOptions::default());
        let mut mass: Option<Vec<f64>> = None;
        let mut masses = Vec::new();
        for step in 0..24 {
            let at = 0.01 + 1e-4 * f64::from(step);
            if let Some(mass) = mass.as_ref().filter(|_| ahead > 0.0 && solver.is_worn()) {
                let (matrix, escape) = generators::oscillator(40, at + ahead);
                solver.renew(&matrix, &escape, mass).unwrap();
                assert!(!solver.is_worn());
            }
            let (matrix, escape) = generators::oscillator(40, at);
            let steady = solver.solve(&matrix, &escape, mass.as_deref()).unwrap();
            assert!(steady.info.converged);
            masses.push(steady.mass.clone());
            mass = Some(steady.mass);
        }
        (solver.factorisations(), masses)
    };
    let ((at_each, here), (ahead, there)) = (run(0.0), run(2e-4));
    assert!(ahead < at_each, "{ahead} {at_each}");
    for (a, b) in here.iter().zip(&there) {
        assert!(distance(a, b) < 1e-9);
    }
}
