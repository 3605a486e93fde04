//! Where a number of the solved values, such as a mean time of first passage, crosses a level that is asked for.
//!
//! The number is a smooth function of the parameter with a known error at every value, so its crossing is the root of
//! the polynomial through the values around: of its logarithm where it is positive, because rates and times change by
//! orders of magnitude. The error of the root is what one value less changes, and the number's own error over its
//! slope.

mod rise;

use super::doubt::{BifurcationStatus, Doubt, status_of};
use super::measure::{DECAY_DISCRIMINANT, EXPONENT, Measure, SPECTRAL_RISE};
use super::spectral_change::SpectralChange;
use super::{CellCheck, Point, SolveReport, Subject};
use crate::numerics::bisected;
use crate::system::{ExponentMethod, Family, MeasureLevel};
use crate::topology::two_sided_limit;

/// Values through which the polynomial goes, half of them on either side.
const NODES: usize = 4;

/// Share of the wanted width that interpolation may leave.
const INTERPOLATED: f64 = 0.1;

/// Degrees of freedom of standard errors of numbers that are sampled, which come from 32 blocks.
const FREEDOM: f64 = 31.0;

/// Halvings of a bracket in which a polynomial's root is found.
const HALVINGS: usize = 80;

/// A crossing of a level.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelCrossing {
    /// `LV` and its ordinal, `DB` for a D-bifurcation, `SB` for a change of a power spectrum.
    pub label: String,
    /// The measure and its level.
    pub asked: MeasureLevel,
    /// The parameter's value.
    pub value: f64,
    /// Half-width of the interval that is believed to hold the true value.
    pub error: f64,
    /// Solved values beside it.
    pub lower: f64,
    /// Solved values beside it.
    pub upper: f64,
    /// Whether the measure rises through the level as the parameter does.
    pub rises: bool,
    /// Why it may not be what it says; the first decides its status.
    pub doubts: Vec<Doubt>,
}

impl LevelCrossing {
    /// How well it is known.
    pub fn status(&self) -> BifurcationStatus {
        status_of(&self.doubts)
    }

    /// What changes in which spectrum, where it is a number of one that passes zero; no name is that of relaxation.
    pub(crate) fn spectral(&self) -> Option<(SpectralChange, &str)> {
        if self.asked.level != 0.0 {
            return None;
        }
        SpectralChange::ALL.into_iter().find_map(|change| {
            let rest = self.asked.measure.strip_prefix(change.measure().word)?;
            match change {
                SpectralChange::Pair => rest.is_empty().then_some((change, "")),
                _ => Some((change, rest.strip_prefix('_')?)),
            }
        })
    }

    /// Whether it is the largest Lyapunov exponent that passes zero.
    pub(crate) fn is_d_bifurcation(&self) -> bool {
        self.asked.measure == EXPONENT.word && self.asked.level == 0.0
    }
}

/// A measure less its level at one value of the parameter, with its error.
#[derive(Clone, Copy)]
struct Excess {
    at: f64,
    over: f64,
    error: f64,
    is_judged: bool,
    /// Whether the solved value before it has the measure, too.
    follows: bool,
}

/// The root of a polynomial through samples.
struct Root {
    /// The samples beside it.
    ends: [Excess; 2],
    value: f64,
    /// What one sample less changes.
    interpolation: f64,
    /// The error of the measure over its slope.
    of_measure: f64,
    /// Whether the measure does not go to zero from either side, as where another mode becomes the slowest, so far as
    /// samples tell.
    is_jump: bool,
    /// The sample that is the only one on its side, where the other side alone does not tell that it is no jump.
    alone: Option<f64>,
}

impl Root {
    fn error(&self) -> f64 {
        self.interpolation + self.of_measure
    }

    /// Whether it lies about another one.
    fn holds(&self, other: &Self) -> bool {
        self.ends[0].at <= other.ends[0].at && other.ends[1].at <= self.ends[1].at
    }
}

/// The levels of which the crossings are wanted: those that are asked for, and zero for the exponent along the density
/// and for the numbers that say how a spectrum, or the kind of the slowest deviations, changes.
pub(crate) fn asked_of(family: &Family) -> Vec<MeasureLevel> {
    let question = family.questions.spectrum.iter();
    let powers = question.flat_map(|question| {
        let pairs = question.pairs.iter().filter(|(one, other)| one == other);
        let names = pairs.map(|&pair| question.name(pair));
        names.flat_map(|of| {
            SpectralChange::OF_POWER.map(|change| MeasureLevel {
                measure: change.measure().name(&of),
                level: 0.0,
            })
        })
    });
    let exponent = family.questions.largest_exponent.map(|_| MeasureLevel {
        measure: EXPONENT.word.to_owned(),
        level: 0.0,
    });
    let pair = (family.questions.slow_modes >= 2).then(|| MeasureLevel {
        measure: DECAY_DISCRIMINANT.word.to_owned(),
        level: 0.0,
    });
    let mut all = family.questions.levels.to_vec();
    let new: Vec<MeasureLevel> = (exponent.into_iter())
        .chain(pair)
        .chain(powers)
        .filter(|one| !all.contains(one))
        .collect();
    all.extend(new);
    all
}

