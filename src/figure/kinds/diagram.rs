//! The P-bifurcation diagram of a marginal: its density over the parameter as a heat map, the branches of
//! its peaks and valleys, and the labelled bifurcations.

use crate::continuation::{Finding, LocateOptions, Point, PointStatus, SweepResult};
use crate::density::Density;
use crate::space::Axis;
use crate::topology::FeatureKind;

use super::{Drawn, Kind};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::hatch;
use crate::figure::canvas::heat::{self, Picture};
use crate::figure::canvas::legend::{self, Legend, Swatch};
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape};
use crate::figure::canvas::style::{MARGIN, PNG_SCALE};
use crate::figure::parts::along::parameter_range;
use crate::figure::parts::bifurcations::Labels;
use crate::figure::parts::branches::{Branch, branches};
use crate::figure::parts::meeting::{located, meet};
use crate::figure::parts::view::{self, View, middles};
use crate::figure::parts::{caption, names, table};
use crate::figure::print::{Figure, Print};

/// Size of the map on a page of its own width, in pixels, and that width.
const MAP: (f64, f64) = (380.0, 250.0);
const USUAL: f64 = 505.0;

/// A diagram an observed marginal.
pub(super) const KIND: Kind = Kind {
    names: &["diagram"],
    usual: Some("diagram"),
    sketches: |sweep| sweep.of_marginals("diagram", draw),
};

/// The diagram of a marginal; `None` without any density.
fn draw(result: &SweepResult, (observable, axis): (usize, usize), print: &Print<'_>) -> Drawn {
    let (family, look) = (&result.subject.family, &print.look);
    let (watched, points) = (result.subject.observables[observable], &result.points);
    let columns = Columns::new(points, observable);
    let window = view::window(&columns.densities(), 0)?;
    let largest = columns.shown.iter().flatten().map(|shown| shown.largest);
    let largest = largest.fold(0.0, f64::max);
    let range = parameter_range(points);
    let high = look.height(MAP.1, USUAL);
    let up = Scale::vertical(look, window, high, &names::axis(family, axis));
    let bar = ColourBar::new(look, largest, high, &names::density(family, watched));
    let left = MARGIN + up.left();
    let wide = look.fill(MAP.0, left + bar.width() + MARGIN);
    let across = Scale::horizontal(look, range, wide, &names::parameter(family));
    let width = left + wide + bar.width() + MARGIN;
    let heading = Heading::new(look, print.title, width);
    let labels = Labels::new(look, result, Some(watched), range, (left, wide));
    let above = labels.height().max(ColourBar::above());
    let map = Rectangle::new((left, heading.height() + above), (wide, high));
    let kinds = [FeatureKind::Peak, FeatureKind::Valley];
    let mut followed = kinds.map(|kind| branches(points, observable, kind, window));
    meet(&mut followed, &located(result, watched), points, window);
    let entries = entries(points, observable, &followed, &labels);
    let legend = Legend::new(look, entries, width - 2.0 * MARGIN);
    let below = map.bottom() + Scale::below();
    let page = Page::new(look, width, below + legend.height() + MARGIN);
    heading.draw(&page);
    let panel = page.panel(map, range, window);
    columns.draw(&page, (&panel, map), (range, window, largest));
    labels.draw_lines(look, &panel, window);
    draw_branches(&panel, &followed, window);
    frame::border(&page, map);
    labels.draw_texts(&page, map);
    across.draw_below(&page, map, true);
    up.draw_left(&page, map, true);
    bar.draw(&page, map, &[]);
    legend.draw(&page, map.left + 0.5 * map.width, below);
    let seen = format!(
        "Steady-state marginal density {} over {} (colours), with its peaks (solid) and valleys (dashed).",
        caption::density(family, watched),
        caption::parameter(family)
    );
    let between = caption::between_cells(result, |one| one == watched);
    let marks = format!("{}{}", caption::bifurcations(result), caption::floor(look));
    let caption = caption::of_sweep(result, seen, &[between, marks]);
    let points: Vec<&Point> = points.iter().collect();
    let table = table::of_marginals(result, (&[observable], &points), |one, _| table::cells(one));
    Some(Figure::new(&page, caption, table))
}

/// Ends of the columns: half-way between neighbouring values, and the ends of the range.
pub(super) fn column_edges(points: &[Point], range: (f64, f64)) -> Vec<f64> {
    let middles = points
        .windows(2)
        .map(|pair| 0.5 * (pair[0].value + pair[1].value));
    let edges = std::iter::once(range.0).chain(middles);
    edges.chain(std::iter::once(range.1)).collect()
}

