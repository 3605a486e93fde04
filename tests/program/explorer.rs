//! The explorer through the real binary: the page of a stored run, read back by the page's own code where Node.js is
//! installed and shown by a browser where Chromium is. Both tests say when they skip.

use std::path::{Path, PathBuf};
use std::process::Command;

use base64::Engine as _;
use pbif::cancellation::Cancellation;
use pbif::run::StoredRun;
use pbif::sweep_file::SweepFile;

use crate::common::room::{Room, shipped};
use crate::common::table::Table;

/// A small run of `coulomb_fc` in the folder `run`, and its page.
fn explored(room: &Room) -> PathBuf {
    let cells = "cells.x.count=30 cells.y.count=30";
    let settings = format!("sweep.points=7 {cells} locate.grid_check=off locate.tolerance=1e-3");
    room.run(&format!(
        "sweep sweeps/coulomb_fc.toml --quiet --out run {settings}"
    ));
    let printed = room.done("explore run --html pages/page.html");
    printed.says(&["pages/page.html", "MB"]);
    room.path("pages/page.html")
}

/// Whether a program can be started.
fn has(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok()
}

/// Runs what the page's own sources make of a page, up to a body that returns what is wanted.
const BEFORE: &str = r"
const fs = require('fs');
const [page, ...sources] = process.argv.slice(2);
const html = fs.readFileSync(page, 'utf8');
const document = { getElementById: (id) => ({ textContent: html.split(`id=\x22${id}\x22>`)[1].split('</script>')[0] }) };
const code = sources.map((name) => fs.readFileSync(name, 'utf8')).join('');
const run = new Function('document', 'fromNode', `${code}
  return (async () => {
";

/// After that body.
const AFTER: &str = r"
  })();`);
run(document).then((found) => process.stdout.write(JSON.stringify(found)));
";

