//! Numbers over the parameter, in panels below each other that share the abscissa, with the labelled bifurcations
//! through all of them.

use plotters_backend::text_anchor::HPos;

use crate::continuation::{Point, SweepResult};
use crate::density::Observable;
use crate::numerics::ends_of;
use crate::topology::Detection;

use super::bifurcations::Labels;
use super::caption;
use super::names;
use super::track::{self, Track, draw_track};
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::letters;
use crate::figure::canvas::page::{Heading, Lettering, Page, Rectangle, lettering};
use crate::figure::canvas::style::{MARGIN, TEXT};
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
    let above = if is_above { 1.4 * TEXT } else { 0.0 };
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
    let unknown = track::without_errors(tracks).to_owned();
    let marked = [unknown, caption::bifurcations(result)];
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
        let place = (rect.left, rect.top - 0.8 * TEXT);
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

/// First and last parameter value; widened if they are the same.
pub(crate) fn parameter_range(points: &[Point]) -> (f64, f64) {
    let values = points.iter().map(|point| point.value);
    let (from, to) = ends_of(values);
    if from < to {
        return (from, to);
    }
    let half = if from == 0.0 { 0.5 } else { 0.1 * from.abs() };
    (from - half, from + half)
}
