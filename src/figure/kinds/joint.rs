//! Joint densities of two axes as heat maps with contours: one figure a parameter value, a sheet of all, and small
//! multiples of the whole sweep.

use super::{Kind, Sketch, Sweep};
use crate::continuation::{Point, SweepResult, evenly_spaced};
use crate::figure::canvas::colour_bar::ColourBar;
use crate::figure::canvas::frame::Scale;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::Page;
use crate::figure::canvas::style::MARGIN;
use crate::figure::parts::joint_map::{Joint, draw_map, levels, open_page, write_above};
use crate::figure::parts::{caption, joint_sheet, names, table, view};
use crate::figure::print::{Figure, Print};

/// What a map is, for captions.
const WAY: &str = "as a map with contours at LEVELS of its maximum";
/// What stands for the levels of contours there, which depend on the colours.
const CONTOURS: &str = "LEVELS";
/// Small multiples of a sweep: one to so many values of the parameter.
const MULTIPLES: usize = 12;
/// Side of the map of a single figure, in pixels.
const SINGLE: f64 = 290.0;
/// Highest map of a single figure.
const TALLEST: f64 = 420.0;

pub(super) const KIND: Kind = Kind {
    names: &["joint", "multiples"],
    usual: Some("joint_sheets"),
    sketches,
};

/// A sheet an observed pair of axes, small multiples, then the maps of the sheet one by one.
fn sketches<'a>(sweep: &Sweep<'a>) -> Vec<Sketch<'a>> {
    let mut sketches = Vec::new();
    for (number, pair) in sweep.pairs() {
        let (name, way) = (format!("joint_{pair}"), (number, WAY));
        let several = several(sweep.result, number);
        sketches.push(sweep.joint(&name, way, &sweep.chosen, joint_sheet::draw));
        sketches.push(sweep.joint(
            format!("multiples_{pair}"),
            way,
            &several,
            joint_sheet::draw,
        ));
        sketches.extend(sweep.each_joint(&name, way, draw_single));
    }
    sketches
}

/// Draws a page of joint densities.
pub(super) type DrawJoint = fn(&Joint<'_>, &Print<'_>) -> Option<Page>;

impl<'a> Sweep<'a> {
    /// A figure of a joint density, by its number, at some points, in the way that the words of its caption say.
    pub(super) fn joint(
        &self,
        name: impl Into<String>,
        (number, way): (usize, &'static str),
        points: &[&'a Point],
        draw: DrawJoint,
    ) -> Sketch<'a> {
        let (result, points) = (self.result, points.to_vec());
        Sketch::new(name, move |print| {
            let joint = Joint::new(result, number, &points)?.on_page(print);
            let page = draw(&joint, print)?;
            Some(figure((&joint, &print.look), way, &page).of_panels(joint.count()))
        })
    }

    /// The same at every chosen point by itself, named after its value.
    pub(super) fn each_joint(
        &self,
        name: &str,
        way: (usize, &'static str),
        draw: DrawJoint,
    ) -> Vec<Sketch<'a>> {
        let points = self.chosen.iter();
        let single = |point: &&'a Point| {
            let name = names::at_value(name, self.family(), point.value);
            self.joint(name, way, &[point], draw).of_one_value()
        };
        points.map(single).collect()
    }
}

/// A page that shows joint densities, in the way that the words say.
pub(super) fn figure((joint, look): (&Joint<'_>, &Look), way: &str, page: &Page) -> Figure {
    let (result, points) = (joint.result, &joint.points[joint.shown.clone()]);
    let way = way.replace(CONTOURS, caption::contours(look));
    let (family, watched) = (
        &result.subject.family,
        result.subject.observables[joint.number],
    );
    let seen = format!(
        "Steady-state joint density {}{}, {way}.",
        caption::density(family, watched),
        caption::at(family, points.iter().map(|point| point.value))
    );
    let between = caption::between_cells(result, |one| one == watched);
    let is_map = way.contains("map");
    let marks = is_map.then(|| {
        let floor = caption::floor(look);
        format!("Marked are peaks (+) and craters (o).{floor}")
    });
    let marked = [between, marks.unwrap_or_default()];
    let table = table::of_joint(result, joint.number, points);
    Figure::new(page, caption::of_sweep(result, seen, &marked), table)
}

/// Points spread evenly over a sweep that have a density of an observable, for small multiples.
fn several(result: &SweepResult, observable: usize) -> Vec<&Point> {
    let ends = [result.points.first(), result.points.last()];
    let [Some(first), Some(last)] = ends.map(|end| end.map(|point| point.value)) else {
        return Vec::new();
    };
    let wanted = evenly_spaced((first, last), MULTIPLES);
    let points = view::nearest(result, &wanted).into_iter();
    points
        .filter(|point| view::density(point, observable).is_some())
        .collect()
}

/// One map at one point: a square in every style, in the middle of a page that is wider.
fn draw_single(joint: &Joint<'_>, print: &Print<'_>) -> Option<Page> {
    let (look, found, (x, y)) = (&print.look, &joint.found[0], joint.window);
    let [first, second, density] = &joint.titles;
    let largest = found.shown.largest;
    let own = |page: f64| (0.68 * page).clamp(170.0, TALLEST);
    let high = look.tall * look.page.map_or(SINGLE, own);
    let beside = |side: f64| {
        let up = Scale::vertical(look, y, side, second);
        (up, ColourBar::new(look, largest, side, density))
    };
    // What stands beside the map hardly depends on its height: a first round measures it.
    let (up, bar) = beside(high);
    let side = high.min(look.fill(high, MARGIN + up.left() + bar.width() + MARGIN));
    let (up, bar) = beside(side);
    let across = Scale::horizontal(look, x, side, first);
    let left = MARGIN + up.left();
    let own = left + side + bar.width() + MARGIN;
    let width = look.page.unwrap_or(own);
    let left = left + 0.5 * (width - own).max(0.0);
    let (page, map) = open_page(print, &joint.found, (left, width), (side, side));
    write_above(&page, map, joint.at(found));
    draw_map(&page, map, found, (x, y), largest);
    across.draw_below(&page, map, true);
    up.draw_left(&page, map, true);
    bar.draw(&page, map, levels(look));
    Some(page)
}
