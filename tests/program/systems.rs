//! `pbif systems`, and the help that every command has.

use crate::common::room::Room;

#[test]
fn the_list_names_every_model() {
    let printed = Room::new().done("systems");
    assert!(printed.err.is_empty() && !printed.out.contains('\u{1b}'));
    let names = "coulomb dahl dahl_eq8 stribeck lugre elasto_plastic bouc_wen rayleigh bistable";
    for name in names.split(' ') {
        assert!(printed.out.contains(&format!("| {name} ")), "{printed:?}");
    }
}

#[test]
fn a_model_is_shown_in_full() {
    Room::new().done("systems dahl").says(&[
        "z' = y - (λ |y|/f_c) z",
        "Axes",
        "| lambda ",
        "must be given",
        "a finite number greater than zero",
        "x  unbounded",
        "z  from -1 to 1 at ",
        "Switching surfaces\n  y = 0",
        "(x, y, z) -> (-x, -y, -z)",
        "Source",
        "Notes",
    ]);
}

#[test]
fn an_unknown_model_comes_with_the_nearest() {
    let words = ["unknown model `columb`", "did you mean `coulomb`?"];
    assert_eq!(Room::new().refused("systems columb", &words).out, "");
}

#[test]
fn help_has_examples_and_every_key() {
    let room = Room::new();
    let text = room.done("--help").out;
    assert!(text.contains("pbif check sweeps/coulomb_fc.toml") && text.contains("Exit status"));
    room.done("sweep --help").says(&[
        "method.solver_tolerance",
        "default: 1e-8 by generator, 1e-10 by sgcm",
        "cells.<axis>.grade.at",
        "--set",
    ]);
    room.done("--version");
    room.run("").ends(2);
}
