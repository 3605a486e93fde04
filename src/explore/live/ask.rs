//! What the page asks for, as it arrives.

use std::collections::BTreeMap;

use serde::Deserialize;

/// Asks for the densities at some values.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AskSolve {
    /// Requests of one lane replace each other.
    pub(super) lane: String,
    /// Rises along a lane.
    pub(super) ticket: u64,
    /// The parameter that moves: neighbouring requests differ in it alone.
    pub(super) moving: String,
    /// Values of the parameters; the sweep's where one is left out.
    pub(super) values: BTreeMap<String, f64>,
    /// On half as many cells an axis.
    #[serde(default)]
    pub(super) preview: bool,
    /// Without the values of joint densities.
    #[serde(default)]
    pub(super) marginals_only: bool,
}

/// Asks for sample paths.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AskPaths {
    pub(super) lane: String,
    pub(super) ticket: u64,
    /// Values of the parameters, that of the swept one among them.
    pub(super) values: BTreeMap<String, f64>,
    pub(super) starts: Vec<Start>,
    /// How long a path is, at most: see [`crate::monte_carlo::PathRun::over_turns`].
    pub(super) turns: f64,
}

/// Where a path starts, and what its noise is keyed by.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Start {
    /// One coordinate an axis.
    pub(super) state: Vec<f64>,
    pub(super) seed: u64,
}

/// Asks for the changes between two values of the swept parameter.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AskLocate {
    pub(super) lane: String,
    pub(super) ticket: u64,
    pub(super) values: BTreeMap<String, f64>,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// Asks for a sweep file with these values of the parameters that are not swept.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AskSweepFile {
    pub(super) values: BTreeMap<String, f64>,
}

/// Asks for the map of the plane at these values of the parameters that do not span it, or that the one in the making
/// be given up.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AskMap {
    pub(super) lane: String,
    pub(super) ticket: u64,
    pub(super) values: BTreeMap<String, f64>,
    #[serde(default)]
    pub(super) stop: bool,
}

/// Asks how far the map of a lane is.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AskMapProgress {
    pub(super) lane: String,
}
