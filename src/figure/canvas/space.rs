//! A box seen from above and aside, for surfaces: parallel projection, axes with titles, and facets drawn from the far
//! end to the near one, so that near parts hide far ones.

use plotters_backend::text_anchor::HPos;

use super::backend::Lettering;
use super::facets::{HEIGHT, brightness, parts, shade};
use super::frame::Scale;
use super::letters;
use super::look::Look;
use super::page::{Page, Rectangle, Shape, lettering};
use super::style::{Colour, FRAME_LINE, GREY, INK, Stroke, TEXT, TICK, TICK_TEXT};

/// Angle between the abscissa and the picture plane, in degrees: MATLAB's habit.
const AZIMUTH: f64 = 37.5;
/// Angle of the view above the floor, in degrees.
const ELEVATION: f64 = 32.0;
/// Gap between ticks and labels, in pixels.
const GAP: f64 = 4.0;
/// How far the title of the heights reaches beyond their axis, to the right.
const TITLE_BEYOND: f64 = 4.0;
/// What is lower than this share of the box lies on its floor, for the eye.
const FLAT: f64 = 0.002;
/// Width of the lines of the mesh, in pixels.
const MESH: f64 = 0.35;

/// Heights over a rectilinear grid, all in shares of the box: abscissas and ordinates ascending from 0 to 1, heights
/// the ordinate fastest.
pub(crate) struct Heights {
    /// Abscissas.
    pub(crate) x: Vec<f64>,
    /// Ordinates.
    pub(crate) y: Vec<f64>,
    /// Heights.
    pub(crate) z: Vec<f64>,
}

impl Heights {
    fn at(&self, i: usize, j: usize) -> [f64; 3] {
        [self.x[i], self.y[j], self.z[i * self.y.len() + j]]
    }
}

/// An axis, the point at a share of its way, the direction of its ticks on the page, and where its labels end.
type Axis<'a> = (&'a Scale, fn(f64) -> [f64; 3], (f64, f64), HPos);

/// A box laid out, with its three axes.
pub(crate) struct Space {
    /// Pixels from the upper left of the page to the middle of the floor.
    middle: (f64, f64),
    /// Pixels of a side of the box.
    side: f64,
    axes: [Scale; 3],
}

/// Sine and cosine of both angles: azimuth, elevation.
fn angles() -> ((f64, f64), (f64, f64)) {
    (
        AZIMUTH.to_radians().sin_cos(),
        ELEVATION.to_radians().sin_cos(),
    )
}

/// Place of a point of the unit box on a picture whose unit is a side of the box, from the middle of the floor;
/// downward positive.
fn project([x, y, z]: [f64; 3]) -> (f64, f64) {
    let ((sin_a, cos_a), (sin_e, cos_e)) = angles();
    let (u, v, w) = (x - 0.5, y - 0.5, z * HEIGHT);
    let away = v * cos_a - u * sin_a;
    (u * cos_a + v * sin_a, -(w * cos_e + away * sin_e))
}

impl Space {
    /// Height of what a box with its labels takes on `width` pixels, when its axes have these labels' widths beside it.
    pub(crate) fn height(look: &Look, width: f64, ranges: Ranges<'_>) -> f64 {
        let (side, _) = Self::lay_out(look, width, ranges);
        Self::above(side) + side * project([1.0, 0.0, 0.0]).1 + Self::below()
    }

    /// Room from the top to the middle of the floor.
    fn above(side: f64) -> f64 {
        1.9 * TEXT - side * project([0.0, 1.0, 1.0]).1
    }

    /// Room below the near corner.
    fn below() -> f64 {
        TICK + GAP + 1.1 * TICK_TEXT
    }

    /// Room left of the box: labels of the heights, and their title, which ends above the axis.
    fn left(look: &Look, axes: &[Scale; 3]) -> f64 {
        let title = letters::text_width(look, axes[2].title(), TEXT, false);
        (axes[2].label_width() + GAP).max(title - TITLE_BEYOND)
    }

