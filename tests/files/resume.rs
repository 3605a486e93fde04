//! Runs that are killed or interrupted and go on: in the end they have left what an uninterrupted run leaves, byte for
//! byte, and whatever was in the folder before is there too.

#![cfg(unix)]

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

/// Sweeps that differ in what a session remembers (factors and trails, with and without mass that leaves; masses;
/// nothing) and in what densities are on (cells, bins of quantities, a series).
const SWEEPS: [(&str, &[&str]); 7] = [
    (
        "coulomb_fc",
        &[
            "cells.x.count=24",
            "cells.y.count=24",
            "sweep.points=9",
            "locate.tolerance=1e-3",
        ],
    ),
    (
        "coulomb_fc",
        &[
            "cells.x={ from = -3.0, to = 3.0, count = 24 }",
            "cells.y={ from = -3.0, to = 3.0, count = 24 }",
            "sweep.points=7",
            "locate.tolerance=1e-3",
        ],
    ),
    (
        "coulomb_fc",
        &[
            "method.kind=sgcm",
            "method.samples=160",
            "cells.x.count=20",
            "cells.y.count=20",
            "sweep.points=5",
            "locate.tolerance=5e-3",
        ],
    ),
    (
        "bistable",
        &[
            "method.kind=monte-carlo",
            "method.error=0.3",
            "sweep.points=5",
            "locate.tolerance=0.5",
        ],
    ),
    ("bistable", &["sweep.points=9"]),
    (
        "rayleigh_energy",
        &["cells.x.count=24", "cells.y.count=24", "sweep.points=7"],
    ),
    (
        "gallery/coloured_bistable",
        &[
            "detect.marginals=[\"x\", \"noise\"]",
            "cells.x.count=60",
            "sweep.points=7",
            "locate.tolerance=1e-3",
        ],
    ),
];

fn command(sweep: (&str, &[&str]), out: &Path, options: &[&str]) -> Command {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    command
        .arg("sweep")
        .arg(root.join("sweeps").join(format!("{}.toml", sweep.0)));
    for setting in sweep.1 {
        command.args(["--set", setting]);
    }
    command.args(["--set", "figures.formats=[\"svg\"]", "--out"]);
    command.arg(out).args(options);
    command
}

fn run(sweep: (&str, &[&str]), out: &Path, options: &[&str]) -> Output {
    let output = command(sweep, out, options).output().unwrap();
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    output
}

/// Starts a run and sends it a signal when so many points are reported; `false` if it was done before.
fn stopped(
    sweep: (&str, &[&str]),
    out: &Path,
    options: &[&str],
    points: usize,
    signal: &str,
) -> bool {
    let mut command = command(sweep, out, options);
    let mut child = command
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let reported = format!("{points:4} of");
    let seen = lines.any(|line| line.unwrap().starts_with(&reported));
    let pid = child.id().to_string();
    let sent = Command::new("kill").args([signal, &pid]).status().unwrap();
    lines.for_each(drop);
    let code = child.wait().unwrap().code();
    seen && sent.success() && !matches!(code, Some(0 | 1))
}

/// Every file of a run with its content, without what takes another time: the manifest, and the column of seconds.
fn files(run: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![run.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(run).unwrap().to_str().unwrap().to_owned();
            if path.is_dir() {
                open.push(path);
            } else if !["run.json", "checksums.sha256", "ro-crate-metadata.json"].contains(&&*name)
            {
                found.insert(name, std::fs::read(path).unwrap());
            }
        }
    }
    let points = String::from_utf8(found.remove("points.csv").unwrap()).unwrap();
    found.insert(
        "points.csv".to_owned(),
        without_seconds(&points).into_bytes(),
    );
    found
}

fn without_seconds(table: &str) -> String {
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let place = reader
        .headers()
        .unwrap()
        .iter()
        .position(|name| name == "seconds")
        .unwrap();
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        let cells = row.iter().enumerate().filter(|(index, _)| *index != place);
        cells
            .map(|(_, cell)| cell.to_owned())
            .collect::<Vec<_>>()
            .join(",")
    });
    rows.collect::<Vec<_>>().join("\n")
}

fn assert_same(found: &Path, wanted: &Path, what: &str) {
    let (found, wanted) = (files(found), files(wanted));
    let names = found.keys().chain(wanted.keys());
    let different: Vec<_> = names
        .filter(|name| found.get(*name) != wanted.get(*name))
        .collect();
    assert!(different.is_empty(), "{what}: {different:?}");
}

fn manifest(run: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(run.join("run.json")).unwrap()).unwrap()
}

fn folders(folder: &TempDir) -> (PathBuf, PathBuf) {
    (folder.path().join("whole"), folder.path().join("run"))
}

