//! Joint densities on one sheet: as many columns as there is room for, the same windows, one colour bar.

use plotters_backend::text_anchor::HPos;

use crate::figure::print::Print;

use super::joint_map::{Joint, JointPoint, draw_map, levels, open_page, with_letter, write_above};
use super::names;
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::Scale;
use crate::figure::canvas::letters;
use crate::figure::canvas::look::{Look, on_heat};
use crate::figure::canvas::page::{Page, Rectangle, Shape, small};
use crate::figure::canvas::style::{Colour, MARGIN, TEXT, TICK_TEXT};
use crate::figure::canvas::symbols;

/// Side of a map on a sheet.
const SMALL: f64 = 190.0;
/// Narrowest map on a sheet, where the page is given, and the highest one.
const SMALLEST: f64 = 104.0;
/// Gap between maps on a sheet, and that between the labels of their ticks.
const BETWEEN: f64 = 14.0;
const BETWEEN_LABELS: f64 = 8.0;
/// The densities of a sheet share their scale unless the largest values differ by more than this factor.
const COMPARABLE: f64 = 3.0;
const TALLEST_SMALL: f64 = 400.0;
/// Maps of a sheet of one column at most, where letters cost the second one.
const MOST_IN_A_TOWER: usize = 3;
/// Digits of values where there is little room.
const FEW: usize = 2;
/// Digits of the largest density in a map.
const DIGITS: usize = 3;

/// How the maps of a sheet are arranged and coloured.
struct Sheet {
    columns: usize,
    /// Width and height of a map, in pixels.
    side: (f64, f64),
    /// Distance between neighbouring maps, in pixels.
    step: (f64, f64),
    /// Size of all maps together, in pixels.
    whole: (f64, f64),
    /// The density at the upper end of the colours, where all maps share it.
    common: Option<f64>,
}

impl Sheet {
    /// Arranges maps in as many columns as there is room for between what stands left and right of them all, `beside`
    /// pixels; on a given page none is narrower than `least`. Columns are `between` pixels apart.
    fn new(look: &Look, joint: &Joint<'_>, (beside, between): (f64, f64), least: f64) -> Self {
        let found = &joint.found;
        let own_columns = match found.len() {
            2 | 4 => 2,
            10.. => 4,
            _ => 3,
        };
        let width = |columns: usize| {
            let gaps = (columns - 1) as f64 * between;
            look.fill(SMALL * columns as f64, beside + gaps) / columns as f64
        };
        let most = if found.len() == 9 || found.len() < 4 {
            3
        } else {
            4
        };
        let columns = match look.page {
            None => own_columns,
            Some(_) => Look::columns(most.min(found.len()), |columns| {
                width(columns) >= least.max(SMALLEST)
            }),
        };
        let columns = Look::even_columns(found.len(), columns);
        let high = look.tall * width(columns).min(TALLEST_SMALL);
        let side = (width(columns), high);
        let rows = found.len().div_ceil(columns);
        let step = (side.0 + between, side.1 + BETWEEN + 1.4 * TEXT);
        let (least, largest) = joint.summits;
        let comparable = least * COMPARABLE >= largest;
        Self {
            columns,
            side,
            step,
            whole: (
                (columns - 1) as f64 * step.0 + side.0,
                (rows - 1) as f64 * step.1 + side.1,
            ),
            common: comparable.then_some(largest),
        }
    }

    /// The colour bar of all maps.
    fn bar(&self, look: &Look, density: &str) -> ColourBar {
        match self.common {
            Some(largest) => ColourBar::new(look, largest, self.whole.1, density),
            None => ColourBar::new(look, 1.0, self.whole.1, &format!("{density} / max")),
        }
    }
}

/// Narrowest map whose line does not touch that of its neighbour.
fn widest(look: &Look, lines: &[String]) -> f64 {
    let mut least: f64 = 0.0;
    for line in lines {
        least = least.max(letters::text_width(look, line, TEXT, false) + 4.0 - BETWEEN / 2.0);
    }
    least
}

