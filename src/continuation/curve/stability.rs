//! Curves in a plane of two parameters that follow from the equations about a fixed point alone: where its largest
//! Lyapunov exponent is zero (D-bifurcations), and where the density beside it turns from infinite to zero.
//!
//! Both are zeros of functions that cost microseconds and are known to rounding, so that no densities are solved for.

use super::zero_lines::{Field, ON_IT, ROUNDING};
use super::{Plane, distance};
use crate::exponent::largest;
use crate::system::{Family, Linearised};

/// What changes on a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StabilityKind {
    /// The largest Lyapunov exponent of the fixed point passes zero: a D-bifurcation.
    Exponent,
    /// The stationary density of all axes turns from infinite to zero at the fixed point: a P-bifurcation, at which its
    /// peak opens into a crater.
    Density,
}

impl StabilityKind {
    /// Both.
    const ALL: [Self; 2] = [Self::Exponent, Self::Density];

    /// What is zero on the curve.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exponent => "largest exponent of the fixed point",
            Self::Density => "thinning at the fixed point",
        }
    }

    /// What happens there.
    pub fn words(self) -> &'static str {
        match self {
            Self::Exponent => "the largest exponent of the fixed point is zero",
            Self::Density => "the density turns from infinite to zero at the fixed point",
        }
    }

    /// Letter that the names of its curves begin with.
    fn letter(self) -> char {
        match self {
            Self::Exponent => 'D',
            Self::Density => 'P',
        }
    }
}

/// A point of such a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StabilityPoint {
    /// Values of both parameters.
    pub values: [f64; 2],
    /// Half-width of the band that is believed to hold the true curve, across the curve, as a share of the sides of the
    /// box.
    pub error: f64,
}

/// A curve on which the stability of a fixed point, or the density beside it, changes.
#[derive(Debug, Clone)]
pub struct StabilityCurve {
    /// `D1`, `D2`, … of D-bifurcations; `P1`, … of densities at the fixed point.
    pub name: String,
    /// What changes there.
    pub kind: StabilityKind,
    /// Its points from end to end; the first again at the end where it is closed.
    pub points: Vec<StabilityPoint>,
}

impl StabilityCurve {
    /// Whether it is of D-bifurcations, and passes a place of the box with sides of length one.
    pub(crate) fn passes(&self, plane: &Plane, at: [f64; 2]) -> bool {
        let places = self.points.iter().map(|point| plane.place(point.values));
        let line: Vec<[f64; 2]> = places.collect();
        self.kind == StabilityKind::Exponent && distance(&line, at) <= ON_IT
    }

    /// The largest error of its points.
    pub fn largest_error(&self) -> f64 {
        let errors = self.points.iter().map(|point| point.error);
        errors.fold(0.0, f64::max)
    }
}

/// All such curves in the box of a plane, of the fixed point that a family asks for; none where it asks for none.
///
/// ```
/// use pbif::continuation::curve::{Plane, StabilityKind, stability_curves};
/// use pbif::system::{Family, Interpretation, Path, TypedModel};
///
/// // dx = (a x - x³) dt + b x dW in Itô's sense: the exponent at rest is a - b²/2, and the density beside it goes like
/// // the power 2a/b² - 2 of the distance.
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let model = TypedModel::new("pitchfork", "Pitchfork", ["x"])
///     .with_equation("x", "a x - x^3")
///     .with_noise("x", ["b x"])
///     .with_interpretation(Interpretation::Ito)
///     .with_parameters(["a", "b"])
///     .build()?;
/// let mut family = Family::new(model, &[("b", 0.5)], Path::parameter("a", -1.0, 1.0))?;
/// family.questions.fixed_point = Some(vec![0.0]);
/// let plane = Plane::new(("a", -1.0, 1.0), ("b", 0.2, 0.8))?;
/// let curves = stability_curves(&family, &plane);
/// assert_eq!(curves.len(), 2);
/// for curve in curves {
///     let half = if curve.kind == StabilityKind::Exponent { 0.5 } else { 1.0 };
///     assert!(curve.points.iter().all(|one| (one.values[0] - half * one.values[1].powi(2)).abs() < 1e-14));
/// }
/// # Ok(())
/// # }
/// ```
pub fn stability_curves(family: &Family, plane: &Plane) -> Vec<StabilityCurve> {
    let Some(state) = family.questions.fixed_point.as_deref() else {
        return Vec::new();
    };
    let names = plane.sides().each_ref().map(|side| side.parameter.as_str());
    let linear = |at: [f64; 2]| {
        let values = plane.values(at);
        let moved = [(names[0], values[0]), (names[1], values[1])];
        family.linearised_with(&moved, state).ok()
    };
    let mut found = Vec::new();
    for kind in StabilityKind::ALL {
        let field = Field {
            plane,
            value: &|at| value(kind, &linear(at)?),
        };
        let lines = field.lines().into_iter().enumerate();
        let point = |(values, error)| StabilityPoint { values, error };
        found.extend(lines.map(|(number, points)| StabilityCurve {
            name: format!("{}{}", kind.letter(), number + 1),
            kind,
            points: points.into_iter().map(point).collect(),
        }));
    }
    found
}

/// The function whose zeros are wanted, with its error.
fn value(kind: StabilityKind, linear: &Linearised) -> Option<[f64; 2]> {
    match kind {
        StabilityKind::Exponent => {
            let exponent = largest(linear).ok()?;
            Some([exponent.value, exponent.error])
        }
        StabilityKind::Density => {
            let drift = linear.drift.iter().flatten().map(|a| a.abs());
            let noises = linear.noises.iter().flatten().flatten().map(|b| b * b);
            let squares: f64 = noises.sum();
            // Without noise about it the density is like any other's.
            let rounding = ROUNDING * (drift.sum::<f64>() + squares);
            (squares > 0.0).then(|| [linear.thinning(), rounding])
        }
    }
}
