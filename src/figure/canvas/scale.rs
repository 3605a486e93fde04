//! Axes laid out on a given length: which ticks have labels, and the room that these take. The frame draws them.

use super::letters;
use super::look::Look;
use super::style::{TEXT, TICK, TICK_TEXT};
use super::ticks::{Ticks, decades, ticks};

/// Gap between ticks, labels and titles, in pixels.
pub(super) const GAP: f64 = 4.0;

/// An axis with fewer labels than these gets more, nearer to each other, if they have room.
const FEW: usize = 3;

/// An axis laid out on a given length.
#[derive(Debug, Clone)]
pub(crate) struct Scale {
    /// The range.
    pub(crate) range: (f64, f64),
    pub(super) ticks: Ticks,
    title: String,
    /// The title beside a vertical axis: two lines where one is longer than the axis.
    upward: Vec<String>,
    widest: f64,
}

/// A title beside an axis may be so much longer.
const OVER: f64 = 16.0;

impl Scale {
    /// Lays out a horizontal axis: as many labels as stand apart.
    pub(crate) fn horizontal(look: &Look, range: (f64, f64), length: f64, title: &str) -> Self {
        let wide = Self::with_gap(look, range, length, title, 14.0);
        if wide.ticks.major.len() >= FEW {
            return wide;
        }
        // A short axis is better with labels close to each other than with a single one.
        let close = Self::with_gap(look, range, length, title, 4.0);
        if close.ticks.major.len() > wide.ticks.major.len() {
            close
        } else {
            wide
        }
    }

    /// Lays out an axis that runs aslant, so far across and so far down: labels stand beside or below each other.
    pub(super) fn slanted(
        look: &Look,
        range: (f64, f64),
        (across, down): (f64, f64),
        title: &str,
    ) -> Self {
        let mut most = 7;
        loop {
            let scale = Self::with(look, range, most, title);
            let step = match &scale.ticks.major[..] {
                [first, second, ..] => (second.value - first.value) / (range.1 - range.0),
                _ => 1.0,
            };
            let is_apart = step * down >= 1.15 * TICK_TEXT || step * across >= scale.widest + 6.0;
            if is_apart || most <= 2 {
                return scale;
            }
            most -= 1;
        }
    }

    /// Lays out a horizontal axis with as many labels as have that gap between them.
    fn with_gap(look: &Look, range: (f64, f64), length: f64, title: &str, gap: f64) -> Self {
        let mut most = 7;
        loop {
            let scale = Self::with(look, range, most, title);
            let apart = match &scale.ticks.major[..] {
                [first, .., last] => {
                    let span = (last.value - first.value) / (range.1 - range.0) * length;
                    span / (scale.ticks.major.len() - 1) as f64
                }
                _ => length,
            };
            if apart >= scale.widest + gap || most <= 2 {
                return scale;
            }
            most -= 1;
        }
    }

    /// Lays out a vertical axis.
    pub(crate) fn vertical(look: &Look, range: (f64, f64), length: f64, title: &str) -> Self {
        let most = |apart: f64| ((length / (apart * TICK_TEXT)) as usize).clamp(2, 7);
        let scale = Self::with(look, range, most(2.6), title);
        if scale.ticks.major.len() >= FEW {
            return scale.folded(look, length);
        }
        // Three labels stand on anything longer than three lines.
        let least = if length >= 3.2 * TICK_TEXT { 3 } else { 2 };
        Self::with(look, range, most(1.6).max(least), title).folded(look, length)
    }

    /// The same with the title beside it in two lines, where one is longer than the axis.
    fn folded(mut self, look: &Look, length: f64) -> Self {
        let wide = |text: &str| letters::text_width(look, text, TEXT, false);
        if wide(&self.title) > length + OVER {
            let is_between = |at: &usize| {
                let signs = self.title[..*at].matches(['$', '{', '}']);
                signs.count().is_multiple_of(2)
            };
            let spaces = self
                .title
                .match_indices(' ')
                .map(|(at, _)| at)
                .filter(is_between);
            let lines = spaces.map(|at| [&self.title[..at], &self.title[at + 1..]]);
            let longer = |lines: &[&str; 2]| wide(lines[0]).max(wide(lines[1]));
            let best = lines.min_by(|a, b| longer(a).total_cmp(&longer(b)));
            if let Some(best) = best {
                self.upward = best.map(str::to_owned).to_vec();
            }
        }
        self
    }

    /// Lays out an axis of logarithms to base ten, labelled at as many powers of ten as its length has room for:
    /// `range` and what is drawn are exponents.
    pub(crate) fn logarithmic(look: &Look, range: (f64, f64), length: f64, title: &str) -> Self {
        let most = ((length / (2.2 * TICK_TEXT)) as usize).clamp(2, 9);
        Self::of(look, range, decades(range.0, range.1, most), title).folded(look, length)
    }

