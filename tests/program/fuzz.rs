//! Fuzzers: damaged sweep files, journals, runs and requests, as many as there is time for. Nothing panics or hangs,
//! what goes on ends with the results that are right, and what serves goes on serving.
//!
//! `cargo test --release --test program fuzz:: -- --ignored --nocapture` takes a minute each; `PBIF_FUZZ_SECONDS` and
//! `PBIF_FUZZ_SEED` say otherwise.

use std::io::{Read as _, Write as _};
use std::net::{Shutdown, TcpStream};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

use pbif::cancellation::Cancellation;
use pbif::job::{Job as _, Progress, Start, SweepJob, carry_out};
use pbif::sweep_file::{Sweep, SweepFile};

use super::live::Served;
use crate::common::damage::{damaged, read_all};
use crate::common::numbers::{Numbers, given};
use crate::common::room::{Room, shipped};
use crate::common::sweeps::prepared;

/// No case takes as long, on however busy a machine.
const LONGEST: Duration = Duration::from_secs(20);

/// Tries cases until the time is over. One that panics or hangs is named by its seed and number.
fn fuzz(what: &str, mut case: impl FnMut(&mut Numbers)) {
    let (seed, seconds) = (given("PBIF_FUZZ_SEED", 1), given("PBIF_FUZZ_SECONDS", 60));
    let (mut numbers, begun, mut tried) = (Numbers(seed), Instant::now(), 0);
    while begun.elapsed() < Duration::from_secs(seconds) {
        let clock = Instant::now();
        let ended = catch_unwind(AssertUnwindSafe(|| case(&mut numbers)));
        tried += 1;
        assert!(ended.is_ok(), "{what}: case {tried} of seed {seed}");
        assert!(
            clock.elapsed() < LONGEST,
            "{what}: case {tried} of seed {seed} takes too long"
        );
    }
    println!("{what}: {tried} cases in {seconds} s, seed {seed}");
}

#[test]
#[ignore = "takes as long as it is given"]
fn damaged_sweep_files_are_checked_or_refused() {
    let folders = [shipped("sweeps"), shipped("sweeps/gallery")];
    let entries = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder).unwrap());
    let files = entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_file());
    let mut files: Vec<Vec<u8>> = files.map(|path| std::fs::read(path).unwrap()).collect();
    files.sort();
    fuzz("sweep files", |numbers| {
        let mut text = files[numbers.below(files.len())].clone();
        for _ in 0..=numbers.below(3) {
            text = damaged(&text, numbers);
        }
        let text = String::from_utf8_lossy(&text);
        if let Err(report) = SweepFile::parse("a.toml", &text).validate() {
            assert!(report.render(false).len() < 60_000);
        }
    });
}

fn small() -> Sweep {
    let text = include_str!("../../sweeps/bistable.toml");
    prepared(text, "sweep.points=5 cells.x.count=20 figures.formats=[]")
}

/// Runs a sweep, or goes on with it, until so many points are done; whether it was done at all.
fn run(sweep: &Sweep, home: &Path, most: usize) -> bool {
    let (mut job, stop) = (SweepJob::new(sweep), Cancellation::new());
    let observer = |step: &Progress<'_>| {
        if matches!(step, Progress::Done { done, .. } if *done >= most) {
            stop.cancel();
        }
    };
    let Ok(start) = job.start(home) else {
        return false;
    };
    assert!(most < usize::MAX || start != Start::Complete);
    carry_out(&mut job, home, start, &stop, &observer).is_ok()
}

#[test]
#[ignore = "takes as long as it is given"]
fn damaged_journals_are_gone_on_with_to_the_same_bytes_or_refused() {
    let (room, sweep) = (Room::new(), small());
    assert!(run(&sweep, &room.path("whole"), usize::MAX));
    assert!(run(&sweep, &room.path("cut"), 3));
    let left = room.files("cut", &[]);
    let tables = ["bifurcations.csv", "features.csv", "checks.csv"];
    let wanted = tables.map(|name| room.bytes(&format!("whole/{name}")));
    fuzz("journals", |numbers| {
        let _ = std::fs::remove_dir_all(room.path("again"));
        for (name, bytes) in &left {
            let path = room.path("again").join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            let is_journal = name == "journal.bin";
            let bytes = if is_journal {
                damaged(bytes, numbers)
            } else {
                bytes.clone()
            };
            std::fs::write(path, bytes).unwrap();
        }
        if run(&sweep, &room.path("again"), usize::MAX) {
            let found = tables.map(|name| room.bytes(&format!("again/{name}")));
            assert!(found == wanted, "other tables");
        }
    });
}

#[test]
#[ignore = "takes as long as it is given"]
fn damaged_runs_are_read_or_refused() {
    let (room, sweep) = (Room::new(), small());
    assert!(run(&sweep, &room.path("run"), usize::MAX));
    let files: Vec<(String, Vec<u8>)> = room.files("run", &["figures"]).into_iter().collect();
    fuzz("runs", |numbers| {
        let (name, whole) = &files[numbers.below(files.len())];
        let path = room.path("run").join(name);
        std::fs::write(&path, damaged(whole, numbers)).unwrap();
        let sums = room.path("run/checksums.sha256");
        let signed = std::fs::read(&sums).unwrap();
        // Without checksums damage is found by what is read.
        if numbers.below(2) == 0 {
            std::fs::remove_file(&sums).unwrap();
        }
        read_all(&room.path("run"));
        std::fs::write(&sums, signed).unwrap();
        std::fs::write(&path, whole).unwrap();
    });
}

#[test]
#[ignore = "takes as long as it is given"]
fn damaged_requests_are_answered_or_refused() {
    let served = Served::new();
    let body = r#"{"lane":"a","ticket":1,"moving":"f_c","values":{"f_c":-0.013,"kappa":0.012}}"#;
    let names = [
        "solve",
        "locate",
        "sweep-file",
        "paths",
        "map",
        "map-progress",
        "",
    ];
    let mut tried = 0;
    fuzz("requests", |numbers| {
        let sound = served.request(names[numbers.below(names.len())], body);
        let mut bytes = sound.into_bytes();
        for _ in 0..=numbers.below(2) {
            bytes = damaged(&bytes, numbers);
        }
        let mut stream = TcpStream::connect(("127.0.0.1", served.port)).unwrap();
        let _ = stream.write_all(&bytes);
        let _ = stream.shutdown(Shutdown::Write);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        tried += 1;
        if tried % 50 == 0 {
            assert_eq!(served.post("solve", body).0, 200);
        }
    });
}
