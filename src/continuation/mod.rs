//! Sweeps: follows a source of densities along a parameter and locates changes of signature.
//!
//! This module knows a source of densities and a detector, and nothing of matrices: Monte Carlo, cell maps
//! and closed-form densities all sweep alike.
//!
//! # Decisions
//!
//! **What a value has is a list of measures.** A method adds numbers to its report, each with a name, a unit and, where
//! it knows one, an error; the measures that a sweep file asks for are derived from what the session has solved
//! (`method::measures`, a file each). Tables, journal, export and page go through the list. Only `points.csv` knows
//! where the oldest columns stand, since their order is read by other people's scripts.
//!
//! **What must be known of a point is data.** A method says it as findings: an enum with numbers
//! (`continuation::Finding`). `points.csv` stores code and numbers, so that a stored run still knows them; sentences
//! are made last, in `run::finding_in_words`. Warnings of a sweep are gathered by kind of finding and axis.
//!
//! **Segments, not threads.** A sweep is a chain of warm starts, which one core walks. Its values are cut into
//! segments, each with a session of its own, walked from its middle outward, and then what narrows changes that do not
//! touch is solved side by side, and rows far from each other are checked so. How many segments there are follows from
//! the values and the source (`DensitySource::segments`: its cells and its memory limit), never from the number of
//! threads, so that results are the same bit for bit on any. A segment's first solve has no neighbour: half the root of
//! the number of values keeps that below a tenth of the work.
//!
//! **An indicator's zero is the bifurcation.** At a centre of symmetry the signs of curvatures (at a kink, of the
//! slope) give the type of the critical point, and with it the signature, long before persistence can. `continuation`
//! brackets the change of sign, not the change of count; `docs/location.md` has the rules and the measured errors. It
//! asks a source for a finer one (`DensitySource::finer`), and for one between closed ends (`DensitySource::enclosed`),
//! and knows nothing of its cells.
//!
//! **A band, not only a bracket.** A peak is counted when its persistence exceeds the noise, which is later than its
//! birth. Where no indicator tells, `continuation::persistence` therefore extrapolates the square root of the
//! persistence to zero and states the band from there to the last point where the feature is present.

mod again;
mod at_rest;
mod bands;
mod beside;
mod bracket;
mod change;
mod closer;
mod counting;
pub mod curve;
mod d_bifurcations;
mod dips;
mod distances;
mod doubt;
mod error;
mod events;
mod finding;
mod flank;
mod fluctuations;
mod follow;
mod found;
mod grid;
mod in_doubt;
mod jump;
mod kinks;
mod known_points;
mod label;
mod level_points;
mod levels;
mod live;
mod locate;
mod look;
pub mod map;
pub(crate) mod measure;
mod observer;
mod other_indicators;
mod persistence;
mod point;
mod refined;
mod remembered;
mod report;
mod root;
mod rows;
mod segment;
mod shard;
mod solved_point;
mod source;
mod span;
mod spectral_change;
mod state_field;
mod sweep;
mod walk;
mod wanted;

pub(crate) use again::detect_again;
pub use doubt::{BifurcationStatus, CheckedBy, Doubt, WiderRange};
pub use error::SweepError;
#[cfg(test)]
pub(crate) use finding::tests::every_finding;
pub use finding::{Finding, PassageFault, ShiftedQuantity, SteadyClass};
pub use fluctuations::Fluctuations;
pub use grid::CheckedIndicator;
pub use label::{Label, Located, RowWords, Zero};
pub use levels::LevelCrossing;
pub(crate) use levels::asked_of;
pub use look::CloserLook;
pub use measure::{Measure, MeasureColumn, MeasureKind};
pub use observer::Observer;
pub use point::Point;
pub use report::{PointStatus, SolveReport};
pub use root::ErrorParts;
pub use shard::Shard;
pub use source::{
    CellCheck, DensitySource, Sensitivity, Session, Solution, SourceError, Subject, Want,
};
pub use span::evenly_spaced;
pub use state_field::StateField;
pub use sweep::sweep;
pub(crate) use sweep::sweep_shard;

#[cfg(test)]
mod location_tests;
#[cfg(test)]
mod tests;

