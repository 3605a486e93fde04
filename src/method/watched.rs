//! From cell masses to what is watched: coordinates by sums, quantities by sub-cells, and the means that are wanted
//! beside them.

use std::sync::Arc;

use super::lattice::values_at_nodes;
use super::problem::{AveragedMap, Maps};
use super::structure::{Moment, structure};
use super::{MethodError, Problem};
use crate::density::{
    Coordinate, Detail, EstimatedDensity, EstimatedMoments, Moments, NEGLIGIBLE_OF_QUANTITIES,
    Observable, Projection, QuantityMoments, Roughness, Structure, estimate_from_difference,
    estimate_from_second, estimate_projected, half_difference, moments, phase_factors, times,
};
use crate::space::CellSpace;
use crate::system::{self, BoundQuantity, LANES, SwitchingSurface, System, symmetry_over_a_period};

/// Whether masses carry noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Masses {
    Exact,
    Sampled,
}

impl Problem {
    /// The maps at a value of the path's coordinate.
    pub(super) fn maps(
        &self,
        value: f64,
        kinked: &[SwitchingSurface],
        masses: Masses,
    ) -> Result<Arc<Maps>, MethodError> {
        let family = self.family();
        let mut all = family.quantities().iter().chain(&family.questions.averaged);
        if all.any(|quantity| family.moves(quantity)) {
            return Ok(Arc::new(self.maps_at(value, kinked, masses)?));
        }
        if let Some(known) = self.fixed().get() {
            return Ok(Arc::clone(known));
        }
        let made = Arc::new(self.maps_at(value, kinked, masses)?);
        Ok(Arc::clone(self.fixed().get_or_init(|| made)))
    }

    fn maps_at(
        &self,
        value: f64,
        kinked: &[SwitchingSurface],
        masses: Masses,
    ) -> Result<Maps, MethodError> {
        let (family, space) = (self.family(), self.space());
        let values = family.values_at(value)?;
        let planes = planes(kinked);
        let bind = |quantity: &Arc<crate::system::Quantity>| quantity.bind(&values);
        let bound: Result<Vec<BoundQuantity>, _> = family.quantities().iter().map(bind).collect();
        let averaged: Result<Vec<BoundQuantity>, _> =
            family.questions.averaged.iter().map(bind).collect();
        let (bound, averaged) = (bound?, averaged?);
        let coordinate = |axis: usize| match axis.checked_sub(space.dimension()) {
            None => Coordinate::Axis(axis),
            Some(number) => {
                Coordinate::Quantity(Box::new(bound[number].clone()), self.bins()[number].clone())
            }
        };
        let (fine, coarse) = match masses {
            Masses::Exact => (Detail::Fine, Some(Detail::Coarse)),
            Masses::Sampled => (Detail::Sampled, None),
        };
        let watched = self.observables().iter().map(|observable| {
            let axes = observable.axes();
            if let Some((kept, phase, along)) = self.at_phase(*observable) {
                let map = |is_coarse| {
                    let plain = Projection::of_series(space, kept, is_coarse)?;
                    Ok::<_, MethodError>(plain.at_phase(space, along, phase, is_coarse))
                };
                return Ok(Some((map(false)?, Some(map(true)?))));
            }
            if axes.iter().all(|&axis| axis < space.dimension()) {
                let has_modes = |&axis: &usize| space.axes()[axis].is_modes();
                if !axes.iter().any(has_modes) {
                    return Ok(None);
                }
                let map = |is_coarse| Projection::of_series(space, *observable, is_coarse);
                return Ok(Some((map(false)?, Some(map(true)?))));
            }
            let coordinates: Vec<Coordinate> = axes.into_iter().map(coordinate).collect();
            let map = |detail| Projection::of_quantities(space, &coordinates, detail, &planes);
            Ok::<_, MethodError>(Some((map(fine)?, coarse.map(map).transpose()?)))
        });
        let watched: Result<Vec<_>, _> = watched.collect();
        let averaged = averaged.into_iter().map(|quantity| {
            let map = |detail| QuantityMoments::new(space, &quantity, detail, &planes);
            AveragedMap {
                moments: map(fine),
                judge: coarse.map(|detail| (map(detail), values_at_nodes(space, &quantity))),
                quantity,
            }
        });
        // Where no state has values beyond the bins, these end where the formula does.
        let own_ends = bound.iter().zip(self.bins()).map(|(quantity, bins)| {
            let values = values_at_nodes(space, quantity);
            let is_within =
                |is_beyond: &dyn Fn(f64) -> bool| !values.iter().copied().any(is_beyond);
            [
                is_within(&|value| value < bins.from()),
                is_within(&|value| value > bins.to()),
            ]
        });
        Ok(Maps {
            watched: watched?,
            averaged: averaged.collect(),
            own_ends: own_ends.collect(),
            bound,
        })
    }
}

