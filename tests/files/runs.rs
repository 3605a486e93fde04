//! Runs as their user looks at them: listed, shown, exported, removed.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

fn pbif(home: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    let command = command.current_dir(home).args(arguments);
    command.output().unwrap()
}

/// What a command prints that must end with a status.
fn printed(home: &Path, arguments: &[&str], code: i32) -> String {
    let output = pbif(home, arguments);
    let text = String::from_utf8([&output.stdout[..], &output.stderr].concat()).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
    text
}

fn sweep(home: &Path, options: &[&str]) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("sweeps/bistable.toml");
    let mut arguments = vec!["sweep", file.to_str().unwrap(), "--quiet"];
    arguments.extend([
        "--set",
        "sweep.points=9",
        "--set",
        "figures.formats=[\"svg\"]",
    ]);
    arguments.extend(options);
    printed(home, &arguments, 0);
}

fn assert_says(text: &str, words: &[&str]) {
    for words in words {
        assert!(text.contains(words), "`{words}` not in\n{text}");
    }
}

/// Makes a run unfinished, as a kill before its figures leaves it.
fn unfinish(run: &Path) {
    let file = run.join("run.json");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("\"complete\"", "\"running\"")).unwrap();
    std::fs::remove_file(run.join("checksums.sha256")).unwrap();
    std::fs::remove_dir_all(run.join("figures")).unwrap();
}

#[test]
fn runs_are_listed_with_their_versions_and_shards_and_shown() {
    let folder = TempDir::new().unwrap();
    let home = folder.path();
    let none = printed(home, &["list"], 2);
    assert_says(&none, &["`output` is not a folder", "pbif sweep FILE"]);
    sweep(home, &[]);
    sweep(home, &["--set", "system.parameters.sigma2=0.5"]);
    sweep(home, &["--shard", "1/2"]);
    let listed = printed(home, &["list"], 0);
    let line = |name: &str| {
        let mut lines = listed.lines();
        let found = lines.find(|line| line.split_whitespace().next() == Some(name));
        found.unwrap_or_else(|| unreachable!("{name} not in\n{listed}"))
    };
    assert_says(
        line("output/bistable"),
        &["bistable: a -1 to 1", "complete, ", "located"],
    );
    assert_says(
        line("output/bistable/previous/1"),
        &["complete, ", "located"],
    );
    assert_says(
        line("output/bistable/shards/1-of-2"),
        &["shard 1/2", "complete"],
    );
    let shown = printed(home, &["show", "output/bistable"], 0);
    assert_says(
        &shown,
        &[
            "Particle in a quartic potential",
            "sigma2 = 0.5",
            "a from -1 to 1, 9 given values",
            "x 100 from -2.2 to 2.2",
            "previous/1: complete",
            "1 peak → 2 peaks",
            "located",
        ],
    );
    // The sweep file that is shown is the run's.
    std::fs::write(
        home.join("again.toml"),
        printed(home, &["show", "output/bistable/previous/1", "--sweep"], 0),
    )
    .unwrap();
    let file = std::fs::read_to_string(home.join("again.toml")).unwrap();
    assert_says(&file, &["sigma2 = 0.25"]);
    printed(
        home,
        &[
            "sweep",
            "again.toml",
            "--resume",
            "--out",
            "output/bistable/previous/1",
        ],
        0,
    );
    let refused = printed(home, &["show", "nowhere"], 2);
    assert_says(
        &refused,
        &["is not the folder of a run", "output/coulomb_fc"],
    );
    unfinish(&home.join("output/bistable"));
    assert_says(
        &printed(home, &["list", "output/bistable"], 0),
        &["unfinished, "],
    );
}

#[test]
fn earlier_and_unfinished_runs_are_removed_when_asked_and_nothing_else() {
    let folder = TempDir::new().unwrap();
    let home = folder.path();
    sweep(home, &["--out", "a"]);
    assert_says(&printed(home, &["clean", "a"], 0), &["nothing to remove"]);
    sweep(home, &["--out", "a", "--set", "title=second"]);
    sweep(home, &["--out", "b"]);
    unfinish(&home.join("b"));
    std::fs::write(home.join("a/previous/1/notes.txt"), "mine").unwrap();
    // Without a terminal nobody can be asked.
    let asked = printed(home, &["clean", "."], 2);
    assert_says(
        &asked,
        &["earlier", "a/previous/1", "unfinished", "2 runs", "--yes"],
    );
    assert!(home.join("a/previous/1/run.json").exists() && home.join("b/run.json").exists());
    printed(home, &["clean", ".", "--unfinished", "--yes"], 0);
    assert!(!home.join("b").exists() && home.join("a/previous/1/run.json").exists());
    printed(home, &["clean", ".", "--yes"], 0);
    let left: Vec<_> = std::fs::read_dir(home.join("a/previous/1"))
        .unwrap()
        .flatten()
        .collect();
    assert_eq!(left.len(), 1, "{left:?}");
    assert_says(
        &printed(home, &["verify", "a"], 0),
        &["as the run left them"],
    );
    assert_says(&printed(home, &["clean", "nowhere"], 2), &["holds no runs"]);
}

