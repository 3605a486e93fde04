//! Times of first passage from a sweep file to tables and figures; and questions that have no answer.

use crate::common::numbers::assert_holds;
use crate::common::room::{Room, assert_says};

/// dx = -k x dt + √2 dW.
const FILE: &str = r#"title = "passages"
[system.equations]
x = "-k x"
[system.noise]
x = "sqrt(2)"
[system.parameters]
k = 0.5
[sweep]
parameter = "k"
from = 0.5
to = 1.0
points = 3
[cells]
x = { from = -6.0, to = 6.0, count = 120 }
[regions]
near = "abs(x) < 0.5"
far = "not (-2 <= x <= 2)"
[passage]
leave = { start = { x = 0 }, until = "far", times = [1, 0.5], quantiles = [0.5] }
between = { from = "near", to = "x > 2 or far" }
[figures]
formats = ["svg"]
draw = ["measures_leave_mean"]
"#;

/// T(0) = ∫_0^2 e^{k y²/2} ∫_0^y e^{-k z²/2} dz dy of dx = -k x dt + √2 dW until |x| = 2, by Simpson's rule.
fn exact(k: f64) -> f64 {
    let n = 2000;
    let h = 2.0 / f64::from(n);
    let (mut inner, mut sum) = (0.0, 0.0);
    for step in 0..n {
        let [a, b, c] = [0.0, 0.5, 1.0].map(|share| h * (f64::from(step) + share));
        let f = |z: f64| (-k * z * z / 2.0).exp();
        let half = inner + h / 24.0 * (5.0 * f(a) + 8.0 * f(b) - f(c));
        let whole = inner + h / 6.0 * (f(a) + 4.0 * f(b) + f(c));
        sum += h / 6.0 * (inner / f(a) + 4.0 * half / f(b) + whole / f(c));
        inner = whole;
    }
    sum
}

#[test]
fn a_sweep_has_the_numbers_of_its_passages_and_again_after_it_is_read_back() {
    let room = Room::new();
    room.write("a.toml", FILE);
    room.done("sweep a.toml --out run");
    let table = room.table("run/points.csv");
    for row in &table.0 {
        let [k, mean, error] = row.numbers(["k", "leave_mean", "leave_mean_error"]);
        assert_holds([mean, error], exact(k), 1e-3 * mean);
        let [early, late] = row.numbers(["leave_0.5_survival", "leave_1_survival"]);
        assert!(1.0 > early && early > late && late > 0.0);
        let [median, deviation, rate] =
            row.numbers(["leave_0.5_quantile", "leave_sd", "leave_rate"]);
        assert!(median < mean && deviation < mean && rate * mean > 1.0 && rate * mean < 1.5);
        // From near the middle to the same border it takes a little less.
        let between = row.number("between_mean");
        assert!(between < mean && between > 0.9 * mean, "{between} {mean}");
        assert_eq!(&row["findings"], "");
    }
    room.holds_all("run", "figures/measures_leave_mean.svg");
    // The complete file asks the same, and gives the same.
    let complete = room.done("show run --sweep").out;
    assert_says(
        &complete,
        &["[regions]", "near = \"abs(x) < 0.5\"", "quantiles = [0.5]"],
    );
    room.write("b.toml", complete);
    room.done("sweep b.toml --out again");
    let columns = ["seconds"];
    let again = room.table("again/points.csv").without(&columns);
    assert_eq!(again, table.without(&columns));
    room.done("plot run --only measures_leave_mean --format csv");
}

