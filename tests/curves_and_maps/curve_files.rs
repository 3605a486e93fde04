//! Curves through the program: followed from rows of runs and from sweep files, kept apart, refused in words.

use super::curves::CUSP;
use super::support::off_the_fold;
use crate::common::room::Room;

/// A sweep file that follows its rows in a box of `a`.
fn with_curve(box_of_a: &str) -> String {
    format!("{CUSP}curve = {{ parameter = \"a\", {box_of_a} }}\n")
}

#[test]
#[rustfmt::skip]
fn the_program_follows_a_row_of_a_run_and_says_what_is_wrong() {
    let room = Room::new();
    room.write("cusp.toml", CUSP);
    // At its first value the system is symmetric, and at no other.
    room.done("sweep cusp.toml --out run --quiet sweep.from=0");
    let fold = |more: &str| format!("curve run --quiet --first-from -0.7 --first-to 0.7 {more}");
    let printed = room.done(&fold("--row PB1 --second a --from 0.2 --to 1.6"));
    printed.says(&["EP1", "border of the box in a"]);
    let table = room.read("run/curves/PB1-a/curves.csv");
    let columns = "curve,label,h,a,error,edge_h,edge_a,observable,method,indicator,";
    assert!(table.starts_with(columns), "{table}");
    for row in room.table("run/curves/PB1-a/curves.csv").0 {
        let [h, a, error] = row.numbers(["h", "a", "error"]);
        assert!(off_the_fold([h, a], [1.4, 1.4]).abs() <= error, "{row:?}");
    }
    room.holds_all(
        "run/curves/PB1-a",
        "curve.json figures/curve.svg figures/curve.png",
    );
    // The run is as it was, and a second curve keeps the first.
    room.done("verify run");
    room.done(&fold("--second a --from 0.2 --to 1.6 --step 0.1"));
    assert!(room.holds("run/curves/PB1-a/previous/1/curves.csv"));
    for (more, words) in [
        ("--row PB7 --second a --from 0 --to 2", "no P- or D-bifurcation `PB7`"),
        ("--second b --from 0 --to 2", "no parameter `b`"),
        ("--second h --from 0 --to 2", "the second parameter of the curve is the swept one"),
        ("--second a --from 1.2 --to 2", "the sweep holds `a` at 1, and the box of the curves goes from 1.2 to 2.0"),
        ("--second a --from 0.2 --to 1e308", "from 0.2 to 1e308: on so long a side that value is not told from others"),
        ("--second a --from 0.2 --to 1e4", "a side of at most 1000.0"),
        ("--second a --from 1 --to 1", "the box of the curves goes from 1 to 1 along `a`"),
        ("--second a --from x --to 1", "allowed: a number"),
    ] {
        room.refused(&fold(more), &[words]);
    }
    // A run of another version is not read.
    let version = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    room.change("run/run.json", &version, "\"version\": \"99.0.0\"");
    room.refused(&fold("--second a --from 0.2 --to 1.6"), &["99.0.0"]);
}

/// Density of exp(kx) where x has a cubic drift: its fold is at h = kb²/2 ± 2(a/3)^(3/2), b the strength of the noise.
const OF_A_FORMULA: &str = r#"
system.equations = { x = "h + a x - x^3" }
system.noise = { x = "0.5958" }
system.parameters = { h = 0.0, a = 0.508 }
sweep = { parameter = "h", from = -0.9, to = 0.9, points = 7 }
detect = { marginals = ["q = exp(0.462 x)"], joint = [] }
"#;

#[test]
fn a_fold_of_a_formula_is_within_its_errors_between_checks_too() {
    let room = Room::new();
    room.write("q.toml", OF_A_FORMULA);
    room.done("sweep q.toml --out run --quiet");
    room.done("curve run --row PB1 --second a --from 0.3 --to 1.3 --out curve --quiet");
    let centre = 0.5 * 0.462 * 0.5958 * 0.5958;
    let (mut located, mut points) = (0, 0);
    for row in room.table("curve/curves.csv").0 {
        let [h, a, error] = row.numbers(["h", "a", "error"]);
        // Across the curve, in sides of the box: h is swept over 1.8, a over 1.
        let half = 2.0 * (a / 3.0_f64).powf(1.5);
        let off = (h - centre).abs() - half;
        let (by_h, by_a) = (1.8, (a / 3.0).sqrt());
        let across = off.abs() / f64::hypot(by_h, by_a);
        points += 1;
        if &row["status"] == "located" {
            located += 1;
            assert!(across <= error + 1e-9, "{a}: {across:e} beyond {error:e}");
        }
    }
    assert!(2 * located > points, "{located} of {points}");
}

