//! Fields of passages over the state where they start (`field_exit_mean_time`, `field_exit_committor`): over two axes a
//! map at each chosen value and a sheet of all, with contours and the border of the target; over one axis curves with
//! the bands of their errors.

use super::spectrum::{Chart, Line};
use super::{Drawn, Kind, Sketch, Sweep};
use crate::continuation::{Point, StateField, SweepResult};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::contour::{GridValues, simplify};
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::heat::Picture;
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::look::{Look, on_heat};
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape};
use crate::figure::canvas::style::{Colour, INK, MARGIN, Stroke, TEXT};
use crate::figure::parts::joint_map::{with_letter, write_above};
use crate::figure::parts::view::{middles, resolution};
use crate::figure::parts::{caption, names, table};
use crate::figure::print::{Figure, Print};
use crate::system::{FieldKind, FieldQuestion};

/// Contours are drawn at these shares of the largest value, that of one half wider.
const LEVELS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
const HALF: f64 = 0.5;
/// Side of a map by itself and of one on a sheet, the narrowest one there, and the highest, in pixels.
const SIDE: f64 = 290.0;
const SMALL: f64 = 190.0;
const NARROWEST: f64 = 104.0;
const TALLEST: f64 = 290.0;
/// Gap between maps, and most of them beside each other.
const BETWEEN: f64 = 22.0;
const MOST_COLUMNS: usize = 3;
/// Squares along each axis on which the border of a target is followed.
const SQUARES: usize = 240;
/// What lies so near to the chord of a border, in pixels, is left out.
const ALIKE: f64 = 0.05;
/// The line of a border, black or white on a map.
fn border(colour: Colour) -> Stroke {
    Stroke::solid(colour, 1.6).dashed(&[5.0, 2.5])
}

/// Maps of each field at each chosen value, or one page of curves.
pub(super) const KIND: Kind = Kind {
    names: &["field"],
    is_usual: true,
    sketches,
};

fn sketches<'a>(sweep: &Sweep<'a>) -> Vec<Sketch<'a>> {
    let result = sweep.result;
    let mut all = Vec::new();
    for asked in sweep.family().fields() {
        let name = format!("field_{}", asked.name);
        if sweep.family().model().axes.len() == 1 {
            let chosen = sweep.chosen.clone();
            all.push(Sketch::new(name, move |print| {
                draw_curves(result, &chosen, asked, print)
            }));
            continue;
        }
        let chosen = sweep.chosen.clone();
        let sheet = move |print: &Print<'_>| match chosen.len() {
            0 | 1 => None,
            _ => draw_maps(result, &chosen, asked, print),
        };
        all.push(Sketch::new(name.as_str(), sheet));
        all.extend(sweep.chosen.iter().map(|&point| {
            let name = names::at_value(&name, point.value);
            Sketch::new(name, move |print| draw_maps(result, &[point], asked, print))
        }));
    }
    all
}

fn of_point<'a>(point: &'a Point, asked: &FieldQuestion) -> Option<&'a StateField> {
    let mut fields = point.report.fields.iter();
    fields.find(|field| field.name == asked.name)
}

/// What a field is, for titles.
fn title(asked: &FieldQuestion) -> &'static str {
    match asked.kind {
        FieldKind::MeanTime => "mean time",
        FieldKind::Committor => "committor",
    }
}

/// What a field is, for captions.
fn words(asked: &FieldQuestion) -> String {
    let [until, part] = [
        Some(&asked.until),
        asked.part.and_then(|part| asked.exits.get(part)),
    ]
    .map(|region| region.map_or("", |region| region.text()));
    match asked.kind {
        FieldKind::MeanTime => {
            format!("Mean time until {until}, over the state where a process starts")
        }
        FieldKind::Committor => format!(
            "Committor: probability to enter {part} before any other part of {until}, over the state where a process starts"
        ),
    }
}

fn draw_curves(
    result: &SweepResult,
    chosen: &[&Point],
    asked: &FieldQuestion,
    print: &Print<'_>,
) -> Drawn {
    let family = &result.subject.family;
    let line = |point: &&Point| {
        let field = of_point(point, asked)?;
        let known = field
            .values
            .iter()
            .copied()
            .zip(field.errors.iter().copied());
        let places = field.axes.first()?.centres().into_iter().zip(known);
        Some(Line {
            value: point.value,
            places: places.filter(|(_, known)| known.0.is_finite()).collect(),
        })
    };
    let lines: Vec<Line> = chosen.iter().filter_map(line).collect();
    let at = caption::at(family, lines.iter().map(|line| line.value));
    let chart = Chart {
        abscissa: names::axis(family, 0),
        is_logarithmic: false,
        ordinate: title(asked).to_owned(),
        is_over_decades: false,
        columns: [family.axis(0).to_owned(), title(asked).replace(' ', "_")],
        seen: format!("{}{at}, each with the band of its error.", words(asked)),
    };
    chart.draw(result, &lines, print)
}

