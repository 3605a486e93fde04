//! Ranges of systems whose densities are known, and of systems that have none.

use super::*;
use crate::system::{TypedModel, registry};

#[test]
fn a_normal_density_is_held_to_six_deviations_and_not_much_more() {
    // Without friction and cubic stiffness both marginals are normal with variance σ²/(2κ).
    let model = registry::find("coulomb").unwrap();
    for sigma2 in [0.01, 1e-6] {
        let given = [("kappa", 0.05), ("f_c", 0.0), ("sigma2", sigma2)];
        let system = model.system_with(&given).unwrap();
        let deviation = (sigma2 / 0.1_f64).sqrt();
        let ranges = automatic_ranges(&[system], &[[None; 2]; 2], 1, &Cancellation::new()).unwrap();
        for (from, to) in ranges {
            assert_eq!(from, -to, "alike on both sides of the centre");
            assert!(
                to > 5.5 * deviation && to < 8.5 * deviation,
                "{to} {deviation}"
            );
        }
    }
}

#[test]
fn axes_that_may_be_exchanged_have_one_range() {
    let coupled = |k: f64, noise: f64| {
        let typed = TypedModel::new("coupled", "Coupled", ["x", "y"])
            .with_equation("x", format!("x - x^3 - {k} (x - y)"))
            .with_equation("y", format!("y - y^3 - {k} (y - x)"))
            .with_noise("x", ["0.6"])
            .with_noise("y", [noise.to_string()]);
        typed.build().unwrap().system_with(&[]).unwrap()
    };
    let ranges = |k: f64, noise: f64| {
        let systems = [coupled(0.1, noise), coupled(k, noise)];
        automatic_ranges(&systems, &[[None; 2]; 2], 1, &Cancellation::new()).unwrap()
    };
    let alike = ranges(0.5, 0.6);
    assert_eq!(alike[0], alike[1]);
    let different = ranges(0.5, 0.3);
    assert_ne!(different[0], different[1]);
}

#[test]
fn an_end_that_is_given_stays_and_the_other_is_found() {
    // Growth with a rate that fluctuates: x^(a/D - 1) exp(-x/D) on one side of zero, a gamma density.
    let (a, d) = (1.0, 0.3);
    let growth = |sign: f64| {
        let typed = TypedModel::new("growth", "Growth", ["x"])
            .with_equation("x", format!("{a} x - {sign} x^2"))
            .with_noise("x", [format!("sqrt(2 * {d}) x")]);
        let typed = typed.with_interpretation(crate::system::Interpretation::Stratonovich);
        typed.build().unwrap().system_with(&[]).unwrap()
    };
    let found = |sign: f64, known: KnownEnds| {
        automatic_ranges(&[growth(sign)], &[known], 1, &Cancellation::new()).unwrap()[0]
    };
    let (from, to) = found(1.0, [Some(0.0), None]);
    // Beyond to no more than a millionth of the mass, and no more than twice the place beyond which that is.
    let beyond = |x: f64| 1.0 - statrs::function::gamma::gamma_lr(a / d, x / d);
    assert!(
        from == 0.0 && beyond(to) < 1e-6 && beyond(0.5 * to) > 1e-6,
        "{to}"
    );
    assert_eq!(found(-1.0, [None, Some(0.0)]), (-to, 0.0));
    // Without growth all ends at zero, which says nothing of the other end.
    let dying = TypedModel::new("decay", "Decay", ["x"])
        .with_equation("x", "-0.5 x - x^2")
        .with_noise("x", ["0.3 x"])
        .with_interpretation(crate::system::Interpretation::Ito);
    let dying = dying.build().unwrap().system_with(&[]).unwrap();
    let systems = [dying, growth(1.0)];
    let both = automatic_ranges(&systems, &[[Some(0.0), None]], 1, &Cancellation::new());
    assert_eq!(both.unwrap(), [(0.0, to.max(2.0))]);
    // A wall does not keep what has no steady state beside it.
    let alone = TypedModel::new("free", "Free", ["x"]).with_equation("x", "0.1 x");
    let alone = alone.with_noise("x", ["0.5"]).build().unwrap();
    let system = alone.system_with(&[]).unwrap();
    let known = [[Some(0.0), None]];
    let found = automatic_ranges(&[system], &known, 1, &Cancellation::new());
    assert!(
        matches!(found, Err(RangeError::RunsAway { .. })),
        "{found:?}"
    );
}

