//! Numbers over the parameter, in panels below each other that share the abscissa, with the labelled bifurcations
//! through all of them.

use plotters_backend::text_anchor::HPos;

use crate::continuation::{Point, SweepResult};
use crate::density::Observable;
use crate::topology::Detection;

use super::bifurcations::Labels;
use super::caption;
use super::names;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{self, Legend, Swatch};
use crate::figure::canvas::letters;
use crate::figure::canvas::page::{Heading, Lettering, Page, Panel, Rectangle, Shape, lettering};
use crate::figure::canvas::style::{GREY, MARGIN, Stroke, TEXT};
use crate::figure::print::{Figure, Print};

/// Width of the panels on a page of its own width, in pixels, and that width.
const WIDTH: f64 = 400.0;
const USUAL: f64 = 480.0;
/// The narrowest panel beside another with what stands beside it, and the width of one on a page of its own width.
const COLUMN: f64 = 250.0;
/// About what stands above and below all panels.
const AROUND: f64 = 100.0;
/// Gap between panels.
const BETWEEN: f64 = 16.0;
/// Room left of labels without a title beside them.
const BETWEEN_LABELS: f64 = 4.0;
/// Room right of the panels, for half a label.
const BESIDE: f64 = 14.0;
/// Share of a linear range that is left free above and below the data.
const BORDER: f64 = 0.06;
/// Opacity of bands of errors.
const BAND: f64 = 0.2;
/// What is smaller than this is drawn there on logarithmic axes: rounding, not a number.
const SMALLEST: f64 = 1e-300;

