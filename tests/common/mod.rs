//! What several of the integration programs share. Each takes it in by a path and uses a part of it.

#![allow(dead_code, reason = "a program uses a part of it")]

pub(crate) mod closed_forms;
pub(crate) mod cusp;
pub(crate) mod room;
pub(crate) mod steady;
pub(crate) mod sweeps;
pub(crate) mod trees;

use std::process::{Command, Output};

/// Runs the program that was built with the tests.
pub(crate) fn pbif(arguments: &[&str]) -> Output {
    let command = Command::new(env!("CARGO_BIN_EXE_pbif"))
        .args(arguments)
        .output();
    command.unwrap()
}
