//! Fields of passages on one axis, from the chain that its motion is, with a place at the centre of every cell.
//! They are exact there but for the quadrature.
//!
//! Mean times and committors are solved at all places at once. On a line no probability flows in the steady state: a
//! process that is on its way back in time is one on its way ahead, so that with q, the probability to come to the
//! second region next, p q (1 - q) is the density of those on their way, and what flows between two neighbouring places
//! is their conductance times what q rises by.

use super::PassageError;
use super::bordered::Bordered;
use super::field::{FieldTarget, PassageField};
use crate::generator::{ChainGrid, Reach};
use crate::space::CellSpace;
use crate::system::BoundQuantity;

/// A field at the centres of the cells of an axis; `None` where its line has no end, or does not reach to a centre.
///
/// # Errors
/// [`PassageError::Nowhere`] and [`PassageError::Everywhere`].
pub(crate) fn field_on_line(
    reach: &Reach<'_>,
    space: &CellSpace,
    target: &FieldTarget,
) -> Option<Result<PassageField, PassageError>> {
    let mut regions = vec![&target.until];
    regions.extend(&target.exits);
    let at_centres = AtCentres::new(reach, space, &regions)?;
    let until = match at_centres.bordered.target(&target.until) {
        Ok(until) => until,
        Err(error) => return Some(Err(error)),
    };
    let ends = until.places();
    let part = target.part.and_then(|part| target.exits.get(part));
    let part = part.map(|part| at_centres.bordered.places_of_part(part, &until));
    let most = part.as_ref().map_or(f64::INFINITY, |_| 1.0);
    let found = at_centres.extrapolated(|grid| {
        let ends = grid.sampled(&ends);
        let ending = grid.chain.until(&ends);
        match &part {
            None => ending.solve(&grid.chain.masses, |_| 0.0),
            Some(part) => next(grid, &ends, &grid.sampled(part)),
        }
    });
    let in_range = |(value, error): (f64, f64)| (value.clamp(0.0, most), error);
    Some(at_centres.field(found.into_iter().map(in_range), |state| {
        let is_in = |region: &BoundQuantity| region.at(state) < 0.0;
        let of_part = target.part.and_then(|part| target.exits.get(part));
        let inside = of_part.map_or(0.0, |part| f64::from(u8::from(is_in(part))));
        is_in(&target.until).then_some(inside)
    }))
}

/// The density and the current of the processes on their way from one region to another, as [`super::Reactive`] has
/// them; `None` as for [`field_on_line`].
///
/// # Errors
/// [`PassageError::Nowhere`], [`PassageError::Start`], [`PassageError::Overlap`].
pub(crate) fn reactive_on_line(
    reach: &Reach<'_>,
    space: &CellSpace,
    regions: [&BoundQuantity; 2],
) -> Option<Result<[PassageField; 2], PassageError>> {
    let at_centres = AtCentres::new(reach, space, &regions)?;
    let [from, to] = match at_centres.bordered.apart(regions) {
        Ok(places) => places,
        Err(error) => return Some(Err(error)),
    };
    let inside = |state: &[f64]| {
        let is_in = regions.iter().any(|region| region.at(state) < 0.0);
        is_in.then_some(0.0)
    };
    let probabilities = |grid: &ChainGrid| {
        let [from, to] = [&from, &to].map(|region| grid.sampled(region));
        let either = from.iter().zip(&to).map(|(one, other)| *one || *other);
        next(grid, &either.collect::<Vec<bool>>(), &to)
    };
    let steady = at_centres.bordered.line.densities(reach.system);
    let density = at_centres.extrapolated(|grid| {
        let on_way = probabilities(grid).into_iter().zip(grid.kept());
        let density = |place: usize| steady.get(place).copied().unwrap_or(0.0);
        on_way
            .map(|(next, place)| density(place) * next * (1.0 - next))
            .collect()
    });
    let current = at_centres.extrapolated(|grid| {
        let next = probabilities(grid);
        let rises = next.windows(2).map(|pair| pair[1] - pair[0]);
        let flows = rises.zip(&grid.chain.conductances);
        let mut flows: Vec<f64> = flows
            .map(|(rise, conductance)| rise * conductance)
            .collect();
        flows.push(0.0);
        flows
    });
    let density = at_centres.field(density.into_iter(), inside);
    let current = at_centres.field(current.into_iter(), inside);
    Some(density.and_then(|density| Ok([density, current?])))
}

/// The probability that of the ends those of a part are the next.
fn next(grid: &ChainGrid, ends: &[bool], part: &[bool]) -> Vec<f64> {
    let none = vec![0.0; ends.len()];
    let ending = grid.chain.until(ends);
    ending.solve(&none, |place| f64::from(u8::from(part[place])))
}

/// A line with a place at the centre of each cell of an axis.
struct AtCentres {
    bordered: Bordered,
    /// States at the centres, and their places.
    centres: Vec<f64>,
    places: Vec<usize>,
}

impl AtCentres {
    fn new(reach: &Reach<'_>, space: &CellSpace, regions: &[&BoundQuantity]) -> Option<Self> {
        let centres = space.axes().first()?.centres();
        let bordered = Bordered::with_places(reach, regions, &centres)?;
        let line = &bordered.line.places;
        // No element begins at the last place.
        let place = |centre: &f64| {
            let found = line.partition_point(|place| place < centre);
            let nearest = [found.checked_sub(1), Some(found)].into_iter().flatten();
            let nearest = nearest.filter(|&place| place + 1 < line.len());
            let away = |&place: &usize| (line[place] - centre).abs();
            let place = nearest.min_by(|a, b| away(a).total_cmp(&away(b)))?;
            (away(&place) <= SAME * centre.abs()).then_some(place)
        };
        let places: Option<Vec<usize>> = centres.iter().map(place).collect();
        Some(Self {
            places: places?,
            bordered,
            centres,
        })
    }

    /// A function at the centres with its errors, from what it is on the places of each grid.
    fn extrapolated(&self, of: impl Fn(&ChainGrid) -> Vec<f64>) -> Vec<(f64, f64)> {
        let line = &self.bordered.line;
        let all = line.grids().map(|grid| {
            let mut values = vec![f64::NAN; line.places.len()];
            let own = of(&grid);
            grid.kept()
                .zip(own)
                .for_each(|(place, value)| values[place] = value);
            values
        });
        let at = |&place: &usize| line.extrapolated([0, 1, 2].map(|grid: usize| all[grid][place]));
        self.places.iter().map(at).collect()
    }

    /// The field of these numbers, with what it is inside regions; [`PassageError::Rounding`] where one is no number.
    fn field(
        &self,
        found: impl Iterator<Item = (f64, f64)>,
        inside: impl Fn(&[f64]) -> Option<f64>,
    ) -> Result<PassageField, PassageError> {
        let all = self.centres.iter().zip(found);
        let all = all.map(|(&centre, found)| inside(&[centre]).map_or(found, |own| (own, 0.0)));
        let (values, errors): (Vec<f64>, Vec<f64>) = all.unzip();
        let is_known = values
            .iter()
            .chain(&errors)
            .all(|number| number.is_finite());
        match is_known {
            true => Ok(PassageField { values, errors }),
            false => Err(PassageError::Rounding),
        }
    }
}

/// Relative distance of two places that are one.
const SAME: f64 = 1e-12;
