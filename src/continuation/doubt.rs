//! Doubts: why a located value may not be what it says. The status of a row, and of a point of a curve, follows from
//! its first doubt, and so does the reason that is given for it.

use super::finding::MOST_NEGATIVE;
use super::measure::{DEVIATION, EDGE_MASS, MEAN};
use super::{CellCheck, ErrorParts, Finding, Point, PointStatus, Subject};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::space::Axis;

/// How well a P-bifurcation is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BifurcationStatus {
    /// Its bracket and its error are within the tolerance, and finer cells, where there are any, show it too.
    Located,
    /// The data cannot tell where in the bracket it lies.
    Unresolved,
    /// A finer grid does not show it there, or there is none to check a cell map that adds diffusion of its own, or,
    /// where only persistence tells, its feature is nowhere more than a few cells from another: it may be an effect of
    /// the cells.
    Unconfirmed,
    /// Finer cells were not asked ([`LocateOptions::grid_check`](super::LocateOptions::grid_check) is off), so that its
    /// error lacks what the cells do to it; or a check failed: its [`Doubt`] says which. The value may be right.
    Unchecked,
}

words! {
    BifurcationStatus, pub word:
    Located: "located", Unresolved: "unresolved", Unconfirmed: "unconfirmed", Unchecked: "unchecked",
}

/// What a located value is checked by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum CheckedBy {
    /// The same source on cells that were refined so many times, one to three.
    FinerCells(u8),
    /// The same source between ends of Ω that let nothing out.
    ClosedEnds,
}

/// How often cells are refined at most to locate a value.
pub(super) const MOST_TIMES: u8 = 3;

impl CheckedBy {
    /// All of them.
    pub(crate) const ALL: [Self; MOST_TIMES as usize + 1] = [
        Self::FinerCells(1),
        Self::FinerCells(2),
        Self::FinerCells(MOST_TIMES),
        Self::ClosedEnds,
    ];

    /// The words used in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::FinerCells(..=1) => "finer cells",
            Self::FinerCells(2) => "finer cells, twice refined",
            Self::FinerCells(_) => "finer cells, three times refined",
            Self::ClosedEnds => "closed ends",
        }
    }
}

/// A reason why a located value may not be what it says.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Doubt {
    /// Finer cells show no such change near.
    NotOnFinerCells,
    /// The check could not be made, for this reason.
    CheckFailed(CheckedBy, String),
    /// Between closed ends of Ω there is no such indicator.
    NotBetweenClosedEnds,
    /// The densities on either side are solved in different ways: from there on the drift at an end of Ω points
    /// outward.
    OutwardDrift,
    /// The indicator jumps to the other side of zero.
    Jump,
    /// A density that it is read from is not that of a steady state, or has not converged; and what would hold the mass
    /// that leaves.
    Unsound(PointStatus, Option<WiderRange>),
    /// This share of the density is negative.
    NegativeDensity(f64),
    /// Too few modes carry the densities: more of them change them by so much.
    FewModes(f64),
    /// The drift jumps along an axis at a place inside cells: the shape of the density follows where in its cell.
    JumpInsideCells(usize, f64),
    /// Noise along an axis dies at an end. The fields: the axis, the end, and the share of the mass in cells beside it.
    NaturalEnd(usize, f64, f64),
    /// What leaves Ω moves the value by so much, more than the tolerance; and what would hold it.
    Leak(f64, WiderRange),
    /// Samples leave the value uncertain by so much, more than the tolerance.
    FewSamples(f64),
    /// Fits of other degrees to sampled densities move the value by so much, more than the tolerance.
    UnevenFits(f64),
    /// Finer cells move the value by so much, more than the tolerance; and how many an axis would do, where that can be
    /// guessed.
    CoarseCells(f64, Option<f64>),
    /// Errors of the solver, and of the straight line across the bracket, come to so much, more than the tolerance.
    SolverError(f64),
    /// The end of a curve follows from the points before it, which leave it uncertain by so much, in sides of the box.
    Extrapolated(f64),
    /// The bracket, of this width, was not narrowed to the tolerance.
    WideBracket(f64),
    /// The cells add diffusion of their own, and no finer cells tell how far that moves the value.
    NumericalDiffusion,
    /// Located values were not to be checked.
    GridCheckOff,
    /// Finer cells could have been asked, and were not: the sweep ended before, or holds no checks.
    CheckMissing,
    /// It is read beside a fixed point that noise leaves alone, where the density goes like a power of the distance;
    /// and where in the sweep that power passes zero, if it is a density of all axes.
    AtRest(Option<f64>),
    /// The indicator is lost between two values: more cells may show more of it.
    IndicatorLost,
    /// The density where the feature vanishes is lower than what the solver leaves: it may be there up to the end of
    /// the sweep.
    TooLow,
    /// The feature is there up to the end of the sweep, though too low to be counted.
    BornBeyond,
    /// No indicator tells of the change.
    NoIndicator,
    /// No indicator tells of the change, and its feature is nowhere more than a few cells from another.
    FewCellsApart,
    /// What is there at both ends cannot be told between them.
    Flicker,
    /// The stages between two signatures cannot be told apart.
    Stages,
    /// What is counted on one side of it is not what is counted beside the next change.
    DoesNotContinue,
    /// Beside the point there is no curve.
    NoCurve,
    /// What a stored curve says of a point whose doubts are not stored.
    Stored(BifurcationStatus),
}

