//! Error against time: total variation to the reference over seconds, both logarithmic, a line a method.

use crate::compare::{AccuracyPoint, Method, Reference};
use crate::numerics::ends_of;

use super::compared_marginals::caption_with;
use super::compared_marginals::stroke;
use super::{Drawn, Sketch};
use crate::compare::Comparison;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{self, Legend, Swatch};
use crate::figure::canvas::page::{Heading, Page, Rectangle, Shape};
use crate::figure::canvas::style::{ERROR_LINE, INK, MARGIN, Stroke};
use crate::figure::canvas::symbols;
use crate::figure::parts::caption;
use crate::figure::parts::names;
use crate::figure::parts::table::{self, number as number_of};
use crate::figure::print::{Figure, Print};

/// Size of the panel, in pixels.
const PANEL: (f64, f64) = (390.0, 270.0);
/// Share of a decade that is left free beside the data.
const BORDER: f64 = 0.25;
/// Least decades of an axis.
const LEAST: f64 = 2.0;
/// Shortest time and smallest error that are told apart.
const SMALLEST: f64 = 1e-9;
/// Errors smaller than this share of what they are of lie within the symbol.
const SEEN: f64 = 0.06;
/// Length of the arrow of what may be zero, and of its barbs across, in pixels.
const ARROW: f64 = 13.0;
const BARB: f64 = 2.6;

fn exponent(value: f64) -> f64 {
    value.max(SMALLEST).log10()
}

/// The ends of an axis of exponents.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = ends_of(values);
    let missing = (0.5 * (LEAST - (high - low))).max(0.0);
    (low - missing - BORDER, high + missing + BORDER)
}

/// The figure, where errors were measured.
pub(super) fn sketches(comparison: &Comparison) -> Vec<Sketch<'_>> {
    let draw = move |print: &Print<'_>| draw(comparison, print);
    vec![Sketch::new("time_to_accuracy", draw)]
}

/// The figure; `None` if nothing was measured.
fn draw(comparison: &Comparison, print: &Print<'_>) -> Drawn {
    let (family, title, look) = (&comparison.subject.family, print.title, &print.look);
    let accuracy = comparison.accuracy.as_ref()?;
    if accuracy.points.is_empty() {
        return None;
    }
    let place = |point: &AccuracyPoint| (exponent(point.seconds), exponent(point.error.value));
    let x = range(accuracy.points.iter().map(|point| place(point).0));
    let y = range(accuracy.points.iter().map(|point| place(point).1));
    let density = names::density(family, accuracy.observable);
    let (by, reference) = match accuracy.reference {
        Reference::Exact => ("exact", "the exact density"),
        Reference::Generator(_) => ("finest", "that of the generator on its finest cells"),
    };
    let ordinate = format!("total variation to {by} {density}");
    let high = look.tall * PANEL.1;
    let up = Scale::logarithmic(look, y, high, &ordinate);
    let left = MARGIN + up.left();
    let wide = look.fill(PANEL.0, left + 12.0 + MARGIN);
    let across = Scale::logarithmic(look, x, wide, "seconds");
    let width = left + wide + 12.0 + MARGIN;
    let separator = if title.is_empty() { "" } else { "; " };
    let value = symbols::rounded(accuracy.value)
        .to_string()
        .replace('-', "−");
    let title = format!(
        "{title}{separator}at {} = {value}",
        caption::parameter(family)
    );
    let heading = Heading::new(look, &title, width);
    let shown = |method: &Method| accuracy.points.iter().any(|one| one.method == *method);
    let methods = Method::ALL.into_iter().enumerate();
    let methods = methods.filter(|(_, method)| shown(method));
    let methods: Vec<(usize, Method)> = methods.collect();
    let entries = methods.iter().map(|&(number, method)| {
        let sample = Swatch::Marked(line(method), number);
        (sample, method.title().to_owned())
    });
    let legend = Legend::new(look, entries.collect(), width - 2.0 * MARGIN);
    let top = heading.height() + legend.height() + 6.0;
    let rect = Rectangle::new((left, top), (wide, high));
    let page = Page::new(look, width, rect.bottom() + Scale::below() + MARGIN);
    heading.draw(&page);
    legend.draw(&page, 0.5 * width, heading.height());
    let panel = page.panel(rect, x, y);
    for &(number, method) in &methods {
        let own = || accuracy.points.iter().filter(|one| one.method == method);
        let places: Vec<(f64, f64)> = own().map(place).collect();
        panel.draw(&places, Shape::Line(line(method)));
        let colour = line(method).colour;
        for point in own() {
            let (at, error) = (place(point), 2.0 * point.error.error);
            let end = |sign: f64| {
                let value = exponent(point.error.value + sign * error);
                (at.0, value.clamp(y.0, y.1))
            };
            // A bar within the symbol says nothing; where zero is within it, only its upper end does.
            let bar = Shape::Line(Stroke::solid(colour, ERROR_LINE));
            if error >= point.error.value {
                let (_, top) = panel.place(end(1.0));
                let (x, y) = panel.place(at);
                page.draw(&[(x, top), (x, y + ARROW)], bar.clone());
                let tip = (x, y + ARROW + ERROR_LINE);
                let barbs = [-1.0, 1.0].map(|side| (x + side * BARB, tip.1 - 1.5 * BARB));
                page.draw(&[barbs[0], tip, barbs[1]], bar);
            } else if error > SEEN * point.error.value {
                panel.draw(&[end(-1.0), end(1.0)], bar);
            }
            panel.mark(&[at], legend::symbol(number, colour));
        }
    }
    frame::around(&page, rect, (&across, &up));
    let seen = format!(
        "Total variation of {} at {} = {} to {reference}, over the seconds that each method took; bars are two standard errors, an arrow \
         says that zero is within them.",
        caption::density(family, accuracy.observable),
        caption::parameter(family),
        caption::number(accuracy.value),
    );
    let rows = accuracy.points.iter().map(|point| {
        let numbers = [point.seconds, point.error.value, point.error.error].map(number_of);
        [vec![point.method.name().to_owned()], numbers.to_vec()].concat()
    });
    let columns = ["method", "seconds", "total_variation", "standard_error"];
    let caption = caption_with(comparison, &seen);
    Some(Figure::new(&page, caption, table::table(&columns, rows)))
}

/// The line of a method; Monte Carlo's is black, as its symbols elsewhere.
fn line(method: Method) -> Stroke {
    let colour = match method {
        Method::MonteCarlo => INK,
        method => stroke(method).colour,
    };
    Stroke {
        colour,
        ..stroke(method)
    }
}
