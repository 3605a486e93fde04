//! Joint densities by every method side by side: a row a parameter value, a column a method.

use crate::compare::{ComparedValue, Method};
use crate::density::Observable;
use crate::system::Family;

use super::canvas::DrawError;
use super::canvas::colour_bar::ColourBar;
use super::canvas::frame::Scale;
use super::canvas::page::{Heading, Page, Rectangle};
use super::canvas::style::{MARGIN, TEXT};
use super::joint::{Found, draw_map, windows, write_above};
use super::sketch::{ComparisonScene, Sketch};
use super::{names, select};

/// Side of a map, in pixels.
const SIDE: f64 = 165.0;
/// Gaps between maps.
const BETWEEN: (f64, f64) = (12.0, 12.0);
/// Room of the line above a map.
const ABOVE: f64 = 1.6 * TEXT;

/// The densities of one value by the methods that have one.
fn row(value: &ComparedValue, observable: Observable) -> Vec<(Method, Found<'_>)> {
    let found = |method: Method| {
        let estimated = value.density(method, observable)?;
        let found = Found {
            value: value.value,
            estimated,
            features: &[],
        };
        Some((method, found))
    };
    Method::ALL.into_iter().filter_map(found).collect()
}

/// A figure a pair of axes.
pub(super) fn sketches<'a>(scene: &'a ComparisonScene<'a>) -> Vec<Sketch<'a>> {
    let observables = scene.comparison.subject.observables.iter();
    observables
        .filter(|observable| matches!(observable, Observable::Joint(..)))
        .map(|&observable| {
            let name = format!("joint_{}", names::file(scene.family(), observable));
            Sketch::new(name, move || draw(scene, observable))
        })
        .collect()
}

/// The figure; `None` if there is nothing to draw. Maps of a row share their colours, all share their windows.
fn draw(scene: &ComparisonScene<'_>, observable: Observable) -> Result<Option<Page>, DrawError> {
    let (family, title) = (scene.family(), scene.title);
    let rows: Vec<Vec<(Method, Found<'_>)>> = scene
        .comparison
        .values
        .iter()
        .map(|value| row(value, observable))
        .filter(|row| !row.is_empty())
        .collect();
    let (Observable::Joint(first, second), false) = (observable, rows.is_empty()) else {
        return Ok(None);
    };
    let mut window: Option<((f64, f64), (f64, f64))> = None;
    for row in &rows {
        for (_, found) in row {
            if let Some((x, y)) = windows(std::slice::from_ref(found)) {
                let join = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
                window = Some(window.map_or((x, y), |(a, b)| (join(a, x), join(b, y))));
            }
        }
    }
    let Some((x, y)) = window else {
        return Ok(None);
    };
    let across = Scale::horizontal(x, SIDE, &names::axis(family, first))?;
    let up = Scale::vertical(y, SIDE, &names::axis(family, second))?;
    let mut bars = Vec::new();
    for row in &rows {
        let largest = select::largest(row.iter().map(|(_, found)| found.density()));
        bars.push((
            largest,
            ColourBar::new(largest, SIDE, &names::density(family, observable))?,
        ));
    }
    let widest = bars.iter().map(|(_, bar)| bar.width()).fold(0.0, f64::max);
    let left = MARGIN + up.left();
    let step = (SIDE + BETWEEN.0, ABOVE + SIDE + BETWEEN.1);
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = left + columns as f64 * step.0 - BETWEEN.0 + widest + MARGIN;
    let heading = Heading::new(title, width)?;
    let height = heading.height() + rows.len() as f64 * step.1 + Scale::below() + MARGIN;
    let page = Page::new(width, height);
    heading.draw(&page)?;
    for (number, (row, (largest, bar))) in rows.iter().zip(&bars).enumerate() {
        for (column, (method, found)) in row.iter().enumerate() {
            let map = Rectangle {
                left: left + column as f64 * step.0,
                top: heading.height() + ABOVE + number as f64 * step.1,
                width: SIDE,
                height: SIDE,
            };
            write_above(&page, map, above(*method, found.value, column, family))?;
            draw_map(&page, map, found, (x, y), *largest)?;
            across.draw_below(&page, map, number + 1 == rows.len())?;
            up.draw_left(&page, map, column == 0)?;
            if column + 1 == row.len() {
                bar.draw(&page, map, &[])?;
            }
        }
    }
    Ok(Some(page))
}

/// The line above a map: the value at the head of a row, and the method.
fn above(method: Method, value: f64, column: usize, family: &Family) -> String {
    let title = match method {
        Method::SgcmSlope => "SGCM, corrected",
        method => method.title(),
    };
    match column {
        0 => format!("{}: {title}", names::at(family, value)),
        _ => title.to_owned(),
    }
}
