//! Bad input, driven as a user would: exit code 2, a message that names place, cause and remedy, nothing written.

use std::path::Path;

use std::process::Command;

const GOOD: &str = r#"title = "trial"
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

/// Runs `pbif sweep` in an empty folder that holds `a.toml`, and returns stderr. Checks that it ends with code 2,
/// prints nothing on stdout, and leaves the folder as it was.
fn refused(text: &str, arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), text).unwrap();
    refused_in(folder.path(), arguments)
}

fn refused_in(folder: &Path, arguments: &[&str]) -> String {
    let before = names(folder);
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    let output = command.current_dir(folder).arg("sweep").args(arguments);
    let output = output.output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty());
    assert!(!message.contains('\u{1b}'), "escape codes off a terminal");
    assert_eq!(names(folder), before, "something was written");
    message
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.unwrap().file_name().into_string().unwrap()
    };
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

fn assert_says(message: &str, words: &[&str]) {
    for words in words {
        assert!(message.contains(words), "`{words}` not in\n{message}");
    }
}

/// The good file with one piece of text replaced must be refused in these words, and for one reason.
fn assert_refused(old: &str, new: &str, words: &[&str]) {
    assert_eq!(GOOD.matches(old).count(), 1, "{old} is not unique");
    let message = refused(&GOOD.replace(old, new), &["a.toml"]);
    assert_says(&message, words);
    assert_says(&message, &["1 error;"]);
}

#[test]
fn missing_files_and_files_that_are_no_text() {
    assert_says(
        &refused(GOOD, &["b.toml"]),
        &["cannot read the sweep file `b.toml`"],
    );
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), [0xff, 0xfe]).unwrap();
    assert_says(&refused_in(folder.path(), &["a.toml"]), &["not UTF-8"]);
}

#[test]
fn files_that_no_sweep_file_is_like() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.toml");
    // Too long: what its beginning shows is told too, and no more than fits a screen or two.
    let many = |line: &str, count: usize| format!("{GOOD}{}", line.repeat(count));
    std::fs::write(&file, many("stranger = 1\n[zzz]\n", 100_000)).unwrap();
    let message = refused_in(folder.path(), &["a.toml"]);
    assert_says(&message, &["larger than 1 MB", "not valid TOML"]);
    std::fs::write(&file, many("= = =\n", 100_000)).unwrap();
    let message = refused_in(folder.path(), &["a.toml"]);
    assert_says(
        &message,
        &["not valid TOML", "and 99980 more", "100000 errors;"],
    );
    assert!(message.len() < 20_000, "{}", message.len());
    std::fs::write(&file, b"title = \"caf\xe9\"\n").unwrap();
    let message = refused_in(folder.path(), &["a.toml"]);
    assert_says(&message, &["not UTF-8", "a.toml:1:13", "Latin-1"]);
    let utf16: Vec<u8> = GOOD.encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::fs::write(&file, utf16).unwrap();
    let message = refused_in(folder.path(), &["a.toml"]);
    assert_says(&message, &["UTF-16, not UTF-8", "save it as UTF-8"]);
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
    ];
    for (old, new, words) in cases {
        let message = refused(&GOOD.replacen(old, new, 1), &["a.toml"]);
        assert_says(&message, &[words, "a.toml:"]);
    }
}

#[test]
fn syntax() {
    assert_refused("points = 3", "points = ", &["not valid TOML", "a.toml:11:"]);
    assert_refused(
        "points = 3",
        "points = 3\npoints = 4",
        &["not valid TOML", "a.toml:12:1"],
    );
}

