//! Joint densities of two axes as heat maps with contours: one figure a parameter value, and a sheet of all.

use plotters_backend::text_anchor::HPos;

use crate::continuation::Point;
use crate::density::{Density, EstimatedDensity, Observable};
use crate::topology::{Feature, FeatureKind, Verdict};

use super::canvas::colour_bar::ColourBar;
use super::canvas::contour::Grid;
use super::canvas::frame::{self, Scale};
use super::canvas::heat::Picture;
use super::canvas::legend::{self, Legend, Sample};
use super::canvas::look::Look;
use super::canvas::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use super::canvas::style::{self, MARGIN, Stroke, TEXT};
use super::canvas::{DrawError, symbols};
use super::sketch::{Sketch, SweepScene};
use super::{names, select};

/// Contours are drawn at these shares of the largest density.
const LEVELS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Side of the map of a single figure, in pixels.
const SINGLE: f64 = 290.0;
/// Side of a map on a sheet.
const SMALL: f64 = 190.0;
/// Narrowest map on a sheet, where the page is given, and the highest one.
const SMALLEST: f64 = 104.0;
const TALLEST_SMALL: f64 = 230.0;
/// Highest map of a single figure.
const TALLEST: f64 = 420.0;
/// Gap between maps on a sheet.
const BETWEEN: f64 = 14.0;
/// The densities of a sheet share their scale unless the largest values differ by more than this factor.
const COMPARABLE: f64 = 3.0;

/// A joint density with what was found in it.
pub(super) struct Found<'a> {
    pub(super) value: f64,
    pub(super) estimated: &'a EstimatedDensity,
    pub(super) features: &'a [Feature],
}

impl<'a> Found<'a> {
    /// The joint density with that number among the observables at a point; `None` where there is none.
    pub(super) fn new(point: &'a Point, observable: usize) -> Option<Self> {
        let estimated = select::density(point, observable)?;
        let detection = point.detections.get(observable);
        Some(Self {
            value: point.value,
            estimated,
            features: detection.map_or(&[], |detection| &detection.features),
        })
    }

