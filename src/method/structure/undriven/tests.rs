//! Kinks on planes without noise against exact densities.

use super::*;
use crate::space::Axis;
use crate::system::TypedModel;

/// x' = y, y' = -x - a sgn x - c y + s ξ has p ∝ exp(-(2c/s²)(y²/2 + x²/2 + a |x|)): the slope of log p jumps by -4
/// a c/s².
#[test]
fn a_force_that_jumps_makes_the_kink_of_the_exact_density() {
    let (c, s, a) = (0.5, 0.7, 0.3);
    let model = TypedModel::new("bang", "A spring with a preload", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-x - a sign(x) - 0.5 y")
        .with_noise("y", ["0.7"])
        .with_parameters(["a"])
        .build()
        .unwrap();
    let system = model.system_with(&[("a", a)]).unwrap();
    let surface = SwitchingSurface { axis: 0, at: 0.0 };
    let found = |count: usize| {
        let axis = |half: f64, count: usize| Axis::uniform(-half, half, count).unwrap();
        let space = CellSpace::new(vec![axis(4.0, 40), axis(3.0, count)]).unwrap();
        assert!(jumps(system.as_ref(), &space, surface));
        assert!(is_known(system.as_ref(), &space, surface));
        let density = |state: &[f64]| {
            let energy = 0.5 * (state[0].powi(2) + state[1].powi(2)) + a * state[0].abs();
            (-2.0 * c / (s * s) * energy).exp()
        };
        let cells = 0..space.n_cells();
        let masses: Vec<f64> = cells.map(|cell| density(&space.centre(cell))).collect();
        let of = |axes: &[usize]| kink(system.as_ref(), &space, &masses, axes, surface).unwrap();
        assert!(kink(system.as_ref(), &space, &masses, &[1], surface).is_none());
        (of(&[0]).jump_at(0), of(&[0, 1]).jump_at(count / 2))
    };
    let exact = -4.0 * a * c / (s * s);
    // Even and odd counts: with and without cells in which nothing crosses the plane. Differences of the logarithm
    // of a normal density are exact, but at the ends of y, where e⁻⁹ of it is.
    for count in [40, 41, 80] {
        let (marginal, joint) = found(count);
        assert!((marginal / exact - 1.0).abs() < 1e-3, "{marginal} {exact}");
        assert!((joint / exact - 1.0).abs() < 1e-9, "{joint} {exact}");
    }
}

/// Where the density has a ring, it rises away from y = 0: the kink's sign is that of the density as well as of the
/// force.
#[test]
fn a_kink_whose_sign_depends_on_the_density_is_not_known() {
    let model = TypedModel::new("bang", "A spring with a preload", ["x", "y"])
        .with_equation("x", "y")
        .with_equation("y", "-x - 0.3 sign(x) - 0.5 y")
        .with_noise("y", ["0.7"])
        .build()
        .unwrap();
    let system = model.system_with(&[]).unwrap();
    let axis = |half: f64, count: usize| Axis::uniform(-half, half, count).unwrap();
    let space = CellSpace::new(vec![axis(3.0, 40), axis(3.0, 40)]).unwrap();
    let ring = |state: &[f64]| (-(state[0].powi(2) + state[1].powi(2) - 1.0).powi(2)).exp();
    let cells = 0..space.n_cells();
    let masses: Vec<f64> = cells.map(|cell| ring(&space.centre(cell))).collect();
    let surface = SwitchingSurface { axis: 0, at: 0.0 };
    assert_eq!(kink(system.as_ref(), &space, &masses, &[0], surface), None);
}

#[test]
fn the_law_is_used_only_where_it_holds() {
    let known = |of_x: &str, force: &str, noise: &str| {
        let model = TypedModel::new("bang", "A jump", ["x", "y"])
            .with_equation("x", of_x)
            .with_equation("y", force)
            .with_noise("y", [noise])
            .build()
            .unwrap();
        let system = model.system_with(&[]).unwrap();
        let axis = |half: f64, count: usize| Axis::uniform(-half, half, count).unwrap();
        let space = CellSpace::new(vec![axis(4.0, 40), axis(3.0, 30)]).unwrap();
        let surface = SwitchingSurface { axis: 0, at: 0.0 };
        let jumps = jumps(system.as_ref(), &space, surface);
        (jumps, is_known(system.as_ref(), &space, surface))
    };
    assert_eq!(known("y", "-x - sign(x) - y", "0.7"), (true, true));
    assert_eq!(
        known("y + 0.3 sin(x)", "-x - sign(x) - y", "0.7"),
        (true, true)
    );
    assert!(!known("y", "-x - y", "0.7").0);
    // Jumps that differ from place to place, a velocity that bends, and a noise that jumps.
    for (of_x, force, noise) in [
        ("y", "-x - (1 - 0.4 y^2) sign(x) - y", "0.7"),
        ("y", "-x - sign(x) y", "0.7"),
        ("y + 0.3 abs(x)", "-x - sign(x) - y", "0.7"),
        ("y", "-x - sign(x) - y", "0.7 + 0.1 sign(x)"),
    ] {
        assert_eq!(
            known(of_x, force, noise),
            (true, false),
            "{of_x}, {force}, {noise}"
        );
    }
}
