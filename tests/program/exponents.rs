//! The largest Lyapunov exponent of a fixed point from a sweep file to rows of tables; and points that are none.

use crate::common::numbers::assert_holds;
use crate::common::room::{Room, assert_says};

const OSCILLATOR: &str = r#"title = "exponents"
[system.equations]
x = "y"
y = "-x + b y - x^3 - x^2 y"
[system.noise]
y = "s x"
[system.parameters]
s = 0.5
[sweep]
parameter = "b"
from = -0.1
to = 0.1
points = 5
[cells]
x = { from = -2.0, to = 2.0, count = 40 }
y = { from = -3.0, to = 3.0, count = 40 }
[exponent]
kind = "fixed-point"
[locate]
grid_check = "off"
[figures]
formats = ["svg"]
draw = ["measures_exponent"]
"#;

#[test]
fn stability_that_comes_and_goes_between_two_values_has_two_rows() {
    let room = Room::new();
    // The exponent is a - 0.005 with a = 0.015 - (q - 0.25)²: above zero from 0.15 to 0.35, at no value of the sweep.
    let text = "[system.equations]\nx = \"(0.015 - (q-0.25)^2) x - x^3\"\n[system.noise]\nx = \"0.1 x\"\n\
                interpretation = \"ito\"\n[system.parameters]\nq = 0.0\n[sweep]\nparameter = \"q\"\nfrom = -1.0\n\
                to = 1.0\npoints = 5\n[cells]\nx = { from = -1, to = 1, count = 50 }\n\
                [exponent]\nkind = \"fixed-point\"\n";
    room.write("a.toml", text);
    room.run("sweep a.toml --out run");
    let table = room.table("run/bifurcations.csv");
    let rows = table.0.iter().filter(|row| row["label"].starts_with("DB"));
    let values: Vec<f64> = rows.map(|row| row.number("value")).collect();
    let exact = [0.15, 0.35];
    assert_eq!(values.len(), 2, "{values:?}");
    let off = values.iter().zip(exact).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-12, "{values:?}");
}

#[test]
fn the_state_of_rest_of_an_oscillator_loses_its_stability_where_the_closed_form_says() {
    let room = Room::new();
    room.write("a.toml", OSCILLATOR);
    assert_says(
        &room.done("check a.toml").out,
        &["kind = \"fixed-point\"", "x = 0.0", "rows `DB`"],
    );
    // No steady state below: exit status 1.
    let printed = room.run("sweep a.toml --out run");
    assert_says(
        &printed.text(),
        &["DB1", "D-bifurcation", "located", "point mass"],
    );
    let table = room.table("run/bifurcations.csv");
    let row = table.0.iter().find(|row| &row["label"] == "DB1").unwrap();
    let [value, error] = row.numbers(["value", "error"]);
    // The zero in b of the closed form with Airy functions.
    assert!(
        (value + 0.061_722_831_0).abs() < 6e-11 && error < 1e-12,
        "{value} ± {error}"
    );
    let texts = row.texts(["status", "before", "after", "observable"]);
    assert_eq!(texts, ["located", "< 0", "> 0", "exponent"]);
    let points = room.table("run/points.csv");
    for row in &points.0 {
        let [b, exponent, error] = row.numbers(["b", "exponent", "exponent_error"]);
        assert!(error < 1e-13);
        assert_eq!(exponent < 0.0, b < value);
        assert_eq!(&row["status"] == "no-steady-state", b < value);
        assert_eq!(row["findings"].starts_with("point-mass:"), b < value);
    }
    room.holds_all("run", "figures/measures_exponent.svg");
    // From the stored values, and from the complete file, the same rows follow.
    room.run("detect run");
    assert_eq!(room.table("run/bifurcations.csv"), table);
    room.write("b.toml", room.done("show run --sweep").out);
    room.run("sweep b.toml --out again");
    assert_eq!(room.table("again/bifurcations.csv"), table);
}

