//! Sweeps that were once wrong, or are hard: the files of `tests/truth/hard_cases/` go through the program as a user
//! would type them, and what it finds is compared with what is known exactly. The whole table of docs/location.md is
//! printed by
//!
//!     cargo test --release --test truth hard_cases:: -- --ignored --nocapture
//!
//! Quick ones are run always.

use crate::common::room::{Room, shipped};
use crate::common::table::Row;

/// A sweep file, what is set on top of it, and where its densities change.
struct Case {
    file: &'static str,
    set: &'static str,
    words: &'static str,
    /// Observable and value of each change.
    truths: &'static [(&'static str, f64)],
    expected: Expected,
}

const fn case(
    file: &'static str,
    set: &'static str,
    words: &'static str,
    truths: &'static [(&'static str, f64)],
    expected: Expected,
) -> Case {
    Case {
        file,
        set,
        words,
        truths,
        expected,
    }
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

#[rustfmt::skip]
const CASES: &[Case] = &[
    case("ring", "", "a bottom becomes a peak inside a ring, which ends later", &[("xy", 0.0), ("xy", 0.25)],
        Located),
    case("two_wells", "", "`rayleigh` with α = -1: peaks open to rings, which merge", &[("xy", -0.025), ("xy", 0.0)],
        Partly(1, "more cells")),
    case("coulomb_ranges", "", "`coulomb` without friction, both ranges `auto`", &[("x", 0.0), ("xy", 0.0)], Located),
    case("narrow_range", "", "the same, a range that is too narrow", &[("x", 0.0), ("xy", 0.0)],
        Partly(0, "a wider range of y")),
    case("three_wells", "", "a peak is born and a crater opens inside one step, next to each other",
        &[("xy", 0.054_679), ("xy", 0.119_539), ("xy", 0.229_788)], Located),
    case("two_folds", "", "three peaks become one by two folds inside one step",
        &[("x", -0.507_233_543_5), ("x", -0.497_240_265_5), ("x", 0.497_240_265_5), ("x", 0.507_233_543_5)], Located),
    case("corner_beside_fold", "", "a pair born 4e-5 before its valley passes a corner of the noise",
        &[("x", -0.469_053_889_264_059), ("x", 0.225_807_889_264_059)], Located),
    case("deep_wells", "", "`bistable`, σ² = 0.01", &[("x", 0.0)], Located),
    case("tilted", "system.noise.x=\"sqrt(0.03)\" cells.x.count=200", "a tilted well, σ² = 0.03, 200 cells",
        &[("x", -FOLD), ("x", FOLD)], Located),
    case("tilted", "system.noise.x=\"0.01\" sweep.from=-0.6 sweep.to=0.6 cells.x.count=100",
        "the same, σ² = 1e-4, whose second peak is too low for a number, 100 cells", &[("x", -FOLD), ("x", FOLD)],
        Located),
    case("tilted", "system.noise.x=\"sqrt(0.05)\" cells.x.count=400", "the same, σ² = 0.05, 400 cells",
        &[("x", -FOLD), ("x", FOLD)], Located),
    case("tilted", "sweep.from=0.30", "the same, σ² = 0.25, h from 0.30", &[("x", FOLD)], Located),
    case("tilted", "sweep.from=0.33", "the same, h from 0.33", &[("x", FOLD)], Located),
    case("undeclared_1d", "", "a symmetry that nobody declares, one axis", &[("x", 0.0)], Located),
    case("undeclared_2d", "", "the same of an oscillator", &[("xy", 0.5)], Located),
    case("undeclared_kink", "", "the same at a kink", &[("x", 0.0)], Located),
    case("tilted_bistable", "", "no symmetry, h = 0.05", &[("x", 0.256_496_392_002_251_1)], Located),
    case("tilted_bistable", "'system.equations.x=\"0.001 + a x - x^3\"'", "nearly symmetric, h = 0.001",
        &[("x", 0.018_898_815_748_423_1)], Located),
    case("tilted_oscillator", "", "an oscillator in a tilted well, joint density", &[("xy", -FOLD), ("xy", FOLD)],
        Located),
    case("undeclared_1d", "'system.equations.x=\"1e-3 a x - x^3\"' sweep.from=-1e3 sweep.to=1e3 sweep.points=40",
        "a parameter in units of 10³", &[("x", 0.0)], Located),
    case("undeclared_1d", "'system.equations.x=\"1e-9 a x - x^3\"' sweep.from=-1e9 sweep.to=1e9 sweep.points=40",
        "a parameter in units of 10⁹", &[("x", 0.0)], Located),
    case("sgcm", "", "SGCM, noise between two walls", &[("x", 2.0)], Partly(0, "needed")),
    case("sine", "", "births in tails that 80 cells an axis do not resolve",
        &[("x", -0.065_336_9), ("x", 0.123_170_6)], Partly(0, "more cells")),
    case("circulation", "", "the same of a drift that circulates, 50 cells an axis",
        &[("x", -0.089_664_6), ("x", 0.208_679_0)], Located),
    case("faint_centre", "", "a peak within a ring, of 6e-8 of its height, σ² = 0.02", &[("xy", 0.0), ("xy", 0.25)],
        Located),
    case("resting", "", "a crater that opens at a fixed point under noise in the stiffness, 80 cells", &[("xy", 0.0)],
        Partly(0, "zero there at 0")),
    case("coupled", "", "two bistable units, whose peaks out of phase become saddles",
        &[("x1_x2", 1.0 / 3.0), ("x1_x2", 0.5)], Located),
    // Between ends at ± 9 and ± 15, where nothing leaves: 2.392497 and 2.392494 with 160 × 240 and 240 × 360 cells.
    case("van_der_pol", "", "van der Pol's oscillator, whose crater closes where mass leaves the range",
        &[("y", 0.839_64), ("xy", 2.392_495)], Partly(1, "a wider range of y")),
    case("epidemic", "", "an epidemic, whose peak reaches the end at which the noise dies",
        &[("I", 0.022_360_679_775)], Located),
    // c³ + 0.3 c - 0.287 c |c| with the corner c = 0.177, at which the slope on one side is level.
    case("power_tails", "locate.effort=0", "tails like powers, 41 × 45 cells: two grids agree by chance",
        &[("y", -0.312_38)], Partly(0, "more cells")),
    case("power_tails", "", "the same with closer looks", &[("y", -0.312_38)], Located),
    case("bent_force", "", "a peak that vanishes at a corner of the force, 80 × 60 cells, to 5e-3 of the range",
        &[("xy", 0.049_653_810)], Located),
    case("bent_force", "locate.relative_tolerance=1e-3", "the same, to 1e-3 of it", &[("xy", 0.049_653_810)], Located),
    case("mirrored_splits", "", "both of two mirrored peaks split at once, 44 × 38 cells",
        &[("x", 0.0), ("xy", 0.0)], Partly(0, "a wider range of y")),
    case("dimentberg", "", "Dimentberg's oscillator, ranges found",
        &[("x", -0.453_634_0), ("y", -0.453_634_0), ("xy", -0.125)], Located),
];

/// The changes that a case finds.
fn run(case: &Case) -> Vec<Row> {
    let room = Room::new();
    let Case { file, set, .. } = case;
    let file = shipped(&format!("tests/truth/hard_cases/{file}.toml"));
    room.write("case.toml", std::fs::read(file).unwrap());
    room.solved(&format!(
        "sweep case.toml --out run --quiet figures.draw=[] {set}"
    ));
    let mut rows = room.table("run/bifurcations.csv").0;
    rows.retain(|row| row["label"].starts_with("PB"));
    rows
}

/// The lines of the table for a case, and what is wrong with it.
fn judged(case: &Case, rows: &[Row]) -> (String, Option<String>) {
    let mut text = String::new();
    let mut taken = vec![false; case.truths.len()];
    let mut wrong = None;
    let mut located = 0;
    let said = |row: &Row| match row.texts(["status", "reason"]) {
        [status, ""] => status.to_owned(),
        [status, reason] => format!("{status}: {reason}"),
    };
    for row in rows {
        let is_located = &row["status"] == "located";
        let number = |column: &str| row[column].parse::<f64>().unwrap_or(f64::NAN);
        let [value, error, lower, upper] = ["value", "error", "lower", "upper"].map(number);
        located += usize::from(is_located);
        let held = case
            .truths
            .iter()
            .enumerate()
            .position(|(index, (observable, truth))| {
                let (low, high) = (lower.min(value - error), upper.max(value + error));
                let holds = match is_located {
                    true => (value - truth).abs() <= error,
                    false => low <= *truth && *truth <= high,
                };
                !taken[index] && *observable == &row["observable"] && holds
            });
        let truth = held.map_or("none".to_owned(), |index| {
            taken[index] = true;
            format!("{:.6}", case.truths[index].1)
        });
        let is_cured = match case.expected {
            Partly(_, cure) => row["reason"].contains(cure),
            Located => false,
        };
        if held.is_none() && (is_located || !is_cured) {
            wrong = Some(format!("{} = {value} holds no truth", &row["observable"]));
        }
        let observable = &row["observable"];
        let found = format!("{value:.7} ± {error:.1e} | {}", said(row));
        text.push_str(&format!(
            "| {} | {observable} | {truth} | {found} |\n",
            case.words
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

/// Runs cases, prints their rows of the table, and asserts that nothing is wrong with them.
fn assert_right(cases: impl Iterator<Item = &'static Case>) {
    println!("| sweep | density | truth | found | status |\n| --- | --- | --- | --- | --- |");
    let mut wrong = Vec::new();
    for case in cases {
        let rows = run(case);
        let (text, fault) = judged(case, &rows);
        print!("{text}");
        wrong.extend(fault.map(|fault| format!("{}: {fault}", case.words)));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

fn of(files: &'static [&str]) -> impl Iterator<Item = &'static Case> {
    CASES.iter().filter(|case| files.contains(&case.file))
}

#[test]
fn what_is_lost_in_the_errors_of_a_density_is_located_on_finer_cells() {
    assert_right(of(&["faint_centre"]));
}

#[test]
fn a_band_holds_what_is_read_beside_a_fixed_point() {
    assert_right(of(&["resting"]));
}

#[test]
fn cells_are_refined_until_values_are_as_certain_as_wanted() {
    assert_right(of(&["coupled", "dimentberg"]));
}

#[test]
fn two_births_inside_one_step_have_a_row_each() {
    assert_right(of(&["three_wells"]));
}

#[test]
fn what_vanishes_at_a_corner_of_a_force_is_located() {
    assert_right(of(&["bent_force"]).take(1));
}

#[test]
fn cells_that_hide_peaks_do_not_agree_by_chance() {
    assert_right(of(&["power_tails"]).take(1));
}

#[test]
#[ignore = "a quarter of a minute: cells are refined thrice for a value that stays unresolved"]
fn the_crater_of_van_der_pols_oscillator_is_in_its_band_at_length() {
    assert_right(of(&["van_der_pol"]));
}

#[test]
#[ignore = "a quarter of a minute: cells are refined thrice for values that stay unresolved"]
fn the_bands_of_splits_that_cells_hardly_show_hold_them_at_length() {
    assert_right(of(&["mirrored_splits"]));
}

#[test]
fn quick_cases_on_one_axis_are_located() {
    let quick = &["deep_wells", "tilted", "two_folds", "undeclared_kink"];
    assert_right(of(quick).take(4));
}

#[test]
#[ignore = "prints the table of docs/location.md"]
fn all_of_them() {
    assert_right(CASES.iter());
}
