//! Sources of densities and the methods behind them: accuracy, agreement, work.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

#[path = "../common/mod.rs"]
mod common;

mod agreement;
mod calibration;
mod damping;
mod generator_against_monte_carlo;
mod generator_refinement;
mod generator_sensitivity;
mod generator_work;
mod gibbs;
mod modes_accuracy;
mod sessions;
