//! Bad input, driven as a user would: exit code 2, a message that names place, cause and remedy, nothing written.

use crate::common::room::{Room, assert_says};

pub(super) const GOOD: &str = r#"title = "trial"
[system]
model = "coulomb"
[system.parameters]
kappa = 0.01
sigma2 = 0.01
[sweep]
parameter = "f_c"
from = -0.02
to = 0.01
points = 3
[cells]
x = { from = -5, to = 5, count = 10 }
y = { from = -5, to = 5, count = 10 }
"#;

/// A system of its own equations.
const TYPED: &str = r#"
[system]
[system.equations]
x = "y"
y = "-(c + x^2) y - x"
[system.noise]
y = "sqrt(2 D)"
[system.parameters]
c = 0.0
D = 0.05
[sweep]
parameter = "c"
from = 0.5
to = -0.5
points = 3
[cells]
x = { from = -3, to = 3, count = 10 }
y = { from = -3, to = 3, count = 10 }
"#;

/// Runs `pbif sweep` in a folder that holds `a.toml` alone, and returns stderr. Checks that it ends with code 2 in
/// these words, prints nothing on stdout, and leaves the folder as it was.
fn refused(text: impl AsRef<[u8]>, line: &str, words: &[&str]) -> String {
    let room = Room::new();
    room.write("a.toml", text);
    refused_in(&room, line, words)
}

fn refused_in(room: &Room, line: &str, words: &[&str]) -> String {
    let before = room.names();
    let printed = room.refused(&format!("sweep {line}"), words);
    assert!(printed.out.is_empty());
    assert!(
        !printed.err.contains('\u{1b}'),
        "escape codes off a terminal"
    );
    assert_eq!(room.names(), before, "something was written");
    printed.err
}

/// A good file with one piece of text replaced must be refused in these words, and for one reason.
fn assert_refused(good: &str, old: &str, new: &str, words: &[&str]) {
    assert_eq!(good.matches(old).count(), 1, "{old} is not unique");
    let message = refused(good.replace(old, new), "a.toml", words);
    assert_says(&message, &["1 error;"]);
}

#[test]
fn missing_files_and_files_that_no_sweep_file_is_like() {
    let words = [
        "cannot read the sweep file `a.tml`",
        "did you mean `a.toml`?",
    ];
    refused(GOOD, "a.tml", &words);
    let words = [
        "cannot read the sweep file `other`",
        "`sweeps/` holds examples",
    ];
    refused(GOOD, "other", &words);
    let room = Room::new();
    std::fs::create_dir(room.path("sweeps")).unwrap();
    room.write("sweeps/a.toml", GOOD);
    refused_in(&room, "a.toml", &["did you mean `sweeps/a.toml`?"]);
    refused([0xff_u8, 0xfe], "a.toml", &["not UTF-8"]);
    // Too long: what its beginning shows is told too, and no more than fits a screen or two.
    let many = |line: &str| format!("{GOOD}{}", line.repeat(100_000));
    let long = many("stranger = 1\n[zzz]\n");
    refused(long, "a.toml", &["larger than 1 MB", "not valid TOML"]);
    let words = ["not valid TOML", "and 99980 more", "100000 errors;"];
    let message = refused(many("= = =\n"), "a.toml", &words);
    assert!(message.len() < 20_000, "{}", message.len());
    let words = ["not UTF-8", "a.toml:1:13", "Latin-1"];
    refused(b"title = \"caf\xe9\"\n", "a.toml", &words);
    let utf16: Vec<u8> = GOOD.encode_utf16().flat_map(u16::to_le_bytes).collect();
    refused(utf16, "a.toml", &["UTF-16, not UTF-8", "save it as UTF-8"]);
}

