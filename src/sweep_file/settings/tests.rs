//! Settings from a text: defaults, angles, conditions between keys.

mod one_side;
mod questions;
mod resolved;
mod states;

use super::*;
use crate::cancellation::Cancellation;
use crate::continuation::evenly_spaced;
use crate::sweep_file::SweepFile;

const FILE: &str = r#"
[system]
model = "coulomb"
parameters = { kappa = 0.01, sigma2 = 0.01 }
[sweep]
parameter = "f_c"
from = -0.02
to = 0.01
points = 31
[cells]
x = { from = -5, to = 5, count = 20 }
y = { from = -5, to = 5, count = 20, grade = { at = [0], smallest = 0.1 } }
"#;

const DAHL: &str = r#"
[system]
model = "dahl"
parameters = { kappa = 0.02, mu = 1, lambda = 0.06, f_c = 0.05, sigma2 = 0.02 }
[sweep]
parameter = "alpha"
from = 0.5
to = -1
points = 3
[cells]
x = { from = -2.5, to = 2.5, count = 12 }
y = { from = -2.5, to = 2.5, count = 12 }
"#;

/// Dahl's oscillator under coloured noise.
const COLOURED: [&str; 2] = [
    "system.noise.kind=ornstein-uhlenbeck",
    "system.parameters.tau=0.5",
];

const EQUATIONS: &str = r#"
[system]
title = "by hand"
[system.equations]
y = "-kappa force"
[system.noise]
y = "sqrt(2 D) y"
interpretation = "ito"
[system.define]
force = "y + y^3"
[system.bounds]
y = ["-9", 9]
[system.parameters]
kappa = 1
[sweep]
parameter = "D"
from = 0.1
to = 0.2
points = 3
[cells]
y = { count = 10 }
"#;

/// A phase-locked loop, its angle in turns.
const ANGLE: &str = r#"
[system.equations]
phi = "w - sin(2 pi phi)"
[system.noise]
phi = "0.5"
[system.bounds]
phi = { period = 1.0 }
[sweep]
parameter = "w"
from = 0
to = 1
points = 3
"#;

#[test]
fn even_phases_are_watched_together() {
    let text = ANGLE.replace("w - sin(2 pi phi)", "-phi + w cos(t)");
    let text = text.replace("phi = { period = 1.0 }", "");
    let spec = parse(&text, &["detect.marginals=[\"phi @ 4 phases\", \"phi\"]"]).unwrap();
    let names: Vec<&str> = spec.family.averages().collect();
    let phases = [
        "phi_phase_0",
        "phi_phase_1_4",
        "phi_phase_1_2",
        "phi_phase_3_4",
    ];
    assert_eq!(names, [&["phi"][..], &phases].concat());
    assert_eq!(spec.observables.len(), 5);
    let refused = parse(&text, &["detect.marginals=[\"phi @ 65 phases\"]"]);
    let words = refused.map(drop).unwrap_err().to_string();
    assert!(words.contains("up to 64"), "{words}");
}

#[test]
fn what_closes_on_itself_is_an_angle_of_harmonics() {
    let read = |sets: &[&str]| parse(ANGLE, sets);
    let spec = read(&[]).unwrap();
    assert_eq!(spec.axes[0].range(), Some((-0.5, 0.5)));
    assert_eq!(spec.axes[0].series, ModesOf::Turn);
    assert_eq!(spec.observables, [crate::density::Observable::Marginal(0)]);
    let names: Vec<&str> = spec.family.averages().collect();
    assert!(names.is_empty(), "{names:?}");
    let again = parse(&spec.to_toml(), &[]).unwrap();
    assert_eq!(again.axes, spec.axes);
    // Trajectories go round, and are counted in bins of a turn whose number is not asked for.
    let counted = read(&["method.kind=monte-carlo"]).unwrap();
    assert!(!counted.axes[0].is_cut(counted.method.kind) && counted.axes[0].count.is_none());
    let again = parse(&counted.to_toml(), &[]).unwrap();
    assert_eq!(again.axes, counted.axes);
    // A cell map has as many cells there.
    let mapped = read(&["method.kind=sgcm"]).unwrap();
    let axis = mapped.axes[0].axis(mapped.method.kind).unwrap().unwrap();
    assert!(axis.is_closed() && axis.count() == crate::density::BINS_OF_A_TURN);
    // In radians it is a word.
    let text = ANGLE.replace("{ period = 1.0 }", "\"periodic\"");
    let radians = text.replace("2 pi phi", "phi");
    let spec = parse(&radians, &[]).unwrap();
    let pi = std::f64::consts::PI;
    assert_eq!(spec.axes[0].range(), Some((-pi, pi)));
    assert!(spec.to_toml().contains("phi = \"periodic\""));
    let other = |word: &str, by: &str| radians.replace(word, by);
    #[rustfmt::skip]
    let cases: [(String, &[&str], &[&str]); 8] = [
        (text.clone(), &[], &["does not have the period", "it has"]),
        (other("sin(phi)", "phi"), &[], &["write sin(phi) or cos(phi)"]),
        (other("sin(phi)", "sgn(sin(phi))"), &[], &["jumps or bends"]),
        (ANGLE.to_owned(), &["cells.phi.count=40"], &["harmonics carry it, not cells"]),
        (ANGLE.to_owned(), &["cells.phi.from=-3", "cells.phi.to=3"], &["its range is one turn"]),
        (other("phi = \"periodic\"", "psi = \"periodic\""), &[], &["psi"]),
        (other("\"periodic\"", "\"cyclic\""), &[], &["`\"periodic\"`"]),
        (ANGLE.to_owned(), &["system.bounds.phi.period=0"], &["greater than zero"]),
    ];
    for (text, sets, words) in cases {
        let refusal = parse(&text, sets).unwrap_err().to_string();
        assert!(
            words.iter().all(|words| refusal.contains(words)),
            "{words:?} not in\n{refusal}"
        );
    }
}

