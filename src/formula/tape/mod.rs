//! Formulas compiled to a tape of instructions that run on [`LANES`](crate::formula::LANES) states at a time.
//!
//! ```text
//! Program ── bind parameters ──► values ── fuse ──► instructions ── allocate ──► Tape ── run
//! ```
//!
//! A [`Program`] holds some expressions with their common parts; binding parameter values makes a [`Tape`], in which
//! whatever depends on parameters alone is a number. Fusing joins operations that follow each other into one pass over
//! the lanes; it changes neither their order nor their rounding, so that a tape gives the bits of
//! [`Graph::evaluate`](crate::formula::graph::Graph::evaluate) on every instruction set.

mod allocate;
mod fuse;
mod instruction;
mod kernel;
mod polynomial;
mod program;
mod run;
mod values;

pub use program::{BindError, Program};
pub use run::Tape;

#[cfg(test)]
mod tests;
