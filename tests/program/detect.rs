//! `pbif detect` and `pbif plot` through the real binary: what is stored gives the same rows and figures again, other
//! settings give what a fresh sweep would, and nothing good is lost.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

const GENERATOR: &[&str] = &[
    "method.kind=generator",
    "cells.x.count=24",
    "cells.y.count=24",
    "sweep.points=4",
    "locate.tolerance=5e-3",
];

const SAMPLED: &[&str] = &[
    "method.kind=sgcm",
    "cells.x.count=24",
    "cells.y={ from = -5.5, to = 5.5, count = 24 }",
    "sweep.points=4",
    "method.samples=300",
    "locate.tolerance=5e-3",
];

const SAMPLED_LINE: &[&str] = &[
    "method.kind=sgcm",
    "sweep.points=5",
    "method.samples=2000",
    "locate.tolerance=0.2",
];

const LINE: &[&str] = &["method.kind=generator", "sweep.points=9"];

/// Tables that detection makes.
const TABLES: [&str; 6] = [
    "points.csv",
    "features.csv",
    "bifurcations.csv",
    "bifurcations.md",
    "bifurcations.tex",
    "bifurcations.json",
];

fn pbif(arguments: &[&str], overrides: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    command.args(arguments);
    for setting in overrides {
        command.args(["--set", setting]);
    }
    command.output().unwrap()
}

/// Sweeps a shipped file into `folder/name`.
fn sweep(file: &str, overrides: &[&str], folder: &TempDir, name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = root.join("sweeps").join(format!("{file}.toml"));
    let run = folder.path().join(name);
    let (file, out) = (file.to_str().unwrap(), run.to_str().unwrap());
    let output = pbif(&["sweep", file, "--out", out, "--quiet"], overrides);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    run
}

fn on(command: &str, run: &Path, options: &[&str], overrides: &[&str]) -> Output {
    let mut arguments = vec![command, run.to_str().unwrap()];
    arguments.extend(options);
    pbif(&arguments, overrides)
}

/// Detects again; must end well.
fn detect(run: &Path, options: &[&str], overrides: &[&str]) -> Output {
    let output = on("detect", run, options, overrides);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
    output
}

/// Every file below a folder with its content, but those below `previous/`.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    fn walk(root: &Path, folder: &Path, found: &mut BTreeMap<String, Vec<u8>>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path
                .strip_prefix(root)
                .unwrap()
                .to_str()
                .unwrap()
                .to_owned();
            // The manifest has other seconds, and with it what is made from it.
            if ["checksums.sha256", "ro-crate-metadata.json"].contains(&&*name) {
                continue;
            }
            if path.is_file() {
                found.insert(name, std::fs::read(path).unwrap());
            } else if name != "previous" {
                walk(root, &path, found);
            }
        }
    }
    let mut found = BTreeMap::new();
    walk(folder, folder, &mut found);
    found
}

fn manifest(run: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(run.join("run.json")).unwrap()).unwrap()
}

fn text(run: &Path, name: &str) -> String {
    std::fs::read_to_string(run.join(name)).unwrap()
}

/// Names and contents that must be equal; all differences are named.
fn assert_same(found: &BTreeMap<String, Vec<u8>>, wanted: &BTreeMap<String, Vec<u8>>, what: &str) {
    let names = found.keys().chain(wanted.keys());
    let different: Vec<_> = names
        .filter(|name| found.get(*name) != wanted.get(*name))
        .collect();
    assert!(different.is_empty(), "{what}: {different:?}");
}

fn without(mut files: BTreeMap<String, Vec<u8>>, name: &str) -> BTreeMap<String, Vec<u8>> {
    files.remove(name).unwrap();
    files
}

