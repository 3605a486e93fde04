//! Joint densities of two axes as surfaces: one figure a parameter value, and a sheet of all. Heights are those on
//! lines that lie evenly, with those on kinks and through the summit. A density with sampling noise has the heights
//! of the cells' middles; where there are more cells than can be seen, lines of cells are left out, but never those
//! beside a kink or through the summit.

use crate::space::Axis;

use super::{Kind, Sketch, Sweep};
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Rectangle};
use crate::figure::canvas::space::{Heights, Ranges, Space};
use crate::figure::canvas::style::{MARGIN, TEXT};
use crate::figure::parts::joint_map::{Joint, JointPoint, with_letter, write_above};
use crate::figure::print::Print;

/// Width of a single surface with its axes, in pixels.
const SINGLE: f64 = 470.0;
/// The same on a sheet, and the narrowest one beside another where the page is given.
const SMALL: f64 = 330.0;
const NARROWEST: f64 = 250.0;
/// The narrowest one where wider ones are higher than a page together.
const NARROWEST_OF_MANY: f64 = 188.0;
/// The lowest ones on a sheet, as a share of their usual size.
const LOWEST: f64 = 0.72;
/// The widest one, however wide the page.
const WIDEST: f64 = 560.0;
/// Room of the line above a surface.
const ABOVE: f64 = 1.5 * TEXT;
/// Lines of a single surface, and of one on a sheet.
const FINE: usize = 100;
pub(super) const COARSE: usize = 90;

pub(super) const KIND: Kind = Kind {
    names: &["surface"],
    usual: None,
    sketches,
};

/// A sheet an observed pair of axes, then its surfaces one by one.
fn sketches<'a>(sweep: &Sweep<'a>) -> Vec<Sketch<'a>> {
    let mut sketches = Vec::new();
    for (number, pair) in sweep.pairs() {
        let (name, way) = (format!("surface_{pair}"), (number, "as a surface"));
        sketches.push(sweep.joint(&name, way, &sweep.chosen, draw_sheet));
        sketches.extend(sweep.each_joint(&name, way, draw_single));
    }
    sketches
}

/// The axes of a surface whose heights go up to `top`.
pub(super) fn ranges<'a>(joint: &'a Joint<'_>, top: f64) -> Ranges<'a> {
    let ([first, second, density], (x, y)) = (&joint.titles, joint.window);
    Ranges {
        x: (x, first),
        y: (y, second),
        z: ((0.0, top), density),
    }
}