#[test]
fn a_system_without_a_steady_state_has_no_range() {
    let model = registry::find("coulomb").unwrap();
    let given = [("kappa", -0.05), ("f_c", 0.0), ("sigma2", 0.01)];
    let system = model.system_with(&given).unwrap();
    let found = automatic_ranges(&[system], &[[None; 2]; 2], 1, &Cancellation::new());
    assert!(
        matches!(found, Err(RangeError::RunsAway { system: 0, .. })),
        "{found:?}"
    );
    // One axis alone has none: x' = -x + …, y' = 0.1 y + ….
    let typed = TypedModel::new("half", "Half stable", ["x", "y"])
        .with_equation("x", "-x")
        .with_equation("y", "0.1 y");
    let typed = typed.with_noise("x", ["0.5"]).with_noise("y", ["0.5"]);
    let model = typed.build().unwrap();
    let system = model.system_with(&[]).unwrap();
    let found = automatic_ranges(&[system], &[[None; 2]; 2], 1, &Cancellation::new());
    assert!(
        matches!(found, Err(RangeError::RunsAway { axis: 1, .. })),
        "{found:?}"
    );
}

#[test]
fn the_search_for_a_range_ends_after_steps_that_are_worth_it() {
    // A lightly damped oscillator takes the longest trajectories there are, and z leaves every box.
    let typed = crate::system::TypedModel::new("light", "Light damping", ["x", "y", "z"]);
    let typed = typed
        .with_equation("x", "y")
        .with_equation("y", "-x - 1e-4 y");
    let typed = typed.with_equation("z", "0.01 z").with_noise("y", ["0.01"]);
    let model = typed.with_noise("z", ["0.5"]).build().unwrap();
    let system = model.system_with(&[]).unwrap();
    let known = [[Some(-9.0), Some(9.0)], [Some(-9.0), Some(9.0)], [None; 2]];
    let found = automatic_ranges(&[system], &known, 1, &Cancellation::new());
    let Err(RangeError::TooLong {
        axis, steps, last, ..
    }) = found
    else {
        panic!("{found:?}");
    };
    assert!(axis == 2 && last.1 > 100.0, "{axis} {last:?}");
    assert!(steps < MOST_STEPS + MOST_STEPS / 5, "{steps}");
}

#[test]
fn a_system_whose_paths_end_in_a_point_says_nothing_of_ranges() {
    // Below its D-bifurcation the multiplicative noise of this oscillator leaves all paths at rest.
    let oscillator = |s: f64| {
        let typed = TypedModel::new("parametric", "Parametric noise", ["x", "y"])
            .with_equation("x", "y")
            .with_equation("y", "-0.2 y - x - 0.2 x^3")
            .with_noise("y", [format!("{s} x")])
            .with_interpretation(crate::system::Interpretation::Stratonovich);
        typed.build().unwrap().system_with(&[]).unwrap()
    };
    let ranges = |systems: &[Arc<dyn System>]| {
        automatic_ranges(systems, &[[None; 2]; 2], 1, &Cancellation::new()).unwrap()
    };
    let above = ranges(&[oscillator(1.2)]);
    assert_eq!(ranges(&[oscillator(0.2), oscillator(1.2)]), above);
    // Nor does it of another axis, and a point may lie anywhere: here at x = 5, beside a state of deviation 0.5.
    let beside = |s: f64| {
        let typed = TypedModel::new("beside", "A point beside noise", ["x", "y"])
            .with_equation("x", "5 - x")
            .with_equation("y", "-y")
            .with_noise("x", [format!("{s} (x - 5)")])
            .with_noise("y", ["0.707"])
            .with_interpretation(crate::system::Interpretation::Ito);
        typed.build().unwrap().system_with(&[]).unwrap()
    };
    let [x, y] = ranges(&[beside(0.2)])[..] else {
        panic!("two axes");
    };
    assert!(x.0 < 4.5 && x.1 > 5.5 && x.1 - x.0 < 3.0, "{x:?}");
    assert!(y.1 > 2.5 && y.1 < 5.0, "{y:?}");
}

