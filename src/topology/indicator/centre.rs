//! Indicators at a centre of symmetry, which are read together: the curvature of a marginal, or the slope at its kink;
//! of a joint density both principal curvatures, or the slope across a kink and the curvature along it.

use std::cmp::Ordering;

use super::exact;
use super::kind::Traits;
use super::smooth::Smooth;
use super::window;
use super::{Indicator, IndicatorKind, is_told};
use crate::density::{EstimatedDensity, Kink, Variants};
use crate::space::Axis;
use crate::topology::reconstruction::Weights;

impl IndicatorKind {
    /// p''/p of a marginal at its centre of symmetry.
    pub const CURVATURE: Self = Self(&CURVATURE);
    /// The same half a turn from the centre, on an axis that closes on itself: a reflection holds that place too.
    pub const OPPOSITE_CURVATURE: Self = Self(&OPPOSITE_CURVATURE);
    /// Slope of log p on the upper side of a kink at the centre of symmetry; in a symmetric density half its jump.
    pub const KINK_SLOPE: Self = Self(&KINK_SLOPE);
    /// Curvature of a joint density along a kink through the centre of symmetry.
    pub const CURVATURE_ALONG_KINK: Self = Self(&ALONG_KINK);
    /// The lower of the two principal curvatures of a joint density at its centre, axes scaled to their ranges.
    pub const LOWER_CURVATURE: Self = Self(&LOWER);
    /// The upper one.
    pub const UPPER_CURVATURE: Self = Self(&UPPER);
}

const CURVATURE: Traits = Traits {
    title: "$p$″ / $p$",
    words: |step| Some(step.of_centre()),
    companions: |_| vec![IndicatorKind::QUARTIC],
    is_at_centre: true,
    ..Traits::new("curvature at the centre", |density, _| {
        read_one(density, IndicatorKind::CURVATURE)
    })
};

/// Read on a density laid out over some turns, whose centre is that place.
const OPPOSITE_CURVATURE: Traits = Traits {
    title: "$p$″ / $p$",
    words: |step| Some(step.of_centre()),
    is_at_centre: true,
    ..Traits::new("curvature half a turn from the centre", |_, _| None)
};

const LOWER: Traits = Traits {
    title: "lower curvature",
    companions: |_| vec![IndicatorKind::QUARTIC],
    is_at_centre: true,
    ..Traits::new("lower curvature at the centre", |density, _| {
        read_one(density, IndicatorKind::LOWER_CURVATURE)
    })
};

const UPPER: Traits = Traits {
    code: "upper curvature at the centre",
    name: "upper curvature at the centre",
    title: "upper curvature",
    read: |density, _| read_one(density, IndicatorKind::UPPER_CURVATURE),
    ..LOWER
};

const KINK_SLOPE: Traits = Traits {
    title: "$p$′ / $p$",
    words: |step| {
        let words = if step.rises {
            "split at a kink"
        } else {
            "merger at a kink"
        };
        (step.craters() == Ordering::Equal).then_some(words)
    },
    companions: |axes| {
        vec![match axes {
            1 => IndicatorKind::curvature_beside_kink(true),
            _ => IndicatorKind::CURVATURE_ALONG_KINK,
        }]
    },
    is_at_centre: true,
    is_exact: true,
    ..Traits::new("slope at the kink", |density, _| {
        read_one(density, IndicatorKind::KINK_SLOPE)
    })
};

const ALONG_KINK: Traits = Traits {
    companions: |_| vec![IndicatorKind::KINK_SLOPE],
    is_at_centre: true,
    ..Traits::new("curvature along the kink", |density, _| {
        read_one(density, IndicatorKind::CURVATURE_ALONG_KINK)
    })
};

/// One of those at the centre.
fn read_one(density: &EstimatedDensity, kind: IndicatorKind) -> Option<Indicator> {
    let mut all = at_centre(density).into_iter();
    all.find(|one| one.kind == kind)
}

