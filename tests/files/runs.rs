//! Runs as their user looks at them: listed, shown, exported, removed.

use std::process::Command;

use crate::common::room::{Printed, Room, assert_says, shipped};

const SWEEP: &str = "sweep sweeps/bistable.toml --quiet sweep.points=9 figures.formats=[\"svg\"]";

fn sweep(room: &Room, options: &str) {
    room.done(&format!("{SWEEP} {options}"));
}

/// Makes a run unfinished, as a kill before its figures leaves it.
fn unfinish(room: &Room, run: &str) {
    room.change(&format!("{run}/run.json"), "\"complete\"", "\"running\"");
    std::fs::remove_file(room.path(run).join("checksums.sha256")).unwrap();
    std::fs::remove_dir_all(room.path(run).join("figures")).unwrap();
}

#[test]
#[rustfmt::skip]
fn runs_are_listed_with_their_versions_and_shards_and_shown() {
    let room = Room::new();
    room.refused("list", &["`output` is not a folder", "pbif sweep FILE"]);
    sweep(&room, "");
    sweep(&room, "system.parameters.sigma2=0.5");
    sweep(&room, "--shard 1/2");
    let listed = room.done("list").text();
    for (name, words) in [
        ("output/bistable", ["bistable: a -1 to 1", "complete, ", "located"]),
        ("output/bistable/previous/1", ["complete, ", "located", ""]),
        ("output/bistable/shards/1-of-2", ["shard 1/2", "complete", ""]),
    ] {
        let is_it = |line: &&str| line.split_whitespace().next() == Some(name);
        let line = listed.lines().find(is_it);
        assert_says(
            line.unwrap_or_else(|| panic!("{name} not in\n{listed}")),
            &words,
        );
    }
    room.done("show output/bistable").says(&[
        "Particle in a quartic potential",
        "sigma2 = 0.5",
        "a from -1 to 1, 9 given values",
        "x 100 from -2.2 to 2.2",
        "previous/1: complete",
        "1 peak → 2 peaks",
        "located",
    ]);
    // The sweep file that is shown is the run's.
    let shown = room.done("show output/bistable/previous/1 --sweep");
    room.write("again.toml", shown.says(&["sigma2 = 0.25"]).text());
    room.done("sweep again.toml --resume --out output/bistable/previous/1");
    room.refused(
        "show nowhere",
        &["is not the folder of a run", "output/coulomb_fc"],
    );
    unfinish(&room, "output/bistable");
    room.done("list output/bistable").says(&["unfinished, "]);
}

#[test]
fn earlier_and_unfinished_runs_are_removed_when_asked_and_nothing_else() {
    let room = Room::new();
    sweep(&room, "--out a");
    room.done("clean a").says(&["nothing to remove"]);
    sweep(&room, "--out a title=second");
    sweep(&room, "--out b");
    unfinish(&room, "b");
    room.write("a/previous/1/notes.txt", "mine");
    room.write("a/previous/1/densities.zarr/notes.txt", "mine");
    room.write("a/previous/1/points.csv", "by hand");
    // Without a terminal nobody can be asked.
    let words = ["earlier", "a/previous/1", "unfinished", "2 runs", "--yes"];
    room.refused("clean .", &words);
    assert!(room.holds("a/previous/1/run.json") && room.holds("b/run.json"));
    room.done("clean . --unfinished --yes");
    assert!(!room.holds("b") && room.holds("a/previous/1/run.json"));
    room.done("clean . --yes").says(&[
        "1 run removed",
        "a/previous/1/densities.zarr/notes.txt: not of the run",
        "a/previous/1/points.csv: changed since the run ended",
    ]);
    assert_eq!(room.files("a/previous/1", &[]).len(), 3);
    room.done("verify a").says(&["as the run left them"]);
    room.refused("clean nowhere", &["holds no runs"]);
}

