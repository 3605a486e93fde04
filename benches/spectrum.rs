//! Time of the slow modes and of the power spectra of one value, at which the steady state is known.
//!
//! `cargo bench --bench spectrum` takes the oscillator of `sweeps/coulomb_fc.toml` on 100 × 100 cells, where it keeps
//! moving, where it is damped by friction and viscously, and where it is damped viscously alone. A number is the size
//! of another grid.

#![expect(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a bench reports and stops at the first fault"
)]

use std::time::Instant;

use pbif::cancellation::Cancellation;
use pbif::generator::{GeneratorOptions, assemble};
use pbif::space::{Axis, CellSpace, Grading};
use pbif::spectrum::{PowerQuestion, Steady, power_spectra, slow_modes};
use pbif::stationary::generator::{RateOptions, RateSolver};
use pbif::system::TypedModel;

/// Modes that are asked for.
const MODES: usize = 6;

/// Frequencies of a spectrum.
const FREQUENCIES: usize = 241;

fn run(friction: f64, count: usize) {
    let drift = format!("-x - 0.01 x^3 - 0.01 y - ({friction}) sgn(y)");
    let model = TypedModel::new("model", "Model", ["x", "y"]).with_equation("x", "y");
    let model = model.with_equation("y", &drift).with_noise("y", ["0.1"]);
    let system = model.build().expect("equations").system_with(&[]);
    let system = system.expect("no parameters");
    let grading = |smallest| Grading {
        at: vec![0.0],
        smallest,
    };
    let axis = |smallest| Axis::graded(-5.5, 5.5, count, &grading(smallest)).expect("a range");
    let space = CellSpace::new(vec![axis(0.03), axis(0.01)]).expect("a grid");
    let (options, rates) = (GeneratorOptions::default(), RateOptions::default());
    let generator = assemble(&*system, &space, &options).expect("a drift");
    let mut solver = RateSolver::new(space.clone(), rates);
    let state = solver.solve(&generator.matrix, &generator.escape, None);
    let masses = state.expect("a generator").mass;
    let steady = Steady {
        masses: &masses,
        closed: &[[false; 2]; 2],
        phase: None,
    };
    let (settings, never) = ((&options, &rates), Cancellation::new());
    let clock = Instant::now();
    let modes = slow_modes(&system, &space, MODES, steady, settings, &never).expect("modes");
    println!(
        "f_c {friction}: {} of {MODES} slow modes {:.2} s, {:?}",
        modes.modes.len(),
        clock.elapsed().as_secs_f64(),
        modes.work
    );
    let frequencies: Vec<f64> = (0..FREQUENCIES).map(|one| one as f64 * 0.026).collect();
    let question = PowerQuestion {
        observables: &[&|state: &[f64]| state[0]],
        pairs: &[(0, 0)],
        frequencies: &frequencies,
        lags: (0.0, 0),
    };
    let clock = Instant::now();
    let power = power_spectra(&system, &space, &question, steady, settings, &never);
    println!(
        "f_c {friction}: spectrum of x {:.2} s, {:?}",
        clock.elapsed().as_secs_f64(),
        power.expect("a spectrum").work
    );
}

fn main() {
    let count = std::env::args().find_map(|word| word.parse().ok());
    for friction in [-0.003, 0.0, 0.005] {
        run(friction, count.unwrap_or(100));
    }
}
