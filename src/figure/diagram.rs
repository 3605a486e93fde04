//! The P-bifurcation diagram of a marginal: its density over the parameter as a heat map, the branches of
//! its peaks and valleys, and the labelled bifurcations.

use plotters_backend::BackendColor;
use plotters_backend::text_anchor::HPos;

use crate::continuation::{BifurcationStatus, LabelledPoint, Point, PointType, SweepResult};
use crate::density::{Density, Observable};
use crate::space::Axis;
use crate::topology::FeatureKind;

use super::branches::{Branch, branches};
use super::colour_bar::ColourBar;
use super::frame::{self, Scale};
use super::heat::{self, Picture};
use super::legend::{self, Legend, Sample};
use super::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use super::select::{self, Names};
use super::style::{BIFURCATION, GREY, MARGIN, PNG_SCALE, Stroke, TICK_TEXT, WHITE};
use super::{Figure, FigureError, hatch, render};

/// Size of the map, in pixels.
const MAP: (f64, f64) = (380.0, 250.0);
/// Height of a row of labels above the map.
const LABEL_ROW: f64 = 16.0;
/// Shade of the band in which an unresolved bifurcation lies.
const BAND: BackendColor = BackendColor {
    alpha: 0.45,
    rgb: (255, 255, 255),
};

/// The diagram of the marginal with the given number among the observables; `None` without any density.
///
/// # Errors
/// Any [`FigureError`] but that of writing.
pub(super) fn diagram(
    result: &SweepResult,
    observable: usize,
    names: Names<'_>,
    title: &str,
) -> Result<Option<Figure>, FigureError> {
    let Some(&watched @ Observable::Marginal(axis)) = result.observables.get(observable) else {
        return Ok(None);
    };
    let densities: Vec<&Density> = densities(result, observable)
        .into_iter()
        .flatten()
        .collect();
    let Some(window) = select::window(&densities, 0) else {
        return Ok(None);
    };
    let largest = select::largest(densities.iter().copied());
    let range = parameter_range(&result.points);
    let across = Scale::horizontal(range, MAP.0, &names.parameter())?;
    let up = Scale::vertical(window, MAP.1, &names.axis(axis))?;
    let bar = ColourBar::new(largest, MAP.1, &names.density(watched))?;
    let width = MARGIN + up.left() + MAP.0 + bar.width() + MARGIN;
    let heading = Heading::new(title, width)?;
    let left = MARGIN + up.left();
    let labels = Labels::new(result, watched, range, left)?;
    let map = Rectangle {
        left,
        top: heading.height() + labels.height().max(ColourBar::above()),
        width: MAP.0,
        height: MAP.1,
    };
    let followed = [FeatureKind::Peak, FeatureKind::Valley]
        .map(|kind| branches(&result.points, observable, kind, window));
    let legend = Legend::new(
        entries(result, observable, &followed, &labels),
        width - 2.0 * MARGIN,
    )?;
    let below = map.bottom() + Scale::below();
    let page = Page::new(width, below + legend.height() + MARGIN);
    heading.draw(&page)?;
    let panel = page.panel(map, range, window);
    draw_map(&page, &panel, result, observable, (range, window, largest))?;
    labels.draw_lines(&panel, window)?;
    draw_branches(&panel, &followed, window)?;
    frame::border(&page, map)?;
    labels.draw_texts(&page, map)?;
    across.draw_below(&page, map, true)?;
    up.draw_left(&page, map, true)?;
    bar.draw(&page, map, &[])?;
    legend.draw(&page, map.left + 0.5 * map.width, below)?;
    Ok(Some(Figure {
        name: format!("diagram_{}", names.file(watched)),
        svg: page.svg(),
    }))
}

/// The density of each point, where it has one.
fn densities(result: &SweepResult, observable: usize) -> Vec<Option<&Density>> {
    let points = result.points.iter();
    points
        .map(|point| select::density(point, observable).map(|estimated| &estimated.density))
        .collect()
}

