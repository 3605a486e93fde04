//! The main job through the real binary, on small grids: what the shipped sweeps must show, what a run leaves, and
//! that it does not depend on the number of threads.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use pbif::cancellation::Cancellation;
use pbif::sweep_file::{Grade, SweepFile};
use tempfile::TempDir;

fn sweep_file(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("sweeps").join(format!("{name}.toml"))
}

/// Runs a shipped sweep with overrides; the results go to `folder/run`.
fn run(name: &str, overrides: &[&str], options: &[&str], folder: &TempDir) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    command.arg("sweep").arg(sweep_file(name)).args(options);
    // These tests are of SGCM, on cells of equal width; those of the generator say so.
    if !overrides
        .iter()
        .any(|setting| setting.contains("generator"))
    {
        command.args(["--set", "method.kind=sgcm"]);
    }
    for setting in overrides {
        command.args(["--set", setting]);
    }
    command.arg("--out").arg(folder.path().join("run"));
    command.output().unwrap()
}

/// A table of a run: its header and rows.
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(folder: &TempDir, name: &str) -> Self {
        let mut reader = csv::Reader::from_path(folder.path().join("run").join(name)).unwrap();
        let words = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
        Self {
            header: words(reader.headers().unwrap()),
            rows: reader.records().map(|row| words(&row.unwrap())).collect(),
        }
    }

    fn column(&self, name: &str) -> Vec<&str> {
        let index = self.header.iter().position(|column| column == name);
        let index = index.unwrap_or_else(|| panic!("no column {name}"));
        self.rows.iter().map(|row| row[index].as_str()).collect()
    }
}

/// The rows of P-bifurcations of one observable: value, lower, upper, before, after.
fn changes(folder: &TempDir, observable: &str) -> Vec<(f64, f64, f64, String, String)> {
    let table = Table::read(folder, "bifurcations.csv");
    let number = |text: &str| text.parse::<f64>().unwrap();
    table
        .rows
        .iter()
        .filter(|row| row[0].starts_with("PB") && row[6] == observable)
        .map(|row| {
            let words = (row[7].clone(), row[8].clone());
            (
                number(&row[2]),
                number(&row[4]),
                number(&row[5]),
                words.0,
                words.1,
            )
        })
        .collect()
}

const SMALL_COULOMB: &[&str] = &[
    "cells.x.count=30",
    "cells.y={ from = -5.5, to = 5.5, count = 30 }",
    "sweep.points=4",
    "method.samples=800",
    "locate.tolerance=1e-4",
];

const SMALL_EQ5: &[&str] = &[
    "cells.x.count=30",
    "cells.y={ from = -0.4, to = 0.4, count = 30 }",
    "sweep.points=4",
    "method.samples=800",
];

#[test]
fn coulomb_goes_from_two_peaks_and_a_crater_to_one_peak() {
    let folder = TempDir::new().unwrap();
    let output = run("coulomb_fc", SMALL_COULOMB, &[], &folder);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let points = Table::read(&folder, "points.csv");
    let ends = |name: &str| {
        let column = points.column(name);
        (column[0].to_owned(), column[column.len() - 1].to_owned())
    };
    assert_eq!(ends("f_c"), ("-0.02".into(), "0.01".into()));
    for (column, first, last) in [
        ("peaks_x", "2", "1"),
        ("peaks_y", "2", "1"),
        ("craters_xy", "1", "0"),
        ("rings_xy", "1", "0"),
        ("peaks_xy", "0", "1"),
    ] {
        assert_eq!(ends(column), (first.into(), last.into()), "{column}");
    }
    for (observable, before, after) in [("x", "2 peaks", "1 peak"), ("y", "2 peaks", "1 peak")] {
        let rows = changes(&folder, observable);
        assert_eq!(rows.len(), 1, "{observable}: no spurious change");
        assert_eq!((rows[0].3.as_str(), rows[0].4.as_str()), (before, after));
    }
    // The ring goes, by stages that noise may blur; each row says what the one before it left, and none that is called
    // located lies off zero, where the two peaks meet.
    let rows = changes(&folder, "xy");
    assert_eq!(
        (rows[0].3.as_str(), rows[rows.len() - 1].4.as_str()),
        ("ring", "1 peak")
    );
    assert!(
        rows.windows(2).all(|pair| pair[0].4 == pair[1].3),
        "{rows:?}"
    );
    let table = Table::read(&folder, "bifurcations.csv");
    let located = table
        .rows
        .iter()
        .filter(|row| row[6] == "xy" && row[9] == "located");
    let values: Vec<f64> = located.map(|row| row[2].parse().unwrap()).collect();
    assert!(values.iter().all(|value| value.abs() < 1e-4), "{values:?}");
    // The velocity's density changes exactly at zero.
    let (_, lower, upper, _, _) = changes(&folder, "y")[0];
    assert!(lower <= 0.0 && 0.0 <= upper, "[{lower}, {upper}]");
    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(
        stdout.contains("PB1") && stdout.contains("merger at a kink"),
        "{stdout}"
    );
    for file in [
        "run.json",
        "features.csv",
        "bifurcations.tex",
        "densities.zarr/zarr.json",
    ] {
        assert!(folder.path().join("run").join(file).is_file(), "{file}");
    }
    for figure in [
        "diagram_x.svg",
        "diagram_y.png",
        "marginals.svg",
        "joint_xy.png",
    ] {
        assert!(
            folder.path().join("run/figures").join(figure).is_file(),
            "{figure}"
        );
    }
}

