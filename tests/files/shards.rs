//! Sweeps cut into shards: each runs alone, is killed and goes on like any run, and together they are the sweep in one
//! piece.

use crate::common::room::{Printed, Room};

/// Rows of marginals and joint densities, checked on finer cells and between closed ends.
const RAYLEIGH: &str =
    "rayleigh_crater.toml cells.x.count=40 cells.y.count=40 sweep.points=9 figures.draw=[]";
const BISTABLE: &str = "bistable.toml sweep.points=9 figures.formats=[\"svg\"]";
/// Of the sampled methods: SGCM, whose support grows from the neighbour's, and Monte Carlo, which remembers nothing.
const SGCM: &str = "bistable.toml method.kind=sgcm method.samples=160 cells.x.count=40 sweep.points=5 \
                    locate.tolerance=0.2 figures.draw=[]";
const MONTE_CARLO: &str = "bistable.toml method.kind=monte-carlo method.error=0.3 sweep.points=5 locate.tolerance=0.5 \
                           figures.draw=[]";

fn sweep(room: &Room, sweep: &str, options: &str) -> Printed {
    room.run(&format!("sweep sweeps/{sweep} --quiet {options}"))
}

/// Runs all shards but those left out, in the order of their numbers backwards.
fn shards(room: &Room, of_sweep: &str, count: usize, without: &[usize]) {
    for number in (1..=count).rev().filter(|number| !without.contains(number)) {
        let shard = sweep(
            room,
            of_sweep,
            &format!("--out run --shard {number}/{count}"),
        );
        let words = format!("shard {number} of {count}: ");
        shard.ends(0).says(&[&words]);
    }
}

/// Located rows are the same within `tolerance` of their errors, values that both have solved have the same moments
/// within `moments`.
fn assert_same(room: &Room, tolerance: f64, moments: f64) {
    let tables =
        |name: &str| ["run", "whole"].map(|run| room.table(&format!("{run}/{name}.csv")).0);
    let [found, wanted] = tables("bifurcations");
    assert_eq!(found.len(), wanted.len(), "{found:?}\n{wanted:?}");
    for (a, b) in found.iter().zip(&wanted) {
        let columns = ["label", "observable", "before", "after", "status", "change"];
        assert_eq!(a.texts(columns), b.texts(columns));
        let error = b["error"].parse::<f64>().unwrap_or(0.0);
        let apart = (a.number("value") - b.number("value")).abs();
        assert!(apart <= tolerance * error, "{a:?}\n{b:?}");
    }
    let [found, wanted] = tables("points");
    let pairs = found
        .iter()
        .filter_map(|a| Some((a, wanted.iter().find(|b| b["a"] == a["a"])?)));
    let pairs: Vec<_> = pairs.collect();
    for (a, b) in &pairs {
        for column in ["mean_x", "sd_x"] {
            let apart = (a.number(column) - b.number(column)).abs();
            assert!(apart <= moments, "{column}: {a:?}\n{b:?}");
        }
    }
    assert!(pairs.len() >= 5, "{}", pairs.len());
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
        let room = Room::new();
        let code = sweep(&room, of_sweep, "--out whole").code.unwrap();
        shards(&room, of_sweep, 4, &[]);
        room.run("merge run").ends(code);
        assert_same(&room, tolerance, moments);
        let manifest = room.json("run/run.json");
        let ending = (&manifest["ending"], &manifest["merged"]);
        assert_eq!(ending, (&"complete".into(), &4.into()));
        // It is a run like any other.
        room.done("verify run");
        room.run("detect run --quiet").ends(code);
        assert_same(&room, tolerance, moments);
    }
}

#[test]
fn what_a_shard_has_solved_and_checked_is_not_solved_again() {
    let room = Room::new();
    // One shard has all: nothing is left to solve, and no byte of a table differs.
    sweep(&room, BISTABLE, "--out whole");
    shards(&room, BISTABLE, 1, &[]);
    room.run("merge run")
        .says(&["0 values were solved that no shard has"]);
    for table in ["bifurcations.csv", "features.csv", "checks.csv"] {
        let [a, b] = ["run", "whole"].map(|run| room.read(&format!("{run}/{table}")));
        assert_eq!(a, b, "{table}");
    }
}

