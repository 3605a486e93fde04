//! Thousands of damaged runs, by a fixed seed: bytes flipped, files cut, doubled and emptied, numbers put in that no
//! run has. Whatever is read of them is read or refused with a file's name, without a panic, a hang, or memory that
//! grows.

use std::path::Path;
use std::time::{Duration, Instant};

use pbif::run::{RunError, RunSummary, StoredRun, check_folder};
use pbif::sweep_file::Report;

use crate::common::numbers::Numbers;
use crate::common::room::Room;

/// No reading of such a small run takes as long, on however busy a machine.
const LONGEST: Duration = Duration::from_secs(20);

/// What is read of a run, by its checksums.
const SUMMED: [&str; 4] = ["run.json", "points.csv", "checks.csv", "densities.zarr"];

/// What stands in tables for numbers, and in JSON for values, that no run writes.
#[rustfmt::skip]
const STRANGE: [&str; 12] = [
    "1e999", "-1e308", "NaN", "inf", "", "99999999999999999999", "-1", "null", "[[[[", "\"", "π", "0x1p3",
];

fn damaged(whole: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    let place = numbers.below(bytes.len());
    match numbers.below(8) {
        0 if !bytes.is_empty() => bytes[place] ^= 1 << numbers.below(8),
        1 => bytes.truncate(place),
        2 => bytes.extend_from_slice(whole),
        3 => bytes.extend_from_slice(&whole[place..]),
        4 => bytes.clear(),
        5 => {
            // A number of a text by something else.
            let is_digit = |byte: &u8| byte.is_ascii_digit();
            if let Some(start) = whole[place..].iter().position(is_digit) {
                let start = place + start;
                let length = whole[start..]
                    .iter()
                    .take_while(|byte| is_digit(byte))
                    .count();
                let strange = STRANGE[numbers.below(STRANGE.len())];
                bytes.splice(start..start + length, strange.bytes());
            }
        }
        6 => {
            // A line twice, or away.
            let lines: Vec<&[u8]> = whole.split_inclusive(|&byte| byte == b'\n').collect();
            let line = numbers.below(lines.len());
            let times = 2 * numbers.below(2);
            let kept = lines.iter().enumerate();
            bytes = kept
                .flat_map(|(index, text)| vec![*text; if index == line { times } else { 1 }])
                .flatten()
                .copied()
                .collect();
        }
        _ => {
            for _ in 0..8 {
                let place = numbers.below(bytes.len());
                if let Some(byte) = bytes.get_mut(place) {
                    *byte = numbers.next() as u8;
                }
            }
        }
    }
    bytes
}

/// Reads all there is to read of a run; what is refused names a file, or a place in one.
fn read_all(run: &Path) -> bool {
    let mut whole = true;
    let mut refused = |error: Option<RunError>| {
        if let Some(error) = error {
            assert!(error.to_string().len() < 20_000, "{error}");
            whole = false;
        }
    };
    refused(check_folder(run).err());
    refused(RunSummary::read(run).err());
    match StoredRun::open(run) {
        Err(error) => refused(Some(error)),
        Ok(stored) => {
            let settings = stored.sweep_file().validate();
            match settings.and_then(|settings| settings.fixed()) {
                Err(report) => {
                    assert!(Report::render(&report, false).len() < 60_000);
                    whole = false;
                }
                Ok(sweep) => {
                    refused(stored.detect(&sweep).err());
                    refused(stored.damage().err());
                }
            }
        }
    }
    whole
}

#[test]
fn damaged_runs_are_read_or_refused() {
    let (read, refused) = damaged_runs(400);
    assert!(read > 20 && refused > 100, "{read} read, {refused} refused");
}

/// Half a minute: `cargo test --release --test files stored_fuzz:: -- --ignored`.
#[test]
#[ignore = "takes half a minute"]
fn five_thousand_damaged_runs_are_read_or_refused() {
    let (read, refused) = damaged_runs(5_000);
    assert!(
        read > 200 && refused > 1000,
        "{read} read, {refused} refused"
    );
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