impl Doubt {
    /// The status of what is in this doubt first.
    pub fn status(&self) -> BifurcationStatus {
        match self {
            Self::NotOnFinerCells
            | Self::NumericalDiffusion
            | Self::FewCellsApart
            | Self::NoCurve => BifurcationStatus::Unconfirmed,
            Self::CheckFailed(..)
            | Self::NotBetweenClosedEnds
            | Self::GridCheckOff
            | Self::CheckMissing => BifurcationStatus::Unchecked,
            Self::Stored(status) => *status,
            _ => BifurcationStatus::Unresolved,
        }
    }

    /// Whether finer cells may remove it: not where samples, modes, what leaves the range, or the equations themselves
    /// leave it, nor where no check was wanted.
    pub(super) fn is_of_cells(&self) -> bool {
        match self {
            Self::NotOnFinerCells
            | Self::Jump
            | Self::NegativeDensity(_)
            | Self::CoarseCells(..)
            | Self::SolverError(_)
            | Self::WideBracket(_)
            | Self::IndicatorLost
            | Self::TooLow
            | Self::BornBeyond
            | Self::NoIndicator
            | Self::FewCellsApart
            | Self::Flicker
            | Self::Stages
            | Self::DoesNotContinue => true,
            Self::CheckFailed(..)
            | Self::NotBetweenClosedEnds
            | Self::OutwardDrift
            | Self::Unsound(..)
            | Self::FewModes(_)
            | Self::JumpInsideCells(..)
            | Self::NaturalEnd(..)
            | Self::Leak(..)
            | Self::FewSamples(_)
            | Self::UnevenFits(_)
            | Self::Extrapolated(_)
            | Self::NumericalDiffusion
            | Self::GridCheckOff
            | Self::CheckMissing
            | Self::AtRest(_)
            | Self::NoCurve
            | Self::Stored(_) => false,
        }
    }

    /// What a finding says against the shape of a density wherever it is read.
    pub(super) fn of_finding(finding: &Finding) -> Option<Self> {
        match *finding {
            Finding::FewModes { change } => Some(Self::FewModes(change)),
            Finding::JumpInsideCells { axis, at } => Some(Self::JumpInsideCells(axis, at)),
            Finding::NaturalEnd { axis, mass, at } => Some(Self::NaturalEnd(axis, at, mass)),
            _ => None,
        }
    }

    /// What the end of a solve says against its density.
    pub(super) fn of_status(status: PointStatus, wider: Option<WiderRange>) -> Option<Self> {
        let wider = wider.filter(|_| status == PointStatus::Escaping);
        (status != PointStatus::Solved).then_some(Self::Unsound(status, wider))
    }

    /// What the negative part of a density says against it.
    pub(super) fn of_negative(density: &Density) -> Option<Self> {
        let masses = density.masses();
        let negative: f64 = masses.iter().map(|mass| (-mass).max(0.0)).sum();
        let share = negative / masses.iter().sum::<f64>().abs().max(f64::MIN_POSITIVE);
        (share > MOST_NEGATIVE).then_some(Self::NegativeDensity(share))
    }
}

/// The status that follows from doubts.
pub(super) fn status_of(doubts: &[Doubt]) -> BifurcationStatus {
    let first = doubts.first();
    first.map_or(BifurcationStatus::Located, Doubt::status)
}

/// An axis along which mass leaves, and the range that would hold it, if its moments are known.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WiderRange {
    /// Name of the axis.
    pub axis: String,
    /// The range.
    pub range: Option<[f64; 2]>,
}

