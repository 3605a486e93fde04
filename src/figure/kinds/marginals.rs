//! Marginal densities at several parameter values, overlaid: a panel an axis, side by side.

use std::borrow::Cow;

use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity, Observable};

use super::{Drawn, Kind, Sketch};
use crate::figure::canvas::contour::beside;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Rectangle, Shape};
use crate::figure::canvas::style::{MARGIN, Stroke, TEXT};
use crate::figure::parts::joint_map::{with_letter, write_above};
use crate::figure::parts::view::View;
use crate::figure::parts::{caption, names, table, view};
use crate::figure::print::{Figure, Print};
use crate::system::Family;

/// Height of a panel on a page of its own width, in pixels, and that width.
const HEIGHT: f64 = 210.0;
const USUAL: f64 = 620.0;
/// Gap between panels.
const BETWEEN: f64 = 18.0;
/// Opacity of the band of two standard errors.
const BAND: f64 = 0.18;

/// Most panels beside each other on a page of its own width.
const MOST_COLUMNS: usize = 4;
/// Narrowest panel beside another where the page is given.
const NARROWEST: f64 = 165.0;
/// Room right of the last panel, for half a label of its axis.
const BESIDE: f64 = 10.0;

/// Densities of one axis, overlaid in a panel.
pub(super) struct Overlaid<'a> {
    /// Title of the abscissa.
    axis: String,
    densities: Vec<(usize, Cow<'a, EstimatedDensity>)>,
    window: (f64, f64),
    up: Scale,
    /// What stands above the panel.
    above: String,
}

pub(super) const KIND: Kind = Kind {
    names: &["marginals"],
    usual: Some("marginals"),
    sketches: |sweep| {
        let (result, chosen) = (sweep.result, sweep.chosen.clone());
        let draw = move |print: &Print<'_>| draw(result, &chosen, print);
        vec![Sketch::new("marginals", draw)]
    },
};

/// How panels are arranged: columns, and the width of a panel.
fn arrangement(look: &Look, panels: usize, room: f64) -> (usize, f64) {
    let own = match panels {
        0 | 1 => 380.0,
        2 => 235.0,
        _ => 215.0,
    };
    if look.page.is_none() {
        return (Look::even_columns(panels, MOST_COLUMNS), own);
    }
    let width = |columns: usize| {
        let gaps = BETWEEN * (columns - 1) as f64 + BESIDE + 2.0 * MARGIN;
        look.fill(own, columns as f64 * room + gaps) / columns as f64
    };
    let columns = Look::columns(panels, |columns| width(columns) >= NARROWEST);
    (columns, width(columns))
}

/// The figure of all observed marginals at the chosen points; `None` if there is nothing to draw.
fn draw(result: &SweepResult, chosen: &[&Point], print: &Print<'_>) -> Drawn {
    let mut all = Vec::new();
    for number in 0..result.subject.observables.len() {
        all.extend(marginal(result, chosen, number, print));
    }
    let page = draw_overlaid(&values_of(&result.subject.family, chosen), (0, &all), print)?;
    let values = chosen.iter().map(|point| point.value);
    let at = caption::at(&result.subject.family, values);
    let seen = format!("Steady-state marginal densities{at}.");
    let is_marginal = |one| matches!(one, Observable::Marginal(_));
    let between = caption::between_cells(result, is_marginal);
    let observables: Vec<usize> = (0..result.subject.observables.len()).collect();
    let rows = |estimated: &EstimatedDensity, number: usize| {
        let all = chosen
            .iter()
            .filter_map(|point| view::density(point, number));
        let all: Vec<&Density> = all.map(|one| &one.density).collect();
        as_drawn(estimated, view::window(&all, 0))
    };
    Some(Figure::new(
        &page,
        caption::of_sweep(result, seen, &[between]),
        table::of_marginals(result, (&observables, chosen), rows),
    ))
}

/// The points of a marginal's curve; with sampling noise its cells.
pub(super) fn as_drawn(
    estimated: &EstimatedDensity,
    window: Option<(f64, f64)>,
) -> Vec<(f64, f64, String)> {
    let Some(window) = window else {
        return Vec::new();
    };
    let view = View::new(estimated);
    if view.between.is_none() {
        return table::cells(estimated);
    }
    let curve = view.curve(window).into_iter();
    curve
        .map(|(place, value)| (place, value, String::new()))
        .collect()
}