    pub(super) fn density(&self) -> &'a Density {
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
pub(super) fn windows(found: &[Found<'_>]) -> Option<((f64, f64), (f64, f64))> {
    let densities: Vec<&Density> = found.iter().map(Found::density).collect();
    Some((
        select::window(&densities, 0)?,
        select::window(&densities, 1)?,
    ))
}

/// Opens a page with heading and legend, and room for maps of the given size that begins `left`
/// pixels from the left; returns the rectangle of the maps.
fn open_page(
    look: &Look,
    found: &[Found<'_>],
    title: &str,
    (left, page_width): (f64, f64),
    (width, height): (f64, f64),
) -> Result<(Page, Rectangle), DrawError> {
    let heading = Heading::new(look, title, page_width)?;
    let legend = Legend::new(look, entries(found), page_width - 2.0 * MARGIN)?;
    let maps = Rectangle {
        left,
        top: heading.height() + ColourBar::above(),
        width,
        height,
    };
    let below = maps.bottom() + Scale::below();
    let page = Page::new(look, page_width, below + legend.height() + MARGIN);
    heading.draw(&page)?;
    legend.draw(&page, left + 0.5 * width, below)?;
    Ok((page, maps))
}

/// A sheet an observed pair of axes, then its maps one by one.
pub(super) fn sketches<'a>(scene: &'a SweepScene<'a>) -> Vec<Sketch<'a>> {
    let mut sketches = Vec::new();
    for (number, &observable) in scene.result.subject.observables.iter().enumerate() {
        if matches!(observable, Observable::Joint(..)) {
            let name = format!("joint_{}", names::file(scene.family(), observable));
            let single = |&point: &&'a Point| {
                let value = select::safe(&symbols::rounded(point.value).to_string());
                Sketch::new(format!("{name}_{value}"), move || {
                    draw_single(scene, number, point)
                })
            };
            let singles = scene.chosen.iter().map(single);
            sketches.push(Sketch::new(&name, move || draw_sheet(scene, number)));
            sketches.extend(singles);
        }
    }
    sketches
}

/// One map at one point; `None` without a density.
fn draw_single(
    scene: &SweepScene<'_>,
    observable: usize,
    point: &Point,
) -> Result<Option<Page>, DrawError> {
    let family = scene.family();
    let watched = scene.result.subject.observables[observable];
    let (Observable::Joint(first, second), Some(found)) = (watched, Found::new(point, observable))
    else {
        return Ok(None);
    };
    let found = [found];
    let Some((x, y)) = windows(&found) else {
        return Ok(None);
    };
    let look = &scene.look;
    let largest = select::largest([found[0].density()]);
    let high = look
        .page
        .map_or(SINGLE, |page| (0.68 * page).clamp(170.0, TALLEST));
    let up = Scale::vertical(look, y, high, &names::axis(family, second))?;
    let bar = ColourBar::new(look, largest, high, &names::density(family, watched))?;
    let left = MARGIN + up.left();
    let wide = look.fill(SINGLE, left + bar.width() + MARGIN);
    let across = Scale::horizontal(look, x, wide, &names::axis(family, first))?;
    let width = left + wide + bar.width() + MARGIN;
    let (page, map) = open_page(look, &found, scene.title, (left, width), (wide, high))?;
    write_above(&page, map, names::at(family, point.value))?;
    draw_map(&page, map, &found[0], (x, y), largest)?;
    across.draw_below(&page, map, true)?;
    up.draw_left(&page, map, true)?;
    bar.draw(&page, map, &LEVELS)?;
    Ok(Some(page))
}

/// How the maps of a sheet are arranged and coloured.
struct Sheet {
    columns: usize,
    /// Width and height of a map, in pixels.
    side: (f64, f64),
    /// Distance between neighbouring maps, in pixels.
    step: (f64, f64),
    /// Size of all maps together, in pixels.
    whole: (f64, f64),
    /// The density at the upper end of the colours, one a map.
    tops: Vec<f64>,
    /// That density where all maps share it.
    common: Option<f64>,
}

impl Sheet {
    /// Arranges maps in as many columns as there is room for between what stands left and right of them all, `beside` pixels.
    fn new(look: &Look, found: &[Found<'_>], beside: f64) -> Self {
        let own_columns = match found.len() {
            2 | 4 => 2,
            _ => 3,
        };
        let width = |columns: usize| {
            let gaps = (columns - 1) as f64 * BETWEEN;
            look.fill(SMALL * columns as f64, beside + gaps) / columns as f64
        };
        let columns = match look.page {
            None => own_columns,
            Some(_) => {
                let most = if found.len() % 3 == 0 { 3 } else { 4 };
                let fits = |columns: &usize| width(*columns) >= SMALLEST;
                (1..=most.min(found.len())).rev().find(fits).unwrap_or(1)
            }
        };
        let side = (width(columns), width(columns).min(TALLEST_SMALL));
        let rows = found.len().div_ceil(columns);
        let step = (side.0 + BETWEEN, side.1 + BETWEEN + 1.4 * TEXT);
        let own: Vec<f64> = found
            .iter()
            .map(|found| select::largest([found.density()]))
            .collect();
        let largest = own.iter().copied().fold(0.0, f64::max);
        let comparable = own.iter().all(|&own| own * COMPARABLE >= largest);
        Self {
            columns,
            side,
            step,
            whole: (
                (columns - 1) as f64 * step.0 + side.0,
                (rows - 1) as f64 * step.1 + side.1,
            ),
            tops: if comparable {
                vec![largest; own.len()]
            } else {
                own
            },
            common: comparable.then_some(largest),
        }
    }

    /// The rectangle of a map.
    fn map(&self, all: Rectangle, number: usize) -> Rectangle {
        let (row, column) = (number / self.columns, number % self.columns);
        Rectangle {
            left: all.left + column as f64 * self.step.0,
            top: all.top + row as f64 * self.step.1,
            width: self.side.0,
            height: self.side.1,
        }
    }

    /// The colour bar of all maps.
    fn bar(&self, look: &Look, density: &str) -> Result<ColourBar, DrawError> {
        match self.common {
            Some(largest) => ColourBar::new(look, largest, self.whole.1, density),
            None => ColourBar::new(look, 1.0, self.whole.1, &format!("{density} / max")),
        }
    }
}

/// All maps of a pair on one sheet, with the same windows; `None` for fewer than two densities.
fn draw_sheet(scene: &SweepScene<'_>, observable: usize) -> Result<Option<Page>, DrawError> {
    let (family, look) = (scene.family(), &scene.look);
    let watched = scene.result.subject.observables[observable];
    let found: Vec<Found<'_>> = scene
        .chosen
        .iter()
        .filter_map(|point| Found::new(point, observable))
        .collect();
    let (Observable::Joint(first, second), Some((x, y))) = (watched, windows(&found)) else {
        return Ok(None);
    };
    if found.len() < 2 {
        return Ok(None);
    }
    let density = names::density(family, watched);
    let vertical = |high: f64| Scale::vertical(look, y, high, &names::axis(family, second));
    // The bar and the labels of the ordinate hardly depend on how high the maps are: a first sheet measures them.
    let first_sheet = Sheet::new(look, &found, 140.0);
    let bar_width = first_sheet.bar(look, &density)?.width();
    let left = MARGIN + vertical(first_sheet.side.1)?.left();
    let sheet = Sheet::new(look, &found, left + bar_width + MARGIN);
    let bar = sheet.bar(look, &density)?;
    let across = Scale::horizontal(look, x, sheet.side.0, &names::axis(family, first))?;
    let up = vertical(sheet.side.1)?;
    let left = MARGIN + up.left();
    let width = look
        .page
        .unwrap_or(left + sheet.whole.0 + bar.width() + MARGIN);
    let (page, all) = open_page(look, &found, scene.title, (left, width), sheet.whole)?;
    for (number, (found, &top)) in found.iter().zip(&sheet.tops).enumerate() {
        let map = sheet.map(all, number);
        write_above(
            &page,
            map,
            lettered(look, number, names::at(family, found.value)),
        )?;
        draw_map(&page, map, found, (x, y), top)?;
        // A map with none below it carries the labels of its column.
        across.draw_below(&page, map, number + sheet.columns >= sheet.tops.len())?;
        up.draw_left(&page, map, number % sheet.columns == 0)?;
    }
    let marks: &[f64] = if sheet.common.is_some() { &[] } else { &LEVELS };
    bar.draw(&page, all, marks)?;
    Ok(Some(page))
}

/// A line above a panel, with the panel's letter where panels have letters.
pub(super) fn lettered(look: &Look, number: usize, line: String) -> String {
    let letter = char::from(b'a' + (number % 26) as u8);
    match look.has_letters {
        true => format!("({letter})  {line}"),
        false => line,
    }
}

/// Writes a line above a map.
pub(super) fn write_above(page: &Page, map: Rectangle, markup: String) -> Result<(), DrawError> {
    let place = (map.left, map.top - 0.75 * TEXT);
    page.text(place, lettering(markup, HPos::Left))
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
pub(super) fn draw_map(
    page: &Page,
    map: Rectangle,
    found: &Found<'_>,
    (x, y): ((f64, f64), (f64, f64)),
    largest: f64,
) -> Result<(), DrawError> {
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
    let columns: Vec<Option<usize>> = (0..size.0)
        .map(|column| across.find(middle(x, column, size.0)))
        .collect();
    let rows: Vec<Option<usize>> = (0..size.1)
        .map(|row| up.find(middle(y, row, size.1)))
        .collect();
    let picture = Picture::new(size, |column, row| {
        Some(density.values[columns[column]? * up.count() + rows[row]?] / largest)
    });
    panel.draw(
        &[(x.0, y.0), (x.1, y.1)],
        Shape::Image(picture.png(page.look())?),
    )?;
    draw_contours(page.look(), &panel, density, (x, y), largest)?;
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
    look: &Look,
    panel: &Panel,
    density: &Density,
    (x, y): ((f64, f64), (f64, f64)),
    largest: f64,
) -> Result<(), DrawError> {
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
        let colour = style::on_heat(look, share * own / largest);
        for line in grid.contour(share * own) {
            panel.draw(&line, Shape::Line(Stroke::solid(colour, 0.8)))?;
        }
    }
    Ok(())
}