#[test]
#[rustfmt::skip]
fn unknown_names_come_with_the_nearest() {
    assert_refused("sigma2 = 0.01", "sigma2 = 0.01\n[sweeep]",
        &["unknown key `sweeep`", "a.toml:7:2", "did you mean `sweep`?"]);
    assert_refused("points = 3", "points = 3\nstep = 0.1",
        &["unknown key `sweep.step`", "a.toml:12:1", "`parameter`, `from`, `to`, `points`"]);
    assert_refused("points = 3", "points = 3\nsamples = 10",
        &["unknown key `sweep.samples`", "did you mean `method.samples`?"]);
    assert_refused("model = \"coulomb\"", "model = \"coulom\"",
        &["`system.model` cannot be `coulom`", "a.toml:3:9", "`dahl`", "did you mean `coulomb`?"]);
    assert_refused("kappa = 0.01", "kappa = 0.01\nalhpa = 1.0",
        &["has no parameter `alhpa`", "a.toml:6:1", "did you mean `alpha`?"]);
    assert_refused("parameter = \"f_c\"", "parameter = \"fc\"",
        &["has no parameter `fc`", "a.toml:8:13", "did you mean `f_c`?"]);
    assert_refused("y = { from = -5, to = 5, count = 10 }", "y = { from = -5, to = 5, count = 10 }\nz = { count = 4 }",
        &["has no axis `z`", "a.toml:15:1", "allowed: `x`, `y`"]);
}

#[test]
fn missing_keys() {
    assert_refused(
        "kappa = 0.01\n",
        "",
        &["needs parameter `kappa`", "a.toml:4:9", "viscous damping"],
    );
    assert_refused(
        "points = 3\n",
        "",
        &["missing key `sweep.points`", "a.toml:7:2"],
    );
    assert_refused(
        "y = { from = -5, to = 5, count = 10 }",
        "y = { to = 5, count = 10 }",
        &["missing key `cells.y.from`", "a.toml:14:1"],
    );
    assert_says(
        &refused("title = \"empty\"", &["a.toml"]),
        &[
            "`system.model`",
            "`sweep.parameter`",
            "`sweep.from`",
            "`sweep.to`",
            "`sweep.points`",
        ],
    );
}

#[test]
fn wrong_kinds_and_ranges() {
    #[rustfmt::skip]
    let cases = [
        ("points = 3", "points = 3.5", "an integer from 2 to"),
        ("points = 3", "points = \"3\"", "write the number without quotes: `3`"),
        ("points = 3", "points = \"three\"", "this is a string"),
        ("kappa = 0.01", "kappa = \"1e-2\"", "write the number without quotes: `1e-2`"),
        ("x = { from = -5, to = 5, count = 10 }", "x = { from = -5, to = 5, modes = \"8\" }", "write the number without quotes: `8`"),
        ("[cells]", "[figures.style]\nwidth = \"90\"\n[cells]", "write the number without quotes: `90`"),
        ("points = 3", "points = 1", "`sweep.points` cannot be `1`"),
        ("kappa = 0.01", "kappa = nan", "a finite number"),
        ("kappa = 0.01", "kappa = inf", "a finite number"),
        ("kappa = 0.01", "kappa = true", "this is a boolean"),
        ("from = -0.02", "from = -inf", "a finite number"),
        ("sigma2 = 0.01", "sigma2 = 0", "a finite number greater than zero"),
        ("sigma2 = 0.01", "sigma2 = -1.0", "`sigma2` of model `coulomb` cannot be -1"),
        ("to = 0.01", "to = -0.02", "the same as `sweep.from`"),
        ("x = { from = -5, to = 5, count = 10 }", "x = { from = -5, to = 5, count = 1 }", "`cells.x.count` cannot be `1`"),
        ("x = { from = -5, to = 5, count = 10 }", "x = { from = 5, to = -5, count = 10 }", "empty or reversed"),
        ("x = { from = -5, to = 5, count = 10 }", "x = { from = 5, to = 5, count = 10 }", "empty or reversed"),
        ("x = { from = -5, to = 5, count = 10 }", "x = 10", "`cells.x` must be a table"),
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
        assert_refused(old, new, &[words, "a.toml:"]);
    }
}

#[test]
fn the_swept_parameter_is_not_given_and_stays_in_its_range() {
    assert_refused(
        "kappa = 0.01",
        "kappa = 0.01\nf_c = 0.0",
        &[
            "`f_c` is swept and also given",
            "a.toml:6:1",
            "remove it here",
        ],
    );
    let text = GOOD
        .replace("\"f_c\"", "\"sigma2\"")
        .replace("sigma2 = 0.01", "f_c = 0.01");
    let message = refused(&text, &["a.toml"]);
    assert_says(
        &message,
        &[
            "`sigma2` of model `coulomb` cannot be -0.02",
            "a.toml:9:8",
            "1 error;",
        ],
    );
}

