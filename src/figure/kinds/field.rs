//! Fields of passages over the state (`field_exit_mean_time`, `field_exit_committor`, `field_exit_reactive_density`).
//! Over two axes a map at each chosen value and a sheet of all, with contours and the border of the target; over one
//! axis curves with the bands of their errors. The components of a current are one map, with the lines along it.

use super::spectrum::{Chart, Line};
use super::{Drawn, Kind, Sketch, Sweep};
use crate::continuation::{Point, StateField, SweepResult};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::contour::{GridValues, simplify};
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::look::{Look, on_heat};
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape};
use crate::figure::canvas::style::{Colour, INK, MARGIN, Stroke, TEXT};
use crate::figure::parts::field_map::{ALIKE, FieldMap, LEVELS, where_seen, whole};
use crate::figure::parts::joint_map::{with_letter, write_above};
use crate::figure::parts::view::middles;
use crate::figure::parts::{caption, names, table};
use crate::figure::print::{Figure, Print};
use crate::system::{Family, FieldKind, FieldQuestion, Region};

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
/// The line of a border, black or white on a map.
fn border(colour: Colour) -> Stroke {
    Stroke::solid(colour, 1.6).dashed(&[5.0, 2.5])
}

/// Maps of each field at each chosen value, or one page of curves.
pub(super) const KIND: Kind = Kind {
    names: &["field"],
    usual: Some("field"),
    sketches,
};

fn sketches<'a>(sweep: &Sweep<'a>) -> Vec<Sketch<'a>> {
    let result = sweep.result;
    let mut all = Vec::new();
    let is_map = sweep.family().model().axes.len() == 2;
    // A map has all components of a current.
    let is_own = |asked: &&FieldQuestion| !is_map || asked.axis.is_none_or(|axis| axis == 0);
    for asked in sweep.family().fields().filter(is_own) {
        let name = match is_map && asked.axis.is_some() {
            true => format!("field_{}", together(sweep.family(), asked)),
            false => format!("field_{}", asked.name),
        };
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
            let name = names::at_value(&name, sweep.family(), point.value);
            Sketch::new(name, move |print| draw_maps(result, &[point], asked, print))
        }));
    }
    all
}

/// What the components of a current are called together.
fn together(family: &Family, asked: &FieldQuestion) -> String {
    let axis = asked.axis.map_or("", |axis| family.axis(axis));
    let name = asked.name.strip_suffix(axis).unwrap_or(&asked.name);
    name.trim_end_matches('_').to_owned()
}

fn of_point<'a>(point: &'a Point, asked: &FieldQuestion) -> Option<&'a StateField> {
    let mut fields = point.report.fields.iter();
    fields.find(|field| field.name == asked.name)
}

/// A field of a point, or all components of a current.
fn all_of_point<'a>(
    (family, point): (&Family, &'a Point),
    asked: &FieldQuestion,
) -> Vec<&'a StateField> {
    let is_together = |other: &&FieldQuestion| match asked.axis {
        Some(_) => other.axis.is_some() && together(family, other) == together(family, asked),
        None => other.name == asked.name,
    };
    let all = family.fields().filter(is_together);
    all.filter_map(|one| of_point(point, one)).collect()
}

/// What a field is, for titles.
fn title(asked: &FieldQuestion) -> &'static str {
    match asked.kind {
        FieldKind::MeanTime => "mean time",
        FieldKind::Committor => "committor",
        FieldKind::ReactiveDensity => "reactive density",
        FieldKind::ReactiveCurrent => "reactive current",
    }
}

/// The inequalities of a region, for captions.
fn in_symbols(family: &Family, region: &Region) -> String {
    caption::in_symbols(family.model(), region.text())
}

/// What a field is, for captions.
fn words(family: &Family, asked: &FieldQuestion) -> String {
    let [until, part] = [
        Some(&asked.until),
        asked.part.and_then(|part| asked.exits.get(part)),
    ]
    .map(|region| region.map_or_else(String::new, |region| in_symbols(family, region)));
    match asked.kind {
        FieldKind::MeanTime => {
            format!("Mean time until {until}, over the state where a process starts")
        }
        FieldKind::Committor => format!(
            "Committor: probability to enter {part} before any other part of {until}, over the state where a process starts"
        ),
        FieldKind::ReactiveDensity => format!("Density of being on the way {}", way(family, asked)),
        FieldKind::ReactiveCurrent => {
            let axis = asked.axis.map_or("", |axis| family.axis_symbol(axis));
            let axis = caption::in_letters(axis);
            match family.model().axes.len() {
                1 => format!(
                    "Current along {axis} of processes on their way {}",
                    way(family, asked)
                ),
                _ => format!("Current of processes on their way {}", way(family, asked)),
            }
        }
    }
}

