//! The fields of passages: numbers over all states in which a passage may start.

use super::given_regions::{Given, either, is_basin, refuse};
use crate::sweep_file::draft::{Draft, MethodKind, PassageDraft};
use crate::sweep_file::reader::Reader;
use crate::system::{FieldKind, FieldQuestion, Model, PassageQuestion, Region};

/// A field of a passage, regions by their numbers.
pub(super) struct GivenField {
    name: String,
    kind: FieldKind,
    until: usize,
    exits: Vec<usize>,
    part: Option<usize>,
    axis: Option<usize>,
}

impl GivenField {
    pub(super) fn is_reactive(&self) -> bool {
        self.kind.is_reactive()
    }

    pub(super) fn question(self, read: &[Region]) -> FieldQuestion {
        FieldQuestion {
            name: self.name,
            kind: self.kind,
            until: read[self.until].clone(),
            exits: self
                .exits
                .into_iter()
                .map(|part| read[part].clone())
                .collect(),
            part: self.part,
            axis: self.axis,
        }
    }
}

/// The fields of a passage of a model: by the generator, and a committor or transitions between regions; `None` where
/// they cannot be asked for.
pub(super) fn fields(
    reader: &mut Reader<'_>,
    (draft, passage, model): (&Draft, &PassageDraft, &Model),
    given: &mut Vec<Given>,
    (until, exits, from): (usize, &[usize], Option<usize>),
) -> Option<Vec<GivenField>> {
    let (name, mut all) = (passage.name.as_str(), Vec::new());
    let asked = passage.fields.iter().flatten();
    if asked.clone().next().is_some() && draft.method.kind != MethodKind::Generator {
        let method = draft.method.kind.name();
        let title = format!("fields of passages are worked out by `generator`, not by `{method}`");
        let remedy = "set `method.kind = \"generator\"`, or leave `fields` out";
        refuse(reader, name, title, remedy);
        return None;
    }
    for kind in FieldKind::ALL
        .into_iter()
        .filter(|kind| asked.clone().any(|one| one == kind))
    {
        let array = |of: &str| format!("{name}_{of}");
        let mut add = |name, (until, exits): (usize, &[usize]), part| {
            let exits = exits.to_vec();
            all.push(GivenField {
                name,
                kind,
                until,
                exits,
                part,
                axis: None,
            });
        };
        match (kind, from) {
            (FieldKind::MeanTime, _) => add(array("mean_time"), (until, &[]), None),
            (FieldKind::Committor, _) if !exits.is_empty() => {
                for part in 0..exits.len() {
                    let of = format!("{}_committor", exit_label(name, part, given, exits));
                    add(array(&of), (until, exits), Some(part));
                }
            }
            (FieldKind::Committor, Some(from)) => {
                if is_basin(&given[from].text) || is_basin(&given[until].text) {
                    let title = format!(
                        "passage `{name}` asks for a committor between regions that are found in a density"
                    );
                    refuse(reader, name, title, "give inequalities as `from` and `to`");
                    return None;
                }
                let both = either(reader, given, name, [from, until]);
                add(array("committor"), (both, &[from, until]), Some(1));
            }
            (FieldKind::ReactiveDensity | FieldKind::ReactiveCurrent, from) => {
                let both = transitions(reader, passage, given, (until, from))?;
                let exits = from.map_or_else(Vec::new, |from| vec![from, until]);
                let mut add = |name, axis| {
                    all.push(GivenField {
                        name,
                        kind,
                        until: both,
                        exits: exits.clone(),
                        part: None,
                        axis,
                    });
                };
                if kind == FieldKind::ReactiveDensity {
                    add(array("reactive_density"), None);
                } else {
                    for (number, axis) in model.axes.iter().enumerate() {
                        add(
                            array(&format!("reactive_current_{}", axis.name)),
                            Some(number),
                        );
                    }
                }
            }
            (FieldKind::Committor, _) => {
                let title =
                    format!("passage `{name}` asks for a committor, and is not between regions");
                let remedy = "give the two regions as `from` and `to`, or as a list of `until`";
                refuse(reader, name, title, remedy);
                return None;
            }
        }
    }
    Some(all)
}

/// Either of the regions between which a passage has transitions, from one inequality to another; `None` where they
/// cannot be asked for.
pub(super) fn transitions(
    reader: &mut Reader<'_>,
    passage: &PassageDraft,
    given: &mut Vec<Given>,
    (until, from): (usize, Option<usize>),
) -> Option<usize> {
    let name = passage.name.as_str();
    let (title, remedy) = match from {
        Some(from) if passage.exits.is_none() => {
            if !is_basin(&given[from].text) && !is_basin(&given[until].text) {
                return Some(either(reader, given, name, [from, until]));
            }
            (
                format!(
                    "passage `{name}` asks for transitions between regions that are found in a density"
                ),
                "give inequalities as `from` and `to`",
            )
        }
        _ => (
            format!("passage `{name}` asks for transitions, and is not from one region to another"),
            "give the two regions as `from` and `to`, such as `from = \"x < -0.5\"`",
        ),
    };
    refuse(reader, name, title, remedy);
    None
}

/// What arrays call a region of several that end a passage.
fn exit_label(passage: &str, part: usize, given: &[Given], exits: &[usize]) -> String {
    let known = &given[exits[part]].name;
    match *known == PassageQuestion::exit_name(passage, part) {
        true => (part + 1).to_string(),
        false => known.clone(),
    }
}