#[test]
fn unchanged_settings_change_no_byte() {
    for (file, overrides) in [
        ("coulomb_fc", GENERATOR),
        ("coulomb_fc", SAMPLED),
        ("bistable", SAMPLED_LINE),
        ("bistable", LINE),
    ] {
        let folder = TempDir::new().unwrap();
        let run = sweep(file, overrides, &folder, "run");
        let before = files(&run);
        let rows = text(&run, "points.csv").lines().count();
        assert!(
            rows > 2 && text(&run, "bifurcations.csv").contains("PB1"),
            "{file}: nothing to show"
        );
        // By the generator, located values were checked on a finer grid, which is repeated from the table.
        let checked = overrides.contains(&"method.kind=generator");
        assert_eq!(run.join("checks.csv").exists(), checked, "{file}");
        // What follows from the equations of one axis needs no check.
        let asked = checked && file != "bistable";
        assert!(
            !asked || text(&run, "checks.csv").lines().count() > 1,
            "{file}"
        );
        let out = folder.path().join("out");
        detect(&run, &["--quiet", "--out", out.to_str().unwrap()], &[]);
        assert_same(&files(&run), &before, "the run is left alone");
        assert_same(
            &without(files(&out), "run.json"),
            &without(before.clone(), "run.json"),
            "another folder",
        );
        detect(&run, &["--quiet"], &[]);
        assert_same(
            &without(files(&run), "run.json"),
            &without(before.clone(), "run.json"),
            "in place",
        );
        // The version before is a complete run, the manifest differs in its seconds and dates alone.
        assert_same(&files(&run.join("previous/1")), &before, "previous");
        let (mut now, mut then) = (manifest(&run), manifest(&run.join("previous/1")));
        assert!(now["seconds"]["detect"].as_f64().unwrap() > 0.0);
        assert_eq!(now["seconds"]["sweep"], then["seconds"]["sweep"]);
        (now["seconds"], then["seconds"]) = Default::default();
        for date in ["started", "ended"] {
            assert!(then["made"][date].is_string(), "{date}");
            (now["made"][date], then["made"][date]) = Default::default();
        }
        assert_eq!(now, then);
    }
}

