//! The program as its user drives it: commands, settings, tables, messages, pages.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

mod bad_input;
mod check;
mod compare;
mod composition;
mod detect;
mod explorer;
mod monte_carlo;
mod paper;
mod quantities;
mod sweep;
mod systems;
