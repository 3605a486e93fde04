//! Marginal densities by every method: a row a parameter value, a column an axis; lines for what is solved, symbols
//! with error bars for Monte Carlo.

use plotters_backend::text_anchor::HPos;

use crate::compare::{ComparedValue, Method};
use crate::density::{Density, EstimatedDensity, Observable};
use crate::system::Family;

use super::marginals::{cells, within};
use super::{Drawn, Sketch};
use crate::compare::Comparison;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{self, Legend, Swatch};
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape, lettering};
use crate::figure::canvas::style::{ERROR_LINE, INK, MARGIN, Stroke, TEXT};
use crate::figure::parts::caption;
use crate::figure::parts::joint_map::with_letter;
use crate::figure::parts::names;
use crate::figure::parts::table::{self, number};
use crate::figure::parts::view;
use crate::figure::parts::view::View;
use crate::figure::print::{Figure, Print};

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
pub(super) fn view_of(method: Method, estimated: &EstimatedDensity) -> View<'_> {
    match method {
        Method::Generator => View::new(estimated),
        _ => View::by_cells(estimated),
    }
}

/// A panel laid out.
struct MarginalPanel<'a> {
    value: &'a ComparedValue,
    observable: Observable,
    axis: usize,
    window: (f64, f64),
    up: Scale,
}

/// The figure of all marginals.
pub(super) fn sketches(comparison: &Comparison) -> Vec<Sketch<'_>> {
    let draw = move |print: &Print<'_>| draw(comparison, print);
    vec![Sketch::new("marginals", draw)]
}

/// The caption of a figure of densities by every method, from what stands before and after the values.
pub(super) fn caption_of(comparison: &Comparison, what: &str, how: &str) -> String {
    let values = comparison.values.iter().map(|value| value.value);
    let at = caption::at(&comparison.subject.family, values);
    caption_with(comparison, &format!("{what}{at} by each method; {how}"))
}

/// What is seen, with the system and the cells.
pub(super) fn caption_with(comparison: &Comparison, seen: &str) -> String {
    let common = comparison.common.shape();
    let common: Vec<String> = common.iter().map(ToString::to_string).collect();
    let system = caption::system_of(&comparison.subject.family);
    let cells = common.join(" × ");
    format!(
        "{seen} {system} Compared on {cells} cells. {}\n",
        caption::version()
    )
}

/// The densities of some observables by every method on the common cells, a row a cell: the averages that drawn ones
/// have.
pub(super) fn rows(comparison: &Comparison, is_shown: impl Fn(&Observable) -> bool) -> String {
    let family = &comparison.subject.family;
    let observables = comparison
        .subject
        .observables
        .iter()
        .filter(|one| is_shown(one));
    let mut lines = Vec::new();
    for value in &comparison.values {
        for &observable in observables.clone() {
            for (method, estimated) in densities(value, observable) {
                let axes = estimated.density.axes.iter();
                let centres: Vec<Vec<f64>> = axes.map(|axis| axis.centres()).collect();
                let along = centres.get(1).map_or(1, Vec::len);
                for (cell, &density) in estimated.density.values.iter().enumerate() {
                    let places = [(0, cell / along), (1, cell % along)];
                    let [first, second] = places.map(|(axis, place)| {
                        let centre = centres.get(axis).and_then(|centres| centres.get(place));
                        centre.map_or_else(String::new, |&one| number(one))
                    });
                    let (at, density) = (number(value.value), number(density));
                    let (method, name) = (method.name().to_owned(), observable.name(family));
                    let error = table::error(estimated, cell);
                    lines.push(vec![at, method, name, first, second, density, error]);
                }
            }
        }
    }
    let columns = [
        family.parameter(),
        "method",
        "observable",
        "coordinate",
        "coordinate_2",
        "density",
        "standard_error",
    ];
    table::table(&columns, lines)
}

