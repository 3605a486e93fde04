//! Whether an indicator passes zero between two values, or jumps to the other side of it because what it is read from
//! changes there.

use super::Point;
use super::doubt::Doubt;
use super::follow::Crossing;
use crate::topology::{Detector, Indicator};

/// Times as steep as beside a bracket that an indicator must be inside it to have jumped. A smooth one is as steep,
/// within a few times.
const STEEPER: f64 = 30.0;
/// Widths of the bracket within which values beside it tell how steep the indicator is.
const BESIDE: f64 = 16.0;

/// The doubt in an indicator that does not pass zero: two densities on either side that are solved in different
/// ways, or a value that does not come down while the bracket closes in on the zero.
pub(super) fn instead_of_zero(
    points: &[&Point],
    crossing: &Crossing,
    detector: &dyn Detector,
) -> Option<Doubt> {
    let (left, right) = (crossing.left, crossing.left + 1);
    let by_quadrature =
        |index: usize| points[index].densities[crossing.observable].is_by_quadrature();
    if by_quadrature(left) != by_quadrature(right) {
        return Some(Doubt::OutwardDrift);
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
    jumps.then_some(Doubt::Jump)
}

/// Change of an indicator over the parameter, without its sign, between two points given by their numbers.
fn slope(points: &[&Point], a: (usize, &Indicator), b: (usize, &Indicator)) -> f64 {
    ((b.1.value - a.1.value) / (points[b.0].value - points[a.0].value)).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuation::SolveReport;
    use crate::density::{Density, EstimatedDensity, Observable};
    use crate::space::Axis;
    use crate::topology::{Detection, IndicatorKind};

    /// Densities whose first value is the indicator.
    struct FirstValue;

    impl Detector for FirstValue {
        fn name(&self) -> &'static str {
            "first value"
        }
        fn detect(&self, _: &EstimatedDensity) -> Detection {
            unreachable!("only indicators are asked for")
        }
        fn indicator(
            &self,
            density: &EstimatedDensity,
            kind: IndicatorKind,
            _: &[f64],
        ) -> Option<Indicator> {
            Some(indicator(kind, density.density.values[0]))
        }
    }

    fn indicator(kind: IndicatorKind, value: f64) -> Indicator {
        Indicator {
            kind,
            place: vec![0.0],
            value,
            sampling_error: 0.0,
            degrees_of_freedom: f64::INFINITY,
            systematic_error: 0.0,
            sensitivity: 1.0,
            replicates: Vec::new(),
        }
    }

    fn point(value: f64, of: f64, negligible: f64) -> Point {
        let density = EstimatedDensity {
            negligible,
            ..EstimatedDensity::new(
                Observable::Marginal(0),
                Density {
                    axes: vec![Axis::uniform(-1.0, 1.0, 2).unwrap()],
                    values: vec![of; 2],
                },
            )
        };
        Point {
            value,
            report: SolveReport::solved("exact"),
            densities: vec![density],
            detections: Vec::new(),
            distance: None,
            seconds: 0.0,
        }
    }

    /// What is said of a function of the parameter that changes its sign between 0.5 and 0.5 + width, given values
    /// beside.
    fn doubt(of: impl Fn(f64) -> f64, width: f64, sampling_error: f64) -> Option<Doubt> {
        let values = [0.5 - 4.0 * width, 0.5, 0.5 + width, 0.5 + 5.0 * width];
        let points = values.map(|value| point(value, of(value), 1e-7));
        let ends = [1, 2].map(|index| Indicator {
            sampling_error,
            ..indicator(IndicatorKind::CURVATURE, of(values[index]))
        });
        let crossing = Crossing {
            observable: 0,
            left: 1,
            ends,
        };
        assert!(crossing.ends[0].value * crossing.ends[1].value <= 0.0);
        instead_of_zero(&points.each_ref(), &crossing, &FirstValue)
    }

    #[test]
    fn a_step_is_told_from_a_zero_however_narrow_the_bracket() {
        let zero = 0.500_000_05;
        for width in [1e-3, 1e-5, 1e-7] {
            let at = 0.5 + 0.3 * width;
            let smooth = |x: f64| 3.0 * (x - at) + (x - at).powi(2);
            assert_eq!(doubt(smooth, width, 0.0), None);
            let step = |x: f64| if x > zero { 0.2 } else { -0.1 } + 0.5 * (x - zero);
            assert_eq!(doubt(step, width, 0.0), Some(Doubt::Jump));
            // Noise makes every indicator uneven.
            assert_eq!(doubt(step, width, 0.01), None);
        }
    }

    #[test]
    fn steep_is_no_jump() {
        // A cubic root is the steepest of smooth branches that meet zero, two zeros at a distance of a bracket a fold
        // of them.
        let root = |x: f64| (x - 0.500_02_f64).cbrt();
        assert_eq!(doubt(root, 1e-4, 0.0), None);
        let two = |x: f64| (x - 0.500_05) * (x - 0.500_2) * -1e4;
        assert_eq!(doubt(two, 1e-4, 0.0), None);
    }

    #[test]
    fn densities_that_are_solved_in_different_ways_are_told() {
        let points = [point(0.0, -1.0, 0.0), point(1.0, 1.0, 1e-7)];
        let ends = [-1.0, 1.0].map(|value| indicator(IndicatorKind::CURVATURE, value));
        let crossing = Crossing {
            observable: 0,
            left: 0,
            ends,
        };
        let doubt = instead_of_zero(&points.each_ref(), &crossing, &FirstValue);
        assert_eq!(doubt, Some(Doubt::OutwardDrift));
    }
}
