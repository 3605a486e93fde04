//! Run folders: listed, killed and gone on with, cut into shards, damaged.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr
)]

#[path = "../common/mod.rs"]
mod common;

mod killing;
mod kills;
mod places;
mod resume;
mod resume_others;
mod runs;
mod shards;
mod stored_fuzz;
