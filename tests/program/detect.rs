//! `pbif detect` and `pbif plot` through the real binary: what is stored gives the same rows and figures again, other
//! settings give what a fresh sweep would, and nothing good is lost.

use std::collections::BTreeMap;

use crate::common::room::{Printed, Room, assert_same};
use crate::common::table::Table;

const GENERATOR: &str = "method.kind=generator cells.x.count=24 cells.y.count=24 sweep.points=4 locate.tolerance=5e-3 locate.effort=0.02";
/// So narrow ranges that what leaves them, most of it along y, is the reason of a row.
const ESCAPING: &str = "method.kind=generator cells.x={from=-5.5,to=5.5,count=30} \
                        cells.y={from=-5.5,to=5.5,count=30} sweep.points=7 locate.tolerance=1e-3 \
                        locate.effort=0";
/// Damped well, so that trajectories forget their start soon, with the same ratios of noise and friction to damping.
const SAMPLED: &str = "method.kind=sgcm system.parameters.kappa=0.1 system.parameters.sigma2=0.1 sweep.from=-0.2 \
                       sweep.to=0.1 cells.x.count=24 cells.y={from=-5.5,to=5.5,count=24} sweep.points=4 \
                       method.samples=300 locate.tolerance=5e-2";
const SAMPLED_LINE: &str =
    "method.kind=sgcm sweep.points=5 method.samples=2000 locate.tolerance=0.2";
const LINE: &str = "method.kind=generator sweep.points=9";

/// Tables that detection makes.
const TABLES: &str =
    "points.csv features.csv bifurcations.csv bifurcations.md bifurcations.tex bifurcations.json";

/// Sweeps a shipped file into a folder of the room.
fn sweep(room: &Room, name: &str, settings: &str, out: &str) -> Printed {
    room.solved(&format!(
        "sweep sweeps/{name}.toml --out {out} --quiet {settings}"
    ))
}

fn swept(name: &str, settings: &str) -> Room {
    let room = Room::new();
    sweep(&room, name, settings, "run");
    room
}

/// Every file of a run, but those below `previous/` and what has other seconds.
fn files(room: &Room, run: &str) -> BTreeMap<String, Vec<u8>> {
    room.files(
        run,
        &["previous", "checksums.sha256", "ro-crate-metadata.json"],
    )
}

fn without_manifest(room: &Room, run: &str) -> BTreeMap<String, Vec<u8>> {
    let mut files = files(room, run);
    files.remove("run.json").unwrap();
    files
}

fn rows(room: &Room, table: &str) -> usize {
    room.read(table).lines().count()
}

/// Figures are drawn again byte for byte, also into another folder; the run is left as it was.
fn assert_drawn_again(room: &Room, name: &str) {
    let before = files(room, "run");
    std::fs::remove_dir_all(room.path("run/figures")).unwrap();
    let printed = room.done("plot run --quiet");
    assert!(printed.err.is_empty());
    printed.says(&["figures/diagram_x.svg"]);
    assert_same(&files(room, "run"), &before, name);
    room.run("plot run --out other figures.formats=[\"svg\"]");
    assert_same(&files(room, "run"), &before, "the run is left alone");
    let drawn = files(room, "other");
    assert!(drawn.keys().all(|name| name.ends_with(".svg")));
    assert_eq!(drawn["diagram_x.svg"], before["figures/diagram_x.svg"]);
}

/// Another selection of densities, and then all of them again.
fn assert_asked_for_again(room: &Room) {
    let before = without_manifest(room, "run");
    room.solved("detect run --quiet detect.marginals=[\"y\"] detect.joint=[]");
    assert!(!room.read("run/points.csv").contains("peaks_x"));
    assert!(!room.holds("run/figures/diagram_x.svg"));
    room.solved("detect run --quiet detect.marginals=[\"x\",\"y\"] detect.joint=[[\"x\",\"y\"]]");
    assert_same(&without_manifest(room, "run"), &before, "both again");
}