#[test]
#[rustfmt::skip]
fn causes_are_those_of_what_was_typed() {
    let auto = TYPED.replace("y = { from = -3, to = 3, count = 10 }", "y = { range = \"auto\" }");
    let away = auto.replace("-(c + x^2) y - x", "0.1 y + c");
    for (text, set, words) in [
        (GOOD, "sweep.to=1e309", &["`sweep.to` cannot be as large as that"][..]),
        (GOOD, "cells.x={from=-1e308,to=1e308,count=10}", &["from -1e308 to 1e308", "longer than the largest number"]),
        (TYPED, "system.noise.rate=2", &["no equation is of that name", "amplitude of the noise on an axis"]),
        (&away, "sweep.points=3", &["range of `y` at c = 0.5", "`cells.y.from` and `to`", "[system.bounds]", "a.toml:18:1"]),
    ] {
        refused(text, &format!("a.toml {set}"), words);
    }
    // Too many names are shown where they stand, and no other name is asked for.
    let many: String = (0..1100).map(|number| format!("d{number} = \"x\"\n")).collect();
    let words = ["more than 1024 definitions", "a.toml:19:9", "write some of them out"];
    refused(format!("{TYPED}[system.define]\n{many}"), "a.toml", &words);
}

#[test]
fn advice_on_memory_fits_the_machine() {
    // Factors that the machine has not the memory for are no reason to raise a limit.
    let gigabytes = |text: &str, before: &str| -> Option<f64> {
        text.split_once(before)?.1.split_once(" GB")?.0.parse().ok()
    };
    let advice = |count: usize| -> Option<(f64, f64)> {
        let cells = format!("{{from=-5,to=5,count={count}}}");
        let room = Room::new();
        room.write("a.toml", GOOD);
        let told = room.run(&format!("check a.toml cells.x={cells} cells.y={cells}"));
        let need = gigabytes(&told.err, "factors need ");
        let (need, has) = need.zip(gigabytes(&told.err, "this machine has "))?;
        let is_advised = told.err.contains("raise `method.memory_limit`");
        assert_eq!(is_advised, need <= has, "{told:?}");
        Some((need, has))
    };
    // The matrices of a cell take 832 bytes, and what cannot hold them is refused before.
    if let Some((_, has)) = advice(4_000) {
        advice((0.995 * has * 1e9 / 832.0).sqrt() as usize);
    }
}

#[test]
fn points_that_did_not_converge_are_told_without_peaks() {
    let room = Room::new();
    room.write("a.toml", GOOD);
    let told = room.run("sweep a.toml method.solver_tolerance=1e-30 --out o figures.formats=[]");
    let lines: Vec<&str> = told
        .err
        .lines()
        .filter(|line| line.contains(" of "))
        .collect();
    assert!(
        lines.iter().any(|line| line.ends_with(": not-converged")),
        "{told:?}"
    );
    let is_silent = |line: &&str| !line.contains("not-converged") || !line.contains("peak");
    assert!(lines.iter().all(is_silent), "{told:?}");
}

#[test]
fn a_run_that_fails_at_its_first_value_leaves_nothing() {
    let line = "a.toml system.parameters.mu=-1e308 --quiet --out o";
    refused(GOOD, line, &["nothing was run or written"]);
}

