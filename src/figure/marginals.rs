//! Marginal densities at several parameter values, overlaid: a panel an axis, side by side.

use std::borrow::Cow;

use crate::continuation::Point;
use crate::density::{Density, EstimatedDensity, Observable};

use super::canvas::DrawError;
use super::canvas::frame::{self, Scale};
use super::canvas::legend::{Legend, Sample};
use super::canvas::look::Look;
use super::canvas::page::{Heading, Page, Rectangle, Shape};
use super::canvas::style::{MARGIN, Stroke};
use super::shown::Shown;
use super::sketch::{Sketch, SweepScene};
use super::told::Shows;
use super::{names, select};

/// Height of a panel on a page of its own width, in pixels, and that width.
const HEIGHT: f64 = 210.0;
const USUAL: f64 = 620.0;
/// Gap between panels.
const BETWEEN: f64 = 18.0;
/// Opacity of the band of two standard errors.
const BAND: f64 = 0.18;

/// Narrowest panel beside another where the page is given.
const NARROWEST: f64 = 165.0;
/// Room right of the last panel, for half a label of its axis.
const BESIDE: f64 = 10.0;

/// Densities of one axis, overlaid in a panel.
pub(super) struct Overlaid<'a> {
    axis: usize,
    densities: Vec<(usize, Cow<'a, EstimatedDensity>)>,
    window: (f64, f64),
    up: Scale,
}

/// One panel laid out.
struct Laid<'a> {
    overlaid: &'a Overlaid<'a>,
    across: Scale,
}

/// The figure of all observed marginals.
pub(super) fn sketches<'a>(scene: &'a SweepScene<'a>) -> Vec<Sketch<'a>> {
    let shows = Shows::Marginals(scene.chosen.clone());
    vec![Sketch::new("marginals", || draw(scene)).showing(shows)]
}

/// How panels are arranged: columns, and the width of a panel.
fn arrangement(look: &Look, panels: usize, room: f64) -> (usize, f64) {
    let own = match panels {
        0 | 1 => 380.0,
        2 => 235.0,
        _ => 215.0,
    };
    if look.page.is_none() {
        return (panels, own);
    }
    let width = |columns: usize| {
        let gaps = BETWEEN * (columns - 1) as f64 + BESIDE + 2.0 * MARGIN;
        look.fill(own, columns as f64 * room + gaps) / columns as f64
    };
    let fitting = (1..=panels.max(1))
        .rev()
        .find(|&columns| width(columns) >= NARROWEST);
    let columns = fitting.unwrap_or(1);
    (columns, width(columns))
}

/// The figure of all observed marginals at the chosen points; `None` if there is nothing to draw.
fn draw(scene: &SweepScene<'_>) -> Result<Option<Page>, DrawError> {
    let mut all = Vec::new();
    for number in 0..scene.result.subject.observables.len() {
        all.extend(marginal(scene, number)?);
    }
    draw_overlaid(scene, &all)
}