#[test]
fn unchanged_settings_change_no_byte() {
    for (name, settings) in [
        ("coulomb_fc", GENERATOR),
        ("coulomb_fc", ESCAPING),
        ("coulomb_fc", SAMPLED),
        ("bistable", SAMPLED_LINE),
        ("bistable", LINE),
    ] {
        let room = swept(name, settings);
        let (before, tables) = (files(&room, "run"), without_manifest(&room, "run"));
        let is_there = room.read("run/bifurcations.csv").contains("PB1");
        assert!(
            rows(&room, "run/points.csv") > 2 && is_there,
            "{name}: nothing to show"
        );
        // By the generator, located values were checked on a finer grid, which is repeated from the table.
        let checked = settings.contains("method.kind=generator");
        assert_eq!(room.holds("run/checks.csv"), checked, "{name}");
        // What follows from the equations of one axis needs no check.
        assert!(
            !checked || name == "bistable" || rows(&room, "run/checks.csv") > 1,
            "{name}"
        );
        room.solved("detect run --quiet --out out");
        assert_same(&files(&room, "run"), &before, "the run is left alone");
        assert_same(&without_manifest(&room, "out"), &tables, "another folder");
        room.solved("detect run --quiet");
        assert_same(&without_manifest(&room, "run"), &tables, "in place");
        // The version before is a complete run, the manifest differs in its seconds and dates alone.
        assert_same(&files(&room, "run/previous/1"), &before, "previous");
        let [mut now, mut then] =
            ["run", "run/previous/1"].map(|run| room.json(&format!("{run}/run.json")));
        assert!(now["seconds"]["detect"].as_f64().unwrap() > 0.0);
        assert_eq!(now["seconds"]["sweep"], then["seconds"]["sweep"]);
        (now["seconds"], then["seconds"]) = Default::default();
        for date in ["started", "ended"] {
            assert!(then["made"][date].is_string(), "{date}");
            (now["made"][date], then["made"][date]) = Default::default();
        }
        assert_eq!(now, then);
        // Drawing asks for what is stored alone, whatever solved it.
        if [GENERATOR, SAMPLED_LINE].contains(&settings) {
            assert_drawn_again(&room, name);
        }
        if settings == GENERATOR {
            assert_asked_for_again(&room);
        }
    }
}

/// Two wells with noise on both axes, on cells that are too coarse for the tolerance.
const COARSE: &str = r#"
[system.equations]
x = "-(sinh(x) - 1.3 x - theta - (y - 0.3 x)*0.3) + 0.4 (y - 0.3 x)"
y = "-(y - 0.3 x) - 0.4 (sinh(x) - 1.3 x - theta - (y - 0.3 x)*0.3)"
[system.noise]
x = "sqrt(0.4)"
y = "sqrt(0.4)"
[system.parameters]
theta = 0.0
[sweep]
parameter = "theta"
from = -0.6
to = 0.6
points = 9
[cells]
x = { from = -3.6, to = 3.6, count = 40 }
y = { from = -4.4, to = 4.4, count = 30 }
[detect]
marginals = []
joint = [["x", "y"]]
"#;

#[test]
fn what_closer_looks_have_found_stands_again_with_the_same_settings_alone() {
    let room = Room::new();
    room.write("coarse.toml", COARSE);
    room.solved("sweep coarse.toml --out own --quiet locate.effort=0");
    room.solved("sweep coarse.toml --out run --quiet");
    assert!(!room.holds("own/closer_looks.json") && room.holds("run/closer_looks.json"));
    let table = |run: &str| room.read(&format!("{run}/bifurcations.csv"));
    assert_ne!(table("own"), table("run"));
    room.solved("detect run --quiet --out again");
    assert_same(
        &without_manifest(&room, "again"),
        &without_manifest(&room, "run"),
        "unchanged settings",
    );
    let before = table("run");
    room.solved("detect run --quiet locate.effort=0");
    assert_ne!(table("run"), before);
    room.solved("detect run --quiet locate.effort=1");
    assert_eq!(table("run"), before);
}

