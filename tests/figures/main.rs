//! Figures drawn from closed-form densities.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

#[path = "../common/mod.rs"]
mod common;

mod captions;
mod contact;
mod kinds;
mod styles;
mod texts;
