//! The main job through the real binary, on small grids: what the shipped sweeps must show, what a run leaves, and
//! that it does not depend on the number of threads.

use pbif::cancellation::Cancellation;
use pbif::sweep_file::{Grade, SweepFile};

use crate::common::room::{Printed, Room, shipped};
use crate::common::table::Row;

/// A shipped sweep run into `run`, which may leave rows unresolved; SGCM, unless the settings say otherwise.
fn swept(name: &str, settings: &str) -> Room {
    let room = Room::new();
    sweep_in(&room, name, settings);
    room
}

fn sweep_in(room: &Room, name: &str, settings: &str) -> Printed {
    let kind = if settings.contains("method.kind") {
        ""
    } else {
        "method.kind=sgcm"
    };
    room.solved(&format!(
        "sweep sweeps/{name}.toml --out run --quiet {kind} {settings}"
    ))
}

const WORDS: [&str; 2] = ["before", "after"];

/// The only change of an observable, between these words.
fn assert_one(room: &Room, observable: &str, words: [&str; 2]) -> Row {
    let table = room.table("run/bifurcations.csv");
    let rows = table.changes(observable);
    assert_eq!(rows.len(), 1, "{observable}: {rows:?}");
    assert_eq!(rows[0].texts(WORDS), words, "{observable}");
    let [value, lower, upper] = rows[0].numbers(["value", "lower", "upper"]);
    assert!(lower <= value && value <= upper);
    rows[0].clone()
}

fn assert_all(room: &Room, column: &str, wanted: &str) {
    let points = room.table("run/points.csv");
    let column = points.column(column);
    assert!(column.iter().all(|text| *text == wanted), "{column:?}");
}

/// What columns of the points have first and last.
fn assert_ends(room: &Room, ends: &[(&str, &str, &str)]) {
    let points = room.table("run/points.csv");
    for (column, first, last) in ends {
        let texts = points.column(column);
        assert_eq!(
            [texts[0], texts[texts.len() - 1]],
            [*first, *last],
            "{column}"
        );
    }
}

/// Ten times the damping, noise and friction of the shipped sweep: shapes change at ten times its values, and
/// trajectories forget their start in a tenth of the time.
const DAMPED: &str =
    "system.parameters.kappa=0.1 system.parameters.sigma2=0.1 sweep.from=-0.2 sweep.to=0.1";

#[test]
fn coulomb_goes_from_two_peaks_and_a_crater_to_one_peak() {
    let room = Room::new();
    let cells = "cells.x.count=30 cells.y={from=-5.5,to=5.5,count=30}";
    let line = format!(
        "sweep sweeps/coulomb_fc.toml --out run method.kind=sgcm {cells} {DAMPED} sweep.points=4 method.samples=800 \
         figures.at=[-0.2,0.1] locate.tolerance=1e-3"
    );
    let printed = room.solved(&line);
    assert_ends(
        &room,
        &[
            ("f_c", "-0.2", "0.1"),
            ("peaks_x", "2", "1"),
            ("peaks_y", "2", "1"),
            ("craters_xy", "1", "0"),
            ("rings_xy", "1", "0"),
            ("peaks_xy", "0", "1"),
        ],
    );
    assert_one(&room, "x", ["2 peaks", "1 peak"]);
    // The velocity's density changes exactly at zero.
    assert!(assert_one(&room, "y", ["2 peaks", "1 peak"]).holds(0.0));
    // The ring goes, by stages that noise may blur; each row says what the one before it left, and none that is called
    // located lies off zero, where the two peaks meet.
    let table = room.table("run/bifurcations.csv");
    let rows = table.changes("xy");
    assert_eq!(
        (&rows[0]["before"], &rows[rows.len() - 1]["after"]),
        ("ring", "1 peak")
    );
    assert!(
        rows.windows(2)
            .all(|pair| pair[0]["after"] == pair[1]["before"]),
        "{rows:?}"
    );
    for row in rows.iter().filter(|row| &row["status"] == "located") {
        assert!(row.number("value").abs() < 1e-3, "{row:?}");
    }
    printed.says(&["PB1", "merger at a kink"]);
    room.holds_all(
        "run",
        "run.json features.csv bifurcations.tex densities.zarr/zarr.json",
    );
    room.holds_all(
        "run/figures",
        "diagram_x.svg diagram_y.png marginals.svg joint_xy.png",
    );
}

