//! The homological picture of a density: of the set where it exceeds a level, the number of pieces and of holes (its
//! Betti numbers), over the parameter and the level. Peaks are where pieces appear as the level falls, saddles where
//! they merge, bottoms of craters where holes close; a P-bifurcation is a change at some level.

use crate::continuation::Point;
use crate::topology::{Feature, FeatureKind, Verdict};

use super::diagram::{column_edges, hatch_column};
use super::{Drawn, Kind};
use crate::continuation::SweepResult;
use crate::figure::canvas::frame::{self, Scale};
use crate::figure::canvas::heat::{self, Picture};
use crate::figure::canvas::legend::{Legend, Swatch};
use crate::figure::canvas::look::Look;
use crate::figure::canvas::page::{Heading, Page, Panel, Rectangle, Shape};
use crate::figure::canvas::style::{Colour, MARGIN, PNG_SCALE};
use crate::figure::parts::along::parameter_range;
use crate::figure::parts::bifurcations::Labels;
use crate::figure::parts::caption;
use crate::figure::parts::names;
use crate::figure::parts::table::{self, number as number_of};
use crate::figure::print::{Figure, Print};

/// Size of the map on a page of its own width, in pixels, and that width.
const MAP: (f64, f64) = (390.0, 220.0);
const USUAL: f64 = 480.0;
/// Room right of the map, for half a label.
const BESIDE: f64 = 14.0;
/// How much of a curve's colour is in an area.
const TINT: f64 = 0.42;
/// Levels nearer to each other are one.
const SAME: f64 = 1e-9;

/// Levels between which the numbers do not change, as shares of the highest peak.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slab {
    from: f64,
    to: f64,
    /// Pieces of the set above a level between both: its Betti number β₀.
    pieces: usize,
    /// Holes in it: β₁.
    holes: usize,
}

/// A picture an observed density.
pub(super) const KIND: Kind = Kind {
    names: &["homology"],
    usual: None,
    sketches: |sweep| sweep.of_observables("homology", draw),
};

/// What was found in an observable's density at a point.
fn features(point: &Point, observable: usize) -> &[Feature] {
    let detection = point.detections.get(observable);
    detection.map_or(&[], |detection| &detection.features)
}

/// The levels of a density from zero to its highest peak, from the features that are there; empty without any.
fn slabs(features: &[Feature]) -> Vec<Slab> {
    let there = |kinds: &'static [FeatureKind]| {
        let features = features.iter();
        features.filter(move |one| one.verdict == Verdict::Present && kinds.contains(&one.kind))
    };
    let summits = || there(&[FeatureKind::Peak, FeatureKind::Ring]);
    let top = summits().map(|one| one.density).fold(0.0, f64::max);
    if !(top > 0.0 && top.is_finite()) {
        return Vec::new();
    }
    // The highest piece is there from the bottom on: what it stands on is the ground of rounding.
    let highest = summits().max_by(|a, b| a.persistence.total_cmp(&b.persistence));
    let piece = |one: &Feature| {
        let lasts = highest.is_some_and(|highest| std::ptr::eq(highest, one));
        let foot = if lasts {
            0.0
        } else {
            one.density - one.persistence
        };
        (foot / top, one.density / top)
    };
    let hole = |one: &Feature| (one.density / top, (one.density + one.persistence) / top);
    let pieces: Vec<(f64, f64)> = summits().map(piece).collect();
    let holes: Vec<(f64, f64)> = there(&[FeatureKind::Crater]).map(hole).collect();
    let ends = pieces
        .iter()
        .chain(&holes)
        .flat_map(|&(from, to)| [from, to]);
    let mut levels: Vec<f64> = ends
        .chain([0.0, 1.0])
        .map(|level| level.clamp(0.0, 1.0))
        .collect();
    levels.sort_by(f64::total_cmp);
    // Symmetric peaks are as high as each other up to rounding.
    levels.dedup_by(|level, before| *level - *before < SAME);
    if let Some(last) = levels.last_mut() {
        *last = 1.0;
    }
    let count = |all: &[(f64, f64)], level: f64| {
        let holds = |&&(from, to): &&(f64, f64)| from < level && level <= to;
        all.iter().filter(holds).count()
    };
    let slab = |pair: &[f64]| {
        let middle = 0.5 * (pair[0] + pair[1]);
        Slab {
            from: pair[0],
            to: pair[1],
            pieces: count(&pieces, middle),
            holes: count(&holes, middle),
        }
    };
    levels.windows(2).map(slab).collect()
}

