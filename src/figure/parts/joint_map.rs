//! Joint densities of two axes as heat maps with contours, and what stands around such maps.

use std::ops::Range;

use plotters_backend::text_anchor::HPos;

use super::names;
use super::view::{self, View, middles};
use crate::continuation::{Point, SweepResult};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::contour::{GridValues, simplify};
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::heat::Picture;
use crate::figure::canvas::legend::{self, Legend, Swatch};
use crate::figure::canvas::look::{Look, on_heat};
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use crate::figure::canvas::style::{MARGIN, Stroke, TEXT};
use crate::figure::print::Print;
use crate::topology::{Feature, FeatureKind, Verdict};

/// Contours are drawn at these shares of the largest density, and at those where colours are logarithmic.
const LEVELS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
const LEVELS_BY_DECADES: [f64; 4] = [1e-3, 1e-2, 0.1, 0.5];
/// What lies in the window of joint densities, at least, of each marginal's mass at either end.
const OUTSIDE: f64 = 2e-4;
/// Contours are followed on squares of so many pixels, and lose points that lie so near to their neighbours' chord.
const CONTOUR: f64 = 1.5;
const ALIKE: f64 = 0.05;

/// The joint densities of a pair of axes at some points of a sweep.
pub(crate) struct Joint<'a> {
    pub(crate) result: &'a SweepResult,
    /// Its number among the observables.
    pub(crate) number: usize,
    /// The points, with and without a density.
    pub(crate) points: &'a [&'a Point],
    /// Those of the points that are shown.
    pub(crate) shown: Range<usize>,
    /// The densities that there are.
    pub(crate) found: Vec<JointPoint<'a>>,
    /// Densities of all pages, and the number of those on pages before this one.
    count: usize,
    pub(crate) before: usize,
    /// The least and the greatest of the largest values of all pages.
    pub(crate) summits: (f64, f64),
    /// The windows of both axes, which all share.
    pub(crate) window: ((f64, f64), (f64, f64)),
    /// Titles of both axes, and of the density.
    pub(crate) titles: [String; 3],
}

impl<'a> Joint<'a> {
    /// `None` where there is nothing to see.
    pub(crate) fn new(
        result: &'a SweepResult,
        number: usize,
        points: &'a [&'a Point],
    ) -> Option<Self> {
        let (family, watched) = (&result.subject.family, result.subject.observables[number]);
        let Observable::Joint(first, second) = watched else {
            return None;
        };
        let found = points.iter();
        let found = found.filter_map(|point| JointPoint::new(point, number));
        let found: Vec<JointPoint<'_>> = found.collect();
        let axes = [first, second].map(|axis| names::axis(family, axis));
        let [first, second] = axes;
        let summits = found.iter().map(|found| found.shown.largest);
        let summits = summits.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), one| {
            (low.min(one), high.max(one))
        });
        Some(Self {
            result,
            number,
            points,
            shown: 0..points.len(),
            window: windows(&found)?,
            count: found.len(),
            before: 0,
            summits,
            found,
            titles: [first, second, names::density(family, watched)],
        })
    }

    /// Densities of all pages.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// What stands on one page of several; windows and colours stay those of all.
    pub(crate) fn on_page(mut self, print: &Print<'_>) -> Self {
        if print.part.1 == 1 {
            return self;
        }
        let share = print.share(self.count);
        let place = |found: &JointPoint<'_>| {
            let mut points = self.points.iter();
            points.position(|point| point.value == found.value)
        };
        let places = self.found[share.clone()].iter().filter_map(place);
        let (from, to) = places.fold((usize::MAX, 0), |(from, to), place| {
            (from.min(place), to.max(place + 1))
        });
        self.shown = from.min(to)..to;
        self.before = share.start;
        self.found = self.found.drain(share).collect();
        self
    }

    /// The value of the parameter that a density is of, as it stands above its map.
    pub(crate) fn at(&self, found: &JointPoint<'_>) -> String {
        names::at(&self.result.subject.family, found.value)
    }
}

/// A joint density with what was found in it.
pub(crate) struct JointPoint<'a> {
    pub(crate) value: f64,
    pub(crate) estimated: &'a EstimatedDensity,
    pub(crate) shown: View<'a>,
    pub(crate) features: &'a [Feature],
}

impl<'a> JointPoint<'a> {
    fn new(point: &'a Point, observable: usize) -> Option<Self> {
        let estimated = view::density(point, observable)?;
        let detection = point.detections.get(observable);
        Some(Self {
            value: point.value,
            estimated,
            shown: View::new(estimated),
            features: detection.map_or(&[], |detection| &detection.features),
        })
    }

    pub(crate) fn density(&self) -> &'a Density {
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

/// The shares of the largest density at which contours are drawn.
pub(crate) fn levels(look: &Look) -> &'static [f64] {
    if look.is_logarithmic {
        &LEVELS_BY_DECADES
    } else {
        &LEVELS
    }
}