/// With negative friction the oscillator keeps moving, and x has two peaks. At one end of this sweep so few cells count
/// one, and finer cells both.
#[test]
fn ends_that_are_counted_differently_without_a_change_are_named() {
    let room = Room::new();
    let cells = "cells.x.count=24 cells.y.count=24 figures.formats=[]";
    let line = format!(
        "sweep sweeps/coulomb_fc.toml --out run {cells} sweep.points=3 sweep.to=-0.005 figures.at=[-0.01] locate.tolerance=5e-3"
    );
    let printed = room.run(&line).ends(1);
    let [below, above] = ["-0.02: x 2 peaks", "-0.005: x 1 peak"];
    assert!(
        printed.out.contains(below) && printed.out.contains(above),
        "{}",
        printed.out
    );
    assert!(room.table("run/bifurcations.csv").changes("x").is_empty());
    let words =
        "the counts of the sweep differ from value to value, but finer cells show no change";
    for text in [printed.out.clone(), room.read("run/bifurcations.md")] {
        let names_x = |line: &str| line.starts_with("x") && line.contains(words);
        assert!(text.lines().any(names_x), "{text}");
    }
    // Without finer cells the peak of x that is there at one end, and may be an error, lies beside no row.
    let again = Room::new();
    let printed = again.run(&format!("{line} locate.effort=0")).ends(1);
    let words = "x, y: no row tells of a feature that the cells cannot tell from their errors";
    assert!(printed.out.contains(words), "{}", printed.out);
    assert!(again.read("run/bifurcations.md").contains(words));
}

#[test]
fn coulomb_as_printed_in_equation_five_has_one_peak_in_x() {
    let cells = "cells.x.count=30 cells.y={from=-0.4,to=0.4,count=30}";
    let room = swept(
        "coulomb_fc_eq5",
        &format!("{cells} sweep.points=4 method.samples=800"),
    );
    assert_all(&room, "peaks_x", "1");
}

#[test]
fn dahl_goes_from_two_peaks_to_one_in_x_and_stays_at_one_in_y() {
    let cells = "cells.x.count=24 cells.y.count=24 cells.z.count=8";
    let settings = "sweep.points=4 method.samples=80 locate.tolerance=1";
    // On so few cells the peaks of x are too near each other to be confirmed.
    let room = swept("dahl_alpha", &format!("{cells} {settings}"));
    assert_ends(&room, &[("peaks_x", "2", "1")]);
    assert_all(&room, "peaks_y", "1");
    assert_one(&room, "x", ["2 peaks", "1 peak"]);
    assert!(room.table("run/bifurcations.csv").changes("y").is_empty());
}

#[test]
fn exact_bifurcations_lie_in_the_stated_band() {
    let splits = ("bistable", "x", "2 peaks");
    let opens = ("rayleigh_crater", "xy", "ring");
    // Samples tell no more than these tolerances ask for.
    let line = "sweep.points=21 method.samples=5000 locate.tolerance=5e-3";
    let grid = "cells.x.count=30 cells.y.count=30 sweep.points=9 method.samples=1000 locate.tolerance=2e-3";
    let exact = "method.kind=generator locate.tolerance=1e-3";
    // By SGCM, and tightly by the generator.
    for ((name, observable, after), settings, width) in [
        (splits, line, f64::INFINITY),
        (opens, grid, f64::INFINITY),
        (splits, exact, 0.04),
        (opens, exact, 0.02),
    ] {
        let row = assert_one(&swept(name, settings), observable, ["1 peak", after]);
        // What samples state is an interval of 95 %, of which a hundred miss five times: twice as much holds.
        let is_held = match width.is_finite() {
            true => row.holds(0.0),
            false => row.number("value").abs() <= 2.0 * row.number("error"),
        };
        assert!(is_held, "{name}: {row:?}");
        assert!(
            row.number("upper") - row.number("lower") < width,
            "{name}: {row:?}"
        );
    }
}

#[test]
fn dahl_as_printed_ends_in_a_message_and_no_picture() {
    for settings in [
        "sweep.points=3 method.samples=64 method.kind=sgcm",
        "sweep.points=2 method.kind=generator",
    ] {
        let room = Room::new();
        let cells = "cells.x.count=16 cells.y.count=16 cells.z.count=10";
        let line = format!("sweep sweeps/dahl_alpha_eq8.toml --out run {cells} {settings}");
        let printed = room.run(&line).ends(1).says(&["MX1"]);
        for words in [&printed.out, &printed.err] {
            assert!(words.contains("no steady state in Ω"), "{printed:?}");
        }
        assert!(!room.holds("run/figures") && !room.holds("run/densities.zarr"));
        assert_all(&room, "status", "no-steady-state");
        for file in ["points.csv", "features.csv", "bifurcations.csv", "run.json"] {
            let text = room.read(&format!("run/{file}"));
            assert!(!text.contains("NaN") && !text.contains("inf"), "{file}");
        }
    }
}

