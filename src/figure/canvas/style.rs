//! How figures look: sizes, colours, dashes. Everything that makes them one family stands here.
//!
//! Lengths are in figure pixels (1/96 inch). A figure one text column wide, about 480 px, shrinks to the
//! 90 mm of a journal's column with lettering of about 7.5 pt.

use plotters::style::colors::colormaps::{ColorMap, ViridisRGB};
use plotters_backend::BackendColor;

/// Sub-pixel units in a figure pixel: plotters places everything on whole units.
pub(in crate::figure) const UNITS: f64 = 20.0;
/// Pixels of a PNG to a figure pixel.
pub(in crate::figure) const PNG_SCALE: f64 = 3.0;

/// Lettering of axis titles and legends.
pub(in crate::figure) const TEXT: f64 = 14.0;
/// Lettering of tick labels.
pub(in crate::figure) const TICK_TEXT: f64 = 12.5;
/// Lettering of the line with the title of the run.
pub(in crate::figure) const TITLE_TEXT: f64 = 12.0;
/// White border of a page.
pub(in crate::figure) const MARGIN: f64 = 8.0;
/// Length of a tick, outward.
pub(in crate::figure) const TICK: f64 = 5.0;
/// Length of a tick without label.
pub(in crate::figure) const MINOR_TICK: f64 = 3.0;
/// Width of frames and ticks.
pub(in crate::figure) const FRAME_LINE: f64 = 1.0;
/// Width of curves.
pub(in crate::figure) const CURVE_LINE: f64 = 1.7;

/// Width of error bars.
pub(in crate::figure) const ERROR_LINE: f64 = 0.9;

const fn colour(rgb: (u8, u8, u8), alpha: f64) -> BackendColor {
    BackendColor { alpha, rgb }
}

pub(in crate::figure) const BLACK: BackendColor = colour((0, 0, 0), 1.0);
pub(in crate::figure) const WHITE: BackendColor = colour((255, 255, 255), 1.0);
/// Lettering that stands back.
pub(in crate::figure) const GREY: BackendColor = colour((95, 95, 95), 1.0);
/// Ground where there is no density.
pub(in crate::figure) const BLANK: BackendColor = colour((240, 240, 240), 1.0);
/// Hatching of that ground.
pub(in crate::figure) const HATCH: BackendColor = colour((150, 150, 150), 1.0);
/// Located bifurcations: a red that no colour of the map comes near.
pub(in crate::figure) const BIFURCATION: BackendColor = colour((214, 20, 20), 1.0);

/// Colours of curves, after Okabe and Ito (told apart with any colour vision), without their yellow.
const CURVES: [(u8, u8, u8); 7] = [
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (0, 0, 0),
    (86, 180, 233),
    (230, 159, 0),
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
pub(in crate::figure) struct Stroke {
    /// Its colour.
    pub(in crate::figure) colour: BackendColor,
    /// Its width, in pixels.
    pub(in crate::figure) width: f64,
    /// Lengths of dashes and gaps, in pixels; empty for a solid line.
    pub(in crate::figure) dash: &'static [f64],
}

impl Stroke {
    /// A solid line.
    pub(in crate::figure) const fn solid(colour: BackendColor, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: &[],
        }
    }

    /// The line of the curve with the given number.
    pub(in crate::figure) fn curve(number: usize) -> Self {
        Self {
            colour: colour(CURVES[number % CURVES.len()], 1.0),
            width: CURVE_LINE,
            dash: DASHES[number % DASHES.len()],
        }
    }
}

/// The colour of a share (0 to 1) of the largest value: viridis, perceptually uniform and readable in grey.
pub(in crate::figure) fn heat(share: f64) -> (u8, u8, u8) {
    let colour = ViridisRGB.get_color(share.clamp(0.0, 1.0) as f32);
    (colour.0, colour.1, colour.2)
}

/// Black or white, whichever is seen better on the colour of a share.
pub(in crate::figure) fn on_heat(share: f64) -> BackendColor {
    if share > 0.55 { BLACK } else { WHITE }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of an sRGB colour (WCAG 2).
    fn luminance((r, g, b): (u8, u8, u8)) -> f64 {
        let linear = |value: u8| (f64::from(value) / 255.0).powf(2.2);
        0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
    }

    #[test]
    fn heat_grows_lighter_all_along() {
        let values: Vec<f64> = (0..=100)
            .map(|i| luminance(heat(f64::from(i) / 100.0)))
            .collect();
        assert!(values.windows(2).all(|pair| pair[1] > pair[0] - 2e-3));
        assert_eq!(heat(-1.0), heat(0.0));
        assert_eq!(heat(2.0), heat(1.0));
    }

    #[test]
    fn marks_on_heat_keep_a_contrast_of_three() {
        for step in 0..=100 {
            let share = f64::from(step) / 100.0;
            let ground = luminance(heat(share)) + 0.05;
            let mark = luminance(on_heat(share).rgb) + 0.05;
            let contrast = (ground / mark).max(mark / ground);
            assert!(contrast > 3.0, "{share}: {contrast}");
        }
    }

    #[test]
    fn curves_repeat_neither_colour_with_dash_early() {
        let key = |number| {
            let stroke = Stroke::curve(number);
            (
                stroke.colour.rgb,
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
