//! Thousands of damaged runs, by a fixed seed: bytes flipped, files cut, doubled and emptied, numbers put in that no
//! run has. Whatever is read of them is read or refused with a file's name, without a panic, a hang, or memory that
//! grows.

use std::time::{Duration, Instant};

use crate::common::damage::{damaged, read_all};
use crate::common::numbers::Numbers;
use crate::common::room::Room;

/// No reading of such a small run takes as long, on however busy a machine.
const LONGEST: Duration = Duration::from_secs(20);

/// What is read of a run, by its checksums.
const SUMMED: [&str; 4] = ["run.json", "points.csv", "checks.csv", "densities.zarr"];

#[test]
fn damaged_runs_are_read_or_refused() {
    let (read, refused) = damaged_runs(400);
    assert!(read > 20 && refused > 100, "{read} read, {refused} refused");
}

/// So many damaged files, each read and mended again: how many runs could be read, and how many were refused.
fn damaged_runs(cases: usize) -> (usize, usize) {
    let room = Room::new();
    let mut numbers = Numbers(14);
    let (mut read, mut refused) = (0, 0);
    // One axis with checks; two axes with a quantity. Small, since each is read thousands of times.
    let sweeps = [
        ("bistable", "sweep.points=3 cells.x.count=20"),
        (
            "rayleigh_energy",
            "sweep.points=3 cells.x.count=12 cells.y.count=12 locate.grid_check=\"off\"",
        ),
    ];
    for (name, settings) in sweeps {
        let format = "figures.formats=[\"svg\"]";
        room.solved(&format!(
            "sweep sweeps/{name}.toml --quiet --out {name} {settings} {format}"
        ));
        let run = room.path(name);
        assert!(read_all(&run));
        let files: Vec<(String, Vec<u8>)> = room.files(name, &["figures"]).into_iter().collect();
        // Tables and manifest are small and say most: every other case is one of them.
        let tables: Vec<_> = files.iter().filter(|file| !file.0.contains('/')).collect();
        let sums = run.join("checksums.sha256");
        let signed = std::fs::read(&sums).unwrap();
        for case in 0..cases / sweeps.len() {
            let (file, whole) = match case % 2 {
                0 => tables[numbers.below(tables.len())],
                _ => &files[numbers.below(files.len())],
            };
            let path = run.join(file);
            // Without checksums, as in unfinished runs, damage is found by what is read.
            let is_signed = case % 3 == 0;
            if !is_signed {
                let _ = std::fs::remove_file(&sums);
            }
            let changed = damaged(whole, &mut numbers);
            let is_removed = numbers.below(40) == 0;
            if is_removed {
                let removed = std::fs::remove_file(&path);
                assert!(removed.is_ok() || path == sums, "{removed:?}");
            } else {
                std::fs::write(&path, &changed).unwrap();
            }
            let clock = Instant::now();
            let is_read = read_all(&run);
            assert!(clock.elapsed() < LONGEST, "{name}, case {case}: {file}");
            // With its checksums no damage of what is read goes unnoticed.
            let is_summed = SUMMED.iter().any(|entry| file.starts_with(entry));
            let is_changed = changed != *whole && !is_removed;
            let is_hidden = is_read && is_signed && is_summed && is_changed;
            assert!(!is_hidden, "{name}, case {case}: {file}");
            match is_read {
                true => read += 1,
                false => refused += 1,
            }
            std::fs::write(&path, whole).unwrap();
            std::fs::write(&sums, &signed).unwrap();
        }
    }
    (read, refused)
}