/// Every table, densities and a figure of a coulomb sweep are the same bits on one thread and on two; `seconds` apart.
#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let sampled = "cells.x.count=20 cells.y={from=-5.5,to=5.5,count=20} sweep.points=3 method.samples=160 \
                   locate.largest_distance=0.99 locate.tolerance=2e-2 figures.at=[-0.2,0.1]";
    let sampled = &*format!("{DAMPED} {sampled}");
    // Four segments, and changes that are far from each other.
    let generator = "method.kind=generator cells.x.count=40 cells.y.count=40 sweep.points=33 locate.tolerance=1e-4";
    for (settings, more) in [
        (sampled, "densities.zarr/p_xy_error/c/0/0/0"),
        (generator, "checks.csv"),
    ] {
        let on = |threads: usize| swept("coulomb_fc", &format!("{settings} --threads {threads}"));
        let one = on(1);
        let files =
            "features.csv bifurcations.csv densities.zarr/p_xy/c/0/0/0 figures/diagram_x.svg";
        for threads in [3, 16] {
            let other = on(threads);
            for file in files.split(' ').chain(more.split_whitespace()) {
                let file = format!("run/{file}");
                assert_eq!(one.bytes(&file), other.bytes(&file), "{file} {threads}");
            }
            let table = |room: &Room| room.table("run/points.csv").without(&["seconds"]);
            assert_eq!(table(&one), table(&other), "{threads}");
        }
    }
}

#[test]
fn quiet_leaves_the_results_alone_and_an_earlier_run_is_kept() {
    let settings = "sweep.points=3 method.samples=200 locate.tolerance=1";
    let room = Room::new();
    let first = sweep_in(&room, "bistable", settings);
    assert!(first.err.is_empty() && !first.out.is_empty(), "{first:?}");
    assert!(!first.out.contains('\x1b'));
    let before = room.bytes("run/features.csv");
    sweep_in(&room, "bistable", settings);
    assert_eq!(before, room.bytes("run/previous/1/features.csv"));
}

#[test]
fn the_generator_finds_every_stage_of_the_joint_density() {
    let grade = "'cells.x.grade={ at = [0.0], smallest = 0.03 }'";
    let settings = format!("method.kind=generator sweep.points=61 locate.tolerance=3e-5 {grade}");
    let room = swept("coulomb_fc", &settings);
    // The velocity's density has its kink at zero exactly; x and the stages of the joint density change nearby.
    assert!(assert_one(&room, "y", ["2 peaks", "1 peak"]).holds(0.0));
    assert_one(&room, "x", ["2 peaks", "1 peak"]);
    let table = room.table("run/bifurcations.csv");
    let stages: Vec<&str> = table
        .changes("xy")
        .into_iter()
        .map(|row| &row["after"])
        .collect();
    assert_eq!(stages, ["2 peaks", "1 peak"]);
    assert_all(&room, "method", "generator");
    // Work, not time: warm starts save factorisations (a cold one a point would be as many as rows).
    let points = room.table("run/points.csv");
    let total: f64 = points
        .0
        .iter()
        .map(|row| row.number("factorisations"))
        .sum();
    assert!(
        2.0 * total < points.0.len() as f64,
        "{total} factorisations"
    );
    // The run has the same arrays, tables and figures as the shipped one, of fewer values.
    let files = room.files("run", &[]).len();
    assert!(files <= 60, "{files} files");
}

#[test]
fn ranges_and_gradings_are_found() {
    let axis = "{ range = \"auto\", count = 40, grade = \"auto\" }";
    let mut file = SweepFile::read(&shipped("sweeps/coulomb_fc.toml")).unwrap();
    file.set("cells.x", axis).set("cells.y", axis);
    let settings = file.validate().unwrap();
    let sweep = settings.prepare(&Cancellation::new()).unwrap();
    for axis in &sweep.settings.axes {
        // At f_c = -0.02 the ring has radius 2.5 and noise around it: 5.5 holds all but 1e-5.
        let (from, to) = axis.range().unwrap();
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
    let room = Room::new();
    let settings = "cells.x.count=20 cells.y.count=20 sweep.points=2000 method.samples=160";
    let mut command = room.command(&format!(
        "sweep sweeps/coulomb_fc.toml --out run {settings}"
    ));
    let mut child = command
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
    let points = room.table("run/points.csv").0.len();
    assert!((2..2000).contains(&points));
    assert!(room.read("run/run.json").contains("\"interrupted\""));
}
