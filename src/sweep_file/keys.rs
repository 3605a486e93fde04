//! Every key of a sweep file: path, kind of value, default, meaning. The only list: messages about unknown
//! keys, the long help and `docs/sweep-file.md` are made from it.
//!
//! Defaults that a program option has are taken from that option's `Default`, so they stand in one place.

use crate::continuation::LocateOptions;
use crate::figure::Format;
use crate::generator::AdvectiveScheme;
use crate::method::{
    Correction, Estimator, GeneratorMethodOptions, MethodOptions, MonteCarloOptions, SgcmOptions,
    StepChoice,
};
use crate::sampling::Integrator;
use crate::stationary::Solver;
use crate::system::registry;
use crate::topology::DetectOptions;

use super::diagnostic::list;

/// Condition on a number, in words and as a test. Numbers are always finite.
#[derive(Debug, Clone, Copy)]
pub(super) struct Condition {
    /// Words that complete "a finite number".
    pub(super) words: &'static str,
    /// The test.
    pub(super) holds: fn(f64) -> bool,
}

const ANY: Condition = Condition {
    words: "",
    holds: |_| true,
};
const POSITIVE: Condition = Condition {
    words: " greater than zero",
    holds: |value| value > 0.0,
};
const OPEN_UNIT: Condition = Condition {
    words: " between 0 and 1, both excluded",
    holds: |value| value > 0.0 && value < 1.0,
};
const SHARE: Condition = Condition {
    words: " from 0 to below 1",
    holds: |value| (0.0..1.0).contains(&value),
};
const UP_TO_ONE: Condition = Condition {
    words: " above 0, at most 1",
    holds: |value| value > 0.0 && value <= 1.0,
};

