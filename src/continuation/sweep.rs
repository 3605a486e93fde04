//! The sweep itself: solves the given values and what lies between them, makes the rows, and looks closer where cells
//! leave them in doubt. What does not depend on each other is solved side by side.

use super::closer::Closer;
use super::known_points::KnownPoints;
use super::segment::Work;
use super::span::{Span, evenly_spaced};
use super::walk::Walk;
use super::{DensitySource, LocateOptions, Observer, Shard, SweepError, SweepResult};
use crate::cancellation::Cancellation;
use crate::topology::Detector;

/// Sweeps a source along its path from end to end, with `points` evenly spaced values (at least 2).
///
/// Cancelled, it ends early with the points so far and [`SweepResult::interrupted`] set; an observer that wants to stop
/// cancels. Failed points are kept as data and labelled `MX`.
///
/// # Errors
/// [`SweepError`] when a value is not allowed or the observer fails.
pub fn sweep(
    source: &dyn DensitySource,
    detector: &dyn Detector,
    points: usize,
    options: &LocateOptions,
    cancellation: &Cancellation,
    observer: &mut dyn Observer,
) -> Result<SweepResult, SweepError> {
    let whole = (points, Shard::WHOLE);
    sweep_shard(source, detector, whole, options, cancellation, observer)
}

/// The same of one shard. What lies between its values is followed, narrowed and located as in the whole sweep, from
/// what the shard knows.
///
/// # Errors
/// As [`sweep`]; [`SweepError::Shards`] where there are more shards than steps.
pub(crate) fn sweep_shard(
    source: &dyn DensitySource,
    detector: &dyn Detector,
    (points, shard): (usize, Shard),
    options: &LocateOptions,
    cancellation: &Cancellation,
    observer: &mut dyn Observer,
) -> Result<SweepResult, SweepError> {
    let subject = source.subject();
    let span = Span::new(subject, points);
    let given = evenly_spaced(subject.family.ends(), points);
    let places = shard.places(given.len()).ok_or(SweepError::Shards {
        shards: shard.of(),
        steps: given.len() - 1,
    })?;
    let values = &given[places];
    observer.begin(values.len());
    let known = observer.known_checks();
    let points_known = KnownPoints::new(observer.known_points(), detector, values, cancellation);
    let options = options.goal(span.length());
    let work = Work::new(
        (source, detector),
        cancellation,
        (observer, values.len()),
        options.largest_distance,
        // Where it is not the first of the sweep, the first value may fail.
        values.first().copied().filter(|_| shard.number() == 1),
    )
    .knowing(points_known);
    let walk = Walk::along(&work, (values, usize::MAX), (span, options.clone()))?;
    let (labels, checks, mut unchecked) = walk.labels(cancellation, known);
    // What lies about the ends of a shard is known to the whole sweep alone.
    let (labels, looks) = if shard == Shard::WHOLE {
        Closer::new((&work, span), &options, &walk, cancellation).labels(labels)
    } else {
        (labels, Vec::new())
    };
    unchecked |= options.grid_check && cancellation.is_cancelled();
    Ok(SweepResult {
        subject: subject.clone(),
        points: walk.points,
        labels,
        checks,
        looks,
        interrupted: work.has_ended() || unchecked,
    })
}
