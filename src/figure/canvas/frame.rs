//! The frame of a panel: its border, ticks, tick labels and titles.

use plotters_backend::text_anchor::HPos;

use super::backend::Lettering;
use super::page::{Page, Rectangle, Shape, lettering, small};
use super::scale::GAP;
pub(crate) use super::scale::Scale;
use super::style::{FRAME_LINE, INK, MINOR_TICK, Stroke, TEXT, TICK, TICK_TEXT};

impl Scale {
    /// Draws ticks below a rectangle and, if wanted, labels and title.
    pub(crate) fn draw_below(&self, page: &Page, rect: Rectangle, labels: bool) {
        let bottom = rect.bottom();
        for (share, labelled) in self.all() {
            let x = rect.left + share * rect.width;
            let end = bottom + if labelled { TICK } else { MINOR_TICK };
            page.draw(
                &[(x, bottom), (x, end)],
                Shape::Line(Stroke::solid(INK, FRAME_LINE)),
            );
        }
        if !labels {
            return;
        }
        for tick in &self.ticks.major {
            let x = rect.left + self.share(tick.value) * rect.width;
            let y = bottom + TICK + GAP + 0.5 * TICK_TEXT;
            page.text((x, y), small(tick.label.as_str(), HPos::Center, INK));
        }
        let y = bottom + TICK + GAP + TICK_TEXT + GAP + 0.7 * TEXT;
        let middle = rect.left + 0.5 * rect.width;
        page.text((middle, y), lettering(self.title(), HPos::Center));
    }

    /// Draws ticks left of a rectangle and, if wanted, labels and title.
    pub(crate) fn draw_left(&self, page: &Page, rect: Rectangle, labels: bool) {
        for (share, labelled) in self.all() {
            let y = rect.bottom() - share * rect.height;
            let end = rect.left - if labelled { TICK } else { MINOR_TICK };
            let points = [(rect.left, y), (end, y)];
            page.draw(&points, Shape::Line(Stroke::solid(INK, FRAME_LINE)));
        }
        if !labels {
            return;
        }
        self.write_labels_left(page, rect);
        let middle = rect.top + 0.5 * rect.height;
        let first = rect.left - self.label_width() - GAP - 0.6 * TEXT - self.second_line();
        for (number, line) in self.upward().iter().enumerate() {
            let title = Lettering {
                upward: true,
                ..lettering(line, HPos::Center)
            };
            // Centring across the direction is done in the rotated frame, so the point is the middle of the line.
            page.text((first + number as f64 * self.second_line(), middle), title);
        }
    }

    /// Draws ticks and labels left of a rectangle, and no title.
    pub(crate) fn draw_labels_left(&self, page: &Page, rect: Rectangle) {
        self.draw_left(page, rect, false);
        self.write_labels_left(page, rect);
    }

    fn write_labels_left(&self, page: &Page, rect: Rectangle) {
        for tick in &self.ticks.major {
            let y = rect.bottom() - self.share(tick.value) * rect.height;
            let place = (rect.left - TICK - GAP, y);
            page.text(place, small(tick.label.as_str(), HPos::Right, INK));
        }
    }

    /// Draws ticks and labels right of a rectangle (a colour bar).
    pub(crate) fn draw_right(&self, page: &Page, rect: Rectangle) {
        let right = rect.right();
        for tick in &self.ticks.major {
            let y = rect.bottom() - self.share(tick.value) * rect.height;
            let stroke = Stroke::solid(INK, FRAME_LINE);
            page.draw(&[(right, y), (right + TICK - 1.0, y)], Shape::Line(stroke));
            page.text(
                (right + TICK + GAP - 1.0, y),
                small(tick.label.as_str(), HPos::Left, INK),
            );
        }
    }
}

/// Draws the frame of a panel: its border, and both scales with labels and titles.
pub(crate) fn around(page: &Page, rect: Rectangle, (across, up): (&Scale, &Scale)) {
    border(page, rect);
    across.draw_below(page, rect, true);
    up.draw_left(page, rect, true);
}

/// Draws the border of a rectangle.
pub(crate) fn border(page: &Page, rect: Rectangle) {
    let line = Stroke::solid(INK, FRAME_LINE);
    page.draw(&rect.rim(), Shape::Line(line));
}