/// Whether neighbouring values of a number differ by samples of their own; its errors are then standard errors.
pub(super) fn is_sampled(subject: &Subject, asked: &MeasureLevel) -> bool {
    let by_paths = subject.family.questions.largest_exponent == Some(ExponentMethod::Trajectories);
    let is_of_cells = matches!(subject.cell_check, CellCheck::OnFinerCells { .. });
    !is_of_cells || (by_paths && asked.measure == EXPONENT.word)
}

/// How many of the errors of a number are believed to hold the true one: one, or those of a two-sided limit where it is
/// sampled.
pub(super) fn limit_of(subject: &Subject, asked: &MeasureLevel, confidence: f64) -> f64 {
    match is_sampled(subject, asked) {
        true => two_sided_limit(1.0 - confidence, FREEDOM),
        false => 1.0,
    }
}

/// All crossings of the levels that are asked for, unnumbered.
pub(super) fn crossings(
    points: &[Point],
    (subject, confidence): (&Subject, f64),
    tolerance: f64,
) -> Vec<LevelCrossing> {
    let of_level = |asked: &MeasureLevel| {
        let mut found: Vec<LevelCrossing> = Vec::new();
        let limit = limit_of(subject, asked, confidence);
        for root in roots_of(points, asked, limit) {
            let row = row((asked, is_sampled(subject, asked)), &root, tolerance);
            match found.last_mut() {
                Some(last) if row.value - last.value <= last.error + row.error => merge(last, &row),
                _ => found.push(row),
            }
        }
        found
    };
    let all = asked_of(&subject.family);
    all.iter().flat_map(of_level).collect()
}

/// The value to solve next, where interpolation leaves more than is wanted, or one value on a side does not tell
/// whether the measure jumps.
pub(super) fn next_value(points: &[Point], asked: &[MeasureLevel], tolerance: f64) -> Option<f64> {
    let all = || {
        let each = asked.iter();
        each.flat_map(|asked| roots_of(points, asked, 1.0))
    };
    let mut wide =
        all().filter(|root| root.interpolation > INTERPOLATED * tolerance.max(root.of_measure));
    let inside = |value: f64, root: &Root| {
        let [a, b] = root.ends.map(|end| end.at);
        (value > a && value < b).then_some(value)
    };
    let wanted = wide.find_map(|root| {
        let [a, b] = root.ends.map(|end| end.at);
        let aside = 0.05 * (b - a);
        inside(root.value.clamp(a + aside, b - aside), &root)
    });
    let told = |root: Root| inside(0.5 * (root.alone? + root.value), &root);
    wanted.or_else(|| all().find_map(told))
}

/// The measure at all points that have it, so many of its errors at each being believed to hold the true one.
fn samples(points: &[Point], asked: &MeasureLevel, limit: f64) -> Vec<Excess> {
    let each = points.iter().map(|point| measure_of(&point.report, asked));
    let each: Vec<Option<&Measure>> = each.collect();
    let known = (points.iter().zip(&each).enumerate()).filter_map(|(number, (point, one))| {
        let follows = number > 0 && each[number - 1].is_some();
        Some((point.value, (*one)?, follows))
    });
    let known: Vec<(f64, &Measure, bool)> = known.collect();
    let is_ratio = asked.level > 0.0 && known.iter().all(|(_, one, _)| one.value > 0.0);
    let sample = |(at, one, follows): (f64, &Measure, bool)| {
        let (over, error) = over(one, asked.level, is_ratio);
        Excess {
            at,
            over,
            error: limit * error,
            is_judged: one.error.is_some(),
            follows,
        }
    };
    known.into_iter().map(sample).collect()
}

/// What a report says of the measure of a level, where that is a number.
pub(super) fn measure_of<'r>(report: &'r SolveReport, asked: &MeasureLevel) -> Option<&'r Measure> {
    let mut measures = report.measures.iter();
    let one = measures.find(|one| one.name == asked.measure)?;
    let is_finite = one.value.is_finite() && one.error.is_none_or(f64::is_finite);
    is_finite.then_some(one)
}

/// How far a measure is over its level, with the error of that: the logarithm of their ratio, or their difference.
pub(super) fn over(one: &Measure, level: f64, is_ratio: bool) -> (f64, f64) {
    let error = one.error.unwrap_or(0.0);
    match is_ratio {
        true => ((one.value / level).ln(), error / one.value),
        false => (one.value - level, error),
    }
}

/// The roots of a measure less its level.
fn roots_of(points: &[Point], asked: &MeasureLevel, limit: f64) -> Vec<Root> {
    let samples = samples(points, asked, limit);
    let found = roots(&samples);
    let rise = asked.measure.strip_prefix(SPECTRAL_RISE.word);
    match rise.and_then(|rest| rest.strip_prefix('_')) {
        Some(of) => rise::roots_of_rise(points, of, &samples, found),
        None => found,
    }
}

