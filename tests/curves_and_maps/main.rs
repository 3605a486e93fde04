//! Curves and maps in planes of two parameters, against what is known exactly.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;

mod codimension_two;
mod codimension_two_kinks;
mod curve_files;
mod curves;
mod levels;
mod map_files;
mod maps;
mod support;