#[test]
fn a_level_of_a_mean_time_is_located_where_the_formula_crosses_it() {
    let room = Room::new();
    // Between two of the sweep's values; the logarithm of the time is no straight line between them.
    let (at, level) = (0.83, exact(0.83));
    let levels = format!("[levels]\nleave_mean = {level}\nsd_x = 1.2\n[passage]");
    room.write(
        "a.toml",
        FILE.replace("points = 3", "points = 5")
            .replace("[passage]", &levels),
    );
    let printed = room.done("sweep a.toml --out run");
    assert_says(
        &printed.text(),
        &["LV1", "LV2", "leave_mean", "rises through", "located"],
    );
    let table = room.table("run/bifurcations.csv");
    let row = |of: &str| table.0.iter().find(|row| &row["observable"] == of).unwrap();
    let [value, error, lower, upper] =
        row("leave_mean").numbers(["value", "error", "lower", "upper"]);
    assert_holds([value, error], at, 1e-3);
    assert!(lower <= value && value <= upper && upper - lower <= 0.125);
    let texts = row("leave_mean").texts(["status", "method", "reason"]);
    assert_eq!(texts, ["located", "level", ""]);
    // The deviation is 1/√k.
    let [value, error] = row("sd_x").numbers(["value", "error"]);
    assert!(
        (value - 1.0 / 1.44).abs() <= error + 1e-6 && error < 1e-3,
        "{value} ± {error}"
    );
    assert_says(&row("sd_x")["change"], &["falls through 1.2"]);
    // From the stored values the same rows follow.
    room.done("detect run");
    assert_eq!(room.table("run/bifurcations.csv"), table);
    let complete = room.done("show run --sweep").out;
    assert_says(&complete, &["[levels]", "sd_x = 1.2"]);
}

#[test]
#[rustfmt::skip]
fn a_question_without_an_answer_leaves_the_rest_and_says_why() {
    let room = Room::new();
    for (old, new, code, words) in [
        ("far = \"not (-2 <= x <= 2)\"", "far = \"x > 40\"", "passage-nowhere", "widen the ranges"),
        ("far = \"not (-2 <= x <= 2)\"", "far = \"x < 7\"", "passage-everywhere", "nothing to wait for"),
        ("start = { x = 0 }", "start = { x = 3 }", "passage-start", "it starts inside"),
    ] {
        room.write("a.toml", FILE.replace(old, new));
        let printed = room.solved("sweep a.toml --out run");
        assert_says(&printed.text(), &[words, "passage `leave` has no numbers"]);
        let row = &room.table("run/points.csv").0[0];
        assert_eq!(&row["status"], "solved");
        assert_eq!(&row["leave_mean"], "");
        assert_says(&row["findings"], &[code]);
        room.done("clean run --yes");
        let _ = std::fs::remove_dir_all(room.path("run"));
    }
}

#[test]
#[rustfmt::skip]
fn wrong_questions_are_refused_with_their_place_and_a_remedy() {
    let room = Room::new();
    for (old, new, words) in [
        ("abs(x) < 0.5", "abs(z) < 0.5", ["region `near`: unknown symbol `z`", "allowed: "]),
        ("abs(x) < 0.5", "abs(x)", ["neither an inequality", "and `not`"]),
        ("abs(x) < 0.5", "k < 0.5", ["depends on no coordinate", "near"]),
        ("x > 2 or far", "x > 2 or", ["an inequality is missing", "between"]),
        ("x > 2 or far", "fra", ["`fra` is neither", "did you mean `far`"]),
        ("[passage]", "[levels]\nleve_mean = 3.0\n[passage]", ["`leve_mean` is no number of this sweep", "leave_mean"]),
        ("start = { x = 0 }, ", "", ["does not say where it starts", "start = { x = 0 }"]),
        ("start = { x = 0 }", "start = { y = 0 }", ["`y` is no coordinate", "no axis"]),
        ("start = { x = 0 }", "start = { x = 0 }, from = \"near\"", ["one is enough", "leave"]),
        ("until = \"far\", ", "", ["does not say where it ends", "leave"]),
        ("x = \"-k x\"", "x = \"-k x + cos(t)\"", ["under a periodic force", "leave [passage] out"]),
        ("times = [1, 0.5]", "times = [-1]", ["times", "greater than zero"]),
        ("quantiles = [0.5]", "quantiles = [1.5]", ["quantiles", "between 0 and 1"]),
        ("[figures]", "[visits]\nv = \"x > 0.3\"\n[method]\nkind = \"sgcm\"\n[figures]", ["a system with one axis", "transitions"]),
    ] {
        assert_eq!(FILE.matches(old).count(), 1, "{old}");
        room.write("a.toml", FILE.replace(old, new));
        room.refused("sweep a.toml", &words);
    }
}