impl Maps {
    /// The watched densities of masses without noise, with the difference to a second discretisation (masses, Σ = 0).
    /// Of quantities the second one is read off coarser sub-cells too, so that its difference holds what these do.
    pub(super) fn exact(
        &self,
        problem: &Problem,
        masses: &[f64],
        difference: &[f64],
    ) -> Result<Vec<EstimatedDensity>, MethodError> {
        let second: Vec<f64> = masses.iter().zip(difference).map(|(m, d)| m + d).collect();
        let all = problem.observables().iter().zip(&self.watched);
        let densities = all.map(|(&observable, maps)| match maps {
            None => Ok(estimate_from_difference(
                problem.space(),
                observable,
                masses,
                difference,
            )?),
            Some((fine, coarse)) => {
                let coarse = coarse.as_ref().unwrap_or(fine);
                let other = coarse.density(&second)?.values;
                let mut estimated = estimate_from_second(observable, fine.density(masses)?, other);
                estimated.negligible = NEGLIGIBLE_OF_QUANTITIES;
                Ok(estimated)
            }
        });
        densities.collect()
    }

    /// Axes of modes of the watched densities, with what the last modes change in each, in total variation.
    pub(super) fn changes_by_last_modes(
        &self,
        problem: &Problem,
        masses: &[f64],
    ) -> Result<Vec<(usize, f64)>, MethodError> {
        let space = problem.space();
        let mut changes = Vec::new();
        for (observable, maps) in problem.observables().iter().zip(&self.watched) {
            let axes = observable.axes().into_iter();
            let carried = |&axis: &usize| axis < space.dimension() && space.axes()[axis].is_modes();
            let carried: Vec<usize> = match problem.at_phase(*observable) {
                Some((.., along)) => vec![along],
                None => axes.filter(carried).collect(),
            };
            if let (false, Some((all, Some(fewer)))) = (carried.is_empty(), maps) {
                let change = half_difference(&all.density(masses)?, &fewer.density(masses)?)?;
                changes.extend(carried.into_iter().map(|axis| (axis, change)));
            }
        }
        Ok(changes)
    }

    /// The watched densities of sampled masses, with their replicates.
    pub(super) fn sampled(
        &self,
        problem: &Problem,
        masses: &[f64],
        replicates: &[Vec<f64>],
    ) -> Result<Vec<EstimatedDensity>, MethodError> {
        let all = problem.observables().iter().zip(&self.watched);
        let densities = all.map(|(&observable, maps)| {
            Ok(match maps {
                None => crate::density::estimate(problem.space(), observable, masses, replicates)?,
                Some((map, _)) => estimate_projected(map, observable, masses, replicates)?,
            })
        });
        densities.collect()
    }