#[test]
fn figures_of_a_user_stay_theirs_when_others_are_drawn_again() {
    let room = Room::new();
    sweep(&room, "--out a");
    std::fs::create_dir_all(room.path("a/figures/paper")).unwrap();
    room.write("a/figures/paper/fig1.tex", "mine");
    room.write("a/figures/diagram_x.svg", "edited by hand");
    room.done("plot a --only marginals --format svg");
    let told = room.run("verify a");
    assert!(format!("{}{}", told.out, told.err).contains("diagram_x.svg"));
    sweep(&room, "--out a title=second");
    room.done("clean a --yes")
        .says(&["diagram_x.svg", "fig1.tex"]);
    let left = room.read("a/previous/1/figures/diagram_x.svg");
    assert_eq!(left, "edited by hand");
    assert_eq!(room.read("a/previous/1/figures/paper/fig1.tex"), "mine");
}

#[test]
fn runs_are_exported_and_nothing_is_overwritten() {
    let room = Room::new();
    sweep(&room, "--out runs/a");
    room.done("export runs/a").says(&["runs/a.nc: p_x at "]);
    assert!(room.bytes("runs/a.nc").starts_with(b"CDF\x02"));
    room.refused("export runs/a", &["is there already", "--out PATH"]);
    room.done("export runs/a --out b/c.nc");
    assert!(room.holds("b/c.nc"));
    room.done("export runs/a --format csv");
    let [table, points] =
        ["runs/a-csv/p_x.csv", "runs/a/points.csv"].map(|name| room.read(name).lines().count());
    assert_eq!(table - 1, 100 * (points - 1));
    room.refused("export runs/a --format hdf", &["netcdf, csv"]);
    // Python's readers, where they are installed: values and normalisation.
    let numpy = Command::new("python3")
        .args(["-c", "import numpy"])
        .status();
    if numpy.is_ok_and(|status| status.success()) {
        let mut python = Command::new("python3");
        let python = python.arg(shipped("examples/python/read_store.py"));
        let output = python
            .args(["runs/a", "a"])
            .current_dir(room.path(""))
            .output();
        let printed = Printed::of("read_store.py", output.unwrap());
        printed.ends(0).says(&["a = -1: highest at x = "]);
    }
    let matplotlib = Command::new("python3")
        .args(["-c", "import matplotlib"])
        .status();
    if matplotlib.is_ok_and(|status| status.success()) {
        let mut python = Command::new("python3");
        let python = python.arg(shipped("examples/python/redraw.py"));
        let output = python
            .args(["runs/a", "--out", "drawn.png"])
            .current_dir(room.path(""))
            .output();
        let printed = Printed::of("redraw.py", output.unwrap());
        printed.ends(0).says(&["PB1: a = "]);
        assert!(room.holds("drawn.png"));
    }
}

#[test]
fn shells_and_man_are_told_of_every_command() {
    let room = Room::new();
    room.done("completions bash").says(&["_pbif()", "--shard"]);
    room.refused("completions tcsh", &["bash", "fish", "zsh"]);
    room.done("man").says(&[".TH pbif", "EXTRA"]);
    room.done("man --out man1");
    assert_says(&room.read("man1/pbif-sweep.1"), &["shard"]);
}

#[test]
fn points_are_solved_again_and_runs_are_cited() {
    let room = Room::new();
    sweep(&room, "--out a");
    let again = "3 of 3 points that were solved again";
    let printed = room.done("verify a --recompute 3");
    printed.says(&["files are as the run left them", again]);
    // More than there are is all of them. Without checksums a strange density is found by solving alone.
    let strange = room.bytes("a/densities.zarr/p_x/c/0/0");
    assert_ne!(strange, room.bytes("a/densities.zarr/p_x/c/5/0"));
    room.write("a/densities.zarr/p_x/c/5/0", strange);
    std::fs::remove_file(room.path("a/checksums.sha256")).unwrap();
    let printed = room.run("verify a --recompute 1000").ends(1);
    let text = printed.says(&["no checksums", "ANOTHER density"]).text();
    assert_eq!(text.matches("ANOTHER").count(), 1, "{text}");
    room.done("cite a").says(&[
        "@software{pbif,",
        "version = {0.1.0}",
        "@misc{model-bistable,",
        "@article{scharfetter1969,",
    ]);
    room.done("cite").says(&["@software{pbif,"]);
    room.refused("cite nothing", &["is not the folder of a run"]);
}
