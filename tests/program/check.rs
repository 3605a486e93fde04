//! `pbif check`: every shipped sweep is sound, and what is printed is again a sweep file.

use std::path::{Path, PathBuf};

use std::process::Command;

fn check(file: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    let output = command
        .arg("check")
        .arg(file)
        .args(arguments)
        .output()
        .unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{errors}");
    String::from_utf8(output.stdout).unwrap()
}

fn sweeps() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("sweeps")
}

/// The printed text without its comments.
fn resolved(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn shipped_sweeps_are_sound_and_their_resolved_files_give_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let mut seen = 0;
    for entry in std::fs::read_dir(sweeps()).unwrap() {
        let file = entry.unwrap().path();
        if file.is_dir() {
            continue;
        }
        let text = check(&file, &[]);
        assert!(!text.contains("lies inside"), "{}:\n{text}", file.display());
        let copy = folder.path().join(file.file_name().unwrap());
        std::fs::write(&copy, &text).unwrap();
        assert_eq!(resolved(&check(&copy, &[])), resolved(&text));
        seen += 1;
    }
    assert_eq!(seen, 14);
    // Nothing was run, so nothing but the copies is there.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 14);
}

#[test]
fn the_cost_is_counted() {
    let sets = [
        "--set",
        "method.kind=sgcm",
        "--set",
        "cells.x.count=30",
        "--set",
        "cells.y.count=20",
        "--set",
        "method.samples=100",
        "--set",
        "method.map_step=1",
        "--set",
        "method.time_step=0.01",
    ];
    let text = check(&sweeps().join("coulomb_fc.toml"), &sets);
    for words in [
        "cells: 30 x 20 = 600",
        "points: 301 (f_c = -0.02, -0.0199, -0.0198, ...)",
        // 600 cells of 4 or 100 transitions of 32 + (2 + 2·4)·8 bytes, and 8·(8 + 8 + 2·11 + 8) bytes a cell.
        "memory: 489.6 kB to 6.9 MB",
        "at most 6.000e4 a point (100 a cell)",
        "time steps: 100 a trajectory, at most 6.000e6 a point",
    ] {
        assert!(text.contains(words), "{words} not in\n{text}");
    }
}

#[test]
fn faces_off_the_switching_surface_and_long_sweeps_are_noted() {
    let file = sweeps().join("coulomb_fc.toml");
    let text = check(
        &file,
        &[
            "--set",
            "cells.y={ from = -5.5, to = 5.5, count = 61 }",
            "--set",
            "sweep.points=2000",
        ],
    );
    assert!(
        text.contains("the switching surface y = 0 lies inside a cell"),
        "{text}"
    );
    assert!(text.contains("2000 points is a long sweep"), "{text}");
    assert!(!text.contains("x = 0 lies inside"), "{text}");
    let text = check(
        &file,
        &["--set", "cells.x={ from = -5.5, to = 5.5, count = 61 }"],
    );
    assert!(
        text.contains("the centre of symmetry x = 0 lies inside a cell"),
        "{text}"
    );
}

#[test]
fn the_range_of_z_is_the_widest_of_the_sweep() {
    let file = sweeps().join("dahl_alpha.toml");
    let text = check(&file, &[]);
    // |z| ≤ f_c/λ = 0.05/0.06.
    assert!(
        text.contains("z = { from = -0.8333333333333334, to = 0.8333333333333334"),
        "{text}"
    );
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("f_c.toml");
    let swept = std::fs::read_to_string(&file)
        .unwrap()
        .replace("f_c = 0.05", "alpha = -0.5");
    std::fs::write(&copy, swept).unwrap();
    let sets = [
        "--set",
        "sweep.parameter=f_c",
        "--set",
        "sweep.from=0.06",
        "--set",
        "sweep.to=0.03",
        "--set",
        "figures.at=[]",
    ];
    assert!(check(&copy, &sets).contains("z = { from = -1.0, to = 1.0, count = 16,"));
}

#[test]
fn figures_outside_a_part_of_the_sweep_are_left_out_with_one_warning() {
    let part = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
        let file = sweeps().join("dahl_alpha.toml");
        let part = ["--set", "sweep.from=0", "--set", "sweep.to=-0.6"];
        command.arg("check").arg(file).args(part).args(more);
        let output = command.output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (
            output.status.code(),
            text(output.stdout),
            text(output.stderr),
        )
    };
    let (code, out, err) = part(&[]);
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("at = [0.0, -0.5]"), "{out}");
    assert_eq!(err.matches("warning").count(), 1, "{err}");
    assert!(err.contains("`0.5`, `-1`, outside the sweep"), "{err}");
    // What was set in the same breath is refused.
    let (code, _, err) = part(&["--set", "figures.at=[0.5]"]);
    assert_eq!(code, Some(2));
    assert!(
        err.contains("`figures.at` has 0.5, outside the sweep"),
        "{err}"
    );
}
