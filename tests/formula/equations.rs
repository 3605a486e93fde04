//! Equations in a sweep file, driven as a user would: what is wrong is shown in the formula, and runs are as those of
//! built-in models.

use crate::common::room::{Printed, Room};

const GOOD: &str = r#"title = "trial"
[system.equations]
x = "y"
y = "-(c0 + c1 x^2) y - x - friction"
[system.noise]
y = ["sqrt(2 D)", "0.1 x"]
[system.define]
friction = "f_c sign(y)"
[system.parameters]
c1 = 0.5
D = 0.1
f_c = 0.1
[sweep]
parameter = "c0"
from = -0.3
to = 0.5
points = 3
[cells]
x = { from = -4, to = 4, count = 24 }
y = { from = -4, to = 4, count = 24 }
"#;

fn check(text: &str, settings: &str) -> Printed {
    let room = Room::new();
    room.write("a.toml", text);
    room.run(&format!("check a.toml {settings}"))
}

/// A text that must be refused in these words.
fn refused(text: &str, settings: &str, words: &[&str]) -> String {
    check(text, settings).ends(2).says(words).err
}

/// The good file with one piece of text replaced must be refused in these words, and for this many reasons.
fn assert_refused(old: &str, new: &str, count: &str, words: &[&str]) {
    assert_eq!(GOOD.matches(old).count(), 1, "{old} is not unique");
    let message = refused(&GOOD.replace(old, new), "", words);
    assert!(message.contains(&format!("{count};")), "{message}");
}

#[test]
#[rustfmt::skip]
fn what_is_wrong_with_a_formula_is_shown_in_it() {
    assert_refused("c1 x^2", "c_1 x^2 + kapa", "1 error",
        &["the equation of `y`: unknown symbol `kapa`", "a.toml:4:23", "^^^^", "parameters c1, D, f_c, c0",
            "give `kapa` a value in [system.parameters]"]);
    assert_refused("- friction", "- fricton", "1 error", &["did you mean `friction`?", "a.toml:4:29"]);
    assert_refused("y - x", "y - sin(x, 1)", "1 error", &["`sin` is given 2 arguments", "allowed: sin(x)"]);
    assert_refused("x = \"y\"", "x = \" \"", "1 error", &["the formula is empty", "a.toml:3:"]);
    assert_refused("sqrt(2 D)", "sqrt(2 E)", "1 error", &["noise 1 on `y`: unknown symbol `E`", "a.toml:6:14"]);
    assert_refused("0.1 x\"", "0.1 xx\"", "1 error", &["noise 2 on `y`: unknown symbol `xx`", "a.toml:6:24"]);
    assert_refused("f_c sign(y)", "f_c sgin(y)", "1 error", &["`sgin` is not a function", "a.toml:8:"]);
    assert_refused("y - x", "y + t - x", "1 error", &["`t` stands outside of sin and cos", "a.toml:4:"]);
    assert_refused("x = \"y\"", "x = true", "1 error", &["`system.equations.x` cannot be a boolean", "a formula"]);
}

#[test]
#[rustfmt::skip]
fn names_and_equations_fit_together() {
    assert_refused("y = \"-(c0", "\"y z\" = \"-(c0", "1 error",
        &["`y z` is not a name", "a.toml:4:1"]);
    assert_refused("x = \"y\"", "x = \"y\"\nx = \"0\"", "1 error", &["duplicate key", "a.toml:4:1"]);
    assert_refused("y = [\"sqrt", "z = [\"sqrt", "1 error",
        &["`system.noise.z`: no equation is of that name", "a.toml:6:1", "allowed: `x`, `y`"]);
    assert_refused("c1 = 0.5", "c1 = 0.5\nx = 1", "1 error", &["`x` is already a state", "a.toml:11:1"]);
    assert_refused("c1 = 0.5", "c1 = 0.5\nsin = 1", "1 error", &["`sin` is a function", "a.toml:11:1"]);
    assert_refused("c1 = 0.5", "c1 = 0.5\n\"c₁\" = 1", "1 error", &["`c₁` is already a parameter (spelled `c1`)"]);
    assert_refused("\"f_c sign(y)\"", "\"2 g\"\ng = \"friction\"", "1 error",
        &["it needs itself: friction → g → friction", "a.toml:8:"]);
    assert_refused("x = \"y\"", "x = \"y\"\na = 0\nb = 0\nc = 0", "1 error", &["5 axes; a model has 1 to 4"]);
    assert_refused("y = [\"sqrt(2 D)\", \"0.1 x\"]", "", "1 error", &["no equation has noise"]);
    assert_refused("\"0.1 x\"", "\"0.1 y\"", "1 error",
        &["Itô's and Stratonovich's readings", "interpretation = \"ito\""]);
    assert_refused("parameter = \"c0\"", "parameter = \"cc\"", "2 errors",
        &["unknown symbol `c0`", "the swept parameter `cc` is in no equation"]);
    assert_refused("title = \"trial\"", "title = \"trial\"\n[system]\nmodel = \"coulomb\"", "1 error",
        &["a built-in model, and `system.equations` too"]);
    assert_refused("f_c = 0.1", "f_c = 0.1\n[system.bounds]\ny = [\"-x\", \"4\"]", "1 error",
        &["a bound of `y` contains `x`"]);
}