/// Maier and Stein's system between two discs.
const FIELDS: &str = r#"title = "fields"
[system.equations]
u = "u - u^3 - b u v^2"
v = "-(1 + u^2) v"
[system.noise]
u = "0.5"
v = "0.5"
[system.parameters]
b = 1.0
[sweep]
parameter = "b"
from = 1.0
to = 4.0
points = 2
[cells]
u = { from = -1.8, to = 1.8, count = 40 }
v = { from = -1.2, to = 1.2, count = 30 }
[regions]
left = "(u + 1)^2 + v^2 < 0.16"
right = "(u - 1)^2 + v^2 < 0.16"
[passage]
cross = { from = "left", to = "right", fields = ["mean-time", "committor"] }
[detect]
joint = []
[figures]
formats = ["svg"]
draw = ["field"]
"#;

#[test]
fn fields_are_stored_drawn_read_back_and_exported() {
    let room = Room::new();
    room.write("a.toml", FIELDS);
    room.done("sweep a.toml --out run");
    let arrays =
        "densities.zarr/cross_mean_time/zarr.json densities.zarr/cross_committor_error/zarr.json";
    room.holds_all("run", arrays);
    let drawn = "figures/field_cross_mean_time_1.svg figures/field_cross_committor_4.svg";
    room.holds_all("run", drawn);
    let before = room.bytes("run/figures/field_cross_committor_4.svg");
    // The same from what is stored.
    room.done("plot run --format svg");
    assert_eq!(
        room.bytes("run/figures/field_cross_committor_4.svg"),
        before
    );
    room.done("plot run --format csv --only field_cross_committor");
    let table = room.table("run/figures/field_cross_committor_1.csv");
    let mut middle = 0;
    for row in &table.0 {
        let [u, v, value, error] = row.numbers(["u", "v", "value", "error"]);
        assert!((0.0..=1.0).contains(&value) && error >= 0.0);
        let at = |sign: f64| (u - sign).hypot(v) < 0.4;
        if at(1.0) || at(-1.0) {
            assert_eq!((value, error), (f64::from(u8::from(at(1.0))), 0.0));
        }
        // The system is symmetric: the value at -u is what is missing to one.
        let mirrored = table.0.iter().find(|other| {
            let [x, y] = other.numbers(["u", "v"]);
            (x + u).abs() < 1e-9 && (y - v).abs() < 1e-9
        });
        let [other, of_other] = mirrored.unwrap().numbers(["value", "error"]);
        assert!(
            (value + other - 1.0).abs() <= error + of_other + 1e-9,
            "{value} {other}"
        );
        middle += usize::from(u.abs() < 0.05);
    }
    assert!(middle > 0);
    room.done("export run");
    assert!(String::from_utf8_lossy(&room.bytes("run.nc")).contains("cross_mean_time_error"));
    // A complete file asks the same.
    let complete = room.done("show run --sweep").out;
    assert_says(&complete, &["fields = [\"mean-time\", \"committor\"]"]);
    room.write("b.toml", complete);
    room.done("check b.toml");
}

