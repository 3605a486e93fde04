//! What several tests of the program share.

use std::process::{Command, Output};

/// Runs the program that was built with the tests.
pub(crate) fn pbif(arguments: &[&str]) -> Output {
    let command = Command::new(env!("CARGO_BIN_EXE_pbif"))
        .args(arguments)
        .output();
    command.unwrap()
}
