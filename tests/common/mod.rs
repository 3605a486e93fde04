//! What several of the integration programs share. Each takes it in by a path and uses a part of it.

#![allow(dead_code, reason = "a program uses a part of it")]

pub(crate) mod closed_forms;
pub(crate) mod damage;
pub(crate) mod numbers;
pub(crate) mod room;
pub(crate) mod steady;
pub(crate) mod sweeps;
pub(crate) mod table;
