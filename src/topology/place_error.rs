//! How well place and height of a feature are known.
//!
//! Without noise a feature is read again as a critical point of a reconstruction of high order, of the density and of
//! its second discretisation, and of a rougher reconstruction. What these differ by is the error. As the
//! discretisations may cross at the very place, what differences that are independent from cell to cell would do is
//! added, to a height the relative difference of the densities as wholes. A peak at an end of the range that is not the
//! system's own may lie as far beyond it as the density goes on rising.
//! With noise it is read again from every replicate. Heights have besides what standard errors know and replicates do
//! not, as what a time step does.

use super::critical::{Critical, FLAT};
use super::field::Field;
use super::refine::refine;
use super::{Feature, FeatureErrors, FeatureKind};
use crate::density::{EstimatedDensity, Variants};
use crate::numerics::jackknife;

/// The errors of a feature of a density.
pub(super) fn errors(estimated: &EstimatedDensity, feature: &Feature) -> FeatureErrors {
    let found = match &estimated.variants {
        Variants::Jackknife(replicates) => by_replicates(estimated, feature, replicates),
        _ if estimated.is_noisy() => None,
        _ => by_reading_again(estimated, feature),
    };
    found.unwrap_or_default()
}

fn by_reading_again(estimated: &EstimatedDensity, feature: &Feature) -> Option<FeatureErrors> {
    let field = Field::new(estimated)?;
    let (values, at) = (field.values(), feature.position.as_slice());
    let near = |values| Critical::near(&field, at, feature.kind, values);
    let own = near(values)?;
    let second = field.second_scheme().and_then(near);
    let second = second.as_ref().unwrap_or(&own);
    let changes = estimated.truncation.change.iter();
    let closed: Vec<f64> = changes
        .zip(values)
        .map(|(change, value)| value + change)
        .collect();
    let closed = if closed.is_empty() {
        None
    } else {
        near(&closed)
    };
    let closed = closed.as_ref().unwrap_or(&own);
    let cell = field.cell_at(&own.position)?;
    let noise = *estimated.standard_error.get(cell)?;
    // The place of a ring is any point of it.
    let flat = match feature.kind {
        FeatureKind::Ring => FLAT,
        _ => 0.0,
    };
    let (rough, independent) = own.shifts(&field, noise, flat);
    let own_place = &own;
    let along = |k: usize| {
        let [given, own, second, closed] =
            [at, &own.position, &second.position, &closed.position].map(|place| place[k]);
        let read = (given - own).abs() + (second - own).abs() + (closed - own).abs();
        let axis = &field.axes()[k];
        let ends = [axis.from(), axis.to()].map(|end| given == end);
        let is_cut = |end: usize| ends[end] && !estimated.structure.is_own_end(k, end == 1);
        let beyond = match is_cut(0) || is_cut(1) {
            true => own_place.beyond_end(&field, k),
            false => 0.0,
        };
        read + rough[k] + independent[k] + beyond
    };
    // Polynomials that end where the feature is make more of what the last cells are off by.
    let error = match own.is_at_end {
        true => own.error(estimated) + noise,
        false => own.error(estimated).max(noise),
    };
    Some(FeatureErrors {
        position: (0..at.len()).map(along).collect(),
        density: Some(
            (feature.density - own.jet.value).abs()
                + error
                + whole(estimated) * feature.density.abs()
                + estimated.truncated(cell),
        ),
    })
}

/// The error of a density in the norm L1, over its mass.
fn whole(estimated: &EstimatedDensity) -> f64 {
    let errors = estimated.standard_error.iter();
    let parts = errors.zip(estimated.density.volumes());
    parts.map(|(error, volume)| error * volume).sum()
}

fn by_replicates(
    estimated: &EstimatedDensity,
    feature: &Feature,
    replicates: &[Vec<f64>],
) -> Option<FeatureErrors> {
    let cell = Field::new(estimated)?.cell_at(&feature.position)?;
    let mut variant = EstimatedDensity {
        variants: Variants::None,
        ..estimated.clone()
    };
    let mut read = |values: &Vec<f64>| {
        variant.density.values.clone_from(values);
        refine(&variant, cell, feature.kind)
    };
    let read: Vec<_> = replicates.iter().map(&mut read).collect();
    let of = |number: &dyn Fn(&super::extremum::Vertex) -> f64| jackknife(read.iter().map(number));
    let along = |k: usize| of(&|one| one.position[k]);
    // What sampling is not, as the time step beside a kink, is in the standard errors alone.
    let sampled = (estimated.variants).sampling_error(|values| values[cell]);
    let all = estimated
        .standard_error
        .get(cell)
        .copied()
        .unwrap_or(sampled);
    let besides = (all * all - sampled * sampled).max(0.0).sqrt();
    (read.len() > 1).then(|| FeatureErrors {
        position: (0..feature.position.len()).map(along).collect(),
        density: Some(of(&|one| one.density).hypot(besides) + estimated.truncated(cell)),
    })
}
