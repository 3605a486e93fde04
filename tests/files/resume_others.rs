//! Comparisons and curves that are killed or interrupted and go on: they end with what uninterrupted ones leave, and
//! earlier ones are there too.

#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use tempfile::TempDir;

/// Columns of tables that hold times, and those that follow from them.
const TIMES: [&str; 4] = [
    "seconds",
    "sampling_seconds",
    "solve_seconds",
    "preparation_seconds",
];

const COMPARISON: &[&str] = &[
    "figures.at=[0.005, -0.01]",
    "figures.formats=[\"svg\"]",
    "method.error=0.05",
    "method.samples=40",
    "cells.x.count=24",
    "cells.y.count=24",
];

fn pbif() -> Command {
    Command::new(env!("CARGO_BIN_EXE_pbif"))
}

fn comparison(out: &Path, options: &[&str]) -> Command {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = pbif();
    command
        .arg("compare")
        .arg(root.join("sweeps/coulomb_fc.toml"));
    for setting in COMPARISON {
        command.args(["--set", setting]);
    }
    command.arg("--out").arg(out).args(options);
    command
}

fn done(mut command: Command) -> Output {
    let output = command.output().unwrap();
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    output
}

fn started(mut command: Command) -> Child {
    let silent = command.stdout(Stdio::null()).stderr(Stdio::null());
    silent.spawn().unwrap()
}

/// Kills a process once a file is so long; `false` if it had ended before.
fn killed_at(mut child: Child, file: &Path, length: u64) -> bool {
    let size = || std::fs::metadata(file).map_or(0, |data| data.len());
    while size() < length && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let running = child.try_wait().unwrap().is_none();
    let _ = child.kill();
    child.wait().unwrap();
    running
}

/// The tables of a folder by name, times left out.
fn tables(folder: &Path) -> BTreeMap<String, Vec<String>> {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let tables = paths.filter(|path| path.extension().is_some_and(|ending| ending == "csv"));
    tables
        .map(|path| {
            let mut reader = csv::Reader::from_path(&path).unwrap();
            let headers = reader.headers().unwrap().clone();
            let mut rows: Vec<String> = reader
                .records()
                .map(|row| {
                    let row = row.unwrap();
                    let cells = headers.iter().zip(row.iter());
                    let cells = cells.filter(|(name, _)| !TIMES.contains(name));
                    cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
                })
                .collect();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            // Its rows are in the order of times.
            if name == "accuracy.csv" {
                rows.sort();
            }
            (name, rows)
        })
        .collect()
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Nothing of the making is left in a folder.
fn assert_tidy(folder: &Path) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(!name.starts_with('.') && !name.contains(".part"), "{name}");
    }
}

#[test]
fn a_killed_comparison_ends_as_one_that_was_not() {
    let folder = TempDir::new().unwrap();
    let (whole, out) = (folder.path().join("whole"), folder.path().join("run"));
    done(comparison(&whole, &["--quiet"]));
    let journal = out.join("compare.part.bin");
    let mut lengths = Vec::new();
    for more in [1, 1_000, 100_000, 100_000] {
        let options: &[&str] = if lengths.is_empty() {
            &[]
        } else {
            &["--resume"]
        };
        let child = started(comparison(&out, options));
        if killed_at(child, &journal, lengths.last().unwrap_or(&0) + more) {
            lengths.push(std::fs::metadata(&journal).unwrap().len());
        }
    }
    assert!(lengths.len() > 1 && lengths.is_sorted(), "{lengths:?}");
    // Another comparison is refused, with what differs.
    let refused = comparison(&out, &["--resume", "--set", "method.samples=60"])
        .output()
        .unwrap();
    let words = String::from_utf8(refused.stderr).unwrap();
    assert!(refused.status.code() == Some(2), "{words}");
    assert!(
        words.contains("compare.sgcm.samples = 40 there, 60 here"),
        "{words}"
    );
    let at = comparison(&out, &["--resume", "--set", "figures.at=[0.005]"]).output();
    let words = String::from_utf8(at.unwrap().stderr).unwrap();
    assert!(words.contains("compare.at"), "{words}");
    done(comparison(&out, &["--resume", "--quiet", "--threads", "1"]));
    assert_eq!(tables(&out), tables(&whole));
    assert_tidy(&out);
    // It is complete: nothing is solved, and nothing written.
    let before = std::fs::read(out.join("compare.json")).unwrap();
    let again = done(comparison(&out, &["--resume"]));
    let words = String::from_utf8(again.stdout).unwrap();
    assert!(words.contains("is complete: nothing was solved"), "{words}");
    assert_eq!(std::fs::read(out.join("compare.json")).unwrap(), before);
    // An unfinished one is kept when another begins, and can be gone on with where it is kept.
    let child = started(comparison(&out, &[]));
    assert!(killed_at(child, &journal, 1));
    done(comparison(&out, &["--quiet"]));
    let kept = out.join("previous/1");
    assert!(kept.join("compare.part.bin").is_file());
    done(comparison(&kept, &["--resume", "--quiet"]));
    assert_eq!(tables(&kept), tables(&whole));
    assert_eq!(tables(&out.join("previous/2")), tables(&whole));
}