#[test]
fn killed_runs_end_with_the_bytes_of_one_that_was_not() {
    for sweep in SWEEPS {
        let folder = TempDir::new().unwrap();
        let (whole, out) = folders(&folder);
        run(sweep, &whole, &["--quiet"]);
        // Killed, interrupted, and killed again while it goes on.
        let first = stopped(sweep, &out, &[], 2, "-KILL");
        assert!(first, "{sweep:?}: nothing to kill");
        assert_eq!(manifest(&out)["ending"], "running");
        assert!(manifest(&out)["points"].as_u64().unwrap() >= 1);
        stopped(sweep, &out, &["--resume", "--threads", "1"], 4, "-INT");
        stopped(sweep, &out, &["--resume"], 5, "-KILL");
        run(sweep, &out, &["--resume", "--quiet"]);
        assert_same(&out, &whole, &format!("{sweep:?}"));
        assert_eq!(manifest(&out)["ending"], "complete");
        // What is stored is read again, also along axes of modes.
        run(sweep, &out, &["--resume", "--quiet"]);
        assert_eq!(manifest(&out)["points"], manifest(&whole)["points"]);
    }
}

#[test]
fn runs_that_are_stopped_in_their_checks_do_not_repeat_them() {
    // Many rows, so that there are checks on finer cells and between closed ends to be stopped in.
    let sweep = SWEEPS[1];
    let folder = TempDir::new().unwrap();
    let (whole, out) = folders(&folder);
    run(sweep, &whole, &["--quiet"]);
    let points = manifest(&whole)["points"].as_u64().unwrap();
    // After the last point come the checks: their records make the journal grow.
    let mut child = command(sweep, &out, &["--quiet"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let size = || std::fs::metadata(out.join("journal.bin")).map_or(0, |data| data.len());
    let all = |out: &Path| {
        std::fs::read(out.join("run.json"))
            .ok()
            .and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok())
            .is_some_and(|manifest| manifest["points"].as_u64() == Some(points))
    };
    while !all(&out) && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let before = size();
    while size() == before && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_micros(200));
    }
    assert!(child.try_wait().unwrap().is_none(), "nothing to kill");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(manifest(&out)["ending"], "running");
    run(sweep, &out, &["--resume", "--quiet"]);
    assert_same(&out, &whole, "killed in its checks");
}

#[test]
fn a_complete_run_is_not_run_again_and_another_sweep_is_refused() {
    let folder = TempDir::new().unwrap();
    let (_, out) = folders(&folder);
    let sweep = SWEEPS[4];
    // Where nothing is, it begins.
    let first = run(sweep, &out, &["--resume", "--quiet"]);
    let before = std::fs::read(out.join("run.json")).unwrap();
    let again = run(sweep, &out, &["--resume", "--quiet"]);
    assert_eq!(std::fs::read(out.join("run.json")).unwrap(), before);
    let [first, again] = [first, again].map(|one| String::from_utf8(one.stdout).unwrap());
    assert!(
        again.contains("is complete: nothing was solved") && again.ends_with(&first),
        "{again}"
    );
    let other = ("bistable", &["sweep.points=11"][..]);
    let refused = command(other, &out, &["--resume"]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    let words = String::from_utf8(refused.stderr).unwrap();
    assert!(words.contains("sweep.points = 9 there, 11 here"), "{words}");
    assert_eq!(std::fs::read(out.join("run.json")).unwrap(), before);
}

#[test]
fn a_run_that_was_killed_before_its_journal_was_there_begins() {
    let folder = TempDir::new().unwrap();
    let (whole, out) = folders(&folder);
    let sweep = SWEEPS[4];
    run(sweep, &whole, &["--quiet"]);
    let mut begun = manifest(&whole);
    begun["ending"] = "running".into();
    begun["points"] = 0.into();
    std::fs::create_dir(&out).unwrap();
    std::fs::write(out.join("run.json"), begun.to_string()).unwrap();
    // A beginning of the journal has another name.
    std::fs::write(out.join(".pbif-x1"), "pbif").unwrap();
    run(sweep, &out, &["--resume", "--quiet"]);
    assert_same(&out, &whole, "killed before its journal");
    // Where points are there, a missing journal is told.
    let mut killed = manifest(&out);
    killed["ending"] = "running".into();
    std::fs::write(out.join("run.json"), killed.to_string()).unwrap();
    let refused = command(sweep, &out, &["--resume"]).output().unwrap();
    let words = String::from_utf8(refused.stderr).unwrap();
    assert!(
        refused.status.code() == Some(2) && words.contains("journal.bin"),
        "{words}"
    );
}

#[test]
fn an_unfinished_run_is_kept_when_another_one_begins() {
    let folder = TempDir::new().unwrap();
    let (whole, out) = folders(&folder);
    let sweep = SWEEPS[0];
    run(sweep, &whole, &["--quiet"]);
    assert!(stopped(sweep, &out, &[], 3, "-KILL"));
    run(SWEEPS[4], &out, &["--quiet"]);
    let kept = out.join("previous/1");
    assert_eq!(manifest(&kept)["ending"], "running");
    run(sweep, &kept, &["--resume", "--quiet"]);
    assert_same(&kept, &whole, "in previous/1");
}