#[test]
fn fields_that_cannot_be_worked_out_are_refused() {
    let room = Room::new();
    for (old, new, words) in [
        (
            "from = \"left\", to = \"right\"",
            "from = \"density\", to = \"right\"",
            ["asks for a committor", "as `from` and `to`"],
        ),
        (
            "\"mean-time\", \"committor\"",
            "\"mean-times\"",
            ["mean-times", "mean-time"],
        ),
        (
            "[figures]",
            "[method]\nkind = \"monte-carlo\"\n[figures]",
            ["by `generator`, not by `monte-carlo`", "`fields`"],
        ),
        (
            "v = \"-(1 + u^2) v\"",
            "v = \"-(1 + u^2) v\"\nw = \"-w + v\"",
            [
                "over one or two axes of cells, and this system has 3",
                "`fields`",
            ],
        ),
        (
            "u = \"u - u^3 - b u v^2\"",
            "cross_mean_time = \"-cross_mean_time\"\nu = \"u - u^3 - b u v^2\"",
            ["cross_mean_time", "name"],
        ),
    ] {
        assert_eq!(FIELDS.matches(old).count(), 1, "{old}");
        let text = FIELDS.replace(old, new);
        let axis =
            |name: &str| format!("[cells]\n{name} = {{ from = -2.0, to = 2.0, count = 12 }}");
        let text = match new {
            new if new.contains("w =") => text.replace("[cells]", &axis("w")),
            new if new.contains("-cross_mean_time") => {
                text.replace("[cells]", &axis("cross_mean_time"))
            }
            _ => text,
        };
        room.write("a.toml", text);
        room.refused("sweep a.toml", &words);
    }
}

/// A potential with wells at -1 and 1 and its top at r, beside an axis of its own.
const BASINS: &str = r#"title = "basins"
[system.equations]
x = "-(x - 1)*(x + 1)*(x - r)"
y = "-y"
[system.noise]
x = "s"
y = "0.7"
[system.parameters]
r = 0.0
s = 0.7
[sweep]
parameter = "r"
from = -0.2
to = 0.2
points = 3
[cells]
x = { from = -2.4, to = 2.4, count = 80 }
y = { from = -3.0, to = 3.0, count = 36 }
[regions]
right = "peak 2 of x"
[passage]
found = { from = "peak 1 of x", to = "right" }
typed = { from = "x < r", to = "x > r" }
down = { start = { x = 0.9, y = 0 }, until = "peak 1 of x" }
back = { start = { x = 0.9, y = 0 }, until = "x < r" }
[detect]
marginals = ["x"]
joint = []
[figures]
draw = []
"#;

/// x has two wells and y one; x and y are a circle that grows by `a` and shrinks by its own square.
const IN_THE_PLANE: &str = r#"
[system.equations]
x = "DRIFT_X"
y = "DRIFT_Y"
[system.noise]
x = "s"
y = "s"
[system.parameters]
a = 1.0
s = 0.6
[sweep]
parameter = "a"
from = 0.8
to = 1.2
points = 2
[cells]
x = { from = -2.6, to = 2.6, count = 64 }
y = { from = -2.6, to = 2.6, count = 60 }
[passage]
found = { FOUND }
typed = { TYPED }
[detect]
marginals = []
joint = [["x", "y"]]
[figures]
draw = []
"#;

#[test]
fn basins_of_joint_densities_and_rings_end_where_valleys_and_crests_are() {
    let wells = ["a*x - x^3", "-y"];
    let circle = ["a*x - y - x*(x^2 + y^2)", "a*y + x - y*(x^2 + y^2)"];
    let cases = [
        (
            wells,
            "from = \"peak 1 of xy\", to = \"peak 2 of xy\"",
            "from = \"x < 0\", to = \"x > 0\"",
        ),
        (
            wells,
            "start = { x = 0.9, y = 0.2 }, until = \"peak 1 of xy\"",
            "start = { x = 0.9, y = 0.2 }, until = \"x < 0\"",
        ),
        (
            circle,
            "start = { x = 0, y = 0.1 }, until = \"outside ring of xy\"",
            "start = { x = 0, y = 0.1 }, until = \"x^2 + y^2 > a\"",
        ),
        (
            circle,
            "start = { x = 1.6, y = 0.1 }, until = \"inside ring of xy\"",
            "start = { x = 1.6, y = 0.1 }, until = \"x^2 + y^2 < a\"",
        ),
    ];
    for ([x, y], found, typed) in cases {
        let room = Room::new();
        let file = IN_THE_PLANE.replace("DRIFT_X", x).replace("DRIFT_Y", y);
        let file = file.replace("FOUND", found).replace("TYPED", typed);
        room.write("a.toml", &file);
        room.done("sweep a.toml --out run");
        for row in &room.table("run/points.csv").0 {
            assert!(!row["findings"].contains("passage"), "{}", &row["findings"]);
            let [value, error, exact, of_exact] = [
                "found_mean",
                "found_mean_error",
                "typed_mean",
                "typed_mean_error",
            ]
            .map(|name| row.number(name));
            assert!(
                (value - exact).abs() <= error + of_exact,
                "{found}: {value} ± {error}, {exact} ± {of_exact}"
            );
            assert!(error < 0.05 * value, "{found}: {value} ± {error}");
        }
    }
}

