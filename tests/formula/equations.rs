//! Equations in a sweep file, driven as a user would: what is wrong is shown in the formula, and runs are as those of
//! built-in models.

use std::path::Path;
use std::process::{Command, Output};

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

fn pbif(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn check(text: &str, settings: &[&str]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), text).unwrap();
    let mut arguments = vec!["check", "a.toml"];
    for setting in settings {
        arguments.extend(["--set", setting]);
    }
    let output = pbif(folder.path(), &arguments);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

fn assert_says(message: &str, words: &[&str]) {
    for words in words {
        assert!(message.contains(words), "`{words}` not in\n{message}");
    }
}

/// The good file with one piece of text replaced must be refused in these words, and for this many reasons.
fn assert_refused(old: &str, new: &str, count: &str, words: &[&str]) {
    assert_eq!(GOOD.matches(old).count(), 1, "{old} is not unique");
    let (code, _, message) = check(&GOOD.replace(old, new), &[]);
    assert_eq!(code, Some(2), "{message}");
    assert_says(&message, words);
    assert_says(&message, &[&format!("{count};")]);
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
    assert_refused("y - x", "y + t - x", "1 error", &["contains the time `t`", "do not change with time"]);
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
    let (code, _, message) = check(&open.replace("y - x", "y - sqrt(x - 3)"), &[]);
    assert_eq!(code, Some(2), "{message}");
    assert_says(
        &message,
        &["the equation of `y` is not finite where the trajectories that look for a range start"],
    );
    let (code, _, message) = check(&open.replace("y - x", "y + 5 x^3 + 9"), &[]);
    assert_eq!(code, Some(2), "{message}");
    assert_says(&message, &["no range holds the density"]);
}

#[test]
fn all_mistakes_are_reported_at_once() {
    let text = GOOD
        .replace("f_c sign(y)", "f_c sgin(y)")
        .replace("x = \"y\"", "x = \"y +\"")
        .replace("sqrt(2 D)", "sqrt(2 E)")
        .replace("points = 3", "points = 1");
    let (code, _, message) = check(&text, &[]);
    assert_eq!(code, Some(2));
    assert_says(
        &message,
        &[
            "a.toml:3:9",
            "a.toml:6:14",
            "a.toml:8:17",
            "points",
            "4 errors;",
        ],
    );
}

#[test]
fn hostile_formulas_are_refused_shortly() {
    for (formula, words) in [
        ("x + ".repeat(25_000) + "x", "at most 65536 bytes"),
        (
            "(".repeat(3_000) + "x" + &")".repeat(3_000),
            "at most 64 levels",
        ),
        ("x + ".repeat(300_000) + "x", "larger than 1 MB"),
    ] {
        let text = GOOD.replace("x = \"y\"", &format!("x = \"{formula}\""));
        let (code, _, message) = check(&text, &[]);
        assert_eq!(code, Some(2));
        assert_says(&message, &[words]);
        assert!(message.len() < 5_000, "{}", message.len());
    }
}

#[test]
fn what_is_not_used_is_told() {
    let text = GOOD.replace("c1 = 0.5", "c1 = 0.5\nleft = 1");
    let (code, _, message) = check(&text, &[]);
    assert_eq!(code, Some(0), "{message}");
    assert_says(
        &message,
        &["warning: parameter `left` is in no equation", "a.toml:11:1"],
    );
    let (code, _, message) = check(GOOD, &["system.parameters.d=0.2"]);
    assert_eq!(code, Some(2), "{message}");
    assert_says(&message, &["parameter `d` is in no equation"]);
}