#[test]
fn runs_are_exported_and_nothing_is_overwritten() {
    let folder = TempDir::new().unwrap();
    let home = folder.path();
    sweep(home, &["--out", "runs/a"]);
    let said = printed(home, &["export", "runs/a"], 0);
    assert_says(&said, &["runs/a.nc: p_x at "]);
    assert!(
        std::fs::read(home.join("runs/a.nc"))
            .unwrap()
            .starts_with(b"CDF\x02")
    );
    assert_says(
        &printed(home, &["export", "runs/a"], 2),
        &["is there already", "--out PATH"],
    );
    printed(
        home,
        &["export", "runs/a", "--format", "npz", "--out", "b/c.npz"],
        0,
    );
    assert!(
        std::fs::read(home.join("b/c.npz"))
            .unwrap()
            .starts_with(b"PK")
    );
    printed(home, &["export", "runs/a", "--format", "csv"], 0);
    let table = std::fs::read_to_string(home.join("runs/a-csv/p_x.csv")).unwrap();
    let points = std::fs::read_to_string(home.join("runs/a/points.csv")).unwrap();
    assert_eq!(
        table.lines().count() - 1,
        100 * (points.lines().count() - 1)
    );
    assert_says(
        &printed(home, &["export", "runs/a", "--format", "hdf"], 2),
        &["netcdf, npz, csv"],
    );
    // Python's readers, where they are installed: values and normalisation.
    let python = Command::new("python3")
        .arg("-c")
        .arg("import numpy")
        .status();
    if python.is_ok_and(|status| status.success()) {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/python/read_npz.py");
        let output = Command::new("python3")
            .arg(script)
            .args(["b/c.npz", "a"])
            .current_dir(home)
            .output();
        let output = output.unwrap();
        assert!(output.status.success(), "{output:?}");
        assert_says(
            &String::from_utf8(output.stdout).unwrap(),
            &["a = -1: highest at x = "],
        );
    }
}

#[test]
fn shells_and_man_are_told_of_every_command() {
    let folder = TempDir::new().unwrap();
    let home = folder.path();
    assert_says(
        &printed(home, &["completions", "bash"], 0),
        &["_pbif()", "--shard"],
    );
    assert_says(
        &printed(home, &["completions", "tcsh"], 2),
        &["bash", "fish", "zsh"],
    );
    assert_says(&printed(home, &["man"], 0), &[".TH pbif", "EXTRA"]);
    printed(home, &["man", "--out", "man1"], 0);
    assert_says(
        &std::fs::read_to_string(home.join("man1/pbif-sweep.1")).unwrap(),
        &["shard"],
    );
}

#[test]
fn points_are_solved_again_and_runs_are_cited() {
    let folder = TempDir::new().unwrap();
    let home = folder.path();
    sweep(home, &["--out", "a"]);
    let text = printed(home, &["verify", "a", "--recompute", "3"], 0);
    assert_says(
        &text,
        &[
            "files are as the run left them",
            "3 of 3 points that were solved again",
        ],
    );
    // More than there are is all of them. Without checksums a strange density is found by solving alone.
    let chunk = |index: usize| home.join(format!("a/densities.zarr/p_x/c/{index}/0"));
    std::fs::copy(chunk(0), chunk(5)).unwrap();
    std::fs::remove_file(home.join("a/checksums.sha256")).unwrap();
    let text = printed(home, &["verify", "a", "--recompute", "1000"], 1);
    assert_says(&text, &["no checksums", "ANOTHER density"]);
    assert_eq!(text.matches("ANOTHER").count(), 1, "{text}");
    let text = printed(home, &["cite", "a"], 0);
    assert_says(
        &text,
        &[
            "@software{pbif,",
            "version = {0.1.0}",
            "@misc{model-bistable,",
            "@article{scharfetter1969,",
        ],
    );
    assert_says(&printed(home, &["cite"], 0), &["@software{pbif,"]);
    assert_says(
        &printed(home, &["cite", "nothing"], 2),
        &["is not the folder of a run"],
    );
}