/// The journal of a merge says where densities are, and does not hold them once more.
#[cfg(unix)]
#[test]
fn a_killed_merge_reads_its_shards_and_goes_on_by_itself() {
    use super::killing::{size, stopped_at};

    let room = Room::new();
    shards(&room, RAYLEIGH, 3, &[]);
    room.run("merge run --out whole --quiet");
    // A kill that comes late is tried again.
    let is_killed = (0..20).any(|_| {
        for name in room.files("run", &["shards"]).keys() {
            std::fs::remove_file(room.path("run").join(name)).unwrap();
        }
        stopped_at(&room, "merge run", 2, "-KILL")
    });
    assert!(is_killed, "it ended before it was killed");
    let (journal, store) = ("run/journal.bin", "whole/densities.zarr");
    let stored = room.files(store, &[]).values().map(Vec::len).sum::<usize>();
    assert!(100 * size(&room.path(journal)) < stored as u64, "{stored}");
    let printed = room.run("detect run --out looked --quiet");
    printed.says(&["interrupted"]);
    // What the shards hold is what is read, here and where the run was moved to with them.
    let points = room.table("looked/points.csv").0;
    assert!(!points.is_empty());
    std::fs::create_dir(room.path("moved")).unwrap();
    std::fs::rename(room.path("run"), room.path("moved/run")).unwrap();
    room.run("detect moved/run --out again --quiet");
    for name in ["points.csv", "features.csv", "densities.zarr/p_xy/c/0/0/0"] {
        let [a, b] = ["looked", "again"].map(|run| room.bytes(&format!("{run}/{name}")));
        assert!(a == b, "{name}");
    }
    // A shard that is gone, or was damaged, is told.
    let shard = room.path("moved/run/shards/1-of-3");
    std::fs::rename(&shard, room.path("aside")).unwrap();
    room.refused("detect moved/run --out none", &["1-of-3, which is gone"]);
    std::fs::rename(room.path("aside"), &shard).unwrap();
    let chunk = "moved/run/shards/1-of-3/densities.zarr/p_x/c/0/0";
    let bytes = room.bytes(chunk);
    let mut damaged = bytes.clone();
    damaged[17] ^= 1;
    room.write(chunk, damaged);
    room.refused("detect moved/run --out none", &["p_x/c/0/0"]);
    room.write(chunk, bytes);
    room.run("merge moved/run --quiet");
    let [found, wanted] = ["moved/run", "whole"].map(|run| {
        let mut files = room.files(run, &["shards"]);
        let told = [
            "run.json",
            "ro-crate-metadata.json",
            "checksums.sha256",
            "points.csv",
        ];
        files.retain(|name, _| !told.contains(&name.as_str()) && !name.starts_with(".pbif"));
        files
    });
    assert!(found.keys().eq(wanted.keys()));
    for (name, bytes) in &found {
        assert!(wanted[name] == *bytes, "{name}");
    }
    // Its rows say how long values took that no shard has solved.
    let [found, wanted] = ["moved/run", "whole"].map(|run| {
        let rows = room.table(&format!("{run}/points.csv")).0;
        let of = ["a", "status", "residual", "mean_x", "sd_y", "distance"];
        rows.iter()
            .map(|row| row.texts(of).map(str::to_owned))
            .collect::<Vec<_>>()
    });
    assert_eq!(found, wanted);
}

