//! Marginal densities by every method: a row a parameter value, a column an axis; lines for what is solved, symbols with error bars for
//! Monte Carlo.

use plotters_backend::text_anchor::HPos;

use crate::compare::{ComparedValue, Comparison, Method};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::system::Family;

use super::canvas::DrawError;
use super::canvas::frame::{self, Scale};
use super::canvas::legend::{self, Legend, Sample};
use super::canvas::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use super::canvas::style::{BLACK, ERROR_LINE, MARGIN, Stroke, TEXT};
use super::marginals::{cells, curve};
use super::sketch::{ComparisonScene, Sketch};
use super::{names, select};

/// Size of a panel, in pixels.
const PANEL: (f64, f64) = (270.0, 165.0);
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

/// A panel laid out.
struct Laid<'a> {
    value: &'a ComparedValue,
    observable: Observable,
    across: Scale,
    up: Scale,
}

/// The figure of all marginals.
pub(super) fn sketches<'a>(scene: &'a ComparisonScene<'a>) -> Vec<Sketch<'a>> {
    vec![Sketch::new("marginals", || draw(scene))]
}

/// The figure; `None` if there is nothing to draw.
fn draw(scene: &ComparisonScene<'_>) -> Result<Option<Page>, DrawError> {
    let (comparison, family, title) = (scene.comparison, scene.family(), scene.title);
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
    let mut rows: Vec<Vec<Laid<'_>>> = Vec::new();
    for &value in &values {
        let mut row = Vec::new();
        for &observable in &watched {
            row.extend(lay_out(comparison, value, observable, family)?);
        }
        rows.push(row);
    }
    if rows.iter().all(Vec::is_empty) {
        return Ok(None);
    }
    let left_of = |laid: &Laid<'_>| laid.up.left();
    let room = rows.iter().flatten().map(left_of).fold(0.0, f64::max);
    let step = (room + PANEL.0 + BETWEEN.0, ABOVE + PANEL.1 + BETWEEN.1);
    let page_width = MARGIN + watched.len() as f64 * step.0 - BETWEEN.0 + 10.0 + MARGIN;
    let heading = Heading::new(title, page_width)?;
    let legend = Legend::new(entries(), page_width - 2.0 * MARGIN)?;
    let top = heading.height() + legend.height();
    let height = top + rows.len() as f64 * step.1 + Scale::below() + MARGIN;
    let page = Page::new(page_width, height);
    heading.draw(&page)?;
    legend.draw(&page, 0.5 * page_width, heading.height())?;
    for (number, row) in rows.iter().enumerate() {
        for (column, laid) in row.iter().enumerate() {
            let rect = Rectangle {
                left: MARGIN + room + column as f64 * step.0,
                top: top + ABOVE + number as f64 * step.1,
                width: PANEL.0,
                height: PANEL.1,
            };
            let letter = char::from(b'a' + ((number * row.len() + column) % 26) as u8);
            let above = format!("({letter})  {}", names::at(family, laid.value.value));
            let place = (rect.left, rect.top - 0.7 * TEXT);
            page.text(place, lettering(above, HPos::Left))?;
            draw_panel(&page, laid, rect, number + 1 == rows.len())?;
        }
    }
    Ok(Some(page))
}

fn entries() -> Vec<(Sample, String)> {
    let entry = |method: &Method| {
        let sample = match method {
            Method::MonteCarlo => Sample::Symbol(BLACK),
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
    comparison: &Comparison,
    value: &'a ComparedValue,
    observable: Observable,
    family: &Family,
) -> Result<Option<Laid<'a>>, DrawError> {
    let Observable::Marginal(axis) = observable else {
        return Ok(None);
    };
    let at = |value: &'a ComparedValue| densities(value, observable).map(|(_, one)| &one.density);
    let own: Vec<&Density> = at(value).collect();
    let all: Vec<&Density> = comparison
        .values
        .iter()
        .flat_map(|value| densities(value, observable).map(|(_, one)| &one.density))
        .collect();
    let Some(window) = select::window(&all, 0) else {
        return Ok(None);
    };
    let highest = select::largest(own);
    if highest <= 0.0 {
        return Ok(None);
    }
    Ok(Some(Laid {
        value,
        observable,
        across: Scale::horizontal(window, PANEL.0, &names::axis(family, axis))?,
        up: Scale::vertical(
            (0.0, 1.08 * highest),
            PANEL.1,
            &names::density(family, observable),
        )?,
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
) -> Result<(), DrawError> {
    let panel = page.panel(rect, laid.across.range, laid.up.range);
    let drawn = |method: Method| laid.value.density(method, laid.observable);
    // Symbols lie over the lines, and the generator's line over those of SGCM.
    for method in [Method::Sgcm, Method::SgcmSlope, Method::Generator] {
        if let Some(estimated) = drawn(method) {
            let line = curve(&estimated.density, laid.across.range, laid.up.range);
            panel.draw(&line, Shape::Line(stroke(method)))?;
        }
    }
    if let Some(estimated) = drawn(Method::MonteCarlo) {
        draw_symbols(&panel, estimated, laid.across.range, laid.up.range)?;
    }
    frame::border(page, rect)?;
    laid.across.draw_below(page, rect, labels)?;
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
        panel.draw(&bar, Shape::Line(Stroke::solid(BLACK, ERROR_LINE)))?;
        let place = (centre, value.clamp(range.0, range.1));
        legend::symbol(|points, shape| panel.draw(points, shape), 0, place, BLACK)?;
    }
    Ok(())
}
