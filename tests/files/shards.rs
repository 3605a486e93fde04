//! Sweeps cut into shards: each runs alone, is killed and goes on like any run, and together they are the sweep in one
//! piece.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// Rows of marginals and joint densities, checked on finer cells and between closed ends.
const RAYLEIGH: (&str, &[&str]) = (
    "rayleigh_crater",
    &[
        "cells.x.count=40",
        "cells.y.count=40",
        "sweep.points=9",
        "figures.draw=[]",
    ],
);
const BISTABLE: (&str, &[&str]) = ("bistable", &["sweep.points=9", "figures.formats=[\"svg\"]"]);
/// Of the sampled methods: SGCM, whose support grows from the neighbour's, and Monte Carlo, which remembers nothing.
const SGCM: (&str, &[&str]) = (
    "bistable",
    &[
        "method.kind=sgcm",
        "method.samples=160",
        "cells.x.count=40",
        "sweep.points=5",
        "locate.tolerance=0.2",
        "figures.draw=[]",
    ],
);
const MONTE_CARLO: (&str, &[&str]) = (
    "bistable",
    &[
        "method.kind=monte-carlo",
        "method.error=0.3",
        "sweep.points=5",
        "locate.tolerance=0.5",
        "figures.draw=[]",
    ],
);

fn pbif(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_pbif"))
        .args(arguments)
        .output();
    output.unwrap()
}

fn sweep(sweep: (&str, &[&str]), out: &Path, options: &[&str]) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = root.join("sweeps").join(format!("{}.toml", sweep.0));
    let mut arguments = vec!["sweep", file.to_str().unwrap(), "--quiet"];
    for setting in sweep.1 {
        arguments.extend(["--set", setting]);
    }
    arguments.extend(["--out", out.to_str().unwrap()]);
    arguments.extend(options);
    pbif(&arguments)
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap_or(-1)
}

fn words(output: &Output) -> String {
    let bytes = [&output.stdout[..], &output.stderr].concat();
    String::from_utf8(bytes).unwrap()
}

/// Runs all shards but those left out, in the order of their numbers backwards.
fn shards(of_sweep: (&str, &[&str]), out: &Path, count: usize, without: &[usize]) {
    for number in (1..=count).rev().filter(|number| !without.contains(number)) {
        let shard = format!("{number}/{count}");
        let output = sweep(of_sweep, out, &["--shard", &shard]);
        assert_eq!(code(&output), 0, "{shard}: {}", words(&output));
        assert!(words(&output).contains(&format!("shard {number} of {count}: ")));
    }
}

fn rows(table: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(table).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap()
}

fn manifest(run: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(run.join("run.json")).unwrap()).unwrap()
}

fn folders(folder: &TempDir) -> (PathBuf, PathBuf) {
    (folder.path().join("whole"), folder.path().join("run"))
}

/// Located rows are the same within `tolerance` of their errors, values that both have solved have the same moments
/// within `moments`.
fn assert_same(found: &Path, wanted: &Path, tolerance: f64, moments: f64) {
    let [a, b] = [found, wanted].map(|run| rows(&run.join("bifurcations.csv")));
    assert_eq!(a.len(), b.len(), "{a:?}\n{b:?}");
    for (a, b) in a.iter().zip(&b) {
        for column in ["label", "observable", "before", "after", "status", "change"] {
            assert_eq!(a[column], b[column], "{a:?}\n{b:?}");
        }
        let error = b["error"].parse::<f64>().unwrap_or(0.0);
        let apart = (number(a, "value") - number(b, "value")).abs();
        assert!(apart <= tolerance * error, "{a:?}\n{b:?}");
    }
    let [a, b] = [found, wanted].map(|run| rows(&run.join("points.csv")));
    let mut common = 0;
    for a in &a {
        let Some(b) = b.iter().find(|b| b["a"] == a["a"]) else {
            continue;
        };
        common += 1;
        for column in ["mean_x", "sd_x"] {
            let apart = (number(a, column) - number(b, column)).abs();
            assert!(apart <= moments, "{column}: {a:?}\n{b:?}");
        }
    }
    assert!(common >= 5, "{common}");
}

#[test]
fn four_shards_are_the_sweep_in_one_piece() {
    for (of_sweep, tolerance, moments) in [
        (RAYLEIGH, 1e-3, 1e-9),
        (BISTABLE, 1e-3, 1e-12),
        // The cells that are reached depend on where the sampling started; the samples of each do not.
        (SGCM, 0.1, 1e-4),
        (MONTE_CARLO, 0.0, 0.0),
    ] {
        let folder = TempDir::new().unwrap();
        let (whole, out) = folders(&folder);
        let code_whole = code(&sweep(of_sweep, &whole, &[]));
        shards(of_sweep, &out, 4, &[]);
        let merged = pbif(&["merge", out.to_str().unwrap()]);
        assert_eq!(code(&merged), code_whole, "{}", words(&merged));
        assert_same(&out, &whole, tolerance, moments);
        let manifest = manifest(&out);
        assert_eq!(
            (&manifest["ending"], &manifest["merged"]),
            (&"complete".into(), &4.into())
        );
        // It is a run like any other.
        let verified = pbif(&["verify", out.to_str().unwrap()]);
        assert_eq!(code(&verified), 0, "{}", words(&verified));
        let detected = pbif(&["detect", out.to_str().unwrap(), "--quiet"]);
        assert_eq!(code(&detected), code_whole, "{}", words(&detected));
        assert_same(&out, &whole, tolerance, moments);
    }
}