#[test]
fn basins_of_peaks_end_at_the_valley_at_every_value() {
    let room = Room::new();
    room.write("a.toml", BASINS);
    room.done("sweep a.toml --out run");
    for row in &room.table("run/points.csv").0 {
        assert!(!row["findings"].contains("passage"), "{}", &row["findings"]);
        for (found, typed) in [("found", "typed"), ("down", "back")] {
            let numbers = |name: &str| {
                let names = [format!("{name}_mean"), format!("{name}_mean_error")];
                names.map(|name| row.number(&name))
            };
            let ([value, error], [exact, of_exact]) = (numbers(found), numbers(typed));
            assert!(
                (value - exact).abs() <= error + of_exact,
                "{value} ± {error}, {exact} ± {of_exact}"
            );
            assert!(error < 0.05 * value, "{value} ± {error}");
        }
    }
    room.write("b.toml", room.done("show run --sweep").out);
    assert_says(
        &room.read("b.toml"),
        &["from = \"peak 1 of x\"", "until = \"right\""],
    );
    room.done("check b.toml");
    // A third peak is not there.
    room.write("three.toml", BASINS.replace("peak 1 of x", "peak 3 of x"));
    room.done("sweep three.toml --out three");
    for row in &room.table("three/points.csv").0 {
        assert!(
            row["findings"].contains("passage-no-peak"),
            "{}",
            &row["findings"]
        );
        assert_eq!(&row["found_mean"], "");
        assert!(row.number("back_mean") > 0.0);
    }
    for (old, new, words) in [
        (
            "peak 2 of x",
            "peak 2 of z",
            [
                "a region that is found is `peak N of AXIS`",
                "write `peak 1 of x`",
            ],
        ),
        (
            "marginals = [\"x\"]",
            "marginals = [\"y\"]",
            ["which is not watched", "detect.marginals"],
        ),
        (
            "from = \"peak 1 of x\", to = \"right\"",
            "from = \"peak 1 of x\", to = \"right\", fields = [\"committor\"]",
            [
                "committor between regions that are found",
                "give inequalities",
            ],
        ),
        (
            "until = \"peak 1 of x\"",
            "until = [\"peak 1 of x\", \"x > 2\"]",
            ["among several regions", "the found region alone"],
        ),
        (
            "to = \"right\"",
            "to = \"right\", switching = \"on\"",
            ["rates between states", "leave `fields` and `switching` out"],
        ),
        (
            "[figures]",
            "[method]\nkind = \"monte-carlo\"\n[figures]",
            ["which `generator` does alone", "give an inequality"],
        ),
    ] {
        assert_eq!(BASINS.matches(old).count(), 1, "{old}");
        room.write("c.toml", BASINS.replace(old, new));
        room.refused("sweep c.toml", &words);
    }
}

/// The numbers of passages of a row, each with its error.
fn numbers(row: &crate::common::table::Row) -> Vec<(f64, f64)> {
    let names = [
        "mean",
        "sd",
        "rate",
        "0.5_survival",
        "1_survival",
        "0.5_quantile",
    ];
    let leave = names.map(|name| format!("leave_{name}"));
    let between = ["between_mean", "between_sd", "between_rate"].map(str::to_owned);
    let all = leave.into_iter().chain(between);
    let one = |name: String| (row.number(&name), row.number(&format!("{name}_error")));
    all.map(one).collect()
}

