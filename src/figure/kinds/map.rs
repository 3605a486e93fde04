//! A map of regimes: regions of one signature in pale colours with their words, and the curves between them with their
//! bands.

use plotters_backend::text_anchor::HPos;

use super::Sketch;
use super::curve::{entries, stroke_of};
use crate::continuation::curve::{Curve, EndReason, SweepInPlane};
use crate::continuation::map::{RegimeMap, RegionPicture, RegionSample};
use crate::density::Observable;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::heat::Picture;
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::letters;
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape, small};
use crate::figure::canvas::style::{BLANK, Colour, INK, MARGIN, PAPER, Stroke, TICK_TEXT};
use crate::figure::canvas::symbols;
use crate::figure::parts::caption;
use crate::figure::parts::crossed::Crossed;
use crate::figure::parts::curve_line::draw_points;
use crate::figure::parts::inset;
use crate::figure::parts::level_lines::LevelLines;
use crate::figure::parts::names::{self, symbol_of};
use crate::figure::parts::region_room::{Room, parted_by};
use crate::figure::parts::stability::Stability;
use crate::figure::print::{Figure, Print};
use crate::system::Family;
use crate::topology::Signature;

/// Size of the panel on a page of its own width, in pixels, and that width.
const PANEL: (f64, f64) = (390.0, 300.0);
const USUAL: f64 = 480.0;
/// Room right of the panel, for half a label.
const BESIDE: f64 = 14.0;
/// Pixels of the picture of the regions to a figure pixel.
const FINE: f64 = 2.0;
/// How much of a curve's colour is in the ground of a region.
const TINT: f64 = 0.26;
/// Between the words of a region and its density, in pixels.
const GAP: f64 = 3.0;
/// Half the length of the `+` on a node whose cells are too wide to count by, in pixels.
const PLUS: f64 = 2.0;
/// Radius of the dots where curves end inside the box, in pixels.
const DOT: f64 = 3.0;

/// One figure an observable.
pub(in crate::figure) fn sketches<'a>(
    map: &'a RegimeMap,
    sweeps: &'a [SweepInPlane],
) -> Vec<Sketch<'a>> {
    let family = &map.subject.family;
    let observables = map.subject.observables.iter().enumerate();
    let sketch = |(index, observable): (usize, &'a Observable)| {
        let draw = move |print: &Print<'_>| {
            let curves = map.curves.iter();
            let scene = Scene {
                map,
                index,
                curves: curves
                    .filter(|curve| curve.observable == *observable)
                    .collect(),
                crossed: Crossed {
                    plane: &map.plane,
                    family,
                    sweeps,
                    observables: std::slice::from_ref(observable),
                },
                stability: Stability::new(
                    family,
                    &map.plane,
                    observable.axes().len() == family.model().axes.len(),
                ),
                levels: LevelLines {
                    plane: &map.plane,
                    curves: &map.levels,
                    family,
                    observables: &map.subject.observables,
                },
                family,
                look: &print.look,
            };
            let (page, words) = scene.draw(print.title);
            Some(Figure::new(
                &page,
                scene.caption(&words, &print.solved_by),
                scene.data(),
            ))
        };
        Sketch::new(format!("map_{}", names::file(family, *observable)), draw)
    };
    observables.map(sketch).collect()
}

struct Scene<'a> {
    map: &'a RegimeMap,
    /// The observable among those that are watched.
    index: usize,
    curves: Vec<&'a Curve>,
    crossed: Crossed<'a>,
    stability: Stability,
    levels: LevelLines<'a>,
    family: &'a Family,
    look: &'a Look,
}

/// The regions as they are drawn: their picture, and the number of the colour of each.
struct Ground {
    picture: RegionPicture,
    /// The different signatures, those of larger regions first.
    kinds: Vec<Option<Signature>>,
}

impl Ground {
    fn kind_of(&self, region: usize) -> usize {
        let signature = self.picture.regions[region].signature;
        let mut kinds = self.kinds.iter();
        kinds.position(|one| *one == signature).unwrap_or(0)
    }
}

/// The line of the mark of a node.
fn node_stroke() -> Stroke {
    Stroke::solid(INK, 0.8)
}

fn words(signature: Option<Signature>) -> String {
    signature.map_or_else(
        || "no steady state, or not converged".to_owned(),
        |one| one.to_string(),
    )
}

