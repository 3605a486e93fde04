//! Files and folders that are not what they seem: altered, piped, linked out of a run, removed while a run writes,
//! named to drive a terminal. What is read is checked, what is written stays in its place.

#![cfg(unix)]

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt as _;
use std::process::Command;

use super::killing::{size, started, stopped_at, wait_until};
use crate::common::room::{Printed, Room, assert_says};

const SWEEP: &str = "sweep sweeps/bistable.toml --quiet sweep.points=5 figures.formats=[\"svg\"]";

fn swept() -> Room {
    let room = Room::new();
    room.done(&format!("{SWEEP} --out a"));
    room
}

/// Whatever reads a run.
const READERS: [&str; 4] = [
    "plot a --quiet --out b",
    "detect a --quiet --out b",
    "export a --out b",
    "explore a --html b.html",
];

#[test]
fn every_reader_checks_what_it_reads() {
    let room = swept();
    for (file, readers) in [
        ("run.json", &["show a", "cite a"][..]),
        ("bifurcations.json", &["show a"]),
        ("points.csv", &READERS),
        ("run.json", &READERS),
        ("densities.zarr/p_x/zarr.json", &READERS),
    ] {
        let name = format!("a/{file}");
        let whole = room.read(&name);
        room.write(&name, format!("{whole}\n"));
        for reader in readers {
            room.refused(reader, &[&name, "is changed"]);
        }
        room.run("verify a").ends(1).says(&[&name, "changed"]);
        room.write(&name, whole);
    }
    room.done("verify a");
}

#[test]
fn a_pipe_in_the_place_of_a_file_is_not_waited_for() {
    for file in [
        "points.csv",
        "bifurcations.json",
        "densities.zarr/p_x/c/0/0",
    ] {
        let room = swept();
        let path = room.path(&format!("a/{file}"));
        std::fs::remove_file(&path).unwrap();
        assert!(
            Command::new("mkfifo")
                .arg(&path)
                .status()
                .unwrap()
                .success()
        );
        for is_signed in [true, false] {
            if !is_signed {
                std::fs::remove_file(room.path("a/checksums.sha256")).unwrap();
            }
            for reader in ["show a", "list .", "verify a"].iter().chain(&READERS) {
                let told = room.run(reader);
                assert!(told.code.is_some(), "{told:?}");
                let reads = READERS.contains(reader) && !file.starts_with("bif");
                assert!(!reads || told.code == Some(2), "{told:?}");
            }
        }
    }
}

#[test]
fn results_go_to_places_of_their_own() {
    let room = swept();
    let before = room.files("a", &[]);
    let detect = "detect a --quiet";
    for line in [SWEEP, detect, "plot a", "export a --format csv"] {
        for place in [
            "/",
            "a/densities.zarr",
            "a/densities.zarr/p_x/new",
            "a/figures/../densities.zarr/x",
        ] {
            let words = match place {
                "/" => ["is no place for results", "root of the file system"],
                _ => ["", "a"],
            };
            // An export says of what is there that it is.
            let words = if line.starts_with("export") {
                ["", ""]
            } else {
                words
            };
            room.refused(&format!("{line} --out {place}"), &words);
        }
    }
    assert!(
        before == room.files("a", &[]),
        "something was written into a run"
    );
    let mut command = room.command(SWEEP);
    let output = command
        .arg("--out")
        .arg(OsStr::from_bytes(b"o\xff"))
        .output();
    let output = output.unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.code() == Some(2) && told.contains("is not UTF-8"),
        "{told}"
    );
    assert_eq!(room.names(), ["a"]);
    // A run that was given such a name later is read.
    let renamed = OsStr::from_bytes(b"a\xff");
    std::fs::rename(room.path("a"), room.path("").join(renamed)).unwrap();
    let mut command = room.command("export --format csv --out tables");
    assert!(command.arg(renamed).status().unwrap().success());
}

#[test]
fn a_link_that_leads_nowhere_is_told_as_one() {
    let room = Room::new();
    std::os::unix::fs::symlink("nowhere", room.path("a")).unwrap();
    let words = ["`a` is a link that leads nowhere", "--out DIR"];
    room.refused(&format!("{SWEEP} --out a"), &words);
    assert_eq!(room.names(), ["a"]);
}

#[test]
fn figures_are_not_drawn_through_a_link_out_of_the_run() {
    let room = swept();
    std::fs::rename(room.path("a/figures"), room.path("mine")).unwrap();
    std::os::unix::fs::symlink(room.path("mine"), room.path("a/figures")).unwrap();
    let before = room.files("mine", &[]);
    room.refused("plot a --style dark", &["a/figures", "out of the run"]);
    assert!(before == room.files("mine", &[]));
    room.done("plot a --style dark --out drawn");
}

#[test]
fn a_folder_that_is_removed_under_a_run_ends_it() {
    let room = Room::new();
    let sweep = "sweep sweeps/bistable.toml sweep.points=20000 --quiet --out a";
    let mut child = started(&room, sweep);
    let table = room.path("a/points.csv");
    assert!(wait_until(&mut child, || size(&table) > 5_000));
    std::fs::rename(room.path("a"), room.path("b")).unwrap();
    let code = child.wait().unwrap().code();
    assert_eq!((code, room.names()), (Some(2), vec!["b".to_owned()]));
}

