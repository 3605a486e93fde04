//! Joint densities of two axes as heat maps with contours: one figure a parameter value, and a sheet of all.

use plotters_backend::text_anchor::HPos;

use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::topology::{Feature, FeatureKind, Verdict};

use super::colour_bar::ColourBar;
use super::contour::Grid;
use super::frame::{self, Scale};
use super::heat::Picture;
use super::legend::{self, Legend, Sample};
use super::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use super::select::{self, Names};
use super::style::{self, MARGIN, Stroke, TEXT};
use super::{Figure, FigureError, symbols};

/// Contours are drawn at these shares of the largest density.
const LEVELS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Side of the map of a single figure, in pixels.
const SINGLE: f64 = 290.0;
/// Side of a map on a sheet.
const SMALL: f64 = 190.0;
/// Gap between maps on a sheet.
const BETWEEN: f64 = 14.0;
/// The densities of a sheet share their scale unless the largest values differ by more than this factor.
const COMPARABLE: f64 = 3.0;

/// A joint density with what was found in it.
struct Found<'a> {
    value: f64,
    estimated: &'a EstimatedDensity,
    features: &'a [Feature],
}

impl<'a> Found<'a> {
    fn new(point: &'a Point, observable: usize) -> Option<Self> {
        let estimated = select::density(point, observable)?;
        let detection = point.detections.get(observable);
        Some(Self {
            value: point.value,
            estimated,
            features: detection.map_or(&[], |detection| &detection.features),
        })
    }

    fn density(&self) -> &'a Density {
        &self.estimated.density
    }

    fn present(&self, kind: FeatureKind) -> impl Iterator<Item = (f64, f64)> {
        let wanted =
            move |feature: &&Feature| feature.kind == kind && feature.verdict == Verdict::Present;
        let place = |feature: &Feature| match feature.position[..] {
            [x, y] => Some((x, y)),
            _ => None,
        };
        self.features.iter().filter(wanted).filter_map(place)
    }
}

