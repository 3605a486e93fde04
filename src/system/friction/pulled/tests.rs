use super::*;
use crate::system::contract::tests::bound;

const MASS: [(&str, f64); 2] = [("kappa", 0.3), ("sigma2", 0.1)];

fn system(name: &str, values: &[(&str, f64)]) -> std::sync::Arc<dyn System> {
    bound(name, &[&MASS[..], values].concat())
}

/// Work of friction in a cycle, by trapezoids.
fn work(cycle: &[Pulled]) -> f64 {
    let pieces = cycle.windows(2);
    pieces
        .map(|two| {
            0.5 * (two[0].force + two[1].force) * (two[1].displacement - two[0].displacement)
        })
        .sum()
}

/// Between two turns at ±a, F = f_c - (f_c + F(a)) e^(-λ(x + a)/f_c), so that F(a) = f_c tanh(λa/f_c).
#[test]
fn dahls_loop_is_that_of_the_closed_form() {
    let dahl = system("dahl", &[("lambda", 2.0), ("f_c", 0.5)]);
    assert_eq!(yielding_distance(dahl.as_ref()), Some(0.25));
    for amplitude in [0.1, 0.25, 2.0_f64] {
        let turn = 0.5 * (4.0 * amplitude).tanh();
        let cycle = cycle(dahl.as_ref(), amplitude, 3.0);
        assert_eq!(cycle.len(), PLACES + 1);
        for one in &cycle {
            let way = if one.velocity > 0.0 { 1.0 } else { -1.0 };
            let gone = amplitude + way * one.displacement;
            let exact = way * (0.5 - (0.5 + turn) * (-4.0 * gone).exp());
            assert!((one.force - exact).abs() < 1e-6, "{one:?} {exact}");
        }
    }
}

/// A loop of Coulomb's law is a rectangle: 4 a f_c, but for the trapezoids at its two sides.
#[test]
fn coulombs_loop_is_a_rectangle() {
    let coulomb = system("coulomb", &[("f_c", 0.2)]);
    let cycle = cycle(coulomb.as_ref(), 1.5, 1.0);
    assert!((work(&cycle) - 1.2).abs() < 1e-3);
    assert_eq!(yielding_distance(coulomb.as_ref()), None);
    assert_eq!(steady_sliding(coulomb.as_ref(), -3.0), Some(-0.2));
}

#[test]
fn steady_sliding_is_at_the_level_of_the_law() {
    let own = [
        ("lambda", 3.0),
        ("eta", 0.4),
        ("f_c", 0.5),
        ("f_s", 0.8),
        ("v_s", 0.2),
    ];
    let lugre = system("lugre", &own);
    for velocity in [-1.0, -0.1, 0.05, 0.2, 2.0_f64] {
        let level = 0.5 + 0.3 * (-(velocity / 0.2).powi(2)).exp();
        let found = steady_sliding(lugre.as_ref(), velocity).unwrap();
        assert!(
            (found - level.copysign(velocity)).abs() < 1e-6,
            "{velocity} {found}"
        );
    }
    let own = [("lambda", 3.0), ("f_b", 0.5), ("f_t", 0.25)];
    let found = steady_sliding(system("elasto_plastic", &own).as_ref(), 0.3).unwrap();
    assert!((found - 0.75).abs() < 1e-6, "{found}");
    let own = [("f_1", 0.75), ("f_2", 0.25), ("epsilon", 0.5), ("rho", 0.2)];
    let found = steady_sliding(system("bliman_sorine", &own).as_ref(), -0.3).unwrap();
    assert!((found + 0.5).abs() < 1e-6, "{found}");
    // z∞ = (A/(β + γ))^(1/n).
    let own = [("lambda", 2.0), ("beta", 3.0), ("gamma", 1.0), ("n", 2.0)];
    let found = steady_sliding(system("bouc_wen", &own).as_ref(), 1.0).unwrap();
    assert!((found - 1.0).abs() < 1e-6, "{found}");
}

#[test]
fn below_its_level_an_elastic_contact_takes_no_work() {
    let own = [("lambda", 2.0), ("f_b", 0.5), ("f_t", 0.25)];
    let contact = system("elasto_plastic", &own);
    assert!(work(&cycle(contact.as_ref(), 0.2, 1.0)).abs() < 1e-6);
    assert!(work(&cycle(contact.as_ref(), 0.6, 1.0)) > 0.1);
}

#[test]
fn a_cycle_closes_where_it_ends_with_the_force_that_it_began_with() {
    let dahl = system("dahl", &[("lambda", 2.0), ("f_c", 0.5)]);
    let mut dahl = cycle(dahl.as_ref(), 0.2, 1.0);
    assert!(closes(&dahl));
    dahl[PLACES].force += 1e-3;
    assert!(!closes(&dahl) && !closes(&[]));
}

#[test]
fn what_is_given_stands_before_what_is_shown() {
    let lugre = crate::system::registry::find("lugre").unwrap();
    let values = shown_values(&lugre, &[("f_s", 3.0)]).unwrap();
    let of = |name: &str| values.as_slice()[lugre.parameter_index(name).unwrap()];
    assert_eq!(
        (of("f_s"), of("v_s"), of("f_c"), of("eta")),
        (3.0, 0.5, 1.0, 0.0)
    );
    assert!(shown_values(&lugre, &[("nu", 3.0)]).is_err());
}

#[test]
fn what_has_no_steady_sliding_says_so() {
    let own = [("lambda", 2.0), ("beta", 1.0), ("gamma", -2.0)];
    let hardening = system("bouc_wen", &own);
    assert_eq!(steady_sliding(hardening.as_ref(), 1.0), None);
    let bistable = bound("bistable", &[("a", 1.0), ("sigma2", 0.5)]);
    assert_eq!(steady_sliding(bistable.as_ref(), 1.0), None);
    assert!(cycle(bistable.as_ref(), 1.0, 1.0).is_empty());
    let still = system("coulomb", &[("f_c", 0.2)]);
    assert!(cycle(still.as_ref(), 0.0, 1.0).is_empty());
    assert!(cycle(still.as_ref(), f64::NAN, 1.0).is_empty());
}
