//! The frame of a panel: its border, ticks, tick labels and titles.

use plotters_backend::text_anchor::HPos;

use super::DrawError;
use super::backend::Lettering;
use super::page::{Page, Rectangle, Shape, lettering};
use super::scale::GAP;
pub(in crate::figure) use super::scale::Scale;
use super::style::{FRAME_LINE, INK, MINOR_TICK, Stroke, TEXT, TICK, TICK_TEXT};

impl Scale {
    /// Draws ticks below a rectangle and, if wanted, labels and title.
    ///
    /// # Errors
    /// [`DrawError::Layout`].
    pub(in crate::figure) fn draw_below(
        &self,
        page: &Page,
        rect: Rectangle,
        labels: bool,
    ) -> Result<(), DrawError> {
        let bottom = rect.bottom();
        for (share, labelled) in self.all() {
            let x = rect.left + share * rect.width;
            let end = bottom + if labelled { TICK } else { MINOR_TICK };
            page.draw(
                &[(x, bottom), (x, end)],
                Shape::Line(Stroke::solid(INK, FRAME_LINE)),
            )?;
        }
        if !labels {
            return Ok(());
        }
        for tick in &self.ticks.major {
            let x = rect.left + self.share(tick.value) * rect.width;
            let y = bottom + TICK + GAP + 0.5 * TICK_TEXT;
            page.text((x, y), tick_label(&tick.label, HPos::Center))?;
        }
        let y = bottom + TICK + GAP + TICK_TEXT + GAP + 0.7 * TEXT;
        let middle = rect.left + 0.5 * rect.width;
        page.text((middle, y), lettering(self.title(), HPos::Center))
    }

    /// Draws ticks left of a rectangle and, if wanted, labels and title.
    ///
    /// # Errors
    /// [`DrawError::Layout`].
    pub(in crate::figure) fn draw_left(
        &self,
        page: &Page,
        rect: Rectangle,
        labels: bool,
    ) -> Result<(), DrawError> {
        for (share, labelled) in self.all() {
            let y = rect.bottom() - share * rect.height;
            let end = rect.left - if labelled { TICK } else { MINOR_TICK };
            let points = [(rect.left, y), (end, y)];
            page.draw(&points, Shape::Line(Stroke::solid(INK, FRAME_LINE)))?;
        }
        if !labels {
            return Ok(());
        }
        self.write_labels_left(page, rect)?;
        let title = Lettering {
            upward: true,
            ..lettering(self.title(), HPos::Center)
        };
        let middle = rect.top + 0.5 * rect.height;
        // Centring across the direction is done in the rotated frame, so the point is the middle of the line.
        page.text(
            (rect.left - self.label_width() - GAP - 0.6 * TEXT, middle),
            title,
        )
    }

    /// Draws ticks and labels left of a rectangle, and no title.
    ///
    /// # Errors
    /// [`DrawError::Layout`].
    pub(in crate::figure) fn draw_labels_left(
        &self,
        page: &Page,
        rect: Rectangle,
    ) -> Result<(), DrawError> {
        self.draw_left(page, rect, false)?;
        self.write_labels_left(page, rect)
    }

    fn write_labels_left(&self, page: &Page, rect: Rectangle) -> Result<(), DrawError> {
        for tick in &self.ticks.major {
            let y = rect.bottom() - self.share(tick.value) * rect.height;
            let place = (rect.left - TICK - GAP, y);
            page.text(place, tick_label(&tick.label, HPos::Right))?;
        }
        Ok(())
    }

    /// Draws ticks and labels right of a rectangle (a colour bar).
    ///
    /// # Errors
    /// [`DrawError::Layout`].
    pub(in crate::figure) fn draw_right(
        &self,
        page: &Page,
        rect: Rectangle,
    ) -> Result<(), DrawError> {
        let right = rect.right();
        for tick in &self.ticks.major {
            let y = rect.bottom() - self.share(tick.value) * rect.height;
            let stroke = Stroke::solid(INK, FRAME_LINE);
            page.draw(&[(right, y), (right + TICK - 1.0, y)], Shape::Line(stroke))?;
            page.text(
                (right + TICK + GAP - 1.0, y),
                tick_label(&tick.label, HPos::Left),
            )?;
        }
        Ok(())
    }
}

fn tick_label(label: &str, anchor: HPos) -> Lettering {
    Lettering {
        size: TICK_TEXT,
        ..lettering(label, anchor)
    }
}

/// Draws the border of a rectangle.
///
/// # Errors
/// [`DrawError::Layout`].
pub(in crate::figure) fn border(page: &Page, rect: Rectangle) -> Result<(), DrawError> {
    let (left, right, top, bottom) = (rect.left, rect.right(), rect.top, rect.bottom());
    let corners = [
        (left, top),
        (right, top),
        (right, bottom),
        (left, bottom),
        (left, top),
    ];
    page.draw(&corners, Shape::Line(Stroke::solid(INK, FRAME_LINE)))
}
