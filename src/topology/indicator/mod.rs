//! Indicators: signed, continuous functions of the parameter that are zero at a P-bifurcation.
//!
//! Near a smooth P-bifurcation the peaks stand above the valley by (θ - θ*)² or less, so that counting them is late;
//! the derivative that changes sign there goes through zero linearly. Which one it is depends on what happens:
//!
//! | what happens | indicator |
//! | --- | --- |
//! | one peak splits at a centre of symmetry | curvature p''/p at the centre |
//! | the same at a kink | slope p'/p on the upper side of the kink |
//! | a peak and a valley are born together elsewhere | slope \|p'\|/p at the inflection between them |
//! | the same at a kink that is no centre | slope p'/p on one side of the kink |
//! | where slope and curvature beside a kink are zero: births at the kink, or away from it | (log p)'' on one side of the kink |
//! | joint density, smooth centre | the two curvatures of p/p along its principal directions |
//! | joint density, centre on a kink | slope across the kink; curvature along it |
//! | joint density, a peak becomes a saddle, or a saddle a peak, on a line of symmetry away from a centre | curvature across the line |
//! | two peaks merge at the valley between them, or a peak appears within a valley, away from a centre | (log p)'' where (log p)''' = 0, less that at which one peak goes alone |
//! | joint density, a peak opens to a ring away from a centre, or two rings merge | curvature along an axis there |
//! | where one peak splits, and curvature is zero: at the centre or away from it | p''''/p at the centre |
//!
//! All are relative to the density at the place, so that its scale does not matter.

mod beside;
mod centre;
mod corrected;
mod crest;
mod exact;
mod fold;
mod kind;
mod level;
mod merger;
mod natural_end;
mod pair;
mod quartic;
mod registry;
mod ring;
mod section;
mod shoulder;
mod smooth;
mod split;
#[cfg(test)]
mod tests;
mod window;
#[cfg(feature = "serde")]
mod written;

pub(crate) use beside::born_at_kink;
pub(super) use centre::at_centre;
pub(super) use corrected::{Counted, correct};
pub(super) use crest::flanks_of_crests;
pub use exact::Flank;
pub use kind::IndicatorKind;
pub(crate) use natural_end::peaks_at_ends;
pub(super) use pair::correct_about_centre;
pub(super) use section::flanks_from_centre;
pub(super) use shoulder::shoulders;

pub(crate) use kind::Step;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::density::{EstimatedDensity, Variants};
use crate::space::Axis;

/// An indicator at one parameter value.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Indicator {
    /// Which.
    pub kind: IndicatorKind,
    /// Where, one coordinate an axis of the density.
    pub place: Vec<f64>,
    /// Its value, a derivative over the density.
    pub value: f64,
    /// Jackknife standard error from sampling.
    pub sampling_error: f64,
    /// Degrees of freedom of the sampling error.
    pub degrees_of_freedom: f64,
    /// What a second discretisation and a reconstruction of lower order change.
    pub systematic_error: f64,
    /// Change of the value by relative errors of one, independent in every cell near the place; times the solver's
    /// relative error it is the solver's part.
    pub sensitivity: f64,
    /// Its values for the jackknife's replicates; empty without sampling.
    pub replicates: Vec<f64>,
}

impl Indicator {
    /// The sign, if it is beyond doubt: the value exceeds the systematic error by more than sampling makes with
    /// the given probability (both signs together).
    pub(crate) fn sign(&self, doubt: f64) -> Option<bool> {
        let sampling = if self.sampling_error > 0.0 {
            self.sampling_error * two_sided_limit(doubt, self.degrees_of_freedom)
        } else {
            0.0
        };
        (self.value.abs() > self.systematic_error + sampling).then_some(self.value > 0.0)
    }

    /// Whether it follows from the equations, without cells or samples: no finer grid can tell more of it.
    pub(crate) fn is_free_of_cells(&self) -> bool {
        self.sensitivity == 0.0 && self.sampling_error == 0.0
    }

    /// An indicator whose value and error are known without cells.
    fn known(kind: IndicatorKind, place: f64, value: f64, error: f64) -> Option<Self> {
        (value.is_finite() && error.is_finite()).then(|| Self {
            kind,
            place: vec![place],
            value,
            sampling_error: 0.0,
            degrees_of_freedom: f64::INFINITY,
            systematic_error: error,
            sensitivity: 0.0,
            replicates: Vec::new(),
        })
    }

    /// An indicator from the function that derives it from the values of a density, and a less accurate one.
    fn derive(
        estimated: &EstimatedDensity,
        kind: IndicatorKind,
        place: Vec<f64>,
        function: impl Fn(&[f64]) -> f64,
        rougher: impl Fn(&[f64]) -> f64,
    ) -> Option<Self> {
        let values = &estimated.density.values;
        let variants = &estimated.variants;
        let value = function(values);
        let sensitivity = sensitivity(estimated, &place, value, &function);
        // What follows from the equations has no pole where the density is small.
        if sensitivity > 0.0 && !is_clear(estimated, &place, CLEAR) {
            return None;
        }
        let replicates: Vec<f64> = match variants {
            Variants::Jackknife(all) => all.iter().map(|one| function(one)).collect(),
            _ => Vec::new(),
        };
        let gap = |values: &[f64]| function(values) - rougher(values);
        let noise = variants.sampling_error(gap);
        let rough = (gap(values).abs() - noise).max(0.0);
        let scheme = variants.second_scheme();
        let scheme = scheme.map_or(0.0, |values| (function(values) - value).abs());
        let sampling_error = variants.sampling_error(&function);
        let finite = [value, sampling_error, rough, scheme];
        finite
            .iter()
            .all(|number| number.is_finite())
            .then_some(Self {
                kind,
                value,
                sampling_error,
                degrees_of_freedom: variants.degrees_of_freedom(),
                systematic_error: rough + scheme,
                sensitivity,
                place,
                replicates,
            })
    }
}

