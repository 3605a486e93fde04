//! The fields of passages: numbers over all states in which a passage may start.

use super::given_regions::{Given, is_basin, refuse, region};
use crate::sweep_file::draft::{Draft, MethodKind, PassageDraft};
use crate::sweep_file::reader::Reader;
use crate::system::{FieldKind, FieldQuestion, PassageQuestion, Region};

/// A field of a passage, regions by their numbers.
pub(super) struct GivenField {
    name: String,
    kind: FieldKind,
    until: usize,
    exits: Vec<usize>,
    part: Option<usize>,
}

impl GivenField {
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
        }
    }
}

/// The fields of a passage: by the generator, and a committor between regions; `None` where they cannot be asked for.
pub(super) fn fields(
    reader: &mut Reader<'_>,
    (draft, passage): (&Draft, &PassageDraft),
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
                let (one, other) = (&given[from].text, &given[until].text);
                if is_basin(one) || is_basin(other) {
                    let title =
                        format!("passage `{name}` asks for a committor between basins of peaks");
                    refuse(reader, name, title, "give inequalities as `from` and `to`");
                    return None;
                }
                let either = format!("({one}) or ({other})");
                let own = ("from", format!("{name}_from_or_to"));
                let both = region(reader, given, name, own, &either);
                given[both].is_joined = true;
                add(array("committor"), (both, &[from, until]), Some(1));
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

/// What arrays call a region of several that end a passage.
fn exit_label(passage: &str, part: usize, given: &[Given], exits: &[usize]) -> String {
    let known = &given[exits[part]].name;
    match *known == PassageQuestion::exit_name(passage, part) {
        true => (part + 1).to_string(),
        false => known.clone(),
    }
}
