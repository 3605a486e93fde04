//! `pbif compare` through the program: what it writes, and that the methods stand to each other as the exact density
//! says.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// A Coulomb oscillator that forgets three times as fast as the shipped one; at f_c = 0 its density is known, and the
/// same.
const SMALL: &[&str] = &[
    "system.parameters.kappa=0.03",
    "system.parameters.sigma2=0.03",
    "sweep.from=-0.01",
    "cells.x={ from = -3.6, to = 3.6, count = 60 }",
    "cells.y={ from = -3.6, to = 3.6, count = 60 }",
    "method.samples=600",
    "method.error=0.006",
];

fn compare(overrides: &[&str], folder: &Path) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    command
        .arg("compare")
        .arg(root.join("sweeps/coulomb_fc.toml"))
        .arg("--out")
        .arg(folder);
    for setting in SMALL.iter().chain(overrides) {
        command.args(["--set", setting]);
    }
    command.output().unwrap()
}

type Row = HashMap<String, String>;

fn rows(path: PathBuf) -> Vec<Row> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(|row| row.unwrap()).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    let word = row
        .get(column)
        .unwrap_or_else(|| panic!("no column {column}"));
    word.parse().unwrap_or_else(|_| panic!("{column}: {word}"))
}

#[test]
fn methods_stand_to_each_other_as_the_exact_density_says() {
    let folder = TempDir::new().unwrap();
    let output = compare(&["figures.at=[0.0]"], folder.path());
    assert_eq!(output.status.code(), Some(0), "{output:?}");

    let methods = rows(folder.path().join("compare.csv"));
    let by = |name: &str| methods.iter().find(|row| row["method"] == name).unwrap();
    let error = |name: &str| number(by(name), "tv_exact_xy");
    let (generator, plain, slope) = (error("generator"), error("sgcm"), error("sgcm-slope"));
    // The cells add a diffusion of up to h²/(12Δt) = 0.0017 to each axis beside a noise of 0.015 on one: about 20 % in
    // variance, 0.37 times as much in total variation. The correction takes out most of it, and the generator has an
    // error of the grid alone.
    assert!((0.04..0.12).contains(&plain), "{plain}");
    assert!(slope < plain / 3.0, "{slope} {plain}");
    assert!(generator < slope / 3.0, "{generator} {slope}");
    for name in ["generator", "sgcm", "sgcm-slope", "monte-carlo"] {
        let row = by(name);
        assert_eq!(row["status"], "solved");
        assert!(number(row, "seconds") > 0.0 && number(row, "bytes") > 1e5);
        assert!(number(row, "work") > 0.0 || name == "generator");
    }
    assert_eq!(number(by("sgcm"), "map_step"), 1.0);
    assert_eq!(by("sgcm")["work"], by("sgcm-slope")["work"]);

    let distances = rows(folder.path().join("distances.csv"));
    let pair = |first: &str, second: &str, observable: &str| -> &Row {
        let wanted = [first, second, observable];
        distances
            .iter()
            .find(|row| [&row["first"], &row["second"], &row["observable"]] == wanted)
            .unwrap_or_else(|| panic!("{wanted:?}"))
    };
    // Six pairs of methods and four with the exact density, three observables each.
    assert_eq!(distances.len(), 30);
    for observable in ["x", "y", "xy"] {
        let sampled = pair("generator", "monte-carlo", observable);
        assert_eq!(sampled["tv_significant"], "false", "{sampled:?}");
        let (tv, noise) = (number(sampled, "tv"), number(sampled, "tv_noise"));
        // Bins of a marginal err together, so that one run may be twice as far off as its noise says.
        assert!(tv < 2.5 * noise && tv > 0.3 * noise, "{sampled:?}");
        let truth = pair("monte-carlo", "exact", observable);
        assert!(
            number(truth, "tv") < 2.5 * number(truth, "tv_noise"),
            "{truth:?}"
        );
        let paper = pair("generator", "sgcm", observable);
        assert_eq!(paper["tv_significant"], "true", "{paper:?}");
    }

    let agreement = rows(folder.path().join("agreement.csv"));
    assert_eq!(agreement.len(), 2);
    for row in &agreement {
        assert!(
            number(row, "bins") > 30.0 && number(row, "share") > 0.95,
            "{row:?}"
        );
    }

    let accuracy = rows(folder.path().join("accuracy.csv"));
    assert!(accuracy.iter().all(|row| row["reference"] == "exact"));
    let of = |name: &str| -> Vec<&Row> {
        accuracy
            .iter()
            .filter(|row| row["method"] == name)
            .collect()
    };
    for name in ["generator", "sgcm", "sgcm-slope", "monte-carlo"] {
        assert_eq!(of(name).len(), 3, "{name}");
    }
    // By cells: the generator's error falls with at least the third order of the number of cells an axis.
    let mut generator: Vec<(f64, f64)> = of("generator")
        .iter()
        .map(|row| (number(row, "cells"), number(row, "tv")))
        .collect();
    generator.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(generator[0].1 > 8.0 * generator[2].1, "{generator:?}");

    let stdout = String::from_utf8(output.stdout).unwrap();
    assert!(
        stdout.contains("generator and Monte Carlo agree"),
        "{stdout}"
    );
    for file in [
        "compare.md",
        "compare.tex",
        "compare.json",
        "densities.csv",
        "figures/marginals.svg",
        "figures/joint_xy.png",
        "figures/time_to_accuracy.svg",
    ] {
        assert!(folder.path().join(file).is_file(), "{file}");
        assert!(stdout.contains(file), "{file} not in\n{stdout}");
    }
    let json = std::fs::read_to_string(folder.path().join("compare.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["methods"].as_array().unwrap().len(), 4);
    assert_eq!(json["common_cells"], serde_json::json!([50, 50]));
}

#[test]
fn an_earlier_comparison_is_kept_and_numbers_repeat_on_any_threads() {
    let folder = TempDir::new().unwrap();
    let few = [
        "figures.at=[0.005]",
        "figures.formats=[\"svg\"]",
        "method.error=0.03",
        "method.samples=100",
        "cells.x.count=30",
        "cells.y.count=30",
    ];
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    compare(&few, folder.path());
    let first = (read("densities.csv"), read("distances.csv"));
    std::fs::write(folder.path().join("mine.txt"), "stays").unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    command
        .arg("compare")
        .arg(root.join("sweeps/coulomb_fc.toml"))
        .args(["--quiet", "--threads", "1", "--out"])
        .arg(folder.path());
    for setting in SMALL.iter().chain(&few) {
        command.args(["--set", setting]);
    }
    let output = command.output().unwrap();
    assert!(output.stderr.is_empty(), "{output:?}");
    assert_eq!(first, (read("densities.csv"), read("distances.csv")));
    assert_eq!(first.0, read("previous/1/densities.csv"));
    assert!(
        folder
            .path()
            .join("previous/1/figures/marginals.svg")
            .is_file()
    );
    assert_eq!(read("mine.txt"), "stays");
    // Nothing half-made is left beside.
    let mut names = std::fs::read_dir(folder.path()).unwrap();
    assert!(names.all(|name| !name.unwrap().file_name().to_string_lossy().starts_with('.')));
}

#[test]
fn bad_input_writes_nothing() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    for (setting, words) in [
        ("figures.at=[]", "no value to compare at"),
        ("figures.at=[0.5]", "outside the sweep"),
        ("method.sample=3", "samples"),
    ] {
        let output = compare(&[setting], &out);
        assert_eq!(output.status.code(), Some(2), "{setting}");
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(stderr.contains(words), "{stderr}");
        assert!(!out.exists());
    }
}
