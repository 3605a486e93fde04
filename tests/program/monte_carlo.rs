//! Sweeps by free trajectories through the real binary: what they find, that nothing depends on threads, and that a
//! time step which falsifies the density is told.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

const SMALL: &[&str] = &[
    "method.kind=monte-carlo",
    "method.error=0.02",
    "sweep.points=2",
    "locate.tolerance=1",
    "cells.x={ from = -5.5, to = 5.5, count = 30 }",
    "cells.y={ from = -5.5, to = 5.5, count = 30 }",
    "locate.largest_distance=0.99",
];

fn pbif(command: &str, sweep: &str, overrides: &[&str], options: &[&str]) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = root.join("sweeps").join(format!("{sweep}.toml"));
    let mut run = Command::new(env!("CARGO_BIN_EXE_pbif"));
    run.arg(command).arg(file).args(options);
    for setting in overrides {
        run.args(["--set", setting]);
    }
    run.output().unwrap()
}

/// Columns of `points.csv`, by name, of a sweep.
fn points(sweep: &str, overrides: &[&str], options: &[&str]) -> Vec<(String, Vec<String>)> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("run");
    let mut options = options.to_vec();
    options.extend(["--out", path.to_str().unwrap()]);
    let output = pbif("sweep", sweep, overrides, &options);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let mut reader = csv::Reader::from_path(path.join("points.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let column = |index: usize| rows.iter().map(|row| row[index].to_owned()).collect();
    let columns = header.iter().enumerate();
    columns
        .map(|(index, name)| (name.to_owned(), column(index)))
        .collect()
}

fn column<'a>(columns: &'a [(String, Vec<String>)], name: &str) -> &'a [String] {
    let found = columns.iter().find(|column| column.0 == name);
    &found.unwrap_or_else(|| panic!("no column {name}")).1
}

#[test]
fn a_sweep_finds_both_ends_and_does_not_depend_on_threads() {
    let one = points("coulomb_fc", SMALL, &["--threads", "1"]);
    for (name, first, last) in [
        ("status", "solved", "solved"),
        ("method", "monte-carlo", "monte-carlo"),
        ("peaks_x", "2", "1"),
        ("craters_xy", "1", "0"),
        ("warnings", "", ""),
    ] {
        let values = column(&one, name);
        assert_eq!(
            (values[0].as_str(), values[1].as_str()),
            (first, last),
            "{name}"
        );
    }
    let three = points("coulomb_fc", SMALL, &["--threads", "3"]);
    for (columns, others) in one.iter().zip(&three) {
        assert!(
            columns == others || columns.0 == "seconds",
            "{columns:?} {others:?}"
        );
    }
}

#[test]
fn moments_are_those_of_the_exact_density() {
    // p ∝ exp((2/σ²)(ax²/2 - x⁴/4)): its variance by Simpson's rule.
    let overrides = [
        "method.kind=monte-carlo",
        "method.error=0.005",
        "sweep.points=2",
        "locate.tolerance=10",
    ];
    let found = points("bistable", &overrides, &["--quiet"]);
    let sigma2 = 0.25;
    for (a, deviation) in column(&found, "a").iter().zip(column(&found, "sd_x")) {
        let a: f64 = a.parse().unwrap();
        let moment = |power: i32| -> f64 {
            (-3000..=3000)
                .map(|n| f64::from(n) * 1e-3)
                .map(|x| {
                    x.powi(power) * (2.0 / sigma2 * (0.5 * a * x * x - 0.25 * x.powi(4))).exp()
                })
                .sum()
        };
        let exact = (moment(2) / moment(0)).sqrt();
        let ratio = deviation.parse::<f64>().unwrap() / exact;
        // A variance to 0.5 % is a deviation to 0.25 %; the time step may add as much as half of it.
        assert!((ratio - 1.0).abs() < 0.01, "{a}: {ratio}");
    }
}

#[test]
fn a_time_step_that_eats_the_damping_is_told_by_every_trajectory_method() {
    let narrow = |method: &str, integrator: &str| {
        let mut sets = SMALL.to_vec();
        let kind = format!("method.kind={method}");
        let integrator = format!("method.integrator={integrator}");
        sets.extend([
            kind.as_str(),
            integrator.as_str(),
            "method.time_step=0.01",
            "method.burn_in=500",
            "method.length=50",
            "method.samples=64",
            "method.map_step=3",
            "sweep.from=0.0",
            "figures.at=[0.0]",
        ]);
        points("coulomb_fc", &sets, &["--quiet"])
    };
    for method in ["monte-carlo", "sgcm"] {
        let euler = narrow(method, "euler-maruyama");
        // Without damping the sample's energy grows, while with half the step half the damping is left.
        let bias: f64 = column(&euler, "time_step_bias")[0].parse().unwrap();
        assert!(bias > 0.5, "{method}: {bias}");
        let told = &column(&euler, "warnings")[0];
        assert!(
            told.contains("the time step 0.0100 shifts"),
            "{method}: {told}"
        );
        let heun = narrow(method, "heun");
        let bias: f64 = column(&heun, "time_step_bias")[0].parse().unwrap();
        assert!(bias < 0.02, "{method}: {bias}");
        let told = &column(&heun, "warnings")[0];
        assert!(!told.contains("time step"), "{method}: {told}");
    }
}

#[test]
fn an_ensemble_sweeps_too() {
    let mut sets = SMALL.to_vec();
    sets.extend([
        "method.estimator=ensemble",
        "method.trajectories=20000",
        "method.time_step=0.1",
        "method.burn_in=500",
    ]);
    let found = points("coulomb_fc", &sets, &["--quiet"]);
    assert_eq!(column(&found, "peaks_x"), ["2", "1"]);
    assert_eq!(column(&found, "iterations"), ["5000", "5000"]);
}

#[test]
fn trajectories_that_run_away_leave_no_density() {
    let sets = [
        "method.kind=monte-carlo",
        "method.error=0.05",
        "sweep.points=2",
    ];
    let found = points("dahl_alpha_eq8", &sets, &["--quiet"]);
    assert!(
        column(&found, "status")
            .iter()
            .all(|status| status == "no-steady-state")
    );
    assert!(column(&found, "warnings")[0].contains("no steady state in Ω"));
}

#[test]
fn the_cost_is_counted() {
    let mut sets = SMALL.to_vec();
    let text = |sets: &[&str]| {
        let output = pbif("check", "coulomb_fc", sets, &[]);
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let left = text(&sets);
    assert!(
        left.contains("chosen when the sweep runs, for a relative error of 0.02"),
        "{left}"
    );
    // 900 cells of 32 blocks of 16 bytes.
    assert!(left.contains("memory: 460.8 kB"), "{left}");
    sets.extend([
        "method.time_step=0.01",
        "method.burn_in=100",
        "method.length=900",
        "method.trajectories=640",
    ]);
    let given = text(&sets);
    assert!(given.contains("time steps: 6.400e7 a point"), "{given}");
}