    /// Side of the box, and its axes.
    fn lay_out(look: &Look, width: f64, ranges: Ranges<'_>) -> (f64, [Scale; 3]) {
        let wide = project([1.0, 1.0, 0.0]).0 - project([0.0, 0.0, 0.0]).0;
        // Labels take about a fifth.
        let rough = 0.8 * width / wide;
        let floor = |(range, title): ((f64, f64), &str), end: [f64; 3]| {
            let (from, to) = (project([0.0, 0.0, 0.0]), project(end));
            let (across, down) = ((to.0 - from.0).abs(), (to.1 - from.1).abs());
            Scale::slanted(look, range, (rough * across, rough * down), title)
        };
        let high = Scale::vertical(look, ranges.z.0, 0.52 * rough, ranges.z.1);
        let axes = [
            floor(ranges.x, [1.0, 0.0, 0.0]),
            floor(ranges.y, [0.0, 1.0, 0.0]),
            high,
        ];
        // A label at the far end of the ordinate stands out by more than its half.
        let right = 0.5 * axes[1].label_width() + 3.0;
        let left = Self::left(look, &axes);
        (((width - left - right) / wide).max(30.0), axes)
    }

    /// Lays a box out in a rectangle that is [`Space::height`] high.
    pub(crate) fn new(look: &Look, rect: Rectangle, ranges: Ranges<'_>) -> Self {
        let (side, axes) = Self::lay_out(look, rect.width, ranges);
        let left = Self::left(look, &axes);
        let middle = rect.left + left - side * project([0.0, 0.0, 0.0]).0;
        Self {
            middle: (middle, rect.top + Self::above(side)),
            side,
            axes,
        }
    }

    /// Place of a point of the unit box on the page, in pixels.
    fn place(&self, point: [f64; 3]) -> (f64, f64) {
        let (x, y) = project(point);
        (self.middle.0 + self.side * x, self.middle.1 + self.side * y)
    }

    /// Draws floor and far walls with faint lines at the ticks, the surface, and the axes.
    pub(crate) fn draw(&self, page: &Page, heights: &Heights) {
        self.draw_walls(page);
        self.draw_surface(page, heights);
        self.draw_axes(page);
    }

    fn line(&self, page: &Page, points: &[[f64; 3]], stroke: Stroke) {
        let places: Vec<(f64, f64)> = points.iter().map(|&point| self.place(point)).collect();
        page.draw(&places, Shape::Line(stroke));
    }

