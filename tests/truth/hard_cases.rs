//! Sweeps that were once wrong, or are hard: the files of `tests/truth/hard_cases/` go through the program as a user
//! would type them, and what it finds is compared with what is known exactly. The whole table of docs/location.md is
//! printed by
//!
//!     cargo test --release --test truth hard_cases:: -- --ignored --nocapture
//!
//! Quick ones are run always.

use std::path::PathBuf;
use std::process::Command;

/// A sweep file, what is set on top of it, and where its densities change.
struct Case {
    file: &'static str,
    set: &'static [&'static str],
    words: &'static str,
    /// Observable and value of each change.
    truths: &'static [(&'static str, f64)],
    expected: Expected,
}

/// What must come of a case.
enum Expected {
    /// Every change is located within 1e-4 of the range, and nothing else.
    Located,
    /// So many rows are located, and these hold truths; each of the others holds one or names the cure by these words.
    Some(usize, &'static str),
}
use Expected::{Located, Some as Partly};

/// Fold of h + x - x³.
const FOLD: f64 = 0.384_900_179_459_750_5;

const CASES: &[Case] = &[
    Case {
        file: "ring",
        set: &[],
        words: "a bottom becomes a peak inside a ring, which ends later",
        truths: &[("xy", 0.0), ("xy", 0.25)],
        expected: Located,
    },
    Case {
        file: "two_wells",
        set: &[],
        words: "`rayleigh` with α = -1: peaks open to rings, which merge",
        truths: &[("xy", -0.025), ("xy", 0.0)],
        expected: Partly(1, "more cells"),
    },
    Case {
        file: "coulomb_ranges",
        set: &[],
        words: "`coulomb` without friction, both ranges `auto`",
        truths: &[("x", 0.0), ("xy", 0.0)],
        expected: Located,
    },
    Case {
        file: "narrow_range",
        set: &[],
        words: "the same, a range that is too narrow",
        truths: &[("x", 0.0), ("xy", 0.0)],
        expected: Partly(0, "a wider range of y"),
    },
    Case {
        file: "two_folds",
        set: &[],
        words: "three peaks become one by two folds inside one step",
        truths: &[
            ("x", -0.507_233_543_5),
            ("x", -0.497_240_265_5),
            ("x", 0.497_240_265_5),
            ("x", 0.507_233_543_5),
        ],
        expected: Located,
    },
    Case {
        file: "deep_wells",
        set: &[],
        words: "`bistable`, σ² = 0.01",
        truths: &[("x", 0.0)],
        expected: Located,
    },
    Case {
        file: "tilted",
        set: &["system.noise.x=\"sqrt(0.03)\"", "cells.x.count=200"],
        words: "a tilted well, σ² = 0.03, 200 cells",
        truths: &[("x", -FOLD), ("x", FOLD)],
        expected: Located,
    },
    Case {
        file: "tilted",
        set: &["system.noise.x=\"sqrt(0.05)\"", "cells.x.count=400"],
        words: "the same, σ² = 0.05, 400 cells",
        truths: &[("x", -FOLD), ("x", FOLD)],
        expected: Located,
    },
    Case {
        file: "tilted",
        set: &["sweep.from=0.30"],
        words: "the same, σ² = 0.25, h from 0.30",
        truths: &[("x", FOLD)],
        expected: Located,
    },
    Case {
        file: "tilted",
        set: &["sweep.from=0.33"],
        words: "the same, h from 0.33",
        truths: &[("x", FOLD)],
        expected: Located,
    },
    Case {
        file: "undeclared_1d",
        set: &[],
        words: "a symmetry that nobody declares, one axis",
        truths: &[("x", 0.0)],
        expected: Located,
    },
    Case {
        file: "undeclared_2d",
        set: &[],
        words: "the same of an oscillator",
        truths: &[("xy", 0.5)],
        expected: Located,
    },
    Case {
        file: "undeclared_kink",
        set: &[],
        words: "the same at a kink",
        truths: &[("x", 0.0)],
        expected: Located,
    },
    Case {
        file: "tilted_bistable",
        set: &[],
        words: "no symmetry, h = 0.05",
        truths: &[("x", 0.256_496_392_002_251_1)],
        expected: Located,
    },
    Case {
        file: "tilted_bistable",
        set: &["system.equations.x=\"0.001 + a x - x^3\""],
        words: "nearly symmetric, h = 0.001",
        truths: &[("x", 0.018_898_815_748_423_1)],
        expected: Located,
    },
    Case {
        file: "tilted_oscillator",
        set: &[],
        words: "an oscillator in a tilted well, joint density",
        truths: &[("xy", -FOLD), ("xy", FOLD)],
        expected: Located,
    },
    Case {
        file: "undeclared_1d",
        set: &[
            "system.equations.x=\"1e-3 a x - x^3\"",
            "sweep.from=-1e3",
            "sweep.to=1e3",
            "sweep.points=40",
        ],
        words: "a parameter in units of 10³",
        truths: &[("x", 0.0)],
        expected: Located,
    },
    Case {
        file: "undeclared_1d",
        set: &[
            "system.equations.x=\"1e-9 a x - x^3\"",
            "sweep.from=-1e9",
            "sweep.to=1e9",
            "sweep.points=40",
        ],
        words: "a parameter in units of 10⁹",
        truths: &[("x", 0.0)],
        expected: Located,
    },
    Case {
        file: "sgcm",
        set: &[],
        words: "SGCM, noise between two walls",
        truths: &[("x", 2.0)],
        expected: Partly(0, "needed"),
    },
];

/// A row of bifurcations.csv.
struct Row {
    observable: String,
    value: f64,
    error: f64,
    lower: f64,
    upper: f64,
    status: String,
    reason: String,
}

/// Fields of a line of comma-separated values.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            letter => fields.last_mut().unwrap().push(letter),
        }
    }
    fields
}