#[test]
fn what_a_shard_has_solved_and_checked_is_not_solved_again() {
    let folder = TempDir::new().unwrap();
    let (whole, out) = folders(&folder);
    // One shard has all: nothing is left to solve, and no byte of a table differs.
    sweep(BISTABLE, &whole, &[]);
    shards(BISTABLE, &out, 1, &[]);
    let merged = pbif(&["merge", out.to_str().unwrap()]);
    assert!(
        words(&merged).contains("0 values were solved that no shard has"),
        "{merged:?}"
    );
    for table in ["bifurcations.csv", "features.csv", "checks.csv"] {
        let [a, b] = [&out, &whole].map(|run| std::fs::read_to_string(run.join(table)).unwrap());
        assert_eq!(a, b, "{table}");
    }
}

#[test]
fn missing_shards_are_named_and_those_that_are_there_can_be_looked_at() {
    let folder = TempDir::new().unwrap();
    let (_, out) = folders(&folder);
    let path = out.to_str().unwrap();
    let nothing = pbif(&["merge", path]);
    assert_eq!(code(&nothing), 2);
    assert!(
        words(&nothing).contains("holds no shards of a sweep"),
        "{nothing:?}"
    );
    shards(BISTABLE, &out, 3, &[2]);
    let refused = pbif(&["merge", path]);
    assert_eq!(code(&refused), 2);
    for expected in [
        "1 of 3 shards in",
        "2/3 (not begun)",
        "--shard 2/3",
        "--partial",
    ] {
        assert!(words(&refused).contains(expected), "{}", words(&refused));
    }
    assert!(!out.join("run.json").exists());
    let partial = pbif(&["merge", path, "--partial"]);
    assert_eq!(code(&partial), 1, "{}", words(&partial));
    assert!(
        words(&partial).contains("missing: 1 of 3 shards: 2/3 (not begun)"),
        "{partial:?}"
    );
    assert_eq!(manifest(&out)["ending"], "interrupted");
    assert!(out.join("figures").is_dir());
    // The last one comes: the whole takes the place of what there was, which is kept.
    shards(BISTABLE, &out, 3, &[1, 3]);
    let merged = pbif(&["merge", path]);
    assert!(matches!(code(&merged), 0 | 1), "{}", words(&merged));
    assert_eq!(manifest(&out)["ending"], "complete");
    assert_eq!(manifest(&out.join("previous/1"))["ending"], "interrupted");
}

/// The job scripts, with a scheduler that runs everything at once.
#[cfg(unix)]
#[test]
fn the_job_scripts_compute_shards_and_put_them_together() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = TempDir::new().unwrap();
    let tools = folder.path().join("tools");
    std::fs::create_dir(&tools).unwrap();
    let tool = |name: &str, text: &str| {
        let path = tools.join(name);
        std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    };
    tool("srun", "exec \"$@\"");
    tool(
        "pbif",
        &format!("exec '{}' \"$@\"", env!("CARGO_BIN_EXE_pbif")),
    );
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = folder.path().join("run");
    let job = |script: &str, arguments: &[&str], task: &str| {
        let path = std::env::var("PATH").unwrap();
        Command::new("bash")
            .arg(root.join("examples/slurm").join(script))
            .args(arguments)
            .env("PATH", format!("{}:{path}", tools.display()))
            .envs([
                ("SLURM_ARRAY_TASK_COUNT", "2"),
                ("SLURM_ARRAY_TASK_ID", task),
            ])
            .envs([("SLURM_JOB_ID", "7"), ("SLURM_CPUS_PER_TASK", "1")])
            .output()
            .unwrap()
    };
    let file = root.join("sweeps/bistable.toml");
    let (file, out) = (file.to_str().unwrap(), out.to_str().unwrap());
    for task in ["2", "1"] {
        let output = job("shards.sh", &[file, out], task);
        assert_eq!(code(&output), 0, "{}", words(&output));
    }
    let merged = job("merge.sh", &[out], "");
    assert_eq!(code(&merged), 0, "{}", words(&merged));
    assert!(words(&merged).contains("PB1"), "{}", words(&merged));
}

#[test]
fn shards_that_do_not_fit_are_refused() {
    let folder = TempDir::new().unwrap();
    let (_, out) = folders(&folder);
    let path = out.to_str().unwrap();
    for (shard, expected) in [
        ("0/4", "K/N, the K-th of N shards"),
        ("5/4", "K/N, the K-th of N shards"),
        ("4", "K/N, the K-th of N shards"),
        ("1/9", "a sweep of 8 steps cannot be cut into 9 shards"),
    ] {
        let refused = sweep(BISTABLE, &out, &["--shard", shard]);
        assert_eq!(code(&refused), 2);
        assert!(words(&refused).contains(expected), "{}", words(&refused));
    }
    assert!(!out.exists());
    shards(BISTABLE, &out, 2, &[2]);
    // A complete one is not run again.
    let again = sweep(BISTABLE, &out, &["--shard", "1/2", "--resume"]);
    assert_eq!(code(&again), 0);
    assert!(
        words(&again).contains("is complete: nothing was solved"),
        "{}",
        words(&again)
    );
    let other = (
        "bistable",
        &["sweep.points=9", "system.parameters.sigma2=0.3"][..],
    );
    shards(other, &out, 2, &[1]);
    let refused = pbif(&["merge", path]);
    assert_eq!(code(&refused), 2);
    assert!(
        words(&refused).contains("system.parameters.sigma2 = 0.3 there"),
        "{}",
        words(&refused)
    );
    shards(BISTABLE, &out, 4, &[1, 2, 3]);
    let refused = pbif(&["merge", path]);
    assert!(
        words(&refused).contains("cut in several ways: into 2 and 4"),
        "{}",
        words(&refused)
    );
}