#[test]
fn coulomb_as_printed_in_equation_five_has_one_peak_in_x() {
    let folder = TempDir::new().unwrap();
    let output = run("coulomb_fc_eq5", SMALL_EQ5, &["--quiet"], &folder);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let points = Table::read(&folder, "points.csv");
    assert!(points.column("peaks_x").iter().all(|&peaks| peaks == "1"));
}

#[test]
fn dahl_goes_from_two_peaks_to_one_in_x_and_stays_at_one_in_y() {
    let folder = TempDir::new().unwrap();
    let overrides = [
        "cells.x.count=24",
        "cells.y.count=24",
        "cells.z.count=8",
        "sweep.points=4",
        "method.samples=80",
        "locate.tolerance=1",
    ];
    let output = run("dahl_alpha", &overrides, &["--quiet"], &folder);
    // On so few cells the peaks of x are too near each other to be confirmed.
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    let points = Table::read(&folder, "points.csv");
    assert_eq!(points.column("peaks_x")[0], "2");
    assert_eq!(points.column("peaks_x").last().copied(), Some("1"));
    assert!(points.column("peaks_y").iter().all(|&peaks| peaks == "1"));
    let rows = changes(&folder, "x");
    assert_eq!(rows.len(), 1);
    assert_eq!(
        (rows[0].3.as_str(), rows[0].4.as_str()),
        ("2 peaks", "1 peak")
    );
    assert!(changes(&folder, "y").is_empty());
}

#[test]
fn exact_bifurcations_lie_in_the_stated_band() {
    let cases: [(&str, &str, &[&str]); 2] = [
        ("bistable", "x", &["sweep.points=21", "method.samples=5000"]),
        (
            "rayleigh_crater",
            "xy",
            &[
                "cells.x.count=30",
                "cells.y.count=30",
                "sweep.points=9",
                "method.samples=1000",
            ],
        ),
    ];
    for (name, observable, overrides) in cases {
        let folder = TempDir::new().unwrap();
        let output = run(name, overrides, &["--quiet"], &folder);
        assert!(
            matches!(output.status.code(), Some(0 | 1)),
            "{name}: {output:?}"
        );
        let rows = changes(&folder, observable);
        assert_eq!(rows.len(), 1, "{name}: {rows:?}");
        let (value, lower, upper, before, after) = rows[0].clone();
        assert!(lower <= 0.0 && 0.0 <= upper, "{name}: [{lower}, {upper}]");
        assert!(lower <= value && value <= upper);
        assert_eq!(before, "1 peak", "{name}");
        assert_eq!(
            after,
            if observable == "x" { "2 peaks" } else { "ring" },
            "{name}"
        );
    }
}