#[test]
fn names_may_be_greek() {
    let text = GOOD
        .replace("c1 x^2", "γ_1 x²")
        .replace("c1 = 0.5", "gamma1 = 0.5")
        .replace("D = 0.1", "\"σ\" = 0.1")
        .replace("sqrt(2 D)", "sqrt(2 sigma)");
    let (code, out, message) = check(
        &text,
        &["system.parameters.γ1=0.25", "sweep.parameter=sigma"],
    );
    assert_eq!(code, Some(2), "{message}");
    assert_says(&message, &["unknown symbol `c0`"]);
    assert!(out.is_empty());
    let settings = [
        "system.parameters.γ1=0.25",
        "system.parameters.c0=0.125",
        "sweep.parameter=sigma",
        "sweep.from=0.05",
    ];
    let (code, out, message) = check(&text, &settings);
    assert_eq!(code, Some(0), "{message}");
    assert_says(
        &out,
        &[
            "gamma1 = 0.25",
            "c0 = 0.125",
            "\"σ\" = 0.1",
            "parameter = \"σ\"",
        ],
    );
}

/// A complete file is read to the same file, any parameter may be swept, and a run can be opened again.
#[test]
fn a_run_is_as_that_of_a_built_in_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let with_value = GOOD.replace("c1 = 0.5", "c0 = 0.2\nc1 = 0.5");
    std::fs::write(path.join("a.toml"), &with_value).unwrap();
    let text = |output: Output| {
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(matches!(output.status.code(), Some(0 | 1)), "{error}");
        String::from_utf8(output.stdout).unwrap()
    };
    let complete = text(pbif(path, &["check", "a.toml"]));
    std::fs::write(path.join("b.toml"), &complete).unwrap();
    let again = text(pbif(path, &["check", "b.toml"]));
    assert_eq!(again.replace("b.toml", "a.toml"), complete);
    let other = [
        "check",
        "a.toml",
        "--set",
        "sweep.parameter=D",
        "--set",
        "sweep.from=0.1",
    ];
    assert_says(
        &text(pbif(path, &other)),
        &["c0 = 0.2", "parameter = \"D\""],
    );

    let fast = [
        "--set",
        "locate.grid_check=off",
        "--set",
        "figures.formats=[\"svg\"]",
        "--quiet",
    ];
    let found = text(pbif(
        path,
        &[&["sweep", "a.toml", "--out", "run"], &fast[..]].concat(),
    ));
    let table = |name: &str| std::fs::read_to_string(path.join(name)).unwrap();
    assert!(
        table("run/points.csv")
            .lines()
            .next()
            .unwrap()
            .starts_with("c0,")
    );
    let again = text(pbif(path, &["detect", "run", "--out", "again", "--quiet"]));
    assert_eq!(found, again.replace("again/", "run/"));
    assert_eq!(table("run/features.csv"), table("again/features.csv"));
    text(pbif(path, &["plot", "run", "--out", "drawn", "--quiet"]));
    assert!(path.join("drawn").read_dir().unwrap().next().is_some());
}

