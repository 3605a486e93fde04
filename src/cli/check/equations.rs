//! What `pbif check` says of a file's own equations: how they were read, what was found in them, and what costs
//! accuracy.

use crate::sweep_file::Sweep;

/// The equations typeset, and what was found, as comments.
pub(super) fn lines(spec: &Sweep) -> Vec<String> {
    let family = spec.problem.family();
    let Some(typed) = family.model().typed() else {
        return Vec::new();
    };
    let mut lines = vec![String::new(), "# Equations as read".to_owned()];
    lines.extend(typed.typeset().iter().map(|line| format!("#   {line}")));
    let mut found: Vec<String> = typed.noises();
    let Ok(system) = family.at(family.ends().0) else {
        return lines;
    };
    let facts = system.facts();
    let surfaces: Vec<String> = (facts.switching_surfaces)
        .iter()
        .map(|surface| format!("{} = {}", family.axis(surface.axis), surface.at))
        .collect();
    found.push(if !surfaces.is_empty() {
        format!("the drift is not smooth where {}", surfaces.join(", "))
    } else if typed.is_smooth() {
        "drift and noise are smooth".to_owned()
    } else {
        "drift or noise is not smooth in places that are no plane of one coordinate".to_owned()
    });
    let said = typed.source().bounds();
    let is_said = |axis: usize| said.iter().any(|(name, _, _)| name == family.axis(axis));
    let (first, last) = family.ends();
    let others = [0.5 * (first + last), last].map(|value| family.at(value));
    let stays = |axis: usize| {
        let mut others = others.iter().flatten();
        others.all(|one| one.facts().bounds(axis) == facts.bounds(axis))
    };
    let found_here = facts.bounds.iter();
    for (&axis, (from, to)) in found_here.filter(|(axis, _)| !is_said(**axis) && stays(**axis)) {
        let name = family.axis(axis);
        found.push(format!(
            "{name} stays between {from} and {to}: it has hysteresis"
        ));
    }
    let reflected = facts.symmetry.as_ref().map(|symmetry| {
        let axes = symmetry.reflected.iter().enumerate();
        let axes = axes.filter(|(_, reflected)| **reflected);
        let each = axes.map(|(axis, _)| {
            let name = family.axis(axis);
            format!("{name} → -{name}")
        });
        each.collect::<Vec<_>>().join(", ")
    });
    found.push(match reflected {
        Some(words) => format!("the reflection {words} leaves the process as it is"),
        None => "no reflection about the origin leaves the process as it is".to_owned(),
    });
    lines.push("# Found".to_owned());
    lines.extend(found.iter().map(|line| format!("#   {line}")));
    lines
}

/// What costs accuracy: places that no face of the grid lies on, noise that vanishes, operations that may fail.
pub(super) fn notes(spec: &Sweep) -> Vec<String> {
    let family = spec.problem.family();
    let Some(typed) = family.model().typed() else {
        return Vec::new();
    };
    let mut notes = family.model().notes.clone();
    let space = spec.problem.space();
    let ranges: Vec<(f64, f64)> = space
        .axes()
        .iter()
        .map(|axis| (axis.from(), axis.to()))
        .collect();
    let (from, to) = family.ends();
    let at = |end: f64| {
        let values = family.values_at(end);
        values.map_or(Vec::new(), |values| values.as_slice().to_vec())
    };
    let parameters: Vec<(f64, f64)> = at(from).into_iter().zip(at(to)).collect();
    for amplitude in typed.vanishing_noises(&ranges, &parameters) {
        notes.push(format!(
            "the amplitude {amplitude} may be zero in the domain: where no other noise acts, densities can have edges or peaks \
             that cells do not resolve"
        ));
    }
    let hazards = typed.hazards(&ranges, &parameters);
    for hazard in hazards.iter().filter(|hazard| !hazard.certain) {
        notes.push(format!(
            "{}: {} in {} could not be excluded on the domain",
            hazard.place,
            hazard.kind.words(),
            hazard.part
        ));
    }
    notes
}
