//! `pbif systems`, and the help that every command has.

use std::process::Command;

fn run(arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pbif"));
    let output = command.args(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (
        output.status.code().unwrap(),
        text(output.stdout),
        text(output.stderr),
    )
}

#[test]
fn the_list_names_every_model() {
    let (code, list, errors) = run(&["systems"]);
    assert_eq!((code, errors.as_str()), (0, ""));
    for name in [
        "coulomb",
        "dahl",
        "dahl_eq8",
        "stribeck",
        "lugre",
        "elasto_plastic",
        "bouc_wen",
        "rayleigh",
        "bistable",
    ] {
        assert!(list.contains(&format!("| {name} ")), "{list}");
    }
    assert!(!list.contains('\u{1b}'));
}

#[test]
fn a_model_is_shown_in_full() {
    let (code, text, _) = run(&["systems", "dahl"]);
    assert_eq!(code, 0);
    for words in [
        "z' = y - (λ |y| / f_c) z",
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
    ] {
        assert!(text.contains(words), "{words} not in\n{text}");
    }
}

#[test]
fn an_unknown_model_comes_with_the_nearest() {
    let (code, list, errors) = run(&["systems", "columb"]);
    assert_eq!((code, list.as_str()), (2, ""));
    assert!(
        errors.contains("unknown model `columb`") && errors.contains("did you mean `coulomb`?")
    );
}

#[test]
fn help_has_examples_and_every_key() {
    let (code, text, _) = run(&["--help"]);
    assert_eq!(code, 0);
    assert!(text.contains("pbif check sweeps/coulomb_fc.toml") && text.contains("Exit status"));
    let (code, text, _) = run(&["sweep", "--help"]);
    assert_eq!(code, 0);
    for words in [
        "method.solver_tolerance",
        "default: 1e-8 by generator, 1e-10 by sgcm",
        "cells.<axis>.grade.at",
        "--set",
    ] {
        assert!(text.contains(words), "{words} not in\n{text}");
    }
    assert_eq!(run(&["--version"]).0, 0);
    assert_eq!(run(&[]).0, 2);
}
