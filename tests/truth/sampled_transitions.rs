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
        ((0.0, 0.1, -0.9, 0.83), Effort(0.05, 200.0, 8192)),
        ((-0.2, 0.2, -1.13, 1.02), Effort(0.05, 60.0, 8192)),
    ];
    for (case, effort) in cases {
        let found = in_well(case, effort, 2);
        let exact = exact_well(case).numbers.map(|number| (number, 0.0));
        hold(&format!("D = {}", case.1), found, exact, 0.03);
    }
}

/// Wells of other tilts, noises and regions, of which nothing was tuned; `PBIF_RANDOM_SYSTEMS` of them, from the seed
/// `PBIF_FUZZ_SEED`. Errors are standard errors: their squares are right on average.
#[test]
fn stated_errors_of_counted_transitions_are_right_in_random_wells() {
    let seed = given("PBIF_FUZZ_SEED", 7);
    let (mut numbers, mut squares) = (Numbers(seed), Vec::new());
    for number in 0..given("PBIF_RANDOM_SYSTEMS", 5) {
        let (tilt, d) = (numbers.rounded(-0.2, 0.2), numbers.rounded(0.12, 0.4));
        let (a, b) = (numbers.rounded(-1.2, -0.3), numbers.rounded(0.3, 1.2));
        let case = (tilt, d, a, b);
        let exact = exact_well(case);
        // Three times what the slowest deviation, an exchange between the wells, takes to be forgotten to a twentieth.
        let burn_in = 3.0 * 3.0 / (2.0 * exact.numbers[1]);
        let found = in_well(
            case,
            Effort(0.02, burn_in.clamp(20.0, 150.0), 1024),
            number + 1,
        );
        let exact = exact.numbers.map(|number| (number, 0.0));
        squares.extend(hold(&format!("{case:?}"), found, exact, 0.1).map(|off| off * off));
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    println!(
        "root mean square of differences over errors: {:.2}",
        mean.sqrt()
    );
    assert!(mean < 2.0, "{mean}");
}

/// Numbers of a well.
fn in_well(case: (f64, f64, f64, f64), effort: Effort, seed: u64) -> [ExitNumber; 3] {
    let (well, parts) = model_of_well(case);
    let end = end_of_well(case.0, case.1);
    let axes = [(-end, end, 60)];
    follow(&well, [&parts[0], &parts[1]], &axes, effort, seed).numbers()
}

/// Borders across the displacement, which noise does not move, and borders of an energy, which it does.
#[test]
fn transitions_of_an_oscillator_are_those_of_the_generator() {
    let equations = [("x", "y"), ("y", "-0.5 y + x - x^3")];
    let oscillator = model(&equations, &[("y", "sqrt(0.2)")]);
    let deep = "y^2/2 - x^2/2 + x^4/4 < -0.1";
    let cases = [
        ["x < -0.7".to_owned(), "x > 0.7".to_owned()],
        [format!("x < 0 and {deep}"), format!("x > 0 and {deep}")],
    ];
    for parts in &cases {
        let parts = [parts[0].as_str(), parts[1].as_str()];
        let axes = [(-2.2, 2.2, 80), (-2.8, 2.8, 80)];
        let by_generator = found(&oscillator, parts, &axes).reactive;
        let exact = [by_generator.flux, by_generator.rate, by_generator.duration];
        let sampled = follow(&oscillator, parts, &axes, Effort(0.05, 60.0, 8192), 2);
        hold(parts[0], sampled.numbers(), exact, 0.03);
    }
}