#[test]
#[rustfmt::skip]
fn a_sweep_file_names_the_curves_that_its_sweep_is_followed_by() {
    let room = Room::new();
    let corners = "from = 1.6, to = 0.2, first_from = -0.7, first_to = 0.7";
    room.write("cusp.toml", with_curve(corners));
    let sweep = "sweep cusp.toml --quiet --out run";
    room.done(sweep).says(&["border of the box in a"]);
    let followed = room.read("run/curves/PB1-a/curves.csv");
    room.done("verify run");
    // The same by the command that says it, and by the one that leaves it to the file.
    for more in ["--row PB1 --second a --from 0.2 --to 1.6", ""] {
        room.done(&format!("curve run --quiet --out again {more}"));
        assert!(room.read("again/curves.csv") == followed, "{more}");
        std::fs::remove_dir_all(room.path("again")).unwrap();
    }
    // Complete, nothing is solved.
    let again = room.run(&format!("{sweep} --resume")).text();
    assert_eq!(again.matches("nothing was solved").count(), 2, "{again}");
    let outside = "the sweep holds `a` at 1, and the box of the curves goes from 0.2 to 0.9";
    for (setting, words) in [
        ("curve.parameter=b", "no parameter `b`"),
        ("curve.parameter=h", "the second parameter of the curve is the swept one"),
        ("curve.from=0.9", outside),
        ("curve.first_to=-0.7", "goes from -0.7 to -0.7 along `h`"),
        ("curve.step=0.5", "from 0.0001 to 0.25"),
        ("curve.rows=[\"PB7\"]", "the sweep has no P- or D-bifurcation `PB7`"),
        ("curve.second=a", "unknown key `curve.second`"),
        ("map.parameter=a", "a file has `[map]` or `[curve]`, not both"),
    ] {
        room.refused(&format!("{sweep} {setting}"), &[words]);
    }
    room.write("cusp.toml", with_curve("from = 0.2"));
    room.run(sweep).says(&["missing key `curve.to`"]);
    room.write("cusp.toml", CUSP);
    for (more, words) in [
        ("", "which is the second parameter of the plane?"),
        ("--second a --from 0.2", "missing key `curve.to`"),
    ] {
        room.refused(&format!("curve cusp.toml --quiet {more}"), &[words]);
    }
}

#[test]
fn curves_of_another_section_or_run_are_kept_apart_from_the_new_ones() {
    let room = Room::new();
    room.write("cusp.toml", with_curve("from = 0.8, to = 1.2, step = 0.1"));
    let sweep = |more: &str| room.done(&format!("sweep cusp.toml --out run {more}"));
    let end = |name: &str| room.json(&format!("{name}/curve.json"))["box"][1]["to"].as_f64();
    let to = |run: &str| end(&format!("{run}/curves/PB1-a"));
    // Two shards put together follow the curves of their file; the same again solves nothing.
    for shard in ["1/2", "2/2"] {
        sweep(&format!("--shard {shard} --quiet"));
    }
    room.done("merge run --quiet");
    assert_eq!(to("run"), Some(1.2));
    let again = room.done("merge run").text();
    assert_eq!(again.matches("nothing was solved").count(), 2, "{again}");
    // Another section: the run stays, and its curves are followed anew beside the earlier ones.
    let words = ["is complete: nothing was solved", "1.2", "followed anew"];
    sweep("--resume curve.to=1.1").says(&words);
    assert_eq!(to("run"), Some(1.1));
    assert_eq!(end("run/curves/PB1-a/previous/1"), Some(1.2));
    // Drawn again they are the same rows; with other settings, rows may be others.
    room.done("detect run figures.at=[0.3] --quiet");
    assert_eq!((to("run"), to("run/previous/1")), (Some(1.1), Some(1.1)));
    room.done("detect run detect.confidence=0.9 --quiet");
    assert!(!room.holds("run/curves"));
    assert_eq!(to("run/previous/2"), Some(1.1));
    // A new run has none but its own.
    sweep("sweep.points=9 --quiet");
    assert_eq!(to("run"), Some(1.2));
    room.write("cusp.toml", CUSP);
    sweep("--quiet");
    assert!(!room.holds("run/curves"));
    assert_eq!(to("run/previous/4"), Some(1.2));
}

#[test]
fn a_sweep_file_without_a_row_to_follow_says_so() {
    let room = Room::new();
    let text = "[system.equations]\nx = \"-x - a x^3\"\n[system.noise]\nx = \"sqrt(2 D)\"\n\
                [system.parameters]\nD = 0.2\na = 1\n[sweep]\nparameter = \"D\"\nfrom = 0.2\nto = 0.3\npoints = 3\n\
                [curve]\nparameter = \"a\"\nfrom = 0.5\nto = 1.5\n";
    room.write("one.toml", text);
    let printed = room.run("curve one.toml --out curve").ends(1);
    printed.says(&["no row in the box was located"]);
    assert!(!room.holds("curve"));
}
