//! What a figure of a sweep shows: from this its table and its caption are made.

use crate::continuation::Point;
use crate::density::Observable;

/// What is seen of a sweep, with the number of an observable where it is one's.
#[derive(Clone)]
pub(super) enum Shows<'a> {
    /// What has no table of its own.
    Nothing,
    /// The density of a marginal over the parameter, with its branches.
    Diagram(usize),
    /// All marginals at some points.
    Marginals(Vec<&'a Point>),
    /// A joint density at some points, in the way that the words say.
    Joint(usize, Vec<&'a Point>, &'static str),
    /// Peaks and valleys of a marginal.
    Peaks(usize),
    /// Indicators of an observable.
    Indicators(usize),
    /// Numbers of pieces and holes of a density's sets above a level.
    Homology(usize),
    /// How well the points were solved.
    Health,
    /// Of a comparison: all marginals by every method.
    ComparedMarginals,
    /// Of a comparison: a joint density by every method.
    ComparedJoint(Observable),
    /// Of a comparison: error against time.
    TimeToAccuracy,
}
