//! Joint densities by every method side by side: a row a parameter value, a column a method.

use crate::compare::{ComparedValue, Method};
use crate::density::Observable;
use crate::system::Family;

use super::compared_marginals::{caption_of, densities, rows as table, view_of};
use super::{Drawn, Sketch};
use crate::compare::Comparison;
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::Scale;
use crate::figure::canvas::letters::text_width;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Rectangle};
use crate::figure::canvas::style::{MARGIN, TEXT};
use crate::figure::parts::joint_map::{JointPoint, draw_map, windows, write_above};
use crate::figure::parts::{caption, names};
use crate::figure::print::{Figure, Print};

/// Side of a map, in pixels.
const SIDE: f64 = 165.0;
/// Narrowest and widest map where the page is given.
const SMALLEST: f64 = 124.0;
/// The same on a slide.
const SMALLEST_ON_SLIDE: f64 = 88.0;
const TALLEST: f64 = 230.0;
/// Gaps between maps.
const BETWEEN: (f64, f64) = (12.0, 12.0);
/// Room of the line above a map.
const ABOVE: f64 = 1.6 * TEXT;

/// The densities of one value by the methods that have one.
fn row(value: &ComparedValue, observable: Observable) -> Vec<(Method, JointPoint<'_>)> {
    let found = |(method, estimated)| {
        let found = JointPoint {
            value: value.value,
            estimated,
            shown: view_of(method, estimated),
            features: &[],
        };
        (method, found)
    };
    densities(value, observable).map(found).collect()
}

/// A figure a pair of axes.
pub(super) fn sketches(comparison: &Comparison) -> Vec<Sketch<'_>> {
    let observables = comparison.subject.observables.iter();
    observables
        .filter(|observable| matches!(observable, Observable::Joint(..)))
        .map(|&observable| {
            let name = names::file(&comparison.subject.family, observable);
            Sketch::new(format!("joint_{name}"), move |print| {
                draw(comparison, observable, print)
            })
        })
        .collect()
}