/// One curve of a panel.
pub(crate) struct Curve {
    /// What the legend says; empty for a curve that has its entry already.
    pub(crate) name: String,
    pub(crate) stroke: Stroke,
    /// Parameter and value, ascending in the parameter; neighbours are joined.
    pub(crate) places: Vec<(f64, f64)>,
    /// Half-width of the band about each place; empty without errors.
    pub(crate) errors: Vec<f64>,
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
        let pairs = self
            .curves
            .iter()
            .flat_map(|curve| curve.places.iter().zip(&curve.errors));
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

/// What was detected of an observable, by its number, at the values of a sweep.
pub(crate) fn detections(
    result: &SweepResult,
    observable: usize,
) -> impl Iterator<Item = (f64, &Detection)> {
    let points = result.points.iter();
    points.filter_map(move |point| Some((point.value, point.detections.get(observable)?)))
}

/// Draws panels of `height` pixels below each other, from the upper one downward, in two columns where one has no room
/// on a page, and those of one page where there are several; those without a curve are left out,
/// `None` where none is left. The caption says what is seen.
///
/// `own_of` is the observable whose bifurcations stand out; with `None` all stand back alike.
pub(crate) fn draw(
    (result, print): (&SweepResult, &Print<'_>),
    own_of: Option<Observable>,
    (tracks, height): (&[Track], f64),
    (seen, table): (String, String),
) -> Option<Figure> {
    let look = &print.look;
    let mut panels = Vec::new();
    for track in tracks {
        let high = look.height(height * track.share, USUAL);
        if let Some(range) = track.range() {
            let scale = if track.is_logarithmic {
                Scale::logarithmic
            } else {
                Scale::vertical
            };
            panels.push((track, scale(look, range, high, &track.title), high));
        }
    }
    if panels.is_empty() {
        return None;
    }
    let count = panels.len();
    let together = panels
        .iter()
        .map(|(track, ..)| BETWEEN + look.usual_height(height * track.share, USUAL));
    let is_high = together.sum::<f64>() > look.greatest_height - AROUND;
    let panels = &panels[print.share(count)];
    let has_room = look.page.is_none_or(|page| page >= 2.0 * COLUMN);
    let columns = if is_high && has_room && panels.len() > 1 {
        2
    } else {
        1
    };
    let lines = panels.len().div_ceil(columns);
    let range = parameter_range(&result.points);
    // Titles that are longer than their panels are high stand above them all, and not beside.
    let mut is_above = false;
    for (_, up, high) in panels {
        let long = letters::text_width(look, up.title(), TEXT, false);
        is_above |= long > high + BETWEEN;
    }
    let above = if is_above { 1.3 * TEXT } else { 0.0 };
    let labels_wide = panels.iter().map(|(_, up, _)| up.label_width());
    let labels_wide = labels_wide.fold(0.0, f64::max);
    let room = if is_above {
        labels_wide + BETWEEN_LABELS
    } else {
        panels
            .iter()
            .map(|(_, up, _)| up.left())
            .fold(0.0, f64::max)
    };
    let own = if columns > 1 { COLUMN } else { WIDTH };
    let beside = columns as f64 * (room + BESIDE) + 2.0 * MARGIN;
    let wide = look.fill(own * columns as f64, beside) / columns as f64;
    let width = columns as f64 * wide + beside;
    let left = |column: usize| MARGIN + room + column as f64 * (room + wide + BESIDE);
    let across = Scale::horizontal(look, range, wide, &names::parameter(&result.subject.family));
    let heading = Heading::new(look, print.title, width);
    let labels = |column: usize| Labels::new(look, result, own_of, range, (left(column), wide));
    let labels: Vec<Labels<'_>> = (0..columns).map(labels).collect();
    let mut entries: Vec<(Swatch, String)> = Vec::new();
    for curve in panels.iter().flat_map(|(track, ..)| &track.curves) {
        let is_new = entries.iter().all(|(_, known)| *known != curve.name);
        if is_new && !curve.name.is_empty() && !curve.places.is_empty() {
            entries.push((Swatch::Curve(curve.stroke), curve.name.clone()));
        }
    }
    entries.extend(labels[0].entries());
    let legend = Legend::new(look, entries, width - 2.0 * MARGIN);
    let top = heading.height() + labels[0].height() + above;
    let step = |high: &f64| high + BETWEEN + above;
    let bottom = |column: &[(&Track, Scale, f64)]| {
        let high = column.iter().map(|(_, _, high)| step(high));
        top + high.sum::<f64>() - BETWEEN - above
    };
    let bottoms = panels.chunks(lines).map(bottom);
    let below = bottoms.fold(0.0, f64::max) + Scale::below();
    let page = Page::new(look, width, below + legend.height() + MARGIN);
    heading.draw(&page);
    for ((column, panels), labels) in panels.chunks(lines).enumerate().zip(&labels) {
        let mut from = top;
        for (number, (track, up, high)) in panels.iter().enumerate() {
            let rect = Rectangle::new((left(column), from), (wide, *high));
            from += step(high);
            let panel = page.panel(rect, range, up.range);
            labels.draw_plain(&panel, up.range);
            draw_track(&panel, track, range, up.range);
            frame::border(&page, rect);
            across.draw_below(&page, rect, number + 1 == panels.len());
            up.draw_labels_left(&page, rect);
            let title = (
                up.title(),
                letters::text_width(look, up.title(), TEXT, false),
            );
            write_title(&page, (rect, title), (is_above, labels_wide));
            if number == 0 {
                let above_title = Rectangle {
                    top: rect.top - above,
                    ..rect
                };
                labels.draw_texts(&page, above_title);
            }
        }
    }
    let middle = 0.5 * (left(0) + left(columns - 1) + wide);
    legend.draw(&page, middle, below);
    let marked = [caption::bifurcations(result)];
    let caption = caption::of_sweep(result, seen, &marked);
    Some(Figure::new(&page, caption, table).of_panels(count))
}

/// Writes the title of an ordinate, which is so wide: above its panel, in smaller letters where it is wider, or beside
/// it, in line with those of the panels above and below, whose labels are so wide.
fn write_title(
    page: &Page,
    (rect, (title, title_wide)): (Rectangle, (&str, f64)),
    (is_above, labels_wide): (bool, f64),
) {
    if is_above {
        let place = (rect.left, rect.top - 0.65 * TEXT);
        let text = lettering(title, HPos::Left);
        let size = text.size * (rect.width / title_wide).min(1.0);
        return page.text(place, Lettering { size, ..text });
    }
    let place = (
        rect.left - labels_wide - BETWEEN_LABELS - 0.6 * TEXT,
        rect.top + 0.5 * rect.height,
    );
    let upward = Lettering {
        upward: true,
        ..lettering(title, HPos::Center)
    };
    page.text(place, upward);
}

/// Draws the curves of a track with their bands.
pub(crate) fn draw_track(panel: &Panel, track: &Track, range: (f64, f64), (low, high): (f64, f64)) {
    if track.has_zero {
        let zero = Stroke::solid(GREY, 0.8);
        panel.draw(&[(range.0, 0.0), (range.1, 0.0)], Shape::Line(zero));
    }
    for curve in &track.curves {
        let on_axis = |value: f64| track.place_of(value).clamp(low, high);
        let band = |sign: f64| {
            let pairs = curve.places.iter().zip(&curve.errors);
            let end = move |place: f64, error: f64| {
                track.end_of_band(place, sign * error).clamp(low, high)
            };
            pairs.map(move |(place, error)| (place.0, end(place.1, *error)))
        };
        let mut outline: Vec<(f64, f64)> = band(1.0).collect();
        outline.extend(band(-1.0).collect::<Vec<_>>().into_iter().rev());
        if curve.errors.iter().any(|&error| error > 0.0) {
            panel.draw(&outline, Shape::Area(curve.stroke.colour.at(BAND)));
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
    }
}

/// First and last parameter value; widened if they are the same.
pub(crate) fn parameter_range(points: &[Point]) -> (f64, f64) {
    let values = points.iter().map(|point| point.value);
    let (from, to) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), value| {
        (from.min(value), to.max(value))
    });
    if from < to {
        return (from, to);
    }
    let half = if from == 0.0 { 0.5 } else { 0.1 * from.abs() };
    (from - half, from + half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_by_decades_that_reaches_beyond_zero_has_no_lower_end() {
        let track = Track {
            title: String::new(),
            is_logarithmic: true,
            has_zero: false,
            least: 0.0,
            share: 1.0,
            curves: Vec::new(),
        };
        let end = |value: f64, error: f64| track.end_of_band(value, error);
        assert_eq!([end(0.05, 0.05), end(-0.05, 0.05)], [-1.0; 2]);
        // The error is six times the value: zero lies in the band, and so does everything below the value.
        assert_eq!(end(1e-5, -6e-5), SMALLEST.log10());
        assert!(end(1e-5, -6e-6) < -5.0 && end(1e-5, -6e-6) > -6.0);
    }

    #[test]
    fn a_range_holds_the_bands_but_for_one_that_is_far_wider_than_others() {
        let of = |values: [f64; 4], errors: [f64; 4]| {
            let places = values.iter().enumerate();
            let track = Track {
                title: String::new(),
                is_logarithmic: false,
                has_zero: false,
                least: 0.0,
                share: 1.0,
                curves: vec![Curve {
                    name: String::new(),
                    stroke: Stroke::curve(0),
                    places: places.map(|(at, &value)| (at as f64, value)).collect(),
                    errors: errors.to_vec(),
                }],
            };
            track.range().unwrap()
        };
        let values = [1.0, 1.1, 1.0, 1.1];
        let (low, high) = of(values, [0.4, 0.5, 0.4, 0.5]);
        assert!(
            low < 0.6 && low > 0.4 && high > 1.6 && high < 1.8,
            "{low} {high}"
        );
        let (low, high) = of(values, [0.01, 50.0, 0.01, 0.01]);
        assert!(low > 0.8 && high < 1.3, "{low} {high}");
        // What is constant but for rounding has labels of few digits.
        let (low, high) = of([-0.5, -0.5, -0.5 - 1e-12, -0.5], [0.0; 4]);
        assert!(high - low > 0.1, "{low} {high}");
    }
}
