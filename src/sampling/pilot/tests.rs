//! A pilot of systems whose spread and rates are known.

use super::*;
use crate::cancellation::Cancellation;
use crate::space::Axis;
use crate::system::registry;
use crate::system::test_families::built_in;

fn square(half: f64, count: usize) -> CellSpace {
    let axis = Axis::uniform(-half, half, count).unwrap();
    CellSpace::new(vec![axis.clone(), axis]).unwrap()
}

#[test]
fn a_linear_oscillator_is_measured_and_gets_its_steps() {
    // σ²/(2κ) = 0.25 is the variance of both axes, ω = 1, γ = 0.02.
    let values = [("kappa", 0.02), ("f_c", 0.0), ("sigma2", 0.01)];
    let system = built_in("coulomb", &values);
    let space = square(3.0, 50);
    let pilot = pilot(&*system, &space, 1, &Cancellation::new()).unwrap();
    assert!((pilot.frequency - 1.0).abs() < 1e-6, "{pilot:?}");
    assert!((pilot.damping - 0.02).abs() < 1e-8, "{pilot:?}");
    // 256 trajectories for at least 10/γ: 2560 correlation times, a standard error of 2 % with the start's.
    for axis in 0..2 {
        assert!(
            (pilot.standard_deviation[axis] - 0.5).abs() < 0.05,
            "{pilot:?}"
        );
        assert!((pilot.mean_square_width[axis] - 0.0144).abs() < 1e-12);
    }
    assert_eq!(pilot.noise_intensity[0], 0.0);
    assert!((pilot.noise_intensity[1] - 0.005).abs() < 1e-12);
    assert!(pilot.share_inside > 0.99);
    let time_step = pilot.automatic_time_step(Integrator::StochasticHeun);
    assert!(
        (time_step - f64::cbrt(0.04 * 0.02)).abs() < 1e-6,
        "{time_step}"
    );
    let euler = pilot.automatic_time_step(Integrator::EulerMaruyama);
    assert!((euler - 2e-4).abs() < 1e-8, "{euler}");
    // 2 · (0.0144/12)/0.25 = 0.05 Δt · 0.005/0.25 gives 9.6 where both variances are equal.
    let map_step = pilot.automatic_map_step(time_step, 2000);
    assert!((map_step / 9.6 - 1.0).abs() < 0.1, "{map_step}");
    assert!((pilot.automatic_map_step(1e-5, 2000) - 1.0).abs() < 1e-12);
    assert_eq!(pilot.automatic_map_step(50.0, 2000), 50.0);
}

#[test]
fn visited_cells_hold_the_mass_on_any_number_of_threads() {
    let values = [("a", 1.0), ("sigma2", 0.02)];
    let system = built_in("bistable", &values);
    let space = CellSpace::new(vec![Axis::uniform(-2.0, 2.0, 40).unwrap()]).unwrap();
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| pilot(&*system, &space, 5, &Cancellation::new()).unwrap())
    };
    let pilot = run(1);
    assert_eq!(pilot, run(2));
    // Both wells, at ±1, and not the ends of the range.
    for x in [-1.0, 1.0] {
        assert!(pilot.cells.contains(&space.find(&[x]).unwrap()));
    }
    assert!(!pilot.cells.contains(&0) && !pilot.cells.contains(&39));
    assert!(pilot.cells.windows(2).all(|pair| pair[0] < pair[1]));
}

#[test]
fn a_system_that_runs_away_leaves_the_centre() {
    let values = [
        ("alpha", -0.5),
        ("kappa", 0.02),
        ("mu", 1.0),
        ("lambda", 0.06),
        ("f_c", 0.05),
        ("sigma2", 0.02),
    ];
    let system = registry::find("dahl_eq8")
        .unwrap()
        .system_with(&values)
        .unwrap();
    let axis = Axis::uniform(-2.5, 2.5, 10).unwrap();
    let space = CellSpace::new(vec![axis.clone(), axis.clone(), axis]).unwrap();
    let pilot = pilot(&*system, &space, 1, &Cancellation::new()).unwrap();
    assert!(pilot.share_inside < 0.05, "{}", pilot.share_inside);
    assert!(!pilot.cells.is_empty());
    let time_step = pilot.automatic_time_step(Integrator::StochasticHeun);
    let map_step = pilot.automatic_map_step(time_step, 2000);
    assert!(time_step > 0.0 && map_step >= time_step && map_step.is_finite());
}
