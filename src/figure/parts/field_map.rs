//! A field of a passage over two axes as a map: colours with contours, or with the lines of a current.

use super::field_border::FieldBorder;
use crate::continuation::StateField;
use crate::figure::canvas::contour::{GridValues, simplify};
use crate::figure::canvas::heat::Picture;
use crate::figure::canvas::look::{Look, on_heat};
use crate::figure::canvas::page::{Page, Panel, Rectangle, Shape};
use crate::figure::canvas::streamline::VectorGrid;
use crate::figure::canvas::style::Stroke;
use crate::figure::parts::view::{middles, resolution};
use crate::space::Axis;

/// Contours are drawn at these shares of the largest value, that of one half wider.
pub(in crate::figure) const LEVELS: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
const HALF: f64 = 0.5;
/// What lies so near to the chord of a line, in pixels, is left out.
pub(in crate::figure) const ALIKE: f64 = 0.05;
/// Length and half the width of the head of an arrow, and the shortest line with one, in pixels.
const HEAD: (f64, f64) = (6.0, 2.2);
const WITH_HEAD: f64 = 24.0;

/// What is smaller than this share of the largest value of a field is not looked for where a map ends.
const FAINT: f64 = 2e-3;
/// What a map shows beside that, over its width and height.
const BESIDE: f64 = 0.3;

/// Cells along each axis that maps of several points show: from the first to behind the last.
pub(in crate::figure) type Extent = [(usize, usize); 2];

/// All cells of the axes of fields; `None` of none, or of another number of axes than two.
pub(in crate::figure) fn whole(fields: &[&StateField]) -> Option<Extent> {
    match &fields.first()?.axes[..] {
        [x, y] => Some([(0, x.count()), (0, y.count())]),
        _ => None,
    }
}

/// The cells about those in which a field of some points is not small.
pub(in crate::figure) fn where_seen<'f>(
    points: impl Iterator<Item = &'f [&'f StateField]>,
) -> Option<Extent> {
    let mut seen: Option<Extent> = None;
    let mut all = None;
    for fields in points {
        let Some(extent @ [_, (_, rows)]) = whole(fields) else {
            continue;
        };
        all = Some(extent);
        for field in fields {
            let size = |value: &f64| if value.is_finite() { value.abs() } else { 0.0 };
            let least = FAINT * field.values.iter().map(size).fold(0.0, f64::max);
            let cells = field.values.iter().enumerate();
            for (cell, _) in cells.filter(|(_, value)| size(value) > least) {
                let [i, j] = [cell / rows, cell % rows];
                let [x, y] = seen.unwrap_or([(i, i + 1), (j, j + 1)]);
                seen = Some([(x.0.min(i), x.1.max(i + 1)), (y.0.min(j), y.1.max(j + 1))]);
            }
        }
    }
    let (seen, all) = (seen?, all?);
    Some([0, 1].map(|axis| {
        let ((from, to), count) = (seen[axis], all[axis].1);
        let more = (BESIDE * (to - from) as f64).ceil() as usize;
        (from.saturating_sub(more), (to + more).min(count))
    }))
}

/// A map of a field over two axes.
pub(in crate::figure) struct FieldMap<'a> {
    pub(in crate::figure) fields: &'a [&'a StateField],
    pub(in crate::figure) places: [Vec<f64>; 2],
    pub(in crate::figure) ranges: [(f64, f64); 2],
    pub(in crate::figure) largest: f64,
    /// One value a cell that is shown: the size of a current, in ranges of the map.
    values: Vec<f64>,
    /// The same of each field.
    shown: Vec<Vec<f64>>,
    /// The border across which it may jump.
    border: Option<FieldBorder<'a>>,
}