/// The windows of both axes.
fn windows(found: &[Found<'_>]) -> Option<((f64, f64), (f64, f64))> {
    let densities: Vec<&Density> = found.iter().map(Found::density).collect();
    Some((
        select::window(&densities, 0)?,
        select::window(&densities, 1)?,
    ))
}

/// One map at one point; `None` without a density.
///
/// # Errors
/// Any [`FigureError`] but that of writing.
pub(super) fn single(
    result: &SweepResult,
    observable: usize,
    point: &Point,
    names: Names<'_>,
    title: &str,
) -> Result<Option<Figure>, FigureError> {
    let watched = result.observables[observable];
    let (Observable::Joint(first, second), Some(found)) = (watched, Found::new(point, observable))
    else {
        return Ok(None);
    };
    let found = [found];
    let Some((x, y)) = windows(&found) else {
        return Ok(None);
    };
    let largest = select::largest([found[0].density()]);
    let across = Scale::horizontal(x, SINGLE, &names.axis(first))?;
    let up = Scale::vertical(y, SINGLE, &names.axis(second))?;
    let bar = ColourBar::new(largest, SINGLE, &names.density(watched))?;
    let width = MARGIN + up.left() + SINGLE + bar.width() + MARGIN;
    let heading = Heading::new(title, width)?;
    let map = Rectangle {
        left: MARGIN + up.left(),
        top: heading.height() + ColourBar::above(),
        width: SINGLE,
        height: SINGLE,
    };
    let legend = Legend::new(entries(&found), width - 2.0 * MARGIN)?;
    let below = map.bottom() + Scale::below();
    let page = Page::new(width, below + legend.height() + MARGIN);
    heading.draw(&page)?;
    let at = (map.left, map.top - 0.85 * TEXT);
    page.text(at, lettering(names.at(point.value), HPos::Left))?;
    draw_map(&page, map, &found[0], (x, y), largest)?;
    across.draw_below(&page, map, true)?;
    up.draw_left(&page, map, true)?;
    bar.draw(&page, map, &LEVELS)?;
    legend.draw(&page, map.left + 0.5 * map.width, below)?;
    let value = symbols::rounded(point.value);
    Ok(Some(Figure {
        name: format!(
            "joint_{}_{}",
            names.file(watched),
            select::safe(&value.to_string())
        ),
        svg: page.svg(),
    }))
}

/// All maps of a pair on one sheet, with the same windows; `None` for fewer than two densities.
///
/// # Errors
/// Any [`FigureError`] but that of writing.
pub(super) fn sheet(
    result: &SweepResult,
    observable: usize,
    chosen: &[&Point],
    names: Names<'_>,
    title: &str,
) -> Result<Option<Figure>, FigureError> {
    let watched = result.observables[observable];
    let found: Vec<Found<'_>> = chosen
        .iter()
        .filter_map(|point| Found::new(point, observable))
        .collect();
    let (Observable::Joint(first, second), Some((x, y))) = (watched, windows(&found)) else {
        return Ok(None);
    };
    if found.len() < 2 {
        return Ok(None);
    }
    let columns = match found.len() {
        2 | 4 => 2,
        _ => 3,
    };
    let rows = found.len().div_ceil(columns);
    let each: Vec<f64> = found
        .iter()
        .map(|found| select::largest([found.density()]))
        .collect();
    let largest = each.iter().copied().fold(0.0, f64::max);
    let common = each.iter().all(|&own| own * COMPARABLE >= largest);
    let across = Scale::horizontal(x, SMALL, &names.axis(first))?;
    let up = Scale::vertical(y, SMALL, &names.axis(second))?;
    let step = (SMALL + BETWEEN, SMALL + BETWEEN + 1.4 * TEXT);
    let whole = (
        columns as f64 * step.0 - BETWEEN,
        rows as f64 * step.1 - step.1 + SMALL,
    );
    let density = names.density(watched);
    let bar = match common {
        true => ColourBar::new(largest, whole.1, &density)?,
        false => ColourBar::new(1.0, whole.1, &format!("{density} / max"))?,
    };
    let width = MARGIN + up.left() + whole.0 + bar.width() + MARGIN;
    let heading = Heading::new(title, width)?;
    let all = Rectangle {
        left: MARGIN + up.left(),
        top: heading.height() + ColourBar::above(),
        width: whole.0,
        height: whole.1,
    };
    let legend = Legend::new(entries(&found), width - 2.0 * MARGIN)?;
    let below = all.bottom() + Scale::below();
    let page = Page::new(width, below + legend.height() + MARGIN);
    heading.draw(&page)?;
    for (number, (found, own)) in found.iter().zip(&each).enumerate() {
        let (row, column) = (number / columns, number % columns);
        let map = Rectangle {
            left: all.left + column as f64 * step.0,
            top: all.top + row as f64 * step.1,
            width: SMALL,
            height: SMALL,
        };
        draw_map(
            &page,
            map,
            found,
            (x, y),
            if common { largest } else { *own },
        )?;
        draw_letter(&page, map, number, &names.at(found.value))?;
        // A map with none below it carries the labels of its column.
        across.draw_below(&page, map, number + columns >= each.len())?;
        up.draw_left(&page, map, column == 0)?;
    }
    let marks: &[f64] = if common { &[] } else { &LEVELS };
    bar.draw(&page, all, marks)?;
    legend.draw(&page, all.left + 0.5 * all.width, below)?;
    Ok(Some(Figure {
        name: format!("joint_{}", names.file(watched)),
        svg: page.svg(),
    }))
}

/// Writes `(a)` and the parameter's value above a map of a sheet.
fn draw_letter(page: &Page, map: Rectangle, number: usize, at: &str) -> Result<(), FigureError> {
    let letter = char::from(b'a' + (number % 26) as u8);
    let place = (map.left, map.top - 0.75 * TEXT);
    page.text(place, lettering(format!("({letter})  {at}"), HPos::Left))
}

/// Legend of the marks that are drawn.
fn entries(found: &[Found<'_>]) -> Vec<(Sample, String)> {
    let any = |kind| {
        found
            .iter()
            .any(|found| found.present(kind).next().is_some())
    };
    let all = [
        (any(FeatureKind::Peak), Sample::Plus, "peak"),
        (any(FeatureKind::Crater), Sample::Ring, "crater"),
    ];
    let shown = all.into_iter().filter(|(shown, _, _)| *shown);
    shown
        .map(|(_, sample, text)| (sample, text.to_owned()))
        .collect()
}

/// Draws heat map, contours and marks into a rectangle; colours run from zero to `largest`.
fn draw_map(
    page: &Page,
    map: Rectangle,
    found: &Found<'_>,
    (x, y): ((f64, f64), (f64, f64)),
    largest: f64,
) -> Result<(), FigureError> {
    let panel = page.panel(map, x, y);
    let density = found.density();
    let [across, up] = &density.axes[..] else {
        return Ok(());
    };
    let size = (
        select::resolution(&[across], x, map.width),
        select::resolution(&[up], y, map.height),
    );
    let middle = |window: (f64, f64), pixel: usize, count: usize| {
        window.0 + (window.1 - window.0) * (pixel as f64 + 0.5) / count as f64
    };
    let picture = Picture::new(size, |column, row| {
        let i = across.find(middle(x, column, size.0))?;
        let j = up.find(middle(y, row, size.1))?;
        Some(density.values[i * up.count() + j] / largest)
    });
    panel.draw(&[(x.0, y.0), (x.1, y.1)], Shape::Image(picture.png()?))?;
    draw_contours(&panel, density, (x, y), largest)?;
    let inside = |&(px, py): &(f64, f64)| px >= x.0 && px <= x.1 && py >= y.0 && py <= y.1;
    for place in found.present(FeatureKind::Peak).filter(inside) {
        legend::plus(|points, shape| panel.draw(points, shape), place)?;
    }
    for place in found.present(FeatureKind::Crater).filter(inside) {
        legend::ring(|points, shape| panel.draw(points, shape), place)?;
    }
    frame::border(page, map)
}

/// Draws the contours at [`LEVELS`] of the density's own maximum, through the centres of cells in the window.
fn draw_contours(
    panel: &Panel,
    density: &Density,
    (x, y): ((f64, f64), (f64, f64)),
    largest: f64,
) -> Result<(), FigureError> {
    let inside = |axis: usize, window: (f64, f64)| -> Vec<(usize, f64)> {
        let centres = density.axes[axis].centres().into_iter().enumerate();
        centres
            .filter(|(_, centre)| *centre > window.0 && *centre < window.1)
            .collect()
    };
    let (across, up) = (inside(0, x), inside(1, y));
    let count = density.axes[1].count();
    let values: Vec<f64> = across
        .iter()
        .flat_map(|(i, _)| up.iter().map(move |(j, _)| i * count + j))
        .map(|cell| density.values[cell])
        .collect();
    let centres =
        |cells: &[(usize, f64)]| -> Vec<f64> { cells.iter().map(|cell| cell.1).collect() };
    let (across, up) = (centres(&across), centres(&up));
    let grid = Grid {
        x: &across,
        y: &up,
        values: &values,
    };
    let own = select::largest([density]);
    for share in LEVELS {
        let colour = style::on_heat(share * own / largest);
        for line in grid.contour(share * own) {
            panel.draw(&line, Shape::Line(Stroke::solid(colour, 0.8)))?;
        }
    }
    Ok(())
}
