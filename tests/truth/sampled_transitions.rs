//! Transitions between two regions counted on free trajectories, against quadrature and the generator.

use std::sync::Arc;

use pbif::cancellation::Cancellation;
use pbif::monte_carlo::{ExitNumber, TransitionRun, Transitions, transitions};
use pbif::sampling::Integrator;
use pbif::system::{Model, regions};

use crate::common::numbers::{Numbers, given};
use crate::common::steady::{even_cells, model};
use crate::transitions::{end_of_well, exact_well, found, model_of_well};

/// How trajectories are followed: time step, burn-in and transitions.
struct Effort(f64, f64, usize);

fn follow(
    model: &Arc<Model>,
    parts: [&str; 2],
    axes: &[(f64, f64, usize)],
    Effort(time_step, burn_in, wanted): Effort,
    seed: u64,
) -> Transitions {
    let values = model.values(&[]).unwrap();
    let [from, to] = parts.map(|text| {
        let region = regions(model, &[("one", text)]).unwrap().remove(0);
        region.level().bind(&values).unwrap()
    });
    let run = TransitionRun {
        time_step,
        integrator: Integrator::StochasticHeun,
        seed,
        burn_in,
        transitions: wanted,
        most_steps: 1e9,
    };
    let (system, space) = (model.system_with(&[]).unwrap(), even_cells(axes));
    let on = (&*system, &space);
    let found = transitions(on, [&from, &to], &[], &run, &Cancellation::new()).unwrap();
    assert_eq!(found.runaways(), 0);
    assert!(found.count() >= wanted);
    found
}

/// Each number is within three of its stated errors, beside that of the exact one, and its error is small. Gives by how
/// many each is off.
#[track_caller]
fn hold(what: &str, found: [ExitNumber; 3], exact: [(f64, f64); 3], largest: f64) -> [f64; 3] {
    let names = ["flux", "rate", "duration"];
    std::array::from_fn(|index| {
        let (number, (exact, of_exact)) = (found[index], exact[index]);
        let error = number.error();
        let off = (number.value - exact) / error.hypot(of_exact);
        println!(
            "{what}, {}: {:.5e} ± {error:.1e} (sampling {:.1e}, step {:.1e} ± {:.1e}), exact {exact:.5e}, off by {off:.2}",
            names[index], number.value, number.sampling, number.step.0, number.step.1
        );
        assert!(off.abs() < 3.0, "{what}, {}: {off}", names[index]);
        assert!(error < largest * exact, "{what}, {}: {error}", names[index]);
        off
    })
}

#[test]
fn transitions_of_double_wells_are_those_of_quadrature() {
    // (tilt, D, from, to), step and burn-in.
    let cases = [
        ((0.0, 0.1, -0.9, 0.83), Effort(0.05, 300.0, 16_384)),
        ((0.1, 0.15, -0.51, 0.4), Effort(0.05, 150.0, 16_384)),
        ((-0.2, 0.2, -1.13, 1.02), Effort(0.02, 100.0, 16_384)),
    ];
    for (case, effort) in cases {
        let (well, parts) = model_of_well(case);
        let end = end_of_well(case.0, case.1);
        let axes = [(-end, end, 60)];
        let time = std::time::Instant::now();
        let found = follow(&well, [&parts[0], &parts[1]], &axes, effort, 1);
        println!("{} transitions, {:?}", found.count(), time.elapsed());
        let exact = exact_well(case).numbers.map(|number| (number, 0.0));
        hold(&format!("D = {}", case.1), found.numbers(), exact, 0.03);
    }
}