#[test]
fn characters_that_only_look_right() {
    #[rustfmt::skip]
    let cases = [
        ("\"coulomb\"", "“coulomb”", "quotation mark of print"),
        ("from = -0.02", "from = −0.02", "not the minus sign of the keyboard"),
        ("to = 0.01", "to = 0,01", "a comma stands inside a number"),
        ("kappa = 0.01", "κ = 0.01", "did you mean `kappa`?"),
        ("kappa = 0.01", "\"κ\" = 0.01", "did you mean `kappa`?"),
        ("kappa = 0.01", "kappa = 0.01\n\"\u{b5}\" = 0.01", "did you mean `mu`?"),
        ("sigma2 = 0.01", "\"σ²\" = 0.01", "did you mean `sigma2`?"),
        ("parameter = \"f_c\"", "parameter = \"μ\"", "did you mean `mu`?"),
        ("points = 3", "points = 3;", "`;` stands behind a value"),
        ("points = 3", "points: 3", "write `=` between key and value"),
        ("to = 0.01", "to = 1/100", "`1/100` is a computation"),
        ("\"coulomb\"", "coulomb", "must be quoted"),
        ("kappa = 0.01", "kappa =", "`kappa` has no value"),
        // Cyrillic letters: in a key, in a name of the model, in one that is swept.
        ("kappa = 0.01", "k\u{430}ppa = 0.01", "`\u{430}` (U+0430) looks like `a`"),
        ("kappa = 0.01", "\"k\u{430}ppa\" = 0.01", "did you mean `kappa`? `\u{430}` (U+0430) looks like `a`"),
        ("parameter = \"f_c\"", "parameter = \"f_\u{441}\"", "did you mean `f_c`? `\u{441}` (U+0441) looks like `c`"),
    ];
    for (old, new, words) in cases {
        refused(GOOD.replacen(old, new, 1), "a.toml", &[words, "a.toml:"]);
    }
    for (old, new, place) in [
        ("c + x^2", "\u{441} + x^2", "a.toml:5:8"),
        ("y - x\"", "y - \u{445}\"", "a.toml:5:21"),
        ("c = 0.0", "c = 0.0\n\"\u{441}1\" = 0.0", "a.toml:10:1"),
        (
            "parameter = \"c\"",
            "parameter = \"\u{441}\"",
            "a.toml:12:13",
        ),
    ] {
        assert_eq!(TYPED.matches(old).count(), 1, "{old}");
        let words = [place, "looks like", "and is a letter of another alphabet"];
        refused(TYPED.replace(old, new), "a.toml", &words);
    }
}

#[test]
#[rustfmt::skip]
fn syntax_names_and_keys() {
    let (parameter, points) = ("parameter = \"f_c\"", "points = 3");
    let (kappa, sigma2) = ("kappa = 0.01", "sigma2 = 0.01");
    let y = "y = { from = -5, to = 5, count = 10 }";
    for (old, new, words) in [
        (points, "points = ", &["not valid TOML", "a.toml:11:"][..]),
        (points, "points = 3\npoints = 4", &["not valid TOML", "a.toml:12:1"]),
        // Unknown names come with the nearest.
        (sigma2, "sigma2 = 0.01\n[sweeep]", &["unknown key `sweeep`", "a.toml:7:2", "did you mean `sweep`?"]),
        (points, "points = 3\nstep = 0.1", &["unknown key `sweep.step`", "a.toml:12:1", "`parameter`, `from`, `to`, `points`"]),
        (points, "points = 3\nsamples = 10", &["unknown key `sweep.samples`", "did you mean `method.samples`?"]),
        ("model = \"coulomb\"", "model = \"coulom\"",
            &["`system.model` cannot be `coulom`", "a.toml:3:9", "`dahl`", "did you mean `coulomb`?"]),
        (kappa, "kappa = 0.01\nalhpa = 1.0", &["has no parameter `alhpa`", "a.toml:6:1", "did you mean `alpha`?"]),
        (parameter, "parameter = \"fc\"", &["has no parameter `fc`", "a.toml:8:13", "did you mean `f_c`?"]),
        (y, &format!("{y}\nz = {{ count = 4 }}"), &["has no axis `z`", "a.toml:15:1", "allowed: `x`, `y`"]),
        // Missing keys.
        ("kappa = 0.01\n", "", &["needs parameter `kappa`", "a.toml:4:9", "viscous damping"]),
        ("points = 3\n", "", &["missing key `sweep.points`", "a.toml:7:2"]),
        // What is swept is not given.
        (kappa, "kappa = 0.01\nf_c = 0.0", &["`f_c` is swept and also given", "a.toml:6:1", "remove it here"]),
    ] {
        assert_refused(GOOD, old, new, words);
    }
    let words = ["`system.model`", "`sweep.parameter`", "`sweep.from`", "`sweep.to`", "`sweep.points`"];
    refused("title = \"empty\"", "a.toml", &words);
}

