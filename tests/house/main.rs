//! The rules of the house and its pages.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

#[path = "../common/mod.rs"]
mod common;

mod architecture;
mod circles;
mod latex;
mod links;
mod readme;
mod spelling;
mod validation;