/// The figure; `None` if there is nothing to draw.
fn draw(comparison: &Comparison, print: &Print<'_>) -> Drawn {
    let (family, look) = (&comparison.subject.family, &print.look);
    let is_marginal = |one: &Observable| matches!(one, Observable::Marginal(_));
    let watched = comparison.subject.observables.iter().copied();
    let watched: Vec<Observable> = watched.filter(is_marginal).collect();
    let has_density = |value: &&ComparedValue| value.solved.iter().any(|s| !s.densities.is_empty());
    let values: Vec<&ComparedValue> = comparison.values.iter().filter(has_density).collect();
    let (count, share) = (values.len(), print.share(values.len()));
    let before = share.start * watched.len();
    let mut all: Vec<MarginalPanel<'_>> = Vec::new();
    for &value in &values[share] {
        for &observable in &watched {
            all.extend(lay_out((comparison, print), value, observable));
        }
    }
    if all.is_empty() {
        return None;
    }
    let room = all.iter().map(|laid| laid.up.left()).fold(0.0, f64::max);
    let width = |columns: usize| {
        let beside = 2.0 * MARGIN + BESIDE + columns as f64 * (room + BETWEEN.0) - BETWEEN.0;
        look.fill(PANEL.0 * columns as f64, beside) / columns as f64
    };
    let columns = Look::columns(watched.len(), |columns| width(columns) >= NARROWEST);
    let wide = width(columns);
    let rows = all.len().div_ceil(columns);
    let step = (
        room + wide + BETWEEN.0,
        ABOVE + look.tall * PANEL.1 + BETWEEN.1,
    );
    let page_width = 2.0 * MARGIN + columns as f64 * step.0 - BETWEEN.0 + BESIDE;
    let heading = Heading::new(look, print.title, page_width);
    let legend = Legend::new(look, entries(comparison), page_width - 2.0 * MARGIN);
    let top = heading.height() + legend.height();
    // Panels of one axis stand below each other only where every axis has a column.
    let labelled_below = |number: usize| columns < watched.len() || number + columns >= all.len();
    let (below, step) = if columns < watched.len() {
        (0.0, (step.0, step.1 + Scale::below()))
    } else {
        (Scale::below(), step)
    };
    let height = top + rows as f64 * step.1 + below + MARGIN;
    let page = Page::new(look, page_width, height);
    heading.draw(&page);
    legend.draw(&page, 0.5 * page_width, heading.height());
    let first = Rectangle::new((MARGIN + room, top + ABOVE), (wide, look.tall * PANEL.1));
    for (number, laid) in all.iter().enumerate() {
        let rect = first.tile(number, columns, step);
        let above = with_letter(look, before + number, names::at(family, laid.value.value));
        let place = (rect.left, rect.top - 0.7 * TEXT);
        page.text(place, lettering(above, HPos::Left));
        draw_panel(&page, laid, rect, labelled_below(number), family);
    }
    let how = "of Monte Carlo with two standard errors, of the generator followed between the cells by parabolas with \
               their averages.";
    let caption = caption_of(comparison, "Steady-state marginal densities", how);
    Some(Figure::new(&page, caption, self::rows(comparison, is_marginal)).of_panels(count))
}

fn entries(comparison: &Comparison) -> Vec<(Swatch, String)> {
    let takes_part = |method: &Method| {
        let mut all = comparison.values.iter().flat_map(|value| &value.solved);
        all.any(|solved| solved.method == *method)
    };
    let entry = |method: Method| match method {
        Method::MonteCarlo => (
            Swatch::Symbol(INK),
            format!("{} ± {ERRORS} standard errors", method.title()),
        ),
        method => (Swatch::Curve(stroke(method)), method.title().to_owned()),
    };
    let methods = Method::ALL.into_iter().filter(takes_part);
    methods.map(entry).collect()
}

/// Lays out the panel of one marginal at one value; all values share the window of an axis.
fn lay_out<'a>(
    (comparison, print): (&'a Comparison, &Print<'_>),
    value: &'a ComparedValue,
    observable: Observable,
) -> Option<MarginalPanel<'a>> {
    let Observable::Marginal(axis) = observable else {
        return None;
    };
    let all: Vec<&Density> = comparison
        .values
        .iter()
        .flat_map(|value| densities(value, observable).map(|(_, one)| &one.density))
        .collect();
    let window = view::window(&all, 0)?;
    let own = densities(value, observable).map(|(method, one)| view_of(method, one).largest);
    let highest = own.fold(0.0, f64::max);
    if highest <= 0.0 {
        return None;
    }
    let title = names::density(&comparison.subject.family, observable);
    Some(MarginalPanel {
        value,
        observable,
        axis,
        window,
        up: Scale::vertical(
            &print.look,
            (0.0, 1.08 * highest),
            print.look.tall * PANEL.1,
            &title,
        ),
    })
}

/// The densities of one observable, with their methods.
pub(super) fn densities(
    value: &ComparedValue,
    observable: Observable,
) -> impl Iterator<Item = (Method, &EstimatedDensity)> {
    Method::ALL
        .into_iter()
        .filter_map(move |method| Some((method, value.density(method, observable)?)))
}

fn draw_panel(
    page: &Page,
    laid: &MarginalPanel<'_>,
    rect: Rectangle,
    labels: bool,
    family: &Family,
) {
    let title = names::axis(family, laid.axis);
    let across = Scale::horizontal(page.look(), laid.window, rect.width, &title);
    let panel = page.panel(rect, laid.window, laid.up.range);
    let drawn = |method: Method| laid.value.density(method, laid.observable);
    // Symbols lie over the lines, and the generator's line over those of SGCM.
    for method in [Method::Sgcm, Method::SgcmSlope, Method::Generator] {
        if let Some(estimated) = drawn(method) {
            let line = within(view_of(method, estimated).curve(laid.window), laid.up.range);
            panel.draw(&line, Shape::Line(stroke(method)));
        }
    }
    if let Some(estimated) = drawn(Method::MonteCarlo) {
        draw_symbols(&panel, estimated, laid.window, laid.up.range);
    }
    frame::border(page, rect);
    across.draw_below(page, rect, labels);
    laid.up.draw_left(page, rect, true);
}

/// A symbol with an error bar at every cell in the window.
fn draw_symbols(
    panel: &Panel,
    estimated: &EstimatedDensity,
    window: (f64, f64),
    range: (f64, f64),
) {
    let density = &estimated.density;
    for (cell, centre) in cells(density, window) {
        let (value, error) = (density.values[cell], estimated.standard_error[cell]);
        let end = |sign: f64| (value + sign * ERRORS * error).clamp(range.0, range.1);
        let bar = [(centre, end(-1.0)), (centre, end(1.0))];
        panel.draw(&bar, Shape::Line(Stroke::solid(INK, ERROR_LINE)));
        let place = (centre, value.clamp(range.0, range.1));
        panel.mark(&[place], legend::symbol(0, INK));
    }
}
