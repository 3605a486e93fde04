//! How one axis is cut into cells, or carried by modes.

use super::modes_of::ModesOf;
use crate::density::BINS_OF_A_TURN;
use crate::method::FEWEST_PHASES;
use crate::space::{Axis, Grading, SpaceError};
use crate::sweep_file::draft::{MethodKind, Modes};

/// How one axis is cut into cells, or carried by modes.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSettings {
    /// Lower and upper end; `None` where one is left to the program.
    pub ends: [Option<f64>; 2],
    /// Number of cells, at least 2; `None` where it is left to the program, and for an axis of modes alone.
    pub count: Option<usize>,
    /// Where the cells get narrower.
    pub grade: Grade,
    /// What modes of the axis are made of.
    pub series: ModesOf,
    /// Number of modes that carry it in place of cells, by methods that can (`MethodKind::takes_modes`).
    pub modes: Option<Modes>,
}

/// Where the cells of an axis get narrower.
#[derive(Debug, Clone, PartialEq)]
pub enum Grade {
    /// Nowhere: they have equal widths.
    Even,
    /// Toward the model's switching surfaces, to a width that is left to the program.
    Auto,
    /// Toward some points.
    Toward(Grading),
}

impl AxisSettings {
    /// Lower and upper end; `None` where one of them is left to the program.
    pub fn range(&self) -> Option<(f64, f64)> {
        self.ends[0].zip(self.ends[1])
    }

    /// The number of modes that a method uses; `None` where it uses cells.
    pub fn modes_by(&self, method: MethodKind) -> Option<Modes> {
        self.modes.filter(|_| method.takes_modes())
    }

    /// Whether it is cut into cells whose number can be given: all over a turn that is counted by trajectories are
    /// even.
    pub(crate) fn is_cut(&self, method: MethodKind) -> bool {
        self.modes_by(method).is_none() && self.series != ModesOf::Turn
    }

    /// The axis as a method uses it; `None` where something is left to the program.
    pub(super) fn axis(&self, method: MethodKind) -> Option<Result<Axis, SpaceError>> {
        let (from, to) = self.range()?;
        match self.modes_by(method) {
            Some(Modes::Auto) => return None,
            Some(Modes::Number(count)) => return Some(self.series.axis((from, to), count)),
            None if self.series == ModesOf::Turn => {
                // The phase of a forcing runs from 0 to 1, an angle has its zero in the middle.
                let count = match method {
                    MethodKind::Sgcm if from == 0.0 => FEWEST_PHASES,
                    _ => BINS_OF_A_TURN,
                };
                return Some(Axis::turn(from, to, count));
            }
            None => {}
        }
        let count = self.count?;
        match &self.grade {
            Grade::Even => Some(Axis::uniform(from, to, count)),
            Grade::Toward(grading) => Some(Axis::graded(from, to, count, grading)),
            Grade::Auto => None,
        }
    }
}
