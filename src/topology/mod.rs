//! What a density looks like: its significant peaks and craters, and the signature they make.

mod between;
mod border;
mod candidate;
mod closed;
mod critical;
mod detector;
mod enclosure;
mod exact;
mod extremum;
mod field;
mod indicator;
mod narrowness;
mod persistence;
mod place_error;
mod quadratic;
mod reconstruction;
mod refine;
mod ridge;
mod rim;
mod shape;
mod signature;
mod significance;
mod surroundings;
mod valley;

#[cfg(test)]
mod analytic_tests;
#[cfg(test)]
mod calibration_tests;
#[cfg(test)]
mod invariance_tests;

pub(crate) use between::Between;
pub(crate) use border::{basin, crest};
pub use detector::PersistenceDetector;
pub use indicator::{Flank, Indicator, IndicatorKind};
pub(crate) use indicator::{Step, born_at_kink, is_clear, peaks_at_ends, two_sided_limit};
pub(crate) use narrowness::reading_error;
pub use signature::Signature;

use crate::density::EstimatedDensity;

/// Settings of detection.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectOptions {
    /// Probability that no feature of the whole sweep is noise.
    pub confidence: f64,
    /// Smallest persistence that counts, as a share of the density's maximum.
    pub floor: f64,
}

impl Default for DetectOptions {
    fn default() -> Self {
        Self {
            confidence: 0.95,
            // A rim of constant height has peaks of this size from the cells alone.
            floor: 1e-3,
        }
    }
}

/// Kinds of features.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum FeatureKind {
    /// A local maximum.
    Peak,
    /// The lowest point between two peaks (in two dimensions the saddle that joins them).
    Valley,
    /// A local minimum enclosed by a ridge (two dimensions only).
    Crater,
    /// A maximum along a closed curve, of constant height within the density's error (two dimensions only); its place
    /// is one point of the curve.
    Ring,
}

/// Whether a feature is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Verdict {
    /// Its persistence exceeds what noise can make at the chosen confidence.
    Present,
    /// It stands out of the typical noise but not beyond doubt.
    Unresolved,
    /// Indistinguishable from noise.
    Absent,
}

/// A peak, valley or crater of one density.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Feature {
    /// What it is.
    pub kind: FeatureKind,
    /// Place, one coordinate an axis of the density, refined below a cell.
    pub position: Vec<f64>,
    /// Value of the density there, refined below a cell.
    pub density: f64,
    /// Height (of a crater: depth) over the saddle where it merges; for the highest peak, over zero. A
    /// valley has the persistence of the lower of the peaks it separates.
    pub persistence: f64,
    /// Standard error of the persistence; zero without sampling.
    pub standard_error: f64,
    /// Persistence over the largest persistence that noise makes at the chosen confidence: 1 is the limit.
    pub significance: f64,
    /// Whether it is there.
    pub verdict: Verdict,
    /// The saddle where it merges with another; of a ring a point inside. `None` for the highest peak and for valleys.
    /// Where extrema follow from the equations, the higher of the valleys beside a peak.
    pub partner: Option<Vec<f64>>,
    /// How well its place and its density are known.
    pub errors: FeatureErrors,
}

/// Errors of a feature's place and height: what other readings and the second discretisation, or replicates, differ by.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FeatureErrors {
    /// Of the place, one number an axis of the density; empty where unknown. The place of a ring is one of its points:
    /// this is across it.
    pub position: Vec<f64>,
    /// Of the density there; `None` where unknown.
    pub density: Option<f64>,
}

/// The detector's findings on one density.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Detection {
    /// Counts of the features whose verdict is `Present`, corrected by the indicators at a centre of symmetry, and what
    /// lies within what.
    pub signature: Signature,
    /// Whether all that the signature counts was seen. Where an indicator proves a bottom at the centre and the cells
    /// do not show the rim around it, nobody knows whether that has peaks.
    pub is_seen: bool,
    /// Indicators at the centre of symmetry; empty without one.
    pub indicators: Vec<Indicator>,
    /// All features that are `Present` or `Unresolved`, and of each kind the strongest `Absent` ones (so that
    /// the birth of a feature can be followed), by kind and falling persistence.
    pub features: Vec<Feature>,
}

impl Detection {
    /// The feature of that kind with the given rank in persistence (0 is the strongest).
    pub(crate) fn ranked(&self, kind: FeatureKind, rank: usize) -> Option<&Feature> {
        self.features
            .iter()
            .filter(|feature| feature.kind == kind)
            .nth(rank)
    }

    /// Whether a feature of a larger persistence than this may be there, or may be what errors make.
    pub(crate) fn has_unresolved(&self, least: f64) -> bool {
        let mut features = self.features.iter();
        features.any(|one| one.verdict == Verdict::Unresolved && one.persistence > least)
    }
}

/// Finds the features of a density.
pub trait Detector: Send + Sync {
    /// Name for the manifest.
    fn name(&self) -> &'static str;

    /// Features of one density. Scaling the values (and errors), mirroring an axis, or shifting an axis
    /// changes nothing but the numbers scaled, mirrored or shifted.
    fn detect(&self, density: &EstimatedDensity) -> Detection;

    /// An indicator of the given kind nearest to a place, to follow it along a sweep; `None` where there is none.
    fn indicator(
        &self,
        density: &EstimatedDensity,
        kind: IndicatorKind,
        near: &[f64],
    ) -> Option<Indicator> {
        let _ = (density, kind, near);
        None
    }

    /// Places of a marginal where a pair of peak and valley may be about to come or go, or on a ray from the centre of
    /// a joint density where a ring and a moat may, and where its crests show a peak that was not detected; none where
    /// the detector knows of none.
    fn flanks(&self, density: &EstimatedDensity, detected: &Detection) -> Vec<Flank> {
        let _ = (density, detected);
        Vec::new()
    }

    /// Share of a density's maximum below which finer cells are not asked for what is not sure.
    fn floor(&self) -> f64 {
        DetectOptions::default().floor
    }

    /// Probability with which errors are stated and a sweep's findings hold.
    fn confidence(&self) -> f64 {
        0.95
    }

    /// Probability that the sign of a single indicator may be wrong, so that all of a sweep are right at the
    /// chosen confidence.
    fn doubt(&self) -> f64 {
        0.05
    }
}