#[test]
fn wrong_kinds_and_ranges() {
    let x = "x = { from = -5, to = 5, count = 10 }";
    #[rustfmt::skip]
    let cases = [
        ("points = 3", "points = 3.5", "an integer from 2 to"),
        ("points = 3", "points = \"3\"", "write the number without quotes: `3`"),
        ("points = 3", "points = \"three\"", "this is a string"),
        ("kappa = 0.01", "kappa = \"1e-2\"", "write the number without quotes: `1e-2`"),
        ("kappa = 0.01", "kappa = \".01\"", "write a digit before the point: `0.01`"),
        (x, "x = { from = -5, to = 5, modes = \"8\" }", "write the number without quotes: `8`"),
        ("[cells]", "[figures.style]\nwidth = \"90\"\n[cells]", "write the number without quotes: `90`"),
        ("points = 3", "points = 1", "`sweep.points` cannot be `1`"),
        ("kappa = 0.01", "kappa = nan", "a finite number"),
        ("kappa = 0.01", "kappa = inf", "a finite number"),
        ("kappa = 0.01", "kappa = true", "this is a boolean"),
        ("from = -0.02", "from = -inf", "a finite number"),
        ("sigma2 = 0.01", "sigma2 = 0", "a finite number greater than zero"),
        ("sigma2 = 0.01", "sigma2 = -1.0", "`sigma2` of model `coulomb` cannot be -1"),
        ("to = 0.01", "to = -0.02", "the same as `sweep.from`"),
        (x, "x = { from = -5, to = 5, count = 1 }", "`cells.x.count` cannot be `1`"),
        (x, "x = { from = 5, to = -5, count = 10 }", "empty or reversed"),
        (x, "x = { from = 5, to = 5, count = 10 }", "empty or reversed"),
        (x, "x = 10.5", "`cells.x` must be a table, or a whole number of cells"),
        (x, "x = [10]", "write [cells.x] on a line of its own"),
        ("[cells]", "[method]\nkind = \"monte-carol\"\n[cells]", "did you mean `monte-carlo`?"),
        ("[cells]", "[method]\nmap_step = \"atuo\"\n[cells]", "did you mean `\"auto\"`?"),
        ("[cells]", "[method]\nmap_step = -1\n[cells]", "greater than zero"),
        ("[cells]", "[method]\nseed = -1\n[cells]", "an integer, 0 or more"),
        ("[cells]", "[detect]\nconfidence = 1.0\n[cells]", "between 0 and 1"),
        ("[cells]", "[figures]\nformats = [\"svgg\"]\n[cells]", "did you mean `svg`?"),
        ("[cells]", "[figures]\nformats = \"svg\"\n[cells]", "did you mean `[\"svg\"]`?"),
        // A backspace, then "eta".
        ("\"trial\"", "\"$\\beta$\"", "a backslash between `\"` begins a code"),
    ];
    for (old, new, words) in cases {
        assert_refused(GOOD, old, new, &[words, "a.toml:"]);
    }
    // Switches and widths in other words.
    for (given, words) in [
        ("title = false", "did you mean `\"on\"` or `\"off\"`?"),
        ("letters = \"no\"", "did you mean `off`?"),
        ("width = \"84mm\"", "did you mean `84`?"),
        ("width = \"Singel\"", "did you mean `single`?"),
        ("width = 1e300", "figures 1e300 mm wide"),
    ] {
        let table = format!("[figures.style]\n{given}\n[cells]");
        assert_refused(GOOD, "[cells]", &table, &[words, "a.toml:13:"]);
    }
}

#[test]
fn parameters_stay_in_their_range_at_both_ends() {
    let text = GOOD.replace("\"f_c\"", "\"sigma2\"");
    let text = text.replace("sigma2 = 0.01", "f_c = 0.01");
    let range = "`sigma2` of model `coulomb` cannot be -0.02";
    refused(text, "a.toml", &[range, "a.toml:9:8", "1 error;"]);
    let text = r#"
[system]
model = "dahl"
parameters = { kappa = 0.02, mu = 1.0, lambda = 0.06, sigma2 = 0.02 }
[sweep]
parameter = "f_c"
from = 0.05
to = 0.0
points = 3
[cells]
x = { from = -2.5, to = 2.5, count = 10 }
y = { from = -2.5, to = 2.5, count = 10 }
z = { count = 4 }
"#;
    let end = "`f_c` of model `dahl` cannot be 0";
    refused(
        text,
        "a.toml",
        &[end, "a.toml:8:6", "greater than zero", "1 error;"],
    );
    let given = text.replace("parameter = \"f_c\"", "parameter = \"alpha\"");
    let given = given.replace("lambda = 0.06", "lambda = 0.06, f_c = -0.05");
    refused(given, "a.toml", &["`f_c` of model `dahl` cannot be -0.05"]);
}