#[test]
fn dahl_needs_positive_friction_at_both_ends() {
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
    let words = [
        "`f_c` of model `dahl` cannot be 0",
        "a.toml:8:6",
        "greater than zero",
        "1 error;",
    ];
    assert_says(&refused(text, &["a.toml"]), &words);
    let given = text
        .replace("parameter = \"f_c\"", "parameter = \"alpha\"")
        .replace("lambda = 0.06", "lambda = 0.06, f_c = -0.05");
    assert_says(
        &refused(&given, &["a.toml"]),
        &["`f_c` of model `dahl` cannot be -0.05"],
    );
}

#[test]
fn everything_wrong_is_reported_at_once() {
    let text = GOOD
        .replace("kappa = 0.01", "kapa = 0.01")
        .replace("points = 3", "points = 1")
        .replace("to = 0.01", "too = 0.01")
        .replace("x = { from = -5", "x = { from = 50");
    let message = refused(&text, &["a.toml", "--set", "method.sample=3"]);
    assert_says(
        &message,
        &[
            "has no parameter `kapa`",
            "needs parameter `kappa`",
            "`sweep.points` cannot be `1`",
            "unknown key `sweep.too`",
            "missing key `sweep.to`",
            "from 50 to 5, is empty",
            "unknown key `method.sample`",
            "7 errors",
        ],
    );
}

#[test]
fn grids_that_do_not_fit_the_memory() {
    let huge = "{ from = -5, to = 5, count = 1000000 }";
    let text = GOOD.replace("{ from = -5, to = 5, count = 10 }", huge);
    let message = refused(&text, &["a.toml"]);
    assert_says(
        &message,
        &[
            "1000000 × 1000000 cells need at least",
            "TB of memory; this machine has",
            "`cells.x.count`",
        ],
    );
}

#[test]
fn overrides_that_do_not_parse_or_do_not_fit() {
    let cases = [
        ("sweep.points", "no `=` here"),
        ("=3", "an empty key"),
        ("sweep.points=", "no value behind `=`"),
        ("sweep.points=[3", "not valid TOML"),
        ("sweep.point=3", "did you mean `points`?"),
        ("sweep.points=many", "`sweep.points` cannot be `many`"),
        ("system.model=dhal", "did you mean `dahl`?"),
    ];
    for (set, words) in cases {
        let message = refused(GOOD, &["a.toml", "--set", set]);
        assert_says(&message, &[words, "--set:1:", set, "1 error;"]);
    }
}

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

/// The typed system with one piece of text replaced must be refused in these words, and for one reason.
fn assert_typed_refused(old: &str, new: &str, words: &[&str]) {
    assert_eq!(TYPED.matches(old).count(), 1, "{old} is not unique");
    let message = refused(&TYPED.replace(old, new), &["a.toml"]);
    assert_says(&message, words);
    assert_says(&message, &["1 error;"]);
}