/// The indicators at the centre of symmetry: one of a marginal, two of a joint density; none where the system
/// declares no symmetry, the cells about the centre are too few, or the density there is no more than the solver
/// leaves.
pub(crate) fn at_centre(estimated: &EstimatedDensity) -> Vec<Indicator> {
    let Some(centre) = &estimated.structure.centre else {
        return Vec::new();
    };
    let kinks: Vec<Option<&Kink>> = (0..centre.len())
        .map(|k| kink_at(estimated, k, centre[k]))
        .collect();
    let found = match (centre.as_slice(), kinks.as_slice()) {
        (_, [Some(kink)]) => slope(estimated, kink, centre).map(|one| vec![one]),
        _ if !is_told(estimated, centre) || is_negative_about(estimated, centre) => None,
        (&[at], [None]) => curvature(estimated, at).map(|one| vec![one]),
        (_, [None, None]) => principal(estimated, centre),
        (_, [Some(kink), None] | [None, Some(kink)]) => along_kink(estimated, kink, centre),
        _ => None,
    };
    found.unwrap_or_default()
}

/// Cells on either side of the centre among which none may be negative.
const ABOUT: usize = 4;

/// Whether a cell about the centre of a density without noise is negative: what is read there is a wiggle of the
/// scheme.
fn is_negative_about(estimated: &EstimatedDensity, centre: &[f64]) -> bool {
    let axes = &estimated.density.axes;
    let near = |k: usize| -> Option<std::ops::Range<usize>> {
        let cell = axes.get(k)?.find(*centre.get(k)?)?;
        Some(cell.saturating_sub(ABOUT)..(cell + ABOUT + 1).min(axes[k].count()))
    };
    let (Some(rows), columns) = (near(0), near(1).unwrap_or(0..1)) else {
        return false;
    };
    let along = axes.get(1).map_or(1, Axis::count);
    let mut cells = rows.flat_map(|row| columns.clone().map(move |column| row * along + column));
    let is_negative = |cell: usize| {
        estimated
            .density
            .values
            .get(cell)
            .is_some_and(|value| *value < 0.0)
    };
    !estimated.is_noisy() && cells.any(is_negative)
}

fn kink_at(estimated: &EstimatedDensity, k: usize, at: f64) -> Option<&Kink> {
    let axis = &estimated.density.axes[k];
    let mut kinks = estimated.structure.kinks.iter();
    kinks.find(|kink| kink.axis == k && !kink.is_bend() && axis.is_same_place(at, kink.at))
}

/// p''/p of a marginal.
fn curvature(estimated: &EstimatedDensity, at: f64) -> Option<Indicator> {
    let profile = estimated.structure.profile.as_ref();
    if let Some(found) =
        profile.and_then(|profile| exact::curvature(profile, at, IndicatorKind::CURVATURE))
    {
        return Some(found);
    }
    if is_sampled(estimated) {
        let fit = Smooth::marginal(estimated, at)?;
        let of =
            |level: usize| move |fit: &Smooth, values: &[f64]| fit.derivatives(values, level)[0];
        let (fine, rough) = (of(0), of(1));
        let kind = IndicatorKind::CURVATURE;
        let fine = |values: &[f64]| fine(&fit, values);
        let rough = |values: &[f64]| rough(&fit, values);
        return Indicator::derive(estimated, kind, vec![at], fine, rough);
    }
    let lines = window::about(estimated, 0, at)?;
    let of = |lines: &[Weights], values: &[f64]| lines[2].apply(values) / lines[0].apply(values);
    let [fine, rough] = lines.both();
    let (fine, rough) = (
        |values: &[f64]| of(fine, values),
        |values: &[f64]| of(rough, values),
    );
    Indicator::derive(estimated, IndicatorKind::CURVATURE, vec![at], fine, rough)
}

/// Half the jump of the slope of log p: the slope on the upper side, because the mean slope is zero by symmetry. It
/// follows from the equations, not from the cells.
fn slope(estimated: &EstimatedDensity, kink: &Kink, centre: &[f64]) -> Option<Indicator> {
    let other = estimated.density.axes.get(1 - kink.axis.min(1));
    let cell = match other {
        Some(axis) if centre.len() > 1 => axis.find(centre[1 - kink.axis])?,
        _ => 0,
    };
    let half = 0.5 * kink.jump_at(cell);
    let range = &estimated.density.axes[kink.axis];
    let rounding = Kink::ROUNDING / (range.to() - range.from());
    let (value, rougher) = (|_: &[f64]| half, |_: &[f64]| half + rounding);
    Indicator::derive(
        estimated,
        IndicatorKind::KINK_SLOPE,
        centre.to_vec(),
        value,
        rougher,
    )
}