#[test]
fn monte_carlo_and_a_comparison_give_the_numbers_of_the_generator() {
    let room = Room::new();
    let few = "\nerror = 0.02\npassages = 8192\n[figures]\nat = [0.5]\n";
    let by = |kind: &str| FILE.replace("[figures]\n", &format!("[method]\nkind = \"{kind}\"{few}"));
    room.write("a.toml", by("generator"));
    room.write("b.toml", by("monte-carlo"));
    assert_says(
        &room.done("check b.toml").out,
        &["passages: 2 a point, 8192 paths"],
    );
    room.done("sweep a.toml --out a");
    room.done("sweep b.toml --out b");
    let rows = [room.table("a/points.csv").0, room.table("b/points.csv").0];
    for (exact, sampled) in rows[0].iter().zip(&rows[1]) {
        assert_eq!(&sampled["findings"], "");
        for (exact, sampled) in numbers(exact).into_iter().zip(numbers(sampled)) {
            let off = (exact.0 - sampled.0).abs() / sampled.1.hypot(exact.1);
            println!("{exact:?} {sampled:?} off by {off:.2}");
            assert!(
                off < 4.0 && sampled.1 < 0.05 * sampled.0,
                "{exact:?} {sampled:?}"
            );
        }
    }
    let printed = room.done("compare a.toml --out c").out;
    assert_says(&printed, &["Times of first passage", "leave_mean"]);
    let table = room.table("c/measures.csv").0;
    let row = table
        .iter()
        .find(|row| &row["measure"] == "leave_mean")
        .unwrap();
    assert!(row.number("errors_apart").abs() < 4.0);
    let of_passages = table.iter().filter(|row| {
        let name = &row["measure"];
        name.starts_with("leave_") || name.starts_with("between_")
    });
    for row in of_passages {
        let [value, error, apart] = row.numbers(["sgcm", "sgcm_error", "sgcm_errors_apart"]);
        let name = &row["measure"];
        println!("{name} by SGCM: {value} ± {error}, {apart} errors apart");
        assert!(apart.abs() < 4.0 && error < 0.2 * value, "{name}");
    }
    // On other cells, so that time steps are the same but for rounding.
    for (by, run) in ["generator", "monte_carlo"].iter().zip(&rows) {
        let [value, error] = run[0].numbers(["leave_mean", "leave_mean_error"]);
        assert!((row.number(by) - value).abs() < 0.1 * error, "{by}");
        assert!((row.number(&format!("{by}_error")) - error).abs() < 0.1 * error);
    }
}

#[test]
fn paths_that_go_on_for_too_long_are_told() {
    let room = Room::new();
    let method = "[method]\nkind = \"monte-carlo\"\nerror = 0.05\npassages = 1024\nlongest_passage = 2.0\n[figures]";
    room.write("a.toml", FILE.replace("[figures]", method));
    let printed = room.done("sweep a.toml --out run");
    assert_says(
        &printed.text(),
        &["still went on at 2.0", "passage `leave`"],
    );
    let row = &room.table("run/points.csv").0[0];
    assert_says(&row["findings"], &["passage-cut"]);
    let [mean, error] = row.numbers(["leave_mean", "leave_mean_error"]);
    assert!((mean - exact(0.5)).abs() < 4.0 * error && error < 0.1 * mean);
    room.write(
        "a.toml",
        FILE.replace("[figures]", &method.replace("2.0", "0.01")),
    );
    let printed = room.solved("sweep a.toml --out again");
    assert_says(
        &printed.text(),
        &["hardly a path entered", "method.longest_passage"],
    );
}

const TRANSITIONS: &str = r#"
[system.equations]
x = "x - x^3 + h"
[system.noise]
x = "sqrt(0.2)"
[system.parameters]
h = 0
[sweep]
parameter = "h"
from = -0.1
to = 0.1
points = 3
[passage]
cross = { from = "x < -0.5", to = "x > 0.5", fields = ["reactive-density", "reactive-current"] }
[figures]
formats = ["svg"]
"#;