#[test]
fn everything_wrong_is_reported_at_once() {
    let text = GOOD
        .replace("kappa = 0.01", "kapa = 0.01")
        .replace("points = 3", "points = 1")
        .replace("to = 0.01", "too = 0.01")
        .replace("x = { from = -5", "x = { from = 50");
    let words = [
        "has no parameter `kapa`",
        "needs parameter `kappa`",
        "`sweep.points` cannot be `1`",
        "unknown key `sweep.too`",
        "missing key `sweep.to`",
        "from 50 to 5, is empty",
        "unknown key `method.sample`",
        "7 errors",
    ];
    refused(text, "a.toml method.sample=3", &words);
}

#[test]
fn grids_that_do_not_fit_the_memory() {
    let huge = "{ from = -5, to = 5, count = 1000000 }";
    let text = GOOD.replace("{ from = -5, to = 5, count = 10 }", huge);
    let need = "1000000 × 1000000 cells need at least";
    refused(
        text,
        "a.toml",
        &[need, "TB of memory; this machine has", "`cells.x.count`"],
    );
}

#[test]
fn overrides_that_do_not_parse_or_do_not_fit() {
    for (set, words) in [
        ("sweep.points", "no `=` here"),
        ("=3", "an empty key"),
        ("sweep.points=", "no value behind `=`"),
        ("sweep.points=[3", "not valid TOML"),
        ("sweep.point=3", "did you mean `points`?"),
        ("sweep.points=many", "`sweep.points` cannot be `many`"),
        ("system.model=dhal", "did you mean `dahl`?"),
    ] {
        let line = format!("a.toml --set {set}");
        refused(GOOD, &line, &[words, "--set:1:", set, "1 error;"]);
    }
}

#[test]
#[rustfmt::skip]
fn equations_of_other_languages_and_of_other_scales() {
    let drift = "\"-(c + x^2) y - x\"";
    let noise = "\"sqrt(2 D)\"";
    let x = "x = { from = -3, to = 3, ";
    for (old, new, words) in [
        (drift, "\"-c x**2\"", &["found `*`", "a.toml:5:", "write ^ for a power"][..]),
        (drift, "\"c nan\"", &["unknown symbol `nan`", "finite numbers only"]),
        (drift, "\"c\u{200b} x\"", &["U+200B", "delete it"]),
        (drift, "'\\alpha c'", &["without a backslash"]),
        // An odd power of a negative number is one; it is too large.
        (drift, "\"-c y^1001\"", &["overflow in y^1001"]),
        (noise, "\"1e200\"", &["too strong", "a.toml:7:5", "other units"]),
        (noise, "\"1e-200\"", &["too weak", "a.toml:7:5", "other units"]),
        // One mistake is told once.
        (noise, "[[\"a\"]]", &["`system.noise.y` cannot be a list"]),
        ("c = 0.0", "c = 0.0\nk = \"1\"", &["`system.parameters.k` cannot be `1`"]),
        (x, "x = { range = [-3, 3], ", &["did you mean `from = -3.0, to = 3.0`?"]),
        (x, "x = { range = \"Auto\", ", &["did you mean `auto`?"]),
    ] {
        assert_refused(TYPED, old, new, words);
    }
    for (given, words) in [
        ("[\"1\", \"-1\"]", ["the bounds of `x`, from 1 to -1, hold no value", "the lower bound comes first"]),
        ("[-1, 1]", ["`x` does not stay within its bound -1", "[system.bounds]"]),
        ("[10, 20]", ["the cells of `x` hold no state", "overlap"]),
    ] {
        let bounds = format!("[system.bounds]\nx = {given}\n[system.parameters]");
        assert_refused(TYPED, "[system.parameters]", &bounds, &words);
    }
    // Beyond the bound that does not hold paths run away, before any domain is known.
    refused(RUNNING_AWAY, "a.toml", &["`x` does not stay within its bound -1", "a.toml:9:5"]);
    let text = TYPED.replace("[system.equations]", "[equations]");
    refused(text, "a.toml", &["did you mean `system.equations`?"]);
}

