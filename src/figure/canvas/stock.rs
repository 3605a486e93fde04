//! The canvas as a backend of plotters: its own elements drawn with those of the canvas.

use std::convert::Infallible;

use plotters_backend::text_anchor::VPos;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, FontTransform,
};

use super::backend::{Canvas, Drawn, Lettering};
use super::style::{Colour, Stroke, UNITS};

/// A colour of plotters' own elements.
fn colour_of(colour: BackendColor) -> Colour {
    Colour::fixed(colour.rgb).at(colour.alpha)
}

fn stroke_of<S: BackendStyle>(style: &S) -> Stroke {
    Stroke::solid(
        colour_of(style.color()),
        f64::from(style.stroke_width()) / UNITS,
    )
}

impl DrawingBackend for Canvas {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size()
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, colour: BackendColor) -> Drawn {
        self.area(
            &[(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)],
            colour_of(colour),
        );
        Ok(())
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        self.line(&[from, to], &stroke_of(style));
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (left, top): BackendCoord,
        (right, bottom): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let corners = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        match fill {
            true => self.area(&corners[..4], colour_of(style.color())),
            false => self.line(&corners, &stroke_of(style)),
        }
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let points: Vec<BackendCoord> = path.into_iter().collect();
        self.line(&points, &stroke_of(style));
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let inside = if fill {
            style.color()
        } else {
            style.color().mix(0.0)
        };
        let radius = f64::from(radius) / UNITS;
        self.dot(center, radius, colour_of(inside), &stroke_of(style));
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        vert: I,
        style: &S,
    ) -> Drawn {
        let points: Vec<BackendCoord> = vert.into_iter().collect();
        self.area(&points, colour_of(style.color()));
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, at: BackendCoord) -> Drawn {
        let size = style.size() / UNITS;
        let half = (0.5 * style.size()) as i32;
        let down = match style.anchor().v_pos {
            VPos::Top => half,
            VPos::Center => 0,
            VPos::Bottom => -half,
        };
        let lettering = Lettering {
            markup: text.to_owned(),
            size,
            colour: colour_of(style.color()),
            anchor: style.anchor().h_pos,
            upward: matches!(style.transform(), FontTransform::Rotate270),
            bold: false,
        };
        self.text((at.0, at.1 + down), &lettering);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::look::Look;
    use super::*;

    #[test]
    fn stock_elements_of_plotters_draw_on_the_canvas() {
        use plotters::prelude::*;
        let canvas = Canvas::new(Look::default(), 10.0, 5.0);
        let root = canvas.clone().into_drawing_area();
        root.draw(&PathElement::new(vec![(0, 0), (7, 3)], BLACK))
            .unwrap();
        root.draw(&Circle::new((5, 5), 3, RED.filled())).unwrap();
        let document = canvas.document();
        assert!(document.contains("viewBox=\"0 0 200 100\""));
        assert!(document.contains("points=\"0,0 7,3\"") && document.contains("<circle cx=\"5\""));
    }
}
