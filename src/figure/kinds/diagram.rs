//! The P-bifurcation diagram of a marginal: its density over the parameter as a heat map, the branches of
//! its peaks and valleys, and the labelled bifurcations.

use crate::continuation::{Point, PointStatus, SweepResult};
use crate::density::Density;
use crate::space::Axis;
use crate::topology::FeatureKind;

use super::{Drawn, Kind};
use crate::figure::FigureError;
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::hatch;
use crate::figure::canvas::heat::{self, Picture};
use crate::figure::canvas::legend::{self, Legend, Sample};
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape};
use crate::figure::canvas::style::{MARGIN, PNG_SCALE};
use crate::figure::figures::{Figure, Print};
use crate::figure::parts::along::parameter_range;
use crate::figure::parts::bifurcations::Labels;
use crate::figure::parts::branches::{Branch, branches};
use crate::figure::parts::view::{self, View, middles};
use crate::figure::parts::{caption, names, table};

/// Size of the map on a page of its own width, in pixels, and that width.
const MAP: (f64, f64) = (380.0, 250.0);
const USUAL: f64 = 505.0;

/// Neighbouring densities at most so far apart (Hellinger) are joined: a straight line between them errs by about its
/// square.
const ALIKE: f64 = 0.1;

/// A diagram an observed marginal.
pub(super) const KIND: Kind = Kind {
    names: &["diagram"],
    is_usual: true,
    sketches: |sweep| sweep.of_marginals("diagram", draw),
};

/// The diagram of a marginal; `None` without any density.
fn draw(result: &SweepResult, (observable, axis): (usize, usize), print: &Print<'_>) -> Drawn {
    let (family, look) = (&result.subject.family, &print.look);
    let watched = result.subject.observables[observable];
    let densities: Vec<&Density> = densities(result, observable)
        .into_iter()
        .flatten()
        .collect();
    let Some(window) = view::window(&densities, 0) else {
        return Ok(None);
    };
    let all = Columns::new(result, observable);
    let largest = all.shown.iter().flatten().map(|shown| shown.largest);
    let largest = largest.fold(0.0, f64::max);
    let range = parameter_range(&result.points);
    let high = look.height(MAP.1, USUAL);
    let up = Scale::vertical(look, window, high, &names::axis(family, axis))?;
    let bar = ColourBar::new(look, largest, high, &names::density(family, watched))?;
    let left = MARGIN + up.left();
    let wide = look.fill(MAP.0, left + bar.width() + MARGIN);
    let across = Scale::horizontal(look, range, wide, &names::parameter(family))?;
    let width = left + wide + bar.width() + MARGIN;
    let heading = Heading::new(look, print.title, width)?;
    let labels = Labels::new(look, result, Some(watched), range, (left, wide))?;
    let map = Rectangle::new(
        (
            left,
            heading.height() + labels.height().max(ColourBar::above()),
        ),
        (wide, high),
    );
    let followed = [FeatureKind::Peak, FeatureKind::Valley]
        .map(|kind| branches(&result.points, observable, kind, window));
    let legend = Legend::new(
        look,
        entries(result, observable, &followed, &labels),
        width - 2.0 * MARGIN,
    )?;
    let below = map.bottom() + Scale::below();
    let page = Page::new(look, width, below + legend.height() + MARGIN);
    heading.draw(&page);
    let panel = page.panel(map, range, window);
    draw_map(
        &page,
        (&panel, map),
        result,
        observable,
        (range, window, largest),
    )?;
    labels.draw_lines(look, &panel, window);
    draw_branches(&panel, &followed, window);
    frame::border(&page, map);
    labels.draw_texts(&page, map);
    across.draw_below(&page, map, true);
    up.draw_left(&page, map, true);
    bar.draw(&page, map, &[])?;
    legend.draw(&page, map.left + 0.5 * map.width, below);
    let seen = format!(
        "Steady-state marginal density {} over {} (colours), with its peaks (solid) and valleys (dashed).",
        caption::density(family, watched),
        family.parameter()
    );
    let between = caption::between_cells(result, |one| one == watched);
    let caption = caption::of_sweep(result, seen, &[between, caption::bifurcations(result)]);
    let points: Vec<&Point> = result.points.iter().collect();
    let table = table::of_marginals(result, (&[observable], &points), |one, _| table::cells(one));
    Ok(Some(Figure::new(&page, caption, table)))
}

/// The density of each point, where it has one.
fn densities(result: &SweepResult, observable: usize) -> Vec<Option<&Density>> {
    let points = result.points.iter();
    points
        .map(|point| view::density(point, observable).map(|estimated| &estimated.density))
        .collect()
}

/// Ends of the columns: half-way between neighbouring values, and the ends of the range.
pub(super) fn column_edges(points: &[Point], range: (f64, f64)) -> Vec<f64> {
    let mut edges = vec![range.0];
    edges.extend(
        points
            .windows(2)
            .map(|pair| 0.5 * (pair[0].value + pair[1].value)),
    );
    edges.push(range.1);
    edges
}

/// Hatches the column between the first two of some edges.
pub(super) fn hatch_column(page: &Page, panel: &Panel, edges: &[f64], window: (f64, f64)) {
    if let [from, to, ..] = *edges {
        let (left, top) = panel.place((from, window.1));
        let (right, bottom) = panel.place((to, window.0));
        hatch::draw(page, (left, right), (top, bottom));
    }
}