    fn draw_walls(&self, page: &Page) {
        let faint = Stroke::solid(GREY.at(0.3), 0.6);
        for share in self.axes[0].labelled() {
            self.line(
                page,
                &[[share, 0.0, 0.0], [share, 1.0, 0.0], [share, 1.0, 1.0]],
                faint,
            );
        }
        for share in self.axes[1].labelled() {
            self.line(
                page,
                &[[1.0, share, 0.0], [0.0, share, 0.0], [0.0, share, 1.0]],
                faint,
            );
        }
        for share in self.axes[2].labelled() {
            self.line(
                page,
                &[[0.0, 0.0, share], [0.0, 1.0, share], [1.0, 1.0, share]],
                faint,
            );
        }
        let edge = Stroke::solid(GREY.at(0.6), 0.8);
        self.line(page, &[[0.0, 1.0, 0.0], [0.0, 1.0, 1.0]], edge);
        self.line(
            page,
            &[[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            edge,
        );
        self.line(
            page,
            &[
                [0.0, 0.0, 1.0],
                [0.0, 1.0, 1.0],
                [1.0, 1.0, 1.0],
                [1.0, 1.0, 0.0],
            ],
            edge,
        );
    }

    /// Strips of facets from the far end to the near one, each from left to right, which is toward the viewer too.
    fn draw_surface(&self, page: &Page, heights: &Heights) {
        let (n, m) = (heights.x.len(), heights.y.len());
        let colours = page.look().colours;
        for j in (0..m.saturating_sub(1)).rev() {
            let mut facets = Vec::with_capacity(n);
            let is_flat = |i: usize| {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                corners.iter().all(|&(i, j)| heights.at(i, j)[2] < FLAT)
            };
            let mut from = 0;
            while from + 1 < n {
                // Neighbours on the floor are one facet.
                let mut to = from + 1;
                while is_flat(from) && to + 1 < n && is_flat(to) {
                    to += 1;
                }
                let corners = [
                    heights.at(from, j),
                    heights.at(to, j),
                    heights.at(to, j + 1),
                    heights.at(from, j + 1),
                ];
                for facet in parts(corners) {
                    let height = facet.iter().map(|corner| corner[2]).sum::<f64>() / 4.0;
                    let colour = shade(colours.colour(height), brightness(&facet));
                    let places = facet.map(|corner| self.place(corner));
                    facets.push((places, Colour::fixed(colour)));
                }
                from = to;
            }
            page.facets(&facets);
            self.draw_mesh(page, heights, j);
        }
    }

    /// The lines of the mesh in the strip with that number.
    fn draw_mesh(&self, page: &Page, heights: &Heights, j: usize) {
        let stroke = Stroke::solid(super::style::BLACK.at(0.4), MESH);
        let every = |count: usize| count.div_ceil(26).max(1);
        let (n, m) = (heights.x.len(), heights.y.len());
        for i in (0..n).step_by(every(n)) {
            self.line(page, &[heights.at(i, j), heights.at(i, j + 1)], stroke);
        }
        if j.is_multiple_of(every(m)) {
            let along: Vec<[f64; 3]> = (0..n).map(|i| heights.at(i, j)).collect();
            self.line(page, &along, stroke);
        }
    }

    fn draw_axes(&self, page: &Page) {
        let ink = Stroke::solid(INK, FRAME_LINE);
        self.line(
            page,
            &[
                [0.0, 0.0, 1.0],
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
            ],
            ink,
        );
        let [across, along, up] = &self.axes;
        // Ticks continue the lines of the floor; that of the ordinate points left.
        let ((sin_a, cos_a), (sin_e, _)) = angles();
        let axes: [Axis<'_>; 3] = [
            (
                across,
                |share| [share, 0.0, 0.0],
                (-sin_a, cos_a * sin_e),
                HPos::Right,
            ),
            (
                along,
                |share| [1.0, share, 0.0],
                (cos_a, sin_a * sin_e),
                HPos::Left,
            ),
            (up, |share| [0.0, 0.0, share], (-1.0, 0.0), HPos::Right),
        ];
        let first = across.labelled().next().unwrap_or(1.0);
        let first_below = self.place([first, 0.0, 0.0]).1 + 0.6 * TICK_TEXT;
        for (scale, point, (dx, dy), anchor) in axes {
            let length = (dx * dx + dy * dy).sqrt();
            let (dx, dy) = (dx / length, dy / length);
            for (share, label) in scale.labels() {
                let (x, y) = self.place(point(share));
                page.draw(&[(x, y), (x + TICK * dx, y + TICK * dy)], Shape::Line(ink));
                // The first label of the abscissa leaves no room for the one of the floor.
                if dy == 0.0
                    && first_below > y - 1.1 * TICK_TEXT
                    && first_below < y + 1.1 * TICK_TEXT
                {
                    continue;
                }
                let text = Lettering {
                    size: TICK_TEXT,
                    ..lettering(label, anchor)
                };
                let down = if dy > 0.0 { 0.35 * TICK_TEXT } else { 0.0 };
                page.text((x + (TICK + GAP) * dx, y + TICK * dy + down), text);
            }
        }
        self.write_titles(page);
    }

    /// Titles beside the middle of their axes, beyond the labels; that of the heights above its axis.
    fn write_titles(&self, page: &Page) {
        let [across, along, up] = &self.axes;
        let (x, y) = self.place([0.5, 0.0, 0.0]);
        let place = (x - across.label_width() - 0.6 * TEXT, y + 1.7 * TEXT);
        page.text(place, lettering(across.title(), HPos::Right));
        let (x, y) = self.place([1.0, 0.5, 0.0]);
        let place = (x + along.label_width() + 0.6 * TEXT, y + 1.7 * TEXT);
        page.text(place, lettering(along.title(), HPos::Left));
        let (x, y) = self.place([0.0, 0.0, 1.0]);
        page.text(
            (x + TITLE_BEYOND, y - 1.15 * TEXT),
            lettering(up.title(), HPos::Right),
        );
    }
}

/// Ranges of the three axes with their titles.
#[derive(Clone, Copy)]
pub(crate) struct Ranges<'a> {
    /// Abscissa.
    pub(crate) x: ((f64, f64), &'a str),
    /// Ordinate.
    pub(crate) y: ((f64, f64), &'a str),
    /// Height.
    pub(crate) z: ((f64, f64), &'a str),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearer_corners_are_lower_on_the_page() {
        let (near, far) = (project([1.0, 0.0, 0.0]), project([0.0, 1.0, 0.0]));
        assert!(near.1 > far.1);
        // Right-handed: the abscissa and the ordinate both lead to the right, heights up.
        let origin = project([0.0, 0.0, 0.0]);
        assert!(project([1.0, 0.0, 0.0]).0 > origin.0 && project([0.0, 1.0, 0.0]).0 > origin.0);
        assert!(project([0.0, 0.0, 1.0]).1 < origin.1);
    }
}