#[test]
fn transitions_come_to_tables_and_figures_and_regions_in_common_are_told() {
    let room = Room::new();
    room.write("a.toml", TRANSITIONS);
    room.done("sweep a.toml --out run");
    let rows = &room.table("run/points.csv").0;
    let fluxes: Vec<f64> = rows
        .iter()
        .map(|row| row.number("cross_transition_flux"))
        .collect();
    for row in rows {
        assert!(!row["findings"].contains("passage"), "{}", &row["findings"]);
        for name in ["flux", "rate", "time"] {
            let name = format!("cross_transition_{name}");
            let [value, error] =
                [name.clone(), format!("{name}_error")].map(|name| row.number(&name));
            assert!(
                error > 0.0 && error < 1e-3 * value,
                "{name}: {value} ± {error}"
            );
        }
    }
    // The tilt to one side is the mirror image of that to the other, and as many go back as go.
    let error = rows[0].number("cross_transition_flux_error");
    let last = fluxes.last().unwrap();
    assert!((fluxes[0] - last).abs() < 2.0 * error + 1e-9, "{fluxes:?}");
    for name in [
        "field_cross_reactive_density",
        "field_cross_reactive_current_x",
    ] {
        assert!(
            room.read(&format!("run/figures/{name}.svg"))
                .contains("<svg")
        );
    }
    for (to, code, words) in [
        (
            "x > -0.8 and x < 0.1",
            "passage-overlap",
            "states in common",
        ),
        ("x > 9", "passage-nowhere", "widen the ranges"),
    ] {
        room.write("b.toml", TRANSITIONS.replace("x > 0.5", to));
        room.done(&format!("sweep b.toml --out {code} --set figures.draw=[]"));
        let row = &room.table(&format!("{code}/points.csv")).0[0];
        assert!(row["findings"].contains(code), "{}", &row["findings"]);
        assert!(row["warnings"].contains(words), "{}", &row["warnings"]);
        assert_eq!(&row["cross_transition_flux"], "");
    }
}

#[test]
fn transitions_counted_on_trajectories_stand_beside_those_of_the_generator() {
    let room = Room::new();
    let fields = "fields = [\"reactive-density\", \"reactive-current\"]";
    let few = "error = 0.1\npassages = 1024\n[figures]\nat = [0.1]";
    let text = TRANSITIONS.replace(fields, "transitions = \"on\"");
    let text = text.replace("sqrt(0.2)", "sqrt(0.6)");
    let by = |kind: &str| text.replace("[figures]", &format!("[method]\nkind = \"{kind}\"\n{few}"));
    room.write("a.toml", by("generator"));
    room.write("b.toml", by("monte-carlo"));
    let told = "transitions: of 1 passages a point, until 1024 are counted";
    assert_says(&room.done("check b.toml").out, &[told]);
    room.done("compare a.toml --out c");
    let table = room.table("c/measures.csv").0;
    let names = ["flux", "rate", "time"].map(|name| format!("cross_transition_{name}"));
    for name in &names {
        let row = table.iter().find(|row| &row["measure"] == name.as_str());
        let row = row.unwrap_or_else(|| panic!("no {name}"));
        let [value, error, apart] =
            row.numbers(["monte_carlo", "monte_carlo_error", "errors_apart"]);
        println!("{name}: {value} ± {error}, {apart} errors apart");
        assert!(
            apart.abs() < 4.0 && error < 0.1 * value,
            "{name}: {value} ± {error}"
        );
    }
    let last = "figures.draw=[] method.passages=64 method.longest_passage=0.2";
    for (to, code) in [
        ("x > 2.6", "passage-rare"),
        ("x > -0.8 and x < 0.1", "passage-overlap"),
    ] {
        room.write("d.toml", by("monte-carlo").replace("x > 0.5", to));
        room.solved(&format!("sweep d.toml --out {code} {last}"));
        let row = &room.table(&format!("{code}/points.csv")).0[0];
        assert!(row["findings"].contains(code), "{}", &row["findings"]);
        assert_eq!(&row["cross_transition_flux"], "");
    }
}
