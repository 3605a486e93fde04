//! Labelled points of a sweep: AUTO's habit of a type and an ordinal for everything worth a row.

use super::LevelCrossing;
use super::doubt::{BifurcationStatus, Doubt, status_of};
use super::spectral_change::SpectralChange;
use super::{ErrorParts, Point};
use crate::density::Observable;
use crate::numerics::sort_ascending;
use crate::system::Family;
use crate::topology::{IndicatorKind, Signature, Step};

/// A labelled point of a sweep, a row of `bifurcations.csv`.
#[derive(Debug, Clone, PartialEq)]
pub enum Label {
    /// An end of the sweep.
    End {
        /// `EP` and its ordinal.
        label: String,
        /// The parameter's value.
        value: f64,
    },
    /// Neighbouring points without a density, or without convergence.
    Failure {
        /// `MX` and its ordinal.
        label: String,
        /// Value of the first.
        lower: f64,
        /// Value of the last.
        upper: f64,
    },
    /// A P-bifurcation.
    Bifurcation(Box<Located>),
    /// A measure crosses a level that was asked for; where it is the Lyapunov exponent and the level zero, a
    /// D-bifurcation.
    Level(Box<LevelCrossing>),
}

/// What a row says beside its value, as tables have it.
#[derive(Debug, Clone, PartialEq)]
pub struct RowWords {
    /// The density or the measure that it is of.
    pub of: String,
    /// What is below the value.
    pub before: String,
    /// What is above the value.
    pub after: String,
    /// What happens there as the parameter rises.
    pub change: String,
    /// What it was located by.
    pub method: &'static str,
    /// How well it is known.
    pub status: BifurcationStatus,
}

/// A P-bifurcation of a sweep.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Located {
    /// `PB` and its ordinal.
    pub label: String,
    /// The parameter's value.
    pub value: f64,
    /// Half-width of the interval that is believed to hold the true value.
    pub error: f64,
    /// Lower end of the bracket or unresolved band.
    pub lower: f64,
    /// Upper end of the bracket or unresolved band.
    pub upper: f64,
    /// The observable whose signature changes.
    pub observable: Observable,
    /// Signature below the value.
    pub before: Signature,
    /// Signature above the value.
    pub after: Signature,
    /// The zero of an indicator that it is; `None` where persistence alone tells.
    pub zero: Option<Zero>,
    /// Whether it is several changes that cannot be told apart.
    pub is_several: bool,
    /// Why it may not be what it says; the first decides its status. None where it is located.
    pub doubts: Vec<Doubt>,
}

/// A zero of an indicator.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Zero {
    /// The indicator.
    pub indicator: IndicatorKind,
    /// Where it is, one coordinate an axis of the density.
    pub place: Vec<f64>,
    /// Change of the indicator per unit of the parameter.
    pub slope: f64,
    /// Parts of the error of the value.
    pub parts: ErrorParts,
    /// Whether three grids or more were asked, and distances between one and the next fell as order one has it, or
    /// faster. Not stored.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub is_settled: bool,
}

impl Label {
    /// Type and ordinal, for example `PB1`.
    pub fn name(&self) -> &str {
        match self {
            Self::End { label, .. } | Self::Failure { label, .. } => label,
            Self::Bifurcation(located) => &located.label,
            Self::Level(crossing) => &crossing.label,
        }
    }

    /// The words of a change; `None` for ends and failures.
    pub fn words(&self, family: &Family) -> Option<RowWords> {
        match self {
            Self::Bifurcation(one) => Some(RowWords {
                of: one.observable.name(family),
                before: one.before.to_string(),
                after: one.after.to_string(),
                change: one.change().to_owned(),
                method: one.method(),
                status: one.status(),
            }),
            Self::Level(one) if one.is_d_bifurcation() => Some(RowWords {
                of: one.asked.measure.clone(),
                before: if one.rises { "< 0" } else { "> 0" }.to_owned(),
                after: if one.rises { "> 0" } else { "< 0" }.to_owned(),
                change: match (family.questions.fixed_point.is_some(), one.rises) {
                    (true, true) => "D-bifurcation: the fixed point loses its stability",
                    (true, false) => "D-bifurcation: the fixed point becomes stable",
                    (false, true) => "D-bifurcation: paths under the same noise run apart",
                    (false, false) => "D-bifurcation: paths under the same noise come together",
                }
                .to_owned(),
                method: "exponent",
                status: one.status(),
            }),
            Self::Level(one) if one.spectral().is_some() => {
                let (change, of) = one.spectral()?;
                let [below, above] = change.sides();
                let (before, after) = if one.rises {
                    (below, above)
                } else {
                    (above, below)
                };
                let of_modes = change == SpectralChange::Pair;
                Some(RowWords {
                    of: if of_modes {
                        "slow modes".to_owned()
                    } else {
                        format!("spectrum of {of}")
                    },
                    before: before.to_owned(),
                    after: after.to_owned(),
                    change: change.words(one.rises).to_owned(),
                    method: if of_modes { "relaxation" } else { "spectrum" },
                    status: one.status(),
                })
            }
            Self::Level(one) => {
                let level = one.asked.level;
                let [below, above] = [format!("< {level}"), format!("> {level}")];
                let (before, after) = if one.rises {
                    (below, above)
                } else {
                    (above, below)
                };
                let way = if one.rises { "rises" } else { "falls" };
                Some(RowWords {
                    of: one.asked.measure.clone(),
                    before,
                    after,
                    change: format!("{way} through {level}"),
                    method: "level",
                    status: one.status(),
                })
            }
            Self::End { .. } | Self::Failure { .. } => None,
        }
    }