#[test]
#[rustfmt::skip]
fn the_d_bifurcation_of_rest_is_followed_in_two_parameters_and_the_crater_beside_it() {
    let room = Room::new();
    room.write("a.toml", OSCILLATOR);
    room.run("sweep a.toml --out run");
    let printed = room.done("curve run --row DB1 --second s --from 0.2 --to 1.0 --first-from -0.3");
    printed.says(&["D1  the largest exponent of the fixed point is zero", "P1  the density turns"]);
    let table = room.table("run/curves/DB1-s/stability.csv");
    let of = |name: &'static str| table.0.iter().filter(move |row| &row["curve"] == name);
    // The density beside rest goes like the power γ - 2, and γ passes 2 where b = 0, whatever the noise is.
    assert!(of("P1").count() > 50);
    for row in of("P1") {
        let [b, error] = row.numbers(["b", "error"]);
        assert!(b.abs() <= 0.4 * error && error < 1e-13, "{row:?}");
    }
    // Sweeps at other noise find the zeros that the curve passes: closed form with Airy functions.
    for (s, exact) in [(0.2, -0.009_996_510_0), (0.5, -0.061_722_831_0), (1.0, -0.222_527_174_3)] {
        let near = of("D1").map(|row| row.numbers(["b", "s"]));
        let mut near: Vec<[f64; 2]> = near.collect();
        near.sort_by(|one, other| (one[1] - s).abs().total_cmp(&(other[1] - s).abs()));
        let [a, b, c] = [near[0], near[1], near[2]];
        // The parabola through three points a step of 0.01 apart.
        let part = |[x, y]: [f64; 2], one: [f64; 2], other: [f64; 2]| {
            x * (s - one[1]) * (s - other[1]) / ((y - one[1]) * (y - other[1]))
        };
        let there = part(a, b, c) + part(b, a, c) + part(c, a, b);
        assert!((there - exact).abs() < 1e-6, "{there} {exact}");
    }
    let ends = of("D1").map(|row| row.numbers(["b", "s"]));
    let ends: Vec<[f64; 2]> = ends.collect();
    let ends = [ends[0], ends[ends.len() - 1]];
    for (s, exact) in [(0.2, -0.009_996_510_0), (1.0, -0.222_527_174_3)] {
        let end = ends.iter().find(|end| end[1] == s).unwrap();
        assert!((end[0] - exact).abs() < 6e-11, "{end:?}");
    }
    room.holds_all("run/curves/DB1-s", "curve.json plane.json figures/curve.svg");
    room.done("verify run");
    // Drawn again from what is stored; a row that is none is refused with those that are.
    let picture = room.read("run/curves/DB1-s/figures/curve.svg");
    room.done("plot run/curves/DB1-s");
    assert_eq!(room.read("run/curves/DB1-s/figures/curve.svg"), picture);
    let box_of_s = "--second s --from 0.2 --to 1.0";
    room.refused(&format!("curve run --row DB2 {box_of_s}"), &["no P- or D-bifurcation `DB2`", "`DB1`"]);
}

#[test]
fn a_map_shows_where_all_mass_ends_in_a_fixed_point_and_its_border() {
    let room = Room::new();
    let map = "[map]\nparameter = \"s\"\nfrom = 0.3\nto = 0.9\npoints = 3\ndepth = 1\n";
    let cells = OSCILLATOR.replace("count = 40", "count = 24");
    room.write(
        "a.toml",
        cells.replace("[locate]", &format!("{map}[locate]")),
    );
    let printed = room.run("sweep a.toml --out map sweep.points=3");
    assert_says(
        &printed.text(),
        &[
            "D1  the largest exponent",
            "all mass ends in the fixed point",
        ],
    );
    // On the side of smaller damping there are densities, on the other side none.
    let zero = room.table("map/stability.csv");
    let line: Vec<[f64; 2]> = zero
        .0
        .iter()
        .filter(|row| &row["curve"] == "D1")
        .map(|row| row.numbers(["b", "s"]))
        .collect();
    for row in &room.table("map/map.csv").0 {
        let [b, s] = row.numbers(["b", "s"]);
        let by_height = |one: &&[f64; 2], other: &&[f64; 2]| {
            (one[1] - s).abs().total_cmp(&(other[1] - s).abs())
        };
        let beside = line.iter().min_by(by_height).unwrap();
        if (beside[1] - s).abs() < 0.01 {
            assert_eq!(
                &row["status"] == "no-steady-state",
                b < beside[0],
                "{row:?}"
            );
        }
    }
    room.holds_all("map", "figures/map_xy.svg stability.csv");
}

/// Neighbouring paths in a double well with little damping run apart, and come together where it is larger.
const CHAOS: &str = r#"[system.equations]
x = "y"
y = "x - x^3 - g y"
[system.noise]
y = "sqrt(g)"
[system.parameters]
[sweep]
parameter = "g"
from = 0.3
to = 0.8
points = 5
[cells]
x = { from = -2.7, to = 2.7, count = 40 }
y = { from = -3.6, to = 3.6, count = 40 }
[exponent]
kind = "largest"
method = "trajectories"
steps = 3e6
[locate]
relative_tolerance = 0.1
grid_check = "off"
effort = 0
[figures]
draw = []
"#;

