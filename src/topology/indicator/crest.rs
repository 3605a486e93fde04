//! Flanks of a joint density along its crests: where a peak and a saddle are about to be born, or to vanish, away from
//! any centre.
//!
//! Along an axis the highest points of the lines across it make crests, of which there may be several side by side. The
//! slope of log p along a crest is that along the axis, because p is level across it; its extrema are the shoulders at
//! which pairs are born, as those of a marginal are.

use super::Flank;
use crate::density::EstimatedDensity;
use crate::topology::field::Field;

/// Cells by which a crest may move aside from one line to the next: steeper ones are followed along the other axis.
const ASIDE: f64 = 2.0;

/// Least bend of the slope along a crest over what its curvature across would make of it: the crest of a ring has none.
const LEAST_BEND: f64 = 0.01;

/// Steps of Newton's method to the top of a line.
const STEPS: usize = 2;

/// A point of a crest.
#[derive(Clone, Copy)]
struct Top {
    /// Across the axis.
    place: f64,
    /// Of log p along the axis.
    slope: f64,
    /// -(log p)'' across it.
    curvature: f64,
}

/// The extrema of the slope along crests, with the axis that each runs along; none where a derivative of the density
/// jumps, of marginals, and of sampled densities. They say where to look, and are read on the centres of cells.
pub(crate) fn flanks_of_crests(estimated: &EstimatedDensity) -> Vec<Flank> {
    let is_smooth = estimated.structure.kinks.iter().all(|kink| kink.is_bend());
    let usable = estimated.density.axes.len() == 2 && is_smooth && !estimated.is_noisy();
    match Field::new(estimated).filter(|_| usable) {
        Some(field) => [0, 1]
            .into_iter()
            .flat_map(|along| flanks(estimated, &field, along))
            .collect(),
        None => Vec::new(),
    }
}

fn flanks(estimated: &EstimatedDensity, field: &Field<'_>, along: usize) -> Vec<Flank> {
    let (axis, across) = (&field.axes()[along], &field.axes()[1 - along]);
    let tops: Vec<Vec<Top>> = (0..axis.count())
        .map(|line| tops(estimated, field, along, line))
        .collect();
    let near = |line: usize, top: &Top| -> Option<Top> {
        let reach = ASIDE * across.width(across.find(top.place)?);
        let distance = |one: &&Top| (one.place - top.place).abs();
        let nearest = tops[line]
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.filter(|one| distance(one) <= reach).copied()
    };
    let mut found = Vec::new();
    for line in 1..axis.count().saturating_sub(1) {
        for here in &tops[line] {
            let (Some(left), Some(right)) = (near(line - 1, here), near(line + 1, here)) else {
                continue;
            };
            let (up, down) = (here.slope - left.slope, here.slope - right.slope);
            let bend = (up + down) / axis.width(line).powi(2);
            let is_turn = (up >= 0.0 && down > 0.0) || (up <= 0.0 && down < 0.0);
            if is_turn && bend.abs() > LEAST_BEND * here.curvature.powf(1.5) {
                let rising = bend > 0.0;
                found.push(Flank {
                    rising,
                    place: axis.centre(line),
                    value: if rising { here.slope } else { -here.slope },
                    line: 1 + along,
                });
            }
        }
    }
    found
}

/// The points of crests on the line of cells at a place of an axis.
fn tops(estimated: &EstimatedDensity, field: &Field<'_>, along: usize, line: usize) -> Vec<Top> {
    let (axis, across) = (&field.axes()[along], &field.axes()[1 - along]);
    let values = field.values();
    let cell = |place: usize| match along {
        0 => line * across.count() + place,
        _ => place * axis.count() + line,
    };
    let least = estimated.negligible_height() * estimated.density.maximum();
    let is_top = |place: &usize| {
        let [below, here, above] = [place - 1, *place, place + 1].map(|one| values[cell(one)]);
        here > least && here >= below && here > above
    };
    let followed = |place: usize| -> Option<Top> {
        let mut at = [axis.centre(line); 2];
        at[1 - along] = across.centre(place);
        let (unit, width) = (field.unit(1 - along), across.width(place));
        let mut jet = field.jet(&at)?;
        for _ in 0..STEPS {
            let step = -unit * jet.first[1 - along] / jet.second[2 * (1 - along)];
            at[1 - along] =
                (at[1 - along] + step.clamp(-width, width)).clamp(across.from(), across.to());
            jet = field.jet(&at)?;
        }
        let curvature = -jet.second[2 * (1 - along)] / (unit * unit * jet.value);
        (jet.value > least && curvature > 0.0).then(|| Top {
            place: at[1 - along],
            slope: jet.first[along] / (field.unit(along) * jet.value),
            curvature,
        })
    };
    (1..across.count().saturating_sub(1))
        .filter(is_top)
        .filter_map(followed)
        .collect()
}