/// Between which regions transitions are.
fn way(family: &Family, asked: &FieldQuestion) -> String {
    match &asked.exits[..] {
        [from, to] => {
            let [from, to] = [from, to].map(|region| in_symbols(family, region));
            format!("from {from} to {to}")
        }
        _ => String::new(),
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
        seen: format!(
            "{}{at}, each with the band of its error.",
            words(family, asked)
        ),
    };
    chart.draw(result, &lines, print)
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
    let fields: Vec<(f64, Vec<&StateField>)> = points
        .iter()
        .map(|point| (point.value, all_of_point((family, point), asked)))
        .collect();
    let extent = match asked.kind.is_reactive() {
        true => where_seen(fields.iter().map(|(_, fields)| &fields[..])),
        false => fields.iter().find_map(|(_, fields)| whole(fields)),
    }?;
    let target = |value: f64| {
        let may_jump = !asked.kind.is_reactive() && asked.until.basin().is_none();
        let values = may_jump.then(|| family.values_at(value).ok()).flatten()?;
        asked.until.level().bind(&values).ok()
    };
    let known = fields.iter().filter_map(|(value, fields)| {
        let map = FieldMap::new(fields, extent)?;
        let map = match target(*value) {
            Some(level) => map.around(move |(x, y)| level.at(&[x, y]) < 0.0),
            None => map,
        };
        Some((*value, map))
    });
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
        _ => "borders of the regions",
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
        map.draw_lines((&page, &panel), largest);
        draw_borders(result, (asked, *value), (look, &panel), map.ranges);
        frame::border(&page, place);
        across.draw_below(&page, place, number + columns >= maps.len());
        up.draw_left(&page, place, number % columns == 0);
    }
    let is_current = asked.kind == FieldKind::ReactiveCurrent;
    bar.draw(&page, all, if is_current { &[] } else { &LEVELS });
    legend.draw(&page, left + 0.5 * whole.0, below);
    let shown = match is_current {
        true => {
            ", with lines along it; colours have its size, with each component over what is shown of its axis".to_owned()
        }
        false => {
            let errors = maps.iter().flat_map(|(_, map)| map.fields);
            let errors = errors.flat_map(|field| &field.errors);
            let most = errors.fold(0.0, |most: f64, error| most.max(*error));
            format!(
                ", with contours at 10, 30, 50 (wide), 70 and 90 % of the largest value; errors are {} at most",
                caption::number(most)
            )
        }
    };
    let at = caption::at(family, maps.iter().map(|(value, _)| *value));
    let seen = format!("{}{at}{shown}.", words(family, asked));
    let caption = caption::of_sweep(result, seen, &[]);
    Some(Figure::new(&page, caption, table_of(result, maps)).of_panels(known.len()))
}

fn table_of(result: &SweepResult, maps: &[(f64, FieldMap<'_>)]) -> String {
    let family = &result.subject.family;
    let rows = maps.iter().flat_map(|(value, map)| {
        let [x, y] = [0, 1].map(|axis| map.fields[0].axes[axis].centres());
        let cells = 0..x.len() * y.len();
        cells.map(move |cell| {
            let (i, j) = (cell / y.len(), cell % y.len());
            let numbers = map
                .fields
                .iter()
                .flat_map(|field| [field.values[cell], field.errors[cell]]);
            let row = [*value, x[i], y[j]].into_iter().chain(numbers);
            row.map(table::number).collect()
        })
    });
    let axes = [family.axis(0), family.axis(1)];
    let columns = match maps.first().map(|(_, map)| map.fields.len()) {
        Some(2) => axes
            .iter()
            .flat_map(|axis| [format!("current_{axis}"), format!("error_{axis}")])
            .collect(),
        _ => vec!["value".to_owned(), "error".to_owned()],
    };
    let first = [family.parameter(), axes[0], axes[1]];
    let columns: Vec<&str> = first
        .into_iter()
        .chain(columns.iter().map(String::as_str))
        .collect();
    table::table(&columns, rows)
}