fn parse(text: &str, overrides: &[&str]) -> Result<Settings, Report> {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    SweepFile::parse("runs/a.toml", text)
        .set_all("--set", &overrides)
        .validate()
}

fn refusal(overrides: &[&str]) -> String {
    parse(FILE, overrides).unwrap_err().to_string()
}

#[test]
fn defaults_are_those_of_the_options() {
    let spec = parse(FILE, &[]).unwrap();
    assert_eq!(
        spec.title,
        "Duffing oscillator with Coulomb friction, sweep of f_c"
    );
    let swept = FILE
        .replace("sigma2 = 0.01", "f_c = 0")
        .replace("\"f_c\"", "\"sigma2\"");
    let of_noise = parse(&swept.replace("-0.02", "0.001"), &[]).unwrap();
    assert!(
        of_noise.title.ends_with("sweep of σ²"),
        "{}",
        of_noise.title
    );
    assert_eq!(spec.method, MethodSettings::default());
    assert_eq!(spec.detect, DetectOptions::default());
    assert_eq!(spec.locate, LocateOptions::default());
    let (x, y, xy) = (
        Observable::Marginal(0),
        Observable::Marginal(1),
        Observable::Joint(0, 1),
    );
    assert_eq!(spec.observables, [x, y, xy]);
    // alpha and mu by the model's default, the swept f_c at `from`.
    let values = spec.family.values_at(spec.family.ends().0).unwrap();
    assert_eq!(values.as_slice(), [1.0, 0.01, 0.0, -0.02, 0.01]);
    assert!(spec.warnings.is_empty());
    assert_eq!(spec.figures.at, [-0.02, -0.01, 0.0, 0.01]);
    let sweep = spec.fixed().unwrap();
    assert!(sweep.problem.space().axes()[1].has_face_at(0.0));
}

#[test]
fn few_cells_and_idle_gradings_are_told() {
    let said = |overrides: &[&str]| {
        let settings = SweepFile::parse("dahl.toml", DAHL)
            .set_all("--set", overrides)
            .validate();
        settings.unwrap().warnings.to_string()
    };
    for (count, few) in [(2, true), (3, true), (4, false)] {
        let words = said(&[&format!("cells.x.count={count}")]);
        let expected = format!("warning: {count} cells along `x` show no shape");
        assert_eq!(words.contains(&expected), few, "{words}");
    }
    let idle = "warning: the grading of `z` has no effect";
    assert!(said(&["cells.z={ modes = 4, grade = \"auto\" }"]).contains(idle));
    assert!(said(&["cells.z={ grade = \"auto\" }"]).contains(idle));
    // Other methods use count and grading, and modes then do nothing.
    assert!(!said(&["cells.z={ modes = 4, count = 16, grade = \"auto\" }"]).contains(idle));
    assert!(!said(&["cells.z={ count = 3, modes = 4 }"]).contains("show no shape"));
}

#[test]
fn values_are_even_and_hit_zero() {
    let spec = parse(FILE, &[]).unwrap();
    let values = evenly_spaced(spec.family.ends(), spec.points);
    assert_eq!(
        (values.len(), values[0], values[20], values[30]),
        (31, -0.02, 0.0, 0.01)
    );
    assert!(
        values
            .windows(2)
            .all(|pair| (pair[1] - pair[0] - 1e-3).abs() < 1e-17)
    );
}