    /// Changes of the watched densities, from changes of the masses.
    pub(super) fn changes(
        &self,
        problem: &Problem,
        masses: &[f64],
    ) -> Result<Vec<Vec<f64>>, MethodError> {
        let all = problem.observables().iter().zip(&self.watched);
        let changes = all.map(|(&observable, maps)| {
            Ok(match maps {
                None => {
                    Projection::new(problem.space(), observable)?
                        .density(masses)?
                        .values
                }
                Some((map, _)) => map.density(masses)?.values,
            })
        });
        changes.collect()
    }

    /// Moments of the quantities that are averaged, from masses without noise. Their errors are what other
    /// discretisations of the masses and coarser sub-cells change; unknown without the former.
    pub(super) fn exact_moments(
        &self,
        space: &CellSpace,
        masses: &[f64],
        others: &[&[f64]],
        kinked: &[SwitchingSurface],
    ) -> Result<Vec<EstimatedMoments>, MethodError> {
        let averaged = self.averaged.iter().map(|map| {
            let moments = map.moments.of(masses)?;
            let (false, Some((coarse, values))) = (others.is_empty(), &map.judge) else {
                return Ok(EstimatedMoments::unjudged(moments));
            };
            let by_others = others.iter().map(|other| map.moments.of(other));
            let by_coarser = std::iter::once(coarse.of(masses));
            let all: Result<Vec<Moments>, _> = by_others.chain(by_coarser).collect();
            let rough = others.iter().map(|other| {
                let roughness = Roughness {
                    space,
                    weights: masses,
                    differences: &differences(masses, other),
                    planes: &planes(kinked),
                };
                roughness.of_moments(values, &moments)
            });
            let none = Moments {
                mean: 0.0,
                standard_deviation: 0.0,
            };
            // Kinks are those of the masses, whatever they are compared with.
            let more = rough.fold(none, |most, one| Moments {
                mean: most.mean.max(one.mean),
                standard_deviation: most.standard_deviation.max(one.standard_deviation),
            });
            let others = all?;
            let layers = map.moments.change_of_layers(coarse, masses, &moments)?;
            Ok(EstimatedMoments::by_difference(moments, &others)
                .with(more)
                .with(layers))
        });
        averaged.collect()
    }

    /// Moments of the quantities that are averaged, without errors.
    pub(super) fn plain_moments(&self, masses: &[f64]) -> Result<Vec<Moments>, MethodError> {
        let all = self.averaged.iter();
        all.map(|map| Ok(map.moments.of(masses)?)).collect()
    }

    /// Moments of the axes, which are known, and of the quantities that are averaged, with standard errors from
    /// replicates of sampled masses.
    pub(super) fn all_sampled_moments(
        &self,
        space: &CellSpace,
        of_axes: &[Moments],
        masses: &[f64],
        replicates: &[Vec<f64>],
    ) -> Result<Vec<EstimatedMoments>, MethodError> {
        let all = |of_axes: Vec<Moments>, masses: &[f64]| {
            let averaged = self.averaged.iter().map(|map| map.moments.of(masses));
            let averaged: Result<Vec<Moments>, _> = averaged.collect();
            Ok::<_, MethodError>([of_axes, averaged?].concat())
        };
        let others = replicates
            .iter()
            .map(|masses| all(moments(space, masses)?, masses));
        let others: Result<Vec<Vec<Moments>>, _> = others.collect();
        let others = others?;
        let found = all(of_axes.to_vec(), masses)?.into_iter().enumerate();
        let estimated = found.map(|(index, own)| {
            let others: Vec<Moments> = others
                .iter()
                .filter_map(|all| all.get(index).copied())
                .collect();
            EstimatedMoments::by_replicates(own, &others)
        });
        Ok(estimated.collect())
    }

