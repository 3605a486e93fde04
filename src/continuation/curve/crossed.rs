//! A sweep over one parameter that lies in a plane of two: its rows as points of the plane, and how far they are from
//! the curves there.

use super::found::Curve;
use super::piece::Piece;
use super::plane::Plane;
use crate::continuation::{BifurcationStatus, Located, SweepResult};
use crate::density::Observable;
use crate::system::Family;
use crate::topology::IndicatorKind;

/// Relative difference up to which two values of a parameter are the same: rounding.
const SAME_VALUE: f64 = 1e-9;

/// A sweep over one of a plane's parameters that holds the other: a straight line in the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepInPlane {
    /// The side of the box that it goes along, 0 or 1.
    pub side: usize,
    /// Its value of the other side's parameter.
    pub held: f64,
    /// The part of its range that is in the box, in ascending order.
    pub range: (f64, f64),
    /// Its P-bifurcations that are in the box, in ascending order of the swept parameter.
    pub rows: Vec<RowInPlane>,
}

/// A row of a sweep as a point of a plane.
#[derive(Debug, Clone, PartialEq)]
pub struct RowInPlane {
    /// Its label, for example `PB1`.
    pub label: String,
    /// Values of both parameters.
    pub values: [f64; 2],
    /// Its error, along the swept parameter and in its unit.
    pub error: f64,
    /// The density that changes, as the plane numbers it; `None` where the plane knows no such state or quantity.
    pub observable: Option<Observable>,
    /// The indicator whose zero it is.
    pub indicator: Option<IndicatorKind>,
    /// How well it is known.
    pub status: BifurcationStatus,
}

/// How far a row is from a curve, in sides of the box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GapToCurve {
    /// The curve, by its place in the list.
    pub curve: usize,
    /// Distance across the curve.
    pub gap: f64,
    /// The errors of both across the curve, added.
    pub error: f64,
}

/// Why a sweep does not lie in a plane.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotInPlane {
    /// It is of other equations.
    #[error("it is of the model `{sweep}`, and the plane is of `{plane}`")]
    OtherModel {
        /// The model of the sweep.
        sweep: String,
        /// The model of the plane.
        plane: String,
    },
    /// Both models have one name, and other equations.
    #[error("its equations are not those of the plane")]
    OtherEquations,
    /// It moves a parameter that is none of the plane's, or several.
    #[error("it sweeps {swept}, and the plane is of {} and {}", sides[0], sides[1])]
    OtherParameter {
        /// What it sweeps.
        swept: String,
        /// The parameters of the plane.
        sides: [String; 2],
    },
    /// It holds another parameter at another value.
    #[error("it has {parameter} = {sweep}, and the plane has {parameter} = {plane}")]
    OtherValue {
        /// The parameter.
        parameter: String,
        /// Its value in the sweep.
        sweep: f64,
        /// Its value in the plane.
        plane: f64,
    },
    /// It holds the other side's parameter at a value that is not in the box.
    #[error("it holds {parameter} = {value}, and the box goes from {} to {}", side.0, side.1)]
    Outside {
        /// The parameter.
        parameter: String,
        /// Its value in the sweep.
        value: f64,
        /// Ends of the box.
        side: (f64, f64),
    },
    /// It goes past the box.
    #[error("its {parameter} goes from {} to {}, and the box from {} to {}", sweep.0, sweep.1, side.0, side.1)]
    Beside {
        /// The parameter.
        parameter: String,
        /// Lowest and highest value in the sweep.
        sweep: (f64, f64),
        /// Those of the box.
        side: (f64, f64),
    },
}

impl SweepInPlane {
    /// A sweep as a line of a plane; `family` is any of the plane's model that holds what the plane holds.
    ///
    /// # Errors
    /// [`NotInPlane`].
    pub fn new(plane: &Plane, family: &Family, sweep: &SweepResult) -> Result<Self, NotInPlane> {
        let swept = &sweep.subject.family;
        check_model(family, swept)?;
        let sides = plane.sides();
        let moved = swept.path().moved();
        let mut numbered = sides.iter().enumerate();
        let along = numbered.find(|(_, side)| moved == [side.parameter.as_str()]);
        let Some((side, _)) = along else {
            return Err(NotInPlane::OtherParameter {
                swept: moved.join(", "),
                sides: sides.each_ref().map(|side| side.parameter.clone()),
            });
        };
        let held = held_value(plane, 1 - side, family, swept)?;
        let (own, along, across) = (swept.range(), &sides[side], &sides[1 - side]);
        if !(across.from..=across.to).contains(&held) {
            return Err(NotInPlane::Outside {
                parameter: across.parameter.clone(),
                value: held,
                side: (across.from, across.to),
            });
        }
        let range = (own.0.max(along.from), own.1.min(along.to));
        if range.0 > range.1 {
            return Err(NotInPlane::Beside {
                parameter: along.parameter.clone(),
                sweep: own,
                side: (along.from, along.to),
            });
        }
        let line = Self {
            side,
            held,
            range,
            rows: Vec::new(),
        };
        let rows = sweep.bifurcations();
        let rows = rows.filter(|row| (range.0..=range.1).contains(&row.value));
        let rows = rows.map(|row| line.row(row, family, swept)).collect();
        Ok(Self { rows, ..line })
    }

