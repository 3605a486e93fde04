//! The curves of a panel with the bands of their errors. A number whose error is not known has an open circle.

use crate::figure::canvas::legend;
use crate::figure::canvas::page::{Panel, Shape};
use crate::figure::canvas::style::{GREY, PAPER, Stroke};

/// Share of a linear range that is left free above and below the data.
const BORDER: f64 = 0.06;
/// Opacity of bands of errors.
const BAND: f64 = 0.2;
/// What is smaller than this is drawn there on logarithmic axes: rounding, not a number.
const SMALLEST: f64 = 1e-300;
/// Radius of an open circle, and how far apart they stand at least, in pixels.
const OPEN: f64 = 2.2;
const APART: f64 = 9.0;

/// One curve of a panel.
pub(crate) struct Curve {
    /// What the legend says; empty for a curve that has its entry already.
    pub(crate) name: String,
    pub(crate) stroke: Stroke,
    /// Parameter and value, ascending in the parameter; neighbours are joined.
    pub(crate) places: Vec<(f64, f64)>,
    /// Half-width of the band about each place, not a number where it is unknown; empty of what has no errors.
    pub(crate) errors: Vec<f64>,
}

impl Curve {
    /// The places whose errors are asked for, with these.
    fn with_errors(&self) -> impl Iterator<Item = (&(f64, f64), &f64)> {
        self.places.iter().zip(&self.errors)
    }

    /// Runs of neighbours whose errors are known.
    fn known(&self) -> Vec<Vec<(&(f64, f64), &f64)>> {
        let all: Vec<(&(f64, f64), &f64)> = self.with_errors().collect();
        let runs = all.split(|(_, error)| error.is_nan());
        runs.map(<[_]>::to_vec)
            .filter(|run| !run.is_empty())
            .collect()
    }
}

/// What a caption says of numbers of which no error is known; nothing where there is none.
pub(crate) fn without_errors(tracks: &[Track]) -> &'static str {
    let curves = tracks.iter().flat_map(|track| &track.curves);
    let mut errors = curves.flat_map(|curve| &curve.errors);
    match errors.any(|error| error.is_nan()) {
        true => "Open circles stand where no error is known.",
        false => "",
    }
}

/// One panel.
pub(crate) struct Track {
    /// Title of the ordinate, as markup.
    pub(crate) title: String,
    pub(crate) is_logarithmic: bool,
    /// Whether the line of zero belongs to it.
    pub(crate) has_zero: bool,
    /// A linear range is no shorter: what differs by less is the same.
    pub(crate) least: f64,
    /// Height, as a share of the usual one.
    pub(crate) share: f64,
    pub(crate) curves: Vec<Curve>,
}

impl Track {
    /// A value as it is drawn.
    fn place_of(&self, value: f64) -> f64 {
        if self.is_logarithmic {
            value.abs().max(SMALLEST).log10()
        } else {
            value
        }
    }

    /// An end of the band about a value, above or below, as it is drawn: by decades a band that reaches beyond zero
    /// reaches down without end.
    fn end_of_band(&self, value: f64, error: f64) -> f64 {
        if self.is_logarithmic {
            self.place_of((value.abs() + error).max(0.0))
        } else {
            value + error
        }
    }

    /// A range of values with the ends of their bands, which reach beyond it by no more than thrice the middle one of
    /// their half-widths, or as far as the values do.
    fn with_bands(&self, (low, high): (f64, f64)) -> (f64, f64) {
        let pairs = self.curves.iter().flat_map(Curve::with_errors);
        let pairs = pairs.filter(|(_, error)| error.is_finite());
        let band = |(place, error): (&(f64, f64), &f64)| {
            [-1.0, 1.0].map(|side| self.end_of_band(place.1, side * error))
        };
        let bands: Vec<[f64; 2]> = pairs.map(band).filter(|band| band[1].is_finite()).collect();
        let mut widths: Vec<f64> = bands.iter().map(|[low, high]| 0.5 * (high - low)).collect();
        widths.sort_by(f64::total_cmp);
        let middle = widths.get(widths.len() / 2).copied().unwrap_or(0.0);
        let most = (3.0 * middle).max(high - low);
        bands.iter().fold((low, high), |(least, largest), band| {
            let least = least.min(band[0].max(low - most));
            (least, largest.max(band[1].min(high + most)))
        })
    }

    /// The range of the ordinate, with the bands of errors but for single ones that are far wider than others; `None`
    /// without a number.
    pub(crate) fn range(&self) -> Option<(f64, f64)> {
        let values = self.curves.iter().flat_map(|curve| &curve.places);
        let values = values
            .map(|place| self.place_of(place.1))
            .filter(|value| value.is_finite());
        let zero = self.has_zero.then_some(0.0);
        let join = |range: Option<(f64, f64)>, value: f64| {
            let (low, high) = range.unwrap_or((value, value));
            Some((low.min(value), high.max(value)))
        };
        let (low, high) = values.chain(zero).fold(None, join)?;
        let (low, high) = self.with_bands((low, high));
        // Two decades hold two labels; a constant is drawn in the middle.
        let least = if self.is_logarithmic {
            2.0
        } else {
            let size = low.abs().max(high.abs());
            let is_constant = high - low <= 1e-9 * size;
            // Labels of a constant have few digits.
            let share = if is_constant { 0.2 } else { 1e-9 };
            (share * size).max(1e-12).max(self.least)
        };
        let missing = (0.5 * (least - (high - low))).max(0.0);
        let border = BORDER * (high - low + 2.0 * missing);
        Some((low - missing - border, high + missing + border))
    }
}