/// Settings of location.
#[derive(Debug, Clone, PartialEq)]
pub struct LocateOptions {
    /// Wanted width of a P-bifurcation's bracket, in units of the parameter; `None` leaves it to the relative
    /// tolerance.
    pub tolerance: Option<f64>,
    /// Wanted width of a bracket as a share of the range that is swept.
    pub relative_tolerance: f64,
    /// Hellinger distance between neighbouring densities above which a value between is solved too.
    pub largest_distance: f64,
    /// Whether located values are checked on a finer grid, where the source has one; those that could be, and are not,
    /// are [`BifurcationStatus::Unchecked`].
    pub grid_check: bool,
    /// Work for changes that are in doubt after that check, on cells that are refined again: as a multiple of the work
    /// of the sweep, counted in solves on its cells. Stretches around such changes are swept again within this multiple
    /// of 200 solves on 100 × 100 cells where that is more.
    pub effort: f64,
}

impl Default for LocateOptions {
    fn default() -> Self {
        Self {
            tolerance: None,
            relative_tolerance: 1e-4,
            largest_distance: 0.2,
            grid_check: true,
            effort: 1.0,
        }
    }
}

impl LocateOptions {
    /// Whether a row or a point of this status is all that was asked for: located, or unchecked where no check was
    /// wanted.
    pub fn is_met_by(&self, status: BifurcationStatus) -> bool {
        match status {
            BifurcationStatus::Located => true,
            BifurcationStatus::Unchecked => !self.grid_check,
            BifurcationStatus::Unresolved | BifurcationStatus::Unconfirmed => false,
        }
    }

    /// What is wanted on a range of this length, in units of the parameter.
    fn goal(&self, length: f64) -> Goal {
        Goal {
            tolerance: self
                .tolerance
                .unwrap_or(self.relative_tolerance * length.abs()),
            largest_distance: self.largest_distance,
            grid_check: self.grid_check,
            effort: self.effort,
            is_closer: false,
        }
    }
}

/// Settings of location on a range that is known.
#[derive(Debug, Clone, PartialEq)]
struct Goal {
    tolerance: f64,
    largest_distance: f64,
    grid_check: bool,
    effort: f64,
    /// Whether a stretch in doubt is swept again, on cells that are finer than those that left it so.
    is_closer: bool,
}

/// A finished (or interrupted) sweep.
#[derive(Debug, Clone)]
pub struct SweepResult {
    /// What was swept, and what was watched.
    pub subject: Subject,
    /// All points in ascending parameter.
    pub points: Vec<Point>,
    /// Labelled points in ascending parameter: end points `EP`, changes `PB`, failures `MX`.
    pub labels: Vec<Label>,
    /// What was seen in the checks of located values; `None` where there was none.
    pub checks: Option<Vec<CheckedIndicator>>,
    /// What closer looks on finer cells have found, in the order in which their rows took the place of others.
    pub looks: Vec<CloserLook>,
    /// Whether the sweep was interrupted before it was complete.
    pub interrupted: bool,
}

impl SweepResult {
    /// The P-bifurcations, in ascending parameter.
    pub fn bifurcations(&self) -> impl Iterator<Item = &Located> {
        self.labels.iter().filter_map(Label::bifurcation)
    }

    /// The levels that are asked for and no value crosses, with the smallest and the largest number found; `None` where
    /// the number is known nowhere.
    pub fn uncrossed_levels(&self) -> Vec<(crate::system::MeasureLevel, Option<[f64; 2]>)> {
        let is_crossed = |asked: &crate::system::MeasureLevel| {
            let mut rows = self.labels.iter();
            rows.any(|row| matches!(row, Label::Level(one) if one.asked == *asked))
        };
        let span = |asked: &crate::system::MeasureLevel| {
            let points = self.points.iter();
            let numbers = points.filter_map(|one| levels::measure_of(&one.report, asked));
            let numbers = numbers.map(|one| [one.value; 2]);
            numbers.reduce(|[low, high], [value, _]| [low.min(value), high.max(value)])
        };
        let levels = self.subject.family.questions.levels.iter();
        let left = levels.filter(|asked| !is_crossed(asked));
        left.map(|asked| (asked.clone(), span(asked))).collect()
    }

    /// Largest Hellinger distance between neighbouring densities that was accepted; `None` with fewer than two.
    pub(crate) fn largest_distance(&self) -> Option<f64> {
        let distances = self.points.iter().filter_map(|point| point.distance);
        distances.reduce(f64::max)
    }
}