/// The range of x, which holds all but a millionth of exp(-potential/temperature) on either side, and is no more than
/// twice as long as that takes.
fn holds_and_is_not_wide(
    system: Arc<dyn System>,
    potential: &dyn Fn(f64) -> f64,
    (temperature, middle): (f64, f64),
) {
    let axes = system.dimension();
    let found = automatic_ranges(&[system], &vec![[None; 2]; axes], 1, &Cancellation::new());
    let (from, to) = found.unwrap()[0];
    let density = |x: f64| ((potential(middle) - potential(x)) / temperature).exp();
    // What lies beyond the range is looked at as far again.
    let (begin, step) = (2.0 * from - to, 3.0 * (to - from) / 30_000.0);
    let place = |n: i32| begin + (f64::from(n) + 0.5) * step;
    let all: f64 = (0..30_000).map(|n| density(place(n))).sum();
    let end_of = |places: &[i32]| {
        let mut sum = 0.0;
        places.iter().copied().find(|&n| {
            sum += density(place(n));
            sum > 1e-6 * all
        })
    };
    let low = place(end_of(&(0..30_000).collect::<Vec<_>>()).unwrap());
    let high = place(end_of(&(0..30_000).rev().collect::<Vec<_>>()).unwrap());
    assert!(from < low && high < to, "{low} to {high}: {from} to {to}");
    assert!(
        to - from < 2.0 * (high - low),
        "{low} to {high}: {from} to {to}"
    );
}

#[test]
fn places_from_which_paths_go_to_infinity_say_nothing_of_ranges() {
    // A body that radiates: hot from any temperature above zero, and run away below.
    let typed =
        TypedModel::new("radiator", "Radiation", ["x"]).with_equation("x", "10 - (x/100)^4");
    let system = typed
        .with_noise("x", ["2"])
        .build()
        .unwrap()
        .system_with(&[])
        .unwrap();
    let potential = |x: f64| 20.0 * (x / 100.0).powi(5) - 10.0 * x;
    holds_and_is_not_wide(system, &potential, (2.0, 100.0 * 10_f64.powf(0.25)));
}

#[test]
fn places_where_steps_are_far_too_short_say_nothing_of_ranges() {
    let particle = |force: &str, damping: f64, noise: f64| {
        let typed = TypedModel::new("particle", "A damped particle", ["x", "v"])
            .with_equation("x", "v")
            .with_equation("v", format!("{force} - {damping} v"));
        let typed = typed.with_noise("v", [noise.to_string()]);
        typed.build().unwrap().system_with(&[]).unwrap()
    };
    // A molecule in Morse's potential, held by a weak spring: the force grows exponentially on one side.
    let morse = |x: f64| (1.0 - (-x).exp()).powi(2) + 0.01 * x * x;
    let force = "-2 (1 - exp(-x)) exp(-x) - 0.02 x";
    holds_and_is_not_wide(particle(force, 0.2, 0.3), &morse, (0.09 / 0.4, 0.0));
    // A spring that is soft within two lengths and hard beyond.
    let hard = |x: f64| x.powi(12) / 12.0;
    holds_and_is_not_wide(particle("-x^11", 0.1, 0.5), &hard, (0.25 / 0.2, 0.0));
}

/// A rotor under a torque turns on and on: that is told from the second box on which two turns fit, and no box beyond
/// is looked at. In a well that noise leaves once in 10^6 periods it has a range.
#[test]
fn a_rotor_that_turns_on_is_told_apart_from_one_that_rests() {
    let rotor = |torque: f64, noise: f64| {
        let typed = TypedModel::new("rotor", "Rotor", ["x", "y"])
            .with_equation("x", "y")
            .with_equation("y", format!("-0.3 y - sin(x) + {torque}"))
            .with_noise("y", [format!("{noise}")]);
        typed.build().unwrap().system_with(&[]).unwrap()
    };
    let ranges = |system| automatic_ranges(&[system], &[[None; 2]; 2], 1, &Cancellation::new());
    assert_eq!(
        ranges(rotor(0.9, 0.5)),
        Err(RangeError::Turns { system: 0, axis: 0 })
    );
    let held = ranges(rotor(0.0, 0.1)).unwrap();
    assert!(held[0].1 < std::f64::consts::PI, "{held:?}");
}