#[test]
#[rustfmt::skip]
fn formulas_are_finite_on_the_domain() {
    assert_refused("y - x", "y - 1/x", "1 error",
        &["the equation of `y` is not finite on the domain: division by zero in 1/x at x = 0", "a.toml:4:5"]);
    assert_refused("y - x", "y - exp(1000 x)", "1 error", &["overflow in exp(1000 x) at x = 4"]);
    assert_refused("sqrt(2 D)", "sqrt(x)", "1 error",
        &["noise 1 on `y` is not finite", "square root of a negative number", "a.toml:6:6"]);
}

#[test]
fn trajectories_that_cannot_start_are_told_apart_from_those_that_run_away() {
    let open = GOOD.replace("from = -4, to = 4, ", "range = \"auto\", ");
    let start = "is not finite where the trajectories that look for a range start";
    let root = open.replace("y - x", "y - sqrt(x - 3)");
    refused(&root, "", &[&format!("the equation of `y` {start}")]);
    let away = open.replace("y - x", "y + 5 x^3 + 9");
    refused(&away, "", &["no range was found within"]);
}

#[test]
fn a_coordinate_that_may_be_an_angle_is_told_where_no_range_holds_it() {
    let rotor = GOOD
        .replace(
            "y = \"-(c0 + c1 x^2) y - x - friction\"",
            "y = \"-0.3 y - sin(x) + c0 + 0.5\"",
        )
        .replace("[\"sqrt(2 D)\", \"0.1 x\"]", "\"sqrt(2 D)\"")
        .replace("from = -4, to = 4, ", "range = \"auto\", ");
    let told = refused(
        &rotor,
        "",
        &["repeats itself with x + 2 pi", "`x = \"periodic\"`"],
    );
    assert!(!told.contains("inside ends"), "{told}");
}

#[test]
fn all_mistakes_are_reported_at_once() {
    let text = GOOD
        .replace("f_c sign(y)", "f_c sgin(y)")
        .replace("x = \"y\"", "x = \"y +\"")
        .replace("sqrt(2 D)", "sqrt(2 E)")
        .replace("points = 3", "points = 1");
    let places = ["a.toml:3:9", "a.toml:6:14", "a.toml:8:17"];
    refused(&text, "", &places);
    refused(&text, "", &["points", "4 errors;"]);
}

#[test]
fn hostile_formulas_are_refused_shortly() {
    let nested = "(".repeat(3_000) + "x" + &")".repeat(3_000);
    for (formula, words) in [
        ("x + ".repeat(25_000) + "x", "at most 65536 bytes"),
        (nested, "at most 64 levels"),
        ("x + ".repeat(300_000) + "x", "larger than 1 MB"),
    ] {
        let text = GOOD.replace("x = \"y\"", &format!("x = \"{formula}\""));
        let message = refused(&text, "", &[words]);
        assert!(message.len() < 5_000, "{}", message.len());
    }
}

#[test]
fn what_is_not_used_is_told() {
    let text = GOOD.replace("c1 = 0.5", "c1 = 0.5\nleft = 1");
    let unused = "warning: parameter `left` is in no equation";
    check(&text, "").ends(0).says(&[unused, "a.toml:11:1"]);
    refused(
        GOOD,
        "system.parameters.d=0.2",
        &["parameter `d` is in no equation"],
    );
}

#[test]
fn names_may_be_greek() {
    let text = GOOD
        .replace("c1 x^2", "γ_1 x²")
        .replace("c1 = 0.5", "gamma1 = 0.5")
        .replace("D = 0.1", "\"σ\" = 0.1")
        .replace("sqrt(2 D)", "sqrt(2 sigma)");
    let sweep = "system.parameters.γ1=0.25 sweep.parameter=sigma";
    let printed = check(&text, sweep).ends(2).says(&["unknown symbol `c0`"]);
    assert!(printed.out.is_empty());
    let printed = check(
        &text,
        &format!("{sweep} system.parameters.c0=0.125 sweep.from=0.05"),
    );
    let names = [
        "gamma1 = 0.25",
        "c0 = 0.125",
        "\"σ\" = 0.1",
        "parameter = \"σ\"",
    ];
    printed.ends(0).says(&names);
}