/// The points without wall-clock times, and without what the solve found: that speaks of the densities watched then.
fn comparable(room: &Room, run: &str) -> (BTreeMap<String, Vec<u8>>, Table) {
    let mut files = without_manifest(room, run);
    files.retain(|name, _| !name.starts_with("densities.zarr") && name != "points.csv");
    let points = room.table(&format!("{run}/points.csv"));
    (files, points.without(&["seconds", "warnings", "findings"]))
}

#[test]
fn other_settings_give_what_a_fresh_sweep_gives() {
    // No value is added and none checked on a finer grid, so that both sweeps have solved the same.
    let fixed = "locate.tolerance=2.0 locate.largest_distance=0.99 locate.grid_check=off figures.formats=[\"svg\"]";
    for (name, settings) in [
        ("coulomb_fc", GENERATOR),
        ("coulomb_fc", SAMPLED),
        ("bistable", SAMPLED_LINE),
    ] {
        let settings = format!("{settings} {fixed}");
        let room = swept(name, &settings);
        let mut different = 0;
        // Nothing depends on which method solved: the dearest is asked for two of the three.
        let changes = [
            "detect.floor=0.3",
            "detect.marginals=[\"x\"] detect.joint=[] figures.at=[0.0]",
            "detect.confidence=0.5 locate.tolerance=3.0",
        ];
        let number = if settings.starts_with(SAMPLED) { 2 } else { 3 };
        for changed in &changes[..number] {
            room.solved(&format!("detect run --out again {changed}"));
            sweep(&room, name, &format!("{settings} {changed}"), "fresh");
            let [(again, points), (fresh, wanted)] =
                ["again", "fresh"].map(|run| comparable(&room, run));
            assert_same(&again, &fresh, &format!("{name} {changed}"));
            assert_eq!(points, wanted, "{name} {changed}");
            let [again, fresh] =
                ["again", "fresh"].map(|run| room.json(&format!("{run}/run.json")));
            assert_eq!(
                (&again["hash"], &again["sweep"]),
                (&fresh["hash"], &fresh["sweep"])
            );
            different +=
                usize::from(room.read("again/features.csv") != room.read("run/features.csv"));
            for run in ["again", "fresh"] {
                std::fs::remove_dir_all(room.path(run)).unwrap();
            }
        }
        assert!(different > 1, "{name}: the settings change nothing");
    }
}

#[test]
fn a_run_without_a_steady_state_stays_one() {
    let cells = "cells.x.count=16 cells.y.count=16 cells.z.count=10";
    let room = swept(
        "dahl_alpha_eq8",
        &format!("method.kind=generator {cells} sweep.points=2"),
    );
    let before = files(&room, "run");
    room.run("detect run --quiet detect.confidence=0.9").ends(1);
    let now = files(&room, "run");
    for table in TABLES.split(' ') {
        assert_eq!(now[table], before[table], "{table}");
    }
    assert!(!room.holds("run/figures") && !room.holds("run/densities.zarr"));
    room.done("plot run --quiet").says(&["nothing to draw"]);
    assert!(!room.holds("run/figures"));
}

#[test]
fn a_killed_run_is_detected_in_the_points_it_has() {
    let room = swept("bistable", SAMPLED_LINE);
    // As a kill leaves it: the last row not written, though its density is.
    let table = room.read("run/points.csv");
    let (kept, _) = table.trim_end().rsplit_once('\n').unwrap();
    room.write("run/points.csv", format!("{kept}\n"));
    room.change("run/run.json", "\"complete\"", "\"running\"");
    std::fs::remove_file(room.path("run/checksums.sha256")).unwrap();
    let printed = room.run("detect run").ends(1);
    for words in [&printed.out, &printed.err] {
        assert!(words.contains("interrupted"), "{printed:?}");
    }
    assert_eq!(room.json("run/run.json")["ending"], "interrupted");
    assert_eq!(rows(&room, "run/points.csv"), kept.lines().count());
    // Rows that are there are what they were, but for the end of the sweep.
    assert!(table.starts_with(&room.read("run/points.csv")));
}

/// A line that must be refused in these words and leave everything as it was.
fn refused(room: &Room, line: &str, words: &[&str]) {
    let before = room.files("", &[]);
    let printed = room.refused(line, words);
    assert!(printed.out.is_empty());
    assert_same(&room.files("", &[]), &before, line);
}

