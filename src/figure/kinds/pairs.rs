//! A joint density twice, as a surface and as a map beside it: a row a parameter value, as papers of this field print
//! them.

use super::Kind;
use super::surface::{COARSE, draw_surface, ranges};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::Scale;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Rectangle};
use crate::figure::canvas::space::Space;
use crate::figure::canvas::style::{MARGIN, TEXT};
use crate::figure::figures::Print;
use crate::figure::parts::joint_map::{Joint, JointPoint, draw_map, with_letter, write_above};

/// Width of a surface with its axes on a page of its own width, in pixels.
const SURFACE: f64 = 330.0;
/// Side of the map beside it.
const MAP: f64 = 190.0;
/// Room of the line above a row.
const ABOVE: f64 = 2.0 * TEXT;
/// Gap between surface and map.
const BETWEEN: f64 = 16.0;
/// On a page narrower than this there is no colour bar: the surface has the same colours, and an axis.
const NARROW: f64 = 540.0;

pub(super) const KIND: Kind = Kind {
    names: &["pairs"],
    is_usual: false,
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
struct Row {
    page: f64,
    surface: f64,
    map: (f64, f64),
}

impl Row {
    /// `left` and `right` are what stands beside the map.
    fn new(look: &Look, left: f64, right: f64) -> Self {
        let Some(page) = look.page else {
            return Self {
                page: 2.0 * MARGIN + SURFACE + BETWEEN + left + MAP + right,
                surface: SURFACE,
                map: (MAP, MAP),
            };
        };
        let room = page - 2.0 * MARGIN;
        let surface = 0.56 * room;
        let map = room - surface - BETWEEN - left - right;
        Self {
            page,
            surface,
            map: (map, map.min(0.62 * surface)),
        }
    }
}

/// The figure.
fn draw(joint: &Joint<'_>, print: &Print<'_>) -> Option<Page> {
    let (look, found, (x, y)) = (&print.look, &joint.found, joint.window);
    let [first, second, density] = &joint.titles;
    let bars = |high: f64| {
        let bar = |found: &JointPoint<'_>| ColourBar::new(look, found.shown.largest, high, density);
        found.iter().map(bar).collect::<Vec<_>>()
    };
    let vertical = |high: f64| Scale::vertical(look, y, high, second);
    let has_bars = look.page.is_none_or(|page| page >= NARROW);
    let widest = |bars: &[ColourBar]| {
        if has_bars {
            bars.iter().map(ColourBar::width).fold(0.0, f64::max)
        } else {
            // Half a label of the abscissa stands out.
            6.0
        }
    };
    // What stands beside the map hardly depends on its height: a first round measures it.
    let row = Row::new(look, vertical(MAP).left(), widest(&bars(MAP)));
    let (up, bars) = (vertical(row.map.1), bars(row.map.1));
    let row = Row {
        map: (Row::new(look, up.left(), widest(&bars)).map.0, row.map.1),
        ..row
    };
    let across = Scale::horizontal(look, x, row.map.0, first);
    let mut surface_high: f64 = 0.0;
    for one in found {
        let ranges = ranges(joint, one.shown.largest);
        surface_high = surface_high.max(Space::height(look, row.surface, ranges));
    }
    let map_high = row.map.1 + Scale::below();
    let step = ABOVE + surface_high.max(map_high);
    let heading = Heading::new(look, print.title, row.page);
    let height = heading.height() + found.len() as f64 * (step + MARGIN);
    let page = Page::new(look, row.page, height);
    heading.draw(&page);
    for (number, (found, bar)) in found.iter().zip(&bars).enumerate() {
        let from = heading.height() + ABOVE + number as f64 * (step + MARGIN);
        let surface = Rectangle::new((MARGIN, from), (row.surface, surface_high));
        write_above(&page, surface, with_letter(look, number, joint.at(found)));
        draw_surface(&page, surface, joint, (found, COARSE));
        let left = row.page - MARGIN - widest(&bars) - row.map.0;
        let top = from + 0.5 * (surface_high.max(map_high) - map_high);
        let map = Rectangle::new((left, top), row.map);
        draw_map(&page, map, found, (x, y), found.shown.largest);
        across.draw_below(&page, map, true);
        up.draw_left(&page, map, true);
        if has_bars {
            bar.draw(&page, map, &[]);
        }
    }
    Some(page)
}
