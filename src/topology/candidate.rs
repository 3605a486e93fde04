//! Components of superlevel and sublevel sets as candidates for features: judged between the cells where the density
//! allows it, and by the cells where it does not.

use super::critical::{Critical, height_above};
use super::field::Field;
use super::persistence::Component;
use super::refine::refine;
use super::ridge;
use super::significance::{Judgement, Limits};
use super::{Feature, FeatureErrors, FeatureKind, Verdict};
use crate::density::{EstimatedDensity, Kink};
use crate::numerics::sort_descending;

/// How many absent features of each kind are listed, so that a birth can be followed.
const ABSENT_LISTED: usize = 4;

/// How many components of each kind are looked at between the cells at most.
const MOST_LOOKED: usize = 48;

/// Up to so many cells from a kink a peak may stand on it.
const NEAR_KINK: f64 = 3.0;

/// Extrema found from different cells closer than this, in widths of a cell, are one.
const ONE_PLACE: f64 = 0.05;

/// A component with its verdict, before it is refined.
pub(super) struct Candidate {
    pub(super) component: Component,
    pub(super) persistence: f64,
    pub(super) standard_error: f64,
    pub(super) judgement: Judgement,
}

/// Judges components and keeps those worth listing, by falling persistence.
pub(super) fn judge(
    mut found: Vec<Component>,
    is_crater: bool,
    estimated: &EstimatedDensity,
    limits: &Limits,
) -> Vec<Candidate> {
    found.sort_by(|a, b| {
        b.persistence
            .total_cmp(&a.persistence)
            .then(a.birth.cmp(&b.birth))
    });
    let field = Field::new(estimated).filter(|_| is_smooth(estimated));
    let mut absent = 0;
    let mut looked = 0;
    let mut places: Vec<Vec<f64>> = Vec::new();
    let mut candidates: Vec<Candidate> = found
        .into_iter()
        .filter_map(|component| {
            // Few stand out of the noise by their cell values: only those are worth a closer look.
            let by_cells = limits.judge(component.persistence, noise(estimated, &component));
            let worth = match &field {
                Some(_) => looked < MOST_LOOKED && by_cells.significance > 0.0,
                None => by_cells.verdict != Verdict::Absent,
            };
            if !worth && absent >= ABSENT_LISTED {
                return None;
            }
            looked += 1;
            let refined = field
                .as_ref()
                .and_then(|field| height(field, estimated, &component, is_crater))
                .map(|refined| refined.unless_known(&mut places, estimated));
            let top = highest(estimated, &component, is_crater);
            let (persistence, standard_error, mut judgement) = match refined {
                Some(height) => {
                    let judged = |(height, error): (f64, f64)| {
                        let error = error + limits.error_of_ends(height, top);
                        (height.max(0.0), error, limits.judge_exact(height, error))
                    };
                    let proof = of_averages(estimated, &component).map(judged);
                    let is_present = |one: &(_, _, Judgement)| one.2.verdict == Verdict::Present;
                    let between = judged(height);
                    match proof.filter(is_present) {
                        Some(proof) if !is_present(&between) => proof,
                        _ => between,
                    }
                }
                None => read_by_cells(
                    estimated,
                    &component,
                    is_crater,
                    (limits, top),
                    field.is_some(),
                ),
            };
            if component.death.is_none() {
                judgement.verdict = Verdict::Present;
            }
            absent += usize::from(judgement.verdict == Verdict::Absent);
            (judgement.verdict != Verdict::Absent || absent <= ABSENT_LISTED).then_some(Candidate {
                component,
                persistence,
                standard_error,
                judgement,
            })
        })
        .collect();
    sort_descending(&mut candidates, |one| one.persistence);
    candidates
}

/// What cells show of a component that is not followed between them, with its error, where the density at its higher
/// critical point is `top`. A density that is smooth in truth, and cannot be followed, is narrower than its cells: what
/// they may have added to the component is not known then, and it is in doubt.
fn read_by_cells(
    estimated: &EstimatedDensity,
    component: &Component,
    is_crater: bool,
    (limits, top): (&Limits, f64),
    is_smooth: bool,
) -> (f64, f64, Judgement) {
    let judged = |persistence: f64| {
        let of_ends = limits.error_of_ends(persistence, top);
        let error = noise(estimated, component) + of_ends;
        (persistence, error, limits.judge(persistence, error))
    };
    let left = ridge::persistence(estimated, component, is_crater);
    let least = judged(left.least);
    if is_smooth && least.2.verdict == Verdict::Absent {
        let (persistence, error, judgement) = judged(left.most);
        return (persistence, error, judgement.in_doubt());
    }
    least
}

/// What the averages over cells alone prove of a component of a marginal, with its error: between two cells of a lower
/// average than a cell between them the density has a maximum, which rises at least as high above its surroundings as
/// the averages differ. The reconstruction may miss it where the density falls to nothing within few cells. `None` over
/// two axes, where a path past a saddle may lead between the cells, in the outermost cells, where an extremum may be no
/// more than the end of a slope, and beside a kink, whose own slopes say when a peak on it vanishes.
fn of_averages(estimated: &EstimatedDensity, component: &Component) -> Option<(f64, f64)> {
    let errors = &estimated.standard_error;
    let death = component.death?;
    let [axis] = estimated.density.axes.as_slice() else {
        return None;
    };
    let inner = 2..errors.len().saturating_sub(2);
    let (at, reach) = (
        axis.centre(component.birth),
        NEAR_KINK * axis.width(component.birth),
    );
    let mut kinks = estimated.structure.kinks.iter();
    let is_sure =
        inner.contains(&component.birth) && !kinks.any(|kink| (kink.at - at).abs() < reach);
    is_sure.then(|| {
        (
            component.persistence,
            errors[component.birth] + errors[death],
        )
    })
}