/// `2 pieces, 1 hole`.
fn words((pieces, holes): (usize, usize)) -> String {
    let counted = |count: usize, word: &str| match count {
        1 => format!("1 {word}"),
        count => format!("{count} {word}s"),
    };
    match holes {
        0 => counted(pieces, "piece"),
        holes => format!("{}, {}", counted(pieces, "piece"), counted(holes, "hole")),
    }
}

/// The numbers of pieces and of holes that occur, with their colours.
struct Kinds {
    numbers: Vec<(usize, usize)>,
    colours: Vec<(u8, u8, u8)>,
}

impl Kinds {
    fn of(look: &Look, columns: &[Vec<Slab>]) -> Self {
        let slabs = columns.iter().flatten();
        let mut numbers: Vec<(usize, usize)> =
            slabs.map(|slab| (slab.pieces, slab.holes)).collect();
        numbers.sort_unstable_by_key(|&(pieces, holes)| (holes, pieces));
        numbers.dedup();
        Self {
            colours: (0..numbers.len())
                .map(|kind| look.tint(TINT, kind))
                .collect(),
            numbers,
        }
    }
}

/// The figure; `None` without a feature.
fn draw(result: &SweepResult, number: usize, print: &Print<'_>) -> Drawn {
    let (family, look) = (&result.subject.family, &print.look);
    let watched = result.subject.observables[number];
    let columns: Vec<Vec<Slab>> = result
        .points
        .iter()
        .map(|point| slabs(features(point, number)))
        .collect();
    let kinds = Kinds::of(look, &columns);
    if kinds.numbers.is_empty() {
        return None;
    }
    let range = parameter_range(&result.points);
    let high = look.height(MAP.1, USUAL);
    let title = format!("level / max {}", names::density(family, watched));
    let up = Scale::vertical(look, (0.0, 1.0), high, &title);
    let left = MARGIN + up.left();
    let wide = look.fill(MAP.0, left + BESIDE + MARGIN);
    let width = left + wide + BESIDE + MARGIN;
    let across = Scale::horizontal(look, range, wide, &names::parameter(family));
    let heading = Heading::new(look, print.title, width);
    let labels = Labels::new(look, result, Some(watched), range, (left, wide));
    let map = Rectangle::new((left, heading.height() + labels.height()), (wide, high));
    let entries = kinds.numbers.iter().zip(&kinds.colours);
    let entries = entries.map(|(&kind, &colour)| (Swatch::Box(Colour::fixed(colour)), words(kind)));
    let entries: Vec<_> = entries.chain(labels.entries()).collect();
    let legend = Legend::new(look, entries, width - 2.0 * MARGIN);
    let below = map.bottom() + Scale::below();
    let page = Page::new(look, width, below + legend.height() + MARGIN);
    heading.draw(&page);
    let panel = page.panel(map, range, (0.0, 1.0));
    let edges = column_edges(&result.points, range);
    draw_areas((&panel, map), &columns, &kinds, (&edges, range));
    for (column, _) in columns
        .iter()
        .enumerate()
        .filter(|(_, slabs)| slabs.is_empty())
    {
        hatch_column(&page, &panel, &edges[column..], (0.0, 1.0));
    }
    labels.draw_plain(&panel, (0.0, 1.0));
    frame::border(&page, map);
    labels.draw_texts(&page, map);
    across.draw_below(&page, map, true);
    up.draw_left(&page, map, true);
    legend.draw(&page, map.left + 0.5 * map.width, below);
    let seen = format!(
        "Betti numbers of the sets where the steady-state density {} exceeds a level: their pieces and holes, over {} and the level as a share of \
         the highest peak. Beside a P-bifurcation the levels of two pieces are as few as the valley is shallow; they are \
         drawn up to half-way to the next value that was solved.",
        caption::density(family, watched),
        caption::parameter(family)
    );
    let caption = caption::of_sweep(result, seen, &[caption::bifurcations(result)]);
    Some(Figure::new(&page, caption, rows(result, &columns)))
}

