//! What a formula tells of itself: what it depends on and how, where it is not smooth, its symmetry under reflections,
//! and where it is not a number.

mod affine;
mod dependence;
mod hazard;
mod interval;
mod kink;
mod noise;
mod parity;
mod periodic;
mod reflection;

pub use hazard::{Domain, Hazard, HazardKind};
pub use interval::Interval;
pub use kink::{Kink, KinkKind, KinkPlace, Surface};
pub(crate) use periodic::{NotPeriodic, Wave};
pub(crate) use reflection::Reflection;

#[cfg(test)]
mod tests;