/// Draws a panel for each of some axes, in a legend the chosen points; `None` without a panel.
pub(super) fn draw_overlaid(
    scene: &SweepScene<'_>,
    all: &[Overlaid<'_>],
) -> Result<Option<Page>, DrawError> {
    let (family, look) = (scene.family(), &scene.look);
    let high = look.height(HEIGHT, USUAL);
    if all.is_empty() {
        return Ok(None);
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
    let heading = Heading::new(look, scene.title, page_width)?;
    let entry = |(number, point): (usize, &&Point)| {
        (
            Sample::Curve(Stroke::curve(number)),
            names::at(family, point.value),
        )
    };
    let legend = Legend::new(
        look,
        scene.chosen.iter().enumerate().map(entry).collect(),
        page_width - 2.0 * MARGIN,
    )?;
    let top = heading.height() + legend.height() + 6.0;
    let step = high + Scale::below() + MARGIN;
    let page = Page::new(look, page_width, top + rows as f64 * step);
    heading.draw(&page)?;
    legend.draw(&page, 0.5 * page_width, heading.height())?;
    for (number, one) in all.iter().enumerate() {
        let (row, column) = (number / columns, number % columns);
        let before: f64 = lefts[..=column].iter().sum();
        let rect = Rectangle {
            left: MARGIN + before + column as f64 * (wide + BETWEEN),
            top: top + row as f64 * step,
            width: wide,
            height: high,
        };
        let title = names::axis(family, one.axis);
        let laid = Laid {
            overlaid: one,
            across: Scale::horizontal(look, one.window, wide, &title)?,
        };
        draw_panel(&page, &laid, rect)?;
    }
    Ok(Some(page))
}

/// The densities of one marginal at the chosen points.
fn marginal<'a>(scene: &SweepScene<'a>, number: usize) -> Result<Option<Overlaid<'a>>, DrawError> {
    let observable = scene.result.subject.observables[number];
    let Observable::Marginal(axis) = observable else {
        return Ok(None);
    };
    let drawable = |(place, point): (usize, &&'a Point)| {
        Some((place, Cow::Borrowed(select::density(point, number)?)))
    };
    let densities = scene.chosen.iter().enumerate().filter_map(drawable);
    let title = names::density(scene.family(), observable);
    Overlaid::new(scene, axis, densities.collect(), &title)
}

impl<'a> Overlaid<'a> {
    /// Densities along an axis, with the numbers of their points among the chosen; `None` where there is nothing to
    /// see. The title is that of the ordinate.
    pub(super) fn new(
        scene: &SweepScene<'_>,
        axis: usize,
        densities: Vec<(usize, Cow<'a, EstimatedDensity>)>,
        title: &str,
    ) -> Result<Option<Self>, DrawError> {
        let bare: Vec<&Density> = densities
            .iter()
            .map(|(_, estimated)| &estimated.density)
            .collect();
        let Some(window) = select::window(&bare, 0) else {
            return Ok(None);
        };
        let shown = densities
            .iter()
            .map(|(_, estimated)| Shown::new(estimated).largest);
        let highest = shown.fold(0.0, f64::max);
        let high = scene.look.height(HEIGHT, USUAL);
        let up = Scale::vertical(&scene.look, (0.0, 1.06 * highest), high, title)?;
        Ok(Some(Self {
            axis,
            densities,
            window,
            up,
        }))
    }
}

fn draw_panel(page: &Page, laid: &Laid<'_>, rect: Rectangle) -> Result<(), DrawError> {
    let panel = page.panel(rect, laid.across.range, laid.overlaid.up.range);
    for (number, estimated) in &laid.overlaid.densities {
        let stroke = Stroke::curve(*number);
        let band = band(estimated, laid.across.range, laid.overlaid.up.range);
        if !band.is_empty() {
            let fill = stroke.colour.at(BAND);
            panel.draw(&band, Shape::Area(fill))?;
        }
    }
    for (number, estimated) in &laid.overlaid.densities {
        let curve = Shown::new(estimated).curve(laid.across.range);
        let curve = within(curve, laid.overlaid.up.range);
        panel.draw(&curve, Shape::Line(Stroke::curve(*number)))?;
    }
    frame::border(page, rect)?;
    laid.across.draw_below(page, rect, true)?;
    laid.overlaid.up.draw_left(page, rect, true)
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

/// The outline of ± 2 standard errors; empty for a method without sampling.
fn band(estimated: &EstimatedDensity, window: (f64, f64), range: (f64, f64)) -> Vec<(f64, f64)> {
    let errors = &estimated.standard_error;
    let values = &estimated.density.values;
    if errors.len() != values.len() || !errors.iter().any(|&error| error > 0.0) {
        return Vec::new();
    }
    let at = |factor: f64| {
        let edge = move |(cell, centre): (usize, f64)| {
            let value = values[cell] + factor * errors[cell];
            (centre, value.clamp(range.0, range.1))
        };
        cells(&estimated.density, window).map(edge)
    };
    let mut outline: Vec<(f64, f64)> = at(2.0).collect();
    let lower: Vec<(f64, f64)> = at(-2.0).collect();
    outline.extend(lower.into_iter().rev());
    outline
}
