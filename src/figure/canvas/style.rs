//! How figures look: sizes, colours, dashes. Everything that makes them one family stands here; what a style changes of
//! it is in [`look`](super::look).
//!
//! Lengths are in figure pixels. Left to itself a figure is printed at 96 of them to the inch; with a width or a size
//! of text asked for, a figure pixel is what makes the lettering of that size, and the layout has as many of them as
//! the page is then wide.

/// Sub-pixel units in a figure pixel: plotters places everything on whole units.
pub(crate) const UNITS: f64 = 20.0;
/// Pixels of an embedded heat map to a figure pixel, where cells are not pixels themselves.
pub(crate) const PNG_SCALE: f64 = 3.0;

/// Lettering of axis titles and legends.
pub(crate) const TEXT: f64 = 14.0;
/// Lettering of tick labels.
pub(crate) const TICK_TEXT: f64 = 12.5;
/// Lettering of the line with the title of the run.
pub(crate) const TITLE_TEXT: f64 = 12.0;
/// White border of a page.
pub(crate) const MARGIN: f64 = 8.0;
/// Length of a tick, outward.
pub(crate) const TICK: f64 = 5.0;
/// Length of a tick without label.
pub(crate) const MINOR_TICK: f64 = 3.0;
/// Width of frames and ticks.
pub(crate) const FRAME_LINE: f64 = 1.0;
/// Width of curves.
pub(crate) const CURVE_LINE: f64 = 1.7;

/// Width of error bars.
pub(crate) const ERROR_LINE: f64 = 0.9;

/// A colour, on light and on dark ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Colour {
    /// Red, green, blue on light ground.
    pub(crate) light: (u8, u8, u8),
    /// The same on dark ground.
    pub(crate) dark: (u8, u8, u8),
    /// Opacity.
    pub(crate) alpha: f64,
}

impl Colour {
    /// A colour that does not depend on the ground.
    pub(crate) const fn fixed(rgb: (u8, u8, u8)) -> Self {
        Self::new(rgb, rgb)
    }

    const fn new(light: (u8, u8, u8), dark: (u8, u8, u8)) -> Self {
        Self {
            light,
            dark,
            alpha: 1.0,
        }
    }

    /// The same colour, let through.
    pub(crate) const fn at(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }
}

/// Lettering, frames, and whatever stands on the page.
pub(crate) const INK: Colour = Colour::new((0, 0, 0), (236, 236, 236));
/// The page.
pub(crate) const PAPER: Colour = Colour::new((255, 255, 255), (20, 22, 26));
/// Black on any ground: marks on maps.
pub(crate) const BLACK: Colour = Colour::fixed((0, 0, 0));
/// White on any ground: marks on maps.
pub(crate) const WHITE: Colour = Colour::fixed((255, 255, 255));
/// Lettering that stands back.
pub(crate) const GREY: Colour = Colour::new((95, 95, 95), (165, 165, 165));
/// Ground where there is no density.
pub(crate) const BLANK: Colour = Colour::new((240, 240, 240), (44, 46, 50));
/// Hatching of that ground.
pub(crate) const HATCH: Colour = Colour::new((150, 150, 150), (110, 110, 110));
/// Located bifurcations: a red that no colour of the map comes near.
pub(crate) const BIFURCATION: Colour = Colour::new((214, 20, 20), (255, 90, 80));
/// Changes of stability.
pub(crate) const D_BIFURCATION: Colour = Colour::new((20, 70, 200), (120, 170, 255));

/// Colours of curves, after Okabe and Ito (told apart with any colour vision), without their yellow.
const CURVES: [Colour; 7] = [
    Colour::new((0, 114, 178), (64, 156, 214)),
    Colour::fixed((213, 94, 0)),
    Colour::fixed((0, 158, 115)),
    Colour::fixed((204, 121, 167)),
    INK,
    Colour::fixed((86, 180, 233)),
    Colour::fixed((230, 159, 0)),
];

/// Dashes of curves, in pixels; a different number from that of the colours, so that pairs repeat late.
const DASHES: [&[f64]; 5] = [
    &[],
    &[7.0, 3.0],
    &[2.0, 2.5],
    &[8.0, 3.0, 2.0, 3.0],
    &[12.0, 3.0, 4.0, 3.0],
];

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(crate) struct Stroke {
    /// Its colour.
    pub(crate) colour: Colour,
    /// Its width, in pixels.
    pub(crate) width: f64,
    /// Lengths of dashes and gaps, in pixels; empty for a solid line.
    pub(crate) dash: &'static [f64],
}

impl Stroke {
    /// A solid line.
    pub(crate) const fn solid(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: &[],
        }
    }

    /// The same line with these lengths of dashes and gaps.
    pub(crate) const fn dashed(self, dash: &'static [f64]) -> Self {
        Self { dash, ..self }
    }

    /// The line of the curve with the given number.
    pub(crate) fn curve(number: usize) -> Self {
        Self {
            colour: CURVES[number % CURVES.len()],
            width: CURVE_LINE,
            dash: DASHES[number % DASHES.len()],
        }
    }
}

/// Relative luminance of an sRGB colour (WCAG 2).
pub(super) fn luminance((r, g, b): (u8, u8, u8)) -> f64 {
    let linear = |value: u8| (f64::from(value) / 255.0).powf(2.2);
    0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lettering_is_read_on_both_grounds() {
        for colour in [INK, GREY, BIFURCATION] {
            let light = (luminance(PAPER.light) + 0.05) / (luminance(colour.light) + 0.05);
            let dark = (luminance(colour.dark) + 0.05) / (luminance(PAPER.dark) + 0.05);
            assert!(light > 4.5 && dark > 4.5, "{colour:?}: {light}, {dark}");
        }
    }

    #[test]
    fn curves_repeat_neither_colour_with_dash_early() {
        let key = |number| {
            let stroke = Stroke::curve(number);
            (
                stroke.colour.light,
                stroke.dash.len(),
                stroke.dash.first().map(|d| *d as i64),
            )
        };
        for a in 0..35 {
            for b in 0..a {
                assert_ne!(key(a), key(b));
            }
        }
    }
}
