//! Curves and maps in planes of two parameters, against what is known exactly.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

#[path = "../common/mod.rs"]
mod common;

mod codimension_two;
mod codimension_two_kinks;
mod curves;
mod maps;