/// The sheet with the lines above its maps; `arranged` gives the sheet whose maps are so wide at least. Many maps below
/// each other fill no page of a journal: without letters, or with values in fewer digits, there may be room for a
/// second column.
fn with_lines(
    (look, joint): (&Look, &Joint<'_>),
    arranged: &dyn Fn(f64) -> Sheet,
) -> (Sheet, Vec<String>) {
    let (found, family) = (&joint.found, &joint.result.subject.family);
    let at = |found: &JointPoint<'_>| joint.at(found);
    let short = |found: &JointPoint<'_>| names::at(family, symbols::rounded_to(found.value, FEW));
    let numbered = found.iter().enumerate();
    let lettered = numbered.map(|(number, found)| {
        let number = joint.before + number;
        with_letter(look, number, at(found))
    });
    let lines: Vec<String> = lettered.collect();
    let sheet = arranged(widest(look, &lines));
    // What stands above a single column may reach into the gap before the bar, whose title is beside it.
    let has_room = |words: &[String]| widest(look, words) <= sheet.side.0 + 0.5 * BETWEEN;
    if sheet.columns > 1 || (found.len() <= MOST_IN_A_TOWER && has_room(&lines)) {
        return (sheet, lines);
    }
    let barer: [Vec<String>; 2] = [
        found.iter().map(at).collect(),
        found.iter().map(short).collect(),
    ];
    let is_told_apart = |words: &[String]| words.windows(2).all(|pair| pair[0] != pair[1]);
    for words in barer.iter().filter(|words| is_told_apart(words)) {
        let wider = arranged(widest(look, words));
        if wider.columns > 1 {
            return (wider, words.clone());
        }
    }
    let mut fitting = [&lines].into_iter().chain(&barer);
    let fitting = fitting.find(|words| has_room(words) && is_told_apart(words));
    let words = fitting.cloned().unwrap_or_else(|| lines.clone());
    (sheet, words)
}

/// Writes the largest density into the lower right corner of a map whose colours it scales, on the colour of no
/// density: logarithmic colours may be dark there.
fn write_maximum(page: &Page, map: Rectangle, found: &JointPoint<'_>) {
    let look = page.look();
    let largest = symbols::rounded_to(found.shown.largest, DIGITS);
    let text = format!("max {}", symbols::value(largest));
    let wide = letters::text_width(look, &text, TICK_TEXT, false) + 6.0;
    let corner = (
        map.right() - wide - 1.0,
        map.bottom() - 1.3 * TICK_TEXT - 1.0,
    );
    let ground = Rectangle::new(corner, (wide, 1.3 * TICK_TEXT));
    let empty = Colour::fixed(look.colours.colour(0.0)).at(0.8);
    page.draw(&ground.corners(), Shape::Area(empty));
    let place = (ground.right() - 3.0, ground.top + 0.5 * ground.height);
    page.text(place, small(text, HPos::Right, on_heat(look, 0.0)));
}

/// All maps of a pair on one sheet, with the same windows; `None` for fewer than two densities.
pub(crate) fn draw(joint: &Joint<'_>, print: &Print<'_>) -> Option<Page> {
    let (look, found, (x, y)) = (&print.look, &joint.found, joint.window);
    if joint.count() < 2 {
        return None;
    }
    let [first, second, density] = &joint.titles;
    let vertical = |high: f64| Scale::vertical(look, y, high, second);
    let horizontal = |long: f64| Scale::horizontal(look, x, long, first);
    let arranged = |least: f64| -> Sheet {
        // The bar and the labels of the ordinate hardly depend on how high the maps are: a first sheet measures them.
        let rough = Sheet::new(look, joint, (140.0, BETWEEN), least);
        let bar_width = rough.bar(look, density).width();
        let left = MARGIN + vertical(rough.side.1).left();
        let beyond = horizontal(rough.side.0).beyond(rough.side.0);
        let between = BETWEEN.max(beyond + BETWEEN_LABELS);
        let beside = left + bar_width + MARGIN;
        Sheet::new(look, joint, (beside, between), least)
    };
    let (sheet, lines) = with_lines((look, joint), &arranged);
    let bar = sheet.bar(look, density);
    let (across, up) = (horizontal(sheet.side.0), vertical(sheet.side.1));
    let left = MARGIN + up.left();
    let own = left + sheet.whole.0 + bar.width() + MARGIN;
    let width = look.page.unwrap_or(own);
    let (page, all) = open_page(print, found, (left, width), sheet.whole);
    let first = Rectangle::new((all.left, all.top), sheet.side);
    for (number, (found, line)) in found.iter().zip(lines).enumerate() {
        let map = first.tile(number, sheet.columns, sheet.step);
        write_above(&page, map, line);
        let top = sheet.common.unwrap_or(found.shown.largest);
        draw_map(&page, map, found, (x, y), top);
        if sheet.common.is_none() {
            write_maximum(&page, map, found);
        }
        // A map with none below it carries the labels of its column.
        across.draw_below(&page, map, number + sheet.columns >= joint.found.len());
        up.draw_left(&page, map, number % sheet.columns == 0);
    }
    let marks: &[f64] = if sheet.common.is_some() {
        &[]
    } else {
        levels(look)
    };
    bar.draw(&page, all, marks);
    Some(page)
}
