//! Whether the cells hold the places at which passages start and end: a passage that has numbers at no value of a sweep
//! is told of before the sweep is solved.

use super::diagnostic::Diagnostic;
use super::draft::MethodKind;
use super::report::Report;
use super::settings::Settings;
use super::sweep::Sweep;
use super::verify::short;
use crate::continuation::evenly_spaced;
use crate::generator::levels;
use crate::space::CellSpace;
use crate::system::{ParameterValues, PassageQuestion, PassageStart, Region};

/// Values of the sweep at which regions are looked at.
const LOOKS: usize = 9;

/// How many of the cells a region holds.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    None,
    Some,
    All,
}

impl Sweep {
    /// What must be known of passages that start outside of the cells, or between regions without a cell at any value
    /// of the sweep: they have no numbers, and all else is solved. Free trajectories know no cells.
    pub(crate) fn passages_without_cells(&self) -> Report {
        let (settings, problem) = (&self.settings, &self.problem);
        if settings.method.kind != MethodKind::Generator {
            return Report::default();
        }
        let asked = problem.family().questions.passages.iter();
        let found = asked.filter_map(|passage| {
            let start = settings.start_outside(passage, problem.space());
            let start = start.or_else(|| settings.without_cells(passage, problem.space()));
            start.or_else(|| settings.start_in_target(passage))
        });
        settings.refuse_all(found.collect())
    }
}

impl Settings {
    /// What is wrong with the state in which a passage starts.
    fn start_outside(&self, passage: &PassageQuestion, space: &CellSpace) -> Option<Diagnostic> {
        let PassageStart::State(state) = &passage.start else {
            return None;
        };
        let mut axes = state.iter().zip(space.axes()).enumerate();
        let outside = axes.find(|(_, (place, axis))| {
            !axis.is_modes() && !(axis.from()..=axis.to()).contains(*place)
        });
        let (number, (place, axis)) = outside?;
        let (own, name) = (&passage.name, self.family.axis(number));
        let title = format!(
            "passage `{own}` starts at {name} = {}, outside of the cells",
            short(*place)
        );
        let found = Diagnostic::warning(title)
            .allowed(in_range(name, (axis.from(), axis.to())))
            .remedy(format!("start inside, or widen `cells.{name}`"));
        Some(self.at_passage(own, &["start", name], found))
    }

    /// What is wrong with a state in which a passage starts, and ends at every value of the sweep that is looked at.
    fn start_in_target(&self, passage: &PassageQuestion) -> Option<Diagnostic> {
        let PassageStart::State(state) = &passage.start else {
            return None;
        };
        let is_inside = |values: &ParameterValues| {
            let level = passage.until.level().bind(values);
            level.is_ok_and(|level| level.at(state) < 0.0)
        };
        let values = self.looked_at();
        if passage.until.basin().is_some() || values.is_empty() || !values.iter().all(is_inside) {
            return None;
        }
        let (own, until) = (&passage.name, passage.until.text());
        let title = format!("passage `{own}` starts inside `{until}`, where it ends");
        let found =
            Diagnostic::warning(title).remedy("start outside of the region that is waited for");
        Some(self.at_passage(own, &["start"], found))
    }

    /// What the parameters are at the values at which regions are looked at.
    fn looked_at(&self) -> Vec<ParameterValues> {
        let (from, to) = self.family.ends();
        let between = evenly_spaced((from, to), LOOKS).into_iter();
        let between = between.filter_map(|value| self.family.values_at(value).ok());
        between.chain(self.corners()).collect()
    }

    /// What is wrong with the regions of a passage.
    fn without_cells(&self, passage: &PassageQuestion, space: &CellSpace) -> Option<Diagnostic> {
        let start = match &passage.start {
            PassageStart::Region(region) => Some((&["from"][..], region)),
            PassageStart::State(_) | PassageStart::Density => None,
        };
        let regions = [Some((&["until", "to"][..], &passage.until)), start];
        let (own, swept) = (&passage.name, self.family.parameter());
        let ranges = space.axes().iter().enumerate();
        let ranges = ranges
            .filter(|(_, axis)| !axis.is_modes())
            .map(|(number, axis)| in_range(self.family.axis(number), (axis.from(), axis.to())));
        let ranges = ranges.collect::<Vec<_>>().join(", ");
        let found = |(words, region): (&[&str], &Region)| {
            let is_target = words.contains(&"until");
            let (title, remedy) = match self.held(region, space)? {
                Held::Some => return None,
                Held::All if !is_target => return None,
                Held::All => (
                    format!(
                        "passage `{own}` ends at once: all cells are inside `{}`, at every value of {swept}",
                        region.text()
                    ),
                    "wait for a region that leaves cells outside",
                ),
                Held::None => (
                    format!(
                        "no cell is inside `{}`, where passage `{own}` {}, at any value of {swept}",
                        region.text(),
                        if is_target { "ends" } else { "starts" }
                    ),
                    "widen the ranges in [cells] until a part of the region is inside, or change its inequality",
                ),
            };
            let found = Diagnostic::warning(title)
                .allowed(format!("regions with a part of the cells, {ranges}"))
                .remedy(remedy);
            Some(self.at_passage(own, words, found))
        };
        regions.into_iter().flatten().find_map(found)
    }

    /// At the first of some keys of a passage that the file has.
    fn at_passage(&self, passage: &str, words: &[&str], found: Diagnostic) -> Diagnostic {
        let root = &self.document.root;
        let whole = ["passage", passage];
        let path = |word: &[&str]| root.find(&[&whole[..], word].concat());
        let own = path(words).or_else(|| words.iter().find_map(|word| path(&[word])));
        match own.or_else(|| path(&[])) {
            Some(entry) => found.at(&entry.node.place, "of this passage"),
            None => found,
        }
    }

    /// How many cells a region holds where it holds most of what is looked for: some at any value, else none, or all.
    /// `None` for what is found in a density, and where it has no value.
    fn held(&self, region: &Region, space: &CellSpace) -> Option<Held> {
        if region.basin().is_some() {
            return None;
        }
        let held = |values: &ParameterValues| {
            let level = region.level().bind(values).ok()?;
            let levels = levels(space, &level).ok()?;
            let inside = levels.iter().filter(|level| **level < 0.0).count();
            Some(match inside {
                0 => Held::None,
                all if all == levels.len() => Held::All,
                _ => Held::Some,
            })
        };
        let all: Option<Vec<Held>> = self.looked_at().iter().map(held).collect();
        let all = all?;
        let first = *all.first()?;
        Some(if all.iter().all(|one| *one == first) {
            first
        } else {
            Held::Some
        })
    }
}

/// `x from -3 to 3`.
fn in_range(name: &str, (from, to): (f64, f64)) -> String {
    format!("{name} from {} to {}", short(from), short(to))
}