/// The table, a row a slab. Levels are shares of the highest peak, as they are drawn.
fn rows(result: &SweepResult, columns: &[Vec<Slab>]) -> String {
    let parameter = result.subject.family.parameter();
    let names = [parameter, "level_from", "level_to", "pieces", "holes"];
    let points = result.points.iter().zip(columns);
    let slabs = points.flat_map(|(point, slabs)| slabs.iter().map(|slab| (point.value, slab)));
    let rows = slabs.map(|(value, slab)| {
        let [value, from, to] = [value, slab.from, slab.to].map(number_of);
        let counts = [slab.pieces, slab.holes].map(|count| count.to_string());
        [vec![value, from, to], counts.to_vec()].concat()
    });
    table::table(&names, rows)
}

/// The areas of equal numbers, as a picture.
fn draw_areas(
    (panel, map): (&Panel, Rectangle),
    columns: &[Vec<Slab>],
    kinds: &Kinds,
    (edges, range): (&[f64], (f64, f64)),
) {
    let size = [map.width, map.height].map(|length| (PNG_SCALE * length).round() as usize);
    let point_of = heat::nearest(edges, range, size[0]);
    let picture = Picture::patches((size[0], size[1]), &kinds.colours, |column, row| {
        let level = (row as f64 + 0.5) / size[1] as f64;
        let slabs = &columns[point_of[column]];
        let slab = slabs.iter().find(|slab| level <= slab.to);
        let kind = slab.map(|slab| (slab.pieces, slab.holes));
        let known = kinds.numbers.iter().position(|one| Some(*one) == kind);
        known.unwrap_or(0)
    });
    panel.draw(&[(range.0, 1.0), (range.1, 0.0)], Shape::Image(picture));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::FeatureErrors;

    fn feature(kind: FeatureKind, density: f64, persistence: f64, verdict: Verdict) -> Feature {
        Feature {
            kind,
            position: vec![0.0, 0.0],
            density,
            persistence,
            standard_error: 0.0,
            significance: 1.0,
            verdict,
            partner: None,
            errors: FeatureErrors::default(),
        }
    }

    #[test]
    fn pieces_and_holes_are_counted_between_the_levels_where_they_change() {
        use FeatureKind::{Crater, Peak, Ring, Valley};
        use Verdict::{Absent, Present};
        // A rim from 0.5 to 2 with two peaks on it, merged at 0.8; its crater goes down to 0.2.
        let features = vec![
            feature(Peak, 2.0, 1.999, Present),
            feature(Peak, 1.6, 0.8, Present),
            feature(Peak, 1.9, 0.01, Absent),
            feature(Valley, 0.8, 0.8, Present),
            feature(Crater, 0.2, 0.3, Present),
        ];
        let found: Vec<_> = slabs(&features)
            .iter()
            .map(|slab| (slab.from, slab.to, slab.pieces, slab.holes))
            .collect();
        let wanted = [
            (0.0, 0.1, 1, 0),
            (0.1, 0.25, 1, 1),
            (0.25, 0.4, 1, 0),
            (0.4, 0.8, 2, 0),
            (0.8, 1.0, 1, 0),
        ];
        assert_eq!(found.len(), wanted.len(), "{found:?}");
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!(
                (found.0 - wanted.0).abs() < 1e-12 && (found.1 - wanted.1).abs() < 1e-12,
                "{found:?}"
            );
            assert_eq!((found.2, found.3), (wanted.2, wanted.3));
        }
        // A ring is one piece with a hole up to its top, as far as its rim is level.
        let ring = vec![
            feature(Ring, 1.0, 0.999, Present),
            feature(Crater, 0.4, 0.6, Present),
        ];
        let found = slabs(&ring);
        assert_eq!(
            found
                .iter()
                .map(|slab| (slab.pieces, slab.holes))
                .collect::<Vec<_>>(),
            [(1, 0), (1, 1)]
        );
        assert!(slabs(&[]).is_empty());
        assert_eq!(words((2, 1)), "2 pieces, 1 hole");
    }
}