/// A complete file is read to the same file, any parameter may be swept, and a run can be opened again.
#[test]
fn a_run_is_as_that_of_a_built_in_model() {
    let room = Room::new();
    room.write("a.toml", GOOD.replace("c1 = 0.5", "c0 = 0.2\nc1 = 0.5"));
    let complete = room.solved("check a.toml").out;
    room.write("b.toml", &complete);
    let again = room.solved("check b.toml").out;
    assert_eq!(again.replace("b.toml", "a.toml"), complete);
    let other = room.solved("check a.toml sweep.parameter=D sweep.from=0.1");
    other.says(&["c0 = 0.2", "parameter = \"D\""]);

    let fast = "locate.grid_check=off figures.formats=[\"svg\"] --quiet";
    let found = room.solved(&format!("sweep a.toml --out run {fast}")).out;
    assert!(room.read("run/points.csv").starts_with("c0,"));
    let again = room.solved("detect run --out again --quiet").out;
    assert_eq!(found, again.replace("again/", "run/"));
    assert_eq!(
        room.read("run/features.csv"),
        room.read("again/features.csv")
    );
    room.solved("plot run --out drawn --quiet");
    assert!(!room.files("drawn", &[]).is_empty());
}

#[test]
fn starting_files_are_written_and_run_as_they_stand() {
    let room = Room::new();
    let like = "pbif new FILE --like NAME";
    room.run("new")
        .says(&["vanderpol", "Van der Pol oscillator", like]);
    let written = room.done("new mine.toml --like genetic");
    written.says(&["pbif sweep mine.toml"]);
    let text = room.read("mine.toml");
    for words in ["pbif sweep mine.toml", "# Source: ", "[system.equations]"] {
        assert!(text.contains(words), "{text}");
    }
    let found = room.done("sweep mine.toml --quiet figures.formats=[]");
    found.says(&["1 peak → 2 peaks, symmetric split", "located"]);
    // A file that is there is never replaced.
    room.refused("new mine.toml", &["`mine.toml` is there already"]);
    assert_eq!(room.read("mine.toml"), text);
    // Names that are easily taken for something else, and names that a shell or a comment would take apart.
    let laser = "write `pbif new laser.toml --like laser`";
    for (line, words) in [
        ("new b.toml --like vanderpool", "did you mean `vanderpol`?"),
        ("new laser", laser),
        ("new --like laser", laser),
        ("new b.toml --like coulomb", "`coulomb` is a built-in model"),
        ("new none/b.toml", "make its folder first"),
    ] {
        room.refused(line, &[words]);
        assert!(!room.holds("b.toml"));
    }
    let spaced = room.run("new -- '-my file.toml'");
    spaced.says(&["pbif sweep './-my file.toml'"]);
    if cfg!(unix) {
        room.done("new 'two\nlines.toml'");
        room.done("check 'two\nlines.toml'");
    }
}

#[test]
fn check_shows_what_was_read_and_found() {
    check(GOOD, "").says(&[
        "#   x' = y",
        "√(2 D) ξ₁(t) + 0.1 x ξ₂(t)",
        "#   friction = f_c sign(y)",
        "ξ₁ on y, additive",
        "ξ₂ on y, multiplicative in x",
        "the drift is not smooth where y = 0",
        "the reflection x → -x, y → -y leaves the process as it is",
    ]);
    let oblique = GOOD
        .replace("y - x", "y - abs(x - y)")
        .replace("\"sqrt(2 D)\", ", "");
    check(&oblique, "").says(&[
        "no face of the grid lies there",
        "the amplitude 0.1 x may be zero in the domain",
    ]);
}

/// Ranges, gradings and counts are found, told, and written down as numbers; the error that was wanted is kept.
#[test]
fn cells_may_be_left_out() {
    let (file, _) = GOOD.split_once("[cells]").unwrap();
    let file = format!("{file}[cells]\naccuracy = 0.01\n");
    let axis = |printed: &Printed, name: &str| {
        let table: toml::Table = printed.out.parse().unwrap();
        table["cells"][name].clone()
    };
    let count = |axis: toml::Value| axis["count"].as_integer().unwrap();
    let chosen = "an axis are chosen; with 40 and 60 cells an axis";
    let grade = "grade = { at = [0.0], smallest = ";
    let printed = check(&file, "method.memory_limit=1")
        .ends(0)
        .says(&[chosen, grade]);
    let cells = count(axis(&printed, "x"));
    assert_eq!(count(axis(&printed, "y")), cells);
    assert!((40..=240).contains(&cells) && cells % 2 == 0, "{cells}");
    assert!(axis(&printed, "x")["to"].as_float().unwrap() > 2.0);
    // One axis is chosen, the other given.
    let given = format!("{file}x = {{ from = -4, to = 4, count = 30 }}\n");
    let printed = check(&given, "").ends(0);
    assert_eq!(count(axis(&printed, "x")), 30);
    assert!(count(axis(&printed, "y")) > 0);
}
