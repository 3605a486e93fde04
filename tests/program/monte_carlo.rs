//! Sweeps by free trajectories through the real binary: what they find, that nothing depends on threads, and that a
//! time step which falsifies the density is told.

use pbif::run::finding_in_words;

use crate::common::room::Room;
use crate::common::sweeps::solved;
use crate::common::table::Table;

const SMALL: &str = "method.error=0.02 sweep.points=2 locate.tolerance=1 cells.x={from=-5.5,to=5.5,count=30} \
                     cells.y={from=-5.5,to=5.5,count=30} locate.largest_distance=0.99";

/// The points of a sweep.
fn points(name: &str, method: &str, settings: &str) -> Table {
    let room = Room::new();
    room.solved(&format!(
        "sweep sweeps/{name}.toml --out run method.kind={method} {settings}"
    ));
    room.table("run/points.csv")
}

#[test]
fn a_sweep_finds_both_ends_and_does_not_depend_on_threads() {
    // Damped well, so that trajectories forget their start soon, with the same ratios of noise and friction to damping.
    let damped =
        "system.parameters.kappa=0.1 system.parameters.sigma2=0.1 sweep.from=-0.2 sweep.to=0.1";
    let [one, three] = [1, 3].map(|threads| {
        let settings = format!("{SMALL} {damped} --threads {threads}");
        points("coulomb_fc", "monte-carlo", &settings)
    });
    for (name, ends) in [
        ("status", ["solved", "solved"]),
        ("method", ["monte-carlo", "monte-carlo"]),
        ("peaks_x", ["2", "1"]),
        ("craters_xy", ["1", "0"]),
        ("warnings", ["", ""]),
    ] {
        assert_eq!(one.column(name), ends, "{name}");
    }
    assert_eq!(one.without(&["seconds"]), three.without(&["seconds"]));
}

#[test]
fn moments_are_those_of_the_exact_density() {
    // p ∝ exp((2/σ²)(ax²/2 - x⁴/4)): its variance by Simpson's rule.
    let settings = "method.error=0.005 sweep.points=2 locate.tolerance=10 --quiet";
    let sigma2 = 0.25;
    for row in points("bistable", "monte-carlo", settings).0 {
        let [a, deviation] = row.numbers(["a", "sd_x"]);
        let moment = |power: i32| -> f64 {
            let places = (-3000..=3000).map(|n| f64::from(n) * 1e-3);
            let log = |x: f64| 2.0 / sigma2 * (0.5 * a * x * x - 0.25 * x.powi(4));
            places.map(|x| x.powi(power) * log(x).exp()).sum()
        };
        let ratio = deviation / (moment(2) / moment(0)).sqrt();
        // A variance to 0.5 % is a deviation to 0.25 %; the time step may add as much as half of it.
        assert!((ratio - 1.0).abs() < 0.01, "{a}: {ratio}");
    }
}

#[test]
fn a_time_step_that_eats_the_damping_is_told_by_every_trajectory_method() {
    // A bias of a half is seen by a sixth of the trajectories that two per cent ask for.
    let steps = "method.time_step=0.01 method.burn_in=500 method.length=50 method.samples=64 method.map_step=3 \
                 method.error=0.05";
    let coulomb = include_str!("../../sweeps/coulomb_fc.toml");
    for method in ["monte-carlo", "sgcm"] {
        // At one value alone, by the words that a run puts into its table.
        let narrow = |integrator: &str| {
            let kind = format!("method.kind={method} method.integrator={integrator}");
            let (sweep, solution) = solved(coulomb, &format!("{SMALL} {steps} {kind}"), Some(0.0));
            let report = solution.report;
            let told = |one| finding_in_words(sweep.problem.family(), one);
            let told: Vec<String> = report.findings.iter().map(told).collect();
            (report.measure("time_step_bias").unwrap(), told.join("; "))
        };
        let (bias, told) = narrow("euler-maruyama");
        // Without damping the sample's energy grows, while with half the step half the damping is left.
        assert!(bias > 0.5, "{method}: {bias}");
        assert!(
            told.contains("the time step 0.0100 shifts"),
            "{method}: {told}"
        );
        let (bias, told) = narrow("heun");
        assert!(bias < 0.02, "{method}: {bias}");
        assert!(!told.contains("time step"), "{method}: {told}");
    }
}

#[test]
fn warnings_of_every_value_are_told_once() {
    let room = Room::new();
    // Values alone: what changes between them is not looked for.
    let few = "method.kind=sgcm method.samples=20 sweep.points=31 cells.x.count=14 cells.y.count=14 \
               locate.tolerance=1 locate.grid_check=off locate.largest_distance=0.99 method.map_step=3 \
               method.time_step=0.1";
    let line = format!("sweep sweeps/coulomb_fc.toml --out run --quiet figures.formats=[] {few}");
    let text = room.solved(&line).text();
    assert!(text.len() < 3_000, "{} bytes: {text}", text.len());
    assert!(
        room.table("run/points.csv")
            .column("warnings")
            .iter()
            .any(|one| !one.is_empty())
    );
}

#[test]
fn an_ensemble_sweeps_too() {
    let ensemble = "method.estimator=ensemble method.trajectories=20000 method.time_step=0.1 method.burn_in=500";
    let found = points(
        "coulomb_fc",
        "monte-carlo",
        &format!("{SMALL} {ensemble} --quiet"),
    );
    assert_eq!(found.column("peaks_x"), ["2", "1"]);
    assert_eq!(found.column("iterations"), ["5000", "5000"]);
}

#[test]
fn trajectories_that_run_away_leave_no_density() {
    let found = points(
        "dahl_alpha_eq8",
        "monte-carlo",
        "method.error=0.05 sweep.points=2 --quiet",
    );
    assert!(
        found
            .column("status")
            .iter()
            .all(|status| *status == "no-steady-state")
    );
    assert!(found.column("warnings")[0].contains("no steady state in Ω"));
}