#[test]
#[rustfmt::skip]
fn equations_of_other_languages_and_of_other_scales() {
    let drift = "\"-(c + x^2) y - x\"";
    let noise = "\"sqrt(2 D)\"";
    let bounds = |text: &str| format!("[system.bounds]\nx = {text}\n[system.parameters]");
    let cases = [
        (drift, "\"-c x**2\"", vec!["found `*`", "a.toml:5:", "write ^ for a power"]),
        (drift, "\"c nan\"", vec!["unknown symbol `nan`", "finite numbers only"]),
        (drift, "\"c\u{200b} x\"", vec!["U+200B", "delete it"]),
        (drift, "'\\alpha c'", vec!["without a backslash"]),
        // An odd power of a negative number is one; it is too large.
        (drift, "\"-c y^1001\"", vec!["overflow in y^1001"]),
        (noise, "\"1e200\"", vec!["too strong", "a.toml:7:5", "other units"]),
        (noise, "\"1e-200\"", vec!["too weak", "a.toml:7:5", "other units"]),
        // One mistake is told once.
        (noise, "[[\"a\"]]", vec!["`system.noise.y` cannot be a list"]),
        ("c = 0.0", "c = 0.0\nk = \"1\"", vec!["`system.parameters.k` cannot be `1`"]),
        ("x = { from = -3, to = 3, ", "x = { range = [-3, 3], ", vec!["did you mean `from = -3.0, to = 3.0`?"]),
        ("x = { from = -3, to = 3, ", "x = { range = \"Auto\", ", vec!["did you mean `auto`?"]),
    ];
    for (old, new, words) in cases {
        assert_typed_refused(old, new, &words);
    }
    for (given, words) in [
        ("[\"1\", \"-1\"]", ["the bounds of `x`, from 1 to -1, hold no value", "the lower bound comes first"]),
        ("[-1, 1]", ["`x` does not stay within its bound -1", "[system.bounds]"]),
        ("[10, 20]", ["the cells of `x` hold no state", "overlap"]),
    ] {
        assert_typed_refused("[system.parameters]", &bounds(given), &words);
    }
    let message = refused(&TYPED.replace("[system.equations]", "[equations]"), &["a.toml"]);
    assert_says(&message, &["did you mean `system.equations`?"]);
}

#[test]
#[rustfmt::skip]
fn quantities_without_values() {
    let with = |table: &str| format!("{table}\n[cells]");
    let cases = [
        ("[watch]\np = \"1/x\"", vec!["`p` has no mean", "next to x = ", "a.toml:17:1"]),
        ("[watch]\np = \"sqrt(x)\"", vec!["`p` has no mean"]),
        ("[watch]\np = \"1e300 y^2\"", vec!["`p` has no mean", "units"]),
        ("[watch]\np = true", vec!["a formula"]),
        ("[detect]\nmarginals = [\"H\"]", vec!["the system has no axis `H`", "a quantity needs its formula: `H = …`"]),
        ("[detect]\nmarginals = [\"x\", \"H = 1/x\"]", vec!["`H` is inf at x = 0", "a.toml:17:19"]),
        ("[detect]\nmarginals = [\"H = 1e-300 x\"]", vec!["too far from 1", "other units"]),
        ("[detect]\nmarginals = [\"H = x^2\"]\nbins = { H = { from = 100, to = 200 } }",
            vec!["no value of `H` lies in its bins", "goes from 0 to 9"]),
        // Given bins do not spare the formula.
        ("[detect]\nmarginals = [\"H = 1/x\"]\nbins = { H = { from = 1, to = 2 } }", vec!["`H` is inf at x = 0"]),
    ];
    for (table, words) in cases {
        assert_typed_refused("[cells]", &with(table), &words);
    }
}

#[test]
fn switches_and_widths_in_other_words() {
    for (given, words) in [
        ("title = false", "did you mean `\"on\"` or `\"off\"`?"),
        ("letters = \"no\"", "did you mean `off`?"),
        ("width = \"84mm\"", "did you mean `84`?"),
        ("width = \"Singel\"", "did you mean `single`?"),
        ("width = 1e300", "figures 1e300 mm wide"),
    ] {
        let table = format!("[figures.style]\n{given}\n[cells]");
        assert_refused("[cells]", &table, &[words, "a.toml:13:"]);
    }
}

#[test]
fn output_that_is_no_folder_or_not_writable() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.toml"), GOOD).unwrap();
    for out in ["a.toml", "a.toml/below"] {
        let message = refused_in(folder.path(), &["a.toml", "--out", out]);
        assert_says(
            &message,
            &["is not a folder", "`a.toml` is a file", "--out DIR"],
        );
    }
    // The default folder can be in the way of a file as well.
    std::fs::write(folder.path().join("output"), "").unwrap();
    let message = refused_in(folder.path(), &["a.toml"]);
    assert_says(
        &message,
        &["`output/a` is not a folder", "`output` is a file"],
    );
}

