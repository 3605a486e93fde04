//! Marginal densities at several parameter values, overlaid: a panel an axis, side by side.

use plotters_backend::BackendColor;

use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::system::Family;

use super::canvas::DrawError;
use super::canvas::frame::{self, Scale};
use super::canvas::legend::{Legend, Sample};
use super::canvas::page::{Heading, Page, Rectangle, Shape};
use super::canvas::style::{MARGIN, Stroke};
use super::sketch::{Sketch, SweepScene};
use super::{names, select};

/// Height of a panel, in pixels.
const HEIGHT: f64 = 210.0;
/// Gap between panels.
const BETWEEN: f64 = 18.0;
/// Opacity of the band of two standard errors.
const BAND: f64 = 0.18;

/// One panel laid out.
struct Laid<'a> {
    densities: Vec<(usize, &'a EstimatedDensity)>,
    across: Scale,
    up: Scale,
    left: f64,
}

/// The figure of all observed marginals.
pub(super) fn sketches<'a>(scene: &'a SweepScene<'a>) -> Vec<Sketch<'a>> {
    vec![Sketch::new("marginals", || draw(scene))]
}

/// The figure of all observed marginals at the chosen points; `None` if there is nothing to draw.
fn draw(scene: &SweepScene<'_>) -> Result<Option<Page>, DrawError> {
    let (result, family, title) = (scene.result, scene.family(), scene.title);
    let chosen = scene.chosen.as_slice();
    let is_marginal =
        |(_, observable): &(usize, &Observable)| matches!(observable, Observable::Marginal(_));
    let watched: Vec<usize> = result
        .subject
        .observables
        .iter()
        .enumerate()
        .filter(is_marginal)
        .map(|(i, _)| i)
        .collect();
    let width = match watched.len() {
        0 | 1 => 380.0,
        2 => 235.0,
        _ => 215.0,
    };
    let mut panels = Vec::new();
    let mut left = MARGIN;
    for observable in watched {
        if let Some(panel) = lay_out(result, observable, chosen, family, (left, width))? {
            left = panel.left + width + BETWEEN;
            panels.push(panel);
        }
    }
    if panels.is_empty() {
        return Ok(None);
    }
    let page_width = left - BETWEEN + 10.0 + MARGIN;
    let heading = Heading::new(title, page_width)?;
    let entry = |(number, point): (usize, &&Point)| {
        (
            Sample::Curve(Stroke::curve(number)),
            names::at(family, point.value),
        )
    };
    let legend = Legend::new(
        chosen.iter().enumerate().map(entry).collect(),
        page_width - 2.0 * MARGIN,
    )?;
    let top = heading.height() + legend.height() + 6.0;
    let page = Page::new(page_width, top + HEIGHT + Scale::below() + MARGIN);
    heading.draw(&page)?;
    legend.draw(&page, 0.5 * page_width, heading.height())?;
    for panel in &panels {
        let rect = Rectangle {
            left: panel.left,
            top,
            width,
            height: HEIGHT,
        };
        draw_panel(&page, panel, rect)?;
    }
    Ok(Some(page))
}

/// Lays out the panel of one marginal, from `from` pixels on.
fn lay_out<'a>(
    result: &SweepResult,
    observable: usize,
    chosen: &[&'a Point],
    family: &Family,
    (from, width): (f64, f64),
) -> Result<Option<Laid<'a>>, DrawError> {
    let watched = result.subject.observables[observable];
    let Observable::Marginal(axis) = watched else {
        return Ok(None);
    };
    let drawable =
        |(number, point): (usize, &&'a Point)| Some((number, select::density(point, observable)?));
    let densities: Vec<(usize, &EstimatedDensity)> =
        chosen.iter().enumerate().filter_map(drawable).collect();
    let bare: Vec<&Density> = densities
        .iter()
        .map(|(_, estimated)| &estimated.density)
        .collect();
    let Some(window) = select::window(&bare, 0) else {
        return Ok(None);
    };
    let highest = select::largest(bare.iter().copied());
    let up = Scale::vertical(
        (0.0, 1.06 * highest),
        HEIGHT,
        &names::density(family, watched),
    )?;
    Ok(Some(Laid {
        densities,
        across: Scale::horizontal(window, width, &names::axis(family, axis))?,
        left: from + up.left(),
        up,
    }))
}

fn draw_panel(page: &Page, laid: &Laid<'_>, rect: Rectangle) -> Result<(), DrawError> {
    let panel = page.panel(rect, laid.across.range, laid.up.range);
    for (number, estimated) in &laid.densities {
        let stroke = Stroke::curve(*number);
        let band = band(estimated, laid.across.range, laid.up.range);
        if !band.is_empty() {
            let fill = BackendColor {
                alpha: BAND,
                ..stroke.colour
            };
            panel.draw(&band, Shape::Area(fill))?;
        }
    }
    for (number, estimated) in &laid.densities {
        let curve = curve(&estimated.density, laid.across.range, laid.up.range);
        panel.draw(&curve, Shape::Line(Stroke::curve(*number)))?;
    }
    frame::border(page, rect)?;
    laid.across.draw_below(page, rect, true)?;
    laid.up.draw_left(page, rect, true)
}

/// Numbers and centres of the cells inside a window.
pub(super) fn cells(density: &Density, window: (f64, f64)) -> impl Iterator<Item = (usize, f64)> {
    let centres = density.axes[0].centres().into_iter().enumerate();
    centres.filter(move |(_, centre)| *centre >= window.0 && *centre <= window.1)
}

/// The density at the centres of its cells.
pub(super) fn curve(density: &Density, window: (f64, f64), range: (f64, f64)) -> Vec<(f64, f64)> {
    cells(density, window)
        .filter(|(cell, _)| density.values[*cell].is_finite())
        .map(|(cell, centre)| (centre, density.values[cell].clamp(range.0, range.1)))
        .collect()
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
