//! Runs that are killed or interrupted and go on: in the end they have left what an uninterrupted run leaves, byte for
//! byte, and whatever was in the folder before is there too.

#![cfg(unix)]

use std::collections::BTreeSet;

use super::killing::{size, started, stopped_at, wait_until};
use crate::common::room::{Printed, Room, assert_same};

/// Sweeps that differ in what a session remembers (factors and trails, with and without mass that leaves; masses;
/// nothing) and in what densities are on (cells, bins of quantities, a series).
const SWEEPS: [&str; 7] = [
    "coulomb_fc.toml cells.x.count=24 cells.y.count=24 sweep.points=25 locate.tolerance=1e-3 locate.effort=0.02",
    "coulomb_fc.toml cells.x={from=-3.0,to=3.0,count=24} cells.y={from=-3.0,to=3.0,count=24} sweep.points=7 \
     locate.tolerance=1e-3",
    // Damped well, so that trajectories forget their start soon.
    "coulomb_fc.toml method.kind=sgcm method.samples=160 system.parameters.kappa=0.1 system.parameters.sigma2=0.1 \
     cells.x.count=20 cells.y.count=20 sweep.points=5 locate.tolerance=5e-3",
    "bistable.toml method.kind=monte-carlo method.error=0.3 sweep.points=5 locate.tolerance=0.5",
    "bistable.toml sweep.points=9",
    "rayleigh_energy.toml cells.x.count=24 cells.y.count=24 sweep.points=7 locate.effort=0.02",
    "gallery/coloured_bistable.toml detect.marginals=[\"x\",\"noise\"] cells.x.count=60 sweep.points=7 \
     locate.tolerance=1e-3",
];

fn line(sweep: &str, out: &str, options: &str) -> String {
    format!("sweep sweeps/{sweep} figures.formats=[\"svg\"] --out {out} {options}")
}

fn run(room: &Room, sweep: &str, out: &str, options: &str) -> Printed {
    room.solved(&line(sweep, out, &format!("{options} --quiet")))
}

/// Two runs are the same but for what takes another time: the manifest, and the column of seconds.
fn assert_same_runs(room: &Room, found: &str, wanted: &str, what: &str) {
    let timed = [
        "run.json",
        "checksums.sha256",
        "ro-crate-metadata.json",
        "points.csv",
    ];
    assert_same(
        &room.files(found, &timed),
        &room.files(wanted, &timed),
        what,
    );
    let [found, wanted] = [found, wanted].map(|run| room.table(&format!("{run}/points.csv")));
    assert_eq!(
        found.without(&["seconds"]),
        wanted.without(&["seconds"]),
        "{what}"
    );
}

fn manifest(room: &Room, run: &str) -> serde_json::Value {
    room.json(&format!("{run}/run.json"))
}

#[test]
fn killed_runs_end_with_the_bytes_of_one_that_was_not() {
    for sweep in SWEEPS {
        let room = Room::new();
        run(&room, sweep, "whole", "");
        // Killed, interrupted, and killed again while it goes on.
        let first = stopped_at(&room, &line(sweep, "run", ""), 2, "-KILL");
        assert!(first, "{sweep}: nothing to kill");
        assert_eq!(manifest(&room, "run")["ending"], "running");
        assert!(manifest(&room, "run")["points"].as_u64().unwrap() >= 1);
        // Its densities can be read, and stored for good elsewhere.
        room.done("export run --format csv --out killed");
        room.run("detect run --out seen --quiet").ends(1);
        room.done("export seen --format csv --out seen-csv");
        stopped_at(
            &room,
            &line(sweep, "run", "--resume --threads 1"),
            4,
            "-INT",
        );
        stopped_at(&room, &line(sweep, "run", "--resume"), 5, "-KILL");
        run(&room, sweep, "run", "--resume");
        assert_same_runs(&room, "run", "whole", sweep);
        room.done("export whole --format csv --out all");
        for (name, text) in room.files("all", &[]) {
            let lines = |bytes: Vec<u8>| -> BTreeSet<String> {
                String::from_utf8(bytes)
                    .unwrap()
                    .lines()
                    .map(str::to_owned)
                    .collect()
            };
            let [killed, seen] =
                ["killed", "seen-csv"].map(|folder| lines(room.bytes(&format!("{folder}/{name}"))));
            assert!(killed.len() > 1 && killed == seen, "{sweep}: {name}");
            assert!(killed.is_subset(&lines(text)), "{sweep}: {name}");
        }
        assert_eq!(manifest(&room, "run")["ending"], "complete");
        // What is stored is read again, also along axes of modes.
        run(&room, sweep, "run", "--resume");
        let [found, wanted] = ["run", "whole"].map(|run| manifest(&room, run)["points"].clone());
        assert_eq!(found, wanted);
    }
}

