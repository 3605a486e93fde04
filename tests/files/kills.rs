//! Jobs of every kind that are killed at random moments, their ends included, and gone on with: they leave the bytes of
//! one that was not killed, and the earlier run in their folder is whole.
//!
//! `cargo test --release --test files kills:: -- --ignored --nocapture` takes some minutes; `PBIF_KILL_ROUNDS` and
//! `PBIF_FUZZ_SEED` say otherwise.

#![cfg(unix)]

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;
use std::time::Instant;

use super::killing::started;
use super::resume_others::{COMPARISON, CUSP, MAP, TIMES};
use crate::common::numbers::{Numbers, given};
use crate::common::room::Room;

/// A job, and what must be there before it.
struct Kind {
    name: &'static str,
    before: &'static [&'static str],
    line: &'static str,
    /// What goes on with it: a merge does so by itself.
    resume: &'static str,
}

const SWEEP: &str = "sweep sweeps/coulomb_fc.toml cells.x.count=24 cells.y.count=24 sweep.points=9 \
                     locate.tolerance=1e-3 locate.effort=0.02 figures.formats=[\"svg\"]";

const KINDS: [Kind; 5] = [
    Kind {
        name: "sweep",
        before: &[],
        line: SWEEP,
        resume: "--resume",
    },
    Kind {
        name: "map",
        before: &[],
        line: MAP,
        resume: "--resume",
    },
    Kind {
        name: "curve",
        before: &["sweep cusp.toml --quiet --out start"],
        line: "curve start --row PB1 --second a --from 0.7 --to 1.3",
        resume: "--resume",
    },
    Kind {
        name: "comparison",
        before: &[],
        line: COMPARISON,
        resume: "--resume",
    },
    Kind {
        name: "merge",
        before: &[
            "sweep cusp.toml map.parameter=a map.from=0.7 map.to=1.3 map.points=5 map.depth=1 sweep.points=7 --quiet \
             --out shards --shard 1/2",
            "sweep cusp.toml map.parameter=a map.from=0.7 map.to=1.3 map.points=5 map.depth=1 sweep.points=7 --quiet \
             --out shards --shard 2/2",
        ],
        line: "merge shards",
        resume: "",
    },
];

/// Whether a file is of work in the making.
fn is_unfinished(name: &str) -> bool {
    name.starts_with(".pbif") || name.ends_with(".part.bin")
}

/// Files of a folder by name, without its earlier versions, its lock, and what a kill left in the making.
fn files(room: &Room, folder: &str) -> BTreeMap<String, Vec<u8>> {
    let mut files = room.files(folder, &["previous"]);
    files.retain(|name, _| !is_unfinished(name));
    files
}

/// Files that say when a job began and ended in whole seconds, or how long a value took in thousandths: two short jobs
/// may share them by chance.
const DATED: [&str; 4] = [
    "run.json",
    "ro-crate-metadata.json",
    "checksums.sha256",
    "points.csv",
];

/// What is left of a job that was not killed.
struct Whole {
    files: BTreeMap<String, Vec<u8>>,
    /// Files that hold times, by the clock or of work: those of `DATED`, and all that two such jobs do not share.
    timed: BTreeSet<String>,
}

impl Whole {
    /// Of two jobs in these folders.
    fn new(room: &Room, [one, other]: [&str; 2]) -> Self {
        let (files, again) = (files(room, one), files(room, other));
        assert!(files.keys().eq(again.keys()));
        let differs = |name: &&String| files[*name] != again[*name];
        let differing = files.keys().filter(differs).cloned();
        let timed = differing.chain(DATED.map(str::to_owned)).collect();
        Self { files, timed }
    }

    /// The files of a folder are the same; tables with times but for these.
    fn assert_left_in(&self, room: &Room, folder: &str, what: &str) {
        let found = files(room, folder);
        let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&found), names(&self.files), "{what}");
        for (name, bytes) in &found {
            if !self.timed.contains(name) {
                assert!(*bytes == self.files[name], "{what}: {name} has other bytes");
            } else if name.ends_with(".csv") {
                let rows = |folder: &str| {
                    let table = room.table(&format!("{folder}/{name}")).without(&TIMES);
                    let rows = table.0.iter().map(|row| format!("{row:?}"));
                    // Some are in the order of their times.
                    rows.collect::<BTreeSet<String>>()
                };
                assert_eq!(rows(folder), rows("whole"), "{what}: {name}");
            }
        }
    }
}