/// The kernel refuses folders there whoever asks, the administrator included.
#[cfg(target_os = "linux")]
#[test]
fn output_that_cannot_be_made() {
    let message = refused(GOOD, &["a.toml", "--out", "/proc/pbif/run"]);
    assert_says(&message, &["`/proc/pbif/run` cannot be made"]);
    let message = refused(GOOD, &["a.toml", "--out", "/proc"]);
    assert_says(&message, &["`/proc` cannot be written to"]);
}

#[test]
fn usage() {
    assert_says(&refused(GOOD, &[]), &["<FILE>"]);
    assert_says(
        &refused(GOOD, &["a.toml", "--threads", "0"]),
        &["--threads", "from 1 to"],
    );
    assert_says(
        &refused(GOOD, &["a.toml", "--outt", "b"]),
        &["--outt", "similar argument exists: '--out'"],
    );
}

/// Numbers that look random and are the same everywhere.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound.max(1) as u64) as usize
    }
}

/// Pieces that sweep files are made of, and some that they are not.
const PIECES: [&str; 24] = [
    "1e308",
    "-1",
    "nan",
    "inf",
    "0",
    "1e-320",
    "99999999999999999999",
    "\"\"",
    "[]",
    "{}",
    "= ",
    "[[",
    "]]",
    "\n[cells]\n",
    "\nmodel = \"dahl\"\n",
    "\"auto\"",
    "x",
    "sigma2",
    "((((",
    "sqrt(",
    "^",
    "\u{3b1}",
    "\u{0}",
    "'''",
];

/// A text with a few things changed in it: pieces put in, characters lost, lines doubled, lost or exchanged, the end
/// cut off.
fn changed(text: &str, numbers: &mut Numbers) -> String {
    let mut letters: Vec<char> = text.chars().collect();
    for _ in 0..=numbers.below(3) {
        let place = numbers.below(letters.len() + 1).min(letters.len());
        let end = (place + numbers.below(12)).min(letters.len());
        match numbers.below(6) {
            0 => drop(letters.splice(place..end, PIECES[numbers.below(PIECES.len())].chars())),
            1 => drop(letters.splice(place..place, PIECES[numbers.below(PIECES.len())].chars())),
            2 => drop(letters.drain(place..end)),
            3 => letters.truncate(letters.len() - numbers.below(letters.len() / 2 + 1)),
            _ => {
                let whole: String = letters.iter().collect();
                let mut lines: Vec<&str> = whole.lines().collect();
                let (one, other) = (numbers.below(lines.len()), numbers.below(lines.len()));
                match numbers.below(3) {
                    _ if lines.is_empty() => {}
                    0 => lines.swap(one, other),
                    1 => lines.insert(one, lines[other]),
                    _ => drop(lines.remove(one)),
                }
                letters = (lines.join("\n") + "\n").chars().collect();
            }
        }
    }
    letters.into_iter().collect()
}

#[test]
fn five_thousand_changed_sweep_files_are_read_or_refused_and_never_panic() {
    let sweeps = Path::new(env!("CARGO_MANIFEST_DIR")).join("sweeps");
    let mut texts = vec![GOOD.to_owned()];
    for folder in [sweeps.clone(), sweeps.join("gallery")] {
        let mut files: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        files.sort();
        files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
        texts.extend(
            files
                .iter()
                .map(|path| std::fs::read_to_string(path).unwrap()),
        );
    }
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let (mut read, mut refused) = (0, 0);
    for case in 0..5000 {
        let text = changed(&texts[case % texts.len()], &mut numbers);
        match pbif::sweep_file::SweepFile::parse("a.toml", &text).validate() {
            Ok(_) => read += 1,
            Err(report) => {
                // What is wrong is said, in a bounded number of words.
                let words = report.render(false);
                assert!(!words.is_empty() && words.len() < 60_000, "{text}\n{words}");
                refused += 1;
            }
        }
    }
    assert!(
        read > 200 && refused > 2000,
        "{read} read, {refused} refused"
    );
}