#[test]
fn names_and_texts_of_others_do_not_drive_the_terminal() {
    let room = swept();
    std::fs::remove_file(room.path("a/checksums.sha256")).unwrap();
    let title = "\"title\": \"Particle in a quartic potential";
    room.change(
        "a/run.json",
        title,
        &format!("{title}\\u001b]0;mine\\u0007\\u001b[2J\\r"),
    );
    let foreign = "a\u{1b}[31m\u{9b}2J";
    std::fs::rename(room.path("a"), room.path(foreign)).unwrap();
    let verified = format!("verify '{foreign}'");
    let sweep = format!("{SWEEP} --out '{foreign}'");
    let plot = format!("plot '{foreign}' --only none");
    let show = format!("show '{foreign}'");
    let new = format!("new '{foreign}.toml'");
    for line in [
        "list .",
        &show,
        &verified,
        &format!("cite '{foreign}'"),
        &plot,
        &sweep,
        &new,
    ] {
        let text = room.run(line).text();
        let is_harmless = |c: char| c == '\n' || c == '\t' || !c.is_control();
        assert!(text.chars().all(is_harmless), "{line}: {text:?}");
    }
}

/// A line of the program under a limit of the shell.
fn limited(room: &Room, limit: &str, line: &str) -> Printed {
    let command = room.command(line);
    let mut shell = Command::new("sh");
    shell
        .current_dir(room.path(""))
        .arg("-c")
        .arg(format!("ulimit {limit}; exec \"$0\" \"$@\""))
        // Every thread has a heap of its own: what fits depends on how many there are.
        .env("RAYON_NUM_THREADS", "2");
    let shell = shell.arg(command.get_program()).args(command.get_args());
    Printed::of(line, shell.output().unwrap())
}

#[test]
#[rustfmt::skip]
fn limits_of_a_process_are_told() {
    let room = swept();
    for (limit, line, words) in [
        ("-f 8", format!("{SWEEP} --out b"), ["cannot write", "File too large"]),
        ("-f 2", "export a --out a.nc".to_owned(), ["cannot write", "ile too large"]),
        (
            "-v 1000000",
            "sweep sweeps/coulomb_fc.toml --out b cells.x={from=-5,to=5,count=700} cells.y={from=-5,to=5,count=700}".to_owned(),
            [
                "of memory, and the system gives this process less",
                "ulimit -v",
            ],
        ),
        (
            // Of 301 points 34 numbers a bin are kept.
            "-v 1000000",
            "sweep sweeps/coulomb_fc.toml --out b method.kind=monte-carlo --threads 1".to_owned(),
            [
                "of memory, and the system gives this process less",
                "fewer points",
            ],
        ),
    ] {
        limited(&room, limit, &line).ends(2).says(&words);
    }
}

#[test]
fn a_run_with_more_densities_than_memory_is_refused_with_a_sentence() {
    let room = Room::new();
    let cells = "sweep.points=301 cells.x.count=2000 locate.effort=0 figures.formats=[]";
    room.solved(&format!(
        "sweep sweeps/bistable.toml {cells} --quiet --out run"
    ));
    let mut refused = 0;
    for megabytes in [150, 200, 250, 300, 400, 1500] {
        let limit = format!("-v {}", 1_000 * megabytes);
        for line in [
            "show run",
            "list run",
            "verify run",
            "detect run --quiet figures.formats=[]",
        ] {
            let told = limited(&room, &limit, line);
            assert!(matches!(told.code, Some(0 | 2)), "{megabytes} MB: {told:?}");
            if told.code == Some(2) {
                refused += 1;
                assert_says(&told.err, &["of memory, and the system gives", "ulimit -v"]);
            }
        }
    }
    assert!((1..6).contains(&refused), "{refused}");
}

#[test]
fn whatever_memory_a_process_is_given_it_ends_with_a_sentence() {
    let room = Room::new();
    let sweep =
        "sweep sweeps/coulomb_fc.toml sweep.points=3 figures.formats=[] --threads 2 --quiet";
    let mut refused = 0;
    for megabytes in [60, 150, 250, 300, 350, 400, 450, 600, 800, 1000] {
        let limit = format!("-v {}", 1_000 * megabytes);
        let told = limited(&room, &limit, &format!("{sweep} --out o{megabytes}"));
        assert!(matches!(told.code, Some(0..=2)), "{megabytes} MB: {told:?}");
        if told.code == Some(2) {
            refused += 1;
            assert_says(
                &told.err,
                &[
                    "of memory, and the system gives this process less",
                    "--threads",
                ],
            );
            assert!(!room.holds(&format!("o{megabytes}")));
        }
    }
    assert!(refused > 2 && refused < 10, "{refused}");
}

#[test]
fn a_large_run_that_is_interrupted_ends_at_once_and_goes_on() {
    let room = Room::new();
    let line = "sweep sweeps/bistable.toml sweep.points=400 figures.formats=[\"svg\"] --out a";
    assert!(stopped_at(&room, line, 250, "-TERM"));
    assert!(!room.holds("a/figures") && !room.holds("a/checksums.sha256"));
    room.done("show a").says(&["unfinished"]);
    room.done("plot a --out drawn");
    room.done(&format!("{line} --resume"));
    room.done("verify a");
}