/// The windows of both axes: no density of note is outside of them, and nearly all mass is inside.
pub(crate) fn windows(found: &[JointPoint<'_>]) -> Option<((f64, f64), (f64, f64))> {
    let densities: Vec<&Density> = found.iter().map(JointPoint::density).collect();
    let window = |axis: usize| {
        let noted = view::window(&densities, axis)?;
        let held = view::holding(&densities, axis, OUTSIDE).unwrap_or(noted);
        Some((noted.0.max(held.0), noted.1.min(held.1)))
    };
    Some((window(0)?, window(1)?))
}

/// Opens a page with heading and legend, and room for maps of the given size that begins `left`
/// pixels from the left; returns the rectangle of the maps.
pub(crate) fn open_page(
    print: &Print<'_>,
    found: &[JointPoint<'_>],
    (left, page_width): (f64, f64),
    (width, height): (f64, f64),
) -> (Page, Rectangle) {
    let look = &print.look;
    let heading = Heading::new(look, print.title, page_width);
    let legend = Legend::new(look, entries(found), page_width - 2.0 * MARGIN);
    let maps = Rectangle::new(
        (left, heading.height() + ColourBar::above()),
        (width, height),
    );
    let below = maps.bottom() + Scale::below();
    let page = Page::new(look, page_width, below + legend.height() + MARGIN);
    heading.draw(&page);
    legend.draw(&page, left + 0.5 * width, below);
    (page, maps)
}

/// A line above a panel, with the panel's letter where panels have letters.
pub(crate) fn with_letter(look: &Look, number: usize, line: String) -> String {
    let letter = char::from(b'a' + (number % 26) as u8);
    if look.has_letters {
        // Browsers make one of two plain spaces.
        format!("({letter})\u{a0} {line}").trim_end().to_owned()
    } else {
        line
    }
}

/// Writes a line above a map.
pub(crate) fn write_above(page: &Page, map: Rectangle, markup: String) {
    let place = (map.left, map.top - 0.75 * TEXT);
    page.text(place, lettering(markup, HPos::Left));
}

/// Legend of the marks that are drawn.
fn entries(found: &[JointPoint<'_>]) -> Vec<(Swatch, String)> {
    let any = |kind| {
        found
            .iter()
            .any(|found| found.present(kind).next().is_some())
    };
    let all = [
        (any(FeatureKind::Peak), Swatch::Plus, "peak"),
        (any(FeatureKind::Crater), Swatch::Ring, "crater"),
    ];
    let shown = all.into_iter().filter(|(shown, _, _)| *shown);
    shown
        .map(|(_, sample, text)| (sample, text.to_owned()))
        .collect()
}

/// Draws heat map, contours and marks into a rectangle; colours run from zero to `largest`.
pub(crate) fn draw_map(
    page: &Page,
    map: Rectangle,
    found: &JointPoint<'_>,
    (x, y): ((f64, f64), (f64, f64)),
    largest: f64,
) {
    let panel = page.panel(map, x, y);
    if found.density().axes.len() != 2 {
        return;
    }
    let size = (
        found.shown.resolution(0, x, map.width),
        found.shown.resolution(1, y, map.height),
    );
    let values = found.shown.sheet(&middles(x, size.0), &middles(y, size.1));
    let picture = Picture::new(page.look(), size, |column, row| {
        Some(values[column * size.1 + row] / largest)
    });
    panel.draw(&[(x.0, y.0), (x.1, y.1)], Shape::Image(picture));
    draw_contours(page.look(), (&panel, map), found, (x, y), largest);
    let inside = |&(px, py): &(f64, f64)| px >= x.0 && px <= x.1 && py >= y.0 && py <= y.1;
    for place in found.present(FeatureKind::Peak).filter(inside) {
        panel.mark(&[place], legend::plus());
    }
    for place in found.present(FeatureKind::Crater).filter(inside) {
        panel.mark(&[place], legend::ring());
    }
    frame::border(page, map);
}

/// Draws the contours at [`LEVELS`] of the density's own maximum: through the centres of cells in the window, or
/// between the cells where that is known.
fn draw_contours(
    look: &Look,
    (panel, map): (&Panel, Rectangle),
    found: &JointPoint<'_>,
    (x, y): ((f64, f64), (f64, f64)),
    largest: f64,
) {
    let lines = |k: usize, window: (f64, f64), length: f64| match &found.shown.between {
        Some(between) => between.places(k, window, (length / CONTOUR).ceil() as usize),
        None => {
            let mut centres = found.density().axes[k].centres();
            centres.retain(|centre| *centre > window.0 && *centre < window.1);
            centres
        }
    };
    let (across, up) = (lines(0, x, map.width), lines(1, y, map.height));
    let grid = GridValues {
        x: &across,
        y: &up,
        values: &found.shown.sheet(&across, &up),
    };
    let own = found.shown.largest;
    let place = |&point: &(f64, f64)| panel.place(point);
    for &share in levels(look) {
        let colour = on_heat(look, share * own / largest);
        for line in grid.contour(share * own) {
            let line = simplify(&line, ALIKE, place);
            panel.draw(&line, Shape::Line(Stroke::solid(colour, 0.8)));
        }
    }
}