/// First and last parameter value; widened if they are the same.
fn parameter_range(points: &[Point]) -> (f64, f64) {
    let values = points.iter().map(|point| point.value);
    let (from, to) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), value| {
        (from.min(value), to.max(value))
    });
    if from < to {
        return (from, to);
    }
    let half = if from == 0.0 { 0.5 } else { 0.1 * from.abs() };
    (from - half, from + half)
}

/// Ends of the columns: half-way between neighbouring values, and the ends of the range.
fn column_edges(points: &[Point], range: (f64, f64)) -> Vec<f64> {
    let mut edges = vec![range.0];
    edges.extend(
        points
            .windows(2)
            .map(|pair| 0.5 * (pair[0].value + pair[1].value)),
    );
    edges.push(range.1);
    edges
}

/// Hatches the ground of columns without density and draws the others' heat map.
fn draw_map(
    page: &Page,
    panel: &Panel,
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
        let (left, top) = panel.place((edges[column], window.1));
        let (right, bottom) = panel.place((edges[column + 1], window.0));
        hatch::draw(page, (left, right), (top, bottom))?;
    }
    let axes: Vec<&Axis> = densities
        .iter()
        .flatten()
        .map(|density| &density.axes[0])
        .collect();
    let columns = (MAP.0 * PNG_SCALE).round() as usize;
    let rows = select::resolution(&axes, window, MAP.1);
    let point_of = heat::nearest(&edges, range, columns);
    let picture = Picture::new((columns, rows), |column, row| {
        let density = densities[point_of[column]]?;
        let place = window.0 + (window.1 - window.0) * (row as f64 + 0.5) / rows as f64;
        let cell = density.axes[0].find(place)?;
        Some(density.values[cell] / largest)
    });
    let corners = [(range.0, window.0), (range.1, window.1)];
    panel.draw(&corners, Shape::Image(picture.png()?))
}

/// Draws valleys, then peaks, as far as they lie in the window.
fn draw_branches(
    panel: &Panel,
    followed: &[Vec<Branch>; 2],
    window: (f64, f64),
) -> Result<(), FigureError> {
    let inside = |place: &&(f64, f64)| place.1 >= window.0 && place.1 <= window.1;
    for branch in followed.iter().rev().flatten() {
        let places: Vec<(f64, f64)> = branch.places.iter().filter(inside).copied().collect();
        let draw = |points: &[(f64, f64)], shape: Shape| panel.draw(points, shape);
        match branch.kind {
            FeatureKind::Peak => legend::draw_peaks(draw, &places)?,
            _ => legend::draw_valleys(draw, &places)?,
        }
    }
    Ok(())
}

/// Entries of the legend, only for what the figure shows.
fn entries(
    result: &SweepResult,
    observable: usize,
    followed: &[Vec<Branch>; 2],
    labels: &Labels<'_>,
) -> Vec<(Sample, String)> {
    let missing = result
        .points
        .iter()
        .any(|point| select::density(point, observable).is_none());
    let located = Stroke::solid(BIFURCATION, 1.6);
    let own = |status| {
        labels
            .placed
            .iter()
            .any(|label| label.own && label.point.status == Some(status))
    };
    let all = [
        (!followed[0].is_empty(), Sample::Peaks, "peak"),
        (!followed[1].is_empty(), Sample::Valleys, "valley"),
        (
            own(BifurcationStatus::Located),
            Sample::Curve(located),
            "P-bifurcation",
        ),
        (
            own(BifurcationStatus::Unresolved),
            Sample::Curve(unresolved()),
            "unresolved",
        ),
        (
            own(BifurcationStatus::Unconfirmed),
            Sample::Curve(unconfirmed()),
            "unconfirmed",
        ),
        (missing, Sample::Hatched, "no steady state"),
    ];
    let shown = all.into_iter().filter(|(shown, _, _)| *shown);
    shown
        .map(|(_, sample, text)| (sample, text.to_owned()))
        .collect()
}

fn unresolved() -> Stroke {
    Stroke {
        dash: &[6.0, 3.0],
        ..Stroke::solid(BIFURCATION, 1.6)
    }
}

fn unconfirmed() -> Stroke {
    Stroke {
        dash: &[2.0, 3.0],
        ..Stroke::solid(BIFURCATION, 1.6)
    }
}