/// So many rounds: kills at random moments, then to the end; how many kills came in time.
fn rounds(kind: &Kind, rounds: u64, seed: u64) -> usize {
    let (room, mut numbers) = (Room::new(), Numbers(seed));
    room.write("cusp.toml", CUSP);
    for line in kind.before {
        room.run(line);
    }
    let line = format!("{} --quiet", kind.line);
    room.solved(&format!("{line} --out again"));
    let clock = Instant::now();
    room.solved(&format!("{line} --out whole"));
    let time = clock.elapsed();
    let whole = Whole::new(&room, ["whole", "again"]);
    let mut kills = 0;
    for round in 0..rounds {
        let what = format!("{}, round {round} of seed {seed}", kind.name);
        let _ = std::fs::remove_dir_all(room.path("run"));
        let has_earlier = numbers.below(2) == 0;
        if has_earlier {
            let folders = [room.path("whole"), room.path("run")];
            let copied = Command::new("cp").arg("-r").args(folders).status();
            assert!(copied.unwrap().success());
        }
        // What was there is in its place until another one takes it, then below `previous/`.
        let assert_earlier = || {
            if has_earlier {
                let is_kept = room.path("run/previous/1").is_dir();
                let earlier = if is_kept { "run/previous/1" } else { "run" };
                whole.assert_left_in(&room, earlier, &format!("{what}, the earlier one"));
            }
        };
        let mut resume = "";
        for _ in 0..=numbers.below(3) {
            let mut child = started(&room, &format!("{line} --out run {resume}"));
            let share = numbers.below(1_000) as u32;
            std::thread::sleep(time * share / 1_000);
            kills += usize::from(child.try_wait().unwrap().is_none());
            let _ = child.kill();
            child.wait().unwrap();
            if resume.is_empty() {
                assert_earlier();
            }
            resume = kind.resume;
        }
        let threads = 1 + numbers.below(2);
        room.solved(&format!("{line} --out run --threads {threads} {resume}"));
        whole.assert_left_in(&room, "run", &what);
        assert_earlier();
        let left = room.files("run", &["previous"]);
        let lock = |name: &&String| *name == ".pbif.lock";
        let mut unfinished = left
            .keys()
            .filter(|name| is_unfinished(name) && !lock(name));
        assert_eq!(unfinished.next(), None, "{what}");
        room.done("verify run");
    }
    kills
}

#[test]
fn kills_at_any_moment_lose_nothing() {
    for (kind, count) in KINDS.iter().zip([2, 1]) {
        // On a machine that was busy with something else at first, the kills of a round may all come too late.
        let killed = (1..=5).any(|seed| rounds(kind, count, seed) > 0);
        assert!(killed, "{}: nothing was killed", kind.name);
    }
}

/// As many rounds as there are asked for.
fn many_rounds(name: &str) {
    let (count, seed) = (given("PBIF_KILL_ROUNDS", 40), given("PBIF_FUZZ_SEED", 1));
    let kind = KINDS.iter().find(|kind| kind.name == name).unwrap();
    let clock = Instant::now();
    let kills = rounds(kind, count, seed);
    assert!(kills as u64 * 2 > count, "{name}: {kills} kills");
    let took = clock.elapsed().as_secs();
    println!("{name}: {count} rounds, {kills} kills, the same bytes; {took} s");
}

#[test]
#[ignore = "takes minutes"]
fn rounds_of_kills_of_a_sweep() {
    many_rounds("sweep");
}

#[test]
#[ignore = "takes minutes"]
fn rounds_of_kills_of_a_map() {
    many_rounds("map");
}

#[test]
#[ignore = "takes minutes"]
fn rounds_of_kills_of_a_curve() {
    many_rounds("curve");
}

#[test]
#[ignore = "takes minutes"]
fn rounds_of_kills_of_a_comparison() {
    many_rounds("comparison");
}

#[test]
#[ignore = "takes minutes"]
fn rounds_of_kills_of_a_merge() {
    many_rounds("merge");
}