#[test]
fn conditions_between_keys_hold() {
    for (set, words) in [
        ("sweep.to=-0.02", "the sweep goes from -0.02 to -0.02"),
        ("sweep.to=-0.02000000000000001", "no 31 different numbers"),
        ("sweep.to=1e308", "no 31 different numbers"),
        ("method.samples=4", "8 replicates"),
        ("figures.at=[0.0, 0.02]", "numbers from -0.02 to 0.01"),
        ("detect.joint=[[\"x\", \"x\"]]", "one axis with itself"),
        (
            "detect.joint=[[\"x\", \"y\"], [\"y\", \"x\"]]",
            "listed twice",
        ),
        ("detect.marginals=[\"x\", \"v\"]", "no axis `v`"),
        ("cells.y.grade.smallest=2", "smallest cell 2"),
        ("cells.y.grade.at=[0, 7]", "graded toward 7"),
        (
            "cells.y.grade={at=[0]}",
            "missing key `cells.y.grade.smallest`",
        ),
        ("cells.x.from=1e400", "this is a number"),
    ] {
        let text = refusal(&[set]);
        assert!(text.contains(words), "{set}: {words} not in\n{text}");
        assert!(text.ends_with("1 error"), "{set}:\n{text}");
    }
    let text = refusal(&["method.time_step=2", "method.map_step=1"]);
    assert!(text.contains("time step 2 is longer"), "{text}");
    let text = refusal(&["detect.marginals=[]", "detect.joint=[]"]);
    assert!(text.contains("nothing is watched"), "{text}");
}

#[test]
fn figures_of_the_file_outside_a_sweep_that_was_set_are_left_out() {
    let text = format!("{FILE}[figures]\nat = [-0.02, -0.01, 0.0, 0.01]\n");
    let settings = parse(&text, &["sweep.from=-0.005"]).unwrap();
    assert_eq!(settings.figures.at, [0.0, 0.01]);
    let said = settings.warnings.to_string();
    for words in [
        "warning",
        "`-0.02`, `-0.01`",
        "from -0.005 to 0.01",
        "a.toml:14:7",
    ] {
        assert!(said.contains(words), "{words} not in\n{said}");
    }
    // Nothing is left: the default holds.
    let settings = parse(&text, &["sweep.from=1", "sweep.to=2"]).unwrap();
    assert_eq!(settings.figures.at.len(), 4);
    assert!(settings.warnings.to_string().contains("drawn instead"));
    // What was set in the same breath, and what the file says of itself, is refused.
    let both = ["sweep.from=-0.005", "figures.at=[-0.01]"];
    let said = parse(&text, &both).unwrap_err().to_string();
    assert!(said.contains("has -0.01, outside the sweep"), "{said}");
    let said = parse(&text, &["figures.at=[7]"]).unwrap_err().to_string();
    assert!(said.contains("has 7, outside the sweep"), "{said}");
    let outside = text.replace("0.0, 0.01]", "0.0, 0.02]");
    assert!(parse(&outside, &[]).is_err());
    assert!(parse(&outside, &["sweep.points=7"]).is_err());
}

#[test]
fn one_end_of_a_range_may_be_given_alone() {
    let file = FILE.split("[cells]").next().unwrap_or_default();
    let settings = parse(file, &["cells.x={from=-3}", "cells.y={to=5, count=20}"]).unwrap();
    let ends: Vec<[Option<f64>; 2]> = settings.axes.iter().map(|axis| axis.ends).collect();
    assert_eq!(ends, [[Some(-3.0), None], [None, Some(5.0)]]);
    let text = settings.to_toml();
    assert_eq!(parse(&text, &[]).unwrap().axes, settings.axes, "{text}");
    let range = |axis: usize| -> (f64, f64) {
        let prepared = settings.clone().prepare(&Cancellation::new()).unwrap();
        prepared.settings.axes[axis].range().unwrap()
    };
    assert!(range(0).0 == -3.0 && range(0).1 > 2.0, "{:?}", range(0));
    assert!(range(1).1 == 5.0 && range(1).0 < -2.0, "{:?}", range(1));
}

#[test]
fn a_key_in_the_table_of_another_is_shown_its_own() {
    let report = parse(FILE, &["system.bounds.x={from=0}"])
        .unwrap_err()
        .to_string();
    assert!(report.contains("did you mean `cells.x.from`?"), "{report}");
}

#[test]
fn what_is_left_to_the_program_stays_open_and_is_written_so() {
    let open = ["cells.x={range=auto, count=20}", "cells.y.grade=auto"];
    // Inside a table a word needs its quotation marks.
    let open = [open[0].replace("auto", "\"auto\""), open[1].to_owned()];
    let open: Vec<&str> = open.iter().map(String::as_str).collect();
    let settings = parse(FILE, &open).unwrap();
    assert_eq!(settings.axes[0].range(), None);
    assert_eq!(settings.axes[1].grade, Grade::Auto);
    let text = settings.to_toml();
    assert!(
        text.contains("x = { range = \"auto\", count = 20 }\n"),
        "{text}"
    );
    assert_eq!(parse(&text, &[]).unwrap().axes, settings.axes);
    let said = settings.clone().fixed().unwrap_err().to_string();
    assert!(said.contains("axis `x` is left to the program"), "{said}");
    let sweep = settings.prepare(&Cancellation::new()).unwrap();
    assert!(
        sweep
            .settings
            .axes
            .iter()
            .all(|axis| axis.range().is_some())
    );
    assert!(matches!(sweep.settings.axes[1].grade, Grade::Toward(_)));
    let again = parse(&sweep.to_toml(), &[]).unwrap().fixed().unwrap();
    assert_eq!(again.problem.space(), sweep.problem.space());
}