/// Hatches the column between the first two of some edges.
pub(super) fn hatch_column(page: &Page, panel: &Panel, edges: &[f64], window: (f64, f64)) {
    if let [from, to, ..] = *edges {
        let (left, top) = panel.place((from, window.1));
        let (right, bottom) = panel.place((to, window.0));
        hatch::draw(page, (left, right), (top, bottom));
    }
}

/// The densities of the points of a sweep.
struct Columns<'a> {
    points: &'a [Point],
    shown: Vec<Option<View<'a>>>,
    /// Whether neighbours are joined.
    are_joined: bool,
}

impl<'a> Columns<'a> {
    fn new(points: &'a [Point], observable: usize) -> Self {
        let shown = points.iter();
        let shown = shown.map(|point| Some(View::new(view::density(point, observable)?)));
        let shown: Vec<Option<View<'_>>> = shown.collect();
        let pairs = shown.windows(2).zip(&points[1.min(points.len())..]);
        let mut joinable = pairs.filter(|(pair, _)| pair.iter().all(Option::is_some));
        // What a sweep accepts between neighbours is what may be joined: a straight line between two errs by about the
        // square of their distance (Hellinger). Where one step is longer every value has its column, so that no part of
        // a figure looks more certain than another.
        let most = LocateOptions::default().largest_distance;
        let are_joined =
            joinable.all(|(_, point)| point.distance.is_some_and(|distance| distance <= most));
        Self {
            points,
            shown,
            are_joined,
        }
    }

    fn densities(&self) -> Vec<&'a Density> {
        let shown = self.shown.iter().flatten();
        shown.map(View::density).collect()
    }

    /// Hatches the ground of columns without density and draws the others' heat map.
    fn draw(
        &self,
        page: &Page,
        (panel, map): (&Panel, Rectangle),
        (range, window, largest): ((f64, f64), (f64, f64), f64),
    ) {
        let edges = column_edges(self.points, range);
        for (column, shown) in self.shown.iter().enumerate() {
            if shown.is_none() {
                hatch_column(page, panel, &edges[column..], window);
            }
        }
        let mut shown = self.shown.iter().flatten();
        let size = if shown.any(|shown| shown.between.is_some()) {
            (view::resolution(map.width), view::resolution(map.height))
        } else {
            let densities = self.densities();
            let axes: Vec<&Axis> = densities.iter().map(|density| &density.axes[0]).collect();
            let pixels = view::cell_resolution(&axes, window, map.height);
            ((map.width * PNG_SCALE).round() as usize, pixels)
        };
        let values = self.values(&edges, (range, window), size);
        let picture = Picture::new(page.look(), size, |column, row| {
            Some(values[column].as_ref()?[row] / largest)
        });
        let corners = [(range.0, window.0), (range.1, window.1)];
        panel.draw(&corners, Shape::Image(picture));
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
        let view = |number: usize| self.shown.get(number)?.as_ref()?.between.as_ref();
        view(below)?;
        view(above)?;
        let (from, to) = (self.points.get(below)?, self.points.get(above)?);
        self.are_joined
            .then(|| (place - from.value) / (to.value - from.value))
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
    points: &[Point],
    observable: usize,
    followed: &[Vec<Branch>; 2],
    labels: &Labels<'_>,
) -> Vec<(Swatch, String)> {
    let mut entries = Vec::new();
    let mut add = |shown: bool, sample: Swatch, text: &str| {
        if shown {
            entries.push((sample, text.to_owned()));
        }
    };
    add(!followed[0].is_empty(), Swatch::Peaks, "peak");
    add(!followed[1].is_empty(), Swatch::Valleys, "valley");
    let missing = |point: &&Point| view::density(point, observable).is_none();
    let blank = || points.iter().filter(missing);
    let several = blank().any(|point| point.report.status == PointStatus::SeveralClasses);
    let rests = |point: &Point| {
        let mut findings = point.report.findings.iter();
        findings.any(|one| matches!(one, Finding::PointMass { .. }))
    };
    let words = if several {
        "no unique steady state"
    } else if blank().all(rests) {
        "point mass"
    } else {
        "no steady state"
    };
    add(blank().next().is_some(), Swatch::Hatched, words);
    entries.extend(labels.entries());
    entries
}