/// What a legend says of points: their values.
pub(super) fn values_of(family: &Family, points: &[&Point]) -> Vec<String> {
    let points = points.iter();
    points.map(|point| names::at(family, point.value)).collect()
}

/// Draws a panel for each of some axes, in a legend the words for the densities by their numbers; `None` without a
/// panel. So many panels stand on earlier pages.
pub(super) fn draw_overlaid(
    words: &[String],
    (first, all): (usize, &[Overlaid<'_>]),
    print: &Print<'_>,
) -> Option<Page> {
    let look = &print.look;
    let high = look.height(HEIGHT, USUAL);
    if all.is_empty() {
        return None;
    }
    let room = all.iter().map(|one| one.up.left()).fold(0.0, f64::max);
    let (columns, wide) = arrangement(look, all.len(), room);
    let rows = all.len().div_ceil(columns);
    // Panels of one row need only their own room each.
    let lefts: Vec<f64> = match rows {
        1 => all.iter().map(|one| one.up.left()).collect(),
        _ => vec![room; columns],
    };
    let together = lefts.iter().sum::<f64>() + columns as f64 * wide;
    let gaps = BETWEEN * (columns - 1) as f64 + BESIDE + 2.0 * MARGIN;
    let page_width = look.page.unwrap_or(together + gaps);
    // What rooms of their own leave over goes to the panels.
    let wide = (page_width - gaps - lefts.iter().sum::<f64>()) / columns as f64;
    let heading = Heading::new(look, print.title, page_width);
    let entries = words.iter().enumerate().map(|(number, words)| {
        let sample = Swatch::Curve(Stroke::curve(number));
        (sample, words.clone())
    });
    let legend = Legend::new(look, entries.collect(), page_width - 2.0 * MARGIN);
    let has_letters = look.has_letters && all.len() > 1;
    let has_letters = has_letters || all.iter().any(|one| !one.above.is_empty());
    let above = if has_letters { 1.5 * TEXT } else { 6.0 };
    let top = heading.height() + legend.height() + above;
    let step = high + Scale::below() + if has_letters { above } else { MARGIN };
    let page = Page::new(
        look,
        page_width,
        top - above + rows as f64 * step + above.min(MARGIN),
    );
    heading.draw(&page);
    legend.draw(&page, 0.5 * page_width, heading.height());
    for (number, one) in all.iter().enumerate() {
        let (row, column) = (number / columns, number % columns);
        let before: f64 = lefts[..=column].iter().sum();
        let left = MARGIN + before + column as f64 * (wide + BETWEEN);
        let rect = Rectangle::new((left, top + row as f64 * step), (wide, high));
        let across = Scale::horizontal(look, one.window, wide, &one.axis);
        draw_panel(&page, (one, &across), rect);
        if has_letters {
            write_above(
                &page,
                rect,
                with_letter(look, first + number, one.above.clone()),
            );
        }
    }
    Some(page)
}

/// The densities of one marginal at the chosen points.
fn marginal<'a>(
    result: &SweepResult,
    chosen: &[&'a Point],
    number: usize,
    print: &Print<'_>,
) -> Option<Overlaid<'a>> {
    let observable = result.subject.observables[number];
    let Observable::Marginal(axis) = observable else {
        return None;
    };
    let drawable = |(place, point): (usize, &&'a Point)| {
        Some((place, Cow::Borrowed(view::density(point, number)?)))
    };
    let densities = chosen.iter().enumerate().filter_map(drawable);
    let family = &result.subject.family;
    let (axis, title) = (
        names::axis(family, axis),
        names::density(family, observable),
    );
    Overlaid::new(print, &axis, densities.collect(), &title)
}

impl<'a> Overlaid<'a> {
    /// Densities along an axis, with the numbers of their points among the chosen; `None` where there is nothing to
    /// see. The titles are those of the abscissa and of the ordinate.
    pub(super) fn new(
        print: &Print<'_>,
        axis: &str,
        densities: Vec<(usize, Cow<'a, EstimatedDensity>)>,
        title: &str,
    ) -> Option<Self> {
        let all = densities.iter().map(|(_, estimated)| estimated);
        let bare: Vec<&Density> = all.clone().map(|one| &one.density).collect();
        let window = view::window(&bare, 0)?;
        let highest = all.map(|one| View::new(one).largest).fold(0.0, f64::max);
        let high = print.look.height(HEIGHT, USUAL);
        let up = Scale::vertical(&print.look, (0.0, 1.06 * highest), high, title);
        Some(Self {
            axis: axis.to_owned(),
            densities,
            window,
            up,
            above: String::new(),
        })
    }

    /// The same under a line.
    pub(super) fn under(self, above: String) -> Self {
        Self { above, ..self }
    }
}

fn draw_panel(page: &Page, (one, across): (&Overlaid<'_>, &Scale), rect: Rectangle) {
    let panel = page.panel(rect, across.range, one.up.range);
    for (number, estimated) in &one.densities {
        let stroke = Stroke::curve(*number);
        let band = band(estimated, across.range);
        let band = within(band, one.up.range);
        if !band.is_empty() {
            let fill = stroke.colour.at(BAND);
            panel.draw(&band, Shape::Area(fill));
        }
    }
    for (number, estimated) in &one.densities {
        let curve = View::new(estimated).curve(across.range);
        let curve = within(curve, one.up.range);
        panel.draw(&curve, Shape::Line(Stroke::curve(*number)));
    }
    frame::border(page, rect);
    across.draw_below(page, rect, true);
    one.up.draw_left(page, rect, true);
}

/// Numbers and centres of the cells inside a window.
pub(super) fn cells(density: &Density, window: (f64, f64)) -> impl Iterator<Item = (usize, f64)> {
    let centres = density.axes[0].centres().into_iter().enumerate();
    centres.filter(move |(_, centre)| *centre >= window.0 && *centre <= window.1)
}

/// Points of a curve, kept in the range of the ordinate.
pub(super) fn within(curve: Vec<(f64, f64)>, range: (f64, f64)) -> Vec<(f64, f64)> {
    let kept = |(place, value): (f64, f64)| (place, value.clamp(range.0, range.1));
    curve.into_iter().map(kept).collect()
}

/// The outline of ± 2 standard errors about the curve that is drawn; empty where none are stated. Between the middles
/// of cells errors are joined by straight lines.
fn band(estimated: &EstimatedDensity, window: (f64, f64)) -> Vec<(f64, f64)> {
    let errors = &estimated.stated_errors();
    let values = &estimated.density.values;
    if errors.len() != values.len() || !errors.iter().any(|&error| error > 0.0) {
        return Vec::new();
    }
    let centres = estimated.density.axes[0].centres();
    let error = |place: f64| match beside(&centres, place) {
        Some((cell, share)) => (1.0 - share) * errors[cell] + share * errors[cell + 1],
        None => errors[0],
    };
    let curve = View::new(estimated).curve(window);
    let edge = |factor: f64| {
        let curve = curve.iter();
        curve.map(move |&(place, value)| (place, value + factor * error(place)))
    };
    edge(2.0).chain(edge(-2.0).rev()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::{Structure, Variants};
    use crate::figure::style::FigureStyle;
    use crate::space::Axis;

    #[test]
    fn many_panels_stand_in_rows() {
        let look = FigureStyle::default().look();
        assert_eq!(arrangement(&look, 3, 30.0).0, 3);
        assert_eq!(arrangement(&look, 10, 30.0).0, 4);
    }

    #[test]
    fn a_band_lies_about_the_curve_that_is_drawn() {
        // On wide cells the curve rises far above the chords between their middles.
        let axis = Axis::uniform(-4.0, 4.0, 16).unwrap();
        let normal = |x: f64| (-0.5 * x * x).exp() / 2.507;
        let values: Vec<f64> = axis.centres().into_iter().map(normal).collect();
        let estimated = EstimatedDensity {
            observable: Observable::Marginal(0),
            standard_error: vec![0.01; 16],
            variants: Variants::Scheme(values.clone()),
            density: Density {
                axes: vec![axis],
                values,
            },
            structure: Structure::default(),
            negligible: 0.0,
            truncation: Default::default(),
        };
        let window = (-4.0, 4.0);
        let curve = View::new(&estimated).curve(window);
        let outline = band(&estimated, window);
        assert_eq!(outline.len(), 2 * curve.len());
        let pairs = curve.iter().zip(outline.iter().zip(outline.iter().rev()));
        for (place, (upper, lower)) in pairs {
            assert_eq!((place.0, place.0), (upper.0, lower.0));
            assert!(
                (0.5 * (upper.1 + lower.1) - place.1).abs() < 1e-12,
                "{place:?}"
            );
            assert!((upper.1 - lower.1 - 0.04).abs() < 1e-12, "{place:?}");
        }
    }
}