fn run(case: &Case, folder: &str) -> Vec<Row> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let file = root
        .join("tests/truth/hard_cases")
        .join(case.file)
        .with_extension("toml");
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    command.arg("sweep").arg(file).arg("--out").arg(&out);
    command.args(["--quiet", "--set", "figures.draw=[]"]);
    for set in case.set {
        command.args(["--set", set]);
    }
    let done = command.output().unwrap();
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(matches!(done.status.code(), Some(0 | 1)), "{errors}");
    let table = std::fs::read_to_string(out.join("bifurcations.csv")).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    let mut lines = table.lines().map(fields);
    let header = lines.next().unwrap();
    let at = |name: &str| header.iter().position(|one| one == name).unwrap();
    let row = |line: Vec<String>| {
        let number = |name: &str| line[at(name)].parse::<f64>().unwrap_or(f64::NAN);
        Row {
            observable: line[at("observable")].clone(),
            value: number("value"),
            error: number("error"),
            lower: number("lower"),
            upper: number("upper"),
            status: line[at("status")].clone(),
            reason: line[at("reason")].clone(),
        }
    };
    let is_change = |line: &Vec<String>| line[at("label")].starts_with("PB");
    lines.filter(is_change).map(row).collect()
}

/// The lines of the table for a case, and what is wrong with it.
fn judged(case: &Case, rows: &[Row]) -> (String, Option<String>) {
    let mut text = String::new();
    let mut taken = vec![false; case.truths.len()];
    let mut wrong = None;
    let mut located = 0;
    let said = |row: &Row| match row.reason.as_str() {
        "" => row.status.clone(),
        reason => format!("{}: {reason}", row.status),
    };
    for row in rows {
        let is_located = row.status == "located";
        located += usize::from(is_located);
        let held = case
            .truths
            .iter()
            .enumerate()
            .position(|(index, (observable, truth))| {
                let low = row.lower.min(row.value - row.error);
                let high = row.upper.max(row.value + row.error);
                let holds = match is_located {
                    true => (row.value - truth).abs() <= row.error,
                    false => low <= *truth && *truth <= high,
                };
                !taken[index] && *observable == row.observable && holds
            });
        let truth = held.map_or("none".to_owned(), |index| {
            taken[index] = true;
            format!("{:.6}", case.truths[index].1)
        });
        let is_cured = match case.expected {
            Partly(_, cure) => row.reason.contains(cure),
            Located => false,
        };
        if held.is_none() && (is_located || !is_cured) {
            wrong = Some(format!("{} = {} holds no truth", row.observable, row.value));
        }
        text.push_str(&format!(
            "| {} | {} | {truth} | {:.7} ± {:.1e} | {} |\n",
            case.words,
            row.observable,
            row.value,
            row.error,
            said(row)
        ));
    }
    let wanted = match case.expected {
        Located => case.truths.len(),
        Partly(number, _) => number,
    };
    let missed = taken.iter().filter(|taken| !**taken).count();
    if located != wanted || (missed > 0 && matches!(case.expected, Located)) {
        wrong.get_or_insert(format!(
            "{located} rows located, {missed} changes in no row"
        ));
    }
    (text, wrong)
}

fn all(cases: &[Case], folder: &str) {
    println!("| sweep | density | truth | found | status |\n| --- | --- | --- | --- | --- |");
    let mut wrong = Vec::new();
    for case in cases {
        let rows = run(case, folder);
        let (text, fault) = judged(case, &rows);
        print!("{text}");
        wrong.extend(fault.map(|fault| format!("{}: {fault}", case.words)));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn quick_cases_on_one_axis_are_located() {
    let is_quick = |case: &&Case| {
        let files = ["deep_wells", "tilted", "two_folds", "undeclared_kink"];
        files.contains(&case.file)
    };
    let first = CASES.iter().filter(is_quick).take(3);
    for case in first {
        let (text, wrong) = judged(case, &run(case, "hard_cases_quick"));
        assert!(wrong.is_none(), "{wrong:?}\n{text}");
    }
}

#[test]
#[ignore = "prints the table of docs/location.md"]
fn all_of_them() {
    all(CASES, "hard_cases");
}
