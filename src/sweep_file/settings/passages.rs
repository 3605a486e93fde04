//! Regions and questions of first passage as a file has them, with the place of everything that is wrong with them.

use super::given_regions::{Given, is_basin, named as named_regions, read_all, refuse, region};
use super::passage_fields::{GivenField, fields, transitions};
use crate::density::Observable;
use crate::formula::language::check_name;
use crate::sweep_file::diagnostic::Diagnostic;
use crate::sweep_file::draft::{Draft, MethodKind, PassageDraft};
use crate::sweep_file::names::quotable;
use crate::sweep_file::reader::Reader;
use crate::system::{Model, PassageQuestion, PassageStart, Region, joined_names};

/// The word for a start that is spread as the steady state is.
pub(super) const DENSITY: &str = "density";

/// Checks `[regions]` and `[passage]`: the regions with names, and the questions.
pub(super) fn read(
    reader: &mut Reader<'_>,
    draft: &Draft,
    model: &Model,
    watched: &[Observable],
) -> (Vec<Region>, Vec<PassageQuestion>) {
    let mut given = named_regions(reader, draft);
    let named = given.len();
    check_method(reader, draft);
    if model.phase_axis().is_some()
        && let Some(first) = draft.passages.first()
    {
        let title = "times of first passage are not worked out under a periodic force";
        let found = Diagnostic::new(title).remedy("leave [passage] out, or the force");
        let place = reader.key_place(&["passage", &first.name]);
        reader.report(found.at(place, "this passage"));
        return (Vec::new(), Vec::new());
    }
    let mut asked = Vec::new();
    for passage in &draft.passages {
        if !check_name(&passage.name) {
            let title = format!("`{}` cannot name a passage", quotable(&passage.name));
            let remedy =
                "take letters, digits and `_`, a letter first: columns are called after it";
            refuse(reader, &passage.name, title, remedy);
            continue;
        }
        if let Some(ends) = ends(reader, (draft, passage), &mut given, model) {
            asked.push((passage, ends));
        }
    }
    let Some(read) = read_all(reader, model, &given, named) else {
        return (Vec::new(), Vec::new());
    };
    let questions = asked.into_iter().map(
        |(
            passage,
            Ends {
                until,
                exits,
                start,
                fields,
                transitions,
            },
        )| PassageQuestion {
            name: passage.name.clone(),
            until: read[until].clone(),
            exits: exits.into_iter().map(|part| read[part].clone()).collect(),
            fields: fields
                .into_iter()
                .map(|field| field.question(&read))
                .collect(),
            start: match start {
                GivenStart::State(state) => PassageStart::State(state),
                GivenStart::Region(region) => PassageStart::Region(read[region].clone()),
                GivenStart::Density => PassageStart::Density,
            },
            switching: passage.switching == Some(true),
            transitions: transitions.map(|either| read[either].clone()),
            times: times(reader, passage),
            quantiles: ascending(passage.quantiles.as_ref()),
        },
    );
    let questions: Vec<PassageQuestion> = questions.collect();
    for question in &questions {
        check_basins(reader, (draft, model), question, watched);
    }
    (read.into_iter().take(named).collect(), questions)
}

/// What is found in a density is known to the generator at each value, where that is watched.
fn check_basins(
    reader: &mut Reader<'_>,
    (draft, model): (&Draft, &Model),
    question: &PassageQuestion,
    watched: &[Observable],
) {
    let start = match &question.start {
        PassageStart::Region(region) => Some(region),
        PassageStart::State(_) | PassageStart::Density => None,
    };
    let basins = [Some(&question.until), start]
        .into_iter()
        .flatten()
        .filter_map(Region::basin);
    for basin in basins {
        let (first, second) = basin.axes;
        let names: Vec<&str> = [Some(first), second]
            .into_iter()
            .flatten()
            .map(|axis| model.axes[axis].name.as_str())
            .collect();
        let (name, density) = (&question.name, joined_names(&names));
        let is_watched = watched.contains(&basin.observable());
        let (title, remedy) = if draft.method.kind != MethodKind::Generator {
            let title = format!(
                "passage `{name}` has a region that is found in a density, which `generator` does alone"
            );
            (
                title,
                "set `method.kind = \"generator\"`, or give an inequality".to_owned(),
            )
        } else if !question.fields.is_empty() || question.switching {
            let title = format!(
                "passage `{name}` has a region that is found in a density, and asks for fields or rates between states"
            );
            (
                title,
                "give inequalities, or leave `fields` and `switching` out".to_owned(),
            )
        } else if !is_watched {
            let title = format!(
                "passage `{name}` has a region that is found in the density of `{density}`, which is not watched"
            );
            let remedy = match names[..] {
                [one, other] => format!("add [\"{one}\", \"{other}\"] to `detect.joint`"),
                _ => format!("add \"{density}\" to `detect.marginals`"),
            };
            (title, remedy)
        } else {
            continue;
        };
        refuse(reader, name, title, &remedy);
        return;
    }
}

