//! Walls at the ends of cells, at which the process is reflected (`[system.bounds] x = ["reflecting", "open"]`).

use super::AxisSettings;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::{Draft, EndKind, MethodKind};
use crate::sweep_file::reader::Reader;
use crate::system::Family;

/// The family between the walls that a file names, which stand where cells end.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    family: Family,
    axes: &[AxisSettings],
) -> Family {
    let mut walls = Vec::new();
    for (name, ends) in &draft.equations.ends {
        // An axis that the system does not have.
        let known = family.model().axes.iter();
        let Some(axis) = known.clone().position(|axis| axis.name == *name) else {
            let title = format!("the system has no axis `{name}`");
            let nearest = known.map(|axis| axis.name.as_str());
            let found = Diagnostic::new(title).nearest(name, nearest);
            refuse(reader, name, found);
            continue;
        };
        if let Some(found) = fault(draft, &family, (axis, name), ends, axes[axis].ends) {
            refuse(reader, name, found);
            continue;
        }
        let wall = |end: usize| axes[axis].ends[end].filter(|_| ends[end] == EndKind::Reflecting);
        let (lower, upper) = (wall(0), wall(1));
        if lower.is_some() || upper.is_some() {
            let from = lower.unwrap_or(f64::NEG_INFINITY);
            let to = upper.unwrap_or(f64::INFINITY);
            walls.push((axis, (from, to)));
        }
    }
    family.with_walls(walls)
}

/// Why an axis cannot have such ends.
fn fault(
    draft: &Draft,
    family: &Family,
    (axis, name): (usize, &str),
    ends: &[EndKind; 2],
    places: [Option<f64>; 2],
) -> Option<Diagnostic> {
    if ends.contains(&EndKind::Absorbing) {
        let title = format!(
            "the cells of `{name}` cannot end in absorption: what ends there has no steady state"
        );
        let remedy = format!(
            "ask for the time until it happens, its rate and its probabilities by a passage: \
             `[passage] exit = {{ from = \"density\", until = \"{name} > …\" }}`, with cells that reach beyond (docs/passage.md)"
        );
        return Some(Diagnostic::new(title).remedy(remedy));
    }
    if !ends.contains(&EndKind::Reflecting) {
        return None;
    }
    let along = family.along().unwrap_or_default();
    if along.iter().any(|system| !system.is_noisy(axis)) {
        let title = format!("no noise acts on `{name}`, which a wall that reflects needs");
        return Some(Diagnostic::new(title).remedy(
            "without noise a path would lie at the wall, with a share of all probability; put the wall on an axis with \
             noise, or let a stiff force keep the state inside",
        ));
    }
    let unsaid = |end: usize| ends[end] == EndKind::Reflecting && places[end].is_none();
    if let Some(end) = (0..2).find(|&end| unsaid(end)) {
        let title =
            format!("the wall of `{name}` stands where its cells end, and that is not said");
        let key = ["from", "to"][end];
        return Some(Diagnostic::new(title).remedy(format!("give `cells.{name}.{key}`")));
    }
    if draft.method.kind == MethodKind::Sgcm {
        let title = format!("`sgcm` knows no walls that reflect, as `{name}` has one");
        return Some(
            Diagnostic::new(title)
                .remedy("set `method.kind = \"generator\"`, or `\"monte-carlo\"`"),
        );
    }
    None
}

fn refuse(reader: &mut Reader<'_>, name: &str, found: Diagnostic) {
    let place = reader.place(&["system", "bounds", name]);
    reader.report(found.at(place, "these ends"));
}