#[test]
fn dahl_as_printed_ends_in_a_message_and_no_picture() {
    let folder = TempDir::new().unwrap();
    let overrides = [
        "cells.x.count=16",
        "cells.y.count=16",
        "cells.z.count=10",
        "sweep.points=3",
        "method.samples=64",
    ];
    let output = run("dahl_alpha_eq8", &overrides, &[], &folder);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let stdout = String::from_utf8(output.stdout).unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(stdout.contains("MX1"), "{stdout}");
    assert!(stdout.contains("no steady state in Ω"), "{stdout}");
    assert!(stderr.contains("no steady state in Ω"), "{stderr}");
    assert!(!folder.path().join("run/figures").exists());
    assert!(!folder.path().join("run/densities.zarr").exists());
    let points = Table::read(&folder, "points.csv");
    assert!(
        points
            .column("status")
            .iter()
            .all(|&status| status == "no-steady-state")
    );
    for file in ["points.csv", "features.csv", "bifurcations.csv", "run.json"] {
        let text = std::fs::read_to_string(folder.path().join("run").join(file)).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{file}");
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let overrides = [
        "cells.x.count=20",
        "cells.y={ from = -5.5, to = 5.5, count = 20 }",
        "sweep.points=3",
        "method.samples=160",
        "locate.largest_distance=0.99",
        "locate.tolerance=2e-3",
    ];
    assert_same_on_one_thread_and_two(&overrides, &["densities.zarr/p_xy_error/c/1/0/0"]);
}

/// Every table, densities and a figure of a coulomb sweep are the same bits on one thread and on two; `seconds` apart.
fn assert_same_on_one_thread_and_two(overrides: &[&str], more: &[&str]) {
    let folders = ["1", "2"].map(|threads| {
        let folder = TempDir::new().unwrap();
        let options = ["--quiet", "--threads", threads];
        run("coulomb_fc", overrides, &options, &folder);
        folder
    });
    let text =
        |folder: &TempDir, file: &str| std::fs::read(folder.path().join("run").join(file)).unwrap();
    let files = [
        "features.csv",
        "bifurcations.csv",
        "densities.zarr/p_xy/c/1/0/0",
        "figures/diagram_x.svg",
    ];
    for file in files.iter().chain(more) {
        assert_eq!(text(&folders[0], file), text(&folders[1], file), "{file}");
    }
    let tables = folders
        .each_ref()
        .map(|folder| Table::read(folder, "points.csv"));
    for name in &tables[0].header {
        if name != "seconds" {
            assert_eq!(tables[0].column(name), tables[1].column(name), "{name}");
        }
    }
}

#[test]
fn quiet_leaves_the_results_alone_and_an_earlier_run_is_kept() {
    let folder = TempDir::new().unwrap();
    let overrides = ["sweep.points=3", "method.samples=200", "locate.tolerance=1"];
    let first = run("bistable", &overrides, &["--quiet"], &folder);
    assert!(first.stderr.is_empty(), "{first:?}");
    assert!(!first.stdout.is_empty() && !first.stdout.contains(&b'\x1b'));
    let before = std::fs::read(folder.path().join("run/features.csv")).unwrap();
    run("bistable", &overrides, &["--quiet"], &folder);
    let kept = std::fs::read(folder.path().join("run/previous/1/features.csv")).unwrap();
    assert_eq!(before, kept);
}

const GENERATOR_COULOMB: &[&str] = &[
    "method.kind=generator",
    "sweep.points=61",
    "locate.tolerance=3e-5",
    "cells.x.grade={ at = [0.0], smallest = 0.03 }",
];

#[test]
fn the_generator_finds_every_stage_of_the_joint_density() {
    let folder = TempDir::new().unwrap();
    let output = run("coulomb_fc", GENERATOR_COULOMB, &["--quiet"], &folder);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    // The velocity's density has its kink at zero exactly; x and the stages of the joint density change nearby.
    let y = changes(&folder, "y");
    assert_eq!(y.len(), 1, "{y:?}");
    assert!(y[0].1 <= 0.0 && 0.0 <= y[0].2, "{y:?}");
    let x = changes(&folder, "x");
    assert_eq!(x.len(), 1, "{x:?}");
    assert_eq!((x[0].3.as_str(), x[0].4.as_str()), ("2 peaks", "1 peak"));
    let stages: Vec<String> = changes(&folder, "xy")
        .into_iter()
        .map(|row| row.4)
        .collect();
    assert_eq!(stages, ["2 peaks", "1 peak"]);
    let points = Table::read(&folder, "points.csv");
    assert!(
        points
            .column("method")
            .iter()
            .all(|&method| method == "generator")
    );
    // Work, not time: warm starts save factorisations (a cold one a point would be as many as rows).
    let factorisations = |row: &&str| row.parse::<usize>().unwrap();
    let total: usize = points
        .column("factorisations")
        .iter()
        .map(factorisations)
        .sum();
    assert!(2 * total < points.rows.len(), "{total} factorisations");
}

#[test]
fn the_generator_does_not_depend_on_the_number_of_threads() {
    let overrides = [
        "method.kind=generator",
        "cells.x.count=50",
        "cells.y.count=60",
        "sweep.points=4",
        "locate.tolerance=1",
    ];
    assert_same_on_one_thread_and_two(&overrides, &[]);
}

#[test]
fn the_generator_brackets_exact_bifurcations_tightly() {
    for (name, observable, width) in [("bistable", "x", 0.04), ("rayleigh_crater", "xy", 0.02)] {
        let folder = TempDir::new().unwrap();
        let overrides = ["method.kind=generator", "locate.tolerance=1e-3"];
        let output = run(name, &overrides, &["--quiet"], &folder);
        assert!(
            matches!(output.status.code(), Some(0 | 1)),
            "{name}: {output:?}"
        );
        let rows = changes(&folder, observable);
        assert_eq!(rows.len(), 1, "{name}: {rows:?}");
        let (_, lower, upper, ..) = rows[0].clone();
        assert!(lower <= 0.0 && 0.0 <= upper, "{name}: [{lower}, {upper}]");
        assert!(upper - lower < width, "{name}: [{lower}, {upper}]");
    }
}

#[test]
fn dahl_as_printed_has_no_steady_state_by_the_generator_either() {
    let folder = TempDir::new().unwrap();
    let overrides = [
        "method.kind=generator",
        "cells.x.count=16",
        "cells.y.count=16",
        "cells.z.count=10",
        "sweep.points=2",
    ];
    let output = run("dahl_alpha_eq8", &overrides, &["--quiet"], &folder);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("no steady state in Ω")
    );
    assert!(!folder.path().join("run/figures").exists());
}