#[test]
fn runs_that_are_stopped_in_their_checks_do_not_repeat_them() {
    // Many rows, so that there are checks on finer cells and between closed ends to be stopped in.
    let (room, sweep) = (Room::new(), SWEEPS[1]);
    run(&room, sweep, "whole", "");
    let points = manifest(&room, "whole")["points"].as_u64().unwrap();
    // After the last point come the checks: their records make the journal grow.
    let mut child = started(&room, &line(sweep, "run", "--quiet"));
    let journal = room.path("run/journal.bin");
    let has_all = || {
        let manifest = std::fs::read(room.path("run/run.json")).ok();
        let manifest =
            manifest.and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok());
        manifest.is_some_and(|manifest| manifest["points"].as_u64() == Some(points))
    };
    wait_until(&mut child, has_all);
    let before = size(&journal);
    let running = wait_until(&mut child, || size(&journal) != before);
    assert!(running, "nothing to kill");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(manifest(&room, "run")["ending"], "running");
    run(&room, sweep, "run", "--resume");
    assert_same_runs(&room, "run", "whole", "killed in its checks");
}

#[test]
fn a_complete_run_is_not_run_again_and_another_sweep_is_refused() {
    let (room, sweep) = (Room::new(), SWEEPS[4]);
    // Where nothing is, it begins.
    let first = run(&room, sweep, "run", "--resume");
    let before = room.bytes("run/run.json");
    let again = run(&room, sweep, "run", "--resume").says(&["is complete: nothing was solved"]);
    assert_eq!(room.bytes("run/run.json"), before);
    assert!(again.out.ends_with(&first.out), "{again:?}");
    let other = line("bistable.toml sweep.points=11", "run", "--resume");
    room.refused(&other, &["sweep.points = 9 there, 11 here"]);
    assert_eq!(room.bytes("run/run.json"), before);
}

#[test]
fn a_run_that_was_killed_before_its_journal_was_there_begins() {
    let (room, sweep) = (Room::new(), SWEEPS[4]);
    run(&room, sweep, "whole", "");
    let mut begun = manifest(&room, "whole");
    begun["ending"] = "running".into();
    begun["points"] = 0.into();
    std::fs::create_dir(room.path("run")).unwrap();
    room.write("run/run.json", begun.to_string());
    // A beginning of the journal has another name.
    room.write("run/.pbif-x1", "pbif");
    run(&room, sweep, "run", "--resume");
    assert_same_runs(&room, "run", "whole", "killed before its journal");
    // Where points are there, a missing journal is told.
    let mut killed = manifest(&room, "run");
    killed["ending"] = "running".into();
    std::fs::remove_file(room.path("run/checksums.sha256")).unwrap();
    room.write("run/run.json", killed.to_string());
    room.refused(&line(sweep, "run", "--resume"), &["journal.bin"]);
}

#[test]
fn a_run_that_was_killed_before_its_checksums_gets_them_from_whoever_opens_it() {
    let (room, sweep) = (Room::new(), SWEEPS[4]);
    run(&room, sweep, "run", "");
    let sums = room.bytes("run/checksums.sha256");
    let resumed = line(sweep, "run", "--resume --quiet");
    for reader in [&resumed, "show run", "verify run", "list ."] {
        // What a kill leaves: all is there, and the journal with it.
        for name in ["checksums.sha256", "ro-crate-metadata.json"] {
            std::fs::remove_file(room.path("run").join(name)).unwrap();
        }
        std::fs::write(room.path("run/journal.bin"), "solves").unwrap();
        room.done(reader);
        assert!(room.bytes("run/checksums.sha256") == sums, "{reader}");
        assert!(!room.holds("run/journal.bin"), "{reader}");
    }
}

#[test]
fn an_unfinished_run_is_kept_when_another_one_begins() {
    let (room, sweep) = (Room::new(), SWEEPS[0]);
    run(&room, sweep, "whole", "");
    assert!(stopped_at(&room, &line(sweep, "run", ""), 3, "-KILL"));
    run(&room, SWEEPS[4], "run", "");
    assert_eq!(manifest(&room, "run/previous/1")["ending"], "running");
    run(&room, sweep, "run/previous/1", "--resume");
    assert_same_runs(&room, "run/previous/1", "whole", "in previous/1");
}
