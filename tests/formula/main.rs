//! The language of formulas against an independent reader, independent evaluators, and differences.

mod derivatives;
mod formulas;
mod hostile;
mod support;