/// Draws a surface of at most so many lines into a rectangle as high as [`Space::height`] says.
pub(super) fn draw_surface(
    page: &Page,
    rect: Rectangle,
    joint: &Joint<'_>,
    (found, most): (&JointPoint<'_>, usize),
) {
    let top = found.shown.largest;
    let space = Space::new(page.look(), rect, ranges(joint, top));
    if let Some(heights) = heights(found, joint.window, top, most) {
        space.draw(page, &heights);
    }
}

/// One surface at one point.
fn draw_single(joint: &Joint<'_>, print: &Print<'_>) -> Option<Page> {
    let (look, found) = (&print.look, &joint.found[0]);
    let width = look.page.unwrap_or(SINGLE + 2.0 * MARGIN);
    let wide = (width - 2.0 * MARGIN).min(WIDEST) * look.tall.min(1.0);
    let high = Space::height(look, wide, ranges(joint, found.shown.largest));
    let heading = Heading::new(look, print.title, width);
    let page = Page::new(look, width, heading.height() + ABOVE + high + MARGIN);
    heading.draw(&page);
    let corner = (0.5 * (width - wide), heading.height() + ABOVE);
    let rect = Rectangle::new(corner, (wide, high));
    write_above(&page, rect, joint.at(found));
    draw_surface(&page, rect, joint, (found, FINE));
    Some(page)
}

/// All surfaces of a pair on one sheet, with the same windows, each with heights of its own; `None` for fewer than two
/// densities.
fn draw_sheet(joint: &Joint<'_>, print: &Print<'_>) -> Option<Page> {
    let (look, found) = (&print.look, &joint.found);
    if joint.count() < 2 {
        return None;
    }
    let high = |wide: f64| {
        let heights = found.iter().map(|one| {
            let ranges = ranges(joint, one.shown.largest);
            Space::height(look, wide - MARGIN, ranges)
        });
        heights.fold(0.0, f64::max)
    };
    let (mut columns, mut column) = arrangement(look, (found.len(), NARROWEST));
    let rows = |columns: usize| found.len().div_ceil(columns) as f64;
    if rows(columns) * (ABOVE + high(column) + MARGIN) > look.greatest_height {
        (columns, column) = arrangement(look, (found.len(), NARROWEST_OF_MANY));
    }
    let wide = column * lowered(look, found.len());
    let high = high(wide);
    let width = look.page.unwrap_or(columns as f64 * column + 2.0 * MARGIN);
    let heading = Heading::new(look, print.title, width);
    let step = ABOVE + high + MARGIN;
    let height = heading.height() + rows(columns) * step;
    let page = Page::new(look, width, height);
    heading.draw(&page);
    let margin = 0.5 * (width - columns as f64 * column) + 0.5 * (column - wide);
    let first = Rectangle::new((margin, heading.height() + ABOVE), (wide - MARGIN, high));
    for (number, found) in found.iter().enumerate() {
        let rect = first.tile(number, columns, (column, step));
        let number = joint.before + number;
        write_above(&page, rect, with_letter(look, number, joint.at(found)));
        draw_surface(&page, rect, joint, (found, COARSE));
    }
    Some(page)
}

/// By how much surfaces on a page of so many are smaller than usual: several are not lower than what can be read, and
/// move to further pages instead.
pub(super) fn lowered(look: &Look, count: usize) -> f64 {
    let least = if count > 1 { LOWEST } else { 0.0 };
    look.tall.clamp(least, 1.0)
}

/// Columns of a sheet of so many surfaces, none narrower than so much where the page is given, and the width of each.
fn arrangement(look: &Look, (surfaces, narrowest): (usize, f64)) -> (usize, f64) {
    let most = match surfaces {
        2 | 4 => 2,
        _ => 3,
    };
    let width = |columns: usize| look.fill(SMALL * columns as f64, 2.0 * MARGIN) / columns as f64;
    let fits = |columns: usize| look.page.is_none() || width(columns) >= narrowest;
    let columns = Look::even_columns(surfaces, Look::columns(most, fits));
    (columns, width(columns).min(WIDEST))
}

/// The middles of the cells of a window, of which at most about `most` are kept: evenly, with those in `wanted` always.
fn lines(axis: &Axis, window: (f64, f64), most: usize, wanted: &[usize]) -> Vec<usize> {
    let centres = axis.centres();
    let inside = |&cell: &usize| centres[cell] > window.0 && centres[cell] < window.1;
    let cells: Vec<usize> = (0..axis.count()).filter(inside).collect();
    if cells.len() <= most {
        return cells;
    }
    let apart = (window.1 - window.0) / most as f64;
    let mut kept: Vec<usize> = Vec::new();
    let mut next = f64::NEG_INFINITY;
    for &cell in &cells {
        if centres[cell] >= next || wanted.contains(&cell) || cells.last() == Some(&cell) {
            kept.push(cell);
            next = centres[cell] + 0.999 * apart;
        }
    }
    kept
}

/// The surface of a density over a window, in shares of the window and of `top`; `None` where there is too little of
/// it.
fn heights(
    found: &JointPoint<'_>,
    (x, y): ((f64, f64), (f64, f64)),
    top: f64,
    most: usize,
) -> Option<Heights> {
    let (estimated, density) = (found.estimated, found.density());
    let [across, along] = &density.axes[..] else {
        return None;
    };
    let values = density.values.iter().enumerate();
    let (summit, _) = values.max_by(|a, b| a.1.total_cmp(b.1))?;
    let summit = [summit / along.count(), summit % along.count()];
    let wanted = |number: usize, axis: &Axis| {
        let mut cells = vec![summit[number]];
        for kink in estimated
            .structure
            .kinks
            .iter()
            .filter(|kink| kink.axis == number)
        {
            let face = axis.edges().partition_point(|&edge| edge < kink.at);
            cells.extend([face.saturating_sub(1), face]);
        }
        cells
    };
    let height = |value: f64| {
        if value.is_finite() {
            (value / top).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    if let (Some(between), true) = (&found.shown.between, top > 0.0) {
        let through = |k: usize, axis: &Axis, window: (f64, f64)| {
            let mut places = between.places(k, window, most);
            places.push(axis.centre(summit[k]));
            places.sort_by(f64::total_cmp);
            places.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * (window.1 - window.0));
            places
        };
        let (xs, ys) = (through(0, across, x), through(1, along, y));
        let share = |(from, to): (f64, f64)| move |place: &f64| (place - from) / (to - from);
        return Some(Heights {
            x: xs.iter().map(share(x)).collect(),
            y: ys.iter().map(share(y)).collect(),
            z: between.sheet(&xs, &ys).into_iter().map(height).collect(),
        });
    }
    let i = lines(across, x, most, &wanted(0, across));
    let j = lines(along, y, most, &wanted(1, along));
    if i.len() < 2 || j.len() < 2 || top <= 0.0 {
        return None;
    }
    let shares = |axis: &Axis, cells: &[usize], (from, to): (f64, f64)| -> Vec<f64> {
        let centres = axis.centres();
        let share = |&cell: &usize| (centres[cell] - from) / (to - from);
        let mut shares: Vec<f64> = cells.iter().map(share).collect();
        // The outermost cells reach to the ends of the window.
        shares[0] = 0.0;
        if let Some(last) = shares.last_mut() {
            *last = 1.0;
        }
        shares
    };
    let cells = i
        .iter()
        .flat_map(|i| j.iter().map(move |j| i * along.count() + j));
    Some(Heights {
        x: shares(across, &i, x),
        y: shares(along, &j, y),
        z: cells.map(|cell| height(density.values[cell])).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_cells_are_even_and_keep_what_is_wanted() {
        let axis = Axis::uniform(-1.0, 1.0, 400).unwrap();
        let kept = lines(&axis, (-1.0, 1.0), 50, &[199, 200, 333]);
        assert!([199, 200, 333, 399].iter().all(|cell| kept.contains(cell)));
        assert!((50..56).contains(&kept.len()), "{}", kept.len());
        let few = lines(&axis, (-0.1, 0.1), 50, &[]);
        assert_eq!(few.len(), 40, "all cells of a small window");
    }
}
