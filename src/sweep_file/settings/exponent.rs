//! What a file wants the largest Lyapunov exponent of, a fixed point or all of the stationary density, held against the
//! equations.

use crate::exponent::{ExponentError, largest};
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::{Draft, ExponentKind, MethodKind};
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::system::{ExponentMethod, Family, FixedPointFault, NoiseKind, TangentFault};

/// What to do where a state is moved.
const FIXED: &str = "give under `exponent.at` a state at which the drift and every noise are zero all along the sweep, or leave `[exponent]` out";

/// Steps of all trajectories, where nothing else is said: some seconds.
const STEPS: f64 = 2e7;

/// Reads `[exponent]` into what a family is asked for.
pub(super) fn read(reader: &mut Reader<'_>, draft: &Draft, family: &mut Family) {
    let by_paths = draft.exponent_method == Some(ExponentMethod::Trajectories);
    let is_along = draft.exponent == Some(ExponentKind::Largest);
    for (key, is_idle, remedy) in [
        (
            "method",
            draft.exponent_method.is_some() && !is_along,
            "leave it out, or write `kind = \"largest\"`",
        ),
        (
            "steps",
            draft.exponent_steps.is_some() && !(is_along && by_paths),
            "leave it out, or write `method = \"trajectories\"`",
        ),
    ] {
        if is_idle {
            let title = format!("`exponent.{key}` says nothing of this exponent");
            let place = reader.place(&["exponent", key]);
            let diagnostic = Diagnostic::new(title).remedy(remedy);
            reader.report(diagnostic.at(place, "this key"));
        }
    }
    if draft.exponent == Some(ExponentKind::Largest) {
        let is_known = is_along_density(reader, draft, family);
        let by = draft.exponent_method.unwrap_or(ExponentMethod::Modes);
        family.questions.largest_exponent = is_known.then_some(by);
        if by == ExponentMethod::Trajectories {
            family.questions.exponent_steps = draft.exponent_steps.unwrap_or(STEPS);
        }
    } else {
        family.questions.fixed_point = fixed_point(reader, draft, family);
    }
}

/// Whether the exponent along the density can be worked out; what speaks against it is reported.
fn is_along_density(reader: &mut Reader<'_>, draft: &Draft, family: &Family) -> bool {
    let (from, _) = family.ends();
    let by = draft.exponent_method.unwrap_or(ExponentMethod::Modes);
    let by_modes = by == ExponentMethod::Modes;
    let (words, remedy) = if !draft.fixed_point.is_empty() {
        (
            "`exponent.at` names a fixed point, and the largest exponent is wanted along the density".to_owned(),
            "leave `at` out, or write `kind = \"fixed-point\"`",
        )
    } else if by_modes && draft.method.kind != MethodKind::Generator {
        (
            "modes give the largest Lyapunov exponent along a density by the generator alone"
                .to_owned(),
            "write `exponent.method = \"trajectories\"`, or `method.kind = \"generator\"`",
        )
    } else {
        let Some(fault) = family.tangent_fault(from, by) else {
            return true;
        };
        let remedy = match fault {
            TangentFault::Rough => {
                "smooth it (`v/sqrt(v^2 + e^2)` for `sign(v)`, `sqrt(v^2 + e^2)` for `abs(v)`), or leave `[exponent]` out"
            }
            TangentFault::Axes { .. } | TangentFault::Turns => {
                "write `exponent.method = \"trajectories\"`, or leave `[exponent]` out"
            }
            TangentFault::Walls => "write `exponent.method = \"modes\"`, or leave `[exponent]` out",
            _ => "leave `[exponent]` out",
        };
        (fault.to_string(), remedy)
    };
    let diagnostic = Diagnostic::new(words).remedy(remedy);
    reader.report(diagnostic.at(reader.place(&["exponent", "kind"]), "this exponent"));
    false
}