    fn row(&self, row: &Located, family: &Family, swept: &Family) -> RowInPlane {
        let mut values = [self.held; 2];
        values[self.side] = row.value;
        RowInPlane {
            label: row.label.clone(),
            values,
            error: row.error,
            observable: observable_in_plane(row.observable, family, swept),
            indicator: row.indicator(),
            status: row.status(),
        }
    }

    /// Distance of a row of this sweep from the nearest curve of its density and its indicator that crosses the sweep;
    /// `None` where none does.
    pub(crate) fn gap(&self, row: &RowInPlane, curves: &[Curve]) -> Option<GapToCurve> {
        let of_row = |curve: &Curve| {
            Some(curve.observable) == row.observable && Some(curve.kind) == row.indicator
        };
        let gaps = curves.iter().enumerate().filter(|(_, curve)| of_row(curve));
        let gaps = gaps.flat_map(|(number, curve)| {
            let at = curve.plane.place(row.values);
            let error = row.error / curve.plane.sides()[self.side].length();
            Piece::all_of(curve).filter_map(move |piece| {
                let (meets, along) = piece.crosses(1 - self.side, at[1 - self.side])?;
                let sine = along[1 - self.side].abs();
                Some(GapToCurve {
                    curve: number,
                    gap: sine * (meets[self.side] - at[self.side]).abs(),
                    error: piece.error + sine * error,
                })
            })
        });
        gaps.min_by(|one, other| one.gap.total_cmp(&other.gap))
    }
}

fn check_model(family: &Family, swept: &Family) -> Result<(), NotInPlane> {
    let (plane, sweep) = (family.model(), swept.model());
    match plane.is_stated_like(sweep) {
        true => Ok(()),
        false if plane.name == sweep.name => Err(NotInPlane::OtherEquations),
        false => Err(NotInPlane::OtherModel {
            sweep: sweep.name.clone(),
            plane: plane.name.clone(),
        }),
    }
}

/// The value at which a sweep holds the parameter of a side of the plane; refuses one that holds others at other values
/// than the plane.
fn held_value(
    plane: &Plane,
    side: usize,
    family: &Family,
    swept: &Family,
) -> Result<f64, NotInPlane> {
    let sides = plane.sides();
    let mut held = None;
    for (parameter, value) in swept.fixed() {
        if parameter == sides[side].parameter {
            held = Some(value);
            continue;
        }
        let mut known = family.fixed();
        let Some((_, known)) = known.find(|(name, _)| *name == parameter) else {
            continue;
        };
        if (value - known).abs() > SAME_VALUE * value.abs().max(known.abs()) {
            return Err(NotInPlane::OtherValue {
                parameter: parameter.to_owned(),
                sweep: value,
                plane: known,
            });
        }
    }
    held.ok_or_else(|| NotInPlane::OtherParameter {
        swept: swept.path().moved().join(", "),
        sides: sides.each_ref().map(|side| side.parameter.clone()),
    })
}

/// An observable of a sweep as the plane numbers it: quantities by their names and formulas.
fn observable_in_plane(
    observable: Observable,
    family: &Family,
    swept: &Family,
) -> Option<Observable> {
    let number = |axis: usize| match swept.quantity(axis) {
        None => Some(axis),
        Some(own) => {
            let states = family.model().axes.len();
            let same = |known: &&std::sync::Arc<crate::system::Quantity>| {
                known.name() == own.name() && known.formula() == own.formula()
            };
            let place = family.quantities().iter().position(|one| same(&one))?;
            Some(states + place)
        }
    };
    Some(match observable {
        Observable::Marginal(axis) => Observable::Marginal(number(axis)?),
        Observable::Joint(first, second) => Observable::Joint(number(first)?, number(second)?),
    })
}