/// Densities of a shard as another build might have left them, and no detections: their last digits differ.
fn computed_anew(room: &Room, shard: &str) {
    use sha2::{Digest as _, Sha256};

    let chunk = "densities.zarr/p_x/c/0/0";
    let bytes = room.bytes(&format!("{shard}/{chunk}"));
    let (numbers, _) = bytes.as_chunks();
    let numbers = numbers.iter().map(|bytes| f64::from_le_bytes(*bytes));
    let moved = numbers.flat_map(|number| (number * (1.0 + 1e-13)).to_le_bytes());
    let moved: Vec<u8> = moved.collect();
    let sum: String = Sha256::digest(&moved)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    room.write(&format!("{shard}/{chunk}"), moved);
    let sums = room.read(&format!("{shard}/checksums.sha256"));
    let lines = sums
        .lines()
        .filter(|line| !line.ends_with("detections.bin"));
    let lines = lines.map(|line| match line.ends_with(chunk) {
        true => format!("{sum}  {chunk}\n"),
        false => format!("{line}\n"),
    });
    room.write(
        &format!("{shard}/checksums.sha256"),
        lines.collect::<String>(),
    );
}

/// What a merge that was stopped has written tells of densities that are nowhere any more.
#[cfg(unix)]
#[test]
fn a_merge_whose_shard_is_computed_anew_meanwhile_begins_again() {
    use super::killing::stopped_at;

    let room = Room::new();
    shards(&room, RAYLEIGH, 3, &[]);
    let is_killed = (0..20).any(|_| {
        for name in room.files("run", &["shards"]).keys() {
            std::fs::remove_file(room.path("run").join(name)).unwrap();
        }
        stopped_at(&room, "merge run", 10, "-KILL")
    });
    assert!(is_killed, "it ended before it was killed");
    let unfinished = room.read("run/points.csv");
    computed_anew(&room, "run/shards/2-of-3");
    room.refused(
        "detect run --out none",
        &["2-of-3, which is gone or was computed anew"],
    );
    room.run("merge run --out whole --quiet");
    let merged = room.run("merge run");
    merged.says(&[
        "the earlier run is kept in run/previous/1",
        "values were solved",
    ]);
    assert_eq!(room.read("run/previous/1/points.csv"), unfinished);
    for name in ["features.csv", "bifurcations.csv", "checks.csv"] {
        let [a, b] = ["run", "whole"].map(|run| room.read(&format!("{run}/{name}")));
        assert_eq!(a, b, "{name}");
    }
    let stores = ["run", "whole"].map(|run| room.files(&format!("{run}/densities.zarr"), &[]));
    assert!(stores[0] == stores[1]);
    room.done("verify run");
    // One that is complete does not look into its shards again, and says what it found.
    let chunk = "run/shards/1-of-3/densities.zarr/p_x/c/0/0";
    let bytes = room.bytes(chunk);
    room.write(chunk, &bytes[8..]);
    room.run("merge run")
        .says(&["is complete: nothing was solved"]);
    room.refused(
        "merge run --out none",
        &["the chunk c/0/0 has another length"],
    );
}

#[test]
fn what_shards_have_detected_is_not_detected_again_unless_another_program_has() {
    let room = Room::new();
    shards(&room, RAYLEIGH, 2, &[]);
    let merged = |out: &str| room.run(&format!("merge run --out {out}")).text();
    assert!(!merged("taken").contains("detecting in"));
    // Shards of a version that keeps no detections, and of another build.
    for shard in ["1-of-2", "2-of-2"] {
        let file = |name: &str| format!("run/shards/{shard}/{name}");
        let sums = room.read(&file("checksums.sha256"));
        let is_other = |line: &&str| !line.ends_with("detections.bin");
        let left: Vec<&str> = sums.lines().filter(is_other).collect();
        room.write(&file("checksums.sha256"), left.join("\n") + "\n");
    }
    assert!(merged("detected").contains("detecting in "));
    for name in ["features.csv", "bifurcations.csv", "checks.csv"] {
        let [a, b] = ["taken", "detected"].map(|run| room.read(&format!("{run}/{name}")));
        assert_eq!(a, b, "{name}");
    }
    let stores = ["taken", "detected"].map(|run| room.files(&format!("{run}/densities.zarr"), &[]));
    assert!(stores[0] == stores[1]);
    // A damaged one is refused.
    shards(&room, RAYLEIGH, 2, &[2]);
    let file = "run/shards/1-of-2/detections.bin";
    let mut bytes = room.bytes(file);
    let last = bytes.len() - 9;
    bytes[last] ^= 1;
    room.write(file, bytes);
    room.refused("merge run --out none", &["detections.bin"]);
}

