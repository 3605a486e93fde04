//! `pbif check`: every shipped sweep is sound, and what is printed is again a sweep file.

use std::io::{BufRead as _, BufReader};
use std::process::Stdio;

use crate::common::room::{Room, assert_says, shipped};

/// What is printed of a shipped file under settings.
fn checked(name: &str, settings: &str) -> String {
    Room::new()
        .done(&format!("check sweeps/{name}.toml {settings}"))
        .out
}

/// The printed text without its comments.
fn resolved(text: &str) -> String {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn shipped_sweeps_are_sound_and_their_resolved_files_give_the_same() {
    let room = Room::new();
    let entries = std::fs::read_dir(shipped("sweeps")).unwrap();
    let files = entries.map(|entry| entry.unwrap().path());
    let mut checked = 0;
    for file in files.filter(|file| file.is_file()) {
        checked += 1;
        let name = file.file_name().unwrap().to_str().unwrap();
        let text = room.done(&format!("check sweeps/{name}")).out;
        assert!(!text.contains("lies inside"), "{name}:\n{text}");
        room.write(name, &text);
        let again = room.done(&format!("check {name}")).out;
        assert_eq!(resolved(&again), resolved(&text));
    }
    // Nothing was run, so nothing but the copies is there.
    assert!(checked > 0);
    assert_eq!(room.names().len(), checked);
}

#[test]
fn what_takes_long_is_told_while_it_does() {
    // Without the cubic stiffness there is no steady state, which the trials of cells look for at length.
    let room = Room::new();
    let text = std::fs::read_to_string(shipped("sweeps/gallery/bliman_sorine.toml")).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("mu = "));
    room.write("a.toml", lines.collect::<Vec<_>>().join("\n"));
    let mut command = room.command("check a.toml");
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    // It is told before the trials end, which nobody waits for here.
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let words = "trying numbers of cells on coarse grids";
    assert!(lines.any(|line| line.unwrap().contains(words)));
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_system_far_from_its_steady_state_is_judged_without_long_trials() {
    let text = checked("gallery/harvester", "system.parameters.g=1e6");
    assert_says(&text, &["what more change is not known", "no steady state"]);
}

#[test]
fn equations_without_kinks_are_smooth() {
    let text = checked("gallery/vanderpol", "");
    assert_says(&text, &["drift and noise are smooth"]);
}

#[test]
fn the_cost_is_counted() {
    let cells = "cells.x.count=30 cells.y.count=20";
    let steps = "method.kind=sgcm method.samples=100 method.map_step=1 method.time_step=0.01";
    assert_says(
        &checked("coulomb_fc", &format!("{cells} {steps}")),
        &[
            "cells: 30 x 20 = 600",
            "points: 301 (f_c = -0.02, -0.0199, -0.0198, ...)",
            // 600 cells of 4 or 100 transitions of 32 + (8 + 2·4)·9 bytes, and 8·(8 + 8·41 + 2·21 + 8) bytes a cell.
            "memory: 2.3 MB to 12.4 MB",
            "at most 6.000e4 a point (100 a cell)",
            "time steps: 100 a trajectory, at most 6.000e6 a point",
        ],
    );
    let cells = "cells.x={from=-5.5,to=5.5,count=30} cells.y={from=-5.5,to=5.5,count=30}";
    let free = format!("method.kind=monte-carlo method.error=0.02 sweep.points=2 {cells}");
    let left = "chosen when the sweep runs, for a relative error of 0.02";
    // 900 cells of 32 blocks of 16 bytes.
    // Two values of 900 + 60 bins: value, error, and 32 replicates.
    let told = [
        "memory: 460.8 kB",
        "kept: 522.2 kB, the densities of all points",
    ];
    assert_says(&checked("coulomb_fc", &free), &[left, told[0], told[1]]);
    let steps =
        "method.time_step=0.01 method.burn_in=100 method.length=900 method.trajectories=640";
    let given = checked("coulomb_fc", &format!("{free} {steps}"));
    assert_says(&given, &["time steps: 6.400e7 a point"]);
}

#[test]
fn faces_off_the_switching_surface_and_long_sweeps_are_noted() {
    let text = checked(
        "coulomb_fc",
        "cells.y={from=-5.5,to=5.5,count=61} sweep.points=2000",
    );
    assert_says(&text, &["2000 points is a long sweep"]);
    // A surface that stays has a face, whatever the count.
    assert!(!text.contains("lies inside"), "{text}");
    let room = Room::new();
    room.write(
        "belt.toml",
        "system.equations = { x = \"-x\", y = \"-y + 0.5 sign(y - theta)\" }\n\
         system.noise = { x = \"0.6\", y = \"0.5\" }\n\
         sweep = { parameter = \"theta\", from = 0.1, to = 0.8, points = 5 }\n\
         cells = { x = { from = -3, to = 3, count = 30 }, y = { from = -3, to = 3, count = 30 } }\n",
    );
    room.done("check belt.toml")
        .says(&["the switching surface y = 0.1 lies inside a cell: faces do not follow it"]);
    let text = checked("coulomb_fc", "cells.x={from=-5.5,to=5.5,count=61}");
    assert_says(&text, &["the centre of symmetry x = 0 lies inside a cell"]);
}

#[test]
fn the_range_of_z_is_the_widest_of_the_sweep() {
    // |z| ≤ f_c/λ = 0.05/0.06.
    let range = "z = { from = -0.8333333333333334, to = 0.8333333333333334";
    assert_says(&checked("dahl_alpha", ""), &[range]);
    let room = Room::new();
    let text = std::fs::read_to_string(shipped("sweeps/dahl_alpha.toml")).unwrap();
    room.write("f_c.toml", text.replace("f_c = 0.05", "alpha = -0.5"));
    let sweep = "sweep.parameter=f_c sweep.from=0.06 sweep.to=0.03 figures.at=[]";
    let printed = room.done(&format!("check f_c.toml {sweep}"));
    printed.says(&["z = { from = -1.0, to = 1.0, count = 16,"]);
}

#[test]
fn figures_outside_a_part_of_the_sweep_are_left_out_with_one_warning() {
    let (room, part) = (
        Room::new(),
        "check sweeps/dahl_alpha.toml sweep.from=0 sweep.to=-0.6",
    );
    let printed = room
        .done(part)
        .says(&["at = [0.0, -0.5]", "`0.5`, `-1`, outside the sweep"]);
    assert_eq!(printed.err.matches("warning").count(), 1, "{printed:?}");
    // What was set in the same breath is refused.
    let words = ["`figures.at` has 0.5, outside the sweep"];
    room.refused(&format!("{part} figures.at=[0.5]"), &words);
}

#[test]
fn starting_files_warn_of_nothing() {
    for file in pbif::sweep_file::starting_files() {
        let settings = crate::common::sweeps::settings(file.text, "");
        let warnings = settings.warnings.render(false);
        assert!(settings.warnings.is_empty(), "{}: {warnings}", file.name);
    }
}
