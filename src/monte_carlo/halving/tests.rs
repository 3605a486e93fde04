use super::*;
use crate::monte_carlo::relaxation;
use crate::space::Axis;
use crate::system::test_families::built_in;
use std::sync::Arc;

fn oscillator(kappa: f64, f_c: f64) -> (Arc<dyn System>, CellSpace, Relaxation) {
    let values = [
        ("kappa", kappa),
        ("mu", 0.0),
        ("f_c", f_c),
        ("sigma2", 0.01),
    ];
    let system = built_in("coulomb", &values);
    let axis = Axis::uniform(-4.0, 4.0, 40).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis]).unwrap();
    let never = Cancellation::new();
    let relaxation = relaxation(&*system, &space, 1, &never).unwrap();
    (system, space, relaxation)
}

fn bias(
    system: &dyn System,
    space: &CellSpace,
    relaxation: &Relaxation,
    step: (Integrator, f64),
) -> StepBias {
    let found = step_bias(system, space, relaxation, step, 1, &Cancellation::new());
    found.unwrap().unwrap()
}

#[test]
fn euler_maruyama_that_leaves_no_damping_is_caught_and_heun_passes() {
    let (system, space, relaxation) = oscillator(0.01, 0.0);
    let bias = |integrator| bias(&*system, &space, &relaxation, (integrator, 0.01));
    // ω²dt = κ: the coarse path has no steady state, the fine one half the damping.
    let euler = bias(Integrator::EulerMaruyama);
    assert!(euler.certain() > 1.0, "{euler:?}");
    // dt³/4 = 2.5e-7 of 0.01.
    let heun = bias(Integrator::StochasticHeun);
    assert!(
        heun.relative.abs() < 1e-3 && heun.certain() < 1e-3,
        "{heun:?}"
    );
}

#[test]
fn the_bias_of_a_linear_oscillator_is_what_its_damping_loses() {
    // Variances are σ²/(2(κ - ω²dt)) by Euler-Maruyama: with κ = 0.1 and dt = 0.01 they are 1/0.9 of the exact
    // ones, and with dt/2 1/0.95; the difference relative to the latter, 0.0556, extrapolates to 0.111, up to
    // O(κdt).
    let (system, space, relaxation) = oscillator(0.1, 0.0);
    let step = (Integrator::EulerMaruyama, 0.01);
    let bias = bias(&*system, &space, &relaxation, step);
    assert!(
        (bias.relative - 0.111).abs() < 0.01 + 3.0 * bias.standard_error,
        "{bias:?}"
    );
    assert!(bias.standard_error < 0.01, "{bias:?}");
}

#[test]
fn an_automatic_step_keeps_the_bias_below_what_is_wanted() {
    let (system, space, relaxation) = oscillator(0.05, 0.02);
    for integrator in Integrator::ALL {
        for wanted in [0.02, 0.005] {
            let (step, bias) = automatic_step(
                &*system,
                &space,
                &relaxation,
                (integrator, wanted),
                1,
                &Cancellation::new(),
            )
            .unwrap();
            let bias = bias.unwrap();
            assert!(bias.certain() <= wanted, "{integrator:?} {step} {bias:?}");
            assert!(step > 1e-5, "{integrator:?} {step} {bias:?}");
        }
    }
}
