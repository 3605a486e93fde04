//! Comparisons and curves that are killed or interrupted and go on: they end with what uninterrupted ones leave, and
//! earlier ones are there too.

#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::killing::{killed_at, send, size, started, wait_until};
use crate::common::room::Room;
use crate::common::table::Row;

/// Columns of tables that hold times, and those that follow from them.
pub(super) const TIMES: [&str; 4] = [
    "seconds",
    "sampling_seconds",
    "solve_seconds",
    "preparation_seconds",
];

/// Of an oscillator that is damped well, so that trajectories forget their start soon.
pub(super) const COMPARISON: &str = "compare sweeps/coulomb_fc.toml figures.at=[0.005,-0.01] figures.formats=[\"svg\"] \
                          system.parameters.kappa=0.1 system.parameters.sigma2=0.1 method.error=0.05 \
                          method.samples=40 cells.x.count=24 cells.y.count=24";
pub(super) const MAP: &str = "sweep cusp.toml map.parameter=a map.from=0.7 map.to=1.3 map.points=5 map.depth=1 sweep.points=7";
const CURVE: &str = "curve run --row PB1 --second a --from 0.7 --to 1.3";

pub(super) const CUSP: &str = r#"
system.equations = { x = "y", y = "-0.5 y + h + a x - x^3" }
system.noise = { y = "sqrt(0.2)" }
system.parameters = { a = 1.0, h = 0.3 }
sweep = { parameter = "h", from = 0.25, to = 0.5, points = 6 }
cells.x = { from = -2.2, to = 2.4, count = 40 }
cells.y = { from = -2.6, to = 2.6, count = 32 }
detect = { marginals = ["x"] }
locate = { relative_tolerance = 1e-2 }
figures = { formats = ["svg"], at = [] }
"#;

/// The tables of a folder by name, times left out.
fn tables(room: &Room, folder: &str) -> BTreeMap<String, Vec<Row>> {
    let entries = std::fs::read_dir(room.path(folder)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let table = |name: String| {
        let mut rows = room.table(&format!("{folder}/{name}")).without(&TIMES).0;
        // Its rows are in the order of times.
        if name == "accuracy.csv" {
            rows.sort_by_key(|row| format!("{row:?}"));
        }
        (name, rows)
    };
    names
        .filter(|name| name.ends_with(".csv"))
        .map(table)
        .collect()
}

/// Nothing of the making is left in a folder.
fn assert_tidy(room: &Room, folder: &str) {
    for entry in std::fs::read_dir(room.path(folder)).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(!name.starts_with('.') && !name.contains(".part"), "{name}");
    }
}

/// Starts a line several times, going on with it after the first, and kills it when its journal has grown by so much:
/// how often it was killed.
fn killed_again(room: &Room, line: &str, journal: &str, more: &[u64]) -> usize {
    let journal = room.path(journal);
    let (mut length, mut kills) = (0, 0);
    for more in more {
        let resume = if kills == 0 { "" } else { "--resume" };
        if killed_at(
            started(room, &format!("{line} {resume}")),
            &journal,
            length + more,
        ) {
            kills += 1;
            assert!(size(&journal) >= length);
            length = size(&journal);
        }
    }
    kills
}

#[test]
fn a_killed_comparison_ends_as_one_that_was_not() {
    let room = Room::new();
    room.solved(&format!("{COMPARISON} --out whole --quiet"));
    let wanted = tables(&room, "whole");
    let line = format!("{COMPARISON} --out run");
    let kills = killed_again(
        &room,
        &line,
        "run/compare.part.bin",
        &[1, 1_000, 100_000, 100_000],
    );
    assert!(kills > 1, "{kills}");
    // Another comparison is refused, with what differs.
    let other = "compare.sgcm.samples = 40 there, 60 here";
    room.refused(&format!("{line} --resume method.samples=60"), &[other]);
    let at = room.run(&format!("{line} --resume figures.at=[0.005]"));
    assert!(at.err.contains("compare.at"), "{at:?}");
    room.solved(&format!("{line} --resume --quiet --threads 1"));
    assert_eq!(tables(&room, "run"), wanted);
    assert_tidy(&room, "run");
    // It is complete: nothing is solved, and nothing written.
    let before = room.bytes("run/compare.json");
    let again = room.solved(&format!("{line} --resume"));
    again.says(&["is complete: nothing was solved"]);
    assert_eq!(room.bytes("run/compare.json"), before);
    // An unfinished one is kept when another begins, and can be gone on with where it is kept.
    let journal = room.path("run/compare.part.bin");
    assert!(killed_at(started(&room, &line), &journal, 1));
    room.solved(&format!("{line} --quiet"));
    assert!(room.holds("run/previous/1/compare.part.bin"));
    room.solved(&format!(
        "{COMPARISON} --out run/previous/1 --resume --quiet"
    ));
    for kept in ["run/previous/1", "run/previous/2"] {
        assert_eq!(tables(&room, kept), wanted, "{kept}");
    }
}

