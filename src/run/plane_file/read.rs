//! A map or curves from the JSON of their plane.

use serde_json::Value;

use super::{BORDER, NO_DENSITY, REASONS};
use crate::continuation::curve::{
    CodimensionTwoKind, Curve, CurveEnd, CurveOrigin, CurvePoint, CurveWork, DegeneratePoint,
    EndReason, LevelCurve, Plane,
};
use crate::continuation::map::{MapWork, RegimeMap, RegionSample, Untraced, UntracedChange};
use crate::continuation::{BifurcationStatus, Doubt, ErrorParts, Subject};
use crate::density::{Density, Observable};
use crate::method::Problem;
use crate::system::MeasureLevel;
use crate::topology::IndicatorKind;

pub(super) fn map(
    value: &Value,
    problem: &Problem,
    plane: Plane,
    (curves, levels): (Vec<Curve>, Vec<LevelCurve>),
) -> Option<RegimeMap> {
    let subject: Subject = problem.subject().clone();
    let sample = |value: &Value| {
        let observable = count(&value["observable"])?;
        let axes = problem.axes_of(*subject.observables.get(observable)?);
        let values = list(&value["density"], |one| Some(number(one)))?;
        let cells: usize = axes.iter().map(crate::space::Axis::count).product();
        (values.len() == cells).then_some(RegionSample {
            observable,
            values: pair(&value["values"])?,
            density: Density { axes, values },
        })
    };
    let samples = list(&value["samples"], sample)?;
    let untraced = |value: &Value| {
        let asked = &value["level"];
        let of = match asked.is_null() {
            true => UntracedChange::Signature(count(&value["observable"])?),
            false => UntracedChange::Level(MeasureLevel {
                measure: asked[0].as_str()?.to_owned(),
                level: asked[1].as_f64()?,
            }),
        };
        Some(Untraced {
            of,
            pairs: count(&value["pairs"])?,
            near: pair(&value["near"])?,
            reason: value["reason"].as_str()?.to_owned(),
        })
    };
    Some(RegimeMap {
        nodes: read(&value["nodes"])?,
        cells: list(&value["cells"], |cell| {
            Some([pair(&cell[0])?, pair(&cell[1])?])
        })?,
        untraced: list(&value["not_followed"], untraced)?,
        interrupted: value["interrupted"].as_bool()?,
        work: MapWork::default(),
        samples,
        subject,
        plane,
        curves,
        levels,
    })
}

pub(super) fn origin(value: &Value) -> Option<CurveOrigin> {
    Some(CurveOrigin {
        label: value["label"].as_str()?.to_owned(),
        value: number(&value["value"]),
        sides: read(&value["sides"])?,
    })
}

pub(super) fn level(value: &Value) -> Option<LevelCurve> {
    let points = list(&value["points"], point)?;
    Some(LevelCurve {
        asked: MeasureLevel {
            measure: value["measure"].as_str()?.to_owned(),
            level: value["level"].as_f64()?,
        },
        start: count(&value["start"]).filter(|&place| place < points.len())?,
        ends: list(&value["ends"], |one| end(one, points.len()))?,
        work: CurveWork::default(),
        points,
    })
}

/// The end of a curve of so many points.
fn end(value: &Value, points: usize) -> Option<CurveEnd> {
    Some(CurveEnd {
        label: value[0].as_str()?.to_owned(),
        point: count(&value[1]).filter(|&place| place < points)?,
        reason: reason(value[2].as_str()?, &value[3])?,
    })
}

pub(super) fn curve(value: &Value, plane: &Plane) -> Option<Curve> {
    let points = list(&value["points"], point)?;
    let within = |value: &Value| count(value).filter(|&place| place < points.len());
    let split = |value: &Value| {
        let word = value[2].as_str()?;
        let mut kinds = CodimensionTwoKind::ALL.into_iter();
        Some(DegeneratePoint {
            label: value[0].as_str()?.to_owned(),
            kind: kinds.find(|kind| kind.name() == word)?,
            point: within(&value[1])?,
        })
    };
    Some(Curve {
        plane: plane.clone(),
        observable: match list(&value["observable"], count)?.as_slice() {
            [axis] => Observable::Marginal(*axis),
            [first, second] => Observable::Joint(*first, *second),
            _ => return None,
        },
        kind: IndicatorKind::of_code(value["kind"].as_str()?)?,
        start: within(&value["start"])?,
        ends: list(&value["ends"], |one| end(one, points.len()))?,
        degenerate: list(&value["degenerate"], split)?,
        branches: Vec::new(),
        work: CurveWork::default(),
        check_work: CurveWork::default(),
        points,
    })
}

fn reason(word: &str, detail: &Value) -> Option<EndReason> {
    match word {
        BORDER => Some(EndReason::Border(count(detail)?)),
        NO_DENSITY => Some(EndReason::NoDensity(detail.as_str()?.to_owned())),
        word => {
            let known = REASONS.iter().find(|(_, known)| *known == word)?;
            Some(known.0.clone())
        }
    }
}

fn point(value: &Value) -> Option<CurvePoint> {
    let word = value["status"].as_str()?;
    let mut statuses = BifurcationStatus::ALL.into_iter();
    let status = statuses.find(|one| one.word() == word)?;
    let in_doubt = status != BifurcationStatus::Located;
    let parts = &value["parts"];
    Some(CurvePoint {
        values: pair(&value["values"])?,
        error: number(&value["error"]),
        parts: ErrorParts {
            solver: number(&parts[0]),
            grid: number(&parts[1]),
            sampling: number(&parts[2]),
            leak: number(&parts[3]),
        },
        to_edge: pair(&value["to_edge"])?,
        indicator: number(&value["indicator"]),
        gradient: pair(&value["gradient"])?,
        place: list(&value["place"], |one| Some(number(one)))?,
        arclength: number(&value["arclength"]),
        tangent: pair(&value["tangent"])?,
        checked: value["checked"].as_bool()?,
        doubts: Vec::from_iter(in_doubt.then_some(Doubt::Stored(status))),
    })
}

/// What was written of something.
fn read<T: serde::de::DeserializeOwned>(value: &Value) -> Option<T> {
    T::deserialize(value).ok()
}

pub(super) fn list<T>(value: &Value, of: impl Fn(&Value) -> Option<T>) -> Option<Vec<T>> {
    value.as_array()?.iter().map(of).collect()
}

fn count(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

/// A number; what is none was written as null.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn pair(value: &Value) -> Option<[f64; 2]> {
    let both = value.as_array()?;
    (both.len() == 2).then(|| [number(&both[0]), number(&both[1])])
}
