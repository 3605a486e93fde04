//! Questions of first passage: from where, until where. What they ask is solved in [`crate::passage`].

use super::Region;

/// A question of first passage, with names instead of values.
#[derive(Debug, Clone)]
pub struct PassageQuestion {
    /// Its name, with which its numbers' names begin.
    pub name: String,
    /// The region at whose border the process ends.
    pub until: Region,
    /// Parts of that region: the shares of the processes are wanted that end by entering each.
    pub exits: Vec<Region>,
    /// Where the process starts.
    pub start: PassageStart,
    /// Whether the rates between the regions of start and end are wanted, there and back.
    pub switching: bool,
    /// Either of the regions of start and end, where numbers of the transitions between them are wanted.
    pub transitions: Option<Region>,
    /// What is wanted as a field over the state where the process starts.
    pub fields: Vec<FieldQuestion>,
    /// Times at which the probability is wanted that the process still goes on, ascending.
    pub times: Vec<f64>,
    /// Shares of the processes, between 0 and 1, ascending: the times by which so many have ended are wanted.
    pub quantiles: Vec<f64>,
}

/// A region of which it is wanted how often it is visited, and for how long.
#[derive(Debug, Clone)]
pub struct VisitsQuestion {
    /// The name with which its numbers' names begin.
    pub name: String,
    /// The region.
    pub region: Region,
    /// What lies outside of it.
    pub outside: Region,
}

impl PassageQuestion {
    /// Whether it starts or ends in a region that is found in a density.
    pub(crate) fn has_basins(&self) -> bool {
        let start = match &self.start {
            PassageStart::Region(region) => region.basin(),
            PassageStart::State(_) | PassageStart::Density => None,
        };
        self.until.basin().or(start).is_some()
    }

    /// What columns call a part of the region that ends the passage: its name, or its number from 1 on where the
    /// question itself gives it.
    pub(crate) fn exit_label(&self, part: usize) -> String {
        let known = self.exits.get(part).map(Region::name);
        let number = (part + 1).to_string();
        match known {
            Some(name) if name != Self::exit_name(&self.name, part) => name.to_owned(),
            _ => number,
        }
    }

    /// The name of a part that has none.
    pub(crate) fn exit_name(passage: &str, part: usize) -> String {
        format!("{passage}_until_{}", part + 1)
    }
}

/// What a field of a passage is over the state where the process starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldKind {
    /// The mean time.
    MeanTime,
    /// The probability that one region is entered before others.
    Committor,
    /// The density of being on the way from one region to another.
    ReactiveDensity,
    /// A component of the current of processes on their way.
    ReactiveCurrent,
}

words! { FieldKind, pub name: MeanTime: "mean-time", Committor: "committor", ReactiveDensity: "reactive-density",
ReactiveCurrent: "reactive-current" }

impl FieldKind {
    /// Whether it is of transitions.
    pub(crate) fn is_reactive(self) -> bool {
        matches!(self, Self::ReactiveDensity | Self::ReactiveCurrent)
    }
}

/// A field of a passage over the state where the process starts.
#[derive(Debug, Clone)]
pub struct FieldQuestion {
    /// Its name, that of its array: `exit_mean_time`, `exit_committor`.
    pub name: String,
    /// What it is.
    pub kind: FieldKind,
    /// The region at whose border the process ends.
    pub until: Region,
    /// Parts of that region.
    pub exits: Vec<Region>,
    /// The part whose probability is wanted, of a committor.
    pub part: Option<usize>,
    /// The axis, of a component of a current.
    pub axis: Option<usize>,
}

/// A level of a measure of the sweep: the values of the parameter are wanted at which the measure crosses it.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasureLevel {
    /// The measure's name, its column in `points.csv`: `exit_mean`, `sd_x`.
    pub measure: String,
    /// The level, in the measure's unit.
    pub level: f64,
}

/// Where a process starts.
#[derive(Debug, Clone)]
pub enum PassageStart {
    /// At a state: one coordinate an axis.
    State(Vec<f64>),
    /// In a region, as the steady state is spread there.
    Region(Region),
    /// As the steady state is spread, outside of the region that ends the passage.
    Density,
}
