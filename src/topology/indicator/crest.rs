//! Flanks of a joint density along its crests: where a peak and a saddle are about to be born, or to vanish, away from
//! any centre.
//!
//! Along an axis the highest points of the lines across it make crests, of which there may be several side by side. The
//! slope of log p along a crest is that along the axis, because p is level across it; its extrema are the shoulders at
//! which pairs are born, as those of a marginal are.

use super::Flank;
use crate::density::EstimatedDensity;
use crate::topology::field::{Field, Jet};

/// Cells by which a crest may move aside from one line to the next: steeper ones are followed along the other axis.
const ASIDE: f64 = 2.0;

/// Least bend of the slope along a crest over what its curvature across would make of it: the crest of a ring has none.
const LEAST_BEND: f64 = 0.01;

/// By how many times what the second scheme differs by an extremum must stand out.
const CLEAR: f64 = 3.0;

/// Steps of Newton's method to the top of a line.
const STEPS: usize = 2;

/// A point of a crest.
#[derive(Clone, Copy)]
struct Top {
    /// Across the axis.
    place: f64,
    /// Of log p along the axis.
    slope: f64,
    /// By how much the second scheme differs from it.
    error: f64,
    /// -(log p)'' across it.
    curvature: f64,
    /// Of the density, over its largest value.
    height: f64,
}

/// The extrema of the slope along crests, with the axis that each runs along. They say where to look, and are read on
/// the centres of cells. None where a derivative of the density jumps, of marginals, of sampled densities, and where
/// there is a centre of symmetry: indicators are read there, and the crest of a ring about it has no slope. Below a
/// floor, a share of the maximum, those alone of which schemes are sure: what else may be there is too low to count.
pub(crate) fn flanks_of_crests(estimated: &EstimatedDensity, floor: f64) -> Vec<Flank> {
    let is_smooth = estimated.structure.kinks.iter().all(|kink| kink.is_bend());
    let usable = is_smooth && estimated.structure.centre.is_none() && !estimated.is_noisy();
    let usable = usable && estimated.density.axes.len() == 2;
    match Field::new(estimated).filter(|_| usable) {
        Some(field) => [0, 1]
            .into_iter()
            .flat_map(|along| flanks(estimated, &field, (along, floor)))
            .collect(),
        None => Vec::new(),
    }
}

fn flanks(
    estimated: &EstimatedDensity,
    field: &Field<'_>,
    (along, floor): (usize, f64),
) -> Vec<Flank> {
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
    let inner = tops.iter().enumerate().skip(1);
    for (line, own) in inner.take(axis.count().saturating_sub(2)) {
        for here in own {
            let (Some(left), Some(right)) = (near(line - 1, here), near(line + 1, here)) else {
                continue;
            };
            let (up, down) = (here.slope - left.slope, here.slope - right.slope);
            let bend = (up + down) / axis.width(line).powi(2);
            let is_turn = (up >= 0.0 && down > 0.0) || (up <= 0.0 && down < 0.0);
            let errors = left.error + here.error + right.error;
            let is_sure = (up + down).abs() > CLEAR * errors && here.slope.abs() > here.error;
            let may_be_zero = here.slope.abs() <= CLEAR * here.error && here.height > floor;
            let is_bent = bend.abs() > LEAST_BEND * here.curvature.powf(1.5);
            if is_turn && (is_sure || may_be_zero) && is_bent {
                let rising = bend > 0.0;
                found.push(Flank {
                    rising,
                    place: axis.centre(line),
                    value: if rising { here.slope } else { -here.slope },
                    line: 1 + along,
                    is_sure,
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
        let slope = |jet: &Jet| jet.first[along] / (field.unit(along) * jet.value);
        let second = match field.second_scheme() {
            Some(values) => field.stencil(&at, 0)?.jet(values),
            None => jet,
        };
        let curvature = -jet.second[2 * (1 - along)] / (unit * unit * jet.value);
        (jet.value > least && curvature > 0.0).then(|| Top {
            place: at[1 - along],
            slope: slope(&jet),
            error: (slope(&second) - slope(&jet)).abs(),
            curvature,
            height: jet.value / estimated.density.maximum(),
        })
    };
    (1..across.count().saturating_sub(1))
        .filter(is_top)
        .filter_map(followed)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::flanks_of_crests;
    use crate::density::{Density, EstimatedDensity, Observable};
    use crate::space::Axis;

    /// log p = 2 (θ x - cosh x + c x²/2) - (y - x/2)²: along the crest y = x/2 the slope is 2 (θ - sinh x + c x), with
    /// extrema where cosh x = c.
    #[test]
    fn the_slope_along_a_crest_passes_zero_with_its_folds() {
        let c: f64 = 1.2;
        let at = c.acosh();
        let fold = (at.sinh() - c * at).abs();
        let flanks = |theta: f64| {
            let axis = Axis::uniform(-3.0, 3.0, 100).unwrap();
            let centres = axis.centres();
            let log = |x: f64, y: f64| {
                2.0 * (theta * x - x.cosh() + 0.5 * c * x * x) - (y - 0.5 * x).powi(2)
            };
            let rows = centres.iter();
            let values: Vec<f64> = rows
                .flat_map(|x| centres.iter().map(move |y| log(*x, *y).exp()))
                .collect();
            let estimated = EstimatedDensity {
                negligible: 1e-7,
                ..EstimatedDensity::new(
                    Observable::Joint(0, 1),
                    Density {
                        axes: vec![axis.clone(), axis],
                        values,
                    },
                )
            };
            flanks_of_crests(&estimated, 1e-3)
        };
        for theta in [-2.0, -0.5, 0.5, 2.0].map(|share| share * fold) {
            for rising in [false, true] {
                let found = flanks(theta);
                let is_it = |one: &&super::Flank| one.line == 1 && one.rising == rising;
                let found = found.iter().find(is_it).unwrap();
                let side = if rising { 1.0 } else { -1.0 };
                let exact = 2.0 * (side * theta + fold);
                // Read half a cell of 0.06 from the extremum at most, where the slope bends by 2 sinh x.
                let read = at.sinh() * 0.03 * 0.03;
                assert!((found.place - side * at).abs() < 0.06, "{found:?}");
                assert!(
                    (found.value - exact).abs() < 2.0 * read,
                    "{found:?} {exact}"
                );
            }
        }
    }
}
