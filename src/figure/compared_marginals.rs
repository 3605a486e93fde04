//! Marginal densities by every method: a row a parameter value, a column an axis; lines for what is solved, symbols
//! with error bars for Monte Carlo.

use plotters_backend::text_anchor::HPos;

use crate::compare::{ComparedValue, Method};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::system::Family;

use super::canvas::DrawError;
use super::canvas::frame::{self, Scale};
use super::canvas::legend::{self, Legend, Sample};
use super::canvas::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use super::canvas::style::{ERROR_LINE, INK, MARGIN, Stroke, TEXT};
use super::joint::lettered;
use super::marginals::{cells, within};
use super::shown::Shown;
use super::sketch::{ComparisonScene, Sketch};
use super::told::Shows;
use super::{names, select};

/// Size of a panel, in pixels.
const PANEL: (f64, f64) = (270.0, 165.0);
/// Narrowest panel beside another where the page is given.
const NARROWEST: f64 = 180.0;
/// Room right of the last panel, for half a label of its axis.
const BESIDE: f64 = 10.0;
/// Gaps between panels; above each stands its value.
const BETWEEN: (f64, f64) = (20.0, 12.0);
/// Room of the line above a panel.
const ABOVE: f64 = 1.5 * TEXT;
/// Error bars are this many standard errors long to either side.
const ERRORS: f64 = 2.0;

/// The line of a method; Monte Carlo has symbols instead.
pub(super) fn stroke(method: Method) -> Stroke {
    let number = Method::ALL.iter().position(|&one| one == method);
    Stroke::curve(number.unwrap_or(0))
}

/// What is shown of the density of a method: only that of the generator is followed between its cells.
pub(super) fn shown(method: Method, estimated: &EstimatedDensity) -> Shown<'_> {
    match method {
        Method::Generator => Shown::new(estimated),
        _ => Shown::by_cells(estimated),
    }
}

/// A panel laid out.
struct Laid<'a> {
    value: &'a ComparedValue,
    observable: Observable,
    axis: usize,
    window: (f64, f64),
    up: Scale,
}

/// The figure of all marginals.
pub(super) fn sketches<'a>(scene: &'a ComparisonScene<'a>) -> Vec<Sketch<'a>> {
    vec![Sketch::new("marginals", || draw(scene)).showing(Shows::ComparedMarginals)]
}

/// The figure; `None` if there is nothing to draw.
fn draw(scene: &ComparisonScene<'_>) -> Result<Option<Page>, DrawError> {
    let (comparison, family, look) = (scene.comparison, scene.family(), &scene.look);
    let is_marginal = |one: &Observable| matches!(one, Observable::Marginal(_));
    let watched: Vec<Observable> = comparison
        .subject
        .observables
        .iter()
        .copied()
        .filter(is_marginal)
        .collect();
    let has_density = |value: &&ComparedValue| value.solved.iter().any(|s| !s.densities.is_empty());
    let values: Vec<&ComparedValue> = comparison.values.iter().filter(has_density).collect();
    let mut all: Vec<Laid<'_>> = Vec::new();
    for &value in &values {
        for &observable in &watched {
            all.extend(lay_out(scene, value, observable)?);
        }
    }
    if all.is_empty() {
        return Ok(None);
    }
    let room = all.iter().map(|laid| laid.up.left()).fold(0.0, f64::max);
    let width = |columns: usize| {
        let beside = 2.0 * MARGIN + BESIDE + columns as f64 * (room + BETWEEN.0) - BETWEEN.0;
        look.fill(PANEL.0 * columns as f64, beside) / columns as f64
    };
    let fitting = (1..=watched.len())
        .rev()
        .find(|&columns| width(columns) >= NARROWEST);
    let columns = fitting.unwrap_or(1);
    let wide = width(columns);
    let rows = all.len().div_ceil(columns);
    let step = (room + wide + BETWEEN.0, ABOVE + PANEL.1 + BETWEEN.1);
    let page_width = 2.0 * MARGIN + columns as f64 * step.0 - BETWEEN.0 + BESIDE;
    let heading = Heading::new(look, scene.title, page_width)?;
    let legend = Legend::new(look, entries(), page_width - 2.0 * MARGIN)?;
    let top = heading.height() + legend.height();
    // Panels of one axis stand below each other only where every axis has a column.
    let labelled_below = |number: usize| columns < watched.len() || number + columns >= all.len();
    let step = match columns < watched.len() {
        true => (step.0, step.1 + Scale::below()),
        false => step,
    };
    let below = if columns < watched.len() {
        0.0
    } else {
        Scale::below()
    };
    let height = top + rows as f64 * step.1 + below + MARGIN;
    let page = Page::new(look, page_width, height);
    heading.draw(&page)?;
    legend.draw(&page, 0.5 * page_width, heading.height())?;
    for (number, laid) in all.iter().enumerate() {
        let rect = Rectangle {
            left: MARGIN + room + (number % columns) as f64 * step.0,
            top: top + ABOVE + (number / columns) as f64 * step.1,
            width: wide,
            height: PANEL.1,
        };
        let above = lettered(look, number, names::at(family, laid.value.value));
        let place = (rect.left, rect.top - 0.7 * TEXT);
        page.text(place, lettering(above, HPos::Left))?;
        draw_panel(&page, laid, rect, labelled_below(number), family)?;
    }
    Ok(Some(page))
}

