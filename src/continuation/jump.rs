//! Whether an indicator passes zero between two values, or jumps to the other side of it because what it is read from changes there.

use super::Point;
use super::change::Crossing;
use crate::topology::{Detector, Indicator};

/// Times as steep as beside a bracket that an indicator must be inside it to have jumped. A smooth one is as steep, within a few times.
const STEEPER: f64 = 30.0;
/// Widths of the bracket within which values beside it tell how steep the indicator is.
const BESIDE: f64 = 16.0;

/// The sentence for an indicator that does not pass zero: two densities on either side that are solved in different ways, or a value that does not
/// come down while the bracket closes in on the zero.
pub(super) fn instead_of_zero(
    points: &[&Point],
    crossing: &Crossing,
    detector: &dyn Detector,
) -> Option<String> {
    let (left, right) = (crossing.left, crossing.left + 1);
    let by_quadrature =
        |index: usize| points[index].densities[crossing.observable].is_by_quadrature();
    if by_quadrature(left) != by_quadrature(right) {
        return Some(
            "from there on the drift at an end of Ω points outward, and what is seen beside that end changes: a wider range is needed"
                .to_owned(),
        );
    }
    // Noise makes every indicator uneven.
    if crossing.ends.iter().any(|end| end.sampling_error > 0.0) {
        return None;
    }
    let [below, above] = [(left, &crossing.ends[0]), (right, &crossing.ends[1])];
    let inside = slope(points, below, above);
    let width = points[right].value - points[left].value;
    let beyond = |end: (usize, &Indicator), index: Option<usize>| {
        let index = index.filter(|&index| index < points.len())?;
        let is_near = (points[index].value - points[end.0].value).abs() <= BESIDE * width.abs();
        let density = points[index].densities.get(crossing.observable)?;
        let one = is_near.then(|| detector.indicator(density, end.1.kind, &end.1.place))??;
        Some(slope(points, (index, &one), end))
    };
    let outside = [
        beyond(below, left.checked_sub(1)),
        beyond(above, Some(right + 1)),
    ];
    let jumps = outside
        .into_iter()
        .flatten()
        .any(|slope| inside > STEEPER * slope);
    jumps.then(|| {
        "the slope or curvature that tells of it jumps there in place of passing zero: a wider range or more cells may show why".to_owned()
    })
}

/// Change of an indicator over the parameter, without its sign, between two points given by their numbers.
fn slope(points: &[&Point], a: (usize, &Indicator), b: (usize, &Indicator)) -> f64 {
    ((b.1.value - a.1.value) / (points[b.0].value - points[a.0].value)).abs()
}
