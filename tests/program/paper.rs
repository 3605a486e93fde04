//! What docs/paper.md says the shipped sweeps of the paper's examples find: shapes at the paper's values, and where
//! they change.

use std::path::Path;

use std::process::Command;
use tempfile::TempDir;

/// Rows of a table that a sweep writes, as numbers by column name; text is left out.
struct Run(TempDir);

impl Run {
    fn of(sweep: &str, overrides: &[&str]) -> Self {
        let folder = TempDir::new().unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let file = root.join("sweeps").join(format!("{sweep}.toml"));
        let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
        command.arg("sweep").arg(file).arg("--quiet");
        command.arg("--out").arg(folder.path().join("run"));
        for setting in overrides {
            command.args(["--set", setting]);
        }
        let output = command.output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 1)), "{output:?}");
        Self(folder)
    }

    /// The columns of a table, a row each.
    fn table(&self, name: &str, columns: &[&str]) -> Vec<Vec<String>> {
        let path = self.0.path().join("run").join(name);
        let mut reader = csv::Reader::from_path(path).unwrap();
        let header = reader.headers().unwrap().clone();
        let at = |name: &&str| header.iter().position(|column| column == *name).unwrap();
        let at: Vec<usize> = columns.iter().map(at).collect();
        let rows = reader.records().map(Result::unwrap);
        rows.map(|row| at.iter().map(|&column| row[column].to_owned()).collect())
            .collect()
    }

    /// Peaks of x, y and (x, y) and craters of (x, y) at a value.
    fn shape(&self, parameter: &str, value: f64) -> Vec<String> {
        let columns = [parameter, "peaks_x", "peaks_y", "peaks_xy", "craters_xy"];
        let mut rows = self.table("points.csv", &columns).into_iter();
        let near = |row: &Vec<String>| (row[0].parse::<f64>().unwrap() - value).abs() < 1e-9;
        rows.find(near).unwrap().split_off(1)
    }
}

#[test]
fn the_first_example_has_the_shapes_of_the_paper_and_changes_where_the_page_says() {
    let run = Run::of("paper_example1", &[]);
    for (f_c, shape) in [
        (-0.02, ["2", "2", "2", "1"]),
        (-0.01, ["2", "2", "2", "1"]),
        (0.0, ["1", "1", "1", "0"]),
        (0.01, ["1", "1", "1", "0"]),
    ] {
        assert_eq!(run.shape("f_c", f_c), shape, "f_c = {f_c}");
    }
    let rows = run.table(
        "bifurcations.csv",
        &["label", "observable", "value", "status"],
    );
    let found: Vec<&Vec<String>> = rows.iter().filter(|row| row[0].starts_with("PB")).collect();
    // Values of the page; other grids and schemes move them by less than 1e-6 (stated errors: 1.0e-6 and 2.8e-7).
    let mut expected = vec![
        ("x", -0.002_848_5),
        ("xy", -0.000_621_44),
        ("xy", 0.0),
        ("y", 0.0),
    ];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for row in found {
        let value: f64 = row[2].parse().unwrap();
        let near =
            |(observable, at): &(&str, f64)| *observable == row[1] && (value - at).abs() < 3e-6;
        let place = expected.iter().position(near).unwrap();
        expected.remove(place);
        assert_eq!(row[3], "located");
    }
}

#[test]
fn the_second_example_has_the_shapes_of_the_paper() {
    let run = Run::of(
        "paper_example2",
        &[
            "sweep.points=4",
            "locate.tolerance=3",
            "locate.largest_distance=0.99",
            "locate.grid_check=off",
            "cells.x.count=40",
            "cells.y.count=40",
            "cells.z.count=8",
        ],
    );
    for (alpha, shape) in [
        (0.5, ["1", "1", "1", "0"]),
        (0.0, ["1", "1", "1", "0"]),
        (-0.5, ["2", "1", "2", "0"]),
        (-1.0, ["2", "1", "2", "0"]),
    ] {
        assert_eq!(run.shape("alpha", alpha), shape, "alpha = {alpha}");
    }
}