/// Kind of value a key takes.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// A string.
    Text,
    /// A finite number.
    Number(Condition),
    /// An integer from the first to the second value.
    Integer(i128, i128),
    /// A number greater than zero, or "auto".
    Step,
    /// One of some strings.
    Choice(fn() -> Vec<&'static str>),
    /// A list of finite numbers.
    Numbers,
    /// A list of strings.
    Texts,
    /// A list of pairs of strings.
    Pairs,
    /// A list of some of these strings.
    Choices(fn() -> Vec<&'static str>),
}

impl Kind {
    /// What is allowed, in words.
    pub(super) fn words(self) -> String {
        match self {
            Self::Text => "a string".to_owned(),
            Self::Number(condition) => format!("a finite number{}", condition.words),
            Self::Integer(least, most) if most == i128::from(i64::MAX) => {
                format!("an integer, {least} or more")
            }
            Self::Integer(least, most) => format!("an integer from {least} to {most}"),
            Self::Step => "a finite number greater than zero, or `\"auto\"`".to_owned(),
            Self::Choice(names) => format!("a string: {}", list(&names())),
            Self::Numbers => "a list of finite numbers, such as `[0.5, 1.0]`".to_owned(),
            Self::Texts => "a list of strings, such as `[\"x\", \"y\"]`".to_owned(),
            Self::Pairs => "a list of pairs of strings, such as `[[\"x\", \"y\"]]`".to_owned(),
            Self::Choices(names) => format!("a list of strings: {}", list(&names())),
        }
    }
}

/// What holds when a key is left out.
#[derive(Debug, Clone, Copy)]
pub(super) enum KeyDefault {
    /// It must be given.
    Required,
    /// This value, as TOML.
    Value(fn() -> String),
    /// A rule in words.
    Rule(&'static str),
}

/// One key.
#[derive(Debug, Clone, Copy)]
pub(super) struct Key {
    /// Path with dots; `<…>` stands for a name of the model.
    pub(super) path: &'static str,
    /// Kind of value.
    pub(super) kind: Kind,
    /// What holds when it is left out.
    pub(super) default: KeyDefault,
    /// Meaning in words.
    pub(super) meaning: &'static str,
}

/// Most cells an axis may have: edges are stored, so a slip of the pen must not fill the memory.
const MOST_CELLS: i128 = 1_000_000;

/// Shorthand for a row of the table.
const fn key(path: &'static str, kind: Kind, default: KeyDefault, meaning: &'static str) -> Key {
    Key {
        path,
        kind,
        default,
        meaning,
    }
}

/// Every key, in the order in which a file is best read.
#[rustfmt::skip]
pub(super) static KEYS: &[Key] = &[
    key("title", Kind::Text, KeyDefault::Rule("the model's title and the swept parameter"),
        "Title of the run, used in tables and figures."),
    key("system.model", Kind::Choice(model_names), KeyDefault::Required,
        "The model; `pbif systems` lists them, `pbif systems NAME` shows one."),
    key("system.parameters.<parameter>", Kind::Number(ANY), KeyDefault::Rule("the model's default, where it has one"),
        "Value of a parameter of the model. The swept parameter is left out."),
    key("sweep.parameter", Kind::Text, KeyDefault::Required,
        "Name of the parameter that is swept."),
    key("sweep.from", Kind::Number(ANY), KeyDefault::Required,
        "First value of the swept parameter."),
    key("sweep.to", Kind::Number(ANY), KeyDefault::Required,
        "Last value; it may lie below the first."),
    key("sweep.points", Kind::Integer(2, 1_000_000), KeyDefault::Required,
        "Number of parameter values, both ends included, evenly spaced."),
    key("cells.<axis>.range", Kind::Choice(automatic), KeyDefault::Rule("`from` and `to`"),
        "`auto` finds a range that holds the density all along the sweep by a few free trajectories; `from` and `to` are then left out."),
    key("cells.<axis>.from", Kind::Number(ANY), KeyDefault::Rule("the model's bound, where it knows one"),
        "Lower end of the domain along an axis."),
    key("cells.<axis>.to", Kind::Number(ANY), KeyDefault::Rule("the model's bound, where it knows one"),
        "Upper end of the domain along an axis."),
    key("cells.<axis>.count", Kind::Integer(2, MOST_CELLS), KeyDefault::Required,
        "Number of cells along an axis. An even number puts a face in the middle."),
    key("cells.<axis>.grade", Kind::Choice(automatic), KeyDefault::Rule("cells of equal width"),
        "`auto` narrows the cells toward the model's switching surfaces, to a quarter of the layer that holds the kink of the density; or a table with `at` and `smallest`."),
    key("cells.<axis>.grade.at", Kind::Numbers, KeyDefault::Rule("cells of equal width"),
        "Points toward which the cells get narrower, inside the range; a face falls on each."),
    key("cells.<axis>.grade.smallest", Kind::Number(POSITIVE), KeyDefault::Rule("cells of equal width"),
        "Width of the cells at these points; below the width without grading."),
    key("method.kind", Kind::Choice(method_names), KeyDefault::Value(|| quoted(MethodOptions::default().kind())),
        "How the steady-state density is computed: by the generator of the cell map, solved directly, by `sgcm`, stochastic generalized cell mapping, or by `monte-carlo`, counting free trajectories."),
    key("method.scheme", Kind::Choice(scheme_names), KeyDefault::Value(|| quoted(generator().scheme.name())),
        "generator: how advective fluxes are reconstructed. The central schemes are more accurate on fine grids and less robust on coarse ones."),
    key("method.memory_limit", Kind::Number(POSITIVE), KeyDefault::Value(|| number(generator().memory_limit)),
        "generator: gigabytes that factors may take; beyond, a smaller factorisation preconditions."),
    key("method.map_step", Kind::Step, KeyDefault::Value(|| step(sgcm().map_step)),
        "sgcm: time that one transition of the cell map spans. Longer steps mean less numerical diffusion."),
    key("method.time_step", Kind::Step, KeyDefault::Value(|| step(sgcm().time_step)),
        "sgcm, monte-carlo: step of the trajectory integrator; by sgcm it must not exceed `map_step`. Its bias is found by halving it, and stated."),
    key("method.samples", Kind::Integer(2, u32::MAX as i128), KeyDefault::Value(|| sgcm().samples.to_string()),
        "sgcm: trajectories started in each cell."),
    key("method.seed", Kind::Integer(0, i64::MAX as i128), KeyDefault::Value(|| sgcm().seed.to_string()),
        "sgcm, monte-carlo: seed of the random streams; the same seed gives the same numbers bit for bit."),
    key("method.integrator", Kind::Choice(integrator_names), KeyDefault::Value(|| quoted(sgcm().integrator.name())),
        "sgcm, monte-carlo: integrator of the trajectories. `euler-maruyama` takes ω²·time_step away from the damping."),
    key("method.replicates", Kind::Integer(2, 256), KeyDefault::Value(|| sgcm().replicates.to_string()),
        "sgcm: groups the samples are split into to estimate the sampling error; at most `samples`."),
    key("method.correction", Kind::Choice(correction_names), KeyDefault::Value(|| quoted(sgcm().correction.name())),
        "sgcm: `slope` lets the density vary linearly inside cells, which removes nearly all numerical diffusion; `none` is the method of the paper."),
    key("method.solver", Kind::Choice(solver_names), KeyDefault::Value(|| quoted(sgcm().solver.name())),
        "sgcm: solver of the steady state: multilevel aggregation, or power iteration."),
    key("method.estimator", Kind::Choice(estimator_names), KeyDefault::Value(|| quoted(monte_carlo().estimator.name())),
        "monte-carlo: `ergodic` averages long trajectories over time, `ensemble` counts many trajectories, started all over the domain, at one time."),
    key("method.error", Kind::Number(OPEN_UNIT), KeyDefault::Value(|| number(monte_carlo().error)),
        "monte-carlo: wanted relative standard error of the variance of every axis; what is `\"auto\"` is chosen for it."),
    key("method.burn_in", Kind::Step, KeyDefault::Value(|| step(monte_carlo().burn_in)),
        "monte-carlo: time before states are counted (ensemble: at which they are counted); twelve autocorrelation times by itself."),
    key("method.length", Kind::Step, KeyDefault::Value(|| step(monte_carlo().length)),
        "monte-carlo, ergodic: time during which the states of one trajectory are counted; chosen for `error` by itself."),
    key("method.trajectories", Kind::Step, KeyDefault::Value(|| step(monte_carlo().trajectories)),
        "monte-carlo: trajectories, rounded up to a multiple of 64; 2048 by themselves, in an ensemble as many as `error` takes."),
    key("method.solver_tolerance", Kind::Number(OPEN_UNIT), KeyDefault::Rule("`1e-8` by the generator, `1e-10` by sgcm"),
        "L1 error of the cell masses at which the solver stops."),
    key("method.escape_limit", Kind::Number(UP_TO_ONE), KeyDefault::Value(|| number(sgcm().escape_limit)),
        "Largest share of the mass that may leave the domain within one relaxation time before there is said to be no steady state."),
    key("detect.marginals", Kind::Texts, KeyDefault::Rule("every axis"),
        "Axes whose marginal densities are watched for changes."),
    key("detect.joint", Kind::Pairs, KeyDefault::Rule("the first two axes"),
        "Pairs of axes whose joint densities are watched for changes."),
    key("detect.confidence", Kind::Number(OPEN_UNIT), KeyDefault::Value(|| number(DetectOptions::default().confidence)),
        "Probability that no peak or crater of the whole sweep is sampling noise."),
    key("detect.floor", Kind::Number(SHARE), KeyDefault::Value(|| number(DetectOptions::default().floor)),
        "Smallest persistence that counts, as a share of the density's maximum."),
    key("locate.tolerance", Kind::Number(POSITIVE), KeyDefault::Value(|| number(LocateOptions::default().tolerance)),
        "Wanted width of a P-bifurcation's bracket, in units of the swept parameter."),
    key("locate.largest_distance", Kind::Number(SHARE), KeyDefault::Value(|| number(LocateOptions::default().largest_distance)),
        "Hellinger distance between neighbouring densities above which a value between them is solved too."),
    key("locate.grid_check", Kind::Choice(switch), KeyDefault::Value(|| quoted(SWITCH[usize::from(!LocateOptions::default().grid_check)])),
        "Whether located values are checked on a finer grid (by methods without sampling)."),
    key("figures.at", Kind::Numbers, KeyDefault::Rule("both ends of the sweep and two points between"),
        "Parameter values at which joint densities and marginals are drawn, inside the sweep."),
    key("figures.formats", Kind::Choices(format_names), KeyDefault::Value(default_formats),
        "File formats of the figures."),
];

/// The words of a switch, the one for yes first.
pub(super) const SWITCH: [&str; 2] = ["on", "off"];

fn switch() -> Vec<&'static str> {
    SWITCH.to_vec()
}

fn generator() -> GeneratorMethodOptions {
    GeneratorMethodOptions::default()
}

fn sgcm() -> SgcmOptions {
    SgcmOptions::default()
}

fn monte_carlo() -> MonteCarloOptions {
    MonteCarloOptions::default()
}

fn correction_names() -> Vec<&'static str> {
    Correction::ALL.map(Correction::name).to_vec()
}

