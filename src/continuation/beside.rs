//! The checks of rows that are far from each other, side by side, before the rows are made: what they have seen is
//! known then.

use rayon::prelude::*;

use super::change::{Change, changes};
use super::doubt::Doubt;
use super::follow::Crossing;
use super::grid::{Checked, CheckedIndicator, Checks, FinerZero};
use super::live::Live;
use super::locate::by_indicator;
use super::root::root;
use super::span::Span;
use super::{DensitySource, Goal, Point, Want};
use crate::cancellation::Cancellation;
use crate::numerics::sort_ascending;
use crate::topology::Detector;

/// Share of the swept range from which on zeros are far from each other: factors of one are of little use for another.
const FAR: f64 = 0.05;

/// What is checked, and with what.
pub(super) struct Beside<'a> {
    /// Ascending, all with detections.
    pub(super) points: &'a [&'a Point],
    pub(super) source: &'a dyn DensitySource,
    pub(super) detector: &'a dyn Detector,
    pub(super) options: &'a Goal,
    pub(super) span: Span,
    pub(super) cancellation: &'a Cancellation,
    /// What was seen before.
    pub(super) known: &'a [CheckedIndicator],
}

/// One of two kinds of checks: on cells that are refined once, and between closed ends.
struct Half<'a> {
    live: Live<'a>,
    is_on_finer_cells: bool,
}

impl Checks for Half<'_> {
    fn on_finer_cells(
        &mut self,
        checked: &Checked<'_>,
        times: u8,
    ) -> Option<Result<FinerZero, Doubt>> {
        match self.is_on_finer_cells {
            true => self.live.on_finer_cells(checked, times),
            false => None,
        }
    }

    fn between_closed_ends(&mut self, checked: &Checked<'_>) -> Option<Result<f64, Doubt>> {
        match self.is_on_finer_cells {
            true => None,
            false => self.live.between_closed_ends(checked),
        }
    }
}

impl Beside<'_> {
    /// What is seen in the first checks of all rows; nothing where there are not enough of them, or not enough memory,
    /// to solve any side by side.
    pub(super) fn seen(&self) -> Vec<CheckedIndicator> {
        let want = Want::densities(&self.source.subject().observables);
        let Ok(Some(finer)) = self.source.finer(&want) else {
            return Vec::new();
        };
        // Each group opens two sessions.
        let most = finer.segments(usize::MAX) / 2;
        let changes = changes(self.points, self.detector);
        let crossings = changes
            .iter()
            .filter_map(|one| Some((one, one.crossing()?)));
        let groups = self.groups(crossings.collect());
        if most == 0 || groups.is_empty() {
            return Vec::new();
        }
        let each = groups.len().div_ceil(most);
        let parts = groups.par_chunks(each).flat_map_iter(|groups| {
            [true, false].map(|is_on_finer_cells| (groups.concat(), is_on_finer_cells))
        });
        let seen = parts.map(|(group, is_on_finer_cells)| self.check(&group, is_on_finer_cells));
        seen.flatten().collect()
    }

    /// Crossings that are near to each other.
    fn groups<'c>(
        &self,
        mut crossings: Vec<(&'c Change, &'c Crossing)>,
    ) -> Vec<Vec<(&'c Change, &'c Crossing)>> {
        let zero =
            |crossing: &Crossing| root(self.points, crossing, self.detector.confidence()).value;
        sort_ascending(&mut crossings, |one| zero(one.1));
        let far = FAR * self.span.length();
        let are_near =
            |a: &(&Change, &Crossing), b: &(&Change, &Crossing)| zero(b.1) - zero(a.1) <= far;
        crossings.chunk_by(are_near).map(<[_]>::to_vec).collect()
    }

    /// The checks of one kind of some rows, one after the other.
    fn check(
        &self,
        group: &[(&Change, &Crossing)],
        is_on_finer_cells: bool,
    ) -> Vec<CheckedIndicator> {
        let mut half = Half {
            // Cells that are refined more than once are for the rows to ask for.
            live: Live::new(
                Some(self.source),
                self.detector,
                (self.cancellation, self.known.to_vec()),
                (self.span, self.options.tolerance, 0.0),
            ),
            is_on_finer_cells,
        };
        for &found in group {
            by_indicator(
                self.points,
                self.source.subject(),
                found,
                self.detector,
                self.options,
                &mut half,
            );
        }
        half.live.seen().unwrap_or_default()
    }
}