#[test]
fn an_interrupted_comparison_leaves_what_is_done() {
    let room = Room::new();
    let mut child = started(&room, &format!("{COMPARISON} --out run method.error=0.01"));
    let journal = room.path("run/compare.part.bin");
    // Three solves at the first value, each with densities of some 30 kB.
    wait_until(&mut child, || size(&journal) >= 600_000);
    let sent = send(&child, "-INT");
    let code = child.wait().unwrap().code();
    assert!(sent && code == Some(130), "{code:?}");
    // With a value by all methods there are tables, and a journal to go on from; what was interrupted at once before
    // leaves nothing.
    let has_tables = room.holds("run/compare.json");
    assert!(journal.is_file() || !has_tables);
    if has_tables {
        assert_eq!(room.json("run/compare.json")["ending"], "interrupted");
        assert!(!tables(&room, "run")["compare.csv"].is_empty());
    }
}

#[test]
fn a_killed_merge_of_a_map_goes_on_by_itself() {
    let room = Room::new();
    room.write("cusp.toml", CUSP);
    for shard in ["1/2", "2/2"] {
        room.done(&format!("{MAP} --out shards --quiet --shard {shard}"));
    }
    room.solved("merge shards --out whole --quiet");
    let journal = room.path("run/map.part.bin");
    for length in [1, 200_000, 400_000] {
        let child = started(&room, "merge shards --out run --quiet");
        assert!(killed_at(child, &journal, length), "{length}");
    }
    room.solved("merge shards --out run --quiet");
    for name in ["map.csv", "curves.csv", "codimension_two.csv", "plane.json"] {
        let [found, wanted] = ["run", "whole"].map(|of| room.bytes(&format!("{of}/{name}")));
        assert!(found == wanted, "{name}");
    }
    assert_tidy(&room, "run");
}

#[test]
fn a_killed_curve_ends_with_the_bytes_of_one_that_was_not() {
    let room = Room::new();
    room.write("cusp.toml", CUSP);
    room.solved("sweep cusp.toml --quiet --out run");
    room.solved(&format!("{CURVE} --out whole --quiet"));
    let line = format!("{CURVE} --out curve");
    let more = [1, 300_000, 600_000, 900_000, 1_200_000];
    let kills = killed_again(&room, &line, "curve/curve.part.bin", &more);
    assert!(kills > 2, "{kills}");
    let other = room.run(&format!("{line} --resume --step 0.05"));
    other.says(&["followed.step = 0.025 there, 0.05 here"]);
    room.solved(&format!("{line} --resume --quiet --threads 1"));
    for name in [
        "curves.csv",
        "codimension_two.csv",
        "curve.json",
        "figures/curve.svg",
    ] {
        let [found, wanted] = ["curve", "whole"].map(|of| room.bytes(&format!("{of}/{name}")));
        assert!(found == wanted, "{name}");
    }
    assert_tidy(&room, "curve");
    let again = room.solved(&format!("{line} --resume"));
    again.says(&["are complete: nothing was solved"]);
}

#[test]
fn a_flipped_byte_of_any_file_is_found_in_comparisons_curves_and_maps() {
    let room = Room::new();
    room.solved(&format!("{COMPARISON} --out compared --quiet"));
    assert_flips_are_found(&room, "compared");
    room.write("cusp.toml", CUSP);
    room.run("sweep cusp.toml --quiet --out run");
    room.solved(&format!("{CURVE} --out curves --quiet --step 0.1"));
    assert_flips_are_found(&room, "curves");
    let map = "map.parameter=a map.from=0.7 map.to=1.3 map.points=4 map.depth=0 sweep.points=5";
    room.solved(&format!("sweep cusp.toml --quiet --out map {map}"));
    assert_flips_are_found(&room, "map");
}

/// A complete folder is found whole, and not with one byte of any of its files flipped.
fn assert_flips_are_found(room: &Room, out: &str) {
    let line = format!("verify {out}");
    room.done(&line);
    let of = |folder: &str| std::fs::read_dir(room.path(out).join(folder));
    let mut files: Vec<_> = of("").unwrap().chain(of("figures").unwrap()).collect();
    files.extend(of("densities").into_iter().flatten());
    let paths = files.into_iter().map(|file| file.unwrap().path());
    // The lock of the folder is empty and none of its files.
    let is_file = |path: &PathBuf| path.is_file() && size(path) > 0;
    for path in paths.filter(is_file) {
        let whole = std::fs::read(&path).unwrap();
        let mut bytes = whole.clone();
        bytes[whole.len() / 2] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let found = room.run(&line);
        assert!(matches!(found.code, Some(1 | 2)), "{path:?}: {found:?}");
        std::fs::write(&path, whole).unwrap();
    }
}