    /// What the equations say of the density of an observable.
    pub(super) fn structure(
        &self,
        system: &dyn System,
        problem: &Problem,
        masses: &[f64],
        observable: Observable,
        kinked: &[SwitchingSurface],
    ) -> Structure {
        let space = problem.space();
        let axes = observable.axes();
        if let Some((kept, phase, along)) = problem.at_phase(observable) {
            let there = times(masses, &phase_factors(space, along, phase, 0));
            return Structure {
                is_spread: true,
                ..structure(system, space, &there, kept, kinked, Moment::Phase)
            };
        }
        if axes.iter().all(|&axis| axis < space.dimension()) {
            return Structure {
                is_spread: system.facts().phase.is_some(),
                ..structure(system, space, masses, observable, kinked, Moment::Mean)
            };
        }
        let ranges = space.ranges();
        let own_end = |&axis: &usize| match axis.checked_sub(space.dimension()) {
            None => system::closed_ends(system, axis, &ranges),
            Some(number) => self.own_ends.get(number).copied().unwrap_or_default(),
        };
        Structure {
            centre: self.centre(system, problem, &axes, kinked),
            is_spread: true,
            ..Structure::default()
        }
        .with_own_ends(axes.iter().map(own_end))
    }

    /// The point of symmetry of a density of quantities: where the system's reflection reflects each of them.
    fn centre(
        &self,
        system: &dyn System,
        problem: &Problem,
        axes: &[usize],
        kinked: &[SwitchingSurface],
    ) -> Option<Vec<f64>> {
        let space = problem.space();
        let ends: Vec<(f64, f64)> = space.axes().iter().map(|a| (a.from(), a.to())).collect();
        let symmetry = symmetry_over_a_period(system, &ends)?;
        let of = |&axis: &usize| match axis.checked_sub(space.dimension()) {
            None => symmetry.reflected[axis].then(|| symmetry.centre[axis]),
            Some(number) => {
                let quantity = &self.bound[number];
                let is_bent = |surface: &SwitchingSurface| {
                    let others = quantity.states().iter().enumerate();
                    quantity.states()[surface.axis]
                        && others.filter(|(_, needed)| **needed).count() == 1
                };
                // A kink that is carried over to the quantity would be taken for a curvature.
                if kinked.iter().any(is_bent) {
                    return None;
                }
                mirror(quantity, &symmetry, &ends)
            }
        };
        axes.iter().map(of).collect()
    }
}

/// Surfaces as axes with coordinates.
pub(super) fn planes(surfaces: &[SwitchingSurface]) -> Vec<(usize, f64)> {
    surfaces.iter().map(|one| (one.axis, one.at)).collect()
}

/// What a second discretisation changes of the masses.
pub(super) fn differences(masses: &[f64], second: &[f64]) -> Vec<f64> {
    let pairs = second.iter().zip(masses);
    pairs.map(|(second, own)| second - own).collect()
}

/// Relative difference of two values that are the same.
const ROUNDING: f64 = 1e-9;

/// The value about which a reflection of the state reflects a quantity, tried at a batch of states.
fn mirror(
    quantity: &BoundQuantity,
    symmetry: &crate::system::Symmetry,
    ends: &[(f64, f64)],
) -> Option<f64> {
    // Fractions of the multiples of irrational numbers fill the box evenly.
    const STEPS: [f64; 4] = [
        0.618_033_988_75,
        0.754_877_666_25,
        0.569_840_290_998,
        0.438_447_187_19,
    ];
    let (mut states, mut images) = (Vec::new(), Vec::new());
    for (axis, &(from, to)) in ends.iter().enumerate() {
        let (mut state, mut image) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let share = ((lane + 1) as f64 * STEPS[axis % STEPS.len()]).fract();
            state[lane] = from + share * (to - from);
            image[lane] = match symmetry.reflected[axis] {
                true => 2.0 * symmetry.centre[axis] - state[lane],
                false => state[lane],
            };
        }
        states.push(state);
        images.push(image);
    }
    let (here, there) = (quantity.values(&states), quantity.values(&images));
    let sums: Vec<f64> = here.iter().zip(there).map(|(a, b)| a + b).collect();
    let scale = here.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    let same = |sum: &f64| (sum - sums[0]).abs() <= ROUNDING * scale;
    sums.iter().all(same).then(|| 0.5 * sums[0])
}