    fn with(look: &Look, range: (f64, f64), most: usize, title: &str) -> Self {
        Self::of(look, range, ticks(range.0, range.1, most), title)
    }

    fn of(look: &Look, range: (f64, f64), ticks: Ticks, title: &str) -> Self {
        let mut widest: f64 = 0.0;
        for tick in &ticks.major {
            widest = widest.max(letters::text_width(look, &tick.label, TICK_TEXT, false));
        }
        let power = format!(
            "10^{{{}}}",
            super::symbols::fixed(f64::from(ticks.exponent), 0)
        );
        let title = match (ticks.exponent, title.is_empty()) {
            (0, _) => title.to_owned(),
            (_, true) => power,
            (_, false) => format!("{title} ({power})"),
        };
        Self {
            range,
            ticks,
            upward: vec![title.clone()],
            title,
            widest,
        }
    }

    /// The title, with the power of ten that the labels leave out.
    pub(crate) fn title(&self) -> &str {
        &self.title
    }

    /// How far the labels of a horizontal axis of this length reach beyond its two ends together, in pixels.
    pub(crate) fn beyond(&self, length: f64) -> f64 {
        let ticks = &self.ticks.major;
        let ends = ticks.first().zip(ticks.last());
        let half = 0.5 * self.widest;
        ends.map_or(0.0, |(first, last)| {
            let before = half - self.share(first.value) * length;
            let after = half - (1.0 - self.share(last.value)) * length;
            before.max(0.0) + after.max(0.0)
        })
    }

    /// Labelled ticks: share of the way, and label.
    pub(super) fn labels(&self) -> impl Iterator<Item = (f64, &str)> + '_ {
        let ticks = self.ticks.major.iter();
        ticks.map(|tick| (self.share(tick.value), tick.label.as_str()))
    }

    /// Shares of the way at which there are labelled ticks.
    pub(super) fn labelled(&self) -> impl Iterator<Item = f64> + '_ {
        self.labels().map(|(share, _)| share)
    }

    /// Width of ticks and labels beside a vertical axis.
    pub(crate) fn label_width(&self) -> f64 {
        TICK + GAP + self.widest
    }

    /// Room to the left of a vertical axis with title.
    pub(crate) fn left(&self) -> f64 {
        self.label_width() + GAP + 1.45 * TEXT + self.second_line()
    }

    /// What a second line of the title takes beside the first.
    pub(super) fn second_line(&self) -> f64 {
        1.2 * TEXT * (self.upward.len() - 1) as f64
    }

    /// The lines of the title beside a vertical axis, from the left.
    pub(super) fn upward(&self) -> &[String] {
        &self.upward
    }

    /// Room below a horizontal axis with title.
    pub(crate) fn below() -> f64 {
        TICK + GAP + TICK_TEXT + GAP + 1.5 * TEXT
    }

    /// Share of the way along the axis.
    pub(super) fn share(&self, value: f64) -> f64 {
        ((value - self.range.0) / (self.range.1 - self.range.0)).clamp(0.0, 1.0)
    }

    /// Labelled (true) and small ticks with their shares of the way.
    pub(super) fn all(&self) -> impl Iterator<Item = (f64, bool)> + '_ {
        let major = self
            .ticks
            .major
            .iter()
            .map(|tick| (self.share(tick.value), true));
        let minor = self
            .ticks
            .minor
            .iter()
            .map(|&value| (self.share(value), false));
        major.chain(minor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_a_short_axis_stand_apart() {
        for length in [60.0, 100.0, 200.0, 400.0] {
            let scale = Scale::horizontal(&Look::default(), (-0.02, 0.01), length, "x");
            let places: Vec<f64> = scale
                .ticks
                .major
                .iter()
                .map(|tick| scale.share(tick.value) * length)
                .collect();
            assert!(!places.is_empty());
            if length >= 200.0 {
                assert!(places.len() >= 3, "{places:?}");
            }
            if places.len() > 2 {
                assert!(
                    places
                        .windows(2)
                        .all(|pair| pair[1] - pair[0] >= scale.widest + 13.9)
                );
            }
        }
    }

    #[test]
    fn a_power_of_ten_goes_into_the_title() {
        let scale = Scale::vertical(&Look::default(), (0.0, 4e-7), 200.0, "$D$");
        assert_eq!(scale.title(), "$D$ (10^{−7})");
        assert_eq!(
            Scale::vertical(&Look::default(), (0.0, 4.0), 200.0, "$D$").title(),
            "$D$"
        );
    }
}
