//! The sweep file: text, a document whose values know their places, checked values, and a validated sweep, which can be
//! written as TOML again. What is wrong comes as a [`Report`] that shows file, line and column.

mod diagnostic;
mod document;
mod keys;
mod reader;
mod spec;

pub use diagnostic::{Diagnostic, Place, Report, Sources, list};
pub use keys::help;
pub use spec::{AxisCells, EveryMethod, SweepSpec};