impl Scene<'_> {
    fn draw(&self, title: &str) -> (Page, Vec<String>) {
        let look = self.look;
        let [first, second] = self.map.plane.sides();
        let (x, y) = ((first.from, first.to), (second.from, second.to));
        let high = look.height(PANEL.1, USUAL);
        let up = Scale::vertical(look, y, high, &symbol_of(self.family, &second.parameter));
        let left = MARGIN + up.left();
        let wide = look.fill(PANEL.0, left + BESIDE + MARGIN);
        let width = left + wide + BESIDE + MARGIN;
        let across = Scale::horizontal(look, x, wide, &symbol_of(self.family, &first.parameter));
        let heading = Heading::new(look, title, width);
        let rect = Rectangle::new((left, heading.height() + 6.0), (wide, high));
        let ground = self.ground(rect);
        let places = match &ground {
            Some(ground) => self.word_places(ground, rect),
            None => Vec::new(),
        };
        let legend = self.legend(ground.as_ref(), &places, rect);
        let below = rect.bottom() + Scale::below();
        let page = Page::new(look, width, below + legend.height() + MARGIN);
        heading.draw(&page);
        let panel = page.panel(rect, x, y);
        if let Some(ground) = &ground {
            let picture = self.picture(ground);
            panel.draw(&[(x.0, y.1), (x.1, y.0)], Shape::Image(picture));
        }
        for curve in &self.curves {
            let stroke = stroke_of(self.curves.iter().copied(), curve.kind);
            draw_points(&panel, (&curve.plane, &curve.points), stroke);
        }
        self.stability.draw(&panel);
        self.levels.draw(&panel);
        self.crossed.draw(&panel);
        self.draw_ends(&page, &panel);
        for node in self.map.nodes.iter().filter(|node| node.has_wide_cells()) {
            let [x, y] = node.values;
            panel.draw(&[(x, y)], Shape::Plus(PLUS, node_stroke()));
        }
        frame::around(&page, rect, (&across, &up));
        for placed in &places {
            placed.draw(&page, look);
        }
        legend.draw(&page, left + 0.5 * wide, below);
        let kinds = ground.map(|ground| ground.kinds).unwrap_or_default();
        (page, kinds.into_iter().map(words).collect())
    }

    fn ground(&self, rect: Rectangle) -> Option<Ground> {
        let size = [rect.width, rect.height].map(|length| (FINE * length).round() as usize);
        let picture = self.map.regions(self.index, size)?;
        let mut kinds: Vec<Option<Signature>> = Vec::new();
        for region in &picture.regions {
            if !kinds.contains(&region.signature) {
                kinds.push(region.signature);
            }
        }
        Some(Ground { picture, kinds })
    }

    /// The colour of a region's ground.
    fn tint(&self, ground: &Ground, kind: usize) -> (u8, u8, u8) {
        if ground.kinds.get(kind).copied().flatten().is_none() {
            return self.look.resolve(BLANK).0;
        }
        self.look.tint(TINT, kind)
    }

    fn picture(&self, ground: &Ground) -> Picture {
        let colours: Vec<(u8, u8, u8)> = (0..ground.kinds.len())
            .map(|kind| self.tint(ground, kind))
            .collect();
        let [width, height] = ground.picture.size;
        Picture::patches((width, height), &colours, |column, row| {
            ground.kind_of(ground.picture.pixels[row * width + column])
        })
    }

    /// Where each region's words stand, on the page, with the words; `None` where they have no room.
    fn word_places(&self, ground: &Ground, rect: Rectangle) -> Vec<RegionText<'_>> {
        let lines = self.levels.lines().chain(self.stability.lines());
        let shares = |line: Vec<[f64; 2]>| line.into_iter().map(|one| self.map.plane.shares(one));
        let lines: Vec<Vec<[f64; 2]>> = lines.map(|line| shares(line).collect()).collect();
        let parted = parted_by(&ground.picture, &lines);
        let room = Room::new(&parted);
        let mut places: Vec<RegionText<'_>> = Vec::new();
        for (number, region) in ground.picture.regions.iter().enumerate() {
            let text = words(region.signature);
            let wide = letters::text_width(self.look, &symbols::plain(&text), TICK_TEXT, false);
            let half = [0.5 * wide + 6.0, 0.5 * TICK_TEXT + 5.0];
            let (across, high) = inset::SIZE;
            let both = [
                half[0].max(0.5 * across + 6.0),
                half[1] + 0.5 * (high + GAP),
            ];
            let find = |half: [f64; 2]| room.best(number, half.map(|length| FINE * length));
            let with = self
                .sample(ground, number)
                .and_then(|sample| Some((find(both)?, Some(sample))));
            let best = with.or_else(|| Some((find(half)?, None)));
            places.extend(best.map(|([column, row], sample)| RegionText {
                at: (
                    rect.left + (column as f64 + 0.5) / FINE,
                    rect.bottom() - (row as f64 + 0.5) / FINE,
                ),
                words: text,
                sample,
            }));
        }
        places
    }

    /// A density in a region of the picture.
    fn sample(&self, ground: &Ground, region: usize) -> Option<&RegionSample> {
        let [width, height] = ground.picture.size;
        let mut samples = self.map.samples.iter();
        samples.find(|sample| {
            let place = self.map.plane.shares(sample.values);
            let [column, row] = [(place[0], width), (place[1], height)]
                .map(|(share, count)| ((share * count as f64) as usize).min(count - 1));
            sample.observable == self.index && ground.picture.pixels[row * width + column] == region
        })
    }

    fn legend(
        &self,
        ground: Option<&Ground>,
        places: &[RegionText<'_>],
        rect: Rectangle,
    ) -> Legend {
        let mut entries = entries(self.curves.iter().copied(), self.family, rect);
        entries.extend(self.stability.entries());
        entries.extend(self.levels.entries());
        entries.extend(self.crossed.entries());
        if self.map.nodes_with_wide_cells() > 0 {
            let swatch = Swatch::Cross(PLUS, node_stroke());
            entries.push((swatch, "cells too wide to count by".to_owned()));
        }
        if let Some(ground) = ground {
            for (kind, signature) in ground.kinds.iter().enumerate() {
                let text = words(*signature);
                if places.iter().all(|placed| placed.words != text) {
                    let colour = Colour::fixed(self.tint(ground, kind));
                    entries.push((Swatch::Box(colour), symbols::plain(&text)));
                }
            }
        }
        Legend::new(self.look, entries, rect.right() - MARGIN)
    }

    /// Where curves end inside the box, and the labels of points of codimension two.
    fn draw_ends(&self, page: &Page, panel: &Panel) {
        for curve in &self.curves {
            let inside = curve
                .ends
                .iter()
                .filter(|end| !matches!(end.reason, EndReason::Border(_) | EndReason::Closed));
            for point in inside.filter_map(|end| curve.points.get(end.point)) {
                let at = (point.values[0], point.values[1]);
                let rim = Stroke::solid(INK, 1.2);
                panel.draw(&[at], Shape::Dot(DOT, PAPER, rim));
            }
        }
        let points = self.map.codimension_two().into_iter();
        let watched = self.map.subject.observables[self.index];
        for point in points.filter(|point| point.observables == [watched]) {
            let (x, y) = panel.place((point.values[0], point.values[1]));
            let text = small(symbols::plain(&point.label), HPos::Left, INK);
            page.text((x + 2.5 * DOT, y + 2.5 * DOT), text);
        }
    }

    fn caption(&self, words: &[String], solved_by: &str) -> String {
        let [first, second] = self.map.plane.sides();
        let mut text = format!(
            "Regimes of the steady-state density {} in the plane of {} and {}: {}.",
            caption::density(self.family, self.map.subject.observables[self.index]),
            caption::parameter_named(self.family, &first.parameter),
            caption::parameter_named(self.family, &second.parameter),
            words.join(", "),
        );
        for curve in &self.curves {
            let ends = curve.ends.iter();
            let ends = ends.map(|end| caption::end(self.family, &end.reason, &curve.plane));
            let mut ends: Vec<String> = ends.collect();
            ends.dedup();
            text += &format!(
                " On a line the {} is zero ({} points; it ends at: {}).",
                curve.kind.name(),
                curve.points.len(),
                ends.join(", "),
            );
        }
        match self.map.nodes_with_wide_cells() {
            0 => {}
            wide => {
                text += &format!(
                    " At the {wide} of {} nodes that are marked `+` the cells are too wide to count by.",
                    self.map.nodes.len()
                );
            }
        }
        text += &self.stability.caption();
        text += &self.levels.caption();
        text += &self.crossed.caption();
        if self.map.interrupted {
            text += " The map was interrupted before it was complete.";
        }
        format!(
            "{text} {}\n",
            caption::of_plane(self.family, &second.parameter, solved_by)
        )
    }

    /// The curves, and the words of the regions.
    fn data(&self) -> String {
        let [first, second] = self.map.plane.sides();
        let mut text = format!("kind,{},{},words\n", first.parameter, second.parameter);
        for (number, curve) in self.curves.iter().enumerate() {
            for point in &curve.points {
                let [x, y] = point.values;
                text += &format!("curve {},{x},{y},{}\n", number + 1, curve.kind.name());
            }
        }
        for (curve, [x, y]) in self.stability.data() {
            text += &format!("curve {},{x},{y},{}\n", curve.name, curve.kind.name());
        }
        for (name, curve, point) in self.levels.data() {
            let [x, y] = point.values;
            text += &format!("curve {name},{x},{y},{}\n", curve.words());
        }
        for node in &self.map.nodes {
            let [x, y] = node.values;
            let signature = node.signatures.get(self.index).copied();
            let kind = match node.has_wide_cells() {
                true => "node with wide cells",
                false => "node",
            };
            text += &format!("{kind},{x},{y},{}\n", words(signature));
        }
        for (row, to_edge, status) in self.crossed.data() {
            let ([x, y], error) = (row.values, to_edge[0] + to_edge[1]);
            text += &format!("row {},{x},{y},{status} to {error:e}\n", row.label);
        }
        text
    }
}

/// Words in a region, with the density of one of its states where there is room.
struct RegionText<'m> {
    /// The middle of both, on the page.
    at: (f64, f64),
    words: String,
    sample: Option<&'m RegionSample>,
}

impl RegionText<'_> {
    /// The words above, the density below, both together in the middle.
    fn draw(&self, page: &Page, look: &Look) {
        let (x, y) = self.at;
        let text = small(symbols::plain(&self.words), HPos::Center, INK);
        let Some(sample) = self.sample else {
            page.text((x, y), text);
            return;
        };
        let (width, height) = inset::SIZE;
        let top = y - 0.5 * (height + TICK_TEXT + GAP);
        page.text((x, top + 0.5 * TICK_TEXT), text);
        let rect = Rectangle::new((x - 0.5 * width, top + TICK_TEXT + GAP), (width, height));
        inset::draw(page, look, rect, &sample.density)
    }
}
