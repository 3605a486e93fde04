//! Steady-state probability densities of noisy, possibly non-smooth oscillators, and the parameter
//! values where their topology changes (stochastic P-bifurcations).
//!
//! | task | module |
//! | --- | --- |
//! | read formulas, differentiate and analyse them, run them on many states at a time | [`formula`] |
//! | state a model, look up the built-in ones | [`system`] |
//! | ask long work to stop | [`cancellation`] |
//! | the largest Lyapunov exponent of a fixed point | [`exponent`] |
//! | lay a grid of cells over the domain | [`space`] |
//! | turn masses into densities, marginals, moments, distances | [`density`] |
//! | sample a transition matrix by trajectories (SGCM) | [`sampling`] |
//! | run free trajectories: reference densities, relaxation times, the bias of a time step | [`monte_carlo`] |
//! | discretise the generator, the cell map in the limit of a short step | [`generator`] |
//! | find the steady state of a transition matrix | [`stationary`] |
//! | count significant peaks and craters | [`topology`] |
//! | sweep a parameter and locate changes of topology | [`continuation`] |
//! | join the above into a source of densities | [`method`] |
//! | set the methods side by side: distances with uncertainties, times | [`compare`] |
//! | draw | [`figure`] |
//! | read, check and write sweep files | [`sweep_file`] |
//! | write tables and arrays, and read them back | [`run`] |
//! | carry out what a sweep file asks for, into a folder | [`job`] |
//! | put a sweep into one page that slides along it | [`explore`] |
//! | the program `pbif` | [`cli`] |
//!
//! Modules depend on those above them in this table, never the other way.

// What only a later module uses lies idle where features leave that module out; the whole build says what nobody uses.
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]

#[macro_use]
mod words;

#[cfg(feature = "serde")]
mod bytes;
pub mod cancellation;
#[cfg(feature = "cli")]
pub mod cli;
pub mod compare;
pub mod continuation;
pub mod density;
#[cfg(feature = "cli")]
pub mod explore;
pub mod exponent;
#[cfg(any(feature = "figures", feature = "store"))]
pub mod figure;
pub mod formula;
pub mod generator;
#[cfg(all(feature = "store", feature = "figures"))]
pub mod job;
pub mod method;
pub mod monte_carlo;
mod numerics;
pub mod passage;
#[cfg(feature = "store")]
pub mod run;
pub mod sampling;
pub mod space;
pub mod spectrum;
pub mod stationary;
#[cfg(feature = "store")]
pub mod sweep_file;
pub mod system;
pub mod topology;

/// Largest dimension of a state and of a cell space.
pub const MAX_DIMENSION: usize = 4;

/// How a page of the explorer begins: what does not begin so is none of this program's.
#[cfg(feature = "cli")]
pub(crate) const PAGE: &str = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"generator\" content=\"pbif\">\n";

/// Beginning of the names of files and folders that are in the making, or taken out of the way.
#[cfg(any(feature = "figures", feature = "store"))]
pub(crate) const UNFINISHED: &str = ".pbif-";
