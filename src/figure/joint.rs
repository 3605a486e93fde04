//! Joint densities of two axes as heat maps with contours: one figure a parameter value, and a sheet of all
//! (`joint_sheet`).

use plotters_backend::text_anchor::HPos;

use crate::continuation::{Point, SweepResult, evenly_spaced};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::topology::{Feature, FeatureKind, Verdict};

use super::canvas::colour_bar::ColourBar;
use super::canvas::contour::{Grid, thinned};
use super::canvas::frame::{self, Scale};
use super::canvas::heat::Picture;
use super::canvas::legend::{self, Legend, Sample};
use super::canvas::look::Look;
use super::canvas::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use super::canvas::style::{self, MARGIN, Stroke, TEXT};
use super::canvas::{DrawError, symbols};
use super::shown::{Shown, middles};
use super::sketch::{Sketch, SweepScene};
use super::told::Shows;
use super::{joint_sheet, names, select};

/// Contours are drawn at these shares of the largest density.
pub(super) const LEVELS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// What a map is, for captions.
const WAY: &str = "as a map with contours at 10, 30, 50, 70 and 90 % of its maximum";
/// Small multiples of a sweep: one to so many values of the parameter.
const MULTIPLES: usize = 12;
/// Contours are followed on squares of so many pixels, and lose points that lie so near to their neighbours' chord.
const CONTOUR: f64 = 1.5;
const ALIKE: f64 = 0.05;
/// Side of the map of a single figure, in pixels.
const SINGLE: f64 = 290.0;
/// Highest map of a single figure.
const TALLEST: f64 = 420.0;

/// A joint density with what was found in it.
pub(super) struct Found<'a> {
    pub(super) value: f64,
    pub(super) estimated: &'a EstimatedDensity,
    pub(super) shown: Shown<'a>,
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
            shown: Shown::new(estimated),
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
pub(super) fn open_page(
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
                let single = Sketch::new(format!("{name}_{value}"), move || {
                    draw_single(scene, number, point)
                });
                single.showing(Shows::Joint(number, vec![point], WAY))
            };
            let singles = scene.chosen.iter().map(single);
            let sheet = Sketch::new(&name, move || {
                joint_sheet::draw(scene, number, &scene.chosen)
            });
            sketches.push(sheet.showing(Shows::Joint(number, scene.chosen.clone(), WAY)));
            let several = several(scene.result, number);
            let shows = Shows::Joint(number, several.clone(), WAY);
            let multiples = Sketch::new(
                format!("multiples_{}", &name["joint_".len()..]),
                move || joint_sheet::draw(scene, number, &several),
            );
            sketches.push(multiples.showing(shows));
            sketches.extend(singles);
        }
    }
    sketches
}

/// Points spread evenly over a sweep that have a density of an observable, for small multiples.
fn several(result: &SweepResult, observable: usize) -> Vec<&Point> {
    let ends = [result.points.first(), result.points.last()];
    let [Some(first), Some(last)] = ends.map(|end| end.map(|point| point.value)) else {
        return Vec::new();
    };
    let wanted = evenly_spaced((first, last), MULTIPLES);
    let points = select::nearest(result, &wanted).into_iter();
    points
        .filter(|point| select::density(point, observable).is_some())
        .collect()
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
    let largest = found[0].shown.largest;
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
    if found.density().axes.len() != 2 {
        return Ok(());
    }
    let size = (
        found.shown.resolution(0, x, map.width),
        found.shown.resolution(1, y, map.height),
    );
    let values = found.shown.sheet(&middles(x, size.0), &middles(y, size.1));
    let picture = Picture::new(size, |column, row| {
        Some(values[column * size.1 + row] / largest)
    });
    panel.draw(
        &[(x.0, y.0), (x.1, y.1)],
        Shape::Image(picture.png(page.look())?),
    )?;
    draw_contours(page.look(), (&panel, map), found, (x, y), largest)?;
    let inside = |&(px, py): &(f64, f64)| px >= x.0 && px <= x.1 && py >= y.0 && py <= y.1;
    for place in found.present(FeatureKind::Peak).filter(inside) {
        legend::plus(|points, shape| panel.draw(points, shape), place)?;
    }
    for place in found.present(FeatureKind::Crater).filter(inside) {
        legend::ring(|points, shape| panel.draw(points, shape), place)?;
    }
    frame::border(page, map)
}

/// Draws the contours at [`LEVELS`] of the density's own maximum: through the centres of cells in the window, or
/// between the cells where that is known.
fn draw_contours(
    look: &Look,
    (panel, map): (&Panel, Rectangle),
    found: &Found<'_>,
    (x, y): ((f64, f64), (f64, f64)),
    largest: f64,
) -> Result<(), DrawError> {
    let lines = |k: usize, window: (f64, f64), length: f64| match &found.shown.between {
        Some(between) => between.places(k, window, (length / CONTOUR).ceil() as usize),
        None => {
            let mut centres = found.density().axes[k].centres();
            centres.retain(|centre| *centre > window.0 && *centre < window.1);
            centres
        }
    };
    let (across, up) = (lines(0, x, map.width), lines(1, y, map.height));
    let grid = Grid {
        x: &across,
        y: &up,
        values: &found.shown.sheet(&across, &up),
    };
    let own = found.shown.largest;
    let place = |&point: &(f64, f64)| panel.place(point);
    for share in LEVELS {
        let colour = style::on_heat(look, share * own / largest);
        for line in grid.contour(share * own) {
            let line = thinned(&line, ALIKE, place);
            panel.draw(&line, Shape::Line(Stroke::solid(colour, 0.8)))?;
        }
    }
    Ok(())
}