/// Draws the curves of a track with their bands.
pub(crate) fn draw_track(panel: &Panel, track: &Track, range: (f64, f64), (low, high): (f64, f64)) {
    if track.has_zero {
        let zero = Stroke::solid(GREY, 0.8);
        panel.draw(&[(range.0, 0.0), (range.1, 0.0)], Shape::Line(zero));
    }
    for curve in &track.curves {
        let on_axis = |value: f64| track.place_of(value).clamp(low, high);
        for run in curve.known() {
            let end = |sign: f64| {
                let end = move |(place, error): &(&(f64, f64), &f64)| {
                    let end = track.end_of_band(place.1, sign * **error);
                    (place.0, end.clamp(low, high))
                };
                run.iter().map(end)
            };
            let outline: Vec<(f64, f64)> = end(1.0).chain(end(-1.0).rev()).collect();
            if run.iter().any(|(_, error)| **error > 0.0) {
                panel.draw(&outline, Shape::Area(curve.stroke.colour.at(BAND)));
            }
        }
        let places: Vec<(f64, f64)> = curve
            .places
            .iter()
            .map(|place| (place.0, on_axis(place.1)))
            .collect();
        match places[..] {
            [_] => panel.mark(&places, legend::symbol(0, curve.stroke.colour)),
            _ => panel.draw(&places, Shape::Line(curve.stroke)),
        }
        let rim = curve.stroke.dashed(&[]);
        let unknown = curve.with_errors().zip(&places);
        let unknown = unknown.filter(|((_, error), _)| error.is_nan());
        let mut last = f64::NEG_INFINITY;
        for (_, &place) in unknown {
            let across = panel.place(place).0;
            if across - last >= APART {
                last = across;
                panel.draw(&[place], Shape::Dot(OPEN, PAPER, rim));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_by_decades_that_reaches_beyond_zero_has_no_lower_end() {
        let track = of(true, &[], &[]);
        let end = |value: f64, error: f64| track.end_of_band(value, error);
        assert_eq!([end(0.05, 0.05), end(-0.05, 0.05)], [-1.0; 2]);
        // The error is six times the value: zero lies in the band, and so does everything below the value.
        assert_eq!(end(1e-5, -6e-5), SMALLEST.log10());
        assert!(end(1e-5, -6e-6) < -5.0 && end(1e-5, -6e-6) > -6.0);
    }

    /// A track with one curve, at the whole numbers.
    fn of(is_logarithmic: bool, values: &[f64], errors: &[f64]) -> Track {
        let places = values.iter().enumerate();
        Track {
            title: String::new(),
            is_logarithmic,
            has_zero: false,
            least: 0.0,
            share: 1.0,
            curves: vec![Curve {
                name: String::new(),
                stroke: Stroke::curve(0),
                places: places.map(|(at, &value)| (at as f64, value)).collect(),
                errors: errors.to_vec(),
            }],
        }
    }

    #[test]
    fn an_unknown_error_is_no_error_of_zero() {
        let mut track = of(true, &[1.0; 5], &[0.1, 0.1, f64::NAN, f64::NAN, 0.1]);
        let runs = track.curves[0].known();
        assert_eq!(runs.iter().map(Vec::len).collect::<Vec<_>>(), [2, 1]);
        // By decades what is no number would reach down without end.
        let (low, high) = track.range().unwrap();
        assert!(low > -1.5 && high < 1.5, "{low} {high}");
        assert!(without_errors(std::slice::from_ref(&track)).contains("no error is known"));
        track.curves[0].errors.clear();
        assert_eq!(without_errors(&[track]), "");
    }

    #[test]
    fn a_range_holds_the_bands_but_for_one_that_is_far_wider_than_others() {
        let range =
            |values: [f64; 4], errors: [f64; 4]| of(false, &values, &errors).range().unwrap();
        let values = [1.0, 1.1, 1.0, 1.1];
        let (low, high) = range(values, [0.4, 0.5, 0.4, 0.5]);
        assert!(
            low < 0.6 && low > 0.4 && high > 1.6 && high < 1.8,
            "{low} {high}"
        );
        let (low, high) = range(values, [0.01, 50.0, 0.01, 0.01]);
        assert!(low > 0.8 && high < 1.3, "{low} {high}");
        // What is constant but for rounding has labels of few digits.
        let (low, high) = range([-0.5, -0.5, -0.5 - 1e-12, -0.5], [0.0; 4]);
        assert!(high - low > 0.1, "{low} {high}");
    }
}