#[test]
fn ranges_and_gradings_are_found() {
    let axis = "{ range = \"auto\", count = 40, grade = \"auto\" }";
    let mut file = SweepFile::read(&sweep_file("coulomb_fc")).unwrap();
    file.set("cells.x", axis).set("cells.y", axis);
    let sweep = file
        .validate()
        .unwrap()
        .prepare(&Cancellation::new())
        .unwrap();
    for axis in &sweep.settings.axes {
        // At f_c = -0.02 the ring has radius 2.5 and noise around it: 5.5 holds all but 1e-5.
        let (from, to) = axis.range.unwrap();
        assert!((5.5..9.0).contains(&to), "{to}");
        assert_eq!(from, -to);
    }
    let grades: Vec<&Grade> = sweep.settings.axes.iter().map(|axis| &axis.grade).collect();
    assert!(matches!(grades[..], [Grade::Even, Grade::Toward(_)]));
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_the_rows_that_were_done() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};
    let folder = TempDir::new().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_pbif"))
        .arg("sweep")
        .arg(sweep_file("coulomb_fc"))
        .args(["--set", "cells.x.count=20", "--set", "cells.y.count=20"])
        .args(["--set", "sweep.points=2000", "--set", "method.samples=160"])
        .arg("--out")
        .arg(folder.path().join("run"))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // Wait until two points are reported, then interrupt as Ctrl-C does.
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().contains("   2 of")));
    let pid = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    lines.for_each(drop);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let points = Table::read(&folder, "points.csv");
    assert!(points.rows.len() >= 2 && points.rows.len() < 2000);
    let manifest = std::fs::read_to_string(folder.path().join("run/run.json")).unwrap();
    assert!(manifest.contains("\"interrupted\""));
}