fn estimator_names() -> Vec<&'static str> {
    Estimator::ALL.map(Estimator::name).to_vec()
}

fn automatic() -> Vec<&'static str> {
    vec!["auto"]
}

fn model_names() -> Vec<&'static str> {
    let models = registry::models().iter();
    models.map(|model| model.name.as_str()).collect()
}

fn method_names() -> Vec<&'static str> {
    MethodOptions::KINDS.to_vec()
}

fn scheme_names() -> Vec<&'static str> {
    AdvectiveScheme::ALL.map(AdvectiveScheme::name).to_vec()
}

fn integrator_names() -> Vec<&'static str> {
    Integrator::ALL.map(Integrator::name).to_vec()
}

fn solver_names() -> Vec<&'static str> {
    Solver::ALL.map(Solver::name).to_vec()
}

fn format_names() -> Vec<&'static str> {
    Format::ALL.map(Format::name).to_vec()
}

fn default_formats() -> String {
    let names: Vec<String> = format_names().iter().map(|name| quoted(name)).collect();
    format!("[{}]", names.join(", "))
}

/// A string as TOML.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A finite number as a TOML float, with the digits that give the same bits again.
pub(super) fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A step as TOML.
pub(super) fn step(choice: StepChoice) -> String {
    match choice {
        StepChoice::Auto => quoted("auto"),
        StepChoice::Fixed(value) => number(value),
    }
}