/// What Node.js makes of a page by such a body, after some of the page's own sources.
fn read_by_page(room: &Room, page: &Path, sources: &[&str], body: &str) -> serde_json::Value {
    room.write("read.cjs", format!("{BEFORE}{body}{AFTER}"));
    let folder = shipped("src/explore/page");
    let output = Command::new("node")
        .arg(room.path("read.cjs"))
        .arg(page)
        .args(sources.iter().map(|name| folder.join(format!("{name}.js"))))
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The stored densities, as they are unpacked.
const READ: &str = r"
    const bytes = await readBlock('scene');
    const told = JSON.parse(new TextDecoder().decode(bytes));
    const found = { arrays: [] };
    for (const arrays of told.arrays) {
      const at = arrays.frames.map((index) => told.frames[index].value);
      const block = 'block-' + arrays.values.block;
      const packed = new Packed(arrays.values, await readBlock(block), at);
      found.arrays.push({ top: arrays.values.top, frames: at.map((_, i) => Array.from(packed.frame(i))) });
    }
    return found;
";

/// The columns of numbers along the sweep, as the page's own sources make them.
const NUMBERS: &str = r"
    const told = JSON.parse(new TextDecoder().decode(await readBlock('scene')));
    const columns = columnsOf(told, told.frames);
    const found = Object.fromEntries(columns.map((one) => [one.name, seriesOf(one, told.frames)]));
    const first = firstColumn(told, columns).name;
    const ranges = Object.fromEntries(columns.map((one) => [one.name, rangeOf(found[one.name], (value) => value)]));
    return { first, found, ranges };
";

/// A number along the sweep is what the table of points has, with its error; the axis holds it.
#[test]
fn the_numbers_along_the_sweep_are_those_of_the_table() {
    if !has("node") {
        eprintln!("skipped: Node.js is not installed");
        return;
    }
    let room = Room::new();
    let passage = "passage.out={start={x=0},until=\"abs(x)>1.5\"}";
    room.solved(&format!(
        "sweep sweeps/bistable.toml --quiet --out run sweep.points=7 cells.x.count=60 '{passage}'"
    ));
    room.done("explore run --html page.html");
    let sources = ["unpack", "numbers", "along"];
    let page = read_by_page(&room, &room.path("page.html"), &sources, NUMBERS);
    // What was asked for stands first.
    assert_eq!(page["first"], "out_mean");
    let table = room.table("run/points.csv").0;
    for name in ["out_mean", "out_rate", "sd_x", "mean_x"] {
        let series = page["found"][name].as_array().unwrap();
        assert_eq!(series.len(), table.len(), "{name}");
        let of = |one: &serde_json::Value, key: &str| one[key].as_f64().unwrap();
        let [low, high] = [0, 1].map(|end| page["ranges"][name][end].as_f64().unwrap());
        for one in series {
            let row =
                |row: &&crate::common::table::Row| (row.number("a") - of(one, "at")).abs() < 1e-12;
            let row = table.iter().find(row).unwrap();
            let [value, error] =
                [name.to_owned(), format!("{name}_error")].map(|column| row.number(&column));
            assert_eq!(
                [of(one, "value"), of(one, "error")],
                [value, error],
                "{name}"
            );
            assert!(
                low < value && value < high,
                "{name}: {value} in {low} to {high}"
            );
        }
    }
}

#[test]
fn the_code_of_the_page_reads_the_stored_densities() {
    if !has("node") {
        eprintln!("skipped: Node.js is not installed");
        return;
    }
    let room = Room::new();
    let page = explored(&room);
    let read = read_by_page(&room, &page, &["unpack"], READ);

    let run = StoredRun::open(&room.path("run")).unwrap();
    let settings = SweepFile::parse("run.json", run.resolved())
        .validate()
        .unwrap();
    let sweep = settings.prepare(&Cancellation::new()).unwrap();
    let subject = sweep.problem.subject();
    let space = (sweep.problem.space(), sweep.problem.bins());
    let points = run.points(subject, space, &["generator"]).unwrap();
    let with_density = || points.iter().filter(|point| !point.densities.is_empty());
    for (k, arrays) in read["arrays"].as_array().unwrap().iter().enumerate() {
        let top = arrays["top"].as_f64().unwrap();
        // Marginals have 2⁻²⁴ of the largest value; of a joint density the square root has 2⁻¹⁴.
        let is_marginal = subject.observables[k].axes().len() == 1;
        let tolerance = if is_marginal { 1e-7 } else { 7e-5 };
        for (frame, point) in arrays["frames"]
            .as_array()
            .unwrap()
            .iter()
            .zip(with_density())
        {
            let frame: Vec<f64> = serde_json::from_value(frame.clone()).unwrap();
            for (value, stored) in frame.iter().zip(&point.densities[k].density.values) {
                assert!(
                    (value - stored).abs() <= tolerance * top,
                    "{value} {stored}"
                );
            }
        }
    }
}

#[test]
fn a_browser_shows_the_page_from_disk() {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let Some(browser) = names.into_iter().find(|name| has(name)) else {
        eprintln!("skipped: Chromium is not installed");
        return;
    };
    let room = Room::new();
    let page = explored(&room);
    let once = |state: &str| {
        let options = "--headless --no-sandbox --disable-gpu --virtual-time-budget=4000 --dump-dom";
        let mut browser = Command::new(browser);
        browser.args(options.split(' '));
        browser.arg(format!(
            "--user-data-dir={}",
            room.path("profile").display()
        ));
        browser.arg(format!("file://{}#{state}", page.display()));
        String::from_utf8(browser.output().unwrap().stdout).unwrap()
    };
    // On a busy machine the browser's clock may run out before the page has read its data.
    let shown = |state: &str| {
        let tries = (0..8).map(|_| once(state));
        let mut ready = tries.filter(|shown| shown.contains("data-ready=\"true\""));
        ready.next().expect("the script did not run to its end")
    };
    let at_end = shown("f_c=0.01&pin=-0.02");
    for (words, wrong) in [
        (
            "f_c = 0.01: p(x) 1 peak; p(ẋ) 1 peak",
            "what is seen is not said",
        ),
        ("Hellinger distance", "the pinned state is not compared"),
    ] {
        assert!(at_end.contains(words), "{wrong}");
    }
    // What an address says wrongly changes nothing.
    let odd = shown("f_c=much&pin=NaN&joint=7&theme=loud");
    assert!(odd.contains("aria-live=\"polite\">f_c = "));
}

/// What a page is told.
fn told(page: &Path) -> serde_json::Value {
    scene(&std::fs::read_to_string(page).unwrap())
}

/// The same of the text of a page.
pub(super) fn scene(html: &str) -> serde_json::Value {
    let packed = html.split("id=\"scene\">").nth(1).unwrap();
    let packed = packed.split("</script>").next().unwrap();
    let engine = base64::engine::general_purpose::STANDARD;
    let packed = engine.decode(packed).unwrap();
    let told = miniz_oxide::inflate::decompress_to_vec_zlib(&packed).unwrap();
    serde_json::from_slice(&told).unwrap()
}

/// The points of the curves of a plane over h and a are the numbers of a table, to the last digit.
fn assert_curves_are_those_of(table: Table, found: &serde_json::Value) {
    let curves = found["curves"].as_array().unwrap().iter();
    let points = curves.flat_map(|curve| curve["points"].as_array().unwrap());
    let points: Vec<&serde_json::Value> = points.collect();
    assert!(table.0.len() > 20 && table.0.len() == points.len());
    for (row, point) in table.0.iter().zip(points) {
        let wanted = row.numbers(["h", "a", "error", "edge_h", "edge_a"]);
        let found = [0, 1, 2, 3, 4].map(|k| point[k].as_f64().unwrap());
        assert_eq!(found, wanted);
    }
}

/// The states of a page of a plane, each with its values of h and a.
fn frames(told: &serde_json::Value) -> Vec<(&serde_json::Value, f64, f64)> {
    let across = told["across"].as_array().unwrap().iter();
    let frames = told["frames"].as_array().unwrap().iter().zip(across);
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let values = frames.map(|(frame, a)| (frame, number(&frame["value"]), number(a)));
    values.collect()
}

const TILTED: &str = r#"
system.equations = { x = "h + a x - x^3" }
system.noise = { x = "sqrt(0.1)" }
system.parameters = { a = 1.0 }
sweep = { parameter = "h", from = 0.1, to = 0.6, points = 6 }
cells.x = { from = -2.5, to = 2.5, count = 200 }
curve = { parameter = "a", from = 0.6, to = 1.2 }
"#;

#[test]
fn the_page_of_curves_holds_them_and_the_densities_of_their_plane() {
    let room = Room::new();
    room.write("tilted.toml", TILTED);
    room.done("sweep tilted.toml --out run --quiet");
    room.done("explore run")
        .says(&["pbif explore run/curves/PB1-a"]);
    room.done("explore run/curves/PB1-a --quiet");
    let told = told(&room.path("run/curves/PB1-a/explorer.html"));
    let found = &told["plane"]["found"];
    assert_curves_are_those_of(room.table("run/curves/PB1-a/curves.csv"), found);
    let kinds = found["regions"][0]["kinds"].as_array().unwrap();
    let is_there = |one: &str| kinds.contains(&one.into());
    assert!(is_there("1 peak") && is_there("2 peaks"), "{kinds:?}");
    // On both sides of the exact fold, 27 h² = 4 a³, as far from it as a shallow peak needs to be counted.
    let frames = frames(&told);
    assert_eq!(frames.len(), 21 * 21);
    for (frame, h, a) in frames {
        let off = 27.0 * h * h - 4.0 * a.powi(3);
        let words = if off < 0.0 { "2 peaks" } else { "1 peak" };
        let found = &frame["found"][0]["words"];
        assert!(off.abs() < 0.6 || *found == words, "h = {h}, a = {a}");
    }
}

#[test]
fn the_page_of_a_map_holds_what_its_tables_hold() {
    let room = Room::new();
    room.run("sweep sweeps/cusp.toml --quiet --out map sweep.points=9 map.points=8 map.depth=1");
    room.done("explore map --html map.html");
    let told = told(&room.path("map.html"));
    let found = &told["plane"]["found"];
    assert_curves_are_those_of(room.table("map/curves.csv"), found);
    let rows = room.table("map/codimension_two.csv").0;
    assert_eq!(rows.len(), found["points"].as_array().unwrap().len());
    assert_eq!(
        found["points"][0]["at"][1].as_f64().unwrap(),
        rows[0].number("a")
    );

    // Every state of the page is a node of the map, with its words; its density is the exact one of that place.
    let nodes = room.table("map/map.csv").0;
    let frames = frames(&told);
    assert_eq!(frames.len(), 9 * 8);
    for (frame, h, a) in frames {
        let node = nodes.iter().find(|row| row.numbers(["h", "a"]) == [h, a]);
        let words = &node.unwrap()["signature_x"];
        assert_eq!(frame["found"][0]["words"], *words, "{h} {a}");
        // p ∝ exp((2/σ²)(h x + a x²/2 - x⁴/4)), by the trapezoidal rule, which has all digits for a density that
        // vanishes at both ends.
        let weight = |x: f64| (20.0 * (h * x + a * x * x / 2.0 - x.powi(4) / 4.0)).exp();
        let places = || (0..=5000).map(|i| -2.5 + 1e-3 * f64::from(i));
        let exact =
            places().map(|x| x * weight(x)).sum::<f64>() / places().map(weight).sum::<f64>();
        let mean = frame["moments"][0][0].as_f64().unwrap();
        assert!((mean - exact).abs() < 1e-5, "{h} {a}: {mean} {exact}");
    }

    room.refused("explore map detect.noise=0.1", &["stands in its tables"]);
    room.write("map/plane.json", "{}");
    room.refused("explore map", &["plane.json"]);
}

#[test]
fn what_cannot_be_explored_is_refused() {
    let room = Room::new();
    room.refused("explore nothing", &["`nothing` is not the folder of a run"]);
    // What is named like a sweep file is meant as one.
    let printed = room.refused("explore nothing.toml", &["nothing.toml"]);
    assert!(!printed.err.contains("folder of a run"), "{printed:?}");
    assert!(room.names().is_empty());
}
