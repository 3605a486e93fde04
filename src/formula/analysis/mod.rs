//! What a formula tells of itself: what it depends on and how, where it is not smooth, its symmetry under reflections,
//! and where it is not a number.

mod affine;
mod dependence;
mod hazard;
mod interval;
mod kink;
mod noise;
mod parity;
mod reflection;

pub use affine::Affine;
pub use dependence::Dependence;
pub use hazard::{Domain, Hazard, HazardKind};
pub use interval::Interval;
pub use kink::{Kink, KinkKind, KinkPlace, Surface};
pub use parity::{Parity, ParityFinding};
pub use reflection::{Reflection, ReflectionError};

#[cfg(test)]
mod tests;