#[test]
#[rustfmt::skip]
fn what_cannot_be_done_is_said_with_the_remedy() {
    let room = swept("bistable", "sweep.points=3 locate.tolerance=1");
    for command in ["detect", "plot"] {
        refused(
            &room,
            &format!("{command} ."),
            &["not the folder of a run", "pbif sweep"],
        );
        refused(
            &room,
            &format!("{command} absent"),
            &["not the folder of a run"],
        );
        for key in "sweep.points=5 cells.x.count=10 method.seed=2 points=3 title=a".split(' ') {
            let words = ["cannot be set", "`figures.…`", "pbif sweep FILE --set"];
            refused(&room, &format!("{command} run {key}"), &words);
        }
    }
    // The two-dimensional system has a joint density that this run was not asked to store.
    let only_x = format!("{GENERATOR} detect.marginals=[\"x\"] detect.joint=[]");
    sweep(&room, "coulomb_fc", &only_x, "coulomb");
    let stored = "has not stored the density of `xy`, only of x";
    for (line, words) in [
        ("plot run detect.floor=0.1", &["`detect.floor` cannot be set"][..]),
        ("detect run sweep.points=5", &["`detect.…`, `locate.…`, `figures.…`"]),
        ("detect run detect.flor=0.1", &["--set:1", "did you mean `floor`?"]),
        ("detect run detect.floor=2", &["`detect.floor` cannot be `2`"]),
        ("detect run detect.marginals=[\"z\"]", &["no axis", "`x`"]),
        ("detect coulomb detect.joint=[[\"x\",\"y\"]]", &[stored, "pbif sweep FILE"]),
    ] {
        refused(&room, line, words);
    }
    let good = room.read("run/points.csv");
    room.change("run/points.csv", ",solved,", ",sovled,");
    let place = "points.csv, line 2, column `status`: `sovled` is not one of solved";
    refused(&room, "detect run", &[place]);
    std::fs::remove_file(room.path("run/points.csv")).unwrap();
    refused(
        &room,
        "plot run",
        &["cannot read", "points.csv", "not complete"],
    );
    room.write("run/points.csv", good);
    let json = room.read("run/run.json");
    room.change("run/run.json", "points = 3", "points = 4");
    refused(&room, "detect run", &["not the one that was run"]);
    room.write("run/run.json", &json);
    room.change("run/run.json", "\"version\": \"", "\"version\": \"9");
    refused(&room, "detect run", &["is of pbif 9", "this is pbif"]);
    room.write("run/run.json", &json);
    std::fs::remove_dir_all(room.path("run/densities.zarr")).unwrap();
    refused(&room, "detect run", &["cannot read the array store"]);
}

#[test]
fn a_forced_system_is_detected_again_with_the_symmetry_of_its_period() {
    // What the equations say of half a period is not stored: a run that is read back works it out anew. At one phase
    // there is no symmetry but without the forcing, with which the second sweep begins.
    let stroboscopic = r#"
[system.equations]
x = "x - x^3 + A cos(0.3 t)"
[system.noise]
x = "0.5"
[system.parameters]
A = 0.0
[sweep]
parameter = "A"
from = 0.0
to = 1.0
points = 6
[cells]
x = { from = -2.6, to = 2.6, count = 100 }
[detect]
marginals = ["x @ phase 0"]
"#;
    let room = Room::new();
    room.write("forced.toml", stroboscopic);
    sweep(&room, "forced_linear", "sweep.points=5", "linear");
    room.solved("sweep forced.toml --out strobe --quiet");
    for run in ["linear", "strobe"] {
        let table = format!("{run}/bifurcations.csv");
        let before = room.table(&table);
        room.solved(&format!("detect {run} --quiet"));
        let after = room.table(&table);
        assert_eq!(before.column("status"), after.column("status"), "{run}");
        assert_eq!(before.column("value"), after.column("value"), "{run}");
        assert!(after.column("status").contains(&"located"), "{run}");
    }
}