/// The figure; `None` if there is nothing to draw. Maps of a row share their colours, all share their windows.
fn draw(comparison: &Comparison, observable: Observable, print: &Print<'_>) -> Drawn {
    let (family, look) = (&comparison.subject.family, &print.look);
    let rows = comparison.values.iter();
    let rows: Vec<Vec<(Method, JointPoint<'_>)>> = rows
        .map(|value| row(value, observable))
        .filter(|row| !row.is_empty())
        .collect();
    let (Observable::Joint(first, second), false) = (observable, rows.is_empty()) else {
        return None;
    };
    let count = rows.len();
    let mut window: Option<((f64, f64), (f64, f64))> = None;
    for (_, found) in rows.iter().flatten() {
        if let Some((x, y)) = windows(std::slice::from_ref(found)) {
            let join = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
            window = Some(window.map_or((x, y), |(a, b)| (join(a, x), join(b, y))));
        }
    }
    let (x, y) = window?;
    let rows = &rows[print.share(count)];
    let density = names::density(family, observable);
    let rough = ColourBar::new(look, 1.0, SIDE, &density);
    let left = MARGIN + Scale::vertical(look, y, SIDE, &names::axis(family, second)).left();
    let most = rows.iter().map(Vec::len).max().unwrap_or(1);
    let (columns, side) = arrangement(look, most, left + rough.width() + 12.0 + MARGIN);
    let across = Scale::horizontal(look, x, side, &names::axis(family, first));
    let high = look.tall * side;
    let up = Scale::vertical(look, y, high, &names::axis(family, second));
    let mut bars = Vec::new();
    for row in rows {
        let largest = row.iter().map(|(_, found)| found.shown.largest);
        let largest = largest.fold(0.0, f64::max);
        bars.push((largest, ColourBar::new(look, largest, high, &density)));
    }
    let widest = bars.iter().map(|(_, bar)| bar.width()).fold(0.0, f64::max);
    // On a narrow page the value has a line of its own.
    let above = if look.page.is_some() {
        2.0 * ABOVE
    } else {
        ABOVE
    };
    let step = (side + BETWEEN.0, above + high + BETWEEN.1);
    let own = left + columns as f64 * step.0 - BETWEEN.0 + widest + MARGIN;
    let width = look.page.unwrap_or(own);
    let heading = Heading::new(look, print.title, width);
    let lines: usize = rows.iter().map(|row| row.len().div_ceil(columns)).sum();
    let height = heading.height() + lines as f64 * step.1 + Scale::below() + MARGIN;
    let page = Page::new(look, width, height);
    heading.draw(&page);
    let mut line = 0;
    for (row, (largest, bar)) in rows.iter().zip(&bars) {
        for (part, maps) in row.chunks(columns).enumerate() {
            for (column, (method, found)) in maps.iter().enumerate() {
                let top = heading.height() + above + line as f64 * step.1;
                let map = Rectangle::new((left + column as f64 * step.0, top), (side, high));
                let is_first = column == 0 && part == 0;
                write_lines(&page, map, (*method, is_first), found.value, family);
                draw_map(&page, map, found, (x, y), *largest);
                across.draw_below(&page, map, line + 1 == lines);
                up.draw_left(&page, map, column == 0);
                if column + 1 == maps.len() {
                    bar.draw(&page, map, &[]);
                }
            }
            line += 1;
        }
    }
    let density = caption::density(family, observable);
    let what = format!("Steady-state joint density {density}");
    let how = "of the generator followed between the cells by parabolas with their averages.";
    let how = format!("{how}{}", caption::floor(look));
    let table = table(comparison, |one| *one == observable);
    let caption = caption_of(comparison, &what, &how);
    Some(Figure::new(&page, caption, table).of_panels(count))
}

/// Columns, and the side of a map: all methods side by side, as far as they fit on a given page.
fn arrangement(look: &Look, methods: usize, beside: f64) -> (usize, f64) {
    if look.page.is_none() {
        return (methods, SIDE);
    }
    let side = |columns: usize| {
        let gaps = (columns - 1) as f64 * BETWEEN.0;
        look.fill(SIDE, beside + gaps) / columns as f64
    };
    // A slide is low: one row of four maps stands on it, and not two.
    let least = if look.has_fixed_height {
        SMALLEST_ON_SLIDE
    } else {
        SMALLEST
    };
    let columns = Look::columns(methods, |columns| side(columns) >= least);
    let columns = Look::even_columns(methods, columns);
    (columns, side(columns).min(TALLEST))
}

/// Writes what stands above a map: the method, and the value at the head of a row.
fn write_lines(
    page: &Page,
    map: Rectangle,
    (method, is_first): (Method, bool),
    value: f64,
    family: &Family,
) {
    if page.look().page.is_none() {
        return write_above(page, map, above(method, value, is_first, family));
    }
    let title = above(method, value, false, family);
    let fits = text_width(page.look(), &title, TEXT, false) <= map.width + 0.5 * BETWEEN.0;
    // It stands beside the map of SGCM itself.
    let is_short = method == Method::SgcmSlope && !fits;
    let title = if is_short {
        "corrected".to_owned()
    } else {
        title
    };
    write_above(page, map, title);
    if is_first {
        let higher = Rectangle {
            top: map.top - 1.3 * TEXT,
            ..map
        };
        write_above(page, higher, names::at(family, value));
    }
}

/// The line above a map: the value at the head of a row, and the method.
fn above(method: Method, value: f64, is_first: bool, family: &Family) -> String {
    let title = match method {
        Method::SgcmSlope => "SGCM, corrected",
        method => method.title(),
    };
    if is_first {
        format!("{}: {title}", names::at(family, value))
    } else {
        title.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::style::{FigureStyle, FigureWidth};

    #[test]
    fn four_methods_leave_no_hole() {
        let columns = |width| {
            let style = FigureStyle {
                width,
                ..FigureStyle::default()
            };
            arrangement(&style.look(), 4, 110.0).0
        };
        for width in FigureWidth::NAMED {
            assert_ne!(columns(width), 3, "{width:?}");
        }
        assert_eq!(columns(FigureWidth::Slide), 4);
    }
}