#[test]
fn trajectories_tell_exponents_where_modes_do_not() {
    let room = Room::new();
    room.write("a.toml", CHAOS);
    assert_says(
        &room.done("check a.toml").out,
        &["steps of trajectories", "method = \"trajectories\""],
    );
    room.run("sweep a.toml --out run");
    // 2000 pairs of paths by another program: exponent and one standard error (docs/exponents.md).
    let points = room.table("run/points.csv");
    for (g, known, of_known) in [(0.3, 0.0716, 1.1e-3), (0.8, -0.1149, 1.3e-3)] {
        let row = points.0.iter().find(|row| row.number("g") == g).unwrap();
        let [value, error] = row.numbers(["exponent", "exponent_error"]);
        let off = (value - known).abs();
        assert!(
            off <= error + 3.0 * of_known && error < 0.03,
            "{value} ± {error}"
        );
        // The sum of both exponents is minus the damping, at every state.
        let [divergence, error] = row.numbers(["divergence", "divergence_error"]);
        assert!((divergence + g).abs() <= error + 1e-12 && error < 1e-9);
    }
    let table = room.table("run/bifurcations.csv");
    let row = table.0.iter().find(|row| &row["label"] == "DB1").unwrap();
    // By a straight line through paths at 0.45 and 0.55: 0.503 ± 0.002.
    let [value, error] = row.numbers(["value", "error"]);
    assert!(
        (value - 0.503).abs() <= error + 0.006 && error < 0.1,
        "{value} ± {error}"
    );
    let tolerance = 0.1 * 0.5;
    assert_eq!(&row["status"] == "located", error <= tolerance, "{row:?}");
    // Another number of threads, the same numbers.
    room.run("sweep a.toml --out again --threads 1");
    assert_eq!(
        room.read("again/bifurcations.csv"),
        room.read("run/bifurcations.csv")
    );
    let printed = room.run("curve run --row DB1 --second g --from 0.3 --to 0.8");
    assert!(!printed.text().contains("panicked"));
}

#[test]
fn on_one_axis_the_exponent_is_exact_in_either_reading() {
    let file = r#"[system.equations]
x = "a x - x^2"
[system.noise]
x = "0.6 x"
interpretation = "ito"
[system.parameters]
[sweep]
parameter = "a"
from = -0.5
to = 1.0
points = 4
[cells]
x = { from = 0.0, to = 6.0, count = 60 }
[exponent]
kind = "fixed-point"
at = { x = 0 }
[figures]
draw = []
"#;
    let room = Room::new();
    // Growth a x - x² with fluctuating rate: λ = a - 0.6²/2 in Itô's reading, a in Stratonovich's.
    for (reading, zero) in [("ito", 0.18), ("stratonovich", 0.0)] {
        room.write("a.toml", file.replace("\"ito\"", &format!("\"{reading}\"")));
        room.run(&format!("sweep a.toml --out {reading}"));
        let table = room.table(&format!("{reading}/bifurcations.csv"));
        let row = table.0.iter().find(|row| &row["label"] == "DB1").unwrap();
        assert_holds(row.numbers(["value", "error"]), zero, 1e-14);
    }
}

#[test]
#[rustfmt::skip]
fn what_has_no_exponent_is_refused_with_its_place_and_a_remedy() {
    let room = Room::new();
    room.write("a.toml", OSCILLATOR);
    for (set, words) in [
        ("exponent.at.x=1", "x = 1, y = 0 is no fixed point at b = -0.1: along y the drift is -2"),
        ("exponent.at.z=0", "`z` is no coordinate of the state"),
        ("exponent.kind=all", "cannot be `all`"),
        ("exponent.method=trajectories", "`exponent.method` says nothing of this exponent"),
        ("exponent.steps=1e6", "`exponent.steps` says nothing of this exponent"),
        ("system.noise.y=0.1", "the amplitude of the noise 0.1"),
        ("system.equations.y=-x+b*y-sign(y)", "has no derivative at x = 0, y = 0"),
        ("system.noise.kind=ornstein-uhlenbeck system.parameters.tau=1", "white noise alone"),
    ] {
        room.refused(&format!("sweep a.toml {set}"), &[words]);
    }
    room.write(
        "b.toml",
        OSCILLATOR.replace("kind = \"fixed-point\"", "at = { x = 0 }"),
    );
    room.refused(
        "sweep b.toml",
        &["nothing is asked of it", "add `kind", "b.toml:18"],
    );
    let third = OSCILLATOR.replace("[system.noise]", "z = \"-z\"\n[system.noise]");
    let third = third.replace(
        "[exponent]",
        "z = { from = -1.0, to = 1.0, count = 4 }\n[exponent]",
    );
    room.write("c.toml", third);
    room.refused(
        "sweep c.toml",
        &["one axis and of two; this system has 3", "c.toml:"],
    );
}