fn entries() -> Vec<(Sample, String)> {
    let entry = |method: &Method| {
        let sample = match method {
            Method::MonteCarlo => Sample::Symbol(INK),
            method => Sample::Curve(stroke(*method)),
        };
        let text = match method {
            Method::MonteCarlo => format!("{} ± {ERRORS} standard errors", method.title()),
            method => method.title().to_owned(),
        };
        (sample, text)
    };
    Method::ALL.iter().map(entry).collect()
}

/// Lays out the panel of one marginal at one value; all values share the window of an axis.
fn lay_out<'a>(
    scene: &ComparisonScene<'a>,
    value: &'a ComparedValue,
    observable: Observable,
) -> Result<Option<Laid<'a>>, DrawError> {
    let Observable::Marginal(axis) = observable else {
        return Ok(None);
    };
    let all: Vec<&Density> = scene
        .comparison
        .values
        .iter()
        .flat_map(|value| densities(value, observable).map(|(_, one)| &one.density))
        .collect();
    let Some(window) = select::window(&all, 0) else {
        return Ok(None);
    };
    let own = densities(value, observable).map(|(method, one)| shown(method, one).largest);
    let highest = own.fold(0.0, f64::max);
    if highest <= 0.0 {
        return Ok(None);
    }
    let title = names::density(scene.family(), observable);
    Ok(Some(Laid {
        value,
        observable,
        axis,
        window,
        up: Scale::vertical(&scene.look, (0.0, 1.08 * highest), PANEL.1, &title)?,
    }))
}

/// The densities of one observable, with their methods.
fn densities(
    value: &ComparedValue,
    observable: Observable,
) -> impl Iterator<Item = (Method, &EstimatedDensity)> {
    Method::ALL
        .into_iter()
        .filter_map(move |method| Some((method, value.density(method, observable)?)))
}

fn draw_panel(
    page: &Page,
    laid: &Laid<'_>,
    rect: Rectangle,
    labels: bool,
    family: &Family,
) -> Result<(), DrawError> {
    let title = names::axis(family, laid.axis);
    let across = Scale::horizontal(page.look(), laid.window, rect.width, &title)?;
    let panel = page.panel(rect, laid.window, laid.up.range);
    let drawn = |method: Method| laid.value.density(method, laid.observable);
    // Symbols lie over the lines, and the generator's line over those of SGCM.
    for method in [Method::Sgcm, Method::SgcmSlope, Method::Generator] {
        if let Some(estimated) = drawn(method) {
            let line = within(shown(method, estimated).curve(laid.window), laid.up.range);
            panel.draw(&line, Shape::Line(stroke(method)))?;
        }
    }
    if let Some(estimated) = drawn(Method::MonteCarlo) {
        draw_symbols(&panel, estimated, laid.window, laid.up.range)?;
    }
    frame::border(page, rect)?;
    across.draw_below(page, rect, labels)?;
    laid.up.draw_left(page, rect, true)
}

/// A symbol with an error bar at every cell in the window.
fn draw_symbols(
    panel: &Panel,
    estimated: &EstimatedDensity,
    window: (f64, f64),
    range: (f64, f64),
) -> Result<(), DrawError> {
    let density = &estimated.density;
    for (cell, centre) in cells(density, window) {
        let (value, error) = (density.values[cell], estimated.standard_error[cell]);
        let end = |sign: f64| (value + sign * ERRORS * error).clamp(range.0, range.1);
        let bar = [(centre, end(-1.0)), (centre, end(1.0))];
        panel.draw(&bar, Shape::Line(Stroke::solid(INK, ERROR_LINE)))?;
        let place = (centre, value.clamp(range.0, range.1));
        legend::symbol(|points, shape| panel.draw(points, shape), 0, place, INK)?;
    }
    Ok(())
}