#[test]
fn an_interrupted_comparison_leaves_what_is_done() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("run");
    let mut child = started(comparison(&out, &["--set", "method.error=0.01"]));
    let journal = out.join("compare.part.bin");
    // Three solves at the first value, each with densities of some 30 kB.
    let size = || std::fs::metadata(&journal).map_or(0, |data| data.len());
    while size() < 600_000 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let pid = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &pid]).status().unwrap();
    let code = child.wait().unwrap().code();
    assert!(sent.success() && code == Some(130), "{code:?}");
    // With a value by all methods there are tables, and a journal to go on from; what was interrupted at once before
    // leaves nothing.
    let has_tables = out.join("compare.json").is_file();
    assert!(journal.is_file() || !has_tables);
    if has_tables {
        assert_eq!(json(&out.join("compare.json"))["ending"], "interrupted");
        assert!(!tables(&out)["compare.csv"].is_empty());
    }
}

fn sweep(out: &Path, options: &[&str]) -> Command {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = pbif();
    command
        .arg("sweep")
        .arg(root.join("sweeps/coulomb_fc.toml"));
    for setting in [
        "cells.x.count=24",
        "cells.y.count=24",
        "sweep.points=9",
        "locate.tolerance=1e-3",
        "figures.formats=[\"svg\"]",
    ] {
        command.args(["--set", setting]);
    }
    command.arg("--out").arg(out).args(options);
    command
}

/// Kills at moments spread over the whole time of a command, that of its figures and of its renames included, each gone
/// on with: the tables are those of an uninterrupted one every time, and the earlier one in the folder is whole.
fn kills(count: u32, command: fn(&Path, &[&str]) -> Command) -> u32 {
    let folder = TempDir::new().unwrap();
    let whole = folder.path().join("whole");
    let clock = std::time::Instant::now();
    done(command(&whole, &["--quiet"]));
    let time = clock.elapsed();
    let wanted = tables(&whole);
    let mut killed = 0;
    for number in 0..count {
        let out = folder.path().join("run");
        let _ = std::fs::remove_dir_all(&out);
        // An earlier one as good as one that was made there.
        copy(&whole, &out);
        let mut child = started(command(&out, &["--quiet"]));
        // The golden ratio spreads them evenly, in no order.
        let share = (0.618_034 * f64::from(number)).fract();
        std::thread::sleep(time.mul_f64(share));
        killed += u32::from(child.try_wait().unwrap().is_none());
        let _ = child.kill();
        child.wait().unwrap();
        assert_eq!(
            tables_of_earlier(&out),
            wanted,
            "kill {number}: the earlier one"
        );
        done(command(&out, &["--quiet", "--resume"]));
        assert_eq!(tables(&out), wanted, "kill {number}");
        assert_eq!(
            tables_of_earlier(&out),
            wanted,
            "kill {number}: the earlier one"
        );
        let mut verify = pbif();
        verify.arg("verify").arg(&out);
        done(verify);
    }
    killed
}

fn copy(from: &Path, to: &Path) {
    let copied = Command::new("cp").arg("-r").args([from, to]).status();
    assert!(copied.unwrap().success());
}

/// Those of the complete version below `previous/`, or of the one in its place where nothing has taken it yet.
fn tables_of_earlier(out: &Path) -> BTreeMap<String, Vec<String>> {
    let kept = out.join("previous/1");
    match kept.is_dir() {
        true => tables(&kept),
        false => tables(out),
    }
}

#[test]
fn kills_at_any_moment_lose_nothing() {
    assert!(kills(2, sweep) > 0);
}

/// A few minutes each: `cargo test --release --test files resume_others:: -- --ignored`.
#[test]
#[ignore = "takes minutes"]
fn forty_kills_of_a_sweep_at_any_moment_lose_nothing() {
    let killed = kills(40, sweep);
    assert!(killed >= 30, "{killed}");
}

#[test]
#[ignore = "takes minutes"]
fn forty_kills_of_a_comparison_at_any_moment_lose_nothing() {
    let killed = kills(40, comparison);
    assert!(killed >= 30, "{killed}");
}

const CUSP: &str = r#"
[system.equations]
x = "y"
y = "-0.5 y + h + a x - x^3"
[system.noise]
y = "sqrt(0.2)"
[system.parameters]
a = 1.0
h = 0.3
[sweep]
parameter = "h"
from = 0.25
to = 0.5
points = 6
[cells]
x = { from = -2.2, to = 2.4, count = 40 }
y = { from = -2.6, to = 2.6, count = 32 }
[detect]
marginals = ["x"]
[locate]
relative_tolerance = 1e-2
[figures]
formats = ["svg"]
at = []
"#;