/// Whether the cells tell the density at a place: derivatives of what the solver leaves where there is nothing have
/// any sign. Noise has errors of its own.
fn is_told(estimated: &EstimatedDensity, place: &[f64]) -> bool {
    let density = &estimated.density;
    let mut pairs = density.axes.iter().zip(place);
    let cell = pairs.try_fold(0, |cell, (axis, &at)| {
        Some(cell * axis.count() + axis.find(axis.wrapped(at))?)
    });
    let value = cell.and_then(|cell| density.values.get(cell)).copied();
    let least = estimated.negligible * density.maximum();
    estimated.is_noisy() || value.is_some_and(|value| value > least)
}

/// Times its own error that a density must be where an indicator is read. Where it is not, the density may pass zero
/// there, and a derivative over it has a pole, whose change of sign is no bifurcation.
const CLEAR: f64 = 2.0;
/// Cells on either side of a place on which that is asked. Farther cells of a stencil may lie in a tail, where schemes
/// differ by much of next to nothing: a derivative at the place hardly depends on them.
const BESIDE: usize = 1;

/// Whether a density is a clear multiple of its error in the cell of a place and in those beside it along the axes: of
/// its distance to the second scheme, and of what the solver leaves. Sampled densities have tests of their own.
pub(crate) fn is_clear(estimated: &EstimatedDensity, place: &[f64], times: f64) -> bool {
    let density = &estimated.density;
    // Extrema that follow from the equations are there however low the density is.
    if estimated.is_noisy() || estimated.structure.profile.is_some() {
        return true;
    }
    let second = estimated.variants.second_scheme();
    let least = estimated.negligible * density.maximum();
    let is_clear = |cell: usize| {
        let value = density.values[cell];
        let error = second.map_or(0.0, |second| (second[cell] - value).abs());
        value > times / CLEAR * least && value > times * error
    };
    let near = |k: usize| near(&density.axes[k], place[k], BESIDE);
    match density.axes.as_slice() {
        [_] => near(0).all(is_clear),
        [first, second] => {
            let row = first.find(first.wrapped(place[0]));
            let column = second.find(second.wrapped(place[1]));
            let (Some(row), Some(column)) = (row, column) else {
                return false;
            };
            let along_first = near(0).map(|one| one * second.count() + column);
            let along_second = near(1).map(|one| row * second.count() + one);
            along_first.chain(along_second).all(is_clear)
        }
        _ => true,
    }
}

/// The cell along an axis that holds a coordinate, and so many on either side.
fn near(axis: &Axis, at: f64, reach: usize) -> std::ops::Range<usize> {
    let middle = axis.find(axis.wrapped(at)).unwrap_or(0);
    middle.saturating_sub(reach)..(middle + reach + 1).min(axis.count())
}

/// Cells on either side of a place that its derivatives may depend on.
const NEIGHBOURHOOD: usize = 4;
/// Relative step of the differences that give a sensitivity.
const RELATIVE_STEP: f64 = 1e-6;

/// Root of the sum of squares of what relative errors of one in the cells near the place change: relative errors of
/// size ε, independent of each other, change the number by ε times this.
fn sensitivity(
    estimated: &EstimatedDensity,
    place: &[f64],
    value: f64,
    function: &impl Fn(&[f64]) -> f64,
) -> f64 {
    let axes = &estimated.density.axes;
    let near = |k: usize| near(&axes[k], place[k], NEIGHBOURHOOD);
    let cells: Vec<usize> = match axes.get(1) {
        None => near(0).collect(),
        Some(axis) => near(0)
            .flat_map(|first| near(1).map(move |second| first * axis.count() + second))
            .collect(),
    };
    let mut values = estimated.density.values.clone();
    let mut square = |cell: usize| {
        let kept = values[cell];
        values[cell] *= 1.0 + RELATIVE_STEP;
        let change = (function(&values) - value) / RELATIVE_STEP;
        values[cell] = kept;
        change * change
    };
    cells.into_iter().map(&mut square).sum::<f64>().sqrt()
}

/// Standard errors that a Student variable exceeds in magnitude with probability `doubt`.
pub(crate) fn two_sided_limit(doubt: f64, freedom: f64) -> f64 {
    // Beyond a million degrees the distribution is the normal one to all digits that matter.
    let student = StudentsT::new(0.0, 1.0, freedom.min(1e6));
    student.map_or(f64::INFINITY, |student| {
        -student.inverse_cdf((0.5 * doubt).clamp(1e-18, 0.5))
    })
}