#[test]
fn missing_shards_are_named_and_those_that_are_there_can_be_looked_at() {
    let room = Room::new();
    room.refused("merge run", &["holds no shards of a sweep"]);
    shards(&room, BISTABLE, 3, &[2]);
    let words = [
        "1 of 3 shards in",
        "2/3 (not begun)",
        "--shard 2/3",
        "--partial",
    ];
    room.refused("merge run", &words);
    assert!(!room.holds("run/run.json"));
    let partial = room.run("merge run --partial").ends(1);
    partial.says(&["missing: 1 of 3 shards: 2/3 (not begun)"]);
    assert_eq!(room.json("run/run.json")["ending"], "interrupted");
    assert!(room.path("run/figures").is_dir());
    // The last one comes: the whole takes the place of what there was, which is kept.
    shards(&room, BISTABLE, 3, &[1, 3]);
    room.solved("merge run");
    assert_eq!(room.json("run/run.json")["ending"], "complete");
    assert_eq!(
        room.json("run/previous/1/run.json")["ending"],
        "interrupted"
    );
}

/// The job scripts, with a scheduler that runs everything at once.
#[cfg(unix)]
#[test]
fn the_job_scripts_compute_shards_and_put_them_together() {
    use std::os::unix::fs::PermissionsExt as _;

    use crate::common::room::shipped;
    let room = Room::new();
    std::fs::create_dir(room.path("tools")).unwrap();
    let program = format!("exec '{}' \"$@\"", env!("CARGO_BIN_EXE_pbif"));
    for (name, text) in [("srun", "exec \"$@\""), ("pbif", &program)] {
        let name = format!("tools/{name}");
        room.write(&name, format!("#!/bin/sh\n{text}\n"));
        let executable = std::fs::Permissions::from_mode(0o755);
        std::fs::set_permissions(room.path(&name), executable).unwrap();
    }
    let path = format!(
        "{}:{}",
        room.path("tools").display(),
        std::env::var("PATH").unwrap()
    );
    let job = |script: &str, file: &str, task: &str| {
        let mut bash = std::process::Command::new("bash");
        bash.arg(shipped("examples/slurm").join(script))
            .env("PATH", &path);
        bash.args(file.split_whitespace()).arg(room.path("run"));
        bash.envs([
            ("SLURM_ARRAY_TASK_COUNT", "2"),
            ("SLURM_ARRAY_TASK_ID", task),
        ]);
        bash.envs([("SLURM_JOB_ID", "7"), ("SLURM_CPUS_PER_TASK", "1")]);
        Printed::of(script, bash.output().unwrap()).ends(0)
    };
    let file = shipped("sweeps/bistable.toml");
    for task in ["2", "1"] {
        job("shards.sh", file.to_str().unwrap(), task);
    }
    job("merge.sh", "", "").says(&["PB1"]);
}

#[test]
fn shards_that_do_not_fit_are_refused() {
    let room = Room::new();
    let form = "K/N, the K-th of N shards";
    for (shard, words) in [
        ("0/4", form),
        ("5/4", form),
        ("4", form),
        ("1/9", "a sweep of 8 steps cannot be cut into 9 shards"),
    ] {
        let refused = sweep(&room, BISTABLE, &format!("--out run --shard {shard}"));
        refused.ends(2).says(&[words]);
    }
    assert!(!room.holds("run"));
    shards(&room, BISTABLE, 2, &[2]);
    // A complete one is not run again.
    let again = sweep(&room, BISTABLE, "--out run --shard 1/2 --resume");
    again.ends(0).says(&["is complete: nothing was solved"]);
    shards(
        &room,
        "bistable.toml sweep.points=9 system.parameters.sigma2=0.3",
        2,
        &[1],
    );
    room.refused("merge run", &["system.parameters.sigma2 = 0.3 there"]);
    shards(&room, BISTABLE, 4, &[1, 2, 3]);
    room.run("merge run")
        .says(&["cut in several ways: into 2 and 4"]);
}
