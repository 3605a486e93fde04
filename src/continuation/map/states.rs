//! Densities over the box of a map: those at the crossings of some values of both parameters, for whoever shows a map.

use rayon::prelude::*;

use super::SourceInPlane;
use crate::cancellation::Cancellation;
use crate::continuation::curve::Plane;
use crate::continuation::{Point, SourceError};
use crate::topology::Detector;

/// A solved place of a plane.
#[derive(Debug, Clone)]
pub(crate) struct PlaneState {
    /// Values of both parameters.
    pub values: [f64; 2],
    /// What was found there; its value is that of the first parameter.
    pub point: Point,
}

/// Solves at all crossings of these values of the first and of the second parameter of a plane, to and fro, so that
/// neighbours follow each other: every other row is in descending order of the first parameter. A row is a session of
/// its own that shares nothing, so the states do not depend on the number of threads. `done` is told of every state,
/// from whatever thread. Cancelled, rows that are not whole are left out; a state that fails is data.
///
/// # Errors
/// [`SourceError`] where no source can be made in this plane.
pub(crate) fn plane_states(
    source: &SourceInPlane<'_>,
    plane: &Plane,
    values: [&[f64]; 2],
    detector: &dyn Detector,
    cancellation: &Cancellation,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<PlaneState>, SourceError> {
    let solve_row = |(number, &second): (usize, &f64)| {
        let mut across = values[0].to_vec();
        if number % 2 == 1 {
            across.reverse();
        }
        let row = CommonOfRows {
            source,
            detector,
            cancellation,
            done,
        };
        row.solve(&plane.afresh(), &across, second)
    };
    let rows: Result<Vec<Vec<PlaneState>>, SourceError> =
        (values[1].par_iter().enumerate().map(solve_row)).collect();
    Ok(rows?.concat())
}

/// What the rows have in common.
struct CommonOfRows<'a> {
    source: &'a SourceInPlane<'a>,
    detector: &'a dyn Detector,
    cancellation: &'a Cancellation,
    done: &'a (dyn Fn() + Sync),
}

impl CommonOfRows<'_> {
    fn solve(
        &self,
        plane: &Plane,
        across: &[f64],
        second: f64,
    ) -> Result<Vec<PlaneState>, SourceError> {
        let source = (self.source)(plane)?;
        let mut session = source.open(self.cancellation);
        let mut states = Vec::new();
        for &first in across {
            let place = plane.place([first, second]);
            let coordinate = match states.len() {
                0 => plane.begin(place),
                _ => plane.lay(place),
            };
            let solved = Point::solve(session.as_mut(), source.method(), self.detector, coordinate);
            let Some((mut point, _)) = solved.filter(|_| !self.cancellation.is_cancelled()) else {
                return Ok(Vec::new());
            };
            point.value = first;
            states.push(PlaneState {
                values: [first, second],
                point,
            });
            (self.done)();
        }
        Ok(states)
    }
}