/// The density in the higher one of a component's cells: of a crater that of its rim.
fn highest(estimated: &EstimatedDensity, component: &Component, is_crater: bool) -> f64 {
    let cell = match (is_crater, component.death) {
        (true, Some(rim)) => rim,
        _ => component.birth,
    };
    estimated.density.values[cell]
}

/// Standard error of the difference between a component's cells of birth and death.
fn noise(estimated: &EstimatedDensity, component: &Component) -> f64 {
    let errors = &estimated.standard_error;
    let death_error = component.death.map_or(0.0, |cell| errors[cell]);
    errors[component.birth].hypot(death_error)
}

/// Whether the density can be judged between its cells. Noise forbids it, and a plane with a jump of the derivative in
/// a joint density: along such a plane a ridge has a sharp edge, which no polynomial follows.
pub(super) fn is_smooth(estimated: &EstimatedDensity) -> bool {
    let is_marginal = estimated.density.axes.len() == 1;
    !estimated.is_noisy() && (is_marginal || estimated.structure.kinks.iter().all(Kink::is_bend))
}

/// A component between the cells.
struct Refined {
    /// Height of its critical point over the saddle where it dies, of a crater its depth below.
    height: f64,
    error: f64,
    /// Where the critical point is.
    position: Vec<f64>,
}

impl Refined {
    /// Height and error; none where the critical point is one of the `places` of others, to which it is added
    /// otherwise: cells to both sides of one extremum may each be lower than their neighbours.
    fn unless_known(self, places: &mut Vec<Vec<f64>>, estimated: &EstimatedDensity) -> (f64, f64) {
        let axes = &estimated.density.axes;
        let is_here = |other: &Vec<f64>| {
            let pairs = other.iter().zip(&self.position).zip(axes);
            pairs.into_iter().all(|((other, own), axis)| {
                let width = axis.find(*own).map_or(0.0, |cell| axis.width(cell));
                (other - own).abs() < ONE_PLACE * width
            })
        };
        if places.iter().any(is_here) {
            return (0.0, self.error);
        }
        if self.height > 0.0 {
            places.push(self.position);
        }
        (self.height, self.error)
    }
}

/// A component between the cells; `None` for the one that never dies.
fn height(
    field: &Field<'_>,
    estimated: &EstimatedDensity,
    component: &Component,
    is_crater: bool,
) -> Option<Refined> {
    let death = component.death?;
    let values = &estimated.density.values;
    let kind = if is_crater {
        FeatureKind::Crater
    } else {
        FeatureKind::Peak
    };
    let extremum = Critical::near(field, &field.centre(component.birth), kind, values)?;
    let saddle = Critical::near(field, &field.centre(death), FeatureKind::Valley, values)?;
    // Where features are no wider than cells, what joins two of them may be no saddle: the way around is not seen.
    if saddle.is_extremum() {
        return None;
    }
    let (height, error) = if is_crater {
        height_above(&saddle, &extremum, estimated)
    } else {
        height_above(&extremum, &saddle, estimated)
    };
    // At an end polynomials reach beyond the last average, which proves no more than it stands out by itself.
    let height = match extremum.is_at_end {
        true => height.min(component.persistence),
        false => height,
    };
    // A density is nowhere negative: beside a saddle that is, a peak stands out by no more than its own height.
    let highest = if is_crater { &saddle } else { &extremum };
    let height = height.min(highest.value(values));
    // Else a cell that is the highest around it only because of how the cells lie.
    let is_level = |place: &Critical| place.is_level(height, estimated);
    let is_of_kind = extremum.is_of_kind(kind, height) && is_level(&extremum) && is_level(&saddle);
    Some(Refined {
        height: if is_of_kind { height } else { 0.0 },
        error,
        position: extremum.position,
    })
}

impl Candidate {
    /// The feature of the given kind at the given cell, which is that of birth or death.
    pub(super) fn feature(
        &self,
        estimated: &EstimatedDensity,
        kind: FeatureKind,
        cell: usize,
    ) -> Feature {
        let place = refine(estimated, cell, kind);
        Feature {
            kind,
            position: place.position,
            density: place.density,
            persistence: self.persistence,
            standard_error: self.standard_error,
            significance: self.judgement.significance,
            verdict: self.judgement.verdict,
            partner: self.partner(estimated, kind),
            errors: FeatureErrors::default(),
        }
    }

    /// The saddle where it merges.
    fn partner(&self, estimated: &EstimatedDensity, kind: FeatureKind) -> Option<Vec<f64>> {
        let saddle = self
            .component
            .death
            .filter(|_| kind != FeatureKind::Valley)?;
        Some(refine(estimated, saddle, FeatureKind::Valley).position)
    }
}