/// Checks the state of `[exponent]`: it is named by axes of the system, and neither drift nor noise moves it at
/// either end of the sweep or in its middle.
fn fixed_point(reader: &mut Reader<'_>, draft: &Draft, family: &Family) -> Option<Vec<f64>> {
    let model = family.model();
    let is_axis = |name: &str| model.axes.iter().any(|axis| axis.name == name);
    let mut is_known = true;
    for (wrong, _) in draft.fixed_point.iter().filter(|(name, _)| !is_axis(name)) {
        let names: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
        let title = format!("`{}` is no coordinate of the state", quotable(wrong));
        let diagnostic = Diagnostic::new(title).nearest(wrong, names);
        let place = reader.key_place(&["exponent", "at", wrong]);
        reader.report(diagnostic.at(place, "no axis"));
        is_known = false;
    }
    if draft.exponent.is_none() {
        if let (true, false) = (is_known, draft.fixed_point.is_empty()) {
            let title = "`exponent.at` names a fixed point, and nothing is asked of it".to_owned();
            refuse(
                reader,
                title,
                "add `kind = \"fixed-point\"` to `[exponent]`",
            );
        }
        return None;
    }
    if model.noise_kind() != NoiseKind::White {
        let title = "Lyapunov exponents are worked out of white noise alone: an axis of coloured noise is never at rest";
        let remedy = "leave `[exponent]` or `system.noise.kind` out";
        refuse(reader, title.to_owned(), remedy);
        return None;
    }
    if let (true, count @ 3..) = (is_known, model.axes.len()) {
        let title = format!(
            "Lyapunov exponents of fixed points are worked out of one axis and of two; this system has {count}"
        );
        refuse(reader, title, "leave `[exponent]` out");
        return None;
    }
    let given = |axis: &str| draft.fixed_point.iter().find(|(name, _)| name == axis);
    let coordinate = |axis: &str| given(axis).map_or(0.0, |(_, value)| *value);
    let state: Vec<f64> = model
        .axes
        .iter()
        .map(|axis| coordinate(&axis.name))
        .collect();
    let is_fixed = is_known && is_fixed(reader, family, &state);
    is_fixed.then_some(state)
}

/// Whether a state has an exponent at both ends of the path and in its middle; what speaks against it is reported
/// once.
fn is_fixed(reader: &mut Reader<'_>, family: &Family, state: &[f64]) -> bool {
    let (from, to) = family.ends();
    for value in [from, 0.5 * (from + to), to] {
        let linear = family.linearised(value, state).map_err(ExponentError::from);
        let Err(error) = linear.and_then(|linear| largest(&linear)) else {
            continue;
        };
        let (words, remedy) = in_words(family, state, value, &error);
        refuse(reader, words, remedy);
        return false;
    }
    true
}

fn in_words(
    family: &Family,
    state: &[f64],
    value: f64,
    error: &ExponentError,
) -> (String, &'static str) {
    let coordinates = state.iter().enumerate();
    let coordinates = coordinates.map(|(axis, x)| format!("{} = {x}", family.axis(axis)));
    let place = coordinates.collect::<Vec<_>>().join(", ");
    let at = format!("at {} = {value}", family.parameter());
    match error {
        ExponentError::FixedPoint(FixedPointFault::Moves { axis, drift, noise }) => (
            format!(
                "{place} is no fixed point {at}: along {} the drift is {drift} there, and the amplitude of the noise {noise}",
                family.axis(*axis)
            ),
            FIXED,
        ),
        ExponentError::FixedPoint(FixedPointFault::Rough { axis }) => (
            format!(
                "drift or noise of `{}` has no derivative at {place} ({at}), so that small deviations from it obey no linear equation",
                family.axis(*axis)
            ),
            "smooth it there (`v/sqrt(v^2 + e^2)` for `sign(v)`), or leave `[exponent]` out",
        ),
        error => (error.to_string(), "leave `[exponent]` out"),
    }
}

/// An error at what is asked for.
fn refuse(reader: &mut Reader<'_>, title: String, remedy: &str) {
    let diagnostic = Diagnostic::new(title).remedy(remedy);
    let at = reader.place(&["exponent", "at"]);
    let place = at.or_else(|| reader.place(&["exponent", "kind"]));
    let place = place.or_else(|| reader.place(&["exponent"]));
    reader.report(diagnostic.at(place, "this fixed point"));
}