    /// Why it is not located; `None` where it is.
    pub fn reason(&self) -> Option<&Doubt> {
        match self {
            Self::Bifurcation(one) => one.reason(),
            Self::Level(one) => one.doubts.first(),
            Self::End { .. } | Self::Failure { .. } => None,
        }
    }

    /// How well a change is known; `None` for ends and failures.
    pub fn status(&self) -> Option<BifurcationStatus> {
        match self {
            Self::Bifurcation(one) => Some(one.status()),
            Self::Level(one) => Some(one.status()),
            Self::End { .. } | Self::Failure { .. } => None,
        }
    }

    /// The parameter's value; of a failure the middle.
    pub fn value(&self) -> f64 {
        match self {
            Self::Bifurcation(located) => located.value,
            Self::Level(crossing) => crossing.value,
            _ => {
                let (lower, upper) = self.bracket();
                0.5 * (lower + upper)
            }
        }
    }

    /// Half-width of the interval that is believed to hold the true value; zero for end points.
    pub fn error(&self) -> f64 {
        match self {
            Self::Bifurcation(located) => located.error,
            Self::Level(crossing) => crossing.error,
            _ => {
                let (lower, upper) = self.bracket();
                0.5 * (upper - lower)
            }
        }
    }

    /// Ends of the bracket, of an unresolved band, or of what failed.
    pub fn bracket(&self) -> (f64, f64) {
        match self {
            Self::End { value, .. } => (*value, *value),
            Self::Failure { lower, upper, .. } => (*lower, *upper),
            Self::Bifurcation(located) => (located.lower, located.upper),
            Self::Level(crossing) => (crossing.lower, crossing.upper),
        }
    }

    /// The P-bifurcation, if it is one.
    pub fn bifurcation(&self) -> Option<&Located> {
        match self {
            Self::Bifurcation(located) => Some(located),
            _ => None,
        }
    }

    /// The D-bifurcation, if it is one.
    pub(crate) fn d_bifurcation(&self) -> Option<&LevelCrossing> {
        match self {
            Self::Level(crossing) if crossing.is_d_bifurcation() => Some(crossing),
            _ => None,
        }
    }

    /// The change of a power spectrum or of the slowest modes, if it is one.
    pub fn spectral_change(&self) -> Option<&LevelCrossing> {
        match self {
            Self::Level(crossing) => Some(&**crossing).filter(|one| one.spectral().is_some()),
            _ => None,
        }
    }

    /// Whether it is an end of the sweep.
    pub(crate) fn is_end(&self) -> bool {
        matches!(self, Self::End { .. })
    }
}

impl Located {
    /// How well it is known.
    pub fn status(&self) -> BifurcationStatus {
        status_of(&self.doubts)
    }

    /// Why it is not located; `None` where it is.
    pub fn reason(&self) -> Option<&Doubt> {
        self.doubts.first()
    }

    /// Where it may lie: its interval with its bracket.
    pub(super) fn hull(&self) -> [f64; 2] {
        [
            self.lower.min(self.value - self.error),
            self.upper.max(self.value + self.error),
        ]
    }

    /// The indicator whose zero it is.
    pub fn indicator(&self) -> Option<IndicatorKind> {
        self.zero.as_ref().map(|zero| zero.indicator)
    }

    /// What it was located by: the name of an indicator, or `persistence`.
    pub fn method(&self) -> &'static str {
        let indicator = self.indicator();
        indicator.map_or("persistence", |kind| kind.name())
    }

    /// What happens there as the parameter rises, in words.
    pub fn change(&self) -> &'static str {
        let step = Step {
            // Several changes go the way in which they follow each other.
            rises: self.is_several || self.zero.as_ref().is_some_and(|zero| zero.slope > 0.0),
            before: self.before,
            after: self.after,
        };
        step.words(self.indicator(), self.is_several)
    }
}

/// The end points of a sweep, unnumbered.
pub(super) fn end_points(points: &[Point]) -> impl Iterator<Item = Label> {
    let ends = [points.first(), points.last()].into_iter().flatten();
    ends.map(|point| Label::End {
        label: String::new(),
        value: point.value,
    })
}

/// One row for every run of neighbouring points without a density or without convergence, unnumbered.
pub(super) fn failures(points: &[Point]) -> impl Iterator<Item = Label> {
    let alike =
        |a: &Point, b: &Point| a.report.status.is_resolved() == b.report.status.is_resolved();
    let runs = points.chunk_by(alike);
    let failed = runs.filter(|run| !run[0].report.status.is_resolved());
    failed.map(|run| Label::Failure {
        label: String::new(),
        lower: run[0].value,
        upper: run[run.len() - 1].value,
    })
}

/// Sorts rows by parameter and numbers each type from 1.
pub(super) fn number(mut labels: Vec<Label>) -> Vec<Label> {
    sort_ascending(&mut labels, |one| one.value());
    let mut counts = [0; 6];
    for row in &mut labels {
        let (label, prefix, count) = match row {
            Label::Bifurcation(located) => (&mut located.label, "PB", &mut counts[0]),
            Label::Level(crossing) if crossing.is_d_bifurcation() => {
                (&mut crossing.label, "DB", &mut counts[4])
            }
            Label::Level(crossing) if crossing.spectral().is_some() => {
                (&mut crossing.label, "SB", &mut counts[5])
            }
            Label::Level(crossing) => (&mut crossing.label, "LV", &mut counts[3]),
            Label::End { label, .. } => (label, "EP", &mut counts[1]),
            Label::Failure { label, .. } => (label, "MX", &mut counts[2]),
        };
        *count += 1;
        *label = format!("{prefix}{count}");
    }
    labels
}
