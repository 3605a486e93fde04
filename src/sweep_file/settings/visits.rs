//! Regions of which a file wants to know how often they are visited.

use super::given_regions::{Given, is_basin, named, read_all, region_at};
use crate::formula::language::check_name;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::{Draft, MethodKind};
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::system::{Model, VisitsQuestion};

/// Checks `[visits]`.
pub(super) fn read(reader: &mut Reader<'_>, draft: &Draft, model: &Model) -> Vec<VisitsQuestion> {
    let Some((first, _)) = draft.visits.first() else {
        return Vec::new();
    };
    let refused = if draft.method.kind == MethodKind::Sgcm && model.phase_axis().is_some() {
        Some((
            "visits of a forced system are worked out by `generator` and `monte-carlo`, not by `sgcm`".to_owned(),
            "set `method.kind = \"generator\"`, or `\"monte-carlo\"`",
        ))
    } else if model.axes.len() < 2 {
        Some((
            "noise acts across every border of a system with one axis, which is crossed infinitely often".to_owned(),
            "ask for transitions between two regions that do not touch: `[passage]` with `transitions = \"on\"`",
        ))
    } else {
        None
    };
    if let Some((title, remedy)) = refused {
        refuse(reader, first, title, remedy);
        return Vec::new();
    }
    let mut given = named(reader, draft);
    let count = given.len();
    let mut asked = Vec::new();
    for (name, text) in &draft.visits {
        if !check_name(name) {
            let title = format!("`{}` cannot name visits", quotable(name));
            let remedy =
                "take letters, digits and `_`, a letter first: columns are called after it";
            refuse(reader, name, title, remedy);
        } else if is_found(&given, text) {
            let title = format!("visits `{name}` are of a region that is found in a density");
            refuse(
                reader,
                name,
                title,
                "give an inequality, such as `\"x > 0\"`",
            );
        } else {
            let own = format!("{name}_visits");
            let path = ["visits", name];
            let inside = region_at(reader, &mut given, &path, own, text);
            let (out, text) = (
                format!("{name}_outside"),
                format!("not ({})", given[inside].text),
            );
            let outside = region_at(reader, &mut given, &path, out, &text);
            given[outside].is_joined = true;
            asked.push((name, inside, outside));
        }
    }
    let Some(read) = read_all(reader, model, &given, count) else {
        return Vec::new();
    };
    let questions = asked
        .into_iter()
        .map(|(name, inside, outside)| VisitsQuestion {
            name: name.clone(),
            region: read[inside].clone(),
            outside: read[outside].clone(),
        });
    questions.collect()
}

/// Whether a region, given by its name or as an inequality, is found in a density.
fn is_found(given: &[Given], text: &str) -> bool {
    let named = given.iter().find(|one| one.name == text.trim());
    is_basin(named.map_or(text, |one| one.text.as_str()))
}

fn refuse(reader: &mut Reader<'_>, name: &str, title: String, remedy: &str) {
    let place = reader.key_place(&["visits", name]);
    reader.report(
        Diagnostic::new(title)
            .remedy(remedy)
            .at(place, "these visits"),
    );
}