/// Overdamped motion in two wells; the exponent is the mean of 1 - 3x², exactly.
const WELLS: &str = r#"[system.equations]
x = "a x - x^3"
[system.noise]
x = "0.7"
[system.parameters]
[sweep]
parameter = "a"
from = -1.0
to = 1.0
points = 5
[cells]
x = { from = -3.0, to = 3.0, count = 120 }
[exponent]
kind = "largest"
[levels]
exponent = -1.5
[figures]
draw = []
"#;

#[test]
fn along_the_density_of_one_axis_the_exponent_is_a_mean_and_a_level_like_any_other() {
    let room = Room::new();
    room.write("a.toml", WELLS);
    assert_says(
        &room.done("check a.toml").out,
        &["kind = \"largest\"", "along the stationary density"],
    );
    room.done("sweep a.toml --out run");
    for row in &room.table("run/points.csv").0 {
        let names = ["a", "exponent", "exponent_error", "divergence"];
        let [a, exponent, error, divergence] = row.numbers(names);
        let density = |x: f64| ((a * x * x - 0.5 * x.powi(4)) / 0.49).exp();
        let mean = |of: &dyn Fn(f64) -> f64| {
            let places = (-4000..=4000).map(|step| f64::from(step) * 1e-3);
            let sum = |of: &dyn Fn(f64) -> f64| -> f64 {
                places.clone().map(|x| of(x) * density(x)).sum()
            };
            sum(of) / sum(&|_| 1.0)
        };
        let exact = mean(&|x| a - 3.0 * x * x);
        assert!(
            (exponent - exact).abs() <= error + 1e-9,
            "{exponent} {exact}"
        );
        assert!(error < 1e-5, "{error}");
        // By parts it is -2 E[f²]/σ²: below zero whatever the wells are.
        let other = -2.0 / 0.49 * mean(&|x| (a * x - x.powi(3)).powi(2));
        assert!((exact - other).abs() < 1e-9);
        assert_eq!(exponent, divergence);
    }
    let table = room.table("run/bifurcations.csv");
    let is_level = |label: &str| label.starts_with("LV");
    assert!(table.0.iter().any(|row| is_level(&row["label"])));
    assert!(table.0.iter().all(|row| !row["label"].starts_with("DB")));
}

#[test]
fn along_a_density_linear_equations_are_exact_and_their_box_and_cells_do_not_matter() {
    let room = Room::new();
    let file = OSCILLATOR.replace("fixed-point", "largest");
    let file = file.replace("-x + b y - x^3 - x^2 y", "-x - b y");
    let file = file.replace("measures_exponent", "measures_divergence");
    let file = file.replace("s x", "s").replace("-0.1", "0.5");
    room.write("a.toml", file.replace("to = 0.1", "to = 4.5"));
    // So few cells leave a density with a negative part, of which exponents take no notice.
    room.solved("sweep a.toml --out run cells.y.count=24 cells.x.count=24")
        .says(&["this proves little"]);
    for row in &room.table("run/points.csv").0 {
        let [b, exponent, divergence] = row.numbers(["b", "exponent", "divergence"]);
        // The eigenvalues of x'' + b x' + x = 0, and their sum.
        let beyond = (0.25 * b * b - 1.0).max(0.0).sqrt();
        assert!((exponent - (beyond - 0.5 * b)).abs() < 1e-13);
        assert!((divergence + b).abs() < 1e-11);
    }
}

#[test]
#[rustfmt::skip]
fn what_has_no_exponent_along_its_density_is_refused_with_a_remedy() {
    let room = Room::new();
    let file = OSCILLATOR.replace("fixed-point", "largest");
    room.write("a.toml", file.replace("s x", "s"));
    for (set, words) in [
        ("system.equations.y=-x+b*y-x^3-sign(y)", "is not smooth everywhere"),
        ("exponent.at.x=0", "names a fixed point"),
        ("method.kind=monte-carlo", "by the generator alone"),
        ("exponent.method=trajectories system.equations.y=-x+b*y-sign(y)", "is not smooth everywhere"),
        ("exponent.method=trajectories system.bounds.y=reflecting", "without reflecting walls"),
        ("system.noise.kind=ornstein-uhlenbeck system.parameters.tau=1", "formulas with white noise"),
        ("system.equations.y=-x-y+cos(b*t)", "without forcing"),
    ] {
        room.refused(&format!("sweep a.toml {set}"), &[words, "a.toml:"]);
    }
}