impl Key {
    /// The parts of the path.
    pub(super) fn parts(&self) -> impl Iterator<Item = &'static str> {
        self.path.split('.')
    }

    /// Whether the path begins with these names; a part `<…>` matches every name.
    pub(super) fn starts_with(&self, names: &[&str]) -> bool {
        let mut parts = self.parts();
        names.iter().all(|name| {
            parts
                .next()
                .is_some_and(|part| part == *name || part.starts_with('<'))
        })
    }

    /// Whether the path is this one.
    pub(super) fn matches(&self, names: &[&str]) -> bool {
        self.parts().count() == names.len() && self.starts_with(names)
    }

    fn default_words(&self) -> String {
        match self.default {
            KeyDefault::Required => "required".to_owned(),
            KeyDefault::Value(value) => format!("`{}`", value()),
            KeyDefault::Rule(words) => words.to_owned(),
        }
    }
}

/// The key at a path.
pub(super) fn find(names: &[&str]) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.matches(names))
}

/// The table of `docs/sweep-file.md`.
#[cfg(test)]
pub(super) fn markdown() -> String {
    let mut text = "| key | value | default | meaning |\n| --- | --- | --- | --- |\n".to_owned();
    for key in KEYS {
        let (path, words, default) = (key.path, key.kind.words(), key.default_words());
        text += &format!("| `{path}` | {words} | {default} | {} |\n", key.meaning);
    }
    text
}

/// The keys for the long help of the commands that read a sweep file.
pub fn help() -> String {
    let mut text = "Keys of a sweep file (--set KEY=VALUE overrides any of them):\n".to_owned();
    for key in KEYS {
        let (path, words, default) = (key.path, key.kind.words(), key.default_words());
        text += &format!("\n  {path}\n      {}\n      {words}; ", key.meaning);
        text += &match key.default {
            KeyDefault::Required => default,
            _ => format!("default: {default}"),
        };
        text += "\n";
    }
    text.replace('`', "")
}

#[cfg(test)]
mod tests {
    use super::*;

    const BEGIN: &str = "<!-- keys: begin -->\n";
    const END: &str = "<!-- keys: end -->";

    /// `PBIF_BLESS=1 cargo test keys` writes the table anew.
    #[test]
    fn the_documentation_holds_the_table() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/sweep-file.md");
        let text = std::fs::read_to_string(path).unwrap();
        let (before, rest) = text.split_once(BEGIN).unwrap();
        let (table, after) = rest.split_once(END).unwrap();
        if std::env::var_os("PBIF_BLESS").is_some() {
            let fresh = format!("{before}{BEGIN}{}{END}{after}", markdown());
            std::fs::write(path, fresh).unwrap();
            return;
        }
        assert_eq!(table, markdown());
    }

    #[test]
    fn paths_match_names_of_the_model() {
        assert_eq!(
            find(&["cells", "z", "count"]).unwrap().path,
            "cells.<axis>.count"
        );
        assert!(find(&["cells", "z"]).is_none());
        assert!(find(&["sweep", "count"]).is_none());
    }

    #[test]
    fn no_key_is_listed_twice() {
        for (index, key) in KEYS.iter().enumerate() {
            assert!(KEYS[..index].iter().all(|other| other.path != key.path));
        }
    }
}