/// The slope across a kink and the curvature along it.
fn along_kink(estimated: &EstimatedDensity, kink: &Kink, centre: &[f64]) -> Option<Vec<Indicator>> {
    let (across, along) = (kink.axis, 1 - kink.axis);
    let kind = IndicatorKind::CURVATURE_ALONG_KINK;
    if is_sampled(estimated) {
        let fit = Smooth::along_kink(estimated, centre, across)?;
        let fine = |values: &[f64]| fit.derivatives(values, 0)[0];
        let rough = |values: &[f64]| fit.derivatives(values, 1)[0];
        return Some(vec![
            slope(estimated, kink, centre)?,
            Indicator::derive(estimated, kind, centre.to_vec(), fine, rough)?,
        ]);
    }
    let trace = window::on_kink(estimated, across, centre[across])?;
    let lines = window::about(estimated, along, centre[along])?;
    let columns = estimated.density.axes[1].count();
    let apply = |trace: &Weights, line: &Weights, values: &[f64]| {
        if across == 1 {
            line.apply_with(trace, columns, values)
        } else {
            trace.apply_with(line, columns, values)
        }
    };
    let of = |trace: &[Weights], lines: &[Weights], values: &[f64]| {
        apply(&trace[0], &lines[2], values) / apply(&trace[0], &lines[0], values)
    };
    let fine = |values: &[f64]| of(&trace.fine, &lines.fine, values);
    let rough = |values: &[f64]| of(&trace.rough, &lines.rough, values);
    Some(vec![
        slope(estimated, kink, centre)?,
        Indicator::derive(estimated, kind, centre.to_vec(), fine, rough)?,
    ])
}

/// The two eigenvalues of the Hessian of a joint density over the density, axes in units of their ranges.
fn principal(estimated: &EstimatedDensity, centre: &[f64]) -> Option<Vec<Indicator>> {
    let axes = &estimated.density.axes;
    let range = |axis: &Axis| axis.to() - axis.from();
    let (a, b) = (range(&axes[0]), range(&axes[1]));
    let eigenvalue = |[xx, xy, yy]: [f64; 3], sign: f64| {
        let (xx, xy, yy) = (a * a * xx, a * b * xy, b * b * yy);
        0.5 * (xx + yy) + sign * (0.5 * (xx - yy)).hypot(xy)
    };
    let both = |hessian: &dyn Fn(&[f64], usize) -> [f64; 3]| {
        let one = |kind: IndicatorKind, sign: f64| {
            let fine = |values: &[f64]| eigenvalue(hessian(values, 0), sign);
            let rough = |values: &[f64]| eigenvalue(hessian(values, 1), sign);
            Indicator::derive(estimated, kind, centre.to_vec(), fine, rough)
        };
        Some(vec![
            one(IndicatorKind::LOWER_CURVATURE, -1.0)?,
            one(IndicatorKind::UPPER_CURVATURE, 1.0)?,
        ])
    };
    if is_sampled(estimated) {
        let fit = Smooth::joint(estimated, centre)?;
        return both(&|values, level| match fit.derivatives(values, level)[..] {
            [xx, xy, yy] => [xx, xy, yy],
            _ => [f64::NAN; 3],
        });
    }
    let first = window::about(estimated, 0, centre[0])?;
    let second = window::about(estimated, 1, centre[1])?;
    let columns = axes[1].count();
    both(&|values, level| {
        let (rows, lines) = (first.both()[level], second.both()[level]);
        let apply = |i: usize, j: usize| rows[i].apply_with(&lines[j], columns, values);
        let p = apply(0, 0);
        [apply(2, 0) / p, apply(1, 1) / p, apply(0, 2) / p]
    })
}

fn is_sampled(estimated: &EstimatedDensity) -> bool {
    matches!(estimated.variants, Variants::Jackknife(_))
}
