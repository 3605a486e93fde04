//! A joint density twice, as a surface and as a map beside it: a row a parameter value, as papers of this field print
//! them.

use super::Kind;
use super::surface::{COARSE, draw_surface, lowered, ranges};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::Scale;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Rectangle};
use crate::figure::canvas::space::Space;
use crate::figure::canvas::style::{MARGIN, TEXT};
use crate::figure::parts::joint_map::{Joint, JointPoint, draw_map, with_letter, write_above};
use crate::figure::print::Print;

/// Width of a surface with its axes on a page of its own width, in pixels.
const SURFACE: f64 = 330.0;
/// Side of the map beside it.
const MAP: f64 = 190.0;
/// Room of the line above a row.
const ABOVE: f64 = 2.0 * TEXT;
/// Gap between surface and map.
const BETWEEN: f64 = 16.0;
/// In a row narrower than this there is no colour bar: the surface has the same colours, and an axis.
const NARROW: f64 = 540.0;
/// The narrowest row beside another.
const COLUMN: f64 = 400.0;
/// Room right of a map without a colour bar.
const BESIDE: f64 = 6.0;

pub(super) const KIND: Kind = Kind {
    names: &["pairs"],
    usual: None,
    sketches: |sweep| {
        let way = "as a surface and as a map";
        let pairs = sweep.pairs();
        pairs
            .map(|(number, pair)| {
                sweep.joint(format!("pairs_{pair}"), (number, way), &sweep.chosen, draw)
            })
            .collect()
    },
};

/// Where surface and map of a row stand, in pixels.
struct PanelPlaces {
    /// Width of the row with its margins.
    width: f64,
    surface: f64,
    map: (f64, f64),
}

impl PanelPlaces {
    /// `left` and `right` are what stands beside the map; the row is `given` wide, or as wide as its own.
    fn new(given: Option<f64>, tall: f64, (left, right): (f64, f64)) -> Self {
        let Some(width) = given else {
            let (surface, map) = (tall * SURFACE, tall * MAP);
            return Self {
                width: 2.0 * MARGIN + surface + BETWEEN + left + map + right,
                surface,
                map: (map, map),
            };
        };
        let room = width - 2.0 * MARGIN;
        let surface = 0.56 * room;
        let map = room - surface - BETWEEN - left - right;
        let surface = tall * surface;
        Self {
            width,
            surface,
            map: (map, map.min(0.62 * surface)),
        }
    }
}

/// The rows of a page, laid out.
struct Rows<'a> {
    joint: &'a Joint<'a>,
    row: PanelPlaces,
    surface_high: f64,
    across: Scale,
    up: Scale,
    /// Empty where there is no room for them.
    bars: Vec<ColourBar>,
    /// What stands right of the map.
    right: f64,
}

impl<'a> Rows<'a> {
    /// Rows that are `given` wide, or as wide as their own.
    fn new(look: &Look, joint: &'a Joint<'_>, given: Option<f64>) -> Self {
        let (found, (x, y)) = (&joint.found, joint.window);
        let tall = lowered(look, found.len());
        let [first, second, density] = &joint.titles;
        let bars = |high: f64| {
            let bar =
                |found: &JointPoint<'_>| ColourBar::new(look, found.shown.largest, high, density);
            let has_bars = given.is_none_or(|width| width >= NARROW);
            let shown = found.iter().filter(|_| has_bars);
            shown.map(bar).collect::<Vec<_>>()
        };
        // Without a bar, half a label of the abscissa stands out.
        let right = |bars: &[ColourBar]| bars.iter().map(ColourBar::width).fold(BESIDE, f64::max);
        let vertical = |high: f64| Scale::vertical(look, y, high, second);
        // What stands beside the map hardly depends on its height: a first round measures it.
        let beside = (vertical(MAP).left(), right(&bars(MAP)));
        let high = PanelPlaces::new(given, tall, beside).map.1;
        let (up, bars) = (vertical(high), bars(high));
        let right = right(&bars);
        let row = PanelPlaces::new(given, tall, (up.left(), right));
        let row = PanelPlaces {
            map: (row.map.0, high),
            ..row
        };
        let heights = found.iter().map(|one| {
            let ranges = ranges(joint, one.shown.largest);
            Space::height(look, row.surface, ranges)
        });
        Self {
            joint,
            surface_high: heights.fold(0.0, f64::max),
            across: Scale::horizontal(look, x, row.map.0, first),
            row,
            up,
            bars,
            right,
        }
    }

    /// From one row to the next.
    fn step(&self) -> f64 {
        let map = self.row.map.1 + Scale::below();
        ABOVE + self.surface_high.max(map) + MARGIN
    }

    /// Draws one with its left upper corner at a place.
    fn draw(&self, page: &Page, number: usize, (left, top): (f64, f64)) {
        let (joint, look) = (self.joint, page.look());
        let found = &joint.found[number];
        let from = top + ABOVE;
        let size = (self.row.surface, self.surface_high);
        let surface = Rectangle::new((left + MARGIN, from), size);
        let line = with_letter(look, joint.before + number, joint.at(found));
        write_above(page, surface, line);
        draw_surface(page, surface, joint, (found, COARSE));
        let place = left + self.row.width - MARGIN - self.right - self.row.map.0;
        let down = self.step() - ABOVE - MARGIN - self.row.map.1 - Scale::below();
        let map = Rectangle::new((place, from + 0.5 * down), self.row.map);
        draw_map(page, map, found, joint.window, found.shown.largest);
        self.across.draw_below(page, map, true);
        self.up.draw_left(page, map, true);
        if let Some(bar) = self.bars.get(number) {
            bar.draw(page, map, &[]);
        }
    }
}

/// The figure: rows below each other, in two columns where they are higher than a page together and there is room.
fn draw(joint: &Joint<'_>, print: &Print<'_>) -> Option<Page> {
    let (look, count) = (&print.look, joint.found.len());
    let usual = Look { tall: 1.0, ..*look };
    let together = count as f64 * Rows::new(&usual, joint, look.page).step();
    let has_room = look.page.is_some_and(|page| page >= 2.0 * COLUMN);
    let columns = if together > look.greatest_height && has_room {
        count.min(2)
    } else {
        1
    };
    let rows = Rows::new(look, joint, look.page.map(|page| page / columns as f64));
    let width = rows.row.width * columns as f64;
    let heading = Heading::new(look, print.title, width);
    let lines = count.div_ceil(columns) as f64;
    let page = Page::new(look, width, heading.height() + lines * rows.step());
    heading.draw(&page);
    for number in 0..count {
        let (line, column) = ((number / columns) as f64, (number % columns) as f64);
        let top = heading.height() + line * rows.step();
        rows.draw(&page, number, (column * rows.row.width, top));
    }
    Some(page)
}
