//! The language of formulas against an independent reader, independent evaluators and differences, and models made of
//! formulas.

#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "../common/mod.rs"]
mod common;

mod derivatives;
mod equations;
mod formulas;
mod hostile;
mod support;
mod twins;
mod typed;