#[test]
fn starting_files_are_written_and_run_as_they_stand() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let words = |output: &Output| {
        let both = [&output.stdout[..], &output.stderr].concat();
        String::from_utf8(both).unwrap()
    };
    let listed = pbif(path, &["new"]);
    assert_says(
        &words(&listed),
        &[
            "vanderpol",
            "Van der Pol oscillator",
            "pbif new FILE --like NAME",
        ],
    );
    let written = pbif(path, &["new", "mine.toml", "--like", "genetic"]);
    assert_eq!(written.status.code(), Some(0));
    assert_says(&words(&written), &["pbif sweep mine.toml"]);
    let text = std::fs::read_to_string(path.join("mine.toml")).unwrap();
    assert_says(
        &text,
        &["pbif sweep mine.toml", "# Source: ", "[system.equations]"],
    );
    let found = pbif(
        path,
        &[
            "sweep",
            "mine.toml",
            "--quiet",
            "--set",
            "figures.formats=[]",
        ],
    );
    assert_eq!(found.status.code(), Some(0), "{}", words(&found));
    assert_says(
        &words(&found),
        &["1 peak → 2 peaks, symmetric split", "located"],
    );
    // A file that is there is never replaced.
    let again = pbif(path, &["new", "mine.toml"]);
    assert_eq!(again.status.code(), Some(2));
    assert_says(&words(&again), &["`mine.toml` is there already"]);
    assert_eq!(
        std::fs::read_to_string(path.join("mine.toml")).unwrap(),
        text
    );
    let unknown = pbif(path, &["new", "b.toml", "--like", "vanderpool"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert_says(&words(&unknown), &["did you mean `vanderpol`?"]);
    assert!(!path.join("b.toml").exists());
    // Names that are easily taken for something else, and names that a shell or a comment would take apart.
    let cases: [(&[&str], &str); 4] = [
        (
            &["new", "laser"],
            "write `pbif new laser.toml --like laser`",
        ),
        (
            &["new", "--like", "laser"],
            "write `pbif new laser.toml --like laser`",
        ),
        (
            &["new", "b.toml", "--like", "coulomb"],
            "`coulomb` is a built-in model",
        ),
        (&["new", "none/b.toml"], "make its folder first"),
    ];
    for (arguments, expected) in cases {
        let refused = pbif(path, arguments);
        assert_eq!(refused.status.code(), Some(2), "{}", words(&refused));
        assert_says(&words(&refused), &[expected]);
    }
    let spaced = pbif(path, &["new", "--", "-my file.toml"]);
    assert_says(&words(&spaced), &["pbif sweep './-my file.toml'"]);
    #[cfg(unix)]
    {
        let broken = pbif(path, &["new", "two\nlines.toml"]);
        assert_eq!(broken.status.code(), Some(0));
        assert_eq!(
            pbif(path, &["check", "two\nlines.toml"]).status.code(),
            Some(0)
        );
    }
}

#[test]
fn check_shows_what_was_read_and_found() {
    let (_, out, _) = check(GOOD, &[]);
    assert_says(
        &out,
        &[
            "#   x' = y",
            "√(2 D) ξ₁(t) + 0.1 x ξ₂(t)",
            "#   friction = f_c sign(y)",
            "ξ₁ on y, additive",
            "ξ₂ on y, multiplicative in x",
            "the drift is not smooth where y = 0",
            "the reflection x → -x, y → -y leaves the process as it is",
        ],
    );
    let oblique = GOOD
        .replace("y - x", "y - abs(x - y)")
        .replace("\"sqrt(2 D)\", ", "");
    let (_, out, _) = check(&oblique, &[]);
    assert_says(
        &out,
        &[
            "no face of the grid lies there",
            "the amplitude 0.1 x may be zero in the domain",
        ],
    );
}

/// Ranges, gradings and counts are found, told, and written down as numbers; the error that was wanted is kept.
#[test]
fn cells_may_be_left_out() {
    let (file, _) = GOOD.split_once("[cells]").unwrap();
    let file = format!("{file}[cells]\naccuracy = 0.01\n");
    let (code, out, message) = check(&file, &["method.memory_limit=1"]);
    assert_eq!(code, Some(0), "{message}");
    assert_says(
        &out,
        &[
            "an axis are chosen; with 40 and 60 cells an axis",
            "grade = { at = [0.0], smallest = ",
        ],
    );
    let table: toml::Table = out.parse().unwrap();
    let axis = |name: &str| table["cells"][name].clone();
    let count = axis("x")["count"].as_integer().unwrap();
    assert_eq!(axis("y")["count"].as_integer().unwrap(), count);
    assert!((40..=240).contains(&count) && count % 2 == 0, "{count}");
    assert!(axis("x")["to"].as_float().unwrap() > 2.0);
    // One axis is chosen, the other given.
    let (code, out, message) = check(
        &format!("{file}x = {{ from = -4, to = 4, count = 30 }}\n"),
        &[],
    );
    assert_eq!(code, Some(0), "{message}");
    let table: toml::Table = out.parse().unwrap();
    assert_eq!(table["cells"]["x"]["count"].as_integer(), Some(30));
    assert!(table["cells"]["y"]["count"].as_integer().is_some());
}