impl<'a> FieldMap<'a> {
    /// A map of one field, or of the two components of a current, in some cells; `None` where there is nothing to be
    /// seen.
    pub(in crate::figure) fn new(
        fields: &'a [&'a StateField],
        [across, up]: Extent,
    ) -> Option<Self> {
        let [x, y] = &fields.first()?.axes[..] else {
            return None;
        };
        // Colours go from the centre of one cell to that of the next.
        if (across.1 - across.0).min(up.1 - up.0) < 2 {
            return None;
        }
        let places = [
            x.centres()[across.0..across.1].to_vec(),
            y.centres()[up.0..up.1].to_vec(),
        ];
        let rows = y.count();
        let shown: Vec<Vec<f64>> = fields
            .iter()
            .map(|field| {
                let columns =
                    (across.0..across.1).map(|i| &field.values[i * rows + up.0..i * rows + up.1]);
                columns.flatten().copied().collect()
            })
            .collect();
        let values = match &shown[..] {
            [one] => one.clone(),
            [one, other] => vectors(&places, [one, other]).sizes(),
            _ => return None,
        };
        let finite = values.iter().filter(|value| value.is_finite());
        let largest = finite.fold(0.0, |most: f64, value| most.max(*value));
        let range =
            |axis: &Axis, (from, to): (usize, usize)| (axis.edges()[from], axis.edges()[to]);
        (largest > 0.0).then_some(Self {
            fields,
            places,
            ranges: [range(x, across), range(y, up)],
            largest,
            values,
            shown,
            border: None,
        })
    }

    /// The same of a field that may jump on the border of a target.
    pub(in crate::figure) fn around(self, is_inside: impl Fn((f64, f64)) -> bool + 'a) -> Self {
        let values = (self.values.as_slice(), self.largest);
        let border = FieldBorder::new(&self.places, values, is_inside);
        Self {
            border: Some(border),
            ..self
        }
    }

    /// The colours of all pixels, between the centres of cells by straight lines.
    pub(in crate::figure) fn picture(&self, look: &Look, map: Rectangle, largest: f64) -> Picture {
        let size = (resolution(map.width), resolution(map.height));
        let [x, y] = &self.places;
        let across = middles(self.ranges[0], size.0);
        let up = middles(self.ranges[1], size.1);
        Picture::new(look, size, |column, row| {
            let place = (across[column], up[row]);
            let values = match &self.border {
                Some(border) => border.side(&self.places, place),
                None => &self.values[..],
            };
            Some(GridValues { x, y, values }.between(place)? / largest)
        })
    }

    /// Contours of one field, or the lines of a current.
    pub(in crate::figure) fn draw_lines(&self, (page, panel): (&Page, &Panel), largest: f64) {
        match &self.shown[..] {
            [one, other] => self.draw_current((page, panel), [one, other], largest),
            _ => self.draw_contours(page.look(), panel, largest),
        }
    }

    fn draw_contours(&self, look: &Look, panel: &Panel, largest: f64) {
        let [x, y] = &self.places;
        let values = match &self.border {
            Some(border) => border.outer(),
            None => &self.values[..],
        };
        let grid = GridValues { x, y, values };
        for share in LEVELS {
            let width = if share == HALF { 1.6 } else { 0.8 };
            let stroke = Stroke::solid(on_heat(look, share), width);
            for line in grid.contour(share * largest) {
                let parts = match &self.border {
                    Some(border) => border.outside(&line),
                    None => vec![line],
                };
                for part in parts {
                    panel.draw(&part, Shape::Line(stroke));
                }
            }
        }
    }

    fn draw_current(&self, (page, panel): (&Page, &Panel), current: [&[f64]; 2], largest: f64) {
        let look = page.look();
        let [x, y] = &self.places;
        let values = &self.values;
        let sizes = GridValues { x, y, values };
        for line in vectors(&self.places, current).streamlines() {
            let Some(&middle) = line.get(line.len() / 2) else {
                continue;
            };
            let share = sizes.between(middle).map_or(0.0, |size| size / largest);
            let colour = on_heat(look, share.min(1.0));
            let thin = simplify(&line, ALIKE, |&point| panel.place(point));
            panel.draw(&thin, Shape::Line(Stroke::solid(colour, 0.8)));
            let pixels: Vec<(f64, f64)> = line.iter().map(|&point| panel.place(point)).collect();
            if let Some(head) = head(&pixels) {
                page.draw(&head, Shape::Area(colour));
            }
        }
    }
}

fn vectors<'a>([x, y]: &'a [Vec<f64>; 2], components: [&'a [f64]; 2]) -> VectorGrid<'a> {
    VectorGrid {
        components: components.map(|values| GridValues { x, y, values }),
    }
}

/// The head of an arrow in the middle of a line, in pixels; `None` of a short one.
fn head(line: &[(f64, f64)]) -> Option<[(f64, f64); 3]> {
    let length = |pair: &[(f64, f64)]| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
    let whole: f64 = line.windows(2).map(length).sum();
    if whole < WITH_HEAD {
        return None;
    }
    let mut gone = 0.0;
    let at = line.windows(2).position(|pair| {
        gone += length(pair);
        gone >= 0.5 * whole + 0.5 * HEAD.0
    })?;
    let tip = line[at];
    let is_far = |point: &&(f64, f64)| length(&[**point, tip]) >= HEAD.0;
    let back = line[..at].iter().rev().find(is_far)?;
    let size = (tip.0 - back.0).hypot(tip.1 - back.1);
    let (ux, uy) = ((tip.0 - back.0) / size, (tip.1 - back.1) / size);
    let at = |side: f64| {
        (
            tip.0 - HEAD.0 * ux - side * HEAD.1 * uy,
            tip.1 - HEAD.0 * uy + side * HEAD.1 * ux,
        )
    };
    Some([at(1.0), tip, at(-1.0)])
}