fn curve(run: &Path, out: &Path, options: &[&str]) -> Command {
    let mut command = pbif();
    command.arg("curve").arg(run).arg("--out").arg(out);
    let of = [
        "--row", "PB1", "--second", "a", "--from", "0.7", "--to", "1.3",
    ];
    command.args(of).args(options);
    command
}

#[test]
fn a_killed_curve_ends_with_the_bytes_of_one_that_was_not() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("cusp.toml"), CUSP).unwrap();
    let mut sweep = pbif();
    sweep.arg("sweep").arg(at("cusp.toml")).arg("--quiet");
    sweep.arg("--out").arg(at("run"));
    done(sweep);
    let (run, whole, out) = (at("run"), at("whole"), at("curve"));
    done(curve(&run, &whole, &["--quiet"]));
    let journal = out.join("curve.part.bin");
    let (mut length, mut kills) = (0, 0);
    for more in [1, 300_000, 600_000, 900_000, 1_200_000] {
        let options: &[&str] = if kills == 0 { &[] } else { &["--resume"] };
        if killed_at(started(curve(&run, &out, options)), &journal, length + more) {
            kills += 1;
            let now = std::fs::metadata(&journal).unwrap().len();
            assert!(now >= length);
            length = now;
        }
    }
    assert!(kills > 2, "{kills}");
    let refused = curve(&run, &out, &["--resume", "--step", "0.05"]).output();
    let words = String::from_utf8(refused.unwrap().stderr).unwrap();
    assert!(
        words.contains("followed.step = 0.025 there, 0.05 here"),
        "{words}"
    );
    done(curve(
        &run,
        &out,
        &["--resume", "--quiet", "--threads", "1"],
    ));
    for name in [
        "curves.csv",
        "codimension_two.csv",
        "curve.json",
        "figures/curve.svg",
    ] {
        let [found, wanted] = [&out, &whole].map(|of| std::fs::read(of.join(name)).unwrap());
        assert!(found == wanted, "{name}");
    }
    assert_tidy(&out);
    let again = done(curve(&run, &out, &["--resume"]));
    let words = String::from_utf8(again.stdout).unwrap();
    assert!(
        words.contains("are complete: nothing was solved"),
        "{words}"
    );
}

#[test]
fn a_flipped_byte_of_any_file_is_found_in_comparisons_curves_and_maps() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let compared = at("compared");
    done(comparison(&compared, &["--quiet"]));
    assert_flips_are_found(&compared);
    std::fs::write(at("cusp.toml"), CUSP).unwrap();
    let sweep = |out: &str, settings: &[&str]| {
        let mut sweep = pbif();
        sweep.arg("sweep").arg(at("cusp.toml")).arg("--quiet");
        sweep.arg("--out").arg(at(out));
        for setting in settings {
            sweep.args(["--set", setting]);
        }
        sweep.output().unwrap()
    };
    sweep("run", &[]);
    let (run, curves) = (at("run"), at("curves"));
    done(curve(&run, &curves, &["--quiet", "--step", "0.1"]));
    assert_flips_are_found(&curves);
    let map = [
        "map.parameter=a",
        "map.from=0.7",
        "map.to=1.3",
        "map.points=4",
    ];
    let output = sweep(
        "map",
        &[&map[..], &["sweep.points=5", "map.depth=0"]].concat(),
    );
    assert!(output.status.code() < Some(2), "{output:?}");
    assert_flips_are_found(&at("map"));
}

/// A complete folder is found whole, and not with one byte of any of its files flipped.
fn assert_flips_are_found(out: &Path) {
    let verify = |folder: &Path| {
        let mut command = pbif();
        command.arg("verify").arg(folder).output().unwrap()
    };
    assert_eq!(verify(out).status.code(), Some(0), "{:?}", verify(out));
    let mut files: Vec<_> = std::fs::read_dir(out).unwrap().collect();
    files.extend(std::fs::read_dir(out.join("figures")).unwrap());
    files.extend(
        std::fs::read_dir(out.join("densities"))
            .into_iter()
            .flatten(),
    );
    for file in files {
        let path = file.unwrap().path();
        // The lock of the folder is empty and none of its files.
        if !path.is_file() || std::fs::metadata(&path).unwrap().len() == 0 {
            continue;
        }
        let whole = std::fs::read(&path).unwrap();
        let mut bytes = whole.clone();
        bytes[whole.len() / 2] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let found = verify(out);
        assert!(
            matches!(found.status.code(), Some(1 | 2)),
            "{path:?}: {found:?}"
        );
        std::fs::write(&path, whole).unwrap();
    }
}
