//! The program as its user drives it: commands, settings, tables, messages, pages.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

#[path = "../common/mod.rs"]
mod common;

mod bad_input;
mod changed_files;
mod check;
mod compare;
mod composition;
mod detect;
mod early_passages;
mod editor;
mod explorer;
mod exponents;
mod fuzz;
mod live;
mod monte_carlo;
mod names;
mod pages;
mod paper;
mod passages;
mod paths;
mod quantities;
mod relaxation;
mod spectra;
mod sweep;
mod systems;
mod thin_regions;
mod told_early;