/// A map of a field over two axes.
struct FieldMap<'a> {
    field: &'a StateField,
    places: [Vec<f64>; 2],
    ranges: [(f64, f64); 2],
    largest: f64,
}

impl<'a> FieldMap<'a> {
    fn new(field: &'a StateField) -> Option<Self> {
        let [x, y] = &field.axes[..] else {
            return None;
        };
        // Colours go from the centre of one cell to that of the next.
        if x.count().min(y.count()) < 2 {
            return None;
        }
        let finite = field.values.iter().filter(|value| value.is_finite());
        let largest = finite.fold(0.0, |most: f64, value| most.max(*value));
        (largest > 0.0).then_some(Self {
            field,
            places: [x.centres(), y.centres()],
            ranges: [(x.from(), x.to()), (y.from(), y.to())],
            largest,
        })
    }

    /// The colours of all pixels, between the centres of cells by straight lines.
    fn picture(&self, look: &Look, map: Rectangle, largest: f64) -> Picture {
        let size = (resolution(map.width), resolution(map.height));
        let [x, y] = &self.places;
        let across: Vec<(usize, f64)> = middles(self.ranges[0], size.0)
            .into_iter()
            .map(|at| beside(x, at))
            .collect();
        let up: Vec<(usize, f64)> = middles(self.ranges[1], size.1)
            .into_iter()
            .map(|at| beside(y, at))
            .collect();
        let value = |i: usize, j: usize| self.field.values[i * y.len() + j];
        Picture::new(look, size, |column, row| {
            let ((i, s), (j, t)) = (across[column], up[row]);
            let low = (1.0 - s) * value(i, j) + s * value(i + 1, j);
            let high = (1.0 - s) * value(i, j + 1) + s * value(i + 1, j + 1);
            Some(((1.0 - t) * low + t * high) / largest)
        })
    }

    fn draw_contours(&self, (look, panel): (&Look, &Panel), largest: f64) {
        let [x, y] = &self.places;
        let values = &self.field.values;
        let grid = GridValues { x, y, values };
        for share in LEVELS {
            let width = if share == HALF { 1.6 } else { 0.8 };
            let stroke = Stroke::solid(on_heat(look, share), width);
            for line in grid.contour(share * largest) {
                panel.draw(&line, Shape::Line(stroke));
            }
        }
    }
}

/// The borders of the parts of a target at a value of the parameter.
fn draw_borders(
    result: &SweepResult,
    (asked, value): (&FieldQuestion, f64),
    (look, panel): (&Look, &Panel),
    ranges: [(f64, f64); 2],
) -> Option<()> {
    let values = result.subject.family.values_at(value).ok()?;
    let [x, y] = ranges.map(|range| middles(range, SQUARES));
    let parts = asked
        .exits
        .iter()
        .chain(asked.exits.is_empty().then_some(&asked.until));
    for (number, region) in parts.enumerate() {
        let inside = f64::from(u8::from(asked.part == Some(number)));
        let stroke = border(on_heat(look, inside));
        let level = region.level().bind(&values).ok()?;
        let all = x.iter().flat_map(|&x| y.iter().map(move |&y| [x, y]));
        let levels: Vec<f64> = all.map(|state| level.at(&state)).collect();
        let grid = GridValues {
            x: &x,
            y: &y,
            values: &levels,
        };
        for line in grid.contour(0.0) {
            let line = simplify(&line, ALIKE, |&point| panel.place(point));
            panel.draw(&line, Shape::Line(stroke));
        }
    }
    Some(())
}

