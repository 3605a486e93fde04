//! What the field calls measures, where tables have words of their own: `sd_y` is the standard deviation of ẋ.

use super::names;
use crate::continuation::MeasureKind;
use crate::continuation::measure::{
    AMPLIFICATION, AMPLITUDE, DECAY_DISCRIMINANT, DEVIATION, DIVERGENCE, EXPONENT,
    PASSAGE_DEVIATION, PASSAGE_KRAMERS, PASSAGE_MEAN, PASSAGE_MELNIKOV, PASSAGE_QUANTILE,
    PASSAGE_SHARE, PASSAGE_SURVIVAL, SIGNAL_TO_NOISE, SOJOURN, SPECTRAL_PEAK, TIME_SHARE,
    TIME_STEP_BIAS, TURN_DIFFUSION, VELOCITY, VISITS,
};
use crate::density::Observable;
use crate::figure::canvas::symbols;
use crate::system::Family;

/// Words of measures that the field calls otherwise than tables do.
const TITLES: [(MeasureKind, &str); 21] = [
    (PASSAGE_MEAN, "mean time"),
    (PASSAGE_DEVIATION, "standard deviation"),
    (PASSAGE_KRAMERS, "Kramers' rate"),
    (PASSAGE_MELNIKOV, "Mel'nikov's rate"),
    (PASSAGE_SURVIVAL, "probability to last longer than"),
    (PASSAGE_QUANTILE, "time quantile"),
    (TIME_SHARE, "share of the time"),
    (VISITS, "visits per unit of time"),
    (SOJOURN, "mean time of a visit"),
    (PASSAGE_SHARE, "share that ends in"),
    (DEVIATION, "standard deviation"),
    (EXPONENT, "largest Lyapunov exponent"),
    (DIVERGENCE, "sum of the Lyapunov exponents"),
    (VELOCITY, "mean velocity"),
    (TURN_DIFFUSION, "effective diffusion"),
    (AMPLITUDE, "amplitude of the mean"),
    (AMPLIFICATION, "spectral amplification"),
    (SIGNAL_TO_NOISE, "signal-to-noise ratio"),
    (DECAY_DISCRIMINANT, "discriminant of the slowest modes"),
    (SPECTRAL_PEAK, "frequency of the spectral peak"),
    (TIME_STEP_BIAS, "bias by the time step"),
];

/// What measures are of besides passages: names with their symbols as markup, the longest name first.
pub(crate) struct Named<'a> {
    family: &'a Family,
    symbols: Vec<(String, String)>,
}

impl<'a> Named<'a> {
    /// Those of a family whose densities of these observables are watched.
    pub(crate) fn new(family: &'a Family, observables: &[Observable]) -> Self {
        let axes = 0..family.model().axes.len() + family.quantities().len();
        let axes = axes.map(|axis| (family.axis(axis).to_owned(), names::axis(family, axis)));
        let averaged = family.questions.averaged.iter();
        let averaged = averaged.map(|one| (one.name().to_owned(), symbols::variable(one.symbol())));
        let joint = observables.iter().filter(|one| one.axes().len() > 1);
        let joint = joint.map(|&one| (one.name(family), names::density(family, one)));
        let mut symbols: Vec<(String, String)> = axes.chain(averaged).chain(joint).collect();
        symbols.sort_by_key(|(name, _)| std::cmp::Reverse(name.len()));
        Self { family, symbols }
    }

    /// The name of a measure in words, as markup: `sd_y` becomes standard deviation of ẋ, `exit_mean` mean time (exit).
    pub(crate) fn title(&self, name: &str) -> String {
        let plain = |word: &str| symbols::plain(&word.replace('_', " "));
        let titles = |follows: bool| {
            TITLES
                .iter()
                .filter(move |(kind, _)| kind.follows == follows)
        };
        let questions = &self.family.questions;
        let passages = questions.passages.iter().map(|one| &one.name);
        let mut named = passages.chain(questions.visits.iter().map(|one| &one.name));
        let passage = named.find_map(|one| {
            let word = name.strip_prefix(one)?.strip_prefix('_')?;
            Some((plain(one), word))
        });
        if let Some((passage, word)) = passage {
            let titled = titles(true).find_map(|(kind, title)| {
                let before = word.strip_suffix(kind.word)?;
                let before = plain(before.strip_suffix('_').unwrap_or(before));
                Some(format!("{title} {before}").trim_end().to_owned())
            });
            return format!("{} ({passage})", titled.unwrap_or_else(|| plain(word)));
        }
        let of = self.symbols.iter().find_map(|(of, symbol)| {
            let word = name.strip_suffix(of.as_str())?.strip_suffix('_')?;
            Some((word, format!(" of {symbol}")))
        });
        let (word, of) = of.unwrap_or((name, String::new()));
        let title = titles(false).find(|(kind, _)| kind.word == word);
        title.map_or_else(|| plain(word), |(_, title)| (*title).to_owned()) + &of
    }

    /// A unit behind a title, in the symbols of the figure; nothing where it is that of the axis that the title names.
    pub(crate) fn unit(&self, text: &str) -> String {
        let symbol = |word: &str| self.symbols.iter().find(|(name, _)| name == word);
        if text == "1" || symbol(text).is_some() {
            return String::new();
        }
        let (mut made, mut rest) = (String::new(), text);
        while !rest.is_empty() {
            let begin = rest.find(char::is_alphabetic).unwrap_or(rest.len());
            let (signs, after) = rest.split_at(begin);
            let is_of_word = |c: char| c.is_alphanumeric() || c == '_';
            let end = after.find(|c| !is_of_word(c)).unwrap_or(after.len());
            let word = &after[..end];
            made += &symbols::unit(signs);
            made += &match symbol(word) {
                // The phase of a force is an axis `t` as well.
                _ if word == "t" => symbols::variable(word),
                Some((_, symbol)) => symbol.clone(),
                None => symbols::plain(word),
            };
            rest = &after[end..];
        }
        format!(" [{made}]")
    }
}