#[test]
fn other_settings_give_what_a_fresh_sweep_gives() {
    let settings: [&[&str]; 3] = [
        &["detect.floor=0.3"],
        &["detect.confidence=0.5", "locate.tolerance=3.0"],
        &[
            "detect.marginals=[\"x\"]",
            "detect.joint=[]",
            "figures.at=[0.0]",
        ],
    ];
    for (file, overrides) in [
        ("coulomb_fc", GENERATOR),
        ("coulomb_fc", SAMPLED),
        ("bistable", SAMPLED_LINE),
    ] {
        // No value is added and none checked on a finer grid, so that both sweeps have solved the same.
        let fixed = [
            "locate.tolerance=2.0",
            "locate.largest_distance=0.99",
            "locate.grid_check=off",
            "figures.formats=[\"svg\"]",
        ];
        let wide = |more: &[&'static str]| [overrides, &fixed, more].concat();
        let folder = TempDir::new().unwrap();
        let run = sweep(file, &wide(&[]), &folder, "run");
        let features = text(&run, "features.csv");
        let mut different = 0;
        for (index, &changed) in settings.iter().enumerate() {
            let again = folder.path().join(format!("again{index}"));
            detect(&run, &["--out", again.to_str().unwrap()], changed);
            let fresh = sweep(file, &wide(changed), &folder, &format!("fresh{index}"));
            let comparable = |run: &Path| {
                let mut files = files(run);
                files.retain(|name, _| !name.starts_with("densities.zarr") && name != "run.json");
                files.insert(
                    "points.csv".into(),
                    points_without_seconds(run).into_bytes(),
                );
                files
            };
            assert_same(
                &comparable(&again),
                &comparable(&fresh),
                &format!("{file} {changed:?}"),
            );
            assert_eq!(manifest(&again)["hash"], manifest(&fresh)["hash"]);
            assert_eq!(manifest(&again)["sweep"], manifest(&fresh)["sweep"]);
            different += usize::from(text(&again, "features.csv") != features);
        }
        assert!(different > 1, "{file}: the settings change nothing");
    }
}

/// `points.csv` without wall-clock times, and without what the solve found: that speaks of the densities watched then.
fn points_without_seconds(run: &Path) -> String {
    let mut reader = csv::Reader::from_path(run.join("points.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows = reader.records().map(|row| {
        let row = row.unwrap();
        let cells = header.iter().zip(row.iter());
        let cells = cells.filter(|(name, _)| !["seconds", "warnings", "findings"].contains(name));
        cells
            .map(|(_, cell)| format!("{cell}|"))
            .collect::<String>()
            + "\n"
    });
    rows.collect()
}

#[test]
fn what_is_left_out_can_be_asked_for_again() {
    let folder = TempDir::new().unwrap();
    let run = sweep("coulomb_fc", GENERATOR, &folder, "run");
    let before = files(&run);
    let only_y = ["detect.marginals=[\"y\"]", "detect.joint=[]"];
    detect(&run, &["--quiet"], &only_y);
    assert!(!text(&run, "points.csv").contains("peaks_x"));
    assert!(!run.join("figures/diagram_x.svg").exists());
    detect(
        &run,
        &["--quiet"],
        &[
            "detect.marginals=[\"x\", \"y\"]",
            "detect.joint=[[\"x\", \"y\"]]",
        ],
    );
    assert_same(
        &without(files(&run), "run.json"),
        &without(before, "run.json"),
        "both again",
    );
}

#[test]
fn figures_are_drawn_again_byte_for_byte() {
    for (file, overrides) in [("coulomb_fc", GENERATOR), ("bistable", SAMPLED_LINE)] {
        let folder = TempDir::new().unwrap();
        let run = sweep(file, overrides, &folder, "run");
        let before = files(&run);
        std::fs::remove_dir_all(run.join("figures")).unwrap();
        let output = on("plot", &run, &["--quiet"], &[]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert!(output.stderr.is_empty());
        assert_same(&files(&run), &before, file);
        let stdout = String::from_utf8(output.stdout).unwrap();
        assert!(stdout.contains("figures/diagram_x.svg"), "{stdout}");
        let out = folder.path().join("other");
        let options = ["--out", out.to_str().unwrap()];
        on("plot", &run, &options, &["figures.formats=[\"svg\"]"]);
        assert_same(&files(&run), &before, "the run is left alone");
        let drawn = files(&out);
        assert!(
            drawn.keys().all(|name| name.ends_with(".svg")) && drawn.contains_key("diagram_x.svg")
        );
        assert_eq!(drawn["diagram_x.svg"], before["figures/diagram_x.svg"]);
    }
}

#[test]
fn a_run_without_a_steady_state_stays_one() {
    let folder = TempDir::new().unwrap();
    let overrides = [
        "method.kind=generator",
        "cells.x.count=16",
        "cells.y.count=16",
        "cells.z.count=10",
        "sweep.points=2",
    ];
    let run = sweep("dahl_alpha_eq8", &overrides, &folder, "run");
    let before = files(&run);
    let output = detect(&run, &["--quiet"], &["detect.confidence=0.9"]);
    assert_eq!(output.status.code(), Some(1));
    let now = files(&run);
    for table in TABLES {
        assert_eq!(now[table], before[table], "{table}");
    }
    assert!(!run.join("figures").exists() && !run.join("densities.zarr").exists());
    let output = on("plot", &run, &["--quiet"], &[]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(
        String::from_utf8(output.stdout)
            .unwrap()
            .contains("nothing to draw")
    );
    assert!(!run.join("figures").exists());
}

#[test]
fn a_killed_run_is_detected_in_the_points_it_has() {
    let folder = TempDir::new().unwrap();
    let run = sweep("bistable", SAMPLED_LINE, &folder, "run");
    // As a kill leaves it: the last row not written, though its density is.
    let table = text(&run, "points.csv");
    let (rows, _) = table.trim_end().rsplit_once('\n').unwrap();
    std::fs::write(run.join("points.csv"), format!("{rows}\n")).unwrap();
    let json = text(&run, "run.json").replace("\"complete\"", "\"running\"");
    std::fs::write(run.join("run.json"), json).unwrap();
    std::fs::remove_file(run.join("checksums.sha256")).unwrap();
    let output = detect(&run, &[], &[]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let (stdout, stderr) = (
        String::from_utf8(output.stdout).unwrap(),
        String::from_utf8(output.stderr).unwrap(),
    );
    assert!(stdout.contains("interrupted"), "{stdout}");
    assert!(stderr.contains("interrupted"), "{stderr}");
    assert_eq!(manifest(&run)["ending"], "interrupted");
    assert_eq!(
        text(&run, "points.csv").lines().count(),
        rows.lines().count()
    );
    // Rows that are there are what they were, but for the end of the sweep.
    assert!(table.starts_with(&text(&run, "points.csv")));
}

/// The command must refuse in these words and leave everything as it was.
fn refused(command: &str, run: &Path, overrides: &[&str], words: &[&str]) {
    let before = run.is_dir().then(|| files(run));
    let output = on(command, run, &[], overrides);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty());
    for words in words {
        assert!(message.contains(words), "`{words}` not in\n{message}");
    }
    assert_eq!(run.is_dir().then(|| files(run)), before);
}

#[test]
fn what_cannot_be_done_is_said_with_the_remedy() {
    let folder = TempDir::new().unwrap();
    let run = sweep(
        "bistable",
        &["sweep.points=3", "locate.tolerance=1"],
        &folder,
        "run",
    );
    for command in ["detect", "plot"] {
        refused(
            command,
            folder.path(),
            &[],
            &["not the folder of a run", "pbif sweep"],
        );
        refused(
            command,
            &folder.path().join("absent"),
            &[],
            &["not the folder of a run"],
        );
        for key in [
            "sweep.points=5",
            "cells.x.count=10",
            "method.seed=2",
            "points=3",
            "title=a",
        ] {
            let words = ["cannot be set", "`figures.…`", "pbif sweep FILE --set"];
            refused(command, &run, &[key], &words);
        }
    }
    refused(
        "plot",
        &run,
        &["detect.floor=0.1"],
        &["`detect.floor` cannot be set"],
    );
    refused(
        "detect",
        &run,
        &["sweep.points=5"],
        &["`detect.…`, `locate.…`, `figures.…`"],
    );
    refused(
        "detect",
        &run,
        &["detect.flor=0.1"],
        &["--set:1", "did you mean `floor`?"],
    );
    refused(
        "detect",
        &run,
        &["detect.floor=2"],
        &["`detect.floor` cannot be `2`"],
    );
    refused(
        "detect",
        &run,
        &["detect.marginals=[\"z\"]"],
        &["no axis", "`x`"],
    );
    // The two-dimensional system has a joint density that this run was not asked to store.
    let only_x = [GENERATOR, &["detect.marginals=[\"x\"]", "detect.joint=[]"]].concat();
    let coulomb = sweep("coulomb_fc", &only_x, &folder, "coulomb");
    refused(
        "detect",
        &coulomb,
        &["detect.joint=[[\"x\", \"y\"]]"],
        &[
            "has not stored the density of `xy`, only of x",
            "pbif sweep FILE",
        ],
    );
    let good = text(&run, "points.csv");
    std::fs::write(run.join("points.csv"), good.replace(",solved,", ",sovled,")).unwrap();
    refused(
        "detect",
        &run,
        &[],
        &["points.csv, line 2, column `status`: `sovled` is not one of solved"],
    );
    std::fs::remove_file(run.join("points.csv")).unwrap();
    refused(
        "plot",
        &run,
        &[],
        &["cannot read", "points.csv", "not complete"],
    );
    std::fs::write(run.join("points.csv"), good).unwrap();
    let json = text(&run, "run.json");
    std::fs::write(
        run.join("run.json"),
        json.replace("points = 3", "points = 4"),
    )
    .unwrap();
    refused("detect", &run, &[], &["not the one that was run"]);
    std::fs::write(
        run.join("run.json"),
        json.replace("\"version\": \"", "\"version\": \"9"),
    )
    .unwrap();
    refused("detect", &run, &[], &["is of pbif 9", "this is pbif"]);
    std::fs::write(run.join("run.json"), json).unwrap();
    std::fs::remove_dir_all(run.join("densities.zarr")).unwrap();
    refused("detect", &run, &[], &["cannot read the array store"]);
}

/// Numbers that look random and are the same everywhere.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound.max(1) as u64) as usize
    }
}

/// A file with something wrong in it.
fn damaged(whole: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let place = numbers.below(bytes.len());
    match numbers.below(5) {
        0 => bytes.truncate(place),
        1 => bytes[place] ^= 1 << numbers.below(8),
        2 => drop(bytes.splice(place..place, *b"nan,")),
        3 => {
            let end = bytes.len().min(place + 8);
            bytes[place..end].fill([0, 0x7f, 0xff][numbers.below(3)]);
        }
        _ => {
            let end = bytes.len().min(place + 1 + numbers.below(40));
            drop(bytes.drain(place..end));
        }
    }
    bytes
}

#[test]
fn damaged_runs_are_read_or_refused_and_never_panic() {
    let folder = TempDir::new().unwrap();
    let run = sweep("bistable", LINE, &folder, "run");
    let names: Vec<String> = files(&run)
        .into_keys()
        .filter(|name| !name.starts_with("figures"))
        .collect();
    let read = || -> Result<(), Box<dyn std::error::Error>> {
        let stored = pbif::run::StoredRun::open(&run)?;
        let settings = stored
            .sweep_file()
            .validate()
            .map_err(|report| report.render(false))?;
        let sweep = settings.fixed().map_err(|report| report.render(false))?;
        stored.detect(&sweep)?;
        Ok(())
    };
    read().unwrap();
    let sums = run.join("checksums.sha256");
    let stored_sums = std::fs::read(&sums).unwrap();
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    for _ in 0..200 {
        let name = &names[numbers.below(names.len())];
        let path = run.join(name);
        let whole = std::fs::read(&path).unwrap();
        let changed = damaged(&whole, &mut numbers);
        std::fs::write(&path, &changed).unwrap();
        // With its checksums no damage goes unnoticed; without them it is read or refused.
        std::fs::write(&sums, &stored_sums).unwrap();
        assert!(
            changed == whole
                || name.starts_with("bifurcations")
                || name == "features.csv"
                || read().is_err(),
            "{name}"
        );
        std::fs::remove_file(&sums).unwrap();
        let _ = read();
        std::fs::write(&path, &whole).unwrap();
    }
}
