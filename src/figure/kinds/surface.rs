//! Joint densities of two axes as surfaces: one figure a parameter value, and a sheet of all. Heights are those on
//! lines that lie evenly, with those on kinks and through the summit. A density with sampling noise has the heights
//! of the cells' middles; where there are more cells than can be seen, lines of cells are left out, but never those
//! beside a kink or through the summit.

use crate::continuation::{Point, SweepResult};
use crate::density::Observable;
use crate::space::Axis;

use super::{Kind, Sketch, Sweep};
use crate::figure::FigureError;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Rectangle};
use crate::figure::canvas::space::{Heights, Ranges, Space};
use crate::figure::canvas::style::{MARGIN, TEXT};
use crate::figure::figures::Print;
use crate::figure::parts::joint_map::{Found, lettered, windows, write_above};
use crate::figure::parts::names;
use crate::system::Family;

/// Width of a single surface with its axes, in pixels.
const SINGLE: f64 = 470.0;
/// The same on a sheet, and the narrowest one beside another where the page is given.
const SMALL: f64 = 330.0;
const NARROWEST: f64 = 250.0;
/// The widest one, however wide the page.
const WIDEST: f64 = 560.0;
/// Room of the line above a surface.
const ABOVE: f64 = 1.5 * TEXT;
/// Lines of a single surface, and of one on a sheet.
pub(super) const FINE: usize = 100;
pub(super) const COARSE: usize = 90;

pub(super) const KIND: Kind = Kind {
    names: &["surface"],
    is_usual: false,
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

/// What surfaces of one pair of axes share.
pub(super) struct Frame {
    x: (f64, f64),
    y: (f64, f64),
    titles: [String; 3],
}

impl Frame {
    /// The windows and titles of some densities of a pair; `None` where there is nothing to see.
    pub(super) fn new(
        family: &Family,
        observable: Observable,
        found: &[Found<'_>],
    ) -> Option<Self> {
        let Observable::Joint(first, second) = observable else {
            return None;
        };
        let (x, y) = windows(found)?;
        Some(Self {
            x,
            y,
            titles: [
                names::axis(family, first),
                names::axis(family, second),
                names::density(family, observable),
            ],
        })
    }

    /// The axes of a surface whose heights go up to `top`.
    pub(super) fn ranges(&self, top: f64) -> Ranges<'_> {
        Ranges {
            x: (self.x, &self.titles[0]),
            y: (self.y, &self.titles[1]),
            z: ((0.0, top), &self.titles[2]),
        }
    }

    /// Draws a surface into a rectangle as high as [`Space::height`] says.
    pub(super) fn draw(
        &self,
        page: &Page,
        rect: Rectangle,
        (found, top, most): (&Found<'_>, f64, usize),
    ) -> Result<(), FigureError> {
        let space = Space::new(page.look(), rect, self.ranges(top))?;
        if let Some(heights) = heights(found, (self.x, self.y), top, most) {
            space.draw(page, &heights);
        }
        Ok(())
    }
}

/// One surface at one point; `None` without a density.
fn draw_single(
    result: &SweepResult,
    observable: usize,
    points: &[&Point],
    print: &Print<'_>,
) -> Result<Option<Page>, FigureError> {
    let (family, look) = (&result.subject.family, &print.look);
    let watched = result.subject.observables[observable];
    let found = Found::all(points, observable);
    let Some(frame) = Frame::new(family, watched, &found) else {
        return Ok(None);
    };
    let top = found[0].shown.largest;
    let width = look.page.unwrap_or(SINGLE + 2.0 * MARGIN);
    let wide = (width - 2.0 * MARGIN).min(WIDEST);
    let high = Space::height(look, wide, frame.ranges(top))?;
    let heading = Heading::new(look, print.title, width)?;
    let page = Page::new(look, width, heading.height() + ABOVE + high + MARGIN);
    heading.draw(&page);
    let rect = Rectangle::new(
        (0.5 * (width - wide), heading.height() + ABOVE),
        (wide, high),
    );
    write_above(&page, rect, names::at(family, found[0].value));
    frame.draw(&page, rect, (&found[0], top, FINE))?;
    Ok(Some(page))
}

/// All surfaces of a pair on one sheet, with the same windows, each with heights of its own; `None` for fewer than two
/// densities.
fn draw_sheet(
    result: &SweepResult,
    observable: usize,
    chosen: &[&Point],
    print: &Print<'_>,
) -> Result<Option<Page>, FigureError> {
    let (family, look) = (&result.subject.family, &print.look);
    let watched = result.subject.observables[observable];
    let found = Found::all(chosen, observable);
    let (true, Some(frame)) = (found.len() > 1, Frame::new(family, watched, &found)) else {
        return Ok(None);
    };
    let (columns, wide) = arrangement(look, found.len());
    let width = look.page.unwrap_or(columns as f64 * wide + 2.0 * MARGIN);
    let tops: Vec<f64> = found.iter().map(|found| found.shown.largest).collect();
    let mut high: f64 = 0.0;
    for &top in &tops {
        high = high.max(Space::height(look, wide - MARGIN, frame.ranges(top))?);
    }
    let heading = Heading::new(look, print.title, width)?;
    let rows = found.len().div_ceil(columns);
    let step = ABOVE + high + MARGIN;
    let page = Page::new(look, width, heading.height() + rows as f64 * step);
    heading.draw(&page);
    let margin = 0.5 * (width - columns as f64 * wide);
    for (number, (found, &top)) in found.iter().zip(&tops).enumerate() {
        let rect = Rectangle::new(
            (
                margin + (number % columns) as f64 * wide,
                heading.height() + ABOVE + (number / columns) as f64 * step,
            ),
            (wide - MARGIN, high),
        );
        let line = lettered(look, number, names::at(family, found.value));
        write_above(&page, rect, line);
        frame.draw(&page, rect, (found, top, COARSE))?;
    }
    Ok(Some(page))
}

/// Columns of a sheet, and the width of each.
fn arrangement(look: &Look, surfaces: usize) -> (usize, f64) {
    let most = match surfaces {
        2 | 4 => 2,
        _ => 3,
    };
    let width = |columns: usize| look.fill(SMALL * columns as f64, 2.0 * MARGIN) / columns as f64;
    let fits = |columns: &usize| look.page.is_none() || width(*columns) >= NARROWEST;
    let columns = (1..=most).rev().find(fits).unwrap_or(1);
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
    found: &Found<'_>,
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
    let height = |value: f64| match value.is_finite() {
        true => (value / top).clamp(0.0, 1.0),
        false => 0.0,
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