const RUNNING_AWAY: &str = r#"[system.equations]
x = "y"
y = "-0.2 y - x + x^3"
[system.noise]
y = "s"
[system.parameters]
s = 0.2
[system.bounds]
x = [-1, 1]
[sweep]
parameter = "s"
from = 0.1
to = 0.4
points = 4
"#;

#[test]
#[rustfmt::skip]
fn quantities_without_values() {
    for (table, words) in [
        ("[watch]\np = \"1/x\"", &["`p` has no mean", "next to x = ", "a.toml:17:1"][..]),
        ("[watch]\np = \"sqrt(x)\"", &["`p` has no mean"]),
        ("[watch]\np = \"1e300 y^2\"", &["`p` has no mean", "units"]),
        ("[watch]\np = true", &["a formula"]),
        ("[detect]\nmarginals = [\"H\"]", &["the system has no axis `H`", "a quantity needs its formula: `H = …`"]),
        ("[detect]\nmarginals = [\"x\", \"H = 1/x\"]", &["`H` is inf at x = 0", "a.toml:17:19"]),
        ("[detect]\nmarginals = [\"H = 1e-300 x\"]", &["too far from 1", "other units"]),
        ("[detect]\nmarginals = [\"H = x^2\"]\nbins = { H = { from = 100, to = 200 } }",
            &["no value of `H` lies in its bins", "goes from 0 to 9"]),
        // Given bins do not spare the formula.
        ("[detect]\nmarginals = [\"H = 1/x\"]\nbins = { H = { from = 1, to = 2 } }", &["`H` is inf at x = 0"]),
    ] {
        assert_refused(TYPED, "[cells]", &format!("{table}\n[cells]"), words);
    }
}

#[test]
fn output_that_is_no_folder_or_not_writable() {
    let room = Room::new();
    room.write("a.toml", GOOD);
    for out in ["a.toml", "a.toml/below"] {
        let words = ["is not a folder", "`a.toml` is a file", "--out DIR"];
        refused_in(&room, &format!("a.toml --out {out}"), &words);
    }
    // The default folder can be in the way of a file as well.
    room.write("output", "");
    let words = ["`output/a` is not a folder", "`output` is a file"];
    refused_in(&room, "a.toml", &words);
    // The kernel refuses folders there whoever asks, the administrator included.
    if cfg!(target_os = "linux") {
        let words = ["`/proc/pbif/run` cannot be made"];
        refused(GOOD, "a.toml --out /proc/pbif/run", &words);
        refused(
            GOOD,
            "a.toml --out /proc",
            &["`/proc` cannot be written to"],
        );
    }
}

#[test]
fn usage() {
    refused(GOOD, "", &["<FILE>"]);
    refused(GOOD, "a.toml --threads 0", &["--threads", "from 1 to"]);
    let similar = "similar argument exists: '--out'";
    refused(GOOD, "a.toml --outt b", &["--outt", similar]);
}

#[test]
fn ends_that_no_sweep_has_are_told_in_few_digits() {
    let told = refused(
        GOOD,
        "a.toml sweep.from=-1e308 sweep.to=1e308",
        &["f_c = -1e308: the rates along axis `y`", "use other units"],
    );
    assert!(told.lines().all(|line| line.len() < 200), "{told}");
}

#[cfg(unix)]
#[test]
fn a_sweep_file_that_is_a_link_to_nowhere_is_told_as_one() {
    let room = Room::new();
    std::os::unix::fs::symlink("nowhere.toml", room.path("a.toml")).unwrap();
    room.refused(
        "sweep a.toml",
        &["is a link that leads nowhere, to `nowhere.toml`"],
    );
}