impl WiderRange {
    /// The axis along which most of the mass leaves.
    pub(super) fn of(point: &Point, subject: &Subject) -> Option<Self> {
        let report = &point.report;
        report.edge_mass()?;
        let names = || subject.family.model().axes.iter().map(|axis| &axis.name);
        // A table that is read back does not tell of which axis; the marginal of the axis does where it is watched.
        let mass = |(axis, name): (usize, &String)| {
            let told = report.of(&EDGE_MASS, name);
            told.or_else(|| mass_at_ends(point, axis))
        };
        let masses = names().enumerate();
        let masses = masses.filter_map(|(axis, name)| Some((name, mass((axis, name))?)));
        let largest = masses.max_by(|a, b| a.1.total_cmp(&b.1));
        let name = largest.map(|one| one.0).or_else(|| names().next())?;
        let moments = report.of(&MEAN, name).zip(report.of(&DEVIATION, name));
        let range = moments.map(|(mean, deviation)| {
            let reach = TAILS * deviation;
            [mean - reach, mean + reach]
        });
        Some(Self {
            axis: name.clone(),
            range,
        })
    }
}

/// The mass of the outermost cells of an axis whose marginal is watched.
fn mass_at_ends(point: &Point, axis: usize) -> Option<f64> {
    let is_its = |one: &&EstimatedDensity| one.observable == Observable::Marginal(axis);
    let masses = point.densities.iter().find(is_its)?.density.masses();
    let [first, .., last] = masses[..] else {
        return None;
    };
    Some(first + last)
}

/// What is known of a zero besides where it is.
pub(super) struct Evidence<'a> {
    /// What checks say against it.
    pub(super) check: Option<Doubt>,
    /// What speaks against the densities that it is read from, the gravest first.
    pub(super) densities: Vec<Doubt>,
    /// Why no finer cells tell where it is; `None` where they do, or where no cells take part.
    pub(super) unchecked: Option<Doubt>,
    pub(super) cell_check: CellCheck,
    /// How often the cells were refined that it comes from.
    pub(super) refined: u8,
    /// Whether the cells add diffusion of their own.
    pub(super) is_diffused: bool,
    pub(super) parts: ErrorParts,
    /// Width of its bracket.
    pub(super) width: f64,
    pub(super) tolerance: f64,
    pub(super) density: &'a Density,
    pub(super) is_noisy: bool,
    pub(super) wider: Option<WiderRange>,
}

impl Evidence<'_> {
    /// The doubts that follow, the first of which decides.
    pub(super) fn doubts(self) -> Vec<Doubt> {
        let imprecise = (self.parts.total() > self.tolerance).then(|| self.imprecision());
        let is_wide = self.width > self.tolerance * (1.0 + 1e-9);
        let is_checkable = matches!(self.cell_check, CellCheck::OnFinerCells { .. });
        let is_diffused = self.is_diffused && self.unchecked.is_some();
        let mut doubts: Vec<Doubt> = self.check.into_iter().chain(self.densities).collect();
        doubts.extend(imprecise);
        doubts.extend(is_wide.then_some(Doubt::WideBracket(self.width)));
        doubts.extend(is_diffused.then_some(Doubt::NumericalDiffusion));
        doubts.extend(self.unchecked.filter(|_| is_checkable));
        doubts
    }

    /// The largest part of an error that exceeds the tolerance.
    fn imprecision(&self) -> Doubt {
        let ErrorParts {
            solver,
            grid,
            sampling,
            leak,
        } = self.parts;
        match &self.wider {
            Some(wider) if leak >= 0.5 * self.parts.total() => Doubt::Leak(leak, wider.clone()),
            _ if sampling >= grid.max(solver) => Doubt::FewSamples(sampling),
            _ if grid < solver => Doubt::SolverError(solver),
            _ if self.is_noisy => Doubt::UnevenFits(grid),
            _ => Doubt::CoarseCells(grid, self.wanted_cells()),
        }
    }

    /// How many cells bring the error to half of what is wanted, at the order of two by which it falls at least.
    fn wanted_cells(&self) -> Option<f64> {
        let times = (2.0 * self.parts.grid / self.tolerance).sqrt();
        let axes = self.density.axes.iter();
        let cells = axes.map(Axis::count).max().unwrap_or(0) as f64;
        let is_near = times > 1.0 && times <= FARTHEST_GUESS;
        // The error is the distance to cells that were refined once less.
        let finer = match self.cell_check {
            CellCheck::OnFinerCells { ratio, .. } => ratio.powi(i32::from(self.refined.max(1)) - 1),
            CellCheck::Impossible | CellCheck::Needless => 1.0,
        };
        is_near.then(|| (0.1 * cells * finer * times).ceil() * 10.0)
    }
}

/// Times as many cells beyond which their number is not told: the order at which errors fall is not known that far.
const FARTHEST_GUESS: f64 = 4.0;

/// Standard deviations from the mean that hold all but what does not matter of a density whose tails fall as the normal
/// one's.
const TAILS: f64 = 7.5;

#[cfg(test)]
mod tests;