/// Hatches the ground of columns without density and draws the others' heat map.
fn draw_map(
    page: &Page,
    (panel, map): (&Panel, Rectangle),
    result: &SweepResult,
    observable: usize,
    (range, window, largest): ((f64, f64), (f64, f64), f64),
) -> Result<(), FigureError> {
    let densities = densities(result, observable);
    let edges = column_edges(&result.points, range);
    for (column, _) in densities
        .iter()
        .enumerate()
        .filter(|(_, density)| density.is_none())
    {
        hatch_column(page, panel, &edges[column..], window);
    }
    let axes: Vec<&Axis> = densities
        .iter()
        .flatten()
        .map(|density| &density.axes[0])
        .collect();
    let all = Columns::new(result, observable);
    let mut shown = all.shown.iter().flatten();
    let size = if shown.any(|shown| shown.between.is_some()) {
        (view::resolution(map.width), view::resolution(map.height))
    } else {
        (
            (map.width * PNG_SCALE).round() as usize,
            view::cell_resolution(&axes, window, map.height),
        )
    };
    let values = all.values(&edges, (range, window), size);
    let picture = Picture::new(size, |column, row| {
        Some(values[column].as_ref()?[row] / largest)
    });
    let corners = [(range.0, window.0), (range.1, window.1)];
    panel.draw(&corners, Shape::Image(picture.png(page.look())?));
    Ok(())
}

/// The densities of the points of a sweep.
struct Columns<'a> {
    points: &'a [Point],
    shown: Vec<Option<View<'a>>>,
}

impl<'a> Columns<'a> {
    fn new(result: &'a SweepResult, observable: usize) -> Self {
        let points = result.points.iter();
        let shown = points.map(|point| Some(View::new(view::density(point, observable)?)));
        Self {
            points: &result.points,
            shown: shown.collect(),
        }
    }

    /// The values in each column of pixels, from the lowest one up: those of the point whose column it is, and linear
    /// between neighbouring points without noise that hardly differ; `None` without a density.
    fn values(
        &self,
        edges: &[f64],
        (range, window): ((f64, f64), (f64, f64)),
        size: (usize, usize),
    ) -> Vec<Option<Vec<f64>>> {
        let rows = middles(window, size.1);
        let of_point: Vec<Option<Vec<f64>>> = self
            .shown
            .iter()
            .map(|shown| Some(shown.as_ref()?.along(&rows)))
            .collect();
        let places = middles(range, size.0).into_iter();
        let owners = heat::nearest(edges, range, size.0).into_iter();
        let column = |(place, owner): (f64, usize)| {
            let above = self.points.partition_point(|point| point.value < place);
            let Some(share) = self.share(above, place) else {
                return of_point[owner].clone();
            };
            let (lower, upper) = (of_point[above - 1].as_ref()?, of_point[above].as_ref()?);
            let pairs = lower.iter().zip(upper);
            Some(pairs.map(|(a, b)| a + share * (b - a)).collect())
        };
        places.zip(owners).map(column).collect()
    }

    /// How far a value lies between the points before and at a number, where the density may be followed between them.
    fn share(&self, above: usize, place: f64) -> Option<f64> {
        let below = above.checked_sub(1)?;
        let is_smooth = |number: usize| {
            self.shown
                .get(number)?
                .as_ref()?
                .between
                .as_ref()
                .map(|_| ())
        };
        is_smooth(below)?;
        is_smooth(above)?;
        let (from, to) = (self.points.get(below)?, self.points.get(above)?);
        let is_near = to.distance.is_some_and(|distance| distance <= ALIKE);
        is_near.then(|| (place - from.value) / (to.value - from.value))
    }
}

/// Draws valleys, then peaks, as far as they lie in the window.
fn draw_branches(panel: &Panel, followed: &[Vec<Branch>; 2], window: (f64, f64)) {
    let inside = |place: &&(f64, f64)| place.1 >= window.0 && place.1 <= window.1;
    for branch in followed.iter().rev().flatten() {
        let places: Vec<(f64, f64)> = branch.places.iter().filter(inside).copied().collect();
        match branch.kind {
            FeatureKind::Peak => panel.mark(&places, legend::peaks(&places)),
            _ => panel.mark(&places, legend::valleys(&places)),
        }
    }
}

/// Entries of the legend, only for what the figure shows.
fn entries(
    result: &SweepResult,
    observable: usize,
    followed: &[Vec<Branch>; 2],
    labels: &Labels<'_>,
) -> Vec<(Sample, String)> {
    let mut entries = Vec::new();
    let mut add = |shown: bool, sample: Sample, text: &str| {
        if shown {
            entries.push((sample, text.to_owned()));
        }
    };
    add(!followed[0].is_empty(), Sample::Peaks, "peak");
    add(!followed[1].is_empty(), Sample::Valleys, "valley");
    let missing = |point: &&Point| view::density(point, observable).is_none();
    let blank = || result.points.iter().filter(missing);
    let several = blank().any(|point| point.report.status == PointStatus::SeveralClasses);
    let words = if several {
        "no unique steady state"
    } else {
        "no steady state"
    };
    add(blank().next().is_some(), Sample::Hatched, words);
    entries.extend(labels.entries());
    entries
}
