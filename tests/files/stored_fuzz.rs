//! Thousands of damaged runs, by a fixed seed: bytes flipped, files cut, doubled and emptied, numbers put in that no
//! run has. Whatever is read of them is read or refused with a file's name, without a panic, a hang, or memory that
//! grows.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::common::pbif;
use pbif::run::{RunError, RunSummary, StoredRun, check_folder};
use pbif::sweep_file::Report;

/// No reading of such a small run takes as long, on however busy a machine.
const LONGEST: Duration = Duration::from_secs(20);

/// A small generator of numbers (splitmix64), so that a case is the same every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// Every file below a folder, sorted, without pictures.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            found.push(path);
        }
    }
    found.retain(|path| !path.components().any(|part| part.as_os_str() == "figures"));
    found.sort();
    found
}

/// What stands in tables for numbers, and in JSON for values, that no run writes.
const STRANGE: [&str; 12] = [
    "1e999",
    "-1e308",
    "NaN",
    "inf",
    "",
    "99999999999999999999",
    "-1",
    "null",
    "[[[[",
    "\"",
    "π",
    "0x1p3",
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
            let spec = stored.sweep_file().validate();
            let spec = spec.and_then(|settings| settings.fixed());
            match spec {
                Err(report) => assert!(Report::render(&report, false).len() < 60_000),
                Ok(spec) => {
                    refused(stored.detect(&spec).err());
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
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut numbers = Numbers(14);
    let (mut read, mut refused) = (0, 0);
    // One axis with checks; two axes with a quantity. Small, since each is read thousands of times.
    let sweeps: [(&str, &[&str]); 2] = [
        ("bistable", &["sweep.points=3", "cells.x.count=20"]),
        (
            "rayleigh_energy",
            &[
                "sweep.points=3",
                "cells.x.count=12",
                "cells.y.count=12",
                "locate.grid_check=\"off\"",
            ],
        ),
    ];
    for (name, settings) in sweeps {
        let run = folder.path().join(name);
        let file = root.join("sweeps").join(format!("{name}.toml"));
        let mut arguments = vec!["sweep", file.to_str().unwrap(), "--quiet", "--out"];
        arguments.push(run.to_str().unwrap());
        for setting in settings.iter().chain(&["figures.formats=[\"svg\"]"]) {
            arguments.extend(["--set", setting]);
        }
        let made = pbif(&arguments);
        assert!(matches!(made.status.code(), Some(0 | 1)), "{made:?}");
        assert!(read_all(&run));
        let files = files(&run);
        let sums = run.join("checksums.sha256");
        let signed = std::fs::read(&sums).unwrap();
        for case in 0..cases / sweeps.len() {
            // Tables and manifest are small and say most: every other case is one of them.
            let tables: Vec<&PathBuf> = files
                .iter()
                .filter(|path| path.parent() == Some(&run))
                .collect();
            let path = match case % 2 {
                0 => tables[numbers.below(tables.len())],
                _ => &files[numbers.below(files.len())],
            };
            let whole = std::fs::read(path).unwrap();
            // Without checksums, as in unfinished runs, damage is found by what is read.
            let is_signed = case % 3 == 0;
            if !is_signed {
                let _ = std::fs::remove_file(&sums);
            }
            match numbers.below(40) {
                0 => std::fs::remove_file(path).or_else(|error| match path == &sums {
                    true => Ok(()),
                    false => Err(error),
                }),
                _ => std::fs::write(path, damaged(&whole, &mut numbers)),
            }
            .unwrap();
            let clock = Instant::now();
            match read_all(&run) {
                true => read += 1,
                false => refused += 1,
            }
            assert!(clock.elapsed() < LONGEST, "{name}, case {case}: {path:?}");
            std::fs::write(path, whole).unwrap();
            std::fs::write(&sums, &signed).unwrap();
        }
    }
    (read, refused)
}
