//! The signature of a density: how many peaks, rings and craters it has, and what lies within what.

use std::fmt::{self, Display, Formatter};

/// What is compared along a sweep: numbers of significant peaks, rings and craters. Of a marginal only peaks are
/// counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "[usize; 6]", into = "[usize; 6]"))]
pub struct Signature {
    /// Number of significant peaks: maxima at a point, those on the rims of craters included.
    pub peaks: usize,
    /// Number of significant craters: basins that higher ground encloses, the moat around a peak in a ring included.
    pub craters: usize,
    /// Number of rings: maxima along a closed curve, of constant height within the density's error.
    pub rings: usize,
    /// How many of the peaks lie within a ring, or within the rim of a crater.
    pub enclosed_peaks: usize,
    /// How many of the rings lie within another.
    pub enclosed_rings: usize,
    /// How many natural ends of the range, at which the noise dies, are peaks: the density grows there beyond any
    /// bound. Where it vanishes there these peaks are not at the end, or there are none.
    pub at_ends: usize,
}

impl From<[usize; 6]> for Signature {
    fn from(counts: [usize; 6]) -> Self {
        let [
            peaks,
            craters,
            rings,
            enclosed_peaks,
            enclosed_rings,
            at_ends,
        ] = counts;
        Self {
            peaks,
            craters,
            rings,
            enclosed_peaks,
            enclosed_rings,
            at_ends,
        }
    }
}

/// Its counts, in the order of its fields.
impl From<Signature> for [usize; 6] {
    fn from(of: Signature) -> Self {
        [
            of.peaks,
            of.craters,
            of.rings,
            of.enclosed_peaks,
            of.enclosed_rings,
            of.at_ends,
        ]
    }
}

impl Signature {
    /// Of a density with so many peaks and nothing else.
    pub fn of_peaks(peaks: usize) -> Self {
        Self {
            peaks,
            ..Self::default()
        }
    }
}

/// A number with its noun.
fn count_in_words(number: usize, noun: &str) -> String {
    match number {
        1 => format!("1 {noun}"),
        _ => format!("{number} {noun}s"),
    }
}

impl Display for Signature {
    /// `1 peak`, `2 peaks`, `1 peak at an end`, `2 peaks, 1 at an end`; `crater` (its rim has no second peak), `crater
    /// with 2 peaks`; `ring`, `peak in a ring`, `2 rings`, `ring around 2 craters`, `ring and 1 peak`.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let outside = self.peaks - self.enclosed_peaks.min(self.peaks);
        if self.rings == 0 {
            return match (self.craters, outside, self.enclosed_peaks) {
                (0, ..) => {
                    f.write_str(&count_in_words(self.peaks, "peak"))?;
                    match (self.peaks, self.at_ends) {
                        (_, 0) => Ok(()),
                        (1, _) => f.write_str(" at an end"),
                        (peaks, ends) if peaks == ends => f.write_str(" at the ends"),
                        (_, ends) => write!(f, ", {ends} at an end"),
                    }
                }
                (1, 0 | 1, 0) => f.write_str("crater"),
                (1, ..) => write!(f, "crater with {}", count_in_words(outside, "peak")),
                (craters, 0 | 1, 0) => f.write_str(&count_in_words(craters, "crater")),
                (craters, ..) => write!(
                    f,
                    "{} with {}",
                    count_in_words(craters, "crater"),
                    count_in_words(outside, "peak")
                ),
            }
            .and_then(|()| match (self.craters, self.enclosed_peaks) {
                (0, _) | (_, 0) => Ok(()),
                (_, enclosed) => write!(f, " around {}", count_in_words(enclosed, "peak")),
            });
        }
        let ring = match (self.rings, self.enclosed_rings) {
            (1, _) => "ring".to_owned(),
            (2, 1) => "ring in a ring".to_owned(),
            (rings, _) => format!("{rings} rings"),
        };
        match (self.enclosed_peaks, self.rings) {
            (0, _) => f.write_str(&ring)?,
            (1, 1) => f.write_str("peak in a ring")?,
            (1, _) => write!(f, "peak in {ring}")?,
            (peaks, 1) => write!(f, "{peaks} peaks in a ring")?,
            (peaks, _) => write!(f, "{peaks} peaks in {ring}")?,
        }
        // Every ring has a basin within; what is more are craters of their own.
        if self.craters > self.rings {
            write!(f, " around {} craters", self.craters + 1 - self.rings)?;
        }
        match outside {
            0 => Ok(()),
            peaks => write!(f, " and {}", count_in_words(peaks, "peak")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_say_what_contains_what() {
        let of = |peaks, craters, rings, enclosed_peaks, enclosed_rings| {
            Signature {
                peaks,
                craters,
                rings,
                enclosed_peaks,
                enclosed_rings,
                at_ends: 0,
            }
            .to_string()
        };
        assert_eq!(of(1, 0, 0, 0, 0), "1 peak");
        assert_eq!(of(0, 0, 0, 0, 0), "0 peaks");
        let at_ends = |peaks, at_ends| {
            let of = Signature {
                at_ends,
                ..Signature::of_peaks(peaks)
            };
            of.to_string()
        };
        assert_eq!(at_ends(1, 1), "1 peak at an end");
        assert_eq!(at_ends(2, 1), "2 peaks, 1 at an end");
        assert_eq!(at_ends(2, 2), "2 peaks at the ends");
        assert_eq!(of(1, 1, 0, 0, 0), "crater");
        assert_eq!(of(2, 1, 0, 0, 0), "crater with 2 peaks");
        assert_eq!(of(2, 2, 0, 0, 0), "2 craters with 2 peaks");
        assert_eq!(of(3, 1, 0, 1, 0), "crater with 2 peaks around 1 peak");
        assert_eq!(of(0, 1, 1, 0, 0), "ring");
        assert_eq!(of(1, 1, 1, 1, 0), "peak in a ring");
        assert_eq!(of(2, 1, 1, 1, 0), "peak in a ring and 1 peak");
        assert_eq!(of(0, 2, 2, 0, 0), "2 rings");
        assert_eq!(of(0, 2, 1, 0, 0), "ring around 2 craters");
        assert_eq!(of(0, 2, 2, 0, 1), "ring in a ring");
        assert_eq!(of(1, 2, 2, 1, 1), "peak in ring in a ring");
    }
}