/// All roots between neighbouring samples, ascending.
fn roots(samples: &[Excess]) -> Vec<Root> {
    let crosses = |pair: &[Excess]| (pair[0].over < 0.0) != (pair[1].over < 0.0);
    let pairs = samples.windows(2).enumerate();
    let found = pairs.filter(|(_, pair)| crosses(pair)).map(|(left, pair)| {
        let nodes = |count: usize| -> &[Excess] {
            let used = count.min(samples.len());
            let first = (left + 1)
                .saturating_sub(used / 2)
                .min(samples.len() - used);
            &samples[first..first + used]
        };
        let ends = [pair[0], pair[1]];
        let (many, few) = (nodes(NODES), nodes(NODES - 1));
        let value = root(many, ends);
        let width = ends[1].at - ends[0].at;
        let step = 1e-3 * width;
        let slope = (through(many, value + step) - through(many, value - step)) / (2.0 * step);
        let (is_jump, alone) = jump(samples, left, value);
        Root {
            value,
            interpolation: match samples.len() {
                0..NODES => width,
                _ => (root(few, ends) - value).abs(),
            },
            of_measure: ends[0].error.max(ends[1].error) / slope.abs(),
            is_jump,
            alone,
            ends,
        }
    });
    found.collect()
}

/// Whether the measure may jump over zero between a sample and the next: where lines through the two samples on
/// either side of a root lead to less than half of the way to zero there, or a solved value between them has no
/// measure. A side with one sample says nothing; that sample is told then.
fn jump(samples: &[Excess], left: usize, root: f64) -> (bool, Option<f64>) {
    let stays = |near: &Excess, far: Option<&Excess>| {
        let Some(far) = far else {
            return true;
        };
        let slope = (near.over - far.over) / (near.at - far.at);
        let there = near.over + slope * (root - near.at);
        let is_known = near.over.abs() > near.error;
        is_known && there / near.over > 0.5
    };
    let sides = [
        (&samples[left], left.checked_sub(1).map(|at| &samples[at])),
        (&samples[left + 1], samples.get(left + 2)),
    ];
    let is_torn = !samples[left + 1].follows;
    let is_jump = is_torn || sides.iter().all(|&(near, far)| stays(near, far));
    let alone = sides.iter().find(|(_, far)| far.is_none());
    let alone = alone
        .filter(|_| is_jump && !is_torn)
        .map(|(near, _)| near.at);
    (is_jump, alone)
}

/// The root between two samples of the polynomial through some.
fn root(nodes: &[Excess], ends: [Excess; 2]) -> f64 {
    let is_below = ends[0].over < 0.0;
    let is_first = |middle: f64| (through(nodes, middle) < 0.0) == is_below;
    bisected((ends[0].at, ends[1].at), HALVINGS, is_first)
}

/// The polynomial through some samples, at a value.
fn through(nodes: &[Excess], at: f64) -> f64 {
    let term = |(number, node): (usize, &Excess)| {
        let others = nodes
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != number);
        let weight = |product: f64, (_, other): (usize, &Excess)| {
            product * (at - other.at) / (node.at - other.at)
        };
        node.over * others.fold(1.0, weight)
    };
    nodes.iter().enumerate().map(term).sum()
}

fn row((asked, is_sampled): (&MeasureLevel, bool), root: &Root, tolerance: f64) -> LevelCrossing {
    let [lower, upper] = root.ends.map(|end| end.at);
    // Of a jump nothing is known but what it lies between.
    let (value, error) = match root.is_jump {
        true => (0.5 * (lower + upper), 0.5 * (upper - lower)),
        false => (root.value, root.error()),
    };
    let is_judged = root.ends.iter().all(|end| end.is_judged);
    let is_known = error <= tolerance;
    let doubt = match (is_known, is_judged) {
        _ if root.is_jump => Some(Doubt::Jump),
        (false, _) if is_sampled => Some(Doubt::FewSamples(error)),
        (false, _) => Some(Doubt::SolverError(error)),
        (true, false) => Some(Doubt::CheckMissing),
        (true, true) => None,
    };
    LevelCrossing {
        label: String::new(),
        asked: asked.clone(),
        value,
        error,
        lower,
        upper,
        rises: root.ends[0].over < 0.0,
        doubts: doubt.into_iter().collect(),
    }
}

/// Two crossings that cannot be told apart are one band.
fn merge(last: &mut LevelCrossing, next: &LevelCrossing) {
    last.lower = (last.value - last.error).min(last.lower);
    last.upper = (next.value + next.error).max(next.upper);
    last.value = 0.5 * (last.lower + last.upper);
    last.error = 0.5 * (last.upper - last.lower);
    last.doubts = vec![Doubt::Stages];
}

#[cfg(test)]
mod tests;