/// Numbers in their order, each once.
/// Times of a passage: those that are listed, and those of its curve.
fn times(reader: &mut Reader<'_>, passage: &PassageDraft) -> Vec<f64> {
    let mut all = passage.times.clone().unwrap_or_default();
    let asked = &passage.survival;
    match (asked.from, asked.to) {
        (Some(from), Some(to)) if from < to => {
            let last = asked.count.unwrap_or(TIMES_OF_A_CURVE) - 1;
            let step = (to / from).ln() / last as f64;
            all.extend(
                (0..=last).map(|number| in_three_digits(from * (step * number as f64).exp())),
            );
        }
        (None, None) if asked.count.is_none() => {}
        _ => {
            let title = format!("the curve of passage `{}` has no times", passage.name);
            let remedy =
                "give the first and a later last one, as in `survival = { from = 1, to = 1000 }`";
            refuse(reader, &passage.name, title, remedy);
        }
    }
    ascending(Some(&all))
}

/// Times of a curve where their number is not given.
const TIMES_OF_A_CURVE: usize = 36;

/// A positive number with three digits: columns are called after it.
fn in_three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

fn ascending(given: Option<&Vec<f64>>) -> Vec<f64> {
    let mut all = given.cloned().unwrap_or_default();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Transitions are counted on long trajectories, or follow from the generator: a path of a cell map does not know in
/// which of two regions it was last.
fn check_method(reader: &mut Reader<'_>, draft: &Draft) {
    let has_transitions = |passage: &&PassageDraft| passage.transitions == Some(true);
    let first = draft.passages.iter().find(has_transitions);
    let Some(first) = first.filter(|_| draft.method.kind == MethodKind::Sgcm) else {
        return;
    };
    let title = format!(
        "transitions of passage `{}` are worked out by `generator` and `monte-carlo`, not by `sgcm`",
        first.name
    );
    let remedy = "set `method.kind = \"generator\"`, or `\"monte-carlo\"`";
    let diagnostic = Diagnostic::new(title).remedy(remedy);
    let place = reader.key_place(&["passage", &first.name]);
    reader.report(diagnostic.at(place, "this passage"));
}

/// What a passage is between, regions by their numbers among those that are given.
struct Ends {
    until: usize,
    exits: Vec<usize>,
    start: GivenStart,
    fields: Vec<GivenField>,
    /// Either of the regions of start and end, where transitions are asked for.
    transitions: Option<usize>,
}

/// Where a passage starts.
enum GivenStart {
    State(Vec<f64>),
    Region(usize),
    Density,
}

/// The region that ends a passage, and its start; `None` where something is missing or said twice.
fn ends(
    reader: &mut Reader<'_>,
    (draft, passage): (&Draft, &PassageDraft),
    given: &mut Vec<Given>,
    model: &Model,
) -> Option<Ends> {
    let name = passage.name.as_str();
    let mut exits = Vec::new();
    // Any of several regions ends the passage.
    let either = passage.exits.as_ref().map(|parts| {
        let texts = parts.iter().enumerate().map(|(part, text)| {
            let own = PassageQuestion::exit_name(name, part);
            let number = region(reader, given, name, ("until", own), text);
            exits.push(number);
            format!("({text})")
        });
        texts.collect::<Vec<_>>().join(" or ")
    });
    if exits.iter().any(|&part| is_basin(&given[part].text)) {
        let title = format!(
            "passage `{name}` has a region that is found in a density among several regions"
        );
        refuse(
            reader,
            name,
            title,
            "give inequalities, or the found region alone",
        );
        return None;
    }
    let (word, until) = match (either.as_ref().or(passage.until.as_ref()), &passage.to) {
        (Some(until), None) => ("until", until),
        (None, Some(to)) => ("to", to),
        (until, _) => {
            let title = match until {
                Some(_) => format!("passage `{name}` has `until` and `to`, which mean the same"),
                None => format!("passage `{name}` does not say where it ends"),
            };
            refuse(
                reader,
                name,
                title,
                "give `until`: a region, or an inequality such as `\"abs(x) > 2\"`",
            );
            return None;
        }
    };
    let until = region(reader, given, name, (word, format!("{name}_{word}")), until);
    given[until].is_joined |= either.is_some();
    let start = match (&passage.from, passage.start.is_empty()) {
        (Some(from), true) if from.trim() == DENSITY => GivenStart::Density,
        (Some(from), true) => {
            let own = ("from", format!("{name}_from"));
            GivenStart::Region(region(reader, given, name, own, from))
        }
        (None, false) => GivenStart::State(state(reader, passage, model)?),
        (from, _) => {
            let title = match from {
                Some(_) => format!("passage `{name}` has `from` and `start`: one is enough"),
                None => format!("passage `{name}` does not say where it starts"),
            };
            let axes = model.axes.iter().map(|axis| format!("{} = 0", axis.name));
            let state = axes.collect::<Vec<_>>().join(", ");
            let remedy =
                format!("give `from`, a region or `\"density\"`, or `start = {{ {state} }}`");
            refuse(reader, name, title, &remedy);
            return None;
        }
    };
    if passage.switching == Some(true) && !may_switch(reader, draft, passage, &start) {
        return None;
    }
    let from = match start {
        GivenStart::Region(from) => Some(from),
        GivenStart::State(_) | GivenStart::Density => None,
    };
    let of = (draft, passage, model);
    let fields = fields(reader, of, given, (until, &exits, from))?;
    let asked = passage.transitions == Some(true);
    let transitions = match asked || fields.iter().any(GivenField::is_reactive) {
        true => Some(transitions(reader, passage, given, (until, from))?),
        false => None,
    };
    Some(Ends {
        until,
        exits,
        start,
        fields,
        transitions,
    })
}

/// Whether rates between two states can be asked for: by the generator, of a passage between regions.
fn may_switch(
    reader: &mut Reader<'_>,
    draft: &Draft,
    passage: &PassageDraft,
    start: &GivenStart,
) -> bool {
    let name = passage.name.as_str();
    if draft.method.kind != MethodKind::Generator {
        let method = draft.method.kind.name();
        let title =
            format!("rates between states are worked out by `generator`, not by `{method}`");
        let remedy = "set `method.kind = \"generator\"`, or leave `switching` out";
        refuse(reader, name, title, remedy);
        return false;
    }
    if !matches!(start, GivenStart::Region(_)) || passage.exits.is_some() {
        let title =
            format!("passage `{name}` has `switching`, and is not from one region to another");
        let remedy =
            "give the two states as `from` and `to`: regions, such as `from = \"x < -0.5\"`";
        refuse(reader, name, title, remedy);
        return false;
    }
    true
}

/// The state in which a passage starts.
fn state(reader: &mut Reader<'_>, passage: &PassageDraft, model: &Model) -> Option<Vec<f64>> {
    let known = |axis: &str| passage.start.iter().find(|(name, _)| name == axis);
    let is_axis = |name: &str| model.axes.iter().any(|axis| axis.name == name);
    if let Some((wrong, _)) = passage.start.iter().find(|(name, _)| !is_axis(name)) {
        let title = format!("`{wrong}` is no coordinate of the state");
        let names: Vec<&str> = model.axes.iter().map(|axis| axis.name.as_str()).collect();
        let place = reader.key_place(&["passage", &passage.name, "start", wrong]);
        let diagnostic = Diagnostic::new(title).nearest(wrong, names);
        reader.report(diagnostic.at(place, "no axis"));
        return None;
    }
    let state = model
        .axes
        .iter()
        .map(|axis| known(&axis.name).map(|(_, x)| *x));
    let found: Option<Vec<f64>> = state.collect();
    if found.is_none() {
        let missing = model.axes.iter().find(|axis| known(&axis.name).is_none());
        let missing = missing.map_or("", |axis| axis.name.as_str());
        let title = format!("the start of passage `{}` lacks `{missing}`", passage.name);
        refuse(
            reader,
            &passage.name,
            title,
            "give a coordinate for every axis",
        );
    }
    found
}