/// A bifurcation's label with its place above the map.
struct Placed<'a> {
    point: &'a LabelledPoint,
    own: bool,
    /// Pixels from the left of the page to the middle of the text.
    middle: f64,
    /// Row, the lowest being 0.
    row: usize,
}

/// The bifurcations of a sweep, those of the diagram's own observable and the others.
struct Labels<'a> {
    placed: Vec<Placed<'a>>,
    rows: usize,
}

impl<'a> Labels<'a> {
    /// Places labels in as few rows as keep them apart, the diagram's own ones lowest.
    fn new(
        result: &'a SweepResult,
        watched: Observable,
        range: (f64, f64),
        left: f64,
    ) -> Result<Self, FigureError> {
        let inside = |point: &&LabelledPoint| {
            point.kind == PointType::Bifurcation && point.value >= range.0 && point.value <= range.1
        };
        let mut points: Vec<&LabelledPoint> = result.labels.iter().filter(inside).collect();
        points.sort_by_key(|point| point.observable != Some(watched));
        let mut placed = Vec::new();
        let mut rows: Vec<Vec<(f64, f64)>> = Vec::new();
        for point in points {
            let own = point.observable == Some(watched);
            let half = 0.5 * render::text_width(&point.label, TICK_TEXT, own)?;
            let share = (point.value - range.0) / (range.1 - range.0);
            let middle = (left + share * MAP.0).clamp(left + half, left + MAP.0 - half);
            let (from, to) = (middle - half - 3.0, middle + half + 3.0);
            let free =
                |row: &Vec<(f64, f64)>| row.iter().all(|taken| to <= taken.0 || from >= taken.1);
            let row = rows.iter().position(free).unwrap_or(rows.len());
            if row == rows.len() {
                rows.push(Vec::new());
            }
            rows[row].push((from, to));
            placed.push(Placed {
                point,
                own,
                middle,
                row,
            });
        }
        Ok(Self {
            placed,
            rows: rows.len(),
        })
    }

    /// Room above the map.
    fn height(&self) -> f64 {
        self.rows as f64 * LABEL_ROW + 4.0
    }

    /// Draws bands and lines over the map: strongly for the own observable, faintly for others.
    fn draw_lines(&self, panel: &Panel, (from, to): (f64, f64)) -> Result<(), FigureError> {
        for label in self.placed.iter().rev() {
            let point = label.point;
            let line = [(point.value, from), (point.value, to)];
            if !label.own {
                let faint = Stroke {
                    colour: BackendColor {
                        alpha: 0.7,
                        ..WHITE
                    },
                    width: 0.9,
                    dash: &[1.5, 3.0],
                };
                panel.draw(&line, Shape::Line(faint))?;
                continue;
            }
            let stroke = match point.status {
                Some(BifurcationStatus::Unresolved) => {
                    let (a, b) = (point.lower, point.upper);
                    panel.draw(&[(a, from), (b, from), (b, to), (a, to)], Shape::Area(BAND))?;
                    unresolved()
                }
                Some(BifurcationStatus::Unconfirmed) => unconfirmed(),
                _ => Stroke::solid(BIFURCATION, 1.6),
            };
            panel.draw(&line, Shape::Line(Stroke::solid(WHITE, 3.2)))?;
            panel.draw(&line, Shape::Line(stroke))?;
        }
        Ok(())
    }

    /// Writes the labels above the map, with leaders to the higher rows.
    fn draw_texts(&self, page: &Page, map: Rectangle) -> Result<(), FigureError> {
        for label in &self.placed {
            let colour = if label.own { BIFURCATION } else { GREY };
            let y = map.top - 4.0 - (label.row as f64 + 0.5) * LABEL_ROW;
            if label.row > 0 {
                let leader = Stroke::solid(GREY, 0.6);
                let x = label.middle;
                page.draw(
                    &[(x, map.top), (x, y + 0.5 * LABEL_ROW)],
                    Shape::Line(leader),
                )?;
            }
            let mut text = lettering(super::symbols::plain(&label.point.label), HPos::Center);
            text.size = TICK_TEXT;
            text.colour = colour;
            text.bold = label.own;
            page.text((label.middle, y), text)?;
        }
        Ok(())
    }
}