/// Maps of a field at several points, in as many columns as there is room for, with colours that all share.
fn draw_maps(
    result: &SweepResult,
    points: &[&Point],
    asked: &FieldQuestion,
    print: &Print<'_>,
) -> Drawn {
    let family = &result.subject.family;
    let known = points
        .iter()
        .filter_map(|point| Some((point.value, FieldMap::new(of_point(point, asked)?)?)));
    let known: Vec<(f64, FieldMap<'_>)> = known.collect();
    let share = print.share(known.len());
    let maps = &known[share.clone()];
    let largest = known
        .iter()
        .fold(0.0, |most: f64, (_, map)| most.max(map.largest));
    let [x, y] = maps.first()?.1.ranges;
    // Times and probabilities are read from zero on, whatever densities have.
    let look = &Look {
        is_logarithmic: false,
        ..print.look
    };
    let vertical = |high: f64| Scale::vertical(look, y, high, &names::axis(family, 1));
    let horizontal = |wide: f64| Scale::horizontal(look, x, wide, &names::axis(family, 0));
    let left = MARGIN + vertical(SIDE).left();
    let beside = left + ColourBar::new(look, largest, SIDE, title(asked)).width() + MARGIN;
    let own = if maps.len() == 1 { SIDE } else { SMALL };
    let wide = |columns: usize| {
        let gaps = (columns - 1) as f64 * BETWEEN;
        look.fill(own * columns as f64, beside + gaps) / columns as f64
    };
    let columns = Look::columns(maps.len().min(MOST_COLUMNS), |columns| {
        wide(columns) >= NARROWEST
    });
    let columns = Look::even_columns(maps.len(), columns);
    let side = (wide(columns), look.tall * wide(columns).min(TALLEST));
    let step = (side.0 + BETWEEN, side.1 + BETWEEN + 1.4 * TEXT);
    let rows = maps.len().div_ceil(columns);
    let whole = (
        (columns - 1) as f64 * step.0 + side.0,
        (rows - 1) as f64 * step.1 + side.1,
    );
    let (up, across) = (vertical(side.1), horizontal(side.0));
    let bar = ColourBar::new(look, largest, whole.1, title(asked));
    let width = left + whole.0 + bar.width() + MARGIN;
    let heading = Heading::new(look, print.title, width);
    let bordered = match asked.kind {
        FieldKind::MeanTime => "border of the target",
        FieldKind::Committor => "borders of the regions",
    };
    let entries = vec![(Swatch::Curve(border(INK)), bordered.to_owned())];
    let legend = Legend::new(look, entries, width - 2.0 * MARGIN);
    let all = Rectangle::new((left, heading.height() + ColourBar::above()), whole);
    let below = all.bottom() + Scale::below();
    let page = Page::new(look, width, below + legend.height() + MARGIN);
    heading.draw(&page);
    let first = Rectangle::new((all.left, all.top), side);
    for (number, (value, map)) in maps.iter().enumerate() {
        let place = first.tile(number, columns, step);
        let line = names::at(family, *value);
        let line = match known.len() {
            1 => line,
            _ => with_letter(look, share.start + number, line),
        };
        write_above(&page, place, line);
        let panel = page.panel(place, x, y);
        let picture = map.picture(look, place, largest);
        panel.draw(&[(x.0, y.0), (x.1, y.1)], Shape::Image(picture));
        map.draw_contours((look, &panel), largest);
        draw_borders(result, (asked, *value), (look, &panel), map.ranges);
        frame::border(&page, place);
        across.draw_below(&page, place, number + columns >= maps.len());
        up.draw_left(&page, place, number % columns == 0);
    }
    bar.draw(&page, all, &LEVELS);
    legend.draw(&page, left + 0.5 * whole.0, below);
    let errors = maps.iter().flat_map(|(_, map)| &map.field.errors);
    let seen = format!(
        "{}{}, with contours at 10, 30, 50 (wide), 70 and 90 % of the largest value; errors are {} at most.",
        words(asked),
        caption::at(family, maps.iter().map(|(value, _)| *value)),
        caption::number(errors.fold(0.0, |most: f64, error| most.max(*error))),
    );
    let caption = caption::of_sweep(result, seen, &[]);
    Some(Figure::new(&page, caption, table_of(result, maps)).of_panels(known.len()))
}

/// The cell below a place among centres, and how far the place is on the way to the next.
fn beside(centres: &[f64], place: f64) -> (usize, f64) {
    let above = centres.partition_point(|&centre| centre <= place);
    let below = above.saturating_sub(1).min(centres.len().saturating_sub(2));
    let (a, b) = (centres[below], centres[below + 1]);
    (below, ((place - a) / (b - a)).clamp(0.0, 1.0))
}

fn table_of(result: &SweepResult, maps: &[(f64, FieldMap<'_>)]) -> String {
    let family = &result.subject.family;
    let rows = maps.iter().flat_map(|(value, map)| {
        let [x, y] = &map.places;
        let numbers = map.field.values.iter().zip(&map.field.errors).enumerate();
        numbers.map(|(cell, (field, error))| {
            let (i, j) = (cell / y.len(), cell % y.len());
            [*value, x[i], y[j], *field, *error]
                .map(table::number)
                .to_vec()
        })
    });
    let axes = (family.axis(0), family.axis(1));
    let columns = [family.parameter(), axes.0, axes.1, "value", "error"];
    table::table(&columns, rows)
}
